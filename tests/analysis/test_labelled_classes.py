"""The classes of 540 real objects that were labelled by hand (tests/data/collections/labelled_classes.md).

The weights of evidence are found from these rows too: how well museums are read that they do not know is tested in
test_evidence.py.
"""

from __future__ import annotations

import csv
from collections import Counter
from functools import cache
from hashlib import sha256
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.records import Item
from pipeline.tables import table

FILE = Path(__file__).parents[1] / "data" / "collections" / "labelled_classes.csv"
PARTS = ("tuned", "held out", "fresh")

LIES = ("small_flat", "mounted", "installation")
HUNG = ("framed", "relief", "wall_painting")


def part_of(row: dict[str, str]) -> str:
    if row["drawn"] == "fresh":
        return "fresh"
    digest = sha256(f"{row['collection']} {row['object_number']}".encode()).hexdigest()
    return "held out" if int(digest, 16) % 10 >= 6 else "tuned"


def held(name: str) -> str:
    """How a thing of the class is held, which decides what is computed for it."""
    if name == "chandelier":
        return "suspended"
    return "hung" if name in HUNG else "lies" if name in LIES else "stands"


@cache
def labelled() -> tuple[tuple[str, str, str], ...]:
    """(part, label, the classifier's class) of every row of the first set."""
    out = []
    with FILE.open(encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            if row["set"] != "first":
                continue
            texts = {name: row[name] for name in ("title", "object_name", "classification", "medium")}
            sizes = {name: float(row[name]) if row[name] else None for name in ("height_m", "width_m", "depth_m")}
            item = Item(row["object_number"], "G", **texts, **sizes)  # type: ignore[arg-type]
            out.append((part_of(row), row["class"], classify(item).object_class))
    return tuple(out)


def confusion(part: str) -> str:
    """The confusion table of a part, as text: label, how many of it, and what they were taken for."""
    lines = []
    for label in sorted({right for where, right, _ in labelled() if where == part}):
        taken = Counter(found for where, right, found in labelled() if where == part and right == label)
        lines.append(f"{label:16}{taken.total():4}  {', '.join(f'{k} {n}' for k, n in taken.most_common())}")
    return "\n".join(lines)


def test_labels_are_classes_and_every_class_is_seen() -> None:
    assert {label for _, label, _ in labelled()} == {row["class"] for row in table("classes")}
    assert Counter(part for part, _, _ in labelled()) == {"tuned": 274, "held out": 146, "fresh": 120}


@pytest.mark.parametrize(("part", "least"), [("tuned", 0.95), ("held out", 0.88), ("fresh", 0.86)])
def test_accuracy(part: str, least: float) -> None:
    """What is reached, less at most three objects: a change of the rules may cost no more unnoticed."""
    pairs = [(right, found) for where, right, found in labelled() if where == part]
    accuracy = sum(right == found for right, found in pairs) / len(pairs)
    assert accuracy >= least, f"{part}: {accuracy:.3f}\n{confusion(part)}"


@pytest.mark.parametrize(("name", "least"), [
    ("framed", 0.85), ("vessel", 0.95), ("seat", 0.95), ("dish", 0.95), ("lamp", 0.95),
    ("figurine", 0.90), ("installation", 0.90), ("small_flat", 0.75), ("relief", 0.50),
])  # fmt: skip
def test_accuracy_of_a_class(name: str, least: float) -> None:
    """Recall on the rows outside the tuned part, for classes with ten and more of them.

    Reliefs are the weakest: wax portraits, plaster medallions and room panels have names that other things share.
    """
    found = [got for part, right, got in labelled() if part != "tuned" and right == name]
    assert len(found) >= 10
    assert found.count(name) / len(found) >= least, Counter(found)


def test_dangerous_confusions() -> None:
    """Of the 266 objects outside the tuned part: those for which quite another thing would be computed.

    A chandelier is never missed and nothing else is suspended.  The others are counted, each an object that was looked
    at: a hung thing taken to stand, or a standing thing taken to hang, has a wrong model; one taken to lie has none,
    which the report says; a figure taken for a vessel keeps its models with another base and mass.
    """
    pairs = [(right, found) for part, right, found in labelled() if part != "tuned"]
    ways = Counter((held(right), held(found)) for right, found in pairs if held(right) != held(found))
    assert not any("suspended" in pair for pair in ways), ways
    # One sculpture of steel, 2.3 m high and 0.1 m deep, is taken for a slab.
    assert ways["stands", "hung"] <= 1, ways
    assert ways["hung", "stands"] <= 4, ways
    assert ways["stands", "lies"] <= 3, ways
    assert ways["hung", "lies"] <= 6, ways
    assert ways["lies", "hung"] <= 4, ways
    assert ways["lies", "stands"] <= 8, ways
    figures, vessels = ("figurine", "statue", "standing_figure", "bust"), ("vessel", "dish", "stemmed_glass")
    assert sum(right in figures and found in vessels for right, found in pairs) <= 1
    assert sum(right in vessels and found in figures for right, found in pairs) == 0


@pytest.mark.parametrize(
    ("medium", "title", "sizes", "classes"),
    [  # written as Tate writes it, labelled before any was run; sizes in m
        ("Oil paint", "The Snail", (2.8, 2.8, None), {"framed"}),
        ("Oil, 1956", "Horizon", (0.5, 0.6, 0.02), {"framed"}),
        ("Ink", "Three Figures", (0.3, 0.2, None), {"framed", "small_flat"}),
        ("Óleo", "Paisagem", (0.4, 0.6, None), {"framed"}),
        ("Olieverf", "Gezicht op Delft", (0.4, 0.5, None), {"framed"}),
        ("Bronze", "The Kiss of Judas", (0.6, 0.3, 0.3), {"statue", "figurine"}),
        ("Steel and paint", "Red Sprung", (1.8, 1.2, 1.1), {"statue", "object"}),
        ("Oil paint", "Cube", (0.5, 0.5, 0.5), {"statue", "figurine", "object"}),  # as deep as wide: no picture
        ("Bronzo", "Cavallo e cavaliere", (0.5, 0.5, 0.25), {"statue", "figurine"}),
    ],
)
def test_a_bare_medium_beside_a_free_title(
    medium: str, title: str, sizes: tuple[float | None, ...], classes: set[str]
) -> None:
    height, width, depth = sizes
    item = Item(
        object_number="1", gallery="1", title=title, medium=medium, height_m=height, width_m=width, depth_m=depth
    )
    assert classify(item).object_class in classes
