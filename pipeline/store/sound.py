"""What an earlier run was, whole or of a part, and whether it is sound: one that is not is never compared."""

import warnings

from sqlalchemy import ColumnElement, Connection, Engine, Table, func, select

from pipeline.collection.sealing import damaged_rows, told
from pipeline.errors import DamageWarning
from pipeline.store.results import DamagedRunError
from pipeline.store.tables import RUN, RUN_CHART, RUN_DECISION, RUN_MOTION, RUN_PAGE

_PARTS = (RUN_MOTION, RUN_DECISION, RUN_CHART, RUN_PAGE)


_COUNTED = {"motions": RUN_MOTION, "charts": RUN_CHART, "pages": RUN_PAGE}
"""Tables of which a run knows how many rows it has."""


def damaged_heads(connection: Connection) -> list[str]:
    """Return the runs whose own rows are not what was written, which is said."""
    found = list(damaged_rows(connection, RUN))
    if found:
        warnings.warn(f"{told(RUN.name, found)}; left out: nothing is compared with it", DamageWarning, stacklevel=4)
    return found


def runs_but(damaged: list[str]) -> ColumnElement[bool]:
    """Return which rows of RUN are not among these."""
    return RUN.c.run_id.not_in(damaged)


def require_run(connection: Connection, run_id: str) -> None:
    """Refuse a run of which anything but its pages and results themselves is not what was written; none is no damage.

    Raises
    ------
    DamagedRunError
    """
    for table in (RUN, *_PARTS):
        found = list(damaged_rows(connection, table, table.c.run_id == run_id))
        if found:
            raise DamagedRunError(f"run {run_id!r} is damaged: {told(table.name, found)}; choose another run")
    counts = connection.execute(select(RUN.c.counts).where(RUN.c.run_id == run_id)).scalar() or {}
    for name, table in _COUNTED.items():
        there = _rows_of(connection, table, run_id)
        if counts.get(name, there) != there:
            raise DamagedRunError(
                f"run {run_id!r} is not whole: it has {there} {name} instead of {counts[name]}; choose another run"
            )


def _rows_of(connection: Connection, table: Table, run_id: str) -> int:
    return connection.execute(select(func.count()).select_from(table).where(table.c.run_id == run_id)).scalar_one()


def comparable(engine: Engine, run_ids: list[str]) -> str | None:
    """Return the first of some runs that can be compared with; of each before it, it is said why it cannot."""
    with engine.connect() as connection:
        for run_id in run_ids:
            try:
                require_run(connection, run_id)
            except DamagedRunError as problem:
                warnings.warn(f"{problem}; it is left out of the comparison", DamageWarning, stacklevel=2)
            else:
                return run_id
    return None


KERNELS = "kernels"
"""Key of a run's settings under which the version of the compiled models is kept."""


CODE = "code"
"""The same of the version of all code and tables that verdicts rest on besides the kernels."""


RULES = "rules"
"""Key of a run's settings under which the hash of the museum's own rules of classification is kept; "" for none."""


TABLES = "tables"
"""The same of the hashes of its own rows of what is assumed, by table."""


HOUSE = "house"


HOUSE_RULES = "house_rules"
"""The same of its house rules, in one hash."""


LEVELS = "levels"
"""Key of a run's settings under which it is kept how each level combines its motions."""


DISPLAY = "display"
"""Key of a run's settings under which it is kept whether what is not on display was assessed."""


SELECTION = "selection"
"""Key of a run's settings that is true for a run of a part of the collection."""


def whole_runs(engine: Engine) -> list[str]:
    """Return the finished runs of the whole collection, the newest first."""
    with engine.connect() as connection:
        sound = runs_but(damaged_heads(connection))
        finished = select(RUN.c.run_id, RUN.c.settings).where(RUN.c.status == "finished", sound)
        finished = finished.order_by(RUN.c.started.desc())
        return [row.run_id for row in connection.execute(finished) if not row.settings.get(SELECTION)]
