"""Whole runs into the database and out of it again, exactly as they were."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from itertools import islice
from operator import attrgetter
from typing import Any

from sqlalchemy import Connection, Engine, Row, Table, delete, insert, select
from sqlalchemy.exc import IntegrityError, SQLAlchemyError

from pipeline.records import (
    Assessment,
    Chart,
    Finding,
    Fragility,
    MotionSummary,
    Recommendation,
    RunChanges,
    RunRecord,
    Scene,
    Spacing,
    Standing,
    Verdict,
    Wish,
)
from pipeline.store import codec
from pipeline.store.changes import changes
from pipeline.store.codec import StoreError
from pipeline.store.tables import (
    FINDING,
    FRAGILITY,
    RECOMMENDATION,
    RUN,
    RUN_CHART,
    RUN_DECISION,
    RUN_MOTION,
    RUN_SCENE,
    RUN_WISH,
    SPACING,
)

__all__ = [
    "RunChanges",
    "RunSummary",
    "StoreError",
    "compare_runs",
    "latest_run_id",
    "list_runs",
    "load_run",
    "prune_runs",
    "save_run",
]

_CHUNK = 2_000
"""Rows that are put together before they are sent: few enough to be small, many enough for one journey."""

FINISHED, UNFINISHED = "finished", "unfinished"

_WISHES = "wishes"
"""Counted only where the run asked what is worth measuring: nothing asked is not the same as nothing found."""

_RUN_FIELDS = ("run_id", "started", "finished", "version", "site", "museum", "level_notes", "settings", "demonstration")


@dataclass(frozen=True, slots=True)
class RunSummary:
    """A run as a list shows it.

    status : "finished", or "unfinished" for a run without a time of finishing
    counts : objects, assessed, findings, pass, fail, undetermined, recommendations, charts, motions,
             and wishes where it asked for them
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


def save_run(engine: Engine, record: RunRecord) -> None:
    """Keep a whole run, in one transaction: all of it or, after any failure, nothing of it.

    engine : from `collection.database.open_database`, brought to head by `migrate.upgrade`
    record : times as text that sorts like time (ISO 8601, UTC); settings of text, numbers, truth values, None, and
             tuples, lists and mappings of them; every other Mapping of the records is a dict
    raises : StoreError for a run_id that is there already, an object that occurs twice, a finding of an object that the
             run did not assess, a value of the wrong type or text that is not Unicode (naming the object), or a
             database that refuses
    """
    _check(record)
    failure = f"run {record.run_id!a} was not stored, and nothing of it was kept"
    try:
        with _speaking(engine, failure), engine.begin() as connection:
            for table, rows in _tables(record):
                waiting = iter(rows)
                while chunk := list(islice(waiting, _CHUNK)):
                    connection.execute(insert(table), chunk)
    except IntegrityError as error:
        raise StoreError(f"{failure}: {_clash(record)}") from error


def load_run(engine: Engine, run_id: str | None = None) -> RunRecord:
    """Return a run equal to the one that was saved.

    run_id : None means the newest finished run
    raises : StoreError for a run that is not there (listing those that are), or that was pruned while it was read
    """
    with _speaking(engine, "the run could not be read"), engine.connect() as connection:
        if run_id is None:
            run_id = _latest(connection)
        if run_id is None:
            raise StoreError(f"there is no finished run in {_where(engine)}; make one with `kouros run`")
        head = _head(connection, run_id)
        findings = _by_object(connection, FINDING, Finding, run_id)
        recommendations = _by_object(connection, RECOMMENDATION, Recommendation, run_id)
        fragilities = _by_object(connection, FRAGILITY, Fragility, run_id)
        record = RunRecord(
            **{name: head[name] for name in _RUN_FIELDS},
            assessments=tuple(
                Assessment(
                    scene,
                    findings.get(number, ()),
                    recommendations.get(number, ()),
                    fragilities.get(number, ()),
                )
                for scene in _records(connection, RUN_SCENE, Scene, run_id)
                for number in (scene.item.object_number,)
            ),
            charts=_charts(connection, run_id),
            motions=tuple(_records(connection, RUN_MOTION, MotionSummary, run_id)),
            wishes=tuple(_records(connection, RUN_WISH, Wish, run_id)) if _WISHES in head["counts"] else None,
            spacings=tuple(_records(connection, SPACING, Spacing, run_id)),
            decisions=tuple(_records(connection, RUN_DECISION, Standing, run_id)),
        )
    if _counts(record) != head["counts"]:
        raise StoreError(
            f"run {run_id!r} is not whole in {_where(engine)}: {_counts(record)} instead of {head['counts']}; "
            "it was pruned while it was read, or changed by hand: choose another run"
        )
    return record


def list_runs(engine: Engine) -> tuple[RunSummary, ...]:
    """Return all runs, the last one that started first."""
    names = [field.name for field in fields(RunSummary)]
    with _speaking(engine, "the runs could not be listed"), engine.connect() as connection:
        rows = connection.execute(select(*(RUN.c[name] for name in names)).order_by(*_newest_first()))
        return tuple(RunSummary(*row) for row in rows)


def latest_run_id(engine: Engine) -> str | None:
    """Return the newest finished run, None where there is none."""
    with _speaking(engine, "the runs could not be listed"), engine.connect() as connection:
        return _latest(connection)


def compare_runs(engine: Engine, old: str, new: str) -> RunChanges:
    """Return what changed from one run to another: objects, inputs, verdicts, motions.

    raises : StoreError for a run that is not there, listing those that are
    """
    with _speaking(engine, f"the runs {old!r} and {new!r} could not be compared"), engine.connect() as connection:
        for run_id in (old, new):
            _head(connection, run_id)
        return changes(connection, old, new)


def prune_runs(engine: Engine, keep: int) -> tuple[str, ...]:
    """Remove all but the newest finished runs, and the unfinished ones that are older than the oldest of those.

    keep    : how many finished runs stay, at least 1
    returns : the runs that were removed, oldest first
    raises  : StoreError for keep below 1: the last report is never lost
    """
    if keep < 1:
        raise StoreError(f"keep is {keep}; at least 1 run must stay, so that there is always a report")
    with _speaking(engine, "no run was removed"), engine.begin() as connection:
        rows = connection.execute(select(RUN.c.run_id, RUN.c.status).order_by(*_newest_first())).all()
        finished = [place for place, row in enumerate(rows) if row.status == FINISHED]
        if len(finished) < keep:
            return ()
        gone = tuple(row.run_id for row in reversed(rows[finished[keep - 1] + 1 :]))
        for run_id in gone:
            connection.execute(delete(RUN).where(RUN.c.run_id == run_id))
        return gone


# ---------------------------------------------------------------------------------------------------------------------
# Writing


def _check(record: RunRecord) -> None:
    """Refuse what could not be read back equal, before anything is written."""
    run = f"run {record.run_id!a}"
    for assessment in record.assessments:
        item = assessment.scene.item
        where = f"{run}, object {item.object_number!a} in gallery {item.gallery!a}"
        _check_types(where, Assessment, assessment)
        judged: tuple[Finding | Recommendation | Fragility, ...] = (
            *assessment.findings,
            *assessment.recommendations,
            *assessment.fragilities,
        )
        for found in judged:
            if found.object_number != item.object_number:
                kind = type(found).__name__.lower()
                raise StoreError(f"{where} has a {kind} of object {found.object_number!a}; keep each with its object")
    for spacing in record.spacings:
        _check_types(f"{run}, neighbours {spacing.first!a} and {spacing.second!a}", Spacing, spacing)
    for motion in record.motions:
        _check_types(f"{run}, motion {motion.name!a}", MotionSummary, motion)
    for wish in record.wishes or ():
        _check_types(f"{run}, {wish.field} of object {wish.object_number!a}", Wish, wish)
    for standing in record.decisions:
        _check_types(f"{run}, decision {standing.decision.id}", Standing, standing)
    for key, chart in record.charts.items():
        _check_types(f"{run}, chart {key!a}", dict[str, Chart], {key: chart})
    head = {name: getattr(record, name) for name in _RUN_FIELDS if name not in {"settings", "level_notes"}}
    _check_types(run, dict[str, str | bool], head)
    _check_types(f"{run}, level_notes", tuple[str, ...], record.level_notes)
    try:
        codec.settings_to_json(record.settings)
    except StoreError as error:
        raise StoreError(f"{run}: {error}") from error


def _check_types(where: str, hint: Any, value: Any) -> None:
    try:
        codec.to_json(hint, value)
    except StoreError as error:
        raise StoreError(f"{where}: {error}") from error


def _clash(record: RunRecord) -> str:
    """Say which of the two unique things is not."""
    occurs = Counter(assessment.scene.item.object_number for assessment in record.assessments)
    twice = sorted(number for number, times in occurs.items() if times > 1)
    if twice:
        listed = ", ".join(map(ascii, twice[:5])) + (f" and {len(twice) - 5} more" if len(twice) > 5 else "")
        return f"it has more than one object {listed}; give each object its own number in the museum's records"
    return "there is a run of that id already, and runs are never overwritten; use another run_id"


def _tables(record: RunRecord) -> Iterator[tuple[Table, Iterable[dict[str, Any]]]]:
    """Yield each table with its rows, parents first."""
    of_run = {"run_id": record.run_id}
    everything = record.assessments
    advice = (recommendation for one in everything for recommendation in one.recommendations)
    yield RUN, [_run_row(record)]
    yield RUN_MOTION, _rows(of_run, MotionSummary, record.motions)
    charts = enumerate(record.charts.items())
    yield RUN_CHART, ({**of_run, "position": i, "key": key, "chart": chart} for i, (key, chart) in charts)
    yield RUN_WISH, _rows(of_run, Wish, record.wishes or ())
    standing = (
        row | {"object_number": row["decision"].object_number} for row in _rows(of_run, Standing, record.decisions)
    )
    yield RUN_DECISION, standing
    scenes = (assessment.scene for assessment in everything)
    yield RUN_SCENE, (row | _item_columns(row) for row in _rows(of_run, Scene, scenes))
    yield FINDING, _rows(of_run, Finding, (finding for one in everything for finding in one.findings))
    yield (
        RECOMMENDATION,
        _rows(of_run, Recommendation, advice),
    )
    yield FRAGILITY, _rows(of_run, Fragility, (curve for one in everything for curve in one.fragilities))
    yield SPACING, _rows(of_run, Spacing, record.spacings)


def _run_row(record: RunRecord) -> dict[str, Any]:
    return {name: getattr(record, name) for name in _RUN_FIELDS} | {
        "status": FINISHED if record.finished else UNFINISHED,
        "counts": _counts(record),
    }


def _rows(of_run: dict[str, Any], kind: type[Any], records: Iterable[Any]) -> Iterator[dict[str, Any]]:
    names = [field.name for field in fields(kind)]
    values = attrgetter(*names)
    for position, record in enumerate(records):
        yield {**of_run, "position": position, **dict(zip(names, values(record), strict=True))}


def _item_columns(row: Mapping[str, Any]) -> dict[str, Any]:
    item = row["item"]
    return {"object_number": item.object_number, "gallery": item.gallery, "on_display": item.on_display}


def _counts(record: RunRecord) -> dict[str, int]:
    verdicts = [finding.verdict for assessment in record.assessments for finding in assessment.findings]
    return {
        "objects": len(record.assessments),
        "assessed": sum(assessment.assessed for assessment in record.assessments),
        "findings": len(verdicts),
        **{verdict.value: verdicts.count(verdict) for verdict in Verdict},
        "recommendations": sum(len(assessment.recommendations) for assessment in record.assessments),
        "charts": len(record.charts),
        "motions": len(record.motions),
        **({} if record.wishes is None else {_WISHES: len(record.wishes)}),
    }


# ---------------------------------------------------------------------------------------------------------------------
# Reading


def _newest_first() -> tuple[Any, ...]:
    return RUN.c.started.desc(), RUN.c.finished.desc(), RUN.c.run_id.desc()


def _latest(connection: Connection) -> str | None:
    query = select(RUN.c.run_id).where(RUN.c.status == FINISHED).order_by(*_newest_first()).limit(1)
    newest: str | None = connection.execute(query).scalar()
    return newest


def _head(connection: Connection, run_id: str) -> Mapping[str, Any]:
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


def _by_object(connection: Connection, table: Table, kind: type[Any], run_id: str) -> dict[str, tuple[Any, ...]]:
    found: dict[str, list[Any]] = {}
    for record in _records(connection, table, kind, run_id):
        found.setdefault(record.object_number, []).append(record)
    return {number: tuple(records) for number, records in found.items()}


def _charts(connection: Connection, run_id: str) -> dict[str, Chart]:
    return {row.key: row.chart for row in _stored(connection, RUN_CHART, ("key", "chart"), run_id)}


def _where(engine: Engine) -> str:
    return f"the database {engine.url.render_as_string(hide_password=True)}"


@contextmanager
def _speaking(engine: Engine, what: str) -> Iterator[None]:
    """Turn what the database says, but for a clash of keys, into a StoreError that says what failed and where."""
    try:
        yield
    except IntegrityError:
        raise
    except SQLAlchemyError as error:
        if isinstance(getattr(error, "orig", None), StoreError):
            raise error.orig from error  # type: ignore[attr-defined]  # a StatementError around what a column's type said
        remedy = "make its tables with `kouros init`, and see that it can be reached and written"
        raise StoreError(f"{what}: {_where(engine)} says {getattr(error, 'orig', None) or error}; {remedy}") from error
