"""Real things as museums print them on their pages, in eight languages, from file to class by the guess alone.

Truth: tests/data/collections/public_pages/truth.csv, written before any row was read (README there).
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.records import Item
from pipeline.verification.class_scores import MANNER
from tests.soak import SOAK

FOLDER = Path(__file__).parents[1] / "data" / "collections"
PLAIN = re.compile(r"(its )?[\w ]+(, which lies in plan)?, of the object itself;")
"""How a note of a number begins that nothing more is said of."""
LONG = pytest.mark.long("test_things_of_150_more_tables")
NEAR = 0.006
UNFOUND = ("rmg_images", "gugong")
"""Of files of one and of two rows, whose sizes are taken for their numbers."""
REACHED = {"learn": (38, 53, 53), "held": (61, 70, 71)}
"""Heights, classes and manners of support right of 53 and 76 rows, as reached; less is a loss."""


def rows_of(part: str, pages: str = "public_pages") -> list[tuple[dict[str, str], Item]]:
    """Return the marks of a set's rows, each with the thing that is read."""
    with (FOLDER / pages / "truth.csv").open(encoding="utf-8", newline="") as stream:
        marks = [row for row in csv.DictReader(stream) if row["set"] == part]
    found = []
    for name in sorted({mark["file"] for mark in marks}):
        path = FOLDER / pages / part / f"{name}.csv"
        items = {item.object_number: item for item in read_items(path, proposed(str(path)).guess.mapping).items}
        with path.open(encoding="utf-8", newline="") as stream:
            # A mark has the first cell of its row; the number is taken from whichever column has one for each.
            cells = {row[0]: row for row in csv.reader(stream)}
        for mark in marks:
            if mark["file"] == name:
                number = mark["number"]
                able = (number, number.split(" ; ")[0], *cells[number])
                one = next((items[one] for one in able if one in items), None)
                assert one is not None or name in UNFOUND, (name, number)
                if one is not None:
                    found.append((mark, one))
    return found


def is_high(mark: dict[str, str], item: Item) -> bool:
    """Whether a height is one of those that were marked; "12?" is one that may also be left open with a word."""
    heights = [float(one) / 100 for one in re.split(r"[|?]", mark["height_cm"]) if one]
    if item.height_m is None:
        return "?" in mark["height_cm"] and is_said(item)
    return any(item.height_m == pytest.approx(one, rel=NEAR) for one in heights)


def is_said(item: Item) -> bool:
    """Whether anything is said of how a thing's numbers were read."""
    return bool(item.problems) or any(one.note and not PLAIN.match(one.note) for one in item.provenance)


@LONG
@pytest.mark.parametrize("part", [part for part in REACHED if SOAK or part == "held"])
def test_things_of_museums_pages_are_read_by_the_guess_alone(part: str) -> None:
    """Whatever is not as marked is said, and a class that is said to be 90 % sure is right."""
    rows = rows_of(part)
    sized = [(mark, item) for mark, item in rows if re.search(r"\d", mark["height_cm"])]
    wrong = [item for mark, item in sized if not is_high(mark, item)]
    heights, classes, manners = REACHED[part]
    assert len(sized) - len(wrong) >= heights, [(item.object_number, item.dimensions) for item in wrong]
    assert all(map(is_said, wrong))
    taken = [(mark["classes"].split("|"), classify(item)) for mark, item in rows]
    assert sum(scene.object_class in able for able, scene in taken) >= classes
    assert sum(MANNER[scene.object_class] in {MANNER[one] for one in able} for able, scene in taken) >= manners
    sure = [scene.object_class in able for able, scene in taken if scene.chances and scene.chances[0][1] >= 0.9]
    assert all(sure)
    assert all(item.on_display == (mark["display"] == "1") for mark, item in rows if mark["display"] != "-")


FRESH = {"learn": (63, 56, 60, 0), "held": (66, 61, 63, 2)}
"""Of 69 and 67 heights, 68 and 68 things: right, and at most so many wrong classes said to be 90 % sure."""
ASKED = "mexico"
"""Its columns tell no unit, which the guess asks of the file as a whole."""
ROUNDED = 0.0008
"""m; of inches and centimetres that a museum gives beside each other one is rounded."""


@LONG
@pytest.mark.parametrize("part", [part for part in FRESH if SOAK or part == "held"])
def test_things_of_forty_more_sites(part: str) -> None:
    rows = rows_of(part, "fresh_pages")
    heights, classes, manners, mistaken = FRESH[part]
    right, unsaid = [], []
    for mark, item in rows:
        if mark["height_cm"] == "*":
            continue
        able = [float(one) / 100 for one in re.split(r"[|?]", mark["height_cm"].strip("-")) if one]
        near = any(item.height_m == pytest.approx(one, rel=NEAR, abs=ROUNDED) for one in able)
        none = item.height_m is None and (("?" in mark["height_cm"] and is_said(item)) or mark["height_cm"] == "-")
        right.append(near or none)
        if not right[-1] and not is_said(item):
            unsaid.append(mark["file"])
    assert sum(right) >= heights
    assert set(unsaid) <= {ASKED}
    taken = [(mark["classes"].split("|"), classify(item)) for mark, item in rows if mark["classes"] != "*"]
    assert sum(scene.object_class in able for able, scene in taken) >= classes
    assert sum(MANNER[scene.object_class] in {MANNER[one] for one in able} for able, scene in taken) >= manners
    sure = [scene.object_class in able for able, scene in taken if scene.chances and scene.chances[0][1] >= 0.9]
    assert sure.count(False) <= mistaken
    assert all(item.on_display == (mark["display"] == "1") for mark, item in rows if mark["display"] in "01")


TABLES = {
    ("sixty_sites", "learn"): (76, 36, 76, 80, 0, 0),
    ("sixty_sites", "held"): (71, 39, 71, 77, 4, 0),
    ("more_museums", "learn"): (84, 27, 88, 90, 0, 2),
    ("more_museums", "held"): (85, 11, 89, 91, 3, 1),
}
"""Heights (of 80, 78, 86 and 91), plans (of 41, 44, 31 and 14), classes and manners of support (of 81, 81, 95 and 94)
right; heights unsaid and wrong classes that are said to be 90 % sure at the most."""
UNSAID = ("islenzkur", "raiz", "gugong", "sdtb", "victoria")
"""Sizes in a description that no column of sizes stands beside; metres in a column of centimetres."""


def is_plan(mark: dict[str, str], item: Item) -> bool:
    """Whether the sides in plan are those that were marked; of a round thing one is enough."""
    got = sorted(side for side in (item.width_m, item.depth_m) if side is not None)
    for able in mark["plan_cm"].split("|"):
        want = sorted(float(one) / 100 for one in able.split("x") if one)
        if len(got) == 1 and len(want) == 2 and want[0] == want[1]:
            want.pop()
        if got == pytest.approx(want, rel=NEAR, abs=ROUNDED):
            return True
    return False


@pytest.mark.parametrize(
    ("pages", "part"),
    [
        pytest.param(*table, marks=LONG) if table == ("sixty_sites", "held") else table
        for table in TABLES
        if SOAK or table[1] == "held"
    ],
)
def test_things_of_150_more_tables(pages: str, part: str) -> None:
    """What is said to be 90 % sure is right but for three things, and what is not as marked is said but for five."""
    rows = rows_of(part, pages)
    heights, plans, classes, manners, open_, mistaken = TABLES[pages, part]
    right, unsaid = 0, []
    for mark, item in rows:
        if mark["height_cm"] == "*":
            continue
        able = [float(one) / 100 for one in re.split(r"[|?]", mark["height_cm"].strip("-")) if one]
        near = any(item.height_m == pytest.approx(one, rel=NEAR, abs=ROUNDED) for one in able)
        none = item.height_m is None and (
            ("?" in mark["height_cm"] and is_said(item)) or mark["height_cm"].endswith("-")
        )
        right += near or none
        if not (near or none or is_said(item)):
            unsaid.append(mark["file"])
    assert right >= heights
    assert sum(is_plan(mark, item) for mark, item in rows if mark["plan_cm"] not in ("", "*")) >= plans
    assert len(unsaid) <= open_
    assert set(unsaid) <= set(UNSAID)
    taken = [
        ([*MANNER] if mark["classes"] == "*" else mark["classes"].split("|"), classify(item)) for mark, item in rows
    ]
    assert sum(scene.object_class in able for able, scene in taken) >= classes
    assert sum(MANNER[scene.object_class] in {MANNER[one] for one in able} for able, scene in taken) >= manners
    sure = [scene.object_class in able for able, scene in taken if scene.chances and scene.chances[0][1] >= 0.9]
    assert sure.count(False) <= mistaken
    assert all(item.on_display == (mark["display"] == "1") for mark, item in rows if mark["display"] in "01")


@LONG
def test_names_of_things_in_twelve_languages() -> None:
    """Of 3,879 names at least 94 % are taken for the class that was marked, and 95 % for its manner of support.

    That is 1.5 % below what is reached. Words were added to the table for the names that it had not known.
    """
    with (FOLDER / "names_of_things.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    right: Counter[str] = Counter()
    many = Counter(row["language"] for row in rows)
    manners = 0
    for row in rows:
        able = row["classes"].split("|")
        taken = classify(Item("1", "Room", object_name=row["name"])).object_class
        right[row["language"]] += taken in able
        manners += MANNER[taken] in {MANNER[one] for one in able}
    assert len(rows) == 3879
    assert sum(right.values()) / len(rows) >= 0.94
    assert manners / len(rows) >= 0.955
    assert min(right[one] / many[one] for one in many) >= 0.88


@pytest.mark.parametrize(
    ("fields", "taken"),
    [
        ({"title": "木造虚空蔵菩薩坐像"}, "statue"),
        ({"title": "花鳥沈金大硯箱"}, "cabinet"),
        ({"object_name": "relief mural"}, "relief"),
        ({"object_name": "peinture murale"}, "wall_painting"),
        ({"object_name": "gemme(s) de la couronne ; aiguière", "title": "Vase transformé en aiguière"}, "vessel"),
        ({"object_name": "alabardina"}, "mounted"),
        ({"object_name": "硯箱 猿月取蒔絵"}, "cabinet"),
    ],
)
def test_names_that_were_mistaken(fields: dict[str, str], taken: str) -> None:
    item = replace(Item("1", "Room", height_m=0.9, width_m=0.4), **fields)  # type: ignore[arg-type]
    assert classify(item).object_class == taken


@pytest.mark.parametrize(
    ("fields", "taken"),
    [
        # No size: carpets, curtains and hangings are larger than what lies in a case.
        ({"object_name": "hanging", "medium": "cotton, embroidered"}, "relief"),
        ({"object_name": "bed curtain"}, "relief"),
        ({"object_name": "Teppich"}, "relief"),
        ({"object_name": "hanging lamp"}, "chandelier"),
        # A desk as high as a hand is a box.
        ({"object_name": "writing desk", "height_m": 0.127, "width_m": 0.19, "depth_m": 0.27}, "cabinet"),
        ({"object_name": "writing desk", "height_m": 0.9, "width_m": 1.2, "depth_m": 0.6}, "table"),
        # A slab of a bare material hangs, whatever its free title.
        (
            {"title": "Untitled", "medium": "raw and stained wood", "height_m": 2.18, "width_m": 2.35, "depth_m": 0.05},
            "relief",
        ),
        ({"title": "Untitled", "medium": "painted wood", "height_m": 1.09, "width_m": 0.58, "depth_m": 0.22}, "statue"),
        ({"object_name": "telefon ścienny"}, "relief"),
        # A sculpture that is called a bust is one; and a title that says what its thing is made of names it.
        (
            {"object_name": "sculpture", "title": "Bust of a man", "height_m": 0.6, "width_m": 0.4, "depth_m": 0.3},
            "bust",
        ),
        ({"title": "Πήλινο ειδώλιο", "height_m": 0.12, "width_m": 0.05, "depth_m": 0.04}, "figurine"),
        # A piano that is as high as a chest and not deep stands as one.
        ({"object_name": "Piano", "height_m": 1.3, "width_m": 1.45, "depth_m": 0.65}, "cabinet"),
        ({"object_name": "bowl", "classification": "carvings", "height_m": 0.1, "width_m": 0.3}, "dish"),
        ({"object_name": "Messhelm im Spacelab"}, "mounted"),
        ({"object_name": "Dragkista, Kommóða", "height_m": 0.96, "width_m": 1.09, "depth_m": 0.49}, "cabinet"),
    ],
)
def test_things_that_were_mistaken(fields: dict[str, str | float], taken: str) -> None:
    assert classify(replace(Item("1", "Room"), **fields)).object_class == taken  # type: ignore[arg-type]


def test_of_several_names_in_a_cell_none_is_sure() -> None:
    """A museum that writes what a thing may be, from the general to the special, has not said which it is."""
    one = classify(replace(Item("1", "Room", height_m=0.3, width_m=0.2), object_name="statuette"))
    many = classify(replace(Item("1", "Room", height_m=0.3, width_m=0.2), object_name="statuette; relief"))
    assert one.chances[0][1] > many.chances[0][1]
    assert many.chances[0][1] < 0.9
