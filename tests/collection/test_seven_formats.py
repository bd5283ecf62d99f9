"""Exports of seven formats and languages, from file to class by the guess alone: what their writer marked beforehand.

Truth: tests/data/collections/seven_formats/truth.csv, written beside the rows before any was read (README there).
"""

from __future__ import annotations

import csv
import re
import sqlite3
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.dimensions import choose, parse
from pipeline.collection.measured import is_dimension
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.records import Item, Support
from pipeline.verification.class_scores import MANNER

FOLDER = Path(__file__).parents[1] / "data" / "collections" / "seven_formats"
PLAIN = re.compile(r"(its )?[\w ]+(, which lies in plan)?, of the object itself;")
"""How a note of a number begins that nothing more is said of."""
NEAR = 0.006
REACHED = {
    "de": (25, 22, 24, 25),
    "es": (22, 23, 24, 25),
    "it": (21, 22, 25, 24),
    "ja": (20, 18, 23, 25),
    "nl": (24, 23, 25, 23),
    "ro": (23, 22, 24, 25),
    "pl": (23, 23, 24, 25),
}
"""Of 25 rows: sizes, classes, manners of support and display right, as reached; less is a loss."""
UNSAID = {"ja": 1}
"""Sizes that are not as marked without a word: a garment that was marked as lying is read as upright."""


def source_of(language: str, folder: Path) -> str:
    """Return the path or URL of a language's export."""
    if language == "ro":
        with sqlite3.connect(folder / "ro.sqlite") as database:
            database.executescript((FOLDER / "ro.sql").read_text(encoding="utf-8"))
        return f"sqlite:///{folder / 'ro.sqlite'}"
    return str(next(FOLDER.glob(f"{language}.*")))


def near(size: float | None, marked: str) -> bool:
    """Whether a size [m] is what was marked [cm]."""
    return size is None if not marked else size == pytest.approx(float(marked) / 100, rel=NEAR)


def right(mark: dict[str, str], item: Item) -> bool:
    """Whether height and plan are those that were marked; a diameter may be both sides of the plan."""
    plan = sorted(size for size in (item.width_m, item.depth_m) if size is not None)
    marked = sorted(float(mark[side]) / 100 for side in ("width_cm", "depth_cm") if mark[side])
    if len(marked) == 1 and len(plan) == 2:
        marked *= 2
    return near(item.height_m, mark["height_cm"]) and plan == pytest.approx(marked, rel=NEAR)


@pytest.mark.parametrize("language", REACHED)
def test_an_export_is_read_by_the_guess_alone(language: str, tmp_path: Path) -> None:
    """No row is refused, every weight is right, nothing is wrong unsaid but for what is named above."""
    with (FOLDER / "truth.csv").open(encoding="utf-8", newline="") as stream:
        marks = {row["number"]: row for row in csv.DictReader(stream) if row["language"] == language}
    source = source_of(language, tmp_path)
    reading = read_items(source, proposed(source).guess.mapping)
    assert reading.rejected == ()
    found = [(marks[item.object_number], item) for item in reading.items]
    assert len(found) == len(marks) == 25
    wrong = [item for mark, item in found if not right(mark, item)]
    taken = [(mark["class"], classify(item).object_class) for mark, item in found]
    sizes, classes, manners, shown = REACHED[language]
    assert 25 - len(wrong) >= sizes, [(i.object_number, i.dimensions) for i in wrong]
    assert sum(a == b for a, b in taken) >= classes
    assert sum(MANNER[a] == MANNER[b] for a, b in taken) >= manners
    assert sum(item.on_display == (mark["shown"] == "1") for mark, item in found) >= shown
    assert all(item.mass_kg == (pytest.approx(float(m["mass_kg"])) if m["mass_kg"] else None) for m, item in found)
    unsaid = [i for i in wrong if not i.problems and all(PLAIN.match(one.note) for one in i.provenance if one.note)]
    assert len(unsaid) <= UNSAID.get(language, 0), [(i.object_number, i.dimensions) for i in unsaid]


@pytest.mark.parametrize(
    ("text", "sizes"),
    [
        ("Höhe/Breite/Tiefe: 11,5/27/16 cm", (0.115, 0.27, 0.16)),
        ("Höhe/Breite: 21/13 cm", (0.21, 0.13, None)),
        ("height/width 3 1/2 x 4 in", (0.0889, 0.1016, None)),
        ("Alto/Ancho/Fondo = 35 x 20 x 10 cm", (0.35, 0.2, 0.1)),
        ("wysokość w ramie: 95 cm; szerokość w ramie: 122 cm", (0.95, 1.22, None)),
        ("Î: 21 cm", (0.21, None, None)),
        ("Î = 23,5 cm; L = 9 cm; Gr. = 2 cm", (0.235, 0.09, 0.02)),
        ("面長21.2 面幅13.6 奥行6.8 cm", (0.212, 0.136, 0.068)),
        ("vom 12/3/2012, Höhe 5 cm", (0.05, None, None)),
    ],
)
def test_texts_as_registrars_write_them(text: str, sizes: tuple[float | None, ...]) -> None:
    chosen = choose(parse(text, decimal=","), hung=True)
    found = tuple(one and one.value for one in (chosen.height, chosen.width, chosen.depth))
    assert found == tuple(size and pytest.approx(size) for size in sizes)


def test_a_shelf_mark_is_no_dimension() -> None:
    assert not any(map(is_dimension, ("M 45", "CM 45", "G. 12", "M 45a")))
    assert all(map(is_dimension, ("12 x 4 cm", "H 12 cm", "45 m")))


def test_a_length_that_no_field_takes_is_said_in_its_row(tmp_path: Path) -> None:
    path = tmp_path / "canes.csv"
    head = "accession_number,title,height_cm,width_cm,depth_cm,length_cm,location\n"
    path.write_text(
        f"{head}1,Cane,10,4,3,84,Room 1\n2,Bowl,10,30,30,,Room 1\n3,Box,10,30,20,30,Room 1\n", encoding="utf-8"
    )
    cane, bowl, box = read_items(path, proposed(str(path)).guess.mapping).items
    assert [one.message for one in cane.problems] == ["column 'length_cm': its '84' is in no field"]
    assert bowl.problems == box.problems == ()


def test_a_number_with_a_note_is_taken_and_doubted(tmp_path: Path) -> None:
    path = tmp_path / "cups.csv"
    rows = ['1,Chávena,"5,3 (com pires)",Sala 1', '2,Vaso,"30,4 (20,1 sem tampa)",Sala 1', '3,Vaso,"31,4",Sala 1']
    path.write_text("\n".join(["Número de inventário,Título,Altura (cm),Localização", *rows]), encoding="utf-8")
    cup, two, vase = read_items(path, proposed(str(path)).guess.mapping).items
    assert (cup.height_m, two.height_m, vase.height_m) == (0.053, None, 0.314)
    assert "'(com pires)'; the number is taken" in cup.problems[0].message
    assert two.problems
    assert vase.problems == ()


@pytest.mark.parametrize(
    ("name", "title", "taken"),
    [
        ("Leuchter", "Kronleuchter", "chandelier"),
        ("lamp", "Chandelier", "chandelier"),
        ("Lámpara", "Lámpara de techo de ocho brazos", "chandelier"),
        ("Leuchter", "Altarleuchter", "lamp"),
        ("lamp", "Oil lamp", "lamp"),
        ("Painting", "Chandelier", "framed"),
    ],
)
def test_a_title_that_names_a_kind_of_the_same_thing_counts(name: str, title: str, taken: str) -> None:
    item = Item("1", "Room", object_name=name, title=title, height_m=0.95, width_m=0.9)
    assert classify(item).object_class == taken


def test_a_totem_pole_stands_fixed_and_its_model_does_not() -> None:
    pole = Item("1", "Hall", object_name="totem pole", medium="cedar", height_m=6.0, width_m=0.9, depth_m=0.8)
    scene = classify(pole)
    assert (scene.object_class, scene.support) == ("standing_figure", Support.FASTENED)
    assert any(said.startswith("support: fastened, assumed for") for said in scene.assumptions)
    small = Item("2", "Hall", object_name="model totem pole", medium="argillite", height_m=0.3, width_m=0.05)
    assert classify(small).support is Support.FREESTANDING
