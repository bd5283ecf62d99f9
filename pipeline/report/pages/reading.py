"""Refused and doubted records of the museum: a line of the index, a page, and the list for programs."""

import csv
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from heapq import nsmallest
from pathlib import Path
from typing import Any

from pipeline.records import Doubt
from pipeline.records.run import CHOICE, DOUBTFUL, REFUSED, SHEET, SOURCE
from pipeline.report.assumed import assumed
from pipeline.report.language import _, ngettext, said
from pipeline.report.text import clean, count, safe_cell, short, words
from pipeline.report.units import Units

READING = "reading"
"""Key of a run's settings under which it is kept what was refused and is doubted, and stem of the report's files."""

INVENTORY = "inventory"
"""Key of a run's settings under which the version of the inventory is kept."""

IMAGES = "image_faults"
"""Key of a run's settings with a digest of why photographs are not shown; it is not there where all are."""

SHOWN = 1_000
"""Entries on a page, which a browser shows at once."""

PAGES = 20
"""Pages, of which nobody reads more; the list beside them has all."""

COLUMNS = ("row", "line", "object_number", "field", "what", "message", "remedy", "characters", "used")

_LONGEST = 300
_ORDER = {SOURCE: 0, CHOICE: 1, REFUSED: 2, SHEET: 3, DOUBTFUL: 4}
_KINDS = 10_000
"""Kinds of doubts that are counted apart."""

_TOLD = 12
"""Kinds that the page tells."""

Doubts = Callable[[], Iterable[Doubt]]
"""Gives everything that was refused or is doubted, in any order."""


@dataclass(frozen=True, slots=True)
class ReadingView:
    """What the index says of the reading.

    Attributes
    ----------
    known : bool
        Whether it was noted what reading refused and doubts.
    unsaid : int
        Objects taken to be on display because no column says what is; 0 where one does.
    suspicions : tuple[tuple[str, str], ...]
        What the whole source seems to have wrong, and what mends it.
    choices : tuple of str
        What was settled for the whole source by choice.
    images : int
        Photographs that cannot be shown.
    """

    known: bool
    source: str = ""
    rows: int = 0
    refused: int = 0
    doubtful: int = 0
    sheets: int = 0
    suspicions: tuple[tuple[str, str], ...] = ()
    unsaid: int = 0
    choices: tuple[str, ...] = ()
    images: int = 0

    @property
    def look(self) -> bool:
        """Whether there is something to look at."""
        return bool(self.refused or self.doubtful or self.sheets or self.suspicions or self.images)


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
    characters: str
    used: str


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
        choices=tuple(_settled(clean(one["message"])) for one in told.get("choices", ())),
        images=int(told.get("images", 0)),
    )


_AWAY = re.compile(
    r"(?P<number>[\d,]+) objects? taken not to be on display, as the name of the location says: (?P<places>.*)",
    re.DOTALL,
)


def _settled(message: str) -> str:
    """Say in the reader's language what was settled by choice; what settles it otherwise is on the import's page."""
    found = _AWAY.fullmatch(message)
    if found is None:
        return message
    number = int(found["number"].replace(",", ""))
    return ngettext(
        "%(shown)s object is taken not to be on display, as its place is called: %(places)s",
        "%(shown)s objects are taken not to be on display, as their places are called: %(places)s",
        number,
    ) % {"shown": count(number), "places": found["places"]}


@dataclass(frozen=True, slots=True)
class DoubtKind:
    """A kind of doubt: its field and its remedy, how often it is, and an object that has it."""

    field: str
    remedy: str
    count: int
    example: str


@dataclass(frozen=True, slots=True)
class ListedDoubts:
    """What the pages show of a list: its first entries, how many there are, how many of which field and remedy."""

    entries: tuple[DoubtView, ...]
    all: int
    kinds: tuple[DoubtKind, ...]

    @property
    def pages(self) -> tuple[str, ...]:
        """The files of the pages, one at least."""
        return tuple(page_file(at) for at in range(1, max(1, -(-len(self.entries) // SHOWN)) + 1))

    def page(self, number: int) -> tuple[DoubtView, ...]:
        """Return the entries of a page, counted from 1."""
        return self.entries[(number - 1) * SHOWN : number * SHOWN]


def page_file(number: int) -> str:
    """Return the file of a page, counted from 1: the first one's has no number."""
    return f"{READING}.html" if number == 1 else f"{READING}-{number}.html"


def is_reading_file(name: str) -> bool:
    """Say whether a file of a report is a page or the list of what reading refused and doubts."""
    return bool(_FILE.fullmatch(name))


def write_doubts(file: Path, doubts: Iterable[Doubt], units: Units) -> ListedDoubts:
    """Write the whole list as CSV, in English and SI, and return what the pages show of it, in the reader's units."""
    kinds: Counter[tuple[str, str]] = Counter()
    examples: dict[tuple[str, str], str] = {}
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)

        def written() -> Iterator[Doubt]:
            for one in doubts:
                cells = (one.row, one.line, *(getattr(one, name) for name in COLUMNS[2:]))
                writer.writerow([safe_cell(cell) if isinstance(cell, str) else cell for cell in cells])
                kind = (one.field, one.remedy)
                if kind not in kinds and len(kinds) >= _KINDS:
                    kind = ("", "")
                kinds[kind] += 1
                examples.setdefault(kind, one.object_number)
                yield one

        first = nsmallest(SHOWN * PAGES, written(), key=_order)
    told = [
        DoubtKind(
            said(words(clean(name))), short(assumed(remedy, units), _LONGEST), n, short(examples[name, remedy], 60)
        )
        for (name, remedy), n in kinds.most_common(_TOLD)
        if name
    ]
    return ListedDoubts(tuple(_view(one, units) for one in first), kinds.total(), tuple(told))


def _order(one: Doubt) -> tuple[int, bool, int, str]:
    return _ORDER[one.what], one.row is None, one.row or 0, one.object_number


def _view(one: Doubt, units: Units) -> DoubtView:
    return DoubtView(
        what=one.what,
        row="" if one.row is None else count(one.row),
        line="" if one.line is None else count(one.line),
        number=short(one.object_number, 120),
        field=said(words(clean(one.field))),
        message=short(assumed(one.message, units), _LONGEST),
        remedy=short(assumed(one.remedy, units), _LONGEST),
        characters="" if one.characters and one.characters in one.message else short(one.characters, _LONGEST),
        used=_used(one, units),
    )


def _used(one: Doubt, units: Units) -> str:
    """Say what was made of an entry."""
    if one.what == REFUSED:
        return _("no object was made of it")
    if one.what == SOURCE:
        return _("nothing was changed")
    if one.what == CHOICE:
        return _("taken so")
    if one.what == SHEET or not one.used:
        return _("not used")
    flags = {"on display": _("on display"), "not on display": _("not on display"), "yes": _("yes"), "no": _("no")}
    if _SIZES.fullmatch(one.used):
        return _SIZE.sub(lambda size: _size(size, units), one.used)
    return flags.get(one.used) or short(one.used, _LONGEST)


def _size(found: re.Match[str], units: Units) -> str:
    size = units.text(float(found[2]), found[3])
    return f"{said(found[1])} {size}" if found[1] else size


_SIZE = re.compile(r"(?:(height|width|depth|mass) )?(\d[\d.e+-]*) (m|kg)")
_SIZES = re.compile(rf"{_SIZE.pattern}(?:, {_SIZE.pattern})*")


_FILE = re.compile(rf"{READING}(?:-\d{{1,2}})?\.html|{READING}\.csv")
