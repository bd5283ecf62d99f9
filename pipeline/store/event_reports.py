"""What people found in the galleries after an earthquake: only ever added; of an object the newest report counts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

from sqlalchemy import Connection, Engine, func, insert, select

from pipeline.collection.sealing import require_sound, write_seals
from pipeline.store.tables import EVENT_REPORT

_VALUES = EVENT_REPORT.c


@dataclass(frozen=True, slots=True)
class EventReport:
    """A row of the table event_report.

    Attributes
    ----------
    id : int
        Counts up.
    event : str
        Name of the earthquake's folder.
    object_number, state : str
        Of the object, and one of `pipeline.event.found.STATES`.
    moved_m : float or None
        How far it has moved, m; None where nobody said.
    note, who, recorded : str
        More words, whose, and when they were written down (ISO 8601, UTC).
    """

    id: int
    event: str
    object_number: str
    state: str
    moved_m: float | None
    note: str
    who: str
    recorded: str

    @property
    def said(self) -> tuple[str, float | None, str]:
        """What it says, whoever said it."""
        return self.state, self.moved_m, self.note


def event_reports(engine: Engine, event: str) -> dict[str, tuple[EventReport, ...]]:
    """Return what was found after an earthquake, by object number, in the order in which it was said.

    Raises
    ------
    DamagedRowsError
        Where any of it is not what was written.
    """
    found: dict[str, tuple[EventReport, ...]] = {}
    wanted = [_VALUES[field.name] for field in fields(EventReport)]
    with engine.connect() as connection:
        require_sound(connection, EVENT_REPORT)
        for row in connection.execute(select(*wanted).where(_VALUES.event == event).order_by(_VALUES.id)):
            report = EventReport(*row)
            found[report.object_number] = (*found.get(report.object_number, ()), report)
    return found


def newest_report(engine: Engine) -> int:
    """Return the id of the newest report of all: where it is as before, nothing was added."""
    with engine.connect() as connection:
        return _newest(connection)


def add_event_reports(
    engine: Engine, reports: Sequence[EventReport], seen: Mapping[str, int] | None = None
) -> tuple[EventReport, ...]:
    """Write down what was found: all of it, or nothing where somebody has said more of one of the objects.

    Parameters
    ----------
    engine : Engine
        Of the database.
    reports : sequence of EventReport
        Of one earthquake; their ids do not count.
    seen : mapping of str to int or None
        By object number the id of the newest report that whoever says this had seen, 0 for none; None: whatever there
        is.

    Returns
    -------
    tuple of EventReport
        What somebody else has said meanwhile: nothing was written then.
    """
    if not reports:
        return ()
    add = insert(EVENT_REPORT).returning(_VALUES.id)
    with engine.connect() as connection:
        # Written first: from here on nobody else writes, so that what is looked at stays as it is.
        rows = [
            {field.name: getattr(one, field.name) for field in fields(one) if field.name != "id"} for one in reports
        ]
        first = min(connection.execute(add, row).scalar_one() for row in rows)
        meanwhile = _meanwhile(connection, reports[0].event, first, seen or {})
        if not meanwhile:
            write_seals(connection, EVENT_REPORT, _VALUES.id >= first)
            connection.commit()
    return meanwhile


def _newest(connection: Connection) -> int:
    return int(connection.execute(select(func.coalesce(func.max(_VALUES.id), 0))).scalar_one())


def _meanwhile(connection: Connection, event: str, first: int, seen: Mapping[str, int]) -> tuple[EventReport, ...]:
    found = []
    for number, last in seen.items():
        mine = (_VALUES.event == event) & (_VALUES.object_number == number)
        newer = mine & (_VALUES.id > last) & (_VALUES.id < first)
        wanted = [_VALUES[field.name] for field in fields(EventReport)]
        row = connection.execute(select(*wanted).where(newer).order_by(_VALUES.id.desc()).limit(1)).one_or_none()
        if row is not None:
            found.append(EventReport(*row))
    return tuple(found)
