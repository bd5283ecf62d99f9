"""The fidelity `chart`: what it says against `history` at fresh points, where it declines, and what it costs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from shaking import along_x, random_motion

from pipeline import respond
from pipeline.analysis.chart_runs import DECIDES, look_up, run_chart
from pipeline.analysis.model_runs import prepare, run_model
from pipeline.analysis.response_charts import ChartCache, ResponseChart
from pipeline.analysis.response_charts.response_chart import MOST_NODES, UNITS, axis_of, refine
from pipeline.models import MODELS, model_named
from pipeline.models.common import lift_ratios
from pipeline.motions import read_motion
from pipeline.quantities import Array
from pipeline.records import Columns, Motion, Numerics
from pipeline.resources import resource
from tests.soak import SOAK

LONG = pytest.mark.long("test_the_error_reported_covers_the_true_one")

CASES = {
    "sliding": ({}, 0.0),
    "sliding, one direction": ({"directions": 1.0}, 0.0),
    "friction_isolator": ({}, 0.0),
    "swing": ({"damping": 0.02}, 30.0),
    "swing, worst direction": ({"damping": 0.06}, None),
    "swing_3d": ({"damping": 0.05}, 0.0),
    "horizontal_isolator": ({"damping": 0.1, "friction": 0.05, "directions": 1.0}, 0.0),
}


def demo() -> Motion:
    return read_motion(resource("site_motions", "demo"))[0]


def fresh(name: str, count: int, seed: int) -> Array:
    axis = model_named(name).chart
    assert axis is not None
    return np.exp(np.random.default_rng(seed).uniform(np.log(axis.low), np.log(axis.high), count))


def counted(values: list[int], result: Array) -> Array:
    values.append(result.shape[0])
    return result


@pytest.mark.parametrize("case", list(CASES))
@pytest.mark.parametrize(
    "motion",
    [random_motion(3), pytest.param(random_motion(8, n=1500, pga=7.0), marks=LONG)],
    ids=lambda m: m.name,
)
def test_the_error_reported_covers_the_true_one(case: str, motion: Motion) -> None:
    """At 1,000 random points in 99 % at least, against `history`, which the nodes were run at."""
    name = case.split(",", maxsplit=1)[0]
    fixed, angle = CASES[case]
    model = model_named(name)
    assert model.chart is not None
    given = {model.chart.name: fresh(name, 1000, 1), **fixed}
    looked = respond(name, motion, fidelity="chart", angle=angle, azimuth_step=30.0, charts=ChartCache(), **given)
    true = respond(name, motion, angle=angle, azimuth_step=30.0, **given)
    # A short string whipped over the top is chaotic, and jumps of the worst direction are left to the integration.
    tame = true["rotation"] < 0.5 * np.pi if "rotation" in true else np.ones(1000, dtype=bool)
    assert (looked["fidelity"] == "chart")[tame].mean() > 0.98
    assert tame[given[model.chart.name] >= 0.1].mean() > 0.7
    first = model.gives[0].name
    assert (np.abs(looked[first] - true[first]) <= looked["error"]).mean() >= 0.99
    for quantity in model.gives:
        size = np.maximum(true[quantity.name], 0.01 * true[quantity.name].max())
        # The tolerance is 1e-3 by default; a kink may hide between three held-out points.
        assert (np.abs(looked[quantity.name] - true[quantity.name]) <= 1e-3 * size).mean() >= 0.99, quantity.name


def test_the_demonstration_against_the_reference() -> None:
    """Two-directional sliding: the reported error holds that of the nodes as well, so it covers the true one."""
    given = {"friction_static": fresh("sliding", 1000 if SOAK else 150, 2)}
    looked = respond("sliding", demo(), fidelity="chart", charts=ChartCache(), **given)
    true = respond("sliding", demo(), fidelity="reference", **given)
    assert (np.abs(looked["displacement"] - true["displacement"]) <= looked["error"]).mean() >= 0.99


def chart(name: str, motion: Motion, tolerance: float, most: int = MOST_NODES, **fixed: float) -> ResponseChart:
    model = model_named(name)

    def run(values: Mapping[str, Array]) -> Columns:
        return run_model(model, motion, values, Numerics("history"), 0.0)[0]

    left_out = {q.name: np.nan if q.default is None else q.default for q in model.needs}
    excitation = motion.excitation(None)
    return ResponseChart.build(model, axis_of(model), excitation, {**left_out, **fixed}, run, tolerance, most)


def test_a_tighter_tolerance_takes_more_nodes_and_keeps_it() -> None:
    motion, before = random_motion(5), 0
    for tolerance in (3e-2, 1e-2, 1e-3, 1e-4):
        made = chart("swing", motion, tolerance, damping=0.05)
        assert made.cells.nodes > before
        assert made.cells.resolved.mean() > 0.95
        before = made.cells.nodes


def test_a_chart_that_may_not_grow_says_which_error_it_has() -> None:
    """The worst cells go first; what is left unresolved reports the error that was measured there, and is not used."""
    motion = random_motion(5)
    made = chart("swing", motion, 1e-4, most=120, damping=0.0)
    assert made.cells.nodes <= 120
    assert not made.cells.resolved.all()
    assert made.worst("displacement") > 1e-4
    along = fresh("swing", 1000, 4)
    looked = made.look(along)
    model = model_named("swing")
    bodies = {"length": along, "damping": np.zeros(1000), "freedom": np.ones(1000)}
    true = run_model(model, motion, bodies, Numerics("history"), 0.0)[0]
    # Cells this wide hide whole peaks between their held-out points: a claim for nine in ten is all that can be made.
    assert (np.abs(looked.columns["displacement"] - true["displacement"]) <= looked.bounds["displacement"]).mean() > 0.9


def test_kinks_jumps_and_smooth_stretches_of_a_known_function() -> None:
    """|x - 1/3|, a step at 0.7 and a sine: kinks are closed in on, and only the cell with the step is unresolved."""

    def function(share: Array) -> Array:
        return np.abs(share - 1.0 / 3.0) + (share > 0.7) + 0.1 * (1.0 + np.sin(40.0 * share))

    sizes: list[int] = []

    def analyse(places: Array) -> Array:
        value = function(places / UNITS)
        return counted(sizes, np.column_stack([value, np.zeros_like(value), np.zeros_like(value)]))

    cells = refine(analyse, 1e-3)
    assert sum(sizes) == cells.nodes, "no place is run twice"
    edges = cells.edges / UNITS
    (bad,) = np.flatnonzero(~cells.resolved)
    assert edges[bad] <= 0.7 <= edges[bad + 1]
    kink = np.searchsorted(edges, 1.0 / 3.0) - 1
    assert np.diff(edges)[kink] < 0.25 * np.median(np.diff(edges))


def test_only_the_outputs_that_count_are_closed_in_on() -> None:
    """A smooth output beside one that is noise: for a picture of the first the second does not matter."""

    def analyse(places: Array) -> Array:
        share = places / UNITS
        noise = np.modf(1e4 * np.sin(1e5 * share))[0] ** 2
        nothing = np.zeros_like(share)
        return np.column_stack([2.0 + np.sin(7.0 * share), noise, nothing, nothing])

    both, first = refine(analyse, 1e-3), refine(analyse, 1e-3, counted=1)
    assert first.nodes < 0.1 * both.nodes
    assert first.resolved.all()
    assert not both.resolved.any()
    assert (first.bounds[:, 0] <= 1e-3 * first.values[..., 0].min(axis=1)).all()
    # What is known of the other is said all the same.
    assert (first.bounds[:, 1] > 0.1).all()


@pytest.mark.parametrize("name", [model.name for model in MODELS if model.chart is not None and model.chart.leads])
def test_a_verdicts_chart_follows_what_the_verdict_rests_on(name: str) -> None:
    """With little damping under strong shaking: a tenth of the axis was left to the integration before."""
    model, motion = model_named(name), random_motion(8, n=1500, pga=7.0)
    assert model.chart is not None
    assert model.demand == model.gives[0].name
    values = prepare(model, {model.chart.name: fresh(name, 1000, 2), "damping": 0.02})
    angle = None if model.directions == 2 else 0.0
    looked = look_up(model, motion, values, Numerics(tolerance=DECIDES, first=True), angle, ChartCache())
    assert looked.found.mean() > 0.98
    true = run_model(model, motion, values, Numerics("history"), angle)[0][model.demand]
    wrong = np.abs(looked.columns[model.demand] - true)[looked.found]
    assert (wrong <= looked.bounds[model.demand][looked.found]).mean() >= 0.99
    # What it does not follow it does not tell.
    assert all(np.isnan(looked.columns[other.name]).all() for other in model.gives[1:])


def test_nothing_moves_beyond_the_certificate() -> None:
    """The end of the chart stands exactly where the certificate says that it rests: exactly zero from there on."""
    motion = random_motion(3)
    rests = max(lift_ratios(motion.excitation(None)))
    given = np.array([np.nextafter(rests, 0.0), rests, np.nextafter(rests, 9.0), 2.0 * rests, 1.5, 40.0])
    table = respond("sliding", motion, fidelity="chart", charts=ChartCache(), friction_static=given)
    assert (table["fidelity"] == "chart").all()
    assert (table["displacement"][1:] == 0.0).all()
    assert table["displacement"][0] <= table["error"][0]
    assert respond("friction_isolator", motion, fidelity="chart", charts=ChartCache(), friction_static=given)[
        "acceleration"
    ].iloc[1:].to_numpy() == pytest.approx(np.hypot(*motion.acceleration[:2]).max(), rel=1e-12)


def test_a_motion_of_nothing() -> None:
    still = along_x(np.zeros(50), 0.01)
    table = respond("sliding", still, fidelity="chart", charts=ChartCache(), friction_static=[0.0, 0.01, 0.3])
    assert (table["displacement"] == 0.0).all()
    assert (
        respond("swing", still, fidelity="chart", charts=ChartCache(), length=1.0, damping=0.0)["error"] == 0.0
    ).all()


def test_what_is_on_no_chart_is_integrated_and_says_so() -> None:
    motion = random_motion(3)
    given = {"friction_static": np.array([0.1, 0.005, 0.2, 0.3]), "friction_kinetic": np.full(4, np.nan)}
    given["friction_kinetic"][2] = 0.15
    values = {**given, "directions": np.full(4, 2.0)}
    model = model_named("sliding")
    columns, _, looked = run_chart(model, motion, values, Numerics(), 0.0, charts=ChartCache())
    assert looked.tolist() == [True, False, False, True]
    true = run_model(model, motion, values, Numerics("history"), 0.0)[0]
    assert columns["displacement"][1:3].tolist() == true["displacement"][1:3].tolist()
    table = respond("sliding", motion, fidelity="chart", charts=ChartCache(), friction_static=[0.1, 0.005])
    assert table["fidelity"].tolist() == ["chart", "history"]


def test_each_combination_of_fixed_parameters_has_its_chart_up_to_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pipeline.analysis.response_charts.grouping.MOST_CHARTS", 2)
    dampings = np.array([0.1, 0.3, 0.2, 0.1, 0.2, 0.1])
    charts = ChartCache()
    table = respond(
        "swing", random_motion(3), fidelity="chart", charts=charts, tolerance=1e-2, length=1.0, damping=dampings
    )
    assert table["fidelity"].tolist() == ["chart", "history", "chart", "chart", "chart", "chart"]
    assert np.unique(table["displacement"]).size == 3


@pytest.mark.parametrize("name", [m.name for m in MODELS if m.chart is None])
def test_models_without_a_chart_say_why(name: str) -> None:
    model = model_named(name)
    assert model.uncharted
    given = {q.name: 0.5 for q in model.needs if not q.optional}
    with pytest.raises(ValueError, match=f"{name} has no chart: .*; ask for history"):
        respond(name, random_motion(3), fidelity="chart", **given)


def test_rocking_is_never_tabulated() -> None:
    with pytest.raises(ValueError, match="its outcomes flip back and forth, so that it is never tabulated"):
        respond("rocking", random_motion(3), fidelity="chart", half_width=0.1, cg_height=0.5)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, 1e-9, 2.0])
def test_a_tolerance_that_makes_no_sense(tolerance: float) -> None:
    with pytest.raises(ValueError, match="tolerance must be from 1e-6 to 1"):
        respond("sliding", random_motion(3), fidelity="chart", tolerance=tolerance, friction_static=0.1)


def test_the_nodes_are_where_the_model_was_run() -> None:
    """Read at its own nodes a chart gives the model's own answers; 1e-9 is what a logarithm there and back may cost."""
    motion = random_motion(5)
    made = chart("swing", motion, 1e-2, damping=0.05)
    assert (np.diff(made.nodes) > 0.0).all()
    assert (made.nodes[0], made.nodes[-1]) == (made.low, made.high)
    looked = made.look(made.nodes).columns["displacement"]
    ones = np.ones_like(made.nodes)
    fixed = {"length": made.nodes, "damping": 0.05 * ones, "freedom": ones}
    true = run_model(model_named("swing"), motion, fixed, Numerics("history"), 0.0)[0]["displacement"]
    np.testing.assert_allclose(looked, true, rtol=1e-9)


def test_a_cache_forgets_what_was_not_asked_for_and_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    charts, axis, built = ChartCache(kept=2), model_named("sliding").chart, []
    assert axis is not None
    made = chart("sliding", along_x(np.zeros(9), 0.01), 1e-2)

    def build(name: str) -> ResponseChart:
        built.append(name)
        return made

    for name in "abacab":
        charts.get(name, axis, lambda name=name: build(name))
    assert built == ["a", "b", "c", "b"], "a stayed, because it was asked for in between"

    def fail() -> ResponseChart:
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        charts.get("d", axis, fail)
    assert charts.get("d", axis, lambda: made) is made
