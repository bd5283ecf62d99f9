"""Reuse of what an earlier run computed: charts of the same motion by the same kernels."""

import warnings
from collections.abc import Iterable

from sqlalchemy import Engine, select

from pipeline.collection.sealing import damaged_rows, told
from pipeline.errors import DamageWarning
from pipeline.records import Chart
from pipeline.store.sound import damaged_heads, runs_but
from pipeline.store.tables import RUN, RUN_CHART

KERNELS = "kernels"
"""Key of a run's settings under which the version of the compiled models is kept."""


PICTURES = "pictures"
"""The same of the version of the kernels and of all other code that its charts depend on."""


CODE = "code"
"""The same of all code and tables that verdicts rest on besides the kernels."""


RULES = "rules"
"""Key of a run's settings under which the hash of the museum's own rules of classification is kept; "" for none."""


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


def stored_charts(engine: Engine, keys: Iterable[str], version: str) -> dict[str, Chart]:
    """Return those of the charts that the newest finished run has, if the same kernels and code drew them.

    keys    : chart keys; each contains the hash of its motion
    version : of the kernels and the code that draw them
    """
    wanted = set(keys)
    with engine.connect() as connection:
        finished = (RUN.c.status == "finished") & runs_but(damaged_heads(connection))
        newest = select(RUN.c.run_id, RUN.c.settings).where(finished).order_by(RUN.c.started.desc()).limit(1)
        row = connection.execute(newest).one_or_none()
        if row is None or row.settings.get(PICTURES) != version:
            return {}
        damaged = list(damaged_rows(connection, RUN_CHART, RUN_CHART.c.run_id == row.run_id))
        if damaged:
            warnings.warn(f"{told(RUN_CHART.name, damaged)}; they are drawn again", DamageWarning, stacklevel=2)
            return {}
        charts = connection.execute(select(RUN_CHART.c.chart).where(RUN_CHART.c.run_id == row.run_id)).scalars()
        return {chart.key: chart for chart in charts if chart.key in wanted}
