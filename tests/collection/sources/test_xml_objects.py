"""XML of any program is read without a format of its own: whatever its elements are called, the objects are the same.

The shapes are those of exports of EMu, Modes, FileMaker, Access, FoxPro (PastPerfect), Solr and of small programs of
museums' own; the objects are invented, and were written down before anything was read.
"""

from __future__ import annotations

import csv
import gzip
from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.guessing.source import columns_in
from pipeline.collection.reading import read_items
from pipeline.collection.sources.xml_objects import record_path
from pipeline.night.importing import bundled_collection
from tests.soak import SOAK

Thing = tuple[str, str, str, float, float, str, bool]
THINGS: tuple[Thing, ...] = (
    ("1913.20", "Vase", "terracotta", 30.5, 12.0, "Room 3", True),
    ("1913.2", "Jar & lid", "stoneware", 22.0, 15.0, "Room 3", True),
    ("b-3", "Bust <of a man>", "marble", 61.0, 40.0, "Depot 2", False),
)
"""Number, name, material, height and width [cm], place, whether it is on display."""

XML = '<?xml version="1.0" encoding="UTF-8"?>\n'


def emu(things: tuple[Thing, ...]) -> str:
    def measured(kind: str, value: float) -> str:
        return (
            f'<tuple><atom name="PhyType">{kind}</atom><atom name="PhyValue">{value:g}</atom>'
            '<atom name="PhyUnit">cm</atom></tuple>'
        )

    rows = "".join(
        f'<!-- Row --><tuple><atom name="irn">{9000 + at}</atom><atom name="TitObjectNumber">{number}</atom>'
        f'<atom name="TitMainTitle">{escape(name)}</atom><atom name="PhyMaterial">{material}</atom>'
        f'<table name="Dimensions">{measured("Height", high)}{measured("Width", wide)}</table>'
        f'<tuple name="LocCurrentLocationRef"><atom name="SummaryData">{place}</atom></tuple>'
        f'<atom name="WebOnDisplay">{"Yes" if shown else "No"}</atom></tuple>\n'
        for at, (number, name, material, high, wide, place, shown) in enumerate(things)
    )
    return XML + f'<table name="ecatalogue">\n{rows}</table>'


def modes(things: tuple[Thing, ...]) -> str:
    def measured(kind: str, value: float) -> str:
        size = f"<Dimension>{kind}</Dimension><Reading>{value:g} cm</Reading>"
        return f"<Measurement><Part>overall</Part>{size}</Measurement>"

    rows = "".join(
        f'<Object elementtype="standard"><ObjectIdentity><Number>{number}</Number></ObjectIdentity>'
        f'<Identification><ObjectName elementtype="simple name"><Keyword>{escape(name)}</Keyword></ObjectName>'
        f"</Identification><Description><Material><Keyword>{material}</Keyword></Material>"
        f"{measured('height', high)}{measured('width', wide)}</Description>"
        f'<ObjectLocation elementtype="current location"><Location>{place}</Location></ObjectLocation>'
        f"<OnDisplay>{'yes' if shown else 'no'}</OnDisplay></Object>\n"
        for number, name, material, high, wide, place, shown in things
    )
    return XML + f"<Interchange>\n{rows}</Interchange>"


def filemaker(things: tuple[Thing, ...]) -> str:
    names = ("Inventarnummer", "Bezeichnung", "Material", "Höhe cm", "Breite cm", "Standort", "ausgestellt")
    fields = "".join(f'<FIELD EMPTYOK="YES" MAXREPEAT="1" NAME={quoteattr(name)} TYPE="TEXT"/>' for name in names)
    rows = "".join(
        f'<ROW MODID="3" RECORDID="{at}">'
        + "".join(f"<COL><DATA>{escape(str(one))}</DATA></COL>" for one in (*thing[:6], "ja" if thing[6] else "nein"))
        + "</ROW>\n"
        for at, thing in enumerate(things)
    )
    return (
        XML + '<FMPXMLRESULT xmlns="http://www.filemaker.com/fmpxmlresult"><ERRORCODE>0</ERRORCODE>'
        f'<PRODUCT NAME="FileMaker" VERSION="19"/><METADATA>{fields}</METADATA>'
        f'<RESULTSET FOUND="{len(things)}">\n{rows}</RESULTSET></FMPXMLRESULT>'
    )


def access(things: tuple[Thing, ...]) -> str:
    rows = "".join(
        f"<Objekte><ID>{at}</ID><InvNr>{number}</InvNr><Bezeichnung>{escape(name)}</Bezeichnung>"
        f"<Material>{material}</Material><Hoehe_cm>{high}</Hoehe_cm><Breite_cm>{wide}</Breite_cm>"
        f"<Standort>{place}</Standort><ausgestellt>{int(shown)}</ausgestellt></Objekte>\n"
        for at, (number, name, material, high, wide, place, shown) in enumerate(things, start=1)
    )
    return XML + f'<dataroot xmlns:od="urn:schemas-microsoft-com:officedata" generated="2024-05-01">\n{rows}</dataroot>'


def foxpro(things: tuple[Thing, ...]) -> str:
    schema = "".join(f'<xsd:element name="{name}" type="xsd:string"/>' for name in "abcdefghijklmnopqrstuvwxyz")
    rows = "".join(
        f"<ppsdata><objectid>{number}</objectid><objname>{escape(name)}</objname><material>{material}</material>"
        f"<heightin>{high / 2.54:.6f}</heightin><widthin>{wide / 2.54:.6f}</widthin><homeloc>{place}</homeloc>"
        f"<ondisplay>{'true' if shown else 'false'}</ondisplay></ppsdata>\n"
        for number, name, material, high, wide, place, shown in things
    )
    return (
        XML + '<VFPData><xsd:schema xmlns:xsd="http://www.w3.org/2001/XMLSchema" id="VFPData"><xsd:complexType>'
        f"{schema}</xsd:complexType></xsd:schema>\n{rows}</VFPData>"
    )


def solr(things: tuple[Thing, ...]) -> str:
    rows = "".join(
        f'<doc><str name="id">{number}</str><str name="title">{escape(name)}</str><arr name="materials"><str>{material}'
        f'</str></arr><float name="height_cm">{high}</float><float name="width_cm">{wide}</float>'
        f'<str name="current_location">{place}</str><bool name="on_view">{str(shown).lower()}</bool></doc>\n'
        for number, name, material, high, wide, place, shown in things
    )
    head = '<lst name="responseHeader"><int name="status">0</int><int name="QTime">1</int></lst>'
    return XML + f'<response>{head}<result name="response" numFound="{len(things)}">\n{rows}</result></response>'


def grouped(things: tuple[Thing, ...]) -> str:
    rooms = "".join(
        f"<room><name>{room}</name>"
        + "".join(
            f"<object number={quoteattr(number)}><title xml:lang='en'>{escape(name)}</title><material>{material}"
            f"</material><size><height unit='cm'>{high:g}</height><width unit='cm'>{wide:g}</width></size>"
            f"<on_display>{'yes' if shown else 'no'}</on_display></object>\n"
            for number, name, material, high, wide, place, shown in things
            if place == room
        )
        + "</room>"
        for room in dict.fromkeys(place for *_, place, _ in things)
    )
    return XML + f"<museum><generator>inventory 3.1</generator>{rooms}</museum>"


def attributed(things: tuple[Thing, ...]) -> str:
    rows = "".join(
        f"<row number={quoteattr(number)} title={quoteattr(name)} material='{material}' height_cm='{high}' "
        f"width_cm='{wide}' location='{place}' on_display='{str(shown).lower()}'/>\n"
        for number, name, material, high, wide, place, shown in things
    )
    return XML + f"<rows>\n{rows}</rows>"


def dimensioned(things: tuple[Thing, ...]) -> str:
    rows = "".join(
        f"<m:artwork><m:accessionNumber>{number}</m:accessionNumber><m:title>{escape(name)}</m:title>"
        f"<m:medium>{material}</m:medium><m:dimensions><m:dimension type='height' unit='mm'>{10 * high:g}</m:dimension>"
        f"<m:dimension type='width' unit='mm'>{10 * wide:g}</m:dimension></m:dimensions>"
        f"<m:location><m:room>{place}</m:room></m:location><m:onView>{str(shown).lower()}</m:onView></m:artwork>\n"
        for number, name, material, high, wide, place, shown in things
    )
    return XML + f'<m:collection xmlns:m="https://museum.example/schema">\n{rows}</m:collection>'


DIALECTS: dict[str, Callable[[tuple[Thing, ...]], str]] = {
    one.__name__: one for one in (emu, modes, filemaker, access, foxpro, solr, grouped, attributed, dimensioned)
}


def read(path: Path) -> list[Thing]:
    made = guess(path)
    inventory = read_items(path, made.mapping)
    assert not inventory.rejected
    return [
        (
            item.object_number,
            item.title or item.object_name,
            item.medium or item.material or "",
            round(100.0 * (item.height_m or 0.0), 3),
            round(100.0 * (item.width_m or 0.0), 3),
            item.gallery,
            bool(item.on_display),
        )
        for item in inventory.items
    ]


@pytest.mark.parametrize("dialect", DIALECTS)
def test_objects_are_the_same_in_every_dialect(dialect: str, tmp_path: Path) -> None:
    path = tmp_path / "export.xml"
    path.write_text(DIALECTS[dialect](THINGS), encoding="utf-8")
    assert read(path) == [*THINGS]


@pytest.mark.parametrize("dialect", sorted(DIALECTS.keys() - {"attributed", "grouped"}))
def test_one_object_alone_is_one(dialect: str, tmp_path: Path) -> None:
    path = tmp_path / "export.xml"
    path.write_text(DIALECTS[dialect](THINGS[:1]), encoding="utf-8")
    assert read(path) == [THINGS[0]]


@pytest.mark.parametrize("dialect", sorted(DIALECTS.keys() - {"attributed", "grouped"}))
def test_a_folder_has_a_file_for_each_object(dialect: str, tmp_path: Path) -> None:
    for at, thing in enumerate(THINGS):
        (tmp_path / f"{at}.xml").write_text(DIALECTS[dialect]((thing,)), encoding="utf-8")
    (tmp_path / "readme.txt").write_text("of the export", encoding="utf-8")
    assert read(tmp_path) == [*THINGS]


def test_a_root_may_be_an_object_where_each_file_has_one(tmp_path: Path) -> None:
    for at, (number, name, material, high, wide, place, shown) in enumerate(THINGS):
        (tmp_path / f"{at}.xml").write_text(
            f"<objekt><inventarnummer>{number}</inventarnummer><titel>{escape(name)}</titel><material>{material}"
            f"</material><masse><mass art='Höhe' einheit='cm'>{high:g}</mass><mass art='Breite' einheit='cm'>{wide:g}"
            f"</mass></masse><standort>{place}</standort><ausgestellt>{'ja' if shown else 'nein'}</ausgestellt>"
            "</objekt>",
            encoding="utf-8",
        )
    assert read(tmp_path) == [*THINGS]


def test_encodings_and_packing(tmp_path: Path) -> None:
    text = dimensioned(THINGS)
    for name, content in {
        "utf16.xml": text.replace("UTF-8", "UTF-16").encode("utf-16"),
        "latin.xml": filemaker(THINGS).replace("UTF-8", "ISO-8859-1").encode("latin-1"),
        "packed.xml.gz": gzip.compress(text.encode()),
    }.items():
        (tmp_path / name).write_bytes(content)
        assert read(tmp_path / name) == [*THINGS]


def test_where_the_objects_are_is_found(tmp_path: Path) -> None:
    expected = {
        "emu": "table/tuple",
        "modes": "Interchange/Object",
        "filemaker": "FMPXMLRESULT/RESULTSET/ROW",
        "foxpro": "VFPData/ppsdata",
        "solr": "response/result/doc",
        "grouped": "museum/room/object",
    }
    for name, where in expected.items():
        path = tmp_path / f"{name}.xml"
        path.write_text(DIALECTS[name](THINGS * 20), encoding="utf-8")
        with path.open("rb") as binary:
            found, others = record_path(lambda binary=binary: [("x", binary)], path.name)
        assert "/".join(found) == where
        assert not others


def test_tables_beside_the_objects_are_told(tmp_path: Path) -> None:
    path = tmp_path / "export.xml"
    places = "".join(f"<Standorte><ID>{at}</ID><Raum>Room {at}</Raum></Standorte>" for at in range(3))
    path.write_text(access(THINGS).replace("</dataroot>", places + "</dataroot>"), encoding="utf-8")
    made = guess(path)
    assert any("nothing is read of 'dataroot/Standorte'" in doubt for doubt in made.doubts)
    chosen = guess(path, choices={"records": "dataroot/Standorte", "object_number": "ID", "gallery": "Raum"})
    assert chosen.mapping.source.records == "dataroot/Standorte"


def test_nothing_that_is_said_is_lost(tmp_path: Path) -> None:
    path = tmp_path / "export.xml"
    path.write_text(
        "<c><o><n>1</n><t>A <i>fine</i> pot</t><m>clay</m><m>glaze</m><h unit='cm'>12</h><w u='x'>7</w></o>"
        "<o><n>2</n><t>Jar</t><m/><h unit='cm'>14</h><x><y>deep</y></x></o></c>",
        encoding="utf-8",
    )
    columns = {one.name: one.values for one in columns_in(path, {"format": "xml"})}
    assert columns == {
        "n": ["1", "2"],
        "t": ["A fine pot", "Jar"],
        "m": ["clay; glaze", ""],
        "h": ["12 cm", "14 cm"],
        "w": ["7", ""],
        "w@u": ["x", ""],
        "x.y": ["", "deep"],
    }


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<c><o><n>1</n><t>x</t></o><o><n>2</n>", "not well-formed XML"),
        ('<!DOCTYPE c [<!ENTITY e "x">]><c><o><n>1</n><t>&e;</t></o><o><n>2</n><t>y</t></o></c>', "document type"),
        ("<c>nothing</c>", r"\[source\] records"),
        ("<html><body><table><tr><td>1</td></tr></table></body></html>", "web page"),
        ("<?xml version='1.0'?><Workbook xmlns='urn:schemas-microsoft-com:office:spreadsheet'/>", "xlsx"),
    ],
)
def test_what_cannot_be_read_is_said(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "export.xml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CollectionError, match=said):
        guess(path)


@pytest.mark.parametrize(
    ("head", "said"),
    [
        (b"%PDF-1.7\n\0", "a PDF"),
        (b"SQLite format 3\0" + bytes(100), "SQLite database; name it as an address"),
        (b"\0\1\0\0Standard ACE DB\0" + bytes(100), "database of Access"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), r"old \.xls workbook"),
        (b"\x03\x79\x01\x01" + bytes(600), "of no kind that Kouros knows"),
    ],
)
def test_files_that_are_no_tables_are_named(head: bytes, said: str, tmp_path: Path) -> None:
    path = tmp_path / "objects.csv"
    path.write_bytes(head)
    with pytest.raises(CollectionError, match=said):
        guess(path)


@pytest.mark.long("test_objects_are_the_same_in_every_dialect")
def test_a_real_collection_is_the_same_as_from_its_csv(tmp_path: Path) -> None:
    with bundled_collection().open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))[: 400 if SOAK else 130]
    whole, text = tmp_path / "objects.csv", ""
    with whole.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    for row in rows:
        cells = (f"<field name={quoteattr(name)}>{escape(cell)}</field>" for name, cell in row.items())
        text += f"<record>{''.join(cells)}</record>\n"
    (tmp_path / "objects.xml").write_text(f"{XML}<export><day>2024</day><all>{text}</all></export>", encoding="utf-8")
    told = [read_items(path, guess(path).mapping).items for path in (whole, tmp_path / "objects.xml")]
    assert len(told[0]) > 0.97 * len(rows)
    assert told[0] == told[1]
