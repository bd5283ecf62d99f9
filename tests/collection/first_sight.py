"""What is right at first sight of a museum's whole export: by the guess alone, from file to class.

Run: python -m tests.collection.first_sight FOLDER [PART]: the scores of each file, and each row that is wrong.
"""

from __future__ import annotations

import csv
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.collection.errors import CollectionError
from pipeline.collection.reading import read_items
from pipeline.night.importing import proposed
from pipeline.records import Item
from pipeline.verification.class_scores import MANNER

from .test_public_pages import NEAR, ROUNDED, is_plan, is_said

FOLDER = Path(__file__).parents[1] / "data" / "collections"
SURE = 0.9
NOT_ASKED = ("", "*")


@dataclass(frozen=True)
class Seen:
    """A row of an export, how a person reads it, and what was made of it.

    There is no item where it was not read; `stopped` is whether the import of its file stopped and said why.
    """

    mark: dict[str, str]
    item: Item | None
    taken: str = ""
    sure: float = 0.0
    stopped: bool = False

    @property
    def height(self) -> bool | None:
        """Whether its height is one of those that were marked; none where none is asked for.

        "12?" may also be left open with a word, and "-" has none.
        """
        if self.mark["height_cm"] in NOT_ASKED:
            return None
        if self.item is None:
            return False
        if self.item.height_m is None:
            return "-" in self.mark["height_cm"] or ("?" in self.mark["height_cm"] and is_said(self.item))
        able = [float(one) / 100 for one in re.split(r"[|?]", self.mark["height_cm"]) if one.strip("-")]
        return any(self.item.height_m == pytest.approx(one, rel=NEAR, abs=ROUNDED) for one in able)

    @property
    def plan(self) -> bool | None:
        """Whether its sides in plan are those that were marked; one number is a diameter or a single side."""
        if self.mark["plan_cm"] in NOT_ASKED:
            return None
        if self.item is None:
            return False
        alone = [float(one) / 100 for one in self.mark["plan_cm"].split("|") if one and "x" not in one]
        both = self.item.width_m is not None and self.item.width_m == self.item.depth_m
        return is_plan(self.mark, self.item) or (
            both and any(self.item.width_m == pytest.approx(one, rel=NEAR) for one in alone)
        )

    @property
    def kind(self) -> bool | None:
        """Whether its class is one of those that are right."""
        return None if self.mark["classes"] in NOT_ASKED else self.taken in self.mark["classes"].split("|")

    @property
    def manner(self) -> bool | None:
        """Whether it is held in the right manner."""
        if self.mark["classes"] in NOT_ASKED:
            return None
        return MANNER.get(self.taken) in {MANNER[one] for one in self.mark["classes"].split("|")}

    @property
    def shown(self) -> bool | None:
        """Whether it is known to be on display or not."""
        if self.mark["display"] not in ("0", "1"):
            return None
        return self.item is not None and self.item.on_display == (self.mark["display"] == "1")

    @property
    def mass(self) -> bool | None:
        """Whether its mass is as marked."""
        if not self.mark.get("kg"):
            return None
        return self.item is not None and self.item.mass_kg == pytest.approx(float(self.mark["kg"]), rel=NEAR)

    @property
    def said(self) -> bool:
        """Whether anything is said of how its numbers were read."""
        return is_said(self.item) if self.item else self.stopped

    @property
    def sure_and_wrong(self) -> bool:
        """Whether a wrong class is said to be sure."""
        return self.kind is False and self.sure >= SURE


ASKED = ("height", "plan", "kind", "manner", "shown", "mass")


def seen(folder: str, part: str) -> list[Seen]:
    """Return all rows of a part of a folder, its files in order."""
    with (FOLDER / folder / "truth.csv").open(encoding="utf-8", newline="") as stream:
        marks = [row for row in csv.DictReader(stream) if row["set"] == part]
    out = []
    for name in sorted({mark["file"] for mark in marks}):
        path = FOLDER / folder / part / name
        items, stopped = _read(path)
        out += [_seen(mark, items.get(mark["number"]), stopped) for mark in marks if mark["file"] == name]
    return out


def _read(path: Path) -> tuple[dict[str, Item], bool]:
    try:
        found = proposed(str(path))
    except CollectionError as error:
        print(error, file=sys.stderr)
        return {}, True
    held = [one.message for one in found.reading.suspicions if one.holds]
    if held:
        print(path.name, *held, sep="\n", file=sys.stderr)
        return {}, True
    return {item.object_number: item for item in read_items(path, found.guess.mapping).items}, False


def _seen(mark: dict[str, str], item: Item | None, stopped: bool) -> Seen:
    if item is None:
        return Seen(mark, None, stopped=stopped)
    scene = classify(item)
    return Seen(mark, item, scene.object_class, scene.chances[0][1] if scene.chances else 0.0)


def right(rows: list[Seen], what: str) -> tuple[int, int]:
    """Return how many rows are right of how many that are asked."""
    asked = [answer for row in rows if (answer := getattr(row, what)) is not None]
    return sum(asked), len(asked)


def _line(name: str, rows: list[Seen]) -> str:
    marks = [f"{what} {got}/{of}" for what in ASKED for got, of in [right(rows, what)] if of]
    unsaid = sum(row.height is False and not row.said for row in rows)
    sure = [row for row in rows if row.kind is not None and row.sure >= SURE]
    marks += [f"heights wrong unsaid {unsaid}", f"sure {sum(bool(row.kind) for row in sure)}/{len(sure)}"]
    return f"{name}: " + ", ".join(marks)


def main(folder: str, *parts: str) -> None:
    """Print the scores of each file and of each part, and with one part alone all that is wrong."""
    for part in parts or ("learn", "held"):
        rows = seen(folder, part)
        for name in sorted({row.mark["file"] for row in rows}):
            print(_line(f"{part}/{name}", [row for row in rows if row.mark["file"] == name]))
        print(_line(part, rows))
        for row in rows if parts else ():
            wrong = [what for what in ASKED if getattr(row, what) is False]
            if wrong:
                item = row.item
                sides = item and [item.height_m, item.width_m, item.depth_m, item.mass_kg]
                called = item and (item.title, item.object_name)
                print(row.mark["file"], row.mark["number"], *wrong, "said" if row.said else "UNSAID", sep=" | ")
                print("   ", row.mark["height_cm"], row.mark["plan_cm"], row.mark["classes"], row.mark["display"])
                print("   ", sides, row.taken, f"{row.sure:.2f}", called, item and item.on_display)


if __name__ == "__main__":
    main(*sys.argv[1:])
