"""Units of columns: as their heads name them, and as their numbers look where nothing does."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.collection.dimensions import choose, parse
from pipeline.collection.guess import guess
from pipeline.collection.guessing.names import named, unit_in
from pipeline.collection.guessing.units import usual_unit
from pipeline.collection.places import parted
from pipeline.collection.reading import read_items

HEADS = [
    ("Höhe in cm", "Höhe", "cm"),
    ("Maße (H x B x T in mm)", "Maße (H x B x T)", "mm"),
    ("Maße (HxBxT mm)", "Maße (HxBxT)", "mm"),
    ("Abmessungen in cm (H x B x T)", "Abmessungen (H x B x T)", "cm"),
    ("Maße cm (HxBxT)", "Maße (HxBxT)", "cm"),
    ("Dimensions (cm, HxWxD)", "Dimensions (HxWxD)", "cm"),
    ("Dimensions H x W x D (in)", "Dimensions H x W x D", "in"),
    ("Height (with frame, in)", "Height (with frame)", "in"),
    ("Dimensiuni (Î x L x g cm)", "Dimensiuni (Î x L x g)", "cm"),
    ("Mål i cm", "Mål", "cm"),
    ("Wymiary w mm", "Wymiary", "mm"),
    ("Размер (в см)", "Размер", "cm"),
    ("Ύψος (εκ.)", "Ύψος", "cm"),
    ("高度（厘米）", "高度", "cm"),
    ("寸法(cm)", "寸法", "cm"),
    ("寸法（縦×横×高cm）", "寸法（縦×横×高）", "cm"),
    ("高さcm", "高さ", "cm"),
    ("Rozměry (v × š × h v mm)", "Rozměry (v × š × h)", "mm"),
    ("Mål (HxBxD) cm", "Mål (HxBxD)", "cm"),
    ("HEIGHT_IN", "HEIGHT", "in"),
    ("Weight [lbs]", "Weight", "lb"),
    ("Gewicht in Gramm", "Gewicht", "g"),
    ('Height (")', "Height", "in"),
]

NO_UNITS = [
    "Diameter (foot)",  # of the foot of a vase
    "Durchmesser (Fuß)",
    "Dimensions (L x l x g)",  # grosime, the thickness
    "Dimensions (cm/in)",
    "Title (in English)",
    "Stored in (room)",
    "cm",
    "Größe",
]


@pytest.mark.parametrize(("head", "rest", "unit"), HEADS)
def test_the_unit_of_a_head_is_found_wherever_it_stands(head: str, rest: str, unit: str) -> None:
    found, told = unit_in(head)
    assert (" ".join(found.split()), told) == (rest, unit)


@pytest.mark.parametrize("head", NO_UNITS)
def test_what_only_looks_like_a_unit_is_none(head: str) -> None:
    assert unit_in(head) == (head, None)


def _heights(tmp_path: Path, head: str, cells: list[str]) -> tuple[list[float | None], list[str]]:
    path = tmp_path / "list.csv"
    rows = [f"A {at};Vase;Saal {at % 2};{cell}" for at, cell in enumerate(cells)]
    path.write_text("\n".join([f"Inventarnummer;Bezeichnung;Raum;{head}", *rows]), encoding="utf-8")
    found = guess(path)
    items = read_items(path, found.mapping).items
    return [item.height_m for item in items], [*found.doubts, *(question.text for question in found.questions)]


@pytest.mark.parametrize(
    "head", ["Rozměry (v × š × h v mm)", "Maße (H x B x T in mm)", "Abmessungen in mm (HxBxT)", "Maße HxBxT [mm]"]
)
def test_texts_without_a_unit_have_that_of_the_head(head: str, tmp_path: Path) -> None:
    heights, _ = _heights(tmp_path, head, ["430 × 210 × 210", "62 × 41 × 30", "1250 × 300 × 300"])
    assert heights == pytest.approx([0.43, 0.062, 1.25])


@pytest.mark.parametrize(
    ("cells", "metres"),
    [(["43 x 21 x 21", "62,5 x 41 x 30"], [0.43, 0.625]), (["430 x 210 x 200", "625 x 410 x 300"], [0.43, 0.625])],
)
def test_where_neither_head_nor_text_names_a_unit_one_is_taken_and_asked(
    cells: list[str], metres: list[float], tmp_path: Path
) -> None:
    heights, said = _heights(tmp_path, "Maße", cells)
    assert heights == pytest.approx(metres)
    assert any(one.startswith("no unit is told for 'Maße'") for one in said)
    assert "in which unit are 'Maße'?" in said


def test_texts_without_a_unit_beside_several_are_left_and_counted(tmp_path: Path) -> None:
    heights, said = _heights(tmp_path, "Maße", ["H 43 cm", "H 1,2 m", "H 320 mm", "65 x 170 x 55"])
    assert heights == pytest.approx([0.43, 1.2, 0.32, None])
    assert any(one.startswith("1 text of sizes without a unit: not read") for one in said)


def test_numbers_tell_units_by_how_they_look() -> None:
    assert usual_unit(["12.5", "30", "41.2"])[0] == "cm"
    assert usual_unit(["125", "300", "412"])[0] == "mm"
    assert usual_unit(["0.85", "1.20", "0.42", "1.05", "0.66"])[0] == "m"
    assert usual_unit(["4.125", "7.375", "2.5625", "3.875", "9.625"])[0] == "in"
    assert usual_unit(["22 1/2", "24", "20 3/4"])[0] == "in"
    assert usual_unit(["22 1/2", "24", "12½"])[0] == "cm"  # a half is written of centimetres too
    assert usual_unit([])[0] == "cm"


def test_weights_that_mostly_name_their_units_are_read_as_written(tmp_path: Path) -> None:
    """What says nothing in figures does not count against it, and is a doubt of its row."""
    path = tmp_path / "list.csv"
    cells = ['">100 kg"', "approx. 9 lbs.", "450-500 kg", "n/a", "1.5", "850g", "heavy"]
    rows = [f"{at},Bust,Hall,60 cm,{cell}" for at, cell in enumerate(cells)]
    path.write_text("\n".join(["Acc No,Object,Gallery,Height,Weight", *rows]), encoding="utf-8")
    items = read_items(path, guess(path).mapping).items
    told = [None if item.mass_kg is None else round(item.mass_kg, 3) for item in items]
    assert told == [100.0, 4.082, 500.0, None, None, 0.85, None]
    assert [bool(item.problems) for item in items] == [False, False, False, True, True, False, True]


LIST = """Catalog #,Object,Home Location,Cur Location,H,W,D,Wt
N-1,Buffalo skull,Storage A,Main Hall,22 1/2,24,16,
N-2,Grizzly bear mount,Storage A,Main Hall,96,48,40,800
N-3,Trilobite slab,Storage B,Fossil room Case 2,12.5,18.25,2,35
N-4,Barn owl in glass dome,Storage B,Main Hall,20 3/4,12,12,
"""


def test_a_list_of_a_natural_history_museum_in_its_short_words(tmp_path: Path) -> None:
    """Where things are now, not where they are at home; fractions are inches, and weights beside inches pounds."""
    path = tmp_path / "list.csv"
    path.write_text(LIST, encoding="utf-8")
    items = read_items(path, guess(path).mapping).items
    assert [(item.gallery, item.case) for item in items[1:3]] == [("Main Hall", ""), ("Fossil room", "Case 2")]
    assert [item.height_m for item in items] == pytest.approx([0.5715, 2.4384, 0.3175, 0.52705])
    assert [item.mass_kg for item in items] == pytest.approx([None, 362.874, 15.8757, None], abs=1e-3)


@pytest.mark.parametrize("last", ["Σύνολο: 5 αντικείμενα", "Total 168", "合計 5", "Objekte: 5"])
def test_a_sum_below_a_list_is_no_object(last: str, tmp_path: Path) -> None:
    path = tmp_path / "list.csv"
    rows = [f"A {at};Vase;Saal 1;{20 + at} cm" for at in range(5)]
    path.write_text(
        "\n".join(["Inventarnummer;Bezeichnung;Raum;Höhe", *rows, f"{last};;;", "B-7;;;"]), encoding="utf-8"
    )
    read = read_items(path, guess(path).mapping)
    assert [item.object_number for item in read.items] == ["A 0", "A 1", "A 2", "A 3", "A 4", "B-7"]
    assert len(read.rejected) == 1
    assert "a sum" in read.rejected[0].message


def test_a_row_of_units_below_the_names_belongs_to_them(tmp_path: Path) -> None:
    """As Italian offices hand lists over: names in two rows, units in a third; names cut short by a point."""
    path = tmp_path / "lista.csv"
    path.write_text(
        "Inv.;Oggetto;Ubicazione;Misure;;;Peso\n;;;alt.;largh.;prof.;\n;;;mm;mm;mm;g\n"
        "A.12;Vaso;Sala 1;345;220;210;2100\nS.4;Busto;Sala 2;750;580;300;140000\nS.5;Stele;Sala 2;1650;620;140;\n",
        encoding="utf-8",
    )
    found = guess(path)
    read = read_items(path, found.mapping)
    assert [(item.height_m, item.width_m, item.depth_m, item.mass_kg) for item in read.items[:2]] == [
        pytest.approx((0.345, 0.22, 0.21, 2.1)),
        pytest.approx((0.75, 0.58, 0.3, 140.0)),
    ]
    assert not read.rejected
    assert "3 rows name the columns together" in found.sure


@pytest.mark.parametrize(
    ("head", "field"), [("largh.", "width_m"), ("Lungh.", "length_m"), ("Diám.", "diameter_m"), ("Gew.", "mass_kg")]
)
def test_names_of_sides_that_a_point_cuts_short(head: str, field: str) -> None:
    meaning = named(head)
    assert meaning is not None
    assert meaning.field == field


@pytest.mark.parametrize("head", ["Dept.", "St.", "Auth.", "Largh"])
def test_what_is_cut_short_of_other_names_is_no_side(head: str) -> None:
    meaning = named(head)
    assert meaning is None or meaning.field not in ("height_m", "width_m", "depth_m", "length_m", "mass_kg")


def test_of_two_columns_of_names_the_longer_is_the_title(tmp_path: Path) -> None:
    path = tmp_path / "primus.csv"
    path.write_text(
        "Föremålsnr;Sakord;Benämning;Placering;Mått\nNM.1;byrå;Gustaviansk byrå;Rum 4;H 84 B 110 Dj 52\n"
        "NM.2;ljuskrona;Ljuskrona för 12 ljus;Rum 4;Höjd 115 Diam 90\n"
        "NM.3;golvur;Moraklocka;Rum 2;H 2180 mm, B 520 mm\n",
        encoding="utf-8",
    )
    found = guess(path)
    items = read_items(path, found.mapping).items
    assert [(item.object_name, item.title) for item in items[:2]] == [
        ("byrå", "Gustaviansk byrå"),
        ("ljuskrona", "Ljuskrona för 12 ljus"),
    ]
    # Most texts name no unit, and one does: it is asked about the others.
    assert [item.height_m for item in items] == pytest.approx([0.84, 1.15, 2.18])
    assert items[0].depth_m == pytest.approx(0.52)
    assert any(question.key == "unit" for question in found.questions)


@pytest.mark.parametrize(
    ("text", "sides"),
    [
        ("185:128:54 cm", (1.85, 1.28, 0.54)),
        ("24,5 : 31 cm", (0.245, 0.31, None)),
        ("Maßstab 1:10, H 30 cm", (0.3, None, None)),
        ("1:10 cm", (None, None, None)),
    ],
)
def test_sizes_with_colons_between_them(text: str, sides: tuple[float | None, ...]) -> None:
    chosen = choose(parse(text))
    told = [one.value if one else None for one in (chosen.height, chosen.width, chosen.depth)]
    assert told == pytest.approx(list(sides))


@pytest.mark.parametrize(
    ("text", "sides"),
    [
        ("高6.9公分 橫23公分 縱16.4公分", (0.069, 0.23, 0.164)),
        ("높이 6.9cm 가로 23cm 세로 16.4cm", (0.069, 0.23, 0.164)),
        ("縱120公分 橫60公分", (1.2, 0.6, None)),
    ],
)
def test_the_upright_side_is_the_depth_where_a_height_is_told(text: str, sides: tuple[float | None, ...]) -> None:
    chosen = choose(parse(text))
    told = [one.value if one else None for one in (chosen.height, chosen.width, chosen.depth)]
    assert told == pytest.approx(list(sides))


def test_names_of_linked_data_are_read_by_their_last_word() -> None:
    for name, field in (("dcterms:title.@value", "title"), ("dcterms:identifier.@value", "object_number")):
        meaning = named(name)
        assert meaning is not None
        assert meaning.field == field


@pytest.mark.parametrize("head", ["Title / Description", "Description/Title", "Titel / Beschreibung"])
def test_a_column_of_titles_and_descriptions_is_one_of_titles(head: str) -> None:
    meaning = named(head)
    assert meaning is not None
    assert meaning.field == "title"


@pytest.mark.parametrize(
    ("text", "height"),
    [
        ("Length: 145cm nape to hem", 1.45),
        ("Length at CB: 52 in. (132.1 cm)", 1.3208),
        ("Length: 30 cm, hem 200 cm", None),
        ("Length 90 cm", None),
    ],
)
def test_a_garment_hangs_as_high_as_it_is_long(text: str, height: float | None) -> None:
    chosen = choose(parse(text))
    assert (chosen.height.value if chosen.height else None) == (height and pytest.approx(height, rel=1e-3))


@pytest.mark.parametrize(
    ("text", "kg"), [("12 st 4 lb", 172 * 0.45359237), ("Weight: 3 stone", 42 * 0.45359237), ("3 st", None)]
)
def test_stones_are_fourteen_pounds_and_pieces_are_none(text: str, kg: float | None) -> None:
    mass = choose(parse(text)).mass
    assert (mass.value if mass else None) == (kg and pytest.approx(kg))


@pytest.mark.parametrize(
    "hostile", ["(," * 50_000, "x (" * 50_000 + "cm)", "length" + " " * 100_000, "1:" * 50_000 + "cm"]
)
def test_hostile_heads_places_and_texts_cost_no_more_than_their_length(hostile: str) -> None:
    """Each would take hours, were it looked through from each of its characters on: the test would not end."""
    assert unit_in(hostile)[1] is None
    assert parted(hostile) == (hostile, "", "")
    assert parse(hostile).having("truncated")
