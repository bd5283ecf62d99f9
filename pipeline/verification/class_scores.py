"""Scores of the classes of labelled objects, each museum read with weights that never saw it.

Run: python -m pipeline.verification.class_scores FILE...
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.analysis.evidence import Chance, taken_of
from pipeline.analysis.rules import readings
from pipeline.tables import table
from pipeline.verification.class_fit import CLASSES, Labelled, labelled_of, left_out

STATED = 0.9
"""Probability from which a class is said to be sure."""
RANDOM = "plain"
"""The draw that is a simple random sample of its museum; all others are of hard objects."""
FLAT = "framed"
"""The class of flat works."""
WIDTHS = (12, 8, 6, 7, 9, 14, 16)


def _manner(row: dict[str, str]) -> str:
    """Return how things of a class are held: what lies or is held by a mount does not stand."""
    if row["models"] == "held":
        return "held"
    return "none" if row["class"] == "installation" else row["support"]


MANNER = {row["class"]: _manner(dict(row)) for row in table("classes")}
"""The manner of support of each class."""


@dataclass(frozen=True)
class Scored:
    """One object: its museum and draw, the class that a person gave it, and the class and probability it was given."""

    museum: str
    drawn: str
    right: str
    taken: str
    sure: float


def scored(path: Path) -> list[Scored]:
    """Return the objects of a file of labels, each read with the weights of all other museums."""
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    drawn = {(row["collection"], row["object_number"]): row["drawn"] for row in rows}
    out = []
    for museum, (mine, found) in left_out([labelled_of(row) for row in rows]).items():
        for one, chances in zip(mine, found, strict=True):
            taken, sure = _taken(one, chances.tolist())
            out.append(Scored(museum, drawn[museum, one.item.object_number], one.object_class, taken, sure))
    return out


def _taken(one: Labelled, shares: Sequence[float]) -> tuple[str, float]:
    """Return the class that is taken, as `pipeline.analysis.classify` takes it, and its probability."""
    read = readings(one.item)
    chances = sorted(map(Chance, CLASSES, shares), key=lambda chance: -chance.probability)
    taken = taken_of(one.item, read, chances)
    if taken is None:
        return read.decided.rule.object_class, chances[0].probability
    return taken.object_class, taken.probability


def lines(found: Sequence[Scored]) -> list[str]:
    """Return the scores as a table: a line for each museum and draw, and for all museums together."""
    head = ("museum", "draw", "n", "class", "support", f"from {STATED:g}", "flat, standing")
    out = ["  ".join(name.ljust(width) for name, width in zip(head, WIDTHS, strict=True)).rstrip()]
    for museum in (*sorted({one.museum for one in found}), "all"):
        mine = [one for one in found if museum in (one.museum, "all")]
        for name, some in (
            ("random", [one for one in mine if one.drawn == RANDOM]),
            ("hard", [one for one in mine if one.drawn != RANDOM]),
        ):
            if some:
                cells = (museum, name, str(len(some)), *_cells(some))
                out.append("  ".join(cell.ljust(width) for cell, width in zip(cells, WIDTHS, strict=True)).rstrip())
    return out


def _cells(some: Sequence[Scored]) -> tuple[str, ...]:
    sure = [one.taken == one.right for one in some if one.sure >= STATED]
    flat = [MANNER[one.taken] == "freestanding" for one in some if one.right == FLAT]
    return (
        f"{np.mean([one.taken == one.right for one in some]):.3f}",
        f"{np.mean([MANNER[one.taken] == MANNER[one.right] for one in some]):.3f}",
        f"{np.mean(sure):.3f} of {len(sure)}" if sure else "none",
        f"{sum(flat)} of {len(flat)}",
    )


def main() -> None:
    """Print the scores of files of labelled objects."""
    parser = argparse.ArgumentParser(
        prog="python -m pipeline.verification.class_scores",
        description="Leave one museum out: the weights are found from all other museums of a file of labelled objects, "
        "and its own objects classed with them. Columns: right class, right manner of support, right where the "
        f"probability is {STATED:g} or more, and flat works taken to stand. Takes some minutes.",
    )
    parser.add_argument("file", nargs="+", type=Path, help="labelled objects, as labelled_classes.csv")
    found = [one for path in parser.parse_args().file for one in scored(path)]
    print("\n".join(lines(found)))


if __name__ == "__main__":
    main()
