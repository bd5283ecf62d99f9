"""Whole runs into the database and out of it again, exactly as they were."""

import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import islice
from operator import attrgetter
from typing import Any

from sqlalchemy import Connection, Engine, Row, Table, insert, select, update
from sqlalchemy.exc import IntegrityError

from pipeline.collection.sealing import damaged_rows, write_seals
from pipeline.errors import DamageWarning
from pipeline.records import Chart, DecisionStatus, MotionSummary, Page, RunChanges, RunRecord
from pipeline.store import codec
from pipeline.store.changes import changes
from pipeline.store.codec import StoreError, explained, where_is
from pipeline.store.pages import add_pages, load_page
from pipeline.store.results import DamagedRunError
from pipeline.store.sound import damaged_heads, require_run, runs_but
from pipeline.store.tables import PAGE, RUN, RUN_CHART, RUN_DECISION, RUN_MOTION, RUN_PAGE

__all__ = [
    "RunChanges",
    "RunSummary",
    "StoreError",
    "commit_run",
    "compare_runs",
    "latest_run_id",
    "list_runs",
    "load_head",
    "load_run",
    "mark_finished",
]

_CHUNK = 2_000
"""Rows that are put together before they are sent: few enough to be small, many enough for one journey."""

FINISHED, UNFINISHED = "finished", "unfinished"

_RUN_FIELDS = ("run_id", "started", "finished", "version", "site", "museum", "level_notes", "settings", "demonstration")


@dataclass(frozen=True, slots=True)
class RunSummary:
    """A run as a list shows it.

    Attributes
    ----------
    status : str
        "finished", or "unfinished" for a run without a time of finishing.
    counts : mapping of str to int
        Objects, assessed, findings, pass, fail, undetermined, recommendations, pages, charts, motions, and wishes where
        it asked for them.
    """

    run_id: str
    started: str
    finished: str
    version: str
    site: str
    museum: str
    demonstration: bool
    status: str
    counts: Mapping[str, int]


def commit_run(
    engine: Engine,
    head: RunRecord,
    pages: Sequence[Page],
    fresh: Iterable[Mapping[str, Any]] = (),
    *,
    counts: Mapping[str, int],
    damaged: Collection[str] = (),
    published: bool = True,
) -> None:
    """Make a run of its pages, the results on which are kept already: in one transaction, all of it or nothing.

    Parameters
    ----------
    engine : Engine
        From `collection.database.open_database`, brought to head by `migrate.upgrade`.
    head : RunRecord
        The run without its objects; times as text that sorts like time (ISO 8601, UTC); settings of text, numbers,
        truth values, None, and tuples, lists and mappings of them; every other Mapping is a dict.
    fresh : iterable of mapping of str to Any, optional
        Rows of those of its pages that are not kept yet (see `pages.page_row`).
    counts : mapping of str to int
        How many objects, findings and so on it has.
    damaged : collection of str, optional
        Keys of pages that are there, and are to be written anew.
    published : bool, optional
        Whether it has its report already; where not, nobody takes it for a finished run until `mark_finished`.

    Raises
    ------
    StoreError
        For a run_id that is there already, a result that is not kept, a value of the wrong type or text that is not
        Unicode, or a database that refuses.
    """
    _check(head)
    status = FINISHED if published else UNFINISHED
    failure = f"run {head.run_id!a} was not stored, and nothing of it was kept"
    try:
        with explained(engine, failure), engine.begin() as connection:
            add_pages(connection, fresh, damaged)
            for table, rows in _tables(head, pages, counts, status):
                waiting = iter(rows)
                while chunk := list(islice(waiting, _CHUNK)):
                    connection.execute(insert(table), chunk)
                write_seals(connection, table, table.c.run_id == head.run_id)
    except IntegrityError as error:
        raise StoreError(
            f"{failure}: there is a run of that id already, and runs are never overwritten, or a result of it is gone; "
            "run again"
        ) from error


def mark_finished(engine: Engine, run_id: str) -> None:
    """Say that a run has its report: from now on it is the newest finished one; where that is known, nothing changes.

    Raises
    ------
    StoreError
        For a database that refuses.
    """
    failure = f"run {run_id!a} has its report, but could not be marked as finished"
    with explained(engine, failure), engine.begin() as connection:
        mine = (RUN.c.run_id == run_id) & (RUN.c.status != FINISHED)
        if connection.execute(select(RUN.c.run_id).where(mine)).scalar() is None or any(
            damaged_rows(connection, RUN, mine)
        ):
            return
        connection.execute(update(RUN).where(mine).values(status=FINISHED))
        write_seals(connection, RUN, RUN.c.run_id == run_id)


def load_head(engine: Engine, run_id: str | None = None) -> tuple[RunRecord, tuple[Page, ...]]:
    """Return a run without its objects, and its pages, whose objects `pages.load_page` gives.

    Parameters
    ----------
    run_id : str or None, optional
        None means the newest finished run.

    Returns
    -------
    tuple[RunRecord, tuple[Page, ...]]

    Raises
    ------
    StoreError
        For a run that is not there (listing those that are).
    """
    with explained(engine, "the run could not be read"), engine.connect() as connection:
        if run_id is None:
            run_id = _latest(connection)
        if run_id is None:
            raise StoreError(f"there is no finished run in {where_is(engine)}; make one with `kouros run`")
        head = _head(connection, run_id)
        record = RunRecord(
            **{name: head[name] for name in _RUN_FIELDS},
            assessments=(),
            charts=_charts(connection, run_id),
            motions=tuple(_records(connection, RUN_MOTION, MotionSummary, run_id)),
            decisions=tuple(_records(connection, RUN_DECISION, DecisionStatus, run_id)),
        )
        pages = _pages(connection, run_id)
    there = {"pages": len(pages), "charts": len(record.charts), "motions": len(record.motions)}
    told = {name: head["counts"].get(name) for name in there}
    if there != told:
        raise StoreError(
            f"run {run_id!r} is not whole in {where_is(engine)}: {there} instead of {told}; it was pruned while it was "
            "read, or changed by hand: choose another run"
        )
    return record, pages


def load_run(engine: Engine, run_id: str | None = None) -> RunRecord:
    """Return a whole run in memory, equal to the one that was saved; of a large collection that is much.

    Raises
    ------
    StoreError
        As `load_head`.
    """
    head, pages = load_head(engine, run_id)
    found = [load_page(engine, page.key) for page in pages]
    wishes = [one.wishes for one in found]
    return replace(
        head,
        assessments=tuple(assessment for one in found for assessment in one.assessments),
        wishes=None if any(w is None for w in wishes) else tuple(wish for w in wishes for wish in w or ()),
        spacings=tuple(spacing for one in found for spacing in one.spacings),
    )


def list_runs(engine: Engine) -> tuple[RunSummary, ...]:
    """Return all runs, the last one that started first."""
    names = [field.name for field in fields(RunSummary)]
    with explained(engine, "the runs could not be listed"), engine.connect() as connection:
        sound = runs_but(damaged_heads(connection))
        rows = connection.execute(select(*(RUN.c[name] for name in names)).where(sound).order_by(*_newest_first()))
        return tuple(RunSummary(*row) for row in rows)


def latest_run_id(engine: Engine) -> str | None:
    """Return the newest finished run, None where there is none."""
    with explained(engine, "the runs could not be listed"), engine.connect() as connection:
        return _latest(connection)


def changes_since(engine: Engine, old: str, new: str) -> RunChanges | None:
    """Return what changed from one run to another; None, which is said, where something of them is damaged or gone."""
    try:
        return compare_runs(engine, old, new)
    except DamagedRunError as problem:
        warnings.warn(f"{problem}: what changed since run {old!r} is not known", DamageWarning, stacklevel=2)
        return None


def compare_runs(engine: Engine, old: str, new: str) -> RunChanges:
    """Return what changed from one run to another: objects, inputs, verdicts, motions.

    Raises
    ------
    StoreError
        For a run that is not there, listing those that are.
    """
    with explained(engine, f"the runs {old!r} and {new!r} could not be compared"), engine.connect() as connection:
        for run_id in (old, new):
            _head(connection, run_id)
        return changes(connection, old, new)


# ---------------------------------------------------------------------------------------------------------------------
# Writing


def _check(head: RunRecord) -> None:
    """Refuse what could not be read back equal, before anything is written."""
    run = f"run {head.run_id!a}"
    for motion in head.motions:
        codec.check_type(f"{run}, motion {motion.name!a}", MotionSummary, motion)
    for standing in head.decisions:
        codec.check_type(f"{run}, decision {standing.decision.id}", DecisionStatus, standing)
    for key, chart in head.charts.items():
        codec.check_type(f"{run}, chart {key!a}", dict[str, Chart], {key: chart})
    named = {name: getattr(head, name) for name in _RUN_FIELDS if name not in {"settings", "level_notes"}}
    codec.check_type(run, dict[str, str | bool], named)
    codec.check_type(f"{run}, level_notes", tuple[str, ...], head.level_notes)
    try:
        codec.settings_to_json(head.settings)
    except StoreError as error:
        raise StoreError(f"{run}: {error}") from error


def _tables(
    head: RunRecord, pages: Sequence[Page], counts: Mapping[str, int], status: str
) -> Iterator[tuple[Table, Iterable[dict[str, Any]]]]:
    """Yield each table with its rows, parents first."""
    of_run = {"run_id": head.run_id}
    yield RUN, [_run_row(head, {**counts, "pages": len(pages)}, status)]
    yield RUN_MOTION, _rows(of_run, MotionSummary, head.motions)
    charts = enumerate(head.charts.items())
    yield RUN_CHART, ({**of_run, "position": i, "key": key, "chart": chart} for i, (key, chart) in charts)
    standing = (
        row | {"object_number": row["decision"].object_number} for row in _rows(of_run, DecisionStatus, head.decisions)
    )
    yield RUN_DECISION, standing
    names = ("key", "gallery", "on_display", "number", "of")
    yield (
        RUN_PAGE,
        ({**of_run, "position": i, **{n: getattr(page, n) for n in names}} for i, page in enumerate(pages)),
    )


def _run_row(head: RunRecord, counts: Mapping[str, int], status: str) -> dict[str, Any]:
    return {name: getattr(head, name) for name in _RUN_FIELDS} | {
        "status": status if head.finished else UNFINISHED,
        "counts": {**counts, "charts": len(head.charts), "motions": len(head.motions)},
    }


def _rows(of_run: dict[str, Any], kind: type[Any], records: Iterable[Any]) -> Iterator[dict[str, Any]]:
    names = [field.name for field in fields(kind)]
    values = attrgetter(*names)
    for position, record in enumerate(records):
        yield {**of_run, "position": position, **dict(zip(names, values(record), strict=True))}


# ---------------------------------------------------------------------------------------------------------------------
# Reading


def _newest_first() -> tuple[Any, ...]:
    return RUN.c.started.desc(), RUN.c.finished.desc(), RUN.c.run_id.desc()


def _latest(connection: Connection) -> str | None:
    sound = runs_but(damaged_heads(connection))
    query = select(RUN.c.run_id).where(RUN.c.status == FINISHED, sound).order_by(*_newest_first()).limit(1)
    newest: str | None = connection.execute(query).scalar()
    return newest


def _head(connection: Connection, run_id: str) -> Mapping[str, Any]:
    require_run(connection, run_id)
    row = connection.execute(select(RUN).where(RUN.c.run_id == run_id)).mappings().first()
    if row is None:
        known = connection.execute(select(RUN.c.run_id).order_by(*_newest_first())).scalars().all()
        listed = ", ".join(map(repr, known)) or "none; make one with `kouros run`"
        raise StoreError(f"there is no run {run_id!r}; the runs, newest first, are: {listed}")
    return dict(row)


def _stored(connection: Connection, table: Table, names: Iterable[str], run_id: str) -> Iterator[Row[Any]]:
    query = select(*(table.c[name] for name in names)).where(table.c.run_id == run_id).order_by(table.c.position)
    yield from connection.execute(query, execution_options={"yield_per": _CHUNK})


def _records(connection: Connection, table: Table, kind: type[Any], run_id: str) -> Iterator[Any]:
    for row in _stored(connection, table, [field.name for field in fields(kind)], run_id):
        yield kind(*row)


def _pages(connection: Connection, run_id: str) -> tuple[Page, ...]:
    joined = RUN_PAGE.join(PAGE, RUN_PAGE.c.key == PAGE.c.key)
    columns = [RUN_PAGE.c[name] for name in ("key", "gallery", "on_display", "number", "of")]
    query = select(*columns, PAGE.c.run_id, PAGE.c.made).select_from(joined)
    rows = connection.execute(query.where(RUN_PAGE.c.run_id == run_id).order_by(RUN_PAGE.c.position))
    return tuple(Page(*tuple(row)) for row in rows)


def _charts(connection: Connection, run_id: str) -> dict[str, Chart]:
    return {row.key: row.chart for row in _stored(connection, RUN_CHART, ("key", "chart"), run_id)}
