"""What reading refused and doubts is kept with the version that it led to, so that every later night can say it.

Values that are doubted are problems of the objects themselves; here is what the objects do not know.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

from sqlalchemy import Column, Connection, ForeignKey, Integer, LargeBinary, Table, delete, insert, select

from pipeline.collection.database import METADATA

if TYPE_CHECKING:
    from pipeline.collection.reading import Reading
    from pipeline.records import Item

PLACES = 50_000
"""Doubtful objects of which a version keeps row and line: of more their numbers must do."""

CELLS = 10_000
"""What was not used of sheets of our own that a version keeps: the newest."""

READING = Table(
    "reading",
    METADATA,
    Column("version", Integer(), ForeignKey("import_batch.id", ondelete="CASCADE"), primary_key=True),
    Column("told", LargeBinary(), nullable=False),
)
"""One row for each version of which it is known; told is compressed JSON.

base       : the version whose row of import_batch counts the rows and names those refused: of a sheet the import below
             it, of a return the one returned to; null where that is not known
flagged    : whether a column says what is on display
suspicions : field, message and remedy of each
places     : by object number, row and line of a doubtful object
doubtful   : how many of these there are
sheets     : what was not used of sheets of our own: sheet, row, line, object number, field, message, remedy
"""

Cell = tuple[str, int, int, str, str, str, str]


def told(connection: Connection, version: int) -> dict[str, Any] | None:
    """Return what is kept with a version; None where nothing is."""
    found = connection.execute(select(READING.c.told).where(READING.c.version == version)).scalar()
    return None if found is None else dict(json.loads(zlib.decompress(found)))


def note_import(
    connection: Connection, version: int, below: int | None, base: int, reading: Reading, doubtful: int
) -> None:
    """Keep what a reading of the museum's records refused and doubts.

    version  : that it led to;  below: the one before, which may be the same
    base     : the import itself: sheets may have been laid over it since
    doubtful : objects of that version with problems
    """
    places = {number: (row, line) for row, line, number, *_ in (() if reading.unread is None else reading.unread.noted)}
    places |= {item.object_number: place for item, place in _placed(reading) if item.problems and place[0]}
    kept = sorted(places.items(), key=lambda one: one[1])[:PLACES]
    _write(
        connection,
        version,
        {
            "base": base,
            "flagged": reading.flagged,
            "suspicions": [[one.field, one.message, one.remedy] for one in reading.suspicions],
            "places": dict(kept),
            "doubtful": doubtful,
            "sheets": _sheets(connection, below),
        },
    )


def note_sheet(
    connection: Connection,
    version: int,
    below: int,
    reading: Reading,
    unknown: Collection[str],
    filled: Collection[tuple[str, str]],
    doubtful: int,
) -> None:
    """Keep what was not used of a sheet of our own, beside what is kept already.

    version : that it led to;  below: the one that it was laid over, which is the same where it says nothing new
    unknown : its objects that the inventory does not have
    filled  : object number and field of what it fills in, so that an earlier sheet's failure is mended
    """
    before = _sheets(connection, below)
    left = [one for one in before if one[0] != reading.source and (one[3], one[4]) not in filled]
    # Of what was imported before an upgrade nothing is known.
    known = told(connection, below) or {"base": None, "flagged": False, "suspicions": [], "places": {}}
    _write(connection, version, known | {"doubtful": doubtful, "sheets": [*left, *_unused(reading, unknown)][-CELLS:]})


def note_return(connection: Connection, version: int, back: int) -> None:
    """Keep with a return what is kept with the version returned to."""
    known = told(connection, back)
    if known is not None:
        _write(connection, version, known)


def _placed(reading: Reading) -> Iterable[tuple[Item, tuple[int, int]]]:
    """Return the items with row and line: 0 where the reading does not say where they stood."""
    return zip(reading.items, reading.places or [(0, 0)] * len(reading.items), strict=True)


def _unused(reading: Reading, unknown: Collection[str]) -> Iterable[Cell]:
    for out in reading.rejected:
        yield reading.source, out.row, out.line, "", out.field, out.message, out.remedy
    for item, (row, line) in _placed(reading):
        number = item.object_number
        if number in unknown:
            remedy = "see whether its number is that of the museum's records"
            yield reading.source, row, line, number, "object_number", "the inventory has no such object", remedy
        for problem in item.problems:
            # That a sheet leaves the place empty is no matter: it does not change it.
            if problem.field != "gallery":
                yield reading.source, row, line, number, problem.field, problem.message, problem.remedy


def _sheets(connection: Connection, version: int | None) -> list[Cell]:
    known = None if version is None else told(connection, version)
    return [] if known is None else [tuple(one) for one in known["sheets"]]


def _write(connection: Connection, version: int, known: dict[str, Any]) -> None:
    content = zlib.compress(json.dumps(known, separators=(",", ":")).encode())
    if connection.execute(select(READING.c.told).where(READING.c.version == version)).scalar() == content:
        return
    connection.execute(delete(READING).where(READING.c.version == version))
    connection.execute(insert(READING).values(version=version, told=content))
