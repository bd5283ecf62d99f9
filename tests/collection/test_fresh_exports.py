"""Fourteen exports of museums that nobody had seen, by the guess alone, and what they brought to light.

Truth: tests/data/collections/fresh_exports/truth.csv, written before any file was read (README.md there).
"""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.collection.dimensions import choose, parse
from pipeline.collection.display_words import flag_of, says_away
from pipeline.collection.guess import Guess
from pipeline.collection.guessing.names import unit_in
from pipeline.collection.mapping import Mapping
from pipeline.collection.reading import read_items
from pipeline.errors import InputError
from pipeline.night.importing import proposed
from pipeline.records import Item
from tests.soak import SOAK

from .first_sight import ASKED, right, seen

REACHED = {
    "learn": {"height": 133, "plan": 96, "kind": 140, "manner": 150, "shown": 109, "mass": 3},
    "held": {"height": 114, "plan": 44, "kind": 132, "manner": 138, "shown": 108, "mass": 6},
}
"""Rows right, of 134, 98, 165, 165, 109, 3 and of 115, 46, 151, 151, 110, 6, as reached; less is a loss."""
SURE_AND_WRONG = {"learn": 3, "held": 0}


@pytest.mark.long("collection/test_third_exports::test_layouts_that_nobody_had_tried_are_read_by_the_guess_alone")
@pytest.mark.parametrize("part", [part for part in REACHED if SOAK or part == "held"])
def test_fresh_exports_are_read_by_the_guess_alone(part: str) -> None:
    """No height is wrong unsaid, and hardly a class that is said to be 90 % sure."""
    rows = seen("fresh_exports", part)
    assert {what: right(rows, what)[0] >= REACHED[part][what] for what in ASKED} == dict.fromkeys(ASKED, True)
    assert [row.mark for row in rows if row.height is False and not row.said] == []
    assert sum(row.sure_and_wrong for row in rows) <= SURE_AND_WRONG[part]


def written(tmp_path: Path, *lines: str) -> tuple[Guess, dict[str, Item]]:
    """Return what is guessed of a file, and what is read by it."""
    path = tmp_path / "list.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    found = proposed(str(path)).guess
    return found, {item.object_number: item for item in read_items(path, found.mapping).items}


@pytest.mark.parametrize(
    ("name", "rest", "unit"),
    [
        ("Размер (см)", "Размер", "cm"),
        ("Вес, кг", "Вес", "kg"),
        ("高度（厘米）", "高度", "cm"),
        ("Διαστάσεις (εκ.)", "Διαστάσεις", "cm"),
        ("Место", "Место", None),
    ],
)
def test_units_in_heads_are_those_of_other_letters_too(name: str, rest: str, unit: str | None) -> None:
    assert unit_in(name) == (rest, unit)


def test_decimal_commas_of_sizes_without_units_are_decimals(tmp_path: Path) -> None:
    sizes = ("42,5х24,0х20,0", "61,0х38,5х18,0", "98,0х66,0х61,0")
    lines = [f"КП-{at};Ваза;{size}" for at, size in enumerate(sizes)]
    _, items = written(tmp_path, "№ по КП;Наименование;Размер (см)", *lines)
    assert [item.height_m for item in items.values()] == pytest.approx([0.425, 0.61, 0.98])


@pytest.mark.parametrize(("text", "sides"), [("kork. 112 cm, lev. 61 cm, syv. 84 cm", (1.12, 0.61, 0.84))])
def test_words_cut_short_name_their_side(text: str, sides: tuple[float, ...]) -> None:
    chosen = choose(parse(text))
    assert [one and one.value for one in (chosen.height, chosen.width, chosen.depth)] == pytest.approx(sides)


def test_a_number_in_a_sentence_measures_only_what_is_named() -> None:
    text = "Stuhl, 1765 gekauft, einer von 12; H 92 B 45"
    assert [part.value for part in parse(text, default_unit="cm", prose=True).parts] == pytest.approx([0.92, 0.45])
    assert 17.65 in [part.value for part in parse("Wann: 1765", default_unit="cm").parts]
    assert parse("Wann: 1765", default_unit="cm", prose=True).parts == ()


def test_sizes_in_sentences_are_read_where_no_column_tells_any(tmp_path: Path) -> None:
    told = [f"{at},Chaise,Chaise paillée.,H. {80 + at} cm ; L. 40 cm ; P. 38 cm" for at in range(6)]
    alone = [f"{at},Baratte,Baratte de 18{at}. H {90 + at} L 24 P 24.," for at in range(10, 14)]
    both = "20,Coffre,Coffre et sa clé. H 5 L 2 P 1.,H. 60 cm ; L. 110 cm ; P. 52 cm"
    found, items = written(tmp_path, "identifiant,titre,description,mesures", *told, *alone, both)
    assert found.mapping.dimensions is not None
    assert found.mapping.dimensions.prose == ("description",)
    assert [items[str(at)].height_m for at in range(10, 14)] == pytest.approx([1.0, 1.01, 1.02, 1.03])
    assert items["20"].height_m == pytest.approx(0.6)
    assert any("sentences of 'description' alone" in doubt for doubt in found.doubts)


def test_columns_of_sentences_are_some_of_the_columns() -> None:
    section = {"columns": ["a"], "prose": ["b"]}
    with pytest.raises((InputError, ValueError), match="prose names 'b'"):
        Mapping.model_validate(
            {
                "source": {"format": "csv"},
                "museum": {"name": "M"},
                "columns": {"object_number": {"column": "n"}, "gallery": {"column": "g"}},
                "dimensions": section,
            }
        )


PARTS = (
    "Cat Number,Object Name,Materials,Part,Height (cm),Width (cm),Depth (cm),Location",
    "A 1,Clock,oak,Overall,210,50,25,Hall",
    "A 1,Clock,oak,Dial,30,30,,Hall",
    "A 2,Teapot,silver,Teapot,15,22,11,Hall",
    "A 2,Teapot,silver,Lid,4,7,7,Hall",
    "A 3,Chair,beech,Overall,92,45,48,Hall",
    "A 4,Painting,oil on canvas,Canvas,60,50,,Hall",
    "A 4,Painting,oil on canvas,Frame,75,65,6,Hall",
    "A 5,Boots,leather,Left,30,28,10,Hall",
    "A 5,Boots,leather,Right,31,28,10,Hall",
)


def test_rows_of_parts_are_gathered_and_the_object_itself_counts(tmp_path: Path) -> None:
    found, items = written(tmp_path, *PARTS)
    sides = {number: (item.height_m, item.width_m, item.depth_m) for number, item in items.items()}
    assert sides["A 1"] == pytest.approx((2.1, 0.5, 0.25))
    assert sides["A 2"] == pytest.approx((0.15, 0.22, 0.11)), "the part that is called as the object is"
    assert sides["A 3"] == pytest.approx((0.92, 0.45, 0.48))
    assert sides["A 4"] == pytest.approx((0.75, 0.65, 0.06)), "the frame hangs"
    assert items["A 5"].problems, "of which boot the size is, is said"
    assert any("each part of an object has a row of its own" in said for said in found.sure)


def test_sides_of_parts_in_two_units_are_one(tmp_path: Path) -> None:
    _, items = written(
        tmp_path,
        "HeightCM,HeightIN,WidthCM,WidthIN,DepthCM,DepthIN,Element,objectnumber",
        "25.4,10,50.8,20,0,0,overall,X.1",
        "50.8,20,76.2,30,5.08,2,frame,X.1",
        "127,50,101.6,40,0,0,sheet,X.2",
        "152.4,60,127,50,2.54,1,frame,X.2",
        "30.48,12,20.32,8,10.16,4,overall,X.3",
    )
    sides = [(item.height_m, item.width_m, item.depth_m) for item in items.values()]
    assert sides == [
        pytest.approx(one) for one in ((0.508, 0.762, 0.0508), (1.524, 1.27, 0.0254), (0.3048, 0.2032, 0.1016))
    ]


def test_rows_of_several_things_with_one_number_are_no_parts(tmp_path: Path) -> None:
    lines = [line.replace(",Part,", ",Title,") for line in PARTS]
    found, items = written(tmp_path, *lines)
    assert any("repeats 4 object numbers" in doubt for doubt in found.doubts)
    assert items["A 1"].height_m == pytest.approx(2.1)


@pytest.mark.parametrize(
    ("text", "flag"),
    [("展出中", True), ("未展出", False), ("庫房", False), ("kyllä", True), ("ei", False), ("維修", None)],
)
def test_flags_are_known_in_both_kinds_of_chinese_signs(text: str, flag: bool | None) -> None:
    assert flag_of(text, display=True) is flag


@pytest.mark.parametrize("place", ["庫房 3 櫃", "Varasto B, hylly 12", "Kangasvarasto, rulla 14"])
def test_stores_are_known(place: str) -> None:
    assert says_away(place)


def test_a_place_is_known_by_what_its_column_holds(tmp_path: Path) -> None:
    places = ("Salle 1", "Salle 2 - vitrine 1", "Réserve - carton 3", "Salle 1", "Cour", "Réserve - carton 3")
    lines = [f"{at},Vase,H. 20 cm,{place}" for at, place in enumerate(places)]
    found, items = written(tmp_path, "identifiant,titre,mesures,dcterms:spatial", *lines)
    assert items["1"].gallery == "Salle 2"
    assert [item.on_display for item in items.values()] == [True, True, False, True, True, False]
    assert any("by what it holds" in doubt for doubt in found.doubts)


def test_a_flag_in_unknown_words_is_asked_about(tmp_path: Path) -> None:
    rows = [f"{at},Vase,Room {at % 4},{'zwq' if at % 4 else 'bxr'}" for at in range(12)]
    found, _ = written(tmp_path, "number,title,location,Xyz", *rows)
    (asked,) = [question for question in found.questions if question.key == "on_display"]
    assert "'Xyz' ('bxr', 'zwq')" in asked.text
    assert asked.taken == "-"
    scattered = [row.replace("zwq", "bxr" if at % 3 else "zwq") for at, row in enumerate(rows)]
    found, _ = written(tmp_path, "number,title,location,Xyz", *scattered)
    assert [question for question in found.questions if question.key == "on_display"] == []


def test_the_first_sentence_of_a_description_is_the_title_of_what_has_none(tmp_path: Path) -> None:
    lines = [f"HM {at};Ur;Moraklocka. Verk av AAS;H {200 + at} cm" for at in range(4)]
    found, items = written(tmp_path, "Inventarienr;Sakord;Beskrivning;Mått", *lines)
    assert items["HM 0"].title == "Moraklocka"
    assert any("no column is a title" in doubt for doubt in found.doubts)


def test_a_name_stands_behind_its_label_in_a_text_of_several_fields(tmp_path: Path) -> None:
    lines = [
        f'{at},"Inventarnummer: 10{at} Titel: Runde Platte Beschreibung: Mit Blumen. Maße: Höhe: 5,{at} cm Wann: 1770"'
        for at in range(1, 7)
    ]
    _, items = written(tmp_path, "ID,DESCRIPTION", *lines)
    assert items["1"].object_name == "Runde Platte"
    assert [item.height_m for item in items.values()] == pytest.approx([0.051 + 0.001 * at for at in range(6)])
