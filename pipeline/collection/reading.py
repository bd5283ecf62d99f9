"""A museum's records -> items: every row becomes an item, or is rejected with its number, its reason and the remedy."""

from __future__ import annotations

import json
import logging
from collections import Counter, abc
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from dataclasses import field as member
from hashlib import blake2b
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from pipeline.collection.cells import Cells
from pipeline.collection.consistency import contradictions
from pipeline.collection.display_words import flag_of, tells_nothing
from pipeline.collection.errors import CollectionError, NoRowsError
from pipeline.collection.image_names import first_of, of_pattern
from pipeline.collection.limits import STANDARD, Limits, Meter
from pipeline.collection.mapping import ColumnMap, Mapping, check_header
from pipeline.collection.mapping_parts import Texts
from pipeline.collection.measured import fill, is_dimension
from pipeline.collection.naming import titled
from pipeline.collection.opening import open_source
from pipeline.collection.places import case_in, located, parted, spot_of
from pipeline.collection.record import KINDS, NUMBER_LIMIT, TEXT_LIMIT
from pipeline.collection.row_audit import RowAudit
from pipeline.collection.source_audit import audit, judged, taken_away
from pipeline.collection.sources.delimited import RECORD_LIMIT
from pipeline.collection.sources.headings import HEADING, heads_or_sums
from pipeline.collection.sources.rows import NO_FAULTS, Row
from pipeline.collection.unit_audit import Evidence, Suspicion
from pipeline.collection.whole_cells import read_whole_sizes, sides_among, spread_diameter
from pipeline.errors import KourosError, fault_words
from pipeline.records import Item, Problem

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


class KnownRow(NamedTuple):
    """What is known of a row that became an object.

    Attributes
    ----------
    object_number : str
        Of its object.
    noted : str or None
        Field, message and remedy of each of its problems, as JSON; None where it has none.
    evidence : str or None
        What it says about the units of the whole source (`unit_audit.Evidence.plain`), as JSON; None for nothing.
    """

    object_number: str
    noted: str | None
    evidence: str | None


KnownRows = abc.Mapping[str, KnownRow]
"""What is known of rows, by their digests."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What a source held: ``rows`` is always the number of objects and of rejected rows together.

    Attributes
    ----------
    items : tuple of Item
        What was read now.
    rows : int
        Of the source.
    rejected : tuple of Rejected
        Rows that were kept out.
    source : str
        The file's name, without its folder, or the database without its password.
    sha256 : str
        Of the file's bytes, or of the rows that the database gave.
    mapping, museum, credit : str
        Name of the mapping; museum and credit as the mapping gives them.
    places : tuple of (int, int)
        Of each item, its row and its line in the source.
    suspicions : tuple of Suspicion
        What the whole source seems to have wrong; those that say what must hold stop an import.
    choices : tuple of Suspicion
        What was settled for the whole source, by the mapping or unasked.
    known : mapping of str to KnownRow
        What is known of the rows that were read now, by their digests, for the next reading.
    unread : Unread or None
        What was only counted, because it is as it was at the last reading; None where everything was read.
    flagged : bool
        Whether a column says what is on display.
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
    known: KnownRows = member(default_factory=dict)
    unread: Unread | None = None
    flagged: bool = False
    choices: tuple[Suspicion, ...] = ()

    @property
    def objects(self) -> int:
        """How many objects the source has, read now or before."""
        return len(self.items) + (0 if self.unread is None else self.unread.objects)


@dataclass(frozen=True, slots=True)
class Unread:
    """The rows that are as they were at the last reading, all of which became objects.

    Attributes
    ----------
    objects : int
        How many.
    gone : frozenset of str
        Digests of the rows of that reading that did not come again, or not as objects.
    numbers : frozenset of str
        Numbers of the objects of those rows.
    noted : tuple
        The problems of the unread objects: row, line, object number, field, message, remedy.
    """

    objects: int
    gone: frozenset[str]
    numbers: frozenset[str]
    noted: tuple[tuple[int, int, str, str, str, str], ...]


def read_items(
    where: str | Path,
    mapping: Mapping,
    limits: Limits = STANDARD,
    known: KnownRows | None = None,
) -> Reading:
    """Read a museum's file or database, row by row.

    A value that cannot be accepted is None in its item, which keeps the reason as a problem; only rows that are broken,
    have no object number or repeat one are rejected.

    Parameters
    ----------
    where : str or Path
        Path of a file, or the URL of a database.
    mapping : Mapping
        Which column is which field.
    limits : Limits
        Bytes, rows and seconds that are accepted.
    known : mapping of str to KnownRow, optional
        What is known of the rows of an earlier reading by the same mapping, code and limits, by their digests: those
        that come again are counted and not read.

    Returns
    -------
    Reading
        With items of the rows that were read.

    Raises
    ------
    CollectionError
        For a source that is missing, unreadable, too large, empty or not in its encoding.
    MappingError
        Where the mapping's columns are not the source's.
    """
    since = perf_counter()
    with open_source(where, mapping, limits) as source:
        header = next(source.rows, None)
        if header is None:
            raise CollectionError(f"{source.name}: empty collection: there is no header; export it again")
        reader = RowReader(source.name, mapping, header, limits, known or {})
        for row in source.rows:
            reader.take(row)
        digest = source.digest()
    logger.info(
        "%s: read %d rows in %.2f s by mapping %r", source.name, reader.rows, perf_counter() - since, mapping.name
    )
    if not reader.rows:
        raise NoRowsError(f"{source.name}: empty collection: a header and no data rows; export it again")
    evidence = reader.evidence()
    open_, settled = judged(audit(evidence, mapping.columns, reader.audit.rows), mapping.holds)
    return Reading(
        items=tuple(reader.items),
        rows=reader.rows,
        rejected=tuple(reader.rejected),
        source=source.name,
        sha256=digest,
        mapping=mapping.name,
        museum=mapping.museum.name,
        credit=mapping.museum.credit,
        places=tuple(reader.places),
        suspicions=open_,
        choices=(*settled, *taken_away(evidence)),
        known=reader.found,
        unread=None if known is None else reader.unread(),
        flagged=reader.flagged,
    )


def row_digest(header: bytes, cells: Sequence[str]) -> str:
    """Return the digest of a row: that of its cells and of the header, on which their meaning rests.

    Parameters
    ----------
    header : bytes
        What stands for the names of the columns.
    cells : sequence of str
        The row's cells.

    Returns
    -------
    str
        128 bits as hexadecimal digits.
    """
    text = "\0".join(cells)
    if text.count("\0") != len(cells) - 1:
        # Where the cells end must be told: JSON does it whatever they hold.
        text = json.dumps(cells)
    return blake2b(header + text.encode("utf-8", "surrogatepass"), digest_size=16).hexdigest()


class RowReader:
    """Turns the rows of one source into items, one after the other.

    Parameters
    ----------
    file : str
        The source's name, for messages.
    mapping : Mapping
        Which column is which field.
    header : Row
        The names of the columns.
    limits : Limits
        Rows and seconds that are accepted.
    known : mapping of str to KnownRow
        What is known of rows of an earlier reading, by their digests.
    """

    def __init__(self, file: str, mapping: Mapping, header: Row, limits: Limits, known: KnownRows) -> None:
        names = [cell.strip() for cell in header.cells]
        check_header(mapping, file, names)
        self._file = file
        self._decimal, self._thousands = mapping.source.decimal, mapping.source.thousands
        self._columns: list[tuple[str, ColumnMap, list[int]]] = []
        for field, column in mapping.columns.items():
            places = [names.index(source) for source in column.sources if source in names]
            if places:
                self._columns.append((field, column, places))
        self._sides = sides_among(self._columns)
        self._key = next(places for field, _, places in self._columns if field == "object_number")
        self.flagged = "on_display" in mapping.columns and (
            mapping.columns["on_display"].constant is not None or any(f == "on_display" for f, *_ in self._columns)
        )
        self.audit = RowAudit(mapping, names)
        self._shows = Evidence()
        self._seen: dict[str, int] = {}
        texts = mapping.dimensions
        self._texts = texts and [names.index(source) for source in texts.columns if source in names]
        self._named = tuple(source for source in texts.columns if source in names) if texts else ()
        placed = any(field == "gallery" for field, *_ in self._columns)
        beside = {at for _, _, places in self._columns for at in places} | set(self._texts or ())
        self._beside = {at for at in beside - set(self._key) if names[at] != HEADING} if placed else set()
        self._mapping = mapping
        self._constants: dict[str, str | bool] = {
            f: c.constant == "true" if KINDS.get(f) == "flag" else c.constant
            for f, c in mapping.columns.items()
            if c.constant is not None
        }
        self._header = bytes.fromhex(row_digest(b"", header.cells))
        self._known = known
        self._again: set[str] = set()
        self._noted: list[tuple[int, int, str, str, str, str]] = []
        self._evidence: Counter[str] = Counter()
        self._meter = Meter(file, limits)
        self.items: list[Item] = []
        self.places: list[tuple[int, int]] = []
        self.rejected: list[Rejected] = []
        self.found: dict[str, KnownRow] = {}

    @property
    def rows(self) -> int:
        """How many rows were taken."""
        return self._meter.rows

    def take(self, row: Row) -> None:
        """Read a row, or only count it where what is known of it holds again.

        It does not hold where an earlier row gave the object's number: then this one must be refused.
        """
        self._meter.count()
        # What its source found wrong is not in its cells.
        faulty = row.fault[0] or (row.faults is not NO_FAULTS and row.faults)
        digest = "" if faulty else row_digest(self._header, row.cells)
        known = self._known.get(digest)
        if known is not None and known.object_number not in self._seen:
            self._take_over(row, digest, known)
            return
        before = len(self.items)
        try:
            self._take(row)
        except KourosError:
            raise
        except Exception as problem:  # noqa: BLE001 - whatever it is, it is this row's, and told
            self._reject(row, "", f"{FAILED}: {fault_words(problem)}", TELL)
        for item in self.items[before:]:
            evidence = self._shows.plain()
            said = json.dumps(evidence, separators=(",", ":")) if any(evidence) else None
            if said is not None:
                self._evidence[said] += 1
            if digest:
                noted = [(one.field, one.message, one.remedy) for one in item.problems]
                self.found[digest] = KnownRow(item.object_number, json.dumps(noted) if noted else None, said)

    def _take_over(self, row: Row, digest: str, known: KnownRow) -> None:
        number = known.object_number
        self._seen[number] = row.number
        self._again.add(digest)
        if known.noted is not None:
            self._noted += [(row.number, row.line, number, *problem) for problem in json.loads(known.noted)]
        if known.evidence is not None:
            self._evidence[known.evidence] += 1

    def evidence(self) -> Evidence:
        """Return what all rows say about the units of the source."""
        whole = Evidence()
        for said, times in self._evidence.items():
            whole.add(Evidence.of_plain(json.loads(said)), times)
        return whole

    def unread(self) -> Unread:
        """Return what was only counted."""
        gone = frozenset(self._known.keys() - self._again)
        numbers = frozenset(self._known[digest].object_number for digest in gone)
        return Unread(len(self._again), gone, numbers, tuple(self._noted))

    def _take(self, row: Row) -> None:
        message, remedy = row.fault
        if message:
            self._reject(row, "", message, remedy)
            return
        cells = Cells(self._decimal, self._thousands)
        if row.faults:
            self._refuse_cells(row, cells)
        values: dict[str, Any] = self._constants | {
            field: _read(cells, field, self.audit.column_of(field, column, row, cells), [row.cells[i] for i in places])
            for field, column, places in self._columns
        }
        spread_diameter(values, cells)
        read_whole_sizes(values, cells, self._sides, row.cells, self._mapping.dimensions)
        if self._texts and self._mapping.dimensions is not None:
            self._fill(values, cells, self._mapping.dimensions, [row.cells[i] for i in self._texts])
        self.audit.lost(row, cells)
        self._shows = self.audit.look(row, values, cells)
        found = contradictions(values)
        self.audit.weigh(self._shows, row, values, [problem for _, problem in found])
        for field, problem in found:
            cells.problems.append(problem)
            if field:
                values[field] = _NOTHING.get(KINDS[field])
                cells.provenance = [of for of in cells.provenance if of.field != field]
        number = values["object_number"]
        if not number:
            missing = ("the object has no number", "give it one in the museum's database")
            fault = next((row.faults[at] for at in self._key if at in row.faults), None)
            message, remedy = missing if fault is None else (f"the cell of its number {fault[0]}", fault[1])
            self._reject(row, "object_number", message, remedy)
        elif len(number) > NUMBER_LIMIT:
            message = f"an object number of {len(number)} characters, more than {NUMBER_LIMIT}"
            self._reject(row, "object_number", message, "see whether the cells of this row were shifted")
        elif " " in number and is_dimension(number):
            message = f"the object number {number!r} is a dimension: a line inside a cell of the row above became a row"
            self._reject(
                row, "object_number", message, "export again with quotation marks around texts of several lines"
            )
        elif why := heads_or_sums(row, number, self._beside):
            self._reject(
                row, "object_number", f"{number!r} {why}", "leave it out, or give the object a number and a place"
            )
        elif number in self._seen:
            message = f"object number {number!r} was given in row {self._seen[number]} already; only that row is kept"
            self._reject(row, "object_number", message, "give each object its own number, and export one row an object")
        else:
            self._seen[number] = row.number
            self.items.append(self._item(row, values, cells))
            self.places.append((row.number, row.line))

    def _fill(self, values: dict[str, Any], cells: Cells, texts: Texts, found: list[str]) -> None:
        before, provenance = dict(values), list(cells.provenance)
        try:
            held = self._mapping.holds.texts == "texts"
            fill(values, cells, texts, found, self._decimal, names=self._named, texts_hold=held)
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

    def _item(self, row: Row, values: dict[str, Any], cells: Cells) -> Item:
        said = values.pop("on_display", None)
        gallery = values["gallery"]
        on_display = self.audit.display(self._shows, row, values["object_number"], gallery, said, cells)
        if not gallery:
            gallery, on_display = NOWHERE, False
            remedy = "record its current location; until then it counts as not on display"
            if said is not False:  # what is not on display, as a flag says, may well have no place that is told
                cells.problems.append(Problem("gallery", "the location is empty", remedy))
        elif self._mapping.columns["gallery"].cases:
            gallery, values["case"], held = parted(gallery)
            values["displayed"] = "; ".join(filter(None, (values.get("displayed"), held)))
        else:
            gallery = located(gallery)
        spot = spot_of(values.get("case") or "", values.get("furniture"))
        if spot:
            values["displayed"] = "; ".join(filter(None, (values.get("displayed"), spot)))
            values["case"] = ""
        if not values.get("case") and "case" not in self._mapping.columns:
            values["case"] = case_in(values.get("displayed") or "")
        photographs, shown = self._mapping.images, first_of(str(values.get("image") or ""))
        values["image"] = of_pattern(photographs.pattern, values["object_number"], shown)
        if values["image"] and not values.get("image_credit"):
            values["image_credit"] = photographs.credit
        provenance = tuple(sorted(cells.provenance, key=lambda of: of.field))
        titled(values, self._mapping.columns)
        values.update(gallery=gallery, on_display=on_display, provenance=provenance, problems=tuple(cells.problems))
        return Item(**values)

    def _reject(self, row: Row, field: str, message: str, remedy: str) -> None:
        where = f"{self._file}, row {row.number} (line {row.line}): {message}"
        self.rejected.append(Rejected(self._file, row.number, row.line, field, where, remedy))


FAILED = "Kouros failed to read it, which is not your fault"
TELL = "please tell its makers, with the characters of this row"


_NOTHING: abc.Mapping[str, Any] = {"text": "", "polygon": ()}
"""What a field of a kind holds where nothing is recorded; None for all others."""


def _read(cells: Cells, field: str, column: ColumnMap, texts: Sequence[str]) -> Any:
    """Return what a row's cells say for a field; what Kouros itself fails on is a problem, and no value."""
    kind = KINDS.get(field, "number")
    try:
        return _READ[kind](cells, field, column, texts)
    except KourosError:
        raise
    except Exception as problem:  # noqa: BLE001 - whatever it is, it is this cell's, and told
        cells.problems.append(Problem(field, f"{FAILED}: {fault_words(problem)}", TELL))
        return _NOTHING.get(kind)


def _text(cells: Cells, field: str, column: ColumnMap, texts: Sequence[str]) -> str:
    # An object number is never cut: two that begin alike would become one.
    text = cells.text(field, column, texts, limit=RECORD_LIMIT if field == "object_number" else TEXT_LIMIT)
    # A word for none is no isolator that an object stands on.
    return "" if field == "isolator" and (tells_nothing(text) or flag_of(text) is False) else text


_READ: dict[str, Callable[[Cells, str, ColumnMap, Sequence[str]], Any]] = {
    "text": _text,
    "number": Cells.number,
    "integer": Cells.integer,
    "choice": Cells.choice,
    "flag": Cells.flag,
    "polygon": Cells.polygon,
}
