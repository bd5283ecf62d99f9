"""Refused and doubted records of the museum: a line of the index, a page, and the list for programs."""

import csv
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from heapq import nsmallest
from pathlib import Path
from typing import Any

from pipeline.records import Doubt
from pipeline.records.reading import DOUBTFUL, REFUSED, SHEET, SOURCE
from pipeline.report.text import clean, safe_cell, short, words

READING = "reading"
"""Key of a run's settings under which it is kept what was refused and is doubted, and stem of the report's files."""

INVENTORY = "inventory"
"""Key of a run's settings under which the version of the inventory is kept."""

SHOWN = 1_000
"""Entries on the page, which a browser shows at once; the list beside it has all."""

COLUMNS = ("row", "line", "object_number", "field", "what", "message", "remedy")

_LONGEST = 300
_ORDER = {SOURCE: 0, REFUSED: 1, SHEET: 2, DOUBTFUL: 3}

Doubts = Callable[[], Iterable[Doubt]]
"""Gives everything that was refused or is doubted, in any order."""


@dataclass(frozen=True, slots=True)
class ReadingView:
    """What the index says of the reading.

    known   : whether it was noted what reading refused and doubts
    unsaid  : objects taken to be on display because no column says what is; 0 where one does
    suspicions : what the whole source seems to have wrong, and what mends it
    """

    known: bool
    source: str = ""
    rows: int = 0
    refused: int = 0
    doubtful: int = 0
    sheets: int = 0
    suspicions: tuple[tuple[str, str], ...] = ()
    unsaid: int = 0

    @property
    def look(self) -> bool:
        """Whether there is something to look at."""
        return bool(self.refused or self.doubtful or self.sheets or self.suspicions)


@dataclass(frozen=True, slots=True)
class DoubtView:
    """An entry of the page; row and line are "" where they are not known."""

    what: str
    row: str
    line: str
    number: str
    field: str
    message: str
    remedy: str


def reading_view(settings: Mapping[str, Any]) -> ReadingView:
    """Return what the index says, of a run's settings."""
    told = settings.get(READING)
    if not told:
        return ReadingView(known=False)
    return ReadingView(
        known=True,
        source=clean(str(told["source"])),
        rows=int(told["rows"]),
        refused=int(told["refused"]),
        doubtful=int(told["doubtful"]),
        sheets=int(told["sheets"]),
        suspicions=tuple((clean(one["message"]), clean(one["remedy"])) for one in told["suspicions"]),
        unsaid=int(told["unsaid"]),
    )


@dataclass(frozen=True, slots=True)
class ListedDoubts:
    """What the page shows of a list: its first entries, how many there are, how many of which field."""

    entries: tuple[DoubtView, ...]
    all: int
    fields: tuple[tuple[str, int], ...]


def write_doubts(file: Path, doubts: Iterable[Doubt]) -> ListedDoubts:
    """Write the whole list as CSV, one entry at a time, and return what the page shows of it."""
    fields: Counter[str] = Counter()
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)

        def written() -> Iterator[Doubt]:
            for one in doubts:
                cells = (one.row, one.line, one.object_number, one.field, one.what, one.message, one.remedy)
                writer.writerow([safe_cell(cell) if isinstance(cell, str) else cell for cell in cells])
                fields[one.field] += 1
                yield one

        first = nsmallest(SHOWN, written(), key=_order)
    return ListedDoubts(
        tuple(map(_view, first)), fields.total(), tuple((words(f), n) for f, n in fields.most_common() if f)
    )


def _order(one: Doubt) -> tuple[int, bool, int, str]:
    return _ORDER[one.what], one.row is None, one.row or 0, one.object_number


def _view(one: Doubt) -> DoubtView:
    return DoubtView(
        what=one.what,
        row="" if one.row is None else str(one.row),
        line="" if one.line is None else str(one.line),
        number=short(one.object_number, 120),
        field=words(clean(one.field)),
        message=short(one.message, _LONGEST),
        remedy=short(one.remedy, _LONGEST),
    )


FILES = (f"{READING}.html", f"{READING}.csv")
