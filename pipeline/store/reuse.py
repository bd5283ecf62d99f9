"""What an earlier run computed and a later one may take over: charts of the same motion by the same kernels."""

from collections.abc import Iterable

from sqlalchemy import Engine, select

from pipeline.records import Chart
from pipeline.store.tables import RUN, RUN_CHART

KERNELS = "kernels"
"""Key of a run's settings under which the version of the compiled models is kept."""


def stored_charts(engine: Engine, keys: Iterable[str], kernels: str) -> dict[str, Chart]:
    """Return those of the charts that the newest finished run has, if it ran the same kernels.

    keys    : chart keys; each contains the hash of its motion
    kernels : version of the kernels that made them
    """
    wanted = set(keys)
    newest = (
        select(RUN.c.run_id, RUN.c.settings).where(RUN.c.status == "finished").order_by(RUN.c.started.desc()).limit(1)
    )
    with engine.connect() as connection:
        row = connection.execute(newest).one_or_none()
        if row is None or row.settings.get(KERNELS) != kernels:
            return {}
        charts = connection.execute(select(RUN_CHART.c.chart).where(RUN_CHART.c.run_id == row.run_id)).scalars()
        return {chart.key: chart for chart in charts if chart.key in wanted}
