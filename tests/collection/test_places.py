"""A place that names a case besides its room: where it ends, what stands in it, and that a mapping must say so."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.errors import MappingError
from pipeline.collection.guess import guess
from pipeline.collection.mapping import load_mapping
from pipeline.collection.places import located, parted
from pipeline.collection.reading import read_items
from pipeline.records import Furniture, Item, Origin, Support


@pytest.mark.parametrize(
    ("place", "room", "case"),
    [("Gallery 1, case 3", "Gallery 1", "case 3"), ("Gallery 12 Case 3", "Gallery 12", "Case 3"),
     ("Sál 1, vitrína 2", "Sál 1", "vitrína 2"), ("Αίθουσα 5, προθήκη 2", "Αίθουσα 5", "προθήκη 2"),
     ("Sala 3, vetrina 1", "Sala 3", "vetrina 1"), ("Gallery 6, shelf", "Gallery 6", "shelf"),
     ("Gallery 6, left case", "Gallery 6", "left case"), ("Großer Saal, Vitrine III", "Großer Saal", "Vitrine III"),
     ("Salle 3 > Vitrine 12 > étagère 2", "Salle 3", "Vitrine 12 > étagère 2"), ("第2展厅展柜3", "第2展厅", "展柜3"),
     ("British Galleries, Room 58, Case 3", "British Galleries, Room 58", "Case 3"),
     ("Case 3, Gallery 1", "Gallery 1", "Case 3"), ("Salle 3, vit. 2, tabl. 4", "Salle 3", "vit. 2, tabl. 4"),
     ("P.T. sala 2, vetr. B, ripiano 3", "P.T. sala 2", "vetr. B, ripiano 3"), ("sala 4, gabl. 2", "sala 4", "gabl. 2"),
     ("Room 4, case 2 (wall case), shelf 3", "Room 4", "case 2 (wall case), shelf 3"),
     ("2. terem, 3. vitrin", "2. terem", "3. vitrin"), ("Gallery 1 (case 3)", "Gallery 1", "case 3"),
     ("Museum coach, case F upper shelf", "Museum coach", "case F upper shelf"),
     ("Rm 4 CC2 (centre case)", "Rm 4", "CC2 (centre case)"), ("G/F Rm 2, S/C 4 sh 2", "G/F Rm 2", "S/C 4 sh 2"),
     ("Gallery 12 Case 3 Shelf 2", "Gallery 12", "Case 3 Shelf 2"), ("magazyn, regał 7", "magazyn", "regał 7"),
     ("2F常設展示室 ケース3 中段", "2F常設展示室", "ケース3 中段"), ("收蔵庫A 棚3-2", "收蔵庫A", "棚3-2"),
     ("常設展示室 独立ケース1", "常設展示室", "独立ケース1"), ("1층 서화실 벽부장", "1층 서화실", "벽부장"),
     ("Gallery 207 - Display case A", "Gallery 207", "Display case A"), ("Vitrine 3", "Vitrine 3", "Vitrine 3"),
     ("Fossil room Case 2", "Fossil room", "Case 2"), ("Wing B Case 4", "Wing B", "Case 4"),
     ("Rittersaal Vitrine 4", "Rittersaal", "Vitrine 4"), ("Sala romana vetrina 3", "Sala romana", "vetrina 3"),
     ("Wall case 3", "Wall case 3", "Wall case 3"), ("Sala 2 / Vit. 3", "Sala 2", "Vit. 3"),
     ("G69/dc13", "G69", "dc13"), ("On display (G12/dc3)", "G12", "dc3"),
     ("On view at: Gallery 109, case 4", "Gallery 109", "case 4")],
)  # fmt: skip
def test_a_room_and_its_case(place: str, room: str, case: str) -> None:
    assert parted(place) == (room, case, "")


@pytest.mark.parametrize(
    "place",
    ["", "Gallery 1", "Staircase", "Case Study House", "Bookcase Room", "The Shelf", "The Showcase", "Vitrine Gallery",
     "Pedestal Hall", "Cabinet 3", "Kabinett 12", "Second floor", "Ground Floor", "On display",
     "Gallery 2, by the window", "Casement Hall, south",
     "Gallery 5 North", "Gallery 3 – The Plinth Room", "1. OG, Raum 2", "Studio 5. terem",
     "Main Hall (east)"],
)  # fmt: skip
def test_a_room_alone(place: str) -> None:
    assert parted(place) == (place, "", "")


@pytest.mark.parametrize(
    ("place", "room", "displayed"),
    [("Engine Hall, suspended from ceiling", "Engine Hall", "suspended from ceiling"),
     ("Saal 4, an der Wand", "Saal 4", "an der Wand"), ("Gallery 2 - on floor", "Gallery 2", "on floor"),
     ("Atrium; hung overhead", "Atrium", "hung overhead"), ("Main Hall (suspended)", "Main Hall", "suspended"),
     ("Näyttely 3 (ripustettu kattoon)", "Näyttely 3", "ripustettu kattoon"),
     ("Зал 2, подвешен к потолку", "Зал 2", "подвешен к потолку"),
     ("Sala 4, pod sufitem", "Sala 4", "pod sufitem"), ("Rum 2, hängande i taket", "Rum 2", "hängande i taket"),
     ("On display (G24/od)", "G24", "od"), ("Sculpture, room 21, case FS", "Sculpture, room 21", "case FS"),
     ("Salle 348 - Salle des Verres, Hors vitrine", "Salle 348 - Salle des Verres", "Hors vitrine"),
     ("Room 5, not in a case", "Room 5", "not in a case"), ("Library floor", "Library", "floor"),
     ("Level 4, Passports, open display", "Level 4, Passports", "open display"),
     # Of plinths without a number a room has several, which share nothing.
     ("Grosvenor Gallery: plinth", "Grosvenor Gallery", "plinth"), ("Zaal 1.02, sokkel", "Zaal 1.02", "sokkel"),
     ("sala 6, ściana płn.", "sala 6", "ściana płn."), ("1Fロビー 壁面", "1Fロビー", "壁面"),
     ("Udst., rum 3, fritstående", "Udst., rum 3", "fritstående"), ("Rm 2 N wall", "Rm 2", "N wall"),
     ("Rm 5, on stone plinth (90cm), dowel into plinth", "Rm 5", "on stone plinth (90cm), dowel into plinth"),
     ("Sala I - panel 3 (colgado)", "Sala I", "panel 3, colgado"), ("Rm 2 centre", "Rm 2", "centre")],
)  # fmt: skip
def test_a_room_and_how_a_thing_is_held_there(place: str, room: str, displayed: str) -> None:
    assert parted(place) == (room, "", displayed)


@pytest.mark.parametrize(
    ("place", "where"),
    [("Currently on view at: Getty Villa, Gallery 109", "Getty Villa, Gallery 109"), ("On display: Hall 3", "Hall 3"),
     ("On display (G12/dc3)", "G12/dc3"), ("Gallery 4: Greek vases", "Gallery 4: Greek vases"),
     ("Gallery 4 (east)", "Gallery 4 (east)"), ("On display", "On display")],
)  # fmt: skip
def test_that_a_thing_is_on_display_is_no_part_of_its_place(place: str, where: str) -> None:
    assert located(place) == where


@pytest.mark.parametrize(
    ("case", "furniture"),
    [("FS", Furniture.FLOOR), ("EXP", Furniture.FLOOR), ("WN", Furniture.FLOOR), ("31", Furniture.SHOWCASE)],
)
def test_cases_that_are_none(tmp_path: Path, case: str, furniture: Furniture) -> None:
    path = tmp_path / "list.csv"
    rows = "".join(f"{n},statue,marble,H 190 x W 60 x D 50 cm,Room 50a,{case}\n" for n in (1, 2, 3))
    path.write_text(f"number,object,material,size,room,case\n{rows}", encoding="utf-8")
    items = read_items(path, guess(path).mapping).items
    assert {item.case for item in items} == {"" if furniture is Furniture.FLOOR else "31"}
    assert {classify(item).furniture for item in items} == {furniture}


@pytest.mark.parametrize(
    ("name", "height_m", "furniture"),
    [("commode", 0.87, Furniture.FLOOR), ("vase", 0.4, Furniture.PEDESTAL), ("statue", 1.9, Furniture.FLOOR)],
)
@pytest.mark.parametrize("displayed", ["Hors vitrine", "case FS", "open display", "außerhalb der Vitrine"])
def test_what_is_in_no_case_stands_in_none(name: str, height_m: float, furniture: Furniture, displayed: str) -> None:
    item = Item(object_number="1", gallery="Salle 1", object_name=name, height_m=height_m, displayed=displayed)
    scene = classify(item)
    assert (scene.support, scene.furniture) == (Support.FREESTANDING, furniture)


def test_how_a_thing_is_held_in_a_case_is_no_part_of_its_name() -> None:
    """Each thing of a case had a case of its own."""
    found = [parted(f"Rm 4, case 2, {how}") for how in ("on perspex mount", "loose", "hung from nylon line")]
    assert {place.case for place in found} == {"case 2"}
    assert [place.displayed for place in found] == ["on perspex mount", "loose", "hung from nylon line"]


EXPORT = """number,object,material,size,location
1,vase,porcelain,H 30 x W 15 x D 15 cm,"Gallery 1, case 3"
2,vase,porcelain,H 30 x W 15 x D 15 cm,"Gallery 1, shelf 2"
3,bust,marble,H 60 x W 40 x D 30 cm,"Gallery 1, plinth 4"
4,bust,marble,H 60 x W 40 x D 30 cm,Gallery 1
5,vase,porcelain,H 30 x W 15 x D 15 cm,"Store 2, shelf 14"
6,glider,wood,H 60 x W 300 x D 200 cm,"Gallery 2, suspended from the ceiling"
"""


def test_the_guess_says_so_and_what_stands_there_stands_in_it(tmp_path: Path) -> None:
    export, mapping = tmp_path / "export.csv", tmp_path / "mapping.toml"
    export.write_text(EXPORT, encoding="utf-8")
    told = guess(export)
    assert any("'Gallery 1, case 3' the gallery is 'Gallery 1', the rest 'case 3'" in line for line in told.sure)
    mapping.write_text(told.text, encoding="utf-8")
    items = {item.object_number: item for item in read_items(export, load_mapping(mapping)).items}
    assert [(items[n].gallery, items[n].case) for n in "12345"] == [
        ("Gallery 1", "case 3"),
        ("Gallery 1", "shelf 2"),
        ("Gallery 1", "plinth 4"),
        ("Gallery 1", ""),
        ("Store 2", "shelf 14"),
    ]
    assert (items["6"].gallery, items["6"].case, items["6"].displayed) == (
        "Gallery 2",
        "",
        "suspended from the ceiling",
    )
    assert classify(items["6"]).support is Support.SUSPENDED  # fmt: skip
    # A store is told by the whole place.
    assert [items[n].on_display for n in "12345"] == [True, True, True, True, False]
    found = [classify(items[n]) for n in "1234"]
    assert [scene.furniture for scene in found[:3]] == [Furniture.SHOWCASE, Furniture.SHELF, Furniture.PEDESTAL]
    assert [scene.furniture_origin for scene in found] == [Origin.DERIVED] * 3 + [Origin.ASSUMED]
    whole = guess(export, choices={"case": "-"})
    assert "cases" not in whole.text


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [("cases = true", 'cases = true\n[columns.case]\ncolumn = "object"', "leave one out"),
     ("cases = true", '[columns.title]\ncolumn = "object"\ncases = true', "for the column of the gallery")],
)  # fmt: skip
def test_a_mapping_that_contradicts_itself_is_refused(tmp_path: Path, before: str, after: str, words: str) -> None:
    export, mapping = tmp_path / "export.csv", tmp_path / "mapping.toml"
    export.write_text(EXPORT, encoding="utf-8")
    mapping.write_text(guess(export).text.replace(before, after), encoding="utf-8")
    with pytest.raises(MappingError, match=words):
        load_mapping(mapping)
