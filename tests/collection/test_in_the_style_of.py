"""Exports made in the style of seven museums' own, from file to class: what a person marked before they were read.

Truth: the columns `true: ...` of each file (tests/data/collections/README.md), which the import never sees.  Two of the
files, `matriz` and `mv`, were read once, at the end, and nothing was mended for them.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.cells import Cells
from pipeline.collection.dimensions.structured import plain_text, words_of
from pipeline.collection.guess import guess
from pipeline.collection.mapping_parts import Texts
from pipeline.collection.measured import fill
from pipeline.collection.reading import read_items
from pipeline.records import Item
from pipeline.verification.class_scores import MANNER
from tests.soak import some

FOLDER = Path(__file__).parents[1] / "data" / "collections" / "in_the_style_of"
MARK = "true: "
PLAIN = re.compile(r"(its )?[\w ]+(, which lies in plan)?, of the object itself;")
"""How a note of a number begins that nothing more is said of."""
NEAR = 0.006
"""Texts are rounded to 1 mm of at least 16 cm, or are exact."""

CASES = (
    ("rijks", 40, 38, 40),
    ("cleveland", 40, 37, 39),
    ("vam", 40, 36, 39),
    ("tnm", 38, 36, 38),
    ("mkg", 40, 40, 40),
    ("matriz", 37, 34, 37),
    ("mv", 37, 38, 39),
)
"""Of forty rows: sizes, classes and manners of support right, as first reached; less is a loss."""
UNSAID = {"matriz": 1}
"""Sizes that are wrong without a word: of "diâm. bojo 33 cm" the width is left out."""


def read(name: str, folder: Path) -> list[tuple[dict[str, str], Item]]:
    """Return the marks of each row of a file, and the object that was read of it with no step but the guess."""
    delimiter = ";" if name == "mkg" else ","
    with (FOLDER / f"{name}.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream, delimiter=delimiter))
    shown = [column for column in rows[0] if not column.startswith(MARK)]
    path = folder / f"{name}.csv"
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, shown, delimiter=delimiter, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    reading = read_items(path, guess(path).mapping)
    assert reading.rejected == ()
    items = {item.object_number: item for item in reading.items}
    marks = [{column.removeprefix(MARK): cell for column, cell in row.items()} for row in rows]
    return [(mark, items[mark["number"]]) for mark in marks]


def right(mark: dict[str, str], item: Item) -> bool:
    """Whether height and plan are those that were marked, where a width and a depth may stand in either order."""
    plan = sorted(size for size in (item.width_m, item.depth_m) if size is not None)
    marked = sorted(float(mark[side]) / 100 for side in ("width_cm", "depth_cm") if mark[side])
    height = float(mark["height_cm"]) / 100 if mark["height_cm"] else None
    tall = item.height_m is None if height is None else item.height_m == pytest.approx(height, rel=NEAR)
    return tall and plan == pytest.approx(marked, rel=NEAR)


@pytest.mark.parametrize(("name", "sizes", "classes", "manners"), some(CASES, 4))
def test_rows_are_read_and_classed(name: str, sizes: int, classes: int, manners: int, tmp_path: Path) -> None:
    """Of forty rows each: as many sizes and classes right as were reached, none wrong unsaid, the display."""
    found = read(name, tmp_path)
    assert len(found) == 40
    wrong = [(mark, item) for mark, item in found if not right(mark, item)]
    assert len(found) - len(wrong) >= sizes, [item.dimensions for _, item in wrong]
    unsaid = [i for _, i in wrong if not i.problems and all(PLAIN.match(one.note) for one in i.provenance if one.note)]
    assert len(unsaid) <= UNSAID.get(name, 0), [item.dimensions for item in unsaid]
    assert all(item.on_display == (mark["shown"] == "1") for mark, item in found)
    taken = [(mark["class"], classify(item).object_class) for mark, item in found]
    assert sum(a == b for a, b in taken) >= classes, [pair for pair in taken if pair[0] != pair[1]]
    assert sum(MANNER[a] == MANNER[b] for a, b in taken) >= manners


def test_dimensions_as_catalogues_on_the_web_hold_them() -> None:
    """JSON, or the same as Python writes it, becomes the text that it says; what is none stays as it is."""
    asked = {
        '[{"dimension": "Height", "value": "24.5", "unit": "cm", "part": ""}]': "Height 24.5 cm",
        "[{'dimension': 'Height', 'value': 24.5, 'unit': 'cm', 'part': 'foot'}]": "foot: Height 24.5 cm",
        '{"height": 450, "width": 320, "unit": "mm"}': "height 450 mm, width 320 mm",
        '[{"label": "Dimensions", "content": "H x W: 5 x 6 cm"}]': "H x W: 5 x 6 cm",
        "[12] x 4 cm": "[12] x 4 cm",
        '["a': '["a',
        "[[" * 5000: "[[" * 5000,
    }
    assert {text: plain_text(text) for text in asked} == asked
    deep = '{"a":' * 50 + "1" + "}" * 50
    assert plain_text(deep) == deep
    assert plain_text('{"height": ' + "9" * 5000 + "}")


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ('[{"name": "maleri"}]', "maleri"),
        ('["Olie på lærred", "Guld", "Guld"]', "Olie på lærred; Guld"),
        ("[{'type': 'museumstitel', 'title': 'Natten'}, {'title': 'Dagen'}]", "Natten; Dagen"),
        ("[Untitled]", "[Untitled]"),
        ("[1923]", "[1923]"),
        ('["a", 3]', '["a", 3]'),
        ('[{"id": 3}]', '[{"id": 3}]'),
        ("[" * 9000, "[" * 9000),
    ],
)
def test_words_as_catalogues_on_the_web_hold_them(cell: str, words: str) -> None:
    assert words_of(cell) == words


@pytest.mark.parametrize(
    ("text", "height", "plan"),
    [
        ("Diameter: 20.3 cm (8 in.); Overall: 8.9 cm (3 1/2 in.)", 0.089, [0.203, 0.203]),
        ("h 4.2 cm × d 35.6 cm", 0.042, [0.356, 0.356]),
        ("h 12 cm × b 8 cm × d 3 cm", 0.12, [0.03, 0.08]),
        ("d 7.1 cm × gewicht 80.25 gr", None, [0.071, 0.071]),
        ("hoogte 17.5 cm × diameter 9.3 cm (voet)", 0.175, []),
        ("総高130.5cm 最大幅39.5cm", 1.305, [0.395]),
        ("丈150.0cm 裄70.5cm", 1.5, [0.705]),
    ],
)
def test_the_forms_that_were_misread(text: str, height: float | None, plan: list[float]) -> None:
    values: dict[str, object] = {}
    fill(values, Cells(), Texts(columns=("text",)), [text], ".")
    assert values.get("height_m") == (None if height is None else pytest.approx(height))
    found = sorted(values[side] for side in ("width_m", "depth_m") if values.get(side) is not None)
    assert found == pytest.approx(plan)
