"""The museum's records -> Kouros's inventory, with a log of what was read, refused and changed."""

import csv
import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from heapq import merge
from itertools import takewhile
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.analysis.classify import class_of
from pipeline.analysis.rules import PICTURES, readings
from pipeline.collection.inventory import Difference, held, latest_import, replace_inventory, return_to
from pipeline.collection.inventory.source_rows import hold_source, known_rows
from pipeline.collection.limits import Limits
from pipeline.collection.mapping import load_mapping, preset_file, preset_names
from pipeline.collection.reading import NOWHERE, Reading, read_items
from pipeline.collection.source_audit import judged, require_settled
from pipeline.collection.sources.address import expand_secrets
from pipeline.collection.sources.registry import is_address
from pipeline.collection.unit_audit import Suspicion
from pipeline.night.source_state import mapping_of, source_key
from pipeline.night.usual_sizes import unfit_sizes
from pipeline.operations.workspace import IMPORTS, Workspace
from pipeline.quantities import figures
from pipeline.records import Item, Problem
from pipeline.report.text import safe_cell
from pipeline.resources import replacing
from pipeline.settings import Settings

if TYPE_CHECKING:
    from pipeline.collection.guess import Guess
    from pipeline.collection.mapping import Mapping as CollectionMapping


SEEN = 2000
"""Objects that it is told by, evenly chosen."""
FEWEST = 20
"""Objects below which nothing is said."""
MOST = 0.3
"""Share of the objects whose words may say no class; museums of modern art name a sixth of theirs by bare titles."""
NAMED = 3
"""Names that are shown."""


def unknown_names(items: Sequence[Item]) -> str:
    """Return in words that the records of many objects name no class that is known; "" where few do.

    Parameters
    ----------
    items : sequence of Item
        The objects.

    Returns
    -------
    str
        With the names that are most frequent, and what helps.
    """
    some = items[:: max(1, len(items) // SEEN)]
    # A title alone may name what a picture shows: what is taken for one is not held to stand.
    silent = [item for item in some if readings(item).silent and class_of(item).name not in PICTURES]
    if len(some) < FEWEST or len(silent) <= MOST * len(some):
        return ""
    names = Counter(item.object_name or item.title for item in silent if item.object_name or item.title)
    told = ", ".join(repr(name[:40]) for name, _ in names.most_common(NAMED)) or "no name at all"
    return (
        f"{len(silent) / len(some):.0%} of the objects are called what names no class here, such as {told}: they are "
        "taken for free-standing objects. Where their words are of another language, name their classes in a file "
        "of rules, [collection] rules; where a column says what a thing is, choose it by --choose object_name=COLUMN"
    )


LOG_COLUMNS = ("row", "line", "object_number", "field", "what", "message", "remedy")


@dataclass(frozen=True)
class Imported:
    """What an import read, and what it changes, or would change if it were not a dry run.

    Attributes
    ----------
    held : int or None
        The version that a person went back to from this very source; a night leaves it there, and changes nothing.
    log : Path or None
        The file of the log; None for a dry run, and where nothing changed.
    """

    reading: Reading
    changes: Difference | None
    held: int | None = None
    log: Path | None = None

    @property
    def display_said(self) -> bool:
        """Whether a column says what is on display, or a location does."""
        stores = any(not item.on_display and item.gallery != NOWHERE for item in self.reading.items)
        return self.reading.flagged or stores

    @cached_property
    def unknown(self) -> str:
        """What is to be said of words that name no class, as `unknown_names` says it."""
        return unknown_names(self.reading.items)

    @property
    def problems(self) -> list[tuple[Item, Problem]]:
        """Return every value that could not be accepted or is doubted, with its object."""
        return [(item, problem) for item in self.reading.items for problem in item.problems]


def bundled_collection() -> Path:
    """Return the file of the bundled Carnegie rows."""
    return Path(__file__).resolve().parents[1] / "collection" / "data" / "carnegie_2000.csv"


@dataclass(frozen=True)
class Preset:
    """A mapping that comes with Kouros: the museum or the system that it is for, what it expects, and its file."""

    about: str
    expects: str
    file: Path


def presets() -> dict[str, Preset]:
    """Return the mappings that come with Kouros, by name; what each expects is the first sentence of its file."""
    found = {}
    for name in preset_names():
        file = preset_file(name)
        lines = takewhile(lambda line: line.startswith("# "), file.read_text(encoding="utf-8").splitlines())
        words = " ".join(line.removeprefix("# ") for line in lines)
        found[name] = Preset(load_mapping(name).museum.name, re.split(r"(?<=[a-z)])\. ", words)[0].rstrip("."), file)
    return found


@dataclass(frozen=True)
class Proposed:
    """A guessed mapping, and what it makes of the source: what was read, and some of the objects in words.

    Attributes
    ----------
    name : str
        For a file with the mapping, without its ending.
    shown : str
        The source in messages, without secrets.
    unknown : str
        What is to be said of words that name no class, as `unknown_names` says it.
    """

    name: str
    shown: str
    guess: "Guess"
    reading: Reading
    examples: tuple[str, ...]
    unknown: str = ""


def _exchanged(
    suspicions: Sequence[Suspicion], mapping: "CollectionMapping", choices: Mapping[str, str]
) -> dict[str, str]:
    """Return the columns of two sides that texts say are exchanged, each by the other's field; none that was chosen."""
    for one in suspicions:
        if one.holds != "sides":
            continue
        first, second = one.field.split(", ")
        columns = [mapping.columns.get(field) for field in (first, second)]
        names = [column.column for column in columns if column is not None and column.column is not None]
        if len(names) == 2 and not {first, second} & choices.keys():
            return {first: names[1], second: names[0]}
    return {}


def proposed(
    source: str, table: str | None = None, most: int = 10, choices: Mapping[str, str] | None = None
) -> Proposed:
    """Guess a mapping for a file or a database and read it with that; nothing is written.

    Parameters
    ----------
    table, choices
        See `guess`.

    Returns
    -------
    Proposed

    Raises
    ------
    CollectionError
        For a source that cannot be read.
    """
    from pipeline.collection.guess import guess

    found = guess(source, table, choices)
    reading = _with_sizes(read_items(source, found.mapping), found.mapping)
    crossed = _exchanged(reading.suspicions, found.mapping, choices or {})
    if crossed:
        again = guess(source, table, {**(choices or {}), **crossed})
        right = _with_sizes(read_items(source, again.mapping), again.mapping)
        if not any(one.holds == "sides" for one in right.suspicions):
            told = next(one.message for one in reading.suspicions if one.holds == "sides")
            kept = " ".join(f"--choose {field}={found.mapping.columns[field].column}" for field in crossed)
            said = f"{told}: the two columns are taken the other way round; {kept} takes them as they are called"
            found, reading = replace(again, doubts=(said, *again.doubts)), right
    step = max(len(reading.items) // most, 1)
    examples = tuple(_in_words(item) for item in reading.items[::step][:most])
    if is_address(source):
        shown = expand_secrets(source).shown
        named = (
            re.sub(r"[^A-Za-z0-9_.-]+", "-", getattr(found.mapping.source, "table", None) or "query").strip("-.")
            or "mapping"
        )
    else:
        shown, named = source, Path(source).stem
    return Proposed(named, shown, found, reading, examples, unknown_names(reading.items))


def _with_sizes(reading: Reading, mapping: "CollectionMapping") -> Reading:
    """Return a reading with what the classes of its objects say of its unit, where nothing else says so already."""
    if any(one.holds == "units" for one in reading.suspicions):
        return reading
    open_, settled = judged(unfit_sizes(reading.items), mapping.holds)
    return replace(reading, suspicions=(*reading.suspicions, *open_), choices=(*reading.choices, *settled))


def _in_words(item: Item) -> str:
    sides = (("H", item.height_m), ("W", item.width_m), ("D", item.depth_m))
    size = " x ".join(f"{name} {figures(100.0 * value, 4)}" for name, value in sides if value is not None)
    mass = "" if item.mass_kg is None else f", {figures(item.mass_kg, 5)} kg"
    what = ", ".join(filter(None, (item.object_name, item.title and f"{item.title[:50]!r}", item.medium[:40])))
    told = [one for one in dict.fromkeys((item.gallery, item.case, item.displayed)) if one]
    # "Case 7" is not said again before "Case 7, shelf 2".
    place = ", ".join(one for one in told if not any(_begins(other, one) for other in told))
    return f"{item.object_number} | {place} | {what} | {f'{size} cm' if size else 'no size'}{mass}"


def _begins(text: str, words: str) -> bool:
    """Whether a text begins with whole words of another, and goes on."""
    rest = text.casefold().removeprefix(words.casefold())
    return 0 < len(rest) < len(text) and not rest[0].isalnum()


def source_of(workspace: Workspace, source: str) -> str:
    """Return where a source of the settings is: a database's URL as it is, a file's path from the settings' folder."""
    return source if is_address(source) else str(workspace.settings.path(source))


def accepted(settings: Settings) -> Limits:
    """Return how much of the collection the settings accept."""
    said = settings.limits
    return Limits(round(1e6 * said.megabytes), said.rows, said.seconds)


def import_collection(
    workspace: Workspace,
    source: str | Path,
    mapping: str,
    *,
    shrink_limit: float,
    dry_run: bool = False,
    nightly: bool = False,
) -> Imported:
    """Read a museum's records and make the inventory what they say, all of it or nothing.

    Parameters
    ----------
    source : str | Path
        Path of a file, or the URL of a database.
    nightly : bool, optional
        Nobody is there to decide: a version that a person went back to stays until the source changes; and nobody looks
        on: rows that are as they were at the last reading are not read again.

    Returns
    -------
    Imported

    Raises
    ------
    CollectionError
    MappingError
    ShrunkError
        As reading and writing do, and ContradictionError where the source contradicts itself in most rows and the
        mapping does not say what holds; nothing is written then.
    """
    key = source_key(workspace.settings, source, mapping)
    known = known_rows(workspace.engine, key) if nightly else None
    read = mapping_of(workspace.settings, mapping)
    reading = _with_sizes(read_items(source, read, accepted(workspace.settings), known), read)
    if nightly:
        stays = held(workspace.engine, reading.sha256)
        if stays is not None:
            if not dry_run:
                hold_source(workspace.engine, key, reading.sha256)
            return Imported(reading, None, held=stays)
    require_settled(reading.source, reading.suspicions)
    last = latest_import(workspace.engine)
    changes = replace_inventory(workspace.engine, reading, shrink_limit=shrink_limit, dry_run=dry_run, key=key)
    after = latest_import(workspace.engine)
    if after is None or last == after or workspace.settings.rehearsal is not None:
        return Imported(reading, changes)
    log = workspace.settings.path(IMPORTS) / f"{after.id:05d}-{after.imported_at[:10]}.csv"
    _write_log(log, reading, changes)
    return Imported(reading, changes, log=log)


def go_back(workspace: Workspace, version: int, *, dry_run: bool = False) -> Difference:
    """Make the inventory what it was after an earlier import; a dry run only says what that would change.

    Raises
    ------
    CollectionError
        For a version that does not exist.
    """
    return return_to(workspace.engine, version, dry_run=dry_run)


def _write_log(path: Path, reading: Reading, changes: Difference) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as aside, aside.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(LOG_COLUMNS)
        writer.writerows(
            [safe_cell(cell) if isinstance(cell, str) else cell for cell in row] for row in log_rows(reading, changes)
        )


def log_rows(reading: Reading, changes: Difference) -> Iterator[tuple[Any, ...]]:
    """Yield the log, row by row as LOG_COLUMNS names them: what was refused, doubted, new, changed and gone."""
    for out in reading.rejected:
        yield out.row, out.line, "", out.field, "rejected", out.message, out.remedy
    for doubt in reading.suspicions:
        yield "", "", "", doubt.field, "suspicion", doubt.message, doubt.remedy
    for choice in reading.choices:
        yield "", "", "", choice.field, "choice", choice.message, choice.remedy
    noted = () if reading.unread is None else reading.unread.noted
    unread = (
        (row, line, number, field, "problem", message, remedy) for row, line, number, field, message, remedy in noted
    )
    yield from merge(unread, _rows_read(reading, changes), key=itemgetter(0))
    for number in changes.removed:
        yield "", "", number, "", "gone", "no longer in the source", ""


def _rows_read(reading: Reading, changes: Difference) -> Iterator[tuple[Any, ...]]:
    added = set(changes.added)
    for item, (row, line) in zip(reading.items, reading.places, strict=True):
        number = item.object_number
        for problem in item.problems:
            yield row, line, number, problem.field, "problem", problem.message, problem.remedy
        if number in added:
            yield row, line, number, "", "new", "", ""
        for field, (old, new) in changes.changed.get(number, {}).items():
            yield row, line, number, field, "changed", f"{_short(old)} -> {_short(new)}", ""


def _short(value: Any, most: int = 200) -> str:
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= most else f"{text[:most]}..."
