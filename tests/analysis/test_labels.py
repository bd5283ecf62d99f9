"""The labelled objects: the file is what its guide says (tests/data/collections/labelled_classes.md)."""

from __future__ import annotations

import csv
import re
from collections import Counter
from functools import cache
from pathlib import Path

from pipeline.tables import table

FOLDER = Path(__file__).parents[1] / "data" / "collections"


@cache
def rows() -> tuple[dict[str, str], ...]:
    with (FOLDER / "labelled_classes.csv").open(encoding="utf-8", newline="") as stream:
        return tuple(csv.DictReader(stream))


def test_every_label_is_a_class_and_no_doubt_repeats_it() -> None:
    classes = {row["class"] for row in table("classes")}
    for row in rows():
        where = (row["collection"], row["object_number"])
        assert row["class"] in classes, where
        assert row["also"] in classes - {row["class"]} or not row["also"], where


def test_no_object_is_there_twice() -> None:
    found = Counter((row["collection"], row["object_number"]) for row in rows())
    assert len(found) == len(rows()), found.most_common(3)


def test_the_guide_counts_what_is_there() -> None:
    """Rows of each collection and set, and of each class, as the tables of the guide print them."""
    guide = (FOLDER / "labelled_classes.md").read_text(encoding="utf-8")
    for column in ("collection", "class"):
        for name in {row[column] for row in rows()}:
            counts = [sum(r[column] == name and r["set"] == part for r in rows()) for part in ("first", "second")]
            assert re.search(rf"^\| {name} \| {counts[0]} \| {counts[1]} \|", guide, re.MULTILINE), (name, counts)


def test_lengths_are_metres() -> None:
    """Nothing is larger than the wall drawing of 22 m, and nothing measured is thinner than 1 mm."""
    for row in rows():
        for name in ("height_m", "width_m", "depth_m"):
            assert not row[name] or 0.001 < float(row[name]) < 25.0, (row["object_number"], name)
