"""Exports in layouts that nobody had tried, by the guess alone, and each layout in a small file of its own.

Truth: tests/data/collections/third_exports/truth.csv, written before any file was read (README.md there).
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from openpyxl import Workbook

from pipeline.collection.dimensions import choose, parse
from pipeline.collection.dimensions.structured import plain_text, words_of
from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import Guess
from pipeline.collection.reading import Reading, read_items
from pipeline.night.importing import proposed
from pipeline.records import Item

from .first_sight import ASKED, right, seen

LONG = pytest.mark.long("test_layouts_that_nobody_had_tried_are_read_by_the_guess_alone")

REACHED = {
    "learn": {"height": 77, "plan": 67, "kind": 75, "manner": 78, "shown": 48, "mass": 19},
    "held": {"height": 104, "plan": 53, "kind": 92, "manner": 98, "shown": 69, "mass": 11},
    "last": {"height": 63, "plan": 63, "kind": 63, "manner": 63, "shown": 56, "mass": 15},
}
"""Rows right, of 78, 70, 78, 78, 48, 19, of 105, 65, 105, 105, 71, 11 and of 70, 70, 70, 70, 63, 15, as reached."""
SURE_AND_WRONG = {"learn": 2, "held": 1, "last": 0}
"""A horse of 62 cm is a figurine, and a statue by its label: both stand."""


@pytest.mark.parametrize("part", [*(pytest.param(part, marks=LONG) for part in ("learn", "held")), "last"])
def test_layouts_that_nobody_had_tried_are_read_by_the_guess_alone(part: str) -> None:
    rows = seen("third_exports", part)
    assert {what: right(rows, what)[0] >= REACHED[part][what] for what in ASKED} == dict.fromkeys(ASKED, True)
    assert [row.mark for row in rows if row.height is False and not row.said] == []
    assert sum(row.sure_and_wrong for row in rows) <= SURE_AND_WRONG[part]


def read(path: Path) -> tuple[Guess, dict[str, Item], Reading]:
    found = proposed(str(path)).guess
    result = read_items(path, found.mapping)
    return found, {item.object_number: item for item in result.items}, result


def written(path: Path, text: str) -> tuple[Guess, dict[str, Item], Reading]:
    path.write_text(text, encoding="utf-8")
    return read(path)


def sides(item: Item) -> list[float | None]:
    return [item.height_m, item.width_m, item.depth_m]


# ---------------------------------------------------------------------------------------------------------------------
# XML


EMU = """<?xml version="1.0"?><!DOCTYPE table [<!ELEMENT table (tuple)*> <!ATTLIST table name CDATA #REQUIRED>
<!ELEMENT tuple (atom)*> <!ELEMENT atom (#PCDATA)*> <!ATTLIST atom name CDATA #REQUIRED type CDATA "text">]>
<table name="ecatalogue">{}</table>"""
TUPLE = """<tuple><atom name="TitAccessionNo">{no}</atom><atom name="TitMainTitle">A print</atom>
<atom name="MedType_tab">Image Height
Image Width
Sheet Height
Sheet Width</atom><atom name="MedUnit_tab">inches
inches
inches
inches</atom><atom name="MedUnitMetric_tab">{unit}
{unit}
{unit}
{unit}</atom><atom name="MedValue_tab">8
12 3/4
10
14</atom><atom name="MedValueMetric_tab">20.32
32.39
25.4
35.56</atom></tuple>"""


def test_a_document_type_that_lists_elements_is_read_and_parts_stand_in_names_of_kinds(tmp_path: Path) -> None:
    """What the sheet measures counts, not the image; the units in the numbers' own column are theirs."""
    records = TUPLE.format(no="70.1", unit="cm") + TUPLE.format(no="70.2", unit="cm")
    found, items, _ = written(tmp_path / "emu.xml", EMU.format(records))
    assert found.mapping.source.long is not None
    assert [one.value for one in found.mapping.source.long.again] == ["MedValue_tab"]
    assert sides(items["70.1"]) == pytest.approx([0.254, 0.3556, None])


def test_two_units_that_contradict_each_other_leave_no_size_and_that_is_said(tmp_path: Path) -> None:
    records = TUPLE.format(no="70.1", unit="cm") + TUPLE.format(no="70.2", unit="inches")
    _, items, _ = written(tmp_path / "emu.xml", EMU.format(records))
    assert items["70.2"].height_m is None
    assert any("gives it twice" in problem.message for problem in items["70.2"].problems)


@pytest.mark.parametrize(
    "declared",
    [
        '<!DOCTYPE t [<!ENTITY a "b">]>',
        "<!DOCTYPE t>",
        '<!DOCTYPE t SYSTEM "http://localhost:9/t.dtd">',
        '<!DOCTYPE t [<!ELEMENT t ANY><!ENTITY % p "x">]>',
        '<!DOCTYPE t PUBLIC "-//A//B" "t.dtd" [<!ELEMENT t ANY>]>',
    ],
)
def test_any_other_document_type_is_refused(declared: str, tmp_path: Path) -> None:
    with pytest.raises(CollectionError, match="document type"):
        written(tmp_path / "a.xml", declared + "<t><o><no>1</no><n>x</n></o><o><no>2</no><n>y</n></o></t>")


def test_a_harvest_has_numbers_of_its_own_places_and_deleted_records(tmp_path: Path) -> None:
    def record(at: int, place: str) -> str:
        return (
            f"<record><header><identifier>oai:m:{at}</identifier></header><metadata><dc><title>Vase {at}</title>"
            f"<type>Vase</type><identifier>NF.{at}</identifier><identifier>https://m.no/{at}</identifier>"
            f"<format>Høyde: {at} cm</format><source>{place}</source></dc></metadata></record>"
        )

    places = ("Utstilt: Salen", "Magasin 1", "Utstilt: Salen", "Magasin 1")
    records = "".join(record(20 + at, place) for at, place in enumerate(places))
    gone = '<record><header status="deleted"><identifier>oai:m:9</identifier></header></record>'
    text = f"<OAI-PMH><ListRecords>{records}{gone}</ListRecords></OAI-PMH>"
    _, items, result = written(tmp_path / "oai.xml", text)
    assert [(number, item.height_m, item.on_display) for number, item in items.items()] == [
        ("NF.20", pytest.approx(0.20), True),
        ("NF.21", pytest.approx(0.21), False),
        ("NF.22", pytest.approx(0.22), True),
        ("NF.23", pytest.approx(0.23), False),
    ]
    assert ["deleted" in one.message for one in result.rejected] == [True]


# ---------------------------------------------------------------------------------------------------------------------
# JSON


def test_parts_of_an_object_tell_its_size_where_it_tells_none_itself(tmp_path: Path) -> None:
    def size(kind: str, value: str, unit: str) -> dict[str, str]:
        return ({"dimension": kind} if kind else {}) | {"units": unit, "value": value}

    engine = [
        {"name": "driving wheel diameter", "measurements": {"dimensions": [size("diameter", "2057", "mm")]}},
        {"name": "height", "measurements": {"dimensions": [size("height", "153", "in"), size("height", "3886", "mm")]}},
        {"name": "weight", "measurements": {"dimensions": [size("", "107254", "kg"), size("", "236455", "lbs")]}},
    ]
    whole = [size("height", "9 15/16", "in"), size("height", "253", "mm"), size("", "5.2", "kg")]
    records = [
        {"number": "1976-7000", "name": "locomotive", "component": engine},
        {"number": "1984-1", "name": "telescope", "measurements": {"dimensions": whole}},
    ]
    _, items, _ = written(tmp_path / "smg.json", json.dumps(records))
    assert items["1976-7000"].height_m == pytest.approx(3.886, rel=0.001)
    assert items["1976-7000"].mass_kg == pytest.approx(107254)
    assert items["1984-1"].height_m == pytest.approx(0.253, rel=0.005)
    assert items["1984-1"].mass_kg == pytest.approx(5.2)


def test_answers_to_sparql_have_words_for_addresses(tmp_path: Path) -> None:
    def literal(value: str) -> dict[str, str]:
        return {"xml:lang": "en", "type": "literal", "value": value}

    rows = [
        {
            "item": {"type": "uri", "value": f"http://www.wikidata.org/entity/Q{at}"},
            "itemLabel": literal(name),
            "instanceLabel": literal(kind),
            "inv": literal(f"Ma {at}"),
            "height": {"datatype": "http://www.w3.org/2001/XMLSchema#decimal", "type": "literal", "value": height},
            "heightUnitLabel": literal(unit),
        }
        for at, name, kind, height, unit in (
            (399, "Venus de Milo", "statue", "204", "centimetre"),
            (2369, "Winged Victory of Samothrace", "statue", "5.57", "metre"),
            (779, "Mona Lisa", "painting", "77", "centimetre"),
        )
    ]
    answer = {"head": {"vars": list(rows[0])}, "results": {"bindings": rows}}
    _, items, _ = written(tmp_path / "sparql.json", json.dumps(answer))
    assert [(item.title, item.object_name, item.height_m) for item in items.values()] == [
        ("Venus de Milo", "statue", pytest.approx(2.04)),
        ("Winged Victory of Samothrace", "statue", pytest.approx(5.57)),
        ("Mona Lisa", "painting", pytest.approx(0.77)),
    ]


TABLE = {"number": ["A 1", "A 2"], "name": ["Vase", "Chair"], "height_cm": [30, 92], "room": ["Hall", "Hall"]}


@pytest.mark.parametrize(
    "value",
    [
        {key: {"name": n, "height_cm": h, "room": r} for key, n, h, r in zip(*TABLE.values(), strict=True)},
        {"items": {key: {"name": n, "height_cm": h} for key, n, h, _ in zip(*TABLE.values(), strict=True)}},
        {"columns": list(TABLE), "data": [list(row) for row in zip(*TABLE.values(), strict=True)]},
        TABLE,
    ],
    ids=["keyed", "keyed within", "names and cells", "a list for each name"],
)
def test_objects_in_json_stand_in_several_ways(value: object, tmp_path: Path) -> None:
    found, items, _ = written(tmp_path / "a.json", json.dumps(value))
    assert [(number, item.height_m) for number, item in items.items()] == [("A 1", 0.3), ("A 2", 0.92)]
    assert any("stand" in said for said in found.sure)


def test_an_object_with_sizes_by_their_names_is_not_keyed(tmp_path: Path) -> None:
    """What stands behind "height" is no object."""
    sizes = {"height": {"value": "12", "unit": "cm"}, "width": {"value": "7", "unit": "cm"}}
    found, _, _ = written(tmp_path / "a.json", json.dumps([{"number": "A 1", "name": "Vase", "size": sizes}]))
    assert getattr(found.mapping.source, "layout", "") == "objects"


# ---------------------------------------------------------------------------------------------------------------------
# Texts and tables


CARDS = """Museum list, 2024

N° INV : D.1
APPELLATION : Pot
LOCALISATION : Salle 3
DIMENSIONS (cm) : H. 19,5 ; D. 12,4
DESCRIPTION : Pot à surprise,
 à deux anses

N° INV : D.2
APPELLATION : Coffre
LOCALISATION : Réserve A
DIMENSIONS (cm) : H. 60 ; L. 110 ; P. 52
"""


def test_records_of_labelled_lines_are_read(tmp_path: Path) -> None:
    found, items, result = written(tmp_path / "cards.txt", CARDS)
    assert found.mapping.source.format == "cards"
    assert sides(items["D.1"]) == pytest.approx([0.195, 0.124, 0.124])
    assert sides(items["D.2"]) == pytest.approx([0.60, 1.10, 0.52])
    assert items["D.2"].on_display is False
    assert result.rejected == ()


def test_a_printed_list_has_its_cells_below_each_other_and_its_head_on_each_page(tmp_path: Path) -> None:
    head = "Nr.     Objekt            Höhe cm  Standort\n------- ----------------- -------- --------\n"
    first = "A 1     Vase mit Deckel   38,5     Saal 2\n"
    second = "A 2     Truhe             52       Depot 1\n"
    found, items, _ = written(tmp_path / "list.txt", head + first + "\f\n" + head + second)
    assert found.mapping.source.format == "fixed"
    assert [(number, item.height_m, item.on_display) for number, item in items.items()] == [
        ("A 1", 0.385, True),
        ("A 2", 0.52, False),
    ]


FORM = (("N. inventario", "Oggetto", "Altezza (cm)", "Collocazione"), ("M 1", "Anfora", 42.5, "Sala I"),
        ("M 2", "Busto", 71, "Deposito 2"))  # fmt: skip


@pytest.mark.parametrize("titled", [False, True])
def test_objects_that_stand_side_by_side_are_turned(titled: bool, tmp_path: Path) -> None:
    book = Workbook()
    sheet = book.active
    assert sheet is not None
    if titled:
        sheet.append(["Schede della mostra"])
    for row in zip(*FORM, strict=True):
        sheet.append(row)
    book.save(tmp_path / "schede.xlsx")
    found, items, _ = read(tmp_path / "schede.xlsx")
    assert any("side by side" in said for said in found.sure)
    assert [(number, item.height_m, item.on_display) for number, item in items.items()] == [
        ("M 1", 0.425, True),
        ("M 2", 0.71, False),
    ]


def test_a_form_on_each_sheet_is_an_object(tmp_path: Path) -> None:
    book = Workbook()
    for number, *cells in FORM[1:]:
        sheet = book.create_sheet(str(number))
        for row in zip(FORM[0], (number, *cells), strict=True):
            sheet.append(row)
    book.remove(book.worksheets[0])
    book.save(tmp_path / "forms.xlsx")
    _, items, _ = read(tmp_path / "forms.xlsx")
    assert {number: item.height_m for number, item in items.items()} == {"M 1": 0.425, "M 2": 0.71}


def test_numbered_columns_have_a_measurement_each(tmp_path: Path) -> None:
    names = ",".join(f"Measurement {at} {what}" for at in (1, 2, 3) for what in ("Part", "Type", "Value", "Unit"))
    found, items, _ = written(
        tmp_path / "vernon.csv",
        f"Accession No,Object Name,{names},Location\n"
        "G 1,Teapot,overall,height,142,mm,overall,width,19.8,cm,overall,weight,620,g,Hall\n"
        "G 2,Clock,overall,height,2240,mm,overall,width,510,mm,dial,height,420,mm,Hall\n",
    )
    assert (items["G 1"].height_m, items["G 1"].width_m, items["G 1"].mass_kg) == pytest.approx((0.142, 0.198, 0.62))
    assert (items["G 2"].height_m, items["G 2"].width_m) == pytest.approx((2.24, 0.51)), "the dial is a part"
    assert any("numbered columns" in said for said in found.sure)


def test_an_archive_of_darwin_core_is_joined(tmp_path: Path) -> None:
    (tmp_path / "meta.xml").write_text('<archive xmlns="http://rs.tdwg.org/dwc/text/"/>', encoding="utf-8")
    names = ("M.12\tmounted skin\tHall of Mammals", "M.13\tmounted skin\tHall of Birds", "M.14\tskull\tHall of Birds")
    rows = "".join(f"{at}\t{row}\n" for at, row in enumerate(names, start=1))
    (tmp_path / "occurrence.txt").write_text("id\tcatalogNumber\tpreparations\tlocationRemarks\n" + rows)
    sizes = "".join(
        f"{at}\tm{at}-{kind}\t{kind}\t{10 * at + 4}\tcm\n" for at in (1, 2, 3) for kind in ("height", "width")
    )
    heads = "id\tmeasurementID\tmeasurementType\tmeasurementValue\tmeasurementUnit\n"
    (tmp_path / "measurementorfact.txt").write_text(heads + sizes)
    _, items, _ = read(tmp_path)
    assert [(n, item.height_m, item.gallery) for n, item in items.items()] == [
        ("M.12", pytest.approx(0.14), "Hall of Mammals"),
        ("M.13", pytest.approx(0.24), "Hall of Birds"),
        ("M.14", pytest.approx(0.34), "Hall of Birds"),
    ]


def test_what_left_the_museum_is_not_on_display(tmp_path: Path) -> None:
    lines = ("1,Bust,Hall,", "2,Vase,Hall,", "3,Statue,Hall,destroyed", "4,Chair,Hall,", "5,Statue,Hall,transfer")
    text = "\n".join(("Number,Object name,Room,Disposal method", *lines))
    found, items, _ = written(tmp_path / "list.csv", text)
    assert [item.on_display for item in items.values()] == [True, True, False, True, False]
    assert any("there no more" in doubt for doubt in found.doubts)


# ---------------------------------------------------------------------------------------------------------------------
# Cells


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Max. Height x Max. Width x Max. Depth : 34 x 170 x 32 cm", (0.34, 1.70, 0.32)),
        ("(: Max. Height x Max. Width x Max. Depth : 3' x 18' 2&quot; x 3' 2&quot;)", (0.9144, 5.5372, 0.9652)),
        ("(height: overall height 81&quot; bust height 28&quot;)", (2.0574, None, None)),
        ("Maximum width x maximum height: 12 x 13 cm", (0.13, 0.12, None)),
    ],
)
def test_legends_that_qualify_each_side_are_read_in_their_order(text: str, expected: tuple[float | None, ...]) -> None:
    """Depth, height and width were read of the first, each of another's number."""
    chosen = choose(parse(plain_text(text)))
    assert [one and one.value for one in (chosen.height, chosen.width, chosen.depth)] == pytest.approx(list(expected))


@pytest.mark.parametrize(
    ("text", "said"), [("V&amp;A loan", "V&A loan"), ("R&D; &unknown; AT&T", "R&D; &unknown; AT&T")]
)
def test_signs_written_as_web_pages_write_them_are_signs(text: str, said: str) -> None:
    assert words_of(text) == said
