"""What a lookup in a response chart costs beside the analysis it takes the place of, on the demonstration's record."""

import numpy as np

from pipeline.analysis.chart_runs import run_chart
from pipeline.analysis.model_runs import prepare, run_model
from pipeline.analysis.response_charts import ChartCache
from pipeline.models import MODELS
from pipeline.motions import read_motion
from pipeline.quantities import Array
from pipeline.records import Model, Motion, Numerics
from pipeline.resources import resource
from tests.benchmarks.common import SEED, clocked, fastest, least

LOOKUPS = 100_000
"""Parameter sets in one call that looks them up."""

ANALYSES = 200
"""Parameter sets that are integrated beside them, which gives the true errors."""

FIXED = {
    "swing": {"damping": 0.02},
    "swing_3d": {"damping": 0.02},
    "horizontal_isolator": {"damping": 0.02, "friction": 0.1},
}
"""The parameters besides that of the axis."""


def lookups() -> None:
    """Print the cost of each model's chart, of a lookup and of an analysis, in the worst direction or in both."""
    motion = read_motion(resource("site_motions", "demo"))[0]
    print(f"{motion.samples} samples, worst direction or both; {LOOKUPS:,} lookups in one call; errors are relative to")
    print("max(value, 1 % of the largest), against history; a chart pays from so many parameter sets on.")
    print(
        f"{'model':<22}{'tolerance':>10}{'build s':>9}{'ns lookup':>11}{'ns analysis':>13}{'ratio':>9}{'pays from':>11}"
        f"{'error 99 %':>12}{'most':>9}{'covered':>9}{'on it':>7}"
    )
    for model in MODELS:
        if model.chart is not None:
            _model(model, motion)


def _model(model: Model, motion: Motion) -> None:
    axis = model.chart
    assert axis is not None
    rng = np.random.default_rng(SEED)

    def sets(along: Array) -> dict[str, Array]:
        return prepare(model, {axis.name: along, **FIXED.get(model.name, {})})

    few = sets(np.exp(rng.uniform(np.log(axis.low), np.log(axis.high), ANALYSES)))
    true = run_model(model, motion, few, Numerics("history"), None)[0]
    first = model.gives[0].name
    size = np.maximum(true[first], 0.01 * true[first].max())
    analysis = fastest(lambda: run_model(model, motion, few, Numerics("history"), None), 2) / ANALYSES
    for tolerance in (1e-2, 1e-3):
        charts = ChartCache()

        def look(values: dict[str, Array], tolerance: float = tolerance, charts: ChartCache = charts):  # type: ignore[no-untyped-def]
            return run_chart(model, motion, values, Numerics(tolerance=tolerance), None, charts=charts)

        (columns, _, looked), build = clocked(lambda: look(few))
        build -= analysis * np.count_nonzero(~looked)
        # Of what is on the chart, so that no analysis is timed as a lookup.
        many = sets(np.resize(few[axis.name][looked], LOOKUPS))
        cost = least(lambda: look(many)) / LOOKUPS  # noqa: B023
        wrong = np.abs(columns[first] - true[first])[looked]
        relative = wrong / size[looked]
        covered = float(np.mean(wrong <= columns["error"][looked]))
        print(
            f"{model.name:<22}{tolerance:>10g}{build:>9.2f}{1e9 * cost:>11.0f}{1e9 * analysis:>13,.0f}"
            f"{analysis / cost:>9,.0f}{build / (analysis - cost):>11,.0f}{np.quantile(relative, 0.99):>12.0e}"
            f"{relative.max():>9.0e}{covered:>9.1%}{looked.mean():>7.1%}",
            flush=True,
        )
