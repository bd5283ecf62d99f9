"""A museum's records -> items: every row becomes an item, or is rejected with its number, its reason and the remedy."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from time import perf_counter
from typing import Any

from pipeline.collection.blocks import Block, Piece, cut
from pipeline.collection.cells import Cells
from pipeline.collection.contradictions import contradictions
from pipeline.collection.errors import CollectionError
from pipeline.collection.limits import STANDARD, Limits, Meter
from pipeline.collection.mapping import DIAMETER, ColumnMap, Mapping, Texts, check_header
from pipeline.collection.measured import fill, is_dimension
from pipeline.collection.record import KINDS, NUMBER_LIMIT, TEXT_LIMIT
from pipeline.collection.sources.delimited import RECORD_LIMIT
from pipeline.collection.sources.opening import open_source
from pipeline.collection.sources.rows import Row
from pipeline.collection.suspicion import Evidence, Suspicion, suspicions
from pipeline.errors import KourosError, fault_words
from pipeline.records import Item, Origin, Problem, Provenance

logger = logging.getLogger(__name__)

NOWHERE = "Location not recorded"
"""The gallery of an object whose location is empty."""


@dataclass(frozen=True, slots=True)
class Rejected:
    """A row that was kept out: row 1 is the first below the header, line 1 the first of the file."""

    file: str
    row: int
    line: int
    field: str
    message: str
    remedy: str


@dataclass(frozen=True, slots=True)
class Reading:
    """What a source held: ``rows`` is always the number of items and of rejected rows together.

    source  : the file's name, without its folder, or the database without its password
    sha256  : of the file's bytes, or of the rows that the database gave
    mapping : name of the mapping; museum and credit as the mapping gives them
    places  : of each item, its row and its line in the source
    suspicions : units that the whole source seems to have wrong
    blocks  : what became of its rows, for the next reading
    unread  : what was only counted, because it is as it was at the last reading; None: everything was read
    flagged : whether a column says what is on display
    """

    items: tuple[Item, ...]
    rows: int
    rejected: tuple[Rejected, ...]
    source: str
    sha256: str
    mapping: str
    museum: str
    credit: str = ""
    places: tuple[tuple[int, int], ...] = ()
    suspicions: tuple[Suspicion, ...] = ()
    blocks: tuple[Block, ...] = ()
    unread: Unread | None = None
    flagged: bool = False

    @property
    def objects(self) -> int:
        """How many objects the source has, read now or before."""
        return len(self.items) + (0 if self.unread is None else self.unread.objects)


@dataclass(frozen=True, slots=True)
class Unread:
    """The rows that are as they were at the last reading, all of which became objects.

    objects : how many
    gone    : numbers of the objects of that reading whose rows did not come again as they were
    noted   : the problems of the unread objects: row, line, object number, field, message, remedy
    """

    objects: int
    gone: frozenset[str]
    noted: tuple[tuple[int, int, str, str, str, str], ...]


def read_items(
    where: str | Path, mapping: Mapping, limits: Limits = STANDARD, before: Sequence[Block] | None = None
) -> Reading:
    """Read a museum's file or database, row by row.

    A value that cannot be accepted is None in its item, which keeps the reason as a problem; only rows that are broken,
    have no object number or repeat one are rejected.

    where  : path of a file, or the URL of a database
    limits : bytes, rows and seconds that are accepted
    before : the blocks of an earlier reading by the same mapping and code; those of its rows that come again are
             counted and not read
    raises : CollectionError for a source that is missing, unreadable, too large, empty or not in its encoding;
             MappingError where the mapping's columns are not the source's
    """
    since = perf_counter()
    with open_source(where, mapping, limits) as source:
        header = next(source.rows, None)
        if header is None:
            raise CollectionError(f"{source.name}: empty collection: there is no header; export it again")
        desk = _Desk(source.name, mapping, header, limits)
        for piece in cut(source, header.cells, before or (), desk.holds):
            desk.take(piece)
        digest = source.digest()
    logger.info(
        "%s: read %d rows in %.2f s by mapping %r", source.name, desk.rows, perf_counter() - since, mapping.name
    )
    if not desk.rows:
        raise CollectionError(f"{source.name}: empty collection: a header and no data rows; export it again")
    return Reading(
        items=tuple(desk.items),
        rows=desk.rows,
        rejected=tuple(desk.rejected),
        source=source.name,
        sha256=digest,
        mapping=mapping.name,
        museum=mapping.museum.name,
        credit=mapping.museum.credit,
        places=tuple(desk.places),
        suspicions=suspicions(desk.evidence),
        blocks=tuple(desk.blocks),
        unread=None if before is None else desk.unread(before),
        flagged=desk.flagged,
    )


class _Desk:
    """Where the rows of one file are looked at, one after the other."""

    def __init__(self, file: str, mapping: Mapping, header: Row, limits: Limits) -> None:
        names = [cell.strip() for cell in header.cells]
        check_header(mapping, file, names)
        self._file = file
        self._decimal = mapping.source.decimal
        self._columns: list[tuple[str, ColumnMap, list[int]]] = []
        for field, column in mapping.columns.items():
            places = [names.index(source) for source in column.sources if source in names]
            if places:
                self._columns.append((field, column, places))
        self.flagged = "on_display" in mapping.columns and (
            mapping.columns["on_display"].constant is not None or any(f == "on_display" for f, *_ in self._columns)
        )
        self._stores = {name.strip().casefold() for name in mapping.display.not_on_display}
        self._seen: dict[str, int] = {}
        texts = mapping.dimensions
        self._texts = texts and [names.index(source) for source in texts.columns if source in names]
        self._mapping = mapping
        self._constants = {f: c.constant for f, c in mapping.columns.items() if c.constant is not None}
        self.items: list[Item] = []
        self.places: list[tuple[int, int]] = []
        self.rejected: list[Rejected] = []
        self._meter = Meter(file, limits)
        self._unread: list[Block] = []
        self._noted: list[tuple[int, int, str, str, str, str]] = []
        self.blocks: list[Block] = []
        self.evidence = Evidence()

    @property
    def rows(self) -> int:
        return self._meter.rows

    def holds(self, block: Block) -> bool:
        """Say whether what became of the rows of a block holds again: none of its numbers was given already.

        Such a row must be refused, as it was not when it was read.
        """
        return self._seen.keys().isdisjoint(block.numbers)

    def take(self, piece: Piece) -> None:
        """Read the rows of a block, or only count them."""
        if piece.known is not None:
            self._take_over(piece, piece.known)
            return
        first, refused = len(self.items), len(self.rejected)
        at = {}
        for place, row in enumerate(piece.rows):
            try:
                self._take(row)
            except KourosError:
                raise
            except Exception as problem:  # noqa: BLE001 - whatever it is, it is this row's, and told
                self._reject(row, "", f"{FAILED}: {fault_words(problem)}", TELL)
            at[row.number] = place
        items = self.items[first:]
        numbers = tuple(item.object_number for item in items)
        if len(self.rejected) > refused:
            # It is never taken over, so that nothing need be known of its rows.
            block = Block("", numbers, (), Evidence.of(items))
        else:
            noted = tuple(
                (at[row], line - piece.line, item.object_number, problem.field, problem.message, problem.remedy)
                for item, (row, line) in zip(items, self.places[first:], strict=True)
                for problem in item.problems
            )
            block = Block(piece.digest, numbers, noted, Evidence.of(items), piece.span)
        self.blocks.append(block)
        self.evidence.add(block.evidence)

    def _take_over(self, piece: Piece, known: Block) -> None:
        self._meter.count(len(known.numbers))
        self._seen.update(zip(known.numbers, count(piece.number), strict=False))
        block = known
        if piece.rows:
            # Blank lines more or less change where its rows are, and nothing else.
            places = [row.line - piece.line for row in piece.rows]
            noted = tuple((one[0], places[one[0]], *one[2:]) for one in known.noted)
            block = replace(known, noted=noted, span=piece.span)
        self._noted += [(piece.number + one[0], piece.line + one[1], *one[2:]) for one in block.noted]
        self._unread.append(block)
        self.blocks.append(block)
        self.evidence.add(block.evidence)

    def unread(self, before: Sequence[Block]) -> Unread:
        """Return what was only counted."""
        again = {block.digest for block in self._unread}
        gone = frozenset(number for block in before if block.digest not in again for number in block.numbers)
        return Unread(sum(len(block.numbers) for block in self._unread), gone, tuple(self._noted))

    def _take(self, row: Row) -> None:
        self._meter.count()
        message, remedy = row.fault
        if message:
            self._reject(row, "", message, remedy)
            return
        cells = Cells(self._decimal)
        if row.faults:
            self._refuse_cells(row, cells)
        values: dict[str, Any] = self._constants | {
            field: _read(cells, field, column, [row.cells[i] for i in places])
            for field, column, places in self._columns
        }
        self._spread_diameter(values, cells)
        if self._texts and self._mapping.dimensions is not None:
            self._fill(values, cells, self._mapping.dimensions, [row.cells[i] for i in self._texts])
        for field, problem in contradictions(values):
            cells.problems.append(problem)
            if field:
                values[field] = None
                cells.provenance = [of for of in cells.provenance if of.field != field]
        number = values["object_number"]
        if not number:
            self._reject(row, "object_number", "the object has no number", "give it one in the museum's database")
        elif len(number) > NUMBER_LIMIT:
            message = f"an object number of {len(number)} characters, more than {NUMBER_LIMIT}"
            self._reject(row, "object_number", message, "see whether the cells of this row were shifted")
        elif " " in number and is_dimension(number):
            message = f"the object number {number!r} is a dimension: a line inside a cell of the row above became a row"
            self._reject(
                row, "object_number", message, "export again with quotation marks around texts of several lines"
            )
        elif number in self._seen:
            message = f"object number {number!r} was given in row {self._seen[number]} already; only that row is kept"
            self._reject(row, "object_number", message, "give each object its own number, and export one row an object")
        else:
            self._seen[number] = row.number
            self.items.append(self._item(values, cells))
            self.places.append((row.number, row.line))

    def _fill(self, values: dict[str, Any], cells: Cells, texts: Texts, found: list[str]) -> None:
        before, provenance = dict(values), list(cells.provenance)
        try:
            fill(values, cells, texts, found, self._decimal)
        except KourosError:
            raise
        except Exception as problem:  # noqa: BLE001 - whatever it is, it is this text's, and told
            # A half of it is no reading.
            values.clear()
            values.update(before)
            cells.provenance = provenance
            cells.problems.append(Problem("dimensions", f"{FAILED}: {fault_words(problem)}", TELL))

    def _refuse_cells(self, row: Row, cells: Cells) -> None:
        for field, column, places in self._columns:
            for cell in places:
                if cell in row.faults:
                    cells.refuse(field, column, *row.faults[cell])

    def _item(self, values: dict[str, Any], cells: Cells) -> Item:
        said = values.pop("on_display", None)
        gallery = values["gallery"]
        on_display = gallery.casefold() not in self._stores and said is not False
        if not gallery:
            gallery, on_display = NOWHERE, False
            remedy = "record its current location; until then it counts as not on display"
            cells.problems.append(Problem("gallery", "the location is empty", remedy))
        provenance = tuple(sorted(cells.provenance, key=lambda of: of.field))
        values.update(gallery=gallery, on_display=on_display, provenance=provenance, problems=tuple(cells.problems))
        return Item(**values)

    def _spread_diameter(self, values: dict[str, Any], cells: Cells) -> None:
        diameter = values.pop(DIAMETER, None)
        written = next((of.written for of in cells.provenance if of.field == DIAMETER), "")
        cells.provenance = [of for of in cells.provenance if of.field != DIAMETER]
        for field in ("width_m", "depth_m"):
            if values.get(field) is None:
                values[field] = diameter
                if diameter is not None:
                    cells.provenance.append(Provenance(field, Origin.DERIVED, written, "its diameter"))

    def _reject(self, row: Row, field: str, message: str, remedy: str) -> None:
        where = f"{self._file}, row {row.number} (line {row.line}): {message}"
        self.rejected.append(Rejected(self._file, row.number, row.line, field, where, remedy))


FAILED = "Kouros failed to read it, which is not your fault"
TELL = "please tell its makers, with the characters of this row"


def _read(cells: Cells, field: str, column: ColumnMap, texts: Sequence[str]) -> Any:
    """Return what a row's cells say for a field; what Kouros itself fails on is a problem, and no value."""
    kind = KINDS.get(field, "number")
    try:
        return _READ[kind](cells, field, column, texts)
    except KourosError:
        raise
    except Exception as problem:  # noqa: BLE001 - whatever it is, it is this cell's, and told
        cells.problems.append(Problem(field, f"{FAILED}: {fault_words(problem)}", TELL))
        return "" if kind == "text" else None


def _text(cells: Cells, field: str, column: ColumnMap, texts: Sequence[str]) -> str:
    # An object number is never cut: two that begin alike would become one.
    return cells.text(field, column, texts, limit=RECORD_LIMIT if field == "object_number" else TEXT_LIMIT)


_READ: dict[str, Callable[[Cells, str, ColumnMap, Sequence[str]], Any]] = {
    "text": _text,
    "number": Cells.number,
    "integer": Cells.integer,
    "choice": Cells.choice,
    "flag": Cells.flag,
}
