"""The report of a reading: what was refused and is doubted, kept with the version that it led to.

Values that are doubted are problems of the objects themselves; the table `reading` holds what the objects do not know.
"""

from __future__ import annotations

import json
import warnings
import zlib
from collections.abc import Collection, Iterable, Iterator
from typing import Any

from sqlalchemy import Column, Connection, Engine, ForeignKey, Integer, LargeBinary, Table, delete, insert, select

from pipeline.collection.database import METADATA
from pipeline.collection.inventory.records import RECORD_COLUMNS, shown, sound
from pipeline.collection.inventory.tables import IMPORT_BATCH, ITEM, doubted, newest
from pipeline.collection.reading import Reading
from pipeline.collection.sealing import damaged_rows, require_sound, seal_column, write_seals
from pipeline.collection.used import characters_of, used_of
from pipeline.errors import DamageWarning
from pipeline.records import Account, Doubt, Item
from pipeline.records.run import CHOICE, DOUBTFUL, REFUSED, SHEET, SOURCE

PLACES = 50_000
"""Doubtful objects of which a version keeps row and line: of more their numbers must do."""

CELLS = 10_000
"""What was not used of sheets of our own that a version keeps: the newest."""

_CHUNK = 1_000
"""Records that are read at a time."""

_STREAM = {"yield_per": _CHUNK}

READING = Table(
    "reading",
    METADATA,
    Column("version", Integer(), ForeignKey("import_batch.id", ondelete="CASCADE"), primary_key=True),
    Column("told", LargeBinary(), nullable=False),
    seal_column(),
)
"""One row for each version of which it is known; told is compressed JSON.

base       : the version whose row of import_batch counts the rows and names those refused: of a sheet the import below
             it, of a return the one returned to; null where that is not known
flagged    : whether a column says what is on display
suspicions : field, message and remedy of each
choices    : the same of what was settled by choice; lacking where an earlier Kouros wrote it
places     : by object number, row and line of a doubtful object
doubtful   : how many of these there are
sheets     : what was not used of sheets of our own: sheet, row, line, object number, field, message, remedy
"""

Cell = tuple[str, int, int, str, str, str, str]


def account(engine: Engine, version: int | None = None) -> Account | None:
    """Return what became of the rows behind a version.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    version : int, optional
        Of the inventory; the newest where left out.

    Returns
    -------
    Account or None
        None where that was not noted, as before an upgrade.
    """
    with engine.connect() as connection:
        number = newest(connection) if version is None else version
        known = None if number is None else _told(connection, number)
        if known is None or known["base"] is None:
            return None
        require_sound(connection, IMPORT_BATCH, IMPORT_BATCH.c.id == known["base"])
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == known["base"])).mappings().one()
    return Account(
        source=row["source"],
        rows=row["rows"],
        refused=len(row["rejected"]),
        doubtful=known["doubtful"],
        sheets=len(known["sheets"]),
        suspicions=tuple((field, message, remedy) for field, message, remedy in known["suspicions"]),
        flagged=known["flagged"],
        choices=tuple((field, message, remedy) for field, message, remedy in known.get("choices", ())),
    )


def doubts(engine: Engine, version: int) -> Iterator[Doubt]:
    """Yield everything that was refused or is doubted of a version; nothing where that was not noted.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    version : int
        Of the inventory.

    Yields
    ------
    Doubt
        What is of the whole source comes first, with what was settled by choice, then rows refused, then sheets, then
        objects by number.

    Raises
    ------
    DamagedRecordError
        For records of doubtful objects that are not what was written.
    """
    with engine.connect() as connection:
        known = _told(connection, version)
        if known is None or known["base"] is None:
            return
        for field, message, remedy in known["suspicions"]:
            yield Doubt(SOURCE, None, None, "", field, message, remedy)
        for field, message, remedy in known.get("choices", ()):
            yield Doubt(CHOICE, None, None, "", field, message, remedy)
        rejected = select(IMPORT_BATCH.c.rejected).where(IMPORT_BATCH.c.id == known["base"])
        for row in connection.execute(rejected).scalar_one():
            # Its place is told besides.
            message = row["message"].removeprefix(f"{row['file']}, row {row['row']} (line {row['line']}): ")
            yield Doubt(REFUSED, row["row"], row["line"], "", row["field"], message, row["remedy"])
        for sheet, at, line, number, field, message, remedy in known["sheets"]:
            yield Doubt(SHEET, at or None, line or None, number, field, f"{sheet}: {message}", remedy)
        wanted = select(*RECORD_COLUMNS).where(doubted(version)).order_by(ITEM.c.object_number)
        for some in connection.execute(wanted, execution_options=_STREAM).partitions(_CHUNK):
            for item in sound(some, shown(engine)):
                place, below = known["places"].get(item.object_number, (None, None))
                for one in item.problems:
                    made = characters_of(item, one.field), used_of(item, one.field)
                    yield Doubt(DOUBTFUL, place, below, item.object_number, one.field, one.message, one.remedy, *made)


def note_import(
    connection: Connection, version: int, below: int | None, base: int, reading: Reading, doubtful: int
) -> None:
    """Keep what a reading of the museum's records refused and doubts.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    version : int
        That it led to.
    below : int or None
        The version before, which may be the same.
    base : int
        The import itself: sheets may have been laid over it since.
    reading : Reading
        What was read.
    doubtful : int
        Objects of that version with problems.
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
            "choices": [[one.field, one.message, one.remedy] for one in reading.choices],
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

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    version : int
        That it led to.
    below : int
        The version that it was laid over, which is the same where it says nothing new.
    reading : Reading
        What was read.
    unknown : collection of str
        Its objects that the inventory does not have.
    filled : collection of (str, str)
        Object number and field of what it fills in, so that an earlier sheet's failure is mended.
    doubtful : int
        Objects of that version with problems.
    """
    before = _sheets(connection, below)
    left = [one for one in before if one[0] != reading.source and (one[3], one[4]) not in filled]
    # Of what was imported before an upgrade nothing is known.
    known = _told(connection, below) or {"base": None, "flagged": False, "suspicions": [], "places": {}}
    _write(connection, version, known | {"doubtful": doubtful, "sheets": [*left, *_unused(reading, unknown)][-CELLS:]})


def note_return(connection: Connection, version: int, back: int) -> None:
    """Keep with a return what is kept with the version returned to.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    version : int
        That the return led to.
    back : int
        The version returned to.
    """
    known = _told(connection, back)
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
    known = None if version is None else _told(connection, version)
    return [] if known is None else [tuple(one) for one in known["sheets"]]


def _write(connection: Connection, version: int, known: dict[str, Any]) -> None:
    content = zlib.compress(json.dumps(known, separators=(",", ":")).encode())
    mine = READING.c.version == version
    same = connection.execute(select(READING.c.told).where(mine)).scalar() == content
    if same and not any(damaged_rows(connection, READING, mine)):
        return
    connection.execute(delete(READING).where(READING.c.version == version))
    connection.execute(insert(READING).values(version=version, told=content))
    write_seals(connection, READING, READING.c.version == version)


def _told(connection: Connection, version: int) -> dict[str, Any] | None:
    """Return what is kept with a version; None where nothing is, or nothing that can be believed, which is said."""
    if any(damaged_rows(connection, READING, READING.c.version == version)):
        problem = "what was refused and doubted of the museum's records changed in the database since it was noted"
        warnings.warn(f"{problem}: it is not known, import again", DamageWarning, stacklevel=3)
        return None
    found = connection.execute(select(READING.c.told).where(READING.c.version == version)).scalar()
    return None if found is None else dict(json.loads(zlib.decompress(found)))
