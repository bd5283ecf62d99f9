"""Folders of lists with what a reader makes of each row in expected.csv, which the guess has not seen."""

import csv
from collections import defaultdict
from functools import cache
from pathlib import Path

from pipeline.night.importing import proposed
from pipeline.records import Item


@cache
def expected(folder: Path) -> dict[str, list[dict[str, str]]]:
    """Return the rows of expected.csv by list."""
    out = defaultdict(list)
    with (folder / "expected.csv").open(encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            out[row["list"]].append(row)
    return dict(out)


@cache
def items_of(folder: Path, name: str) -> dict[str, Item]:
    """Return the objects of a list by their numbers."""
    (path,) = folder.glob(f"{name}.*")
    return {item.object_number: item for item in proposed(str(path)).reading.items}
