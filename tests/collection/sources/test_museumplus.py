"""A MuseumPlus RIA export gives the columns of objects; the file is made by hand after the service's own answers."""

from __future__ import annotations

import io

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.collection.sources.measurements import COLUMNS
from pipeline.collection.sources.museumplus import read_museumplus

HEAD = '<application xmlns="http://www.zetcom.com/ria/ws/module"><modules><module name="Object" totalSize="1">'
TAIL = "</module></modules></application>"


def voc(name: str, word: str) -> str:
    return (
        f'<vocabularyReference name="{name}"><vocabularyReferenceItem id="1" name="x">'
        f'<formattedValue language="de">{word}</formattedValue></vocabularyReferenceItem></vocabularyReference>'
    )


def field(name: str, value: str, kind: str = "dataField") -> str:
    return f'<{kind} name="{name}"><value>{value}</value></{kind}>'


def group(name: str, *items: str) -> str:
    inner = "".join(f"<repeatableGroupItem>{item}</repeatableGroupItem>" for item in items)
    return f'<repeatableGroup name="{name}">{inner}</repeatableGroup>'


ITEM = (
    '<moduleItem id="1001">'
    + field("ObjObjectNumberTxt", "I C 192")
    + field("ObjTechnicalTermClb", "Standfigur")
    + group(
        "ObjObjectTitleGrp",
        field("SortLnu", "2") + field("TitleTxt", "Nebentitel"),
        field("SortLnu", "1") + field("TitleTxt", "Figur"),
    )
    + group("ObjMaterialTechniqueGrp", field("ExportClb", "Bronze, gegossen"))
    + field("ObjCurrentLocationVrt", " -&gt; Saal 3", "virtualField")
    + group(
        "ObjDimAllGrp",
        field("SortLnu", "1") + voc("TypeDimRef", "Höhe x Breite x Tiefe") + field("HeightNum", "25.2000")
        + field("WidthNum", "16.7") + field("DepthNum", "9") + voc("UnitDdiVoc", "cm"),
        field("SortLnu", "2") + voc("TypeDimRef", "Sockelmaß") + field("HeightNum", "4") + voc("UnitDdiVoc", "cm"),
        field("SortLnu", "3") + voc("TypeDimRef", "Transportkiste") + field("HeightNum", "90")
        + voc("UnitDdiVoc", "cm"),
        field("SortLnu", "4") + field("WeightNum", "3.5") + voc("UnitWeightVoc", "kg"),
    )
    + "</moduleItem>"
)  # fmt: skip


def test_an_object_with_its_groups() -> None:
    _, row = read_museumplus(io.BytesIO(f"{HEAD}{ITEM}{TAIL}".encode()), "ria.xml")
    assert {name: cell for name, cell in zip(COLUMNS, row.cells, strict=True) if cell} == {
        "object_number": "I C 192",
        "record_id": "1001",
        "title": "Figur; Nebentitel",
        "object_name": "Standfigur",
        "medium": "Bronze, gegossen",
        "gallery": "Saal 3",
        "height": "25.2 cm",
        "width": "16.7 cm",
        "depth": "9 cm",
        "weight": "3.5 kg",
        "base height": "4 cm",
        "other_measurements": "Transportkiste height: 90 cm",
        "measurements_in_words": "height: 25.2 cm; width: 16.7 cm; depth: 9 cm; "
        "Transportkiste height: 90 cm; weight: 3.5 kg",
    }
    assert not row.faults


@pytest.mark.parametrize("kind", [voc("TypeDimRefVoc", "{}"), field("PreviewVrt", "{}", "virtualField")])
def test_a_frame_measured_beside_the_work_is_not_the_work(kind: str) -> None:
    """Whether a vocabulary of another name or only the preview says which is which."""
    work, frame = kind.format("Objektmass"), kind.format("Rahmenmass")
    sizes = group(
        "ObjDimAllGrp",
        work + field("HeightNum", "78.5") + field("WidthNum", "114.9") + voc("UnitDdiVoc", "cm"),
        frame + field("HeightNum", "93.5") + field("WidthNum", "129.9") + voc("UnitDdiVoc", "cm"),
    )
    item = f'<moduleItem id="7">{field("ObjObjectNumberTxt", "LM-7")}{sizes}</moduleItem>'
    header, row = read_museumplus(io.BytesIO(f"{HEAD}{item}{TAIL}".encode()), "ria.xml")
    said = dict(zip(header.cells, row.cells, strict=True))
    assert (said["height"], said["width"], row.faults) == ("78.5 cm", "114.9 cm", {})


def test_the_preset_makes_an_item_of_it(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("ria") / "export.xml"
    path.write_text(f"{HEAD}{ITEM}{TAIL}", encoding="utf-8")
    (item,) = read_items(path, load_mapping("museumplus_ria")).items
    assert (item.object_number, item.gallery, item.height_m, item.mass_kg) == ("I C 192", "Saal 3", 0.252, 3.5)
    assert item.problems == ()


def test_other_modules_are_no_objects() -> None:
    content = f"{HEAD}{ITEM}{TAIL}".replace('name="Object"', 'name="Person"').encode()
    assert len(list(read_museumplus(io.BytesIO(content), "ria.xml"))) == 1
    with pytest.raises(CollectionError, match="holds no moduleItem"):
        list(read_museumplus(io.BytesIO(b"<application/>"), "ria.xml"))


@pytest.mark.parametrize(
    ("kind", "numbers", "found"),
    [
        ("Höhe x Breite x Tiefe", ("25.2", "16.7", "9"), {"height": "25.2 cm", "width": "16.7 cm", "depth": "9 cm"}),
        ("Objektmaß (Breite x Höhe)", ("16.7", "25.2"), {"height": "25.2 cm", "width": "16.7 cm"}),
        # Three numbers of which the order names two, or none, are nobody's: they are kept in words.
        ("Höhe x Breite", ("25.2", "16.7", "9"), {}),
        ("", ("25.2", "16.7"), {}),
        ("Rahmenmaß (Höhe x Breite)", ("40", "30"), {}),
    ],
)
def test_numbers_are_named_by_the_order_of_their_kind(
    kind: str, numbers: tuple[str, ...], found: dict[str, str]
) -> None:
    names = ("FirstNum", "SecondNum", "ThirdNum")
    told = "".join(field(name, number) for name, number in zip(names, numbers, strict=False))
    item = (
        '<moduleItem id="7">'
        + field("ObjObjectNumberTxt", "A 7")
        + group("ObjDimAllGrp", voc("TypeVoc", kind) + told + voc("UnitDdiVoc", "cm"))
        + "</moduleItem>"
    )
    head, row = read_museumplus(io.BytesIO(f"{HEAD}{item}{TAIL}".encode()), "ria.xml")
    cells = dict(zip(head.cells, row.cells, strict=True))
    assert {name: cells[name] for name in ("height", "width", "depth") if cells[name]} == found
    if not found:
        assert all(number in " ".join(map(str, row.cells)) for number in numbers)
