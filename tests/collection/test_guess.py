"""A first mapping, guessed from a database, or from a workbook of several sheets; databases are only read."""

from __future__ import annotations

import hashlib
from pathlib import Path

import openpyxl
import pytest
from sqlalchemy import create_engine, text

from pipeline.collection.display_words import says_away
from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.guessing.names import named
from pipeline.collection.guessing.text_files import Head, encoding_of, table_head
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.night.importing import presets, proposed

COLUMNS = '"ObjectNumber" TEXT, "Location" TEXT, "Title" TEXT, "Height (cm)" DOUBLE PRECISION, "Provenance" TEXT'
ROWS = "('19.1', 'Hall 1', 'Vase', 20.5, 'bought'), ('19.2', 'Hall 2', 'Bowl', 8, 'given')"


def fill(url: str, *names: str) -> None:
    engine = create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    with engine.begin() as connection:
        for name in names:
            connection.execute(text(f"CREATE TABLE {name} ({COLUMNS})"))
            connection.execute(text(f"INSERT INTO {name} VALUES {ROWS}"))  # noqa: S608 - names of this test
    engine.dispose()


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database of either kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'tms.sqlite'}"
    where: str = request.getfixturevalue("postgresql_url")
    engine = create_engine(where.replace("postgresql://", "postgresql+psycopg://"))
    with engine.begin() as connection:
        connection.execute(text("DROP SCHEMA public CASCADE"))
        connection.execute(text("DROP SCHEMA IF EXISTS tms CASCADE"))
        connection.execute(text("CREATE SCHEMA public"))
    engine.dispose()
    return where


def test_the_only_table_of_a_database_is_guessed_from(url: str) -> None:
    fill(url, "objects")
    found = proposed(url)
    assert (found.reading.rows, len(found.reading.items), found.guess.mapping.source.table) == (2, 2, "objects")
    assert {name: m.column for name, m in found.guess.mapping.columns.items()} == {
        "object_number": "ObjectNumber",
        "gallery": "Location",
        "title": "Title",
        "object_name": "Title",
        "height_m": "Height (cm)",
    }
    # What it proposes reads the database as it stands.
    assert [item.height_m for item in read_items(url, found.guess.mapping).items] == [0.205, 0.08]


def test_of_several_tables_the_likeliest_is_taken_and_the_others_named(url: str) -> None:
    fill(url, "objects", "loans")
    schema = url.startswith("postgresql")
    if schema:
        engine = create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
        with engine.begin() as connection:
            connection.execute(text("CREATE SCHEMA tms"))
        engine.dispose()
        fill(url, "tms.things")
    found = guess(url)
    assert found.mapping.source.table == "objects"
    others = "'loans'" + (", 'tms.things'" if schema else "")
    assert f"table 'objects' looks most like the objects; --table takes another: {others}" in found.doubts
    with pytest.raises(CollectionError, match="has no table or view 'object'"):
        guess(url, "object")
    assert guess(url, "loans").mapping.source.table == "loans"
    if schema:
        assert guess(url, "tms.things").mapping.source.table == "tms.things"
    query = 'SELECT "ObjectNumber" AS object_number, "Title" FROM objects'
    found = guess(url, query)
    assert (found.mapping.source.query, found.mapping.source.table) == (query, None)
    assert len(read_items(url, found.mapping).items) == 2


def test_a_guess_writes_nothing_to_a_database(tmp_path: Path) -> None:
    where = f"sqlite:///{tmp_path / 'tms.sqlite'}"
    fill(where, "objects")
    before = hashlib.sha256((tmp_path / "tms.sqlite").read_bytes()).hexdigest()
    proposed(where)
    with pytest.raises(CollectionError, match="it would write"):
        guess(where, "WITH gone AS (SELECT 1) DELETE FROM objects RETURNING *")
    assert hashlib.sha256((tmp_path / "tms.sqlite").read_bytes()).hexdigest() == before
    assert [path.name for path in tmp_path.iterdir()] == ["tms.sqlite"]


@pytest.fixture
def workbook(tmp_path: Path) -> Path:
    """A workbook whose objects are on its second sheet."""
    book = openpyxl.Workbook()
    first = book.worksheets[0]
    first.title = "Read me"
    first.append(["This workbook", "is ours"])
    objects = book.create_sheet("Objects")
    objects.append(["Object Number", "Location", "Title", "Height (cm)"])
    for number in range(20):
        first.append(["text", number])
        objects.append([f"19.{number}", "Hall", "Vase", 20 + number])
    book.create_sheet("Empty")
    book.create_sheet("Old").sheet_state = "hidden"
    path = tmp_path / "museum.xlsx"
    book.save(path)
    return path


def test_of_several_sheets_the_one_like_an_inventory_is_taken_and_named(workbook: Path) -> None:
    found = guess(workbook)
    assert found.mapping.source.sheet == "Objects"
    (said,) = (doubt for doubt in found.doubts if "sheets" in doubt)
    assert said.startswith("of 3 sheets 'Objects' looks most like the inventory and is read; --table takes another:")
    assert len(read_items(workbook, found.mapping).items) == 20
    with pytest.raises(CollectionError, match="has no sheet 'Things'; name one of its sheets: 'Read me', 'Objects'"):
        guess(workbook, "Things")
    with pytest.raises(CollectionError, match="3 visible sheets; say which one to read: sheet = "):
        read_items(
            workbook,
            found.mapping.model_copy(update={"source": found.mapping.source.model_copy(update={"sheet": None})}),
        )


def test_a_workbook_read_as_text_says_so(workbook: Path) -> None:
    with pytest.raises(CollectionError, match=r'a workbook, and the mapping carnegie reads csv; say format = "xlsx"'):
        read_items(workbook, load_mapping("carnegie"))


def test_a_table_of_a_text_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("object_number,title\n1,a\n", encoding="utf-8")
    with pytest.raises(CollectionError, match=r"a.csv: has neither sheets nor tables"):
        guess(tmp_path / "a.csv", "objects")


def test_a_preset_names_its_file_which_can_be_copied_and_used(tmp_path: Path) -> None:
    for name, preset in presets().items():
        copy = tmp_path / "ours.toml"
        copy.write_bytes(preset.file.read_bytes())
        ours = load_mapping(copy)
        assert ours.columns == load_mapping(name).columns
        assert ours.museum.name == preset.about
        assert len(preset.expects) > 20


def test_tables_without_numbers_of_objects_are_listed(tmp_path: Path) -> None:
    where = f"sqlite:///{tmp_path / 'other.sqlite'}"
    engine = create_engine(where)
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE people (name TEXT)"))
        connection.execute(text("CREATE TABLE letters (written TEXT)"))
    engine.dispose()
    with pytest.raises(CollectionError, match=r"say by --table which of its tables .*it has 'letters', 'people'"):
        guess(where)


TITLED = "Museum of Things,,,\nList of 2024,,,\n\nNo.,Place,Size,Flag\n1,Hall,12 cm,ja\n2,Store 1,13 cm,nein\n"


def test_what_was_chosen_is_taken_and_what_cannot_be_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "list.csv"
    path.write_text(TITLED, encoding="utf-8")
    chosen = {"header_row": "4", "object_number": "No.", "gallery": "Place", "on_display": "Flag", "dimensions": "Size"}
    found = guess(path, choices=chosen)
    assert found.mapping.source.header_row == 4
    assert {name: m.column for name, m in found.mapping.columns.items()} == {
        "object_number": "No.",
        "gallery": "Place",
        "on_display": "Flag",
    }
    assert found.mapping.dimensions is not None
    assert found.mapping.display.not_on_display == ("Store 1",)
    assert [item.on_display for item in read_items(path, found.mapping).items] == [True, False]
    for choice, said in (
        ({"gallery": "Room"}, "--choose gallery: there is no column 'Room'; its columns are"),
        ({"colour": "Room"}, "--choose colour: there is no such choice; choose a field"),
        ({"header_row": "four"}, "needs a number, such as header_row=4"),
        ({"encoding": "ebcdic-x"}, "there is no encoding 'ebcdic-x'; try utf-8"),
    ):
        with pytest.raises(CollectionError) as refused:
            guess(path, choices=chosen | choice)
        assert said in str(refused.value)


WORDS = {
    "cp1252": "Höhe und Größe; Église d’été – salle à côté; Óleo sobre lienzo, sección; João, coleção de açúcar",
    "mac-roman": "Pâte de verre émaillée, déposée à l’hôtel – Noël; Böcklin, Gemälde über Kühe; señora, città più là",
    "cp1250": "ceramică, înălțime; cană, oală; Muzeul Național al Satului, sală, țesătură".replace("ț", "ţ"),
    "utf-8": "Höhe, Église, înălțime, 高さ",
    "utf-16": "Höhe, Église, înălțime, 高さ",
    "cp1251": "Инвентарный номер; материал; высота 12 см; размеры; бронза",
    "cp1253": "αριθμός ευρετηρίου; υλικό; ύψος 12 εκ.; διάμετρος",
    "cp1254": "Envanter No; ölçüler; yükseklik 12 cm, genişlik, ağırlık; bulunduğu yer",
    "gb18030": "文物号,名称,质地,高度,位置,尺寸",
    "euc-kr": "유물번호,유물명,재질,높이,전시실,크기",
    "shift-jis": "資料番号は展示室にあります。高さと幅をはかる",
    "euc-jp": "資料番号は展示室にあります。高さと幅をはかる",
}


@pytest.mark.parametrize("encoding", WORDS)
def test_texts_come_back_as_they_were_written(encoding: str) -> None:
    """What counts is the text, not the name: two encodings may write the same letters with the same bytes."""
    wanted = WORDS[encoding]
    content = wanted.encode(encoding)
    assert content.decode(encoding_of(content)) == wanted


def test_where_columns_are_named() -> None:
    """Titles above, two rows of a merged head, and a table that begins with its head: each as a person sees it."""
    plain = [(1, ["Inv. no.", "Title", "Height (cm)"]), (2, ["1", "Vase", "12"]), (3, ["2", "Bowl", "7"])]
    assert table_head(plain) == Head(1, 1, 3)
    titled = [(1, ["Museum", "", ""]), *((number + 4, cells) for number, cells in plain)]
    assert table_head(titled) == Head(5, 1, 3)
    merged = [
        (1, ["Inventarnr.", "Titel", "Maße (mm)", "", ""]),
        (2, ["", "", "H", "B", "T"]),
        (3, ["1", "Vase", "120", "80", "70"]),
        (4, ["2", "Krug", "220", "80", "75"]),
    ]
    found = table_head(merged)
    assert (found.row, found.rows) == (1, 2)


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("N° d’inventaire", "object_number"),
        ("Inv.-Nr.", "object_number"),
        ("Número de inventário", "object_number"),
        ("Nr. inventar", "object_number"),
        ("Alte Inv.-Nr.", None),
        ("AccessionDate", None),
        ("Akt. Standort", "gallery"),
        ("Ubicación actual", "gallery"),
        ("Localização", "gallery"),
        ("Höhe in cm", "height_m"),
        ("altezza [mm]", "height_m"),
        ("Înălțime", "height_m"),
        ("Dimensions (cm) / Hauteur", "height_m"),
        ("Objeto/Documento", "object_name"),
        ("材質", "medium"),
        ("Tentoongesteld", "on_display"),
        ("Provenance", None),
        ("Denomination_1", "object_name"),
        ("Denomination_2", None),
        ("Matériaux 01", "medium"),
        ("H1", None),
        ("Matières", "medium"),
        ("object_names", "object_name"),
        ("HEIGHTIN", "height_m"),
        ("weightKg", "mass_kg"),
        ("begin", None),
        ("Αρ. Ευρετηρίου", "object_number"),
        ("ΔΙΑΣΤΑΣΕΙΣ", "dimensions"),
        ("Bulunduğu Yer", "gallery"),
        ("Inventarienummer", "object_number"),
        ("Højde", "height_m"),
        ("TEMPLOC", "gallery"),
    ],
)
def test_names_of_columns_in_many_languages(name: str, field: str | None) -> None:
    found = named(name)
    assert (None if found is None else found.field) == field


def test_a_store_is_no_visible_storage() -> None:
    places = [
        "Αποθήκη Β",
        "Αίθουσα 1, Προθήκη 2",
        "Depo 2",
        "Depot A, rek 3",
        "Schaudepot",
        "Réserve 2",
        "Open storage 4",
        "Salle 3",
        "収蔵庫2",
        "Depotstraße-Saal",
    ]
    assert list(filter(says_away, places)) == ["Αποθήκη Β", "Depo 2", "Depot A, rek 3", "Réserve 2", "収蔵庫2"]


def test_joins_are_proposed_for_a_database_with_declared_keys(url: str) -> None:
    """Of two places the current one; measurements in a unit of each row; on either kind of database."""
    engine = create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    with engine.begin() as connection:
        for statement in (
            "CREATE TABLE locations (id INTEGER PRIMARY KEY, name TEXT, building TEXT)",
            "CREATE TABLE units (id INTEGER PRIMARY KEY, symbol TEXT)",
            "CREATE TABLE artworks (id INTEGER PRIMARY KEY, accession_number TEXT, title TEXT, home_location_id "
            "INTEGER REFERENCES locations(id))",
            "CREATE TABLE movements (id INTEGER PRIMARY KEY, artwork_id INTEGER REFERENCES artworks(id), location_id "
            "INTEGER REFERENCES locations(id), is_current BOOLEAN)",
            "CREATE TABLE measurements (id INTEGER PRIMARY KEY, artwork_id INTEGER REFERENCES artworks(id), kind TEXT, "
            "value DOUBLE PRECISION, unit_id INTEGER REFERENCES units(id))",
            "INSERT INTO locations VALUES (1, 'Gallery 1', 'Main'), (2, 'Gallery 2', 'Main')",
            "INSERT INTO units VALUES (1, 'cm'), (2, 'in'), (3, 'kg')",
            "INSERT INTO artworks VALUES (1, 'A.1', 'Vase', 2), (2, 'A.2', 'Bowl', 2)",
            "INSERT INTO movements VALUES (1, 1, 2, FALSE), (2, 1, 1, TRUE), (3, 2, 2, TRUE)",
            "INSERT INTO measurements VALUES (1, 1, 'height', 20.5, 1), (2, 1, 'width', 10, 2), (3, 2, 'weight', 3, 3)",
        ):
            connection.execute(text(statement))
    engine.dispose()
    found = guess(url, "artworks")
    first, second = read_items(url, found.mapping).items
    assert (first.object_number, first.height_m, first.width_m) == ("A.1", 0.205, 0.254)
    assert (second.object_number, second.height_m, second.mass_kg) == ("A.2", None, 3.0)


def test_central_european_files_are_known_by_their_words() -> None:
    for head in ("Nr inwentarzowy;Materiał;wysokość: 12 cm, średnica", "Inventární číslo;Předmět;Výška (cm);Umístění"):
        content = head.encode("cp1250")
        assert content.decode(encoding_of(content)) == head


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("measurement_height", "height_m"),
        ("measurement_outside_diameter", "diameter_m"),
        ("ca_objects.dimensions.dimensions_width", "width_m"),
        ("ca_storage_locations.hierarchy.preferred_labels.name", "gallery"),
        ("ca_objects.on_display", "on_display"),
        ("main_reference_number", "object_number"),
        ("Miejsce przechowywania", "gallery"),
        ("Šířka (cm)", "width_m"),
        ("Инвентарный номер", "object_number"),
    ],
)
def test_names_of_other_systems(name: str, field: str) -> None:
    found = named(name)
    assert found is not None
    assert found.field == field


def test_cells_of_several_measurements_are_taken_apart(tmp_path: Path) -> None:
    """As Axiell exports fields that repeat; a row whose kinds and values are not as many is refused by name."""
    path = tmp_path / "axiell.csv"
    path.write_text(
        "objectnummer;objectnaam;afmeting.soort;afmeting.waarde;afmeting.eenheid;standplaats;gallery_text\n"
        "A 1;kast;hoogte$breedte$diepte;220,5$206$83,5;cm$cm$cm;Zaal 7;\n"
        "A 2;vaas;hoogte$diameter;435$250;mm$mm;Zaal 7;\n"
        "A 3;vaas;hoogte$diameter;30;cm;Zaal 7;\n"
        "A 4;buste;hoogte$gewicht;82$95;cm$kg;Zaal 8;\n",
        encoding="utf-8",
    )
    reading = read_items(path, guess(path).mapping)
    sizes = {item.object_number: (item.height_m, item.width_m, item.depth_m, item.mass_kg) for item in reading.items}
    assert sizes["A 1"] == (pytest.approx(2.205), 2.06, pytest.approx(0.835), None)
    assert sizes["A 2"] == (pytest.approx(0.435), 0.25, 0.25, None)
    assert sizes["A 4"] == (0.82, None, None, 95.0)
    (broken,) = [item for item in reading.items if item.object_number == "A 3"]
    assert sizes["A 3"][0] is None
    assert any("2 kinds of measurement stand beside 1 values" in problem.message for problem in broken.problems)


def test_the_unit_of_texts_may_stand_in_their_name_and_a_lost_number_is_said(tmp_path: Path) -> None:
    path = tmp_path / "matriz.csv"
    path.write_text(
        "Inventário,Denominação,Dimensões (cm),Localização,measurement_girth,gallery_text\n"
        + "".join(f"{n} Cer,Pote,altura: {n},Sala 2,{n + 5},\n" for n in range(10, 20)),
        encoding="utf-8",
    )
    found = guess(path)
    assert found.mapping.dimensions is not None
    assert found.mapping.dimensions.unit == "cm"
    assert found.mapping.columns["gallery"].column == "Localização"
    assert any("no field takes the numbers of 'measurement_girth'" in doubt for doubt in found.doubts)


TMS_COPY = """
create table Objects (ObjectID integer primary key, ObjectNumber text, ObjectName text, OnView int);
create table DimItemElemXrefs (DimItemElemXrefID integer primary key, TableID int, ID int);
create table Dimensions (DimensionID integer primary key, DimItemElemXrefID int, DimensionTypeID int,
                         PrimaryUnitID int, Dimension real);
create table DimensionTypes (DimensionTypeID integer primary key, DimensionType text);
create table DimensionUnits (UnitID integer primary key, UnitName text);
create table ObjLocations (ObjLocationID integer primary key, ObjectID int, LocationID int);
create table Locations (LocationID integer primary key, Site text, LocationString text);
insert into Objects values (1, '2001.5', 'jar', 1), (2, '2001.6', 'chest', 1);
insert into DimItemElemXrefs values (1, 108, 1), (2, 108, 2), (3, 47, 1);
insert into DimensionTypes values (1, 'Height'), (2, 'Width');
insert into DimensionUnits values (1, 'centimeters'), (2, 'inches');
insert into Dimensions values (1, 1, 1, 1, 30), (2, 1, 2, 1, 22), (3, 2, 1, 2, 30), (4, 3, 1, 1, 999);
insert into ObjLocations values (1, 1, 1), (2, 2, 1);
insert into Locations values (1, 'Main', 'Main, Gallery 5')"""


def test_a_copy_of_some_tables_of_tms_is_joined(tmp_path: Path) -> None:
    """Dimensions hang on rows for things of several tables, 108 the objects; the place is the whole string of it."""
    where = f"sqlite:///{tmp_path / 'copy.sqlite'}"
    engine = create_engine(where)
    with engine.begin() as connection:
        for statement in TMS_COPY.split(";"):
            connection.execute(text(statement))
    items = {item.object_number: item for item in read_items(where, guess(where).mapping).items}
    assert {number: (item.height_m, item.width_m) for number, item in items.items()} == {
        "2001.5": (0.3, 0.22),
        "2001.6": (pytest.approx(0.762), None),
    }
    assert {item.gallery for item in items.values()} == {"Main, Gallery 5"}


def test_words_for_how_things_are_held_are_given_their_meanings(tmp_path: Path) -> None:
    path = tmp_path / "held.csv"
    rows = (
        "not fixed,on plinth",
        "bolted,in showcase",
        "Hung,",
        "freestanding,to be bolted to floor",
        "befestigt,",
        "lose,shelf",
    )
    lines = (f"1.{at},Bust,marble,60,40,Room 1,{row}" for at, row in enumerate(rows))
    head = "Inventory no,Title,Material,Height (cm),Width (cm),Room,Support,Display"
    path.write_text("\n".join([head, *lines]), encoding="utf-8")
    made = guess(path)
    items = read_items(path, made.mapping).items
    assert [item.support and item.support.value for item in items] == [
        "freestanding",
        "fastened",
        "hung",
        "freestanding",
        "fastened",
        "freestanding",
    ]
    assert any("'bolted' as fastened" in doubt for doubt in made.doubts)


def test_a_name_beside_a_description_says_what_a_thing_is(tmp_path: Path) -> None:
    export = tmp_path / "export.csv"
    rows = ['1,Telescope,Refracting telescope on tripod. Bought 1902.,"brass, mahogany",H 160 cm,Hall 1',
            '2,Screen,Pair of six-panel folding screens,"ink and gold on paper",171 x 372 cm,Hall 2']  # fmt: skip
    export.write_text("\n".join(["Accession,Name,Description,Materials,Size,Gallery", *rows]), encoding="utf-8")
    told = guess(export)
    assert (told.mapping.columns["object_name"].column, told.mapping.columns["title"].column) == ("Name", "Description")
    first, second = read_items(export, told.mapping).items
    assert (first.object_name, first.title) == ("Telescope", "Refracting telescope on tripod")
    assert second.object_name == "Screen"
    # Beside an artist a name is a title.
    export.write_text(export.read_text(encoding="utf-8").replace("Materials", "Artist"), encoding="utf-8")
    assert guess(export).mapping.columns["title"].column == "Name"
