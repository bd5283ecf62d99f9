"""The fidelity `auto`: the verdicts of `history`, for what they cost where they cannot be had for less."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.cases import Effort
from pipeline.analysis.chart_runs import DECIDES, deciding, response_chart
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.response import respond
from pipeline.analysis.response_charts import ChartCache
from pipeline.execute import Threads
from pipeline.motions import read_motion
from pipeline.quantities import Array
from pipeline.records import Estimate, Finding, Furniture, Item, Motion, Numerics, Origin, Scene, Support, Verdict
from pipeline.resources import resource
from tests.soak import SOAK

BLOCK = Item("1", "G", title="Block", support=Support.FREESTANDING, furniture=Furniture.FLOOR,
             height_m=0.3, base_width_m=0.3, base_depth_m=0.3,
             width_m=0.3, depth_m=0.3, cg_height_m=0.15, friction=0.3, clearance_m=0.1)  # fmt: skip
PAINTING = Item("2", "G", title="Landscape", classification="paintings", height_m=1.0, width_m=1.2, damping=0.02,
                suspension_length_m=0.5, clearance_m=0.1)  # fmt: skip
LAMP = replace(PAINTING, title="Lamp", support=Support.SUSPENDED)
NEAR = (-1e-1, -1e-2, -3e-3, -1e-3, -1e-4, -1e-6, 1e-6, 1e-4, 1e-3, 3e-3, 1e-2, 1e-1)
"""By what share capacities lie beside the demands of `history`: a chart cannot tell the inner ones, a bound none."""

EVERY = Numerics(azimuth_step=30.0)

COMBINES = ("max", "mean")


@pytest.fixture(scope="module")
def motions() -> tuple[Motion, ...]:
    """Twenty seconds of strong shaking, and the same weaker, turned and later."""
    whole = read_motion(resource("site_motions", "demo"))[0]
    x, y, z = whole.acceleration[:, 1500:3500]
    return (
        Motion(whole.dt, [x, y, z], "one"),
        Motion(whole.dt, 0.6 * np.array([y, x, z])[:, ::-1], "two"),
        Motion(whole.dt, 0.9 * np.array([-y, x, z]), "three"),
    )


@pytest.fixture(scope="module")
def charts(motions: tuple[Motion, ...]) -> ChartCache:
    """Charts of sliding, and of the swing in every direction, as a night that drew them has them."""
    charts = ChartCache()
    for motion in motions:
        response_chart("sliding", motion, charts=charts, numerics=deciding("sliding"))
        response_chart("swing", motion, charts=charts, numerics=deciding("swing", EVERY), damping=0.02)
    return charts


def run(
    scenes: list[Scene], level: LevelMotions, fidelity: str, charts: ChartCache | None = None
) -> tuple[list[list[Finding]], dict[str, Effort]]:
    efforts: dict[str, Effort] = {}
    found = assess(
        scenes,
        [level],
        Context(Threads(2), charts=charts or ChartCache()),
        EVERY.at(fidelity),
        efforts=efforts,
    )[1]
    return found, efforts


def of_model(found: list[list[Finding]], model: str) -> list[Finding]:
    return [f for findings in found for f in findings if f.model == model]


def same(one: list[list[Finding]], other: list[list[Finding]]) -> None:
    """The same verdicts, and of what does not pass the same words; numbers within the error that they state."""
    for a, b in zip(one, other, strict=True):
        assert [(f.model, f.verdict) for f in a] == [(f.model, f.verdict) for f in b]
        for x, y in zip(a, b, strict=True):
            assert None not in (x.demand, y.demand, y.error)
            if x.verdict is not Verdict.PASS:
                assert x.outcome == y.outcome
                assert abs(x.demand - y.demand) <= y.error + 1e-3 * x.demand  # type: ignore[operator]
            if y.fidelity == "bound":
                assert x.demand <= y.demand * (1.0 + 1e-9)  # type: ignore[operator]


def beside(scenes: list[Scene], level: LevelMotions, model: str) -> list[Scene]:
    """The scenes with clearances right beside what `history` demands of them, on both sides."""
    demands = [f.demand for f in of_model(run(scenes, level, "history")[0], model)]
    out = []
    for at, (scene, demand) in enumerate(zip(scenes, demands, strict=True)):
        assert demand is not None
        room = demand * (1.0 + NEAR[at % len(NEAR)])
        out.append(replace(scene, parameters={**scene.parameters, "clearance": Estimate.measured(room, "m")}))
    return out


def blocks(frictions: Array) -> list[Scene]:
    return [
        classify(replace(BLOCK, object_number=str(i), friction=float(f), height_m=0.2 + 1e-4 * i))
        for i, f in enumerate(frictions)
    ]


@pytest.mark.long("test_swings_right_beside_their_capacity")
@pytest.mark.parametrize("combine", COMBINES)
def test_sliding_right_beside_its_capacity(motions: tuple[Motion, ...], charts: ChartCache, combine: str) -> None:
    """240 measured frictions: each verdict is that of the history, although most histories are never run."""
    level = LevelMotions("design", combine, motions)
    scenes = beside(blocks(np.geomspace(0.02, 0.7, 240)), level, "sliding")
    history, auto = run(scenes, level, "history")[0], run(scenes, level, "auto", charts)
    same(history, auto[0])
    effort = auto[1]["sliding"]
    # One part in a thousand is always integrated; a part in ten never, and of a hundredth most are not.
    assert 0 < effort.verdicts < 0.8 * effort.sets
    assert effort.decided[1] > 0
    assert {f.verdict for f in of_model(auto[0], "sliding")} == {Verdict.PASS, Verdict.FAIL}


@pytest.mark.parametrize("combine", COMBINES)
@pytest.mark.parametrize(("item", "model", "count"), [(PAINTING, "swing", 96), (LAMP, "swing_3d", 24)])
def test_swings_right_beside_their_capacity(
    motions: tuple[Motion, ...], charts: ChartCache, combine: str, item: Item, model: str, count: int
) -> None:
    level = LevelMotions("design", combine, motions[:2])
    scenes = beside(
        [
            classify(replace(item, object_number=str(i), suspension_length_m=float(length)))
            for i, length in enumerate(np.geomspace(0.15, 4.0, count))
        ],
        level,
        model,
    )
    same(run(scenes, level, "history")[0], run(scenes, level, "auto", charts)[0])


@pytest.mark.parametrize(
    "combine", [pytest.param("max", marks=pytest.mark.long("test_ranges_of_everything_at_random")), "mean"]
)
def test_ranges_of_everything_at_random(motions: tuple[Motion, ...], charts: ChartCache, combine: str) -> None:
    """Objects of all kinds with measured and assumed inputs, some harmed only by falling, some of known orientation."""
    rng = np.random.default_rng(20190706)
    kinds = (
        BLOCK,
        replace(BLOCK, friction=None, clearance_m=None, medium="porcelain"),
        replace(BLOCK, cg_height_m=None, susceptible=False, base_width_m=0.1, base_depth_m=0.15),
        replace(BLOCK, support=Support.FASTENED, mass_kg=30.0, allowable_stress_pa=2e5, section_width_m=0.05),
        replace(BLOCK, support=Support.FASTENED, mass_kg=30.0, allowable_stress_pa=4e5, section_width_m=0.05,
                frequency_hz=5.0),
        # Its frequency is estimated, and searched.
        replace(BLOCK, support=Support.FASTENED, mass_kg=30.0, allowable_stress_pa=3e8, section_width_m=0.012,
                medium="bronze"),
        replace(BLOCK, mass_kg=30.0, allowable_stress_pa=2e8, section_width_m=0.012, medium="glass"),
        replace(BLOCK, support=Support.ISOLATED, isolator="friction_isolator", friction=0.08),
        replace(PAINTING, damping=None, suspension_length_m=None),
    )  # fmt: skip
    scenes = []
    for i in range(140 if SOAK else 45):
        kind, size = kinds[i % len(kinds)], float(np.exp(rng.normal(0.0, 0.5)))
        sizes = {name: getattr(kind, name) and getattr(kind, name) * size for name in ("height_m", "base_width_m")}
        turned = None if i % 3 else float(rng.uniform(0.0, 360.0))
        scenes.append(classify(replace(kind, object_number=str(i), orientation_deg=turned, **sizes)))
    level = LevelMotions("design", combine, motions)
    history, auto = run(scenes, level, "history")[0], run(scenes, level, "auto", charts)[0]
    same(history, auto)
    same(history, run(scenes, level, "chart", charts)[0])
    assert {f.model for found in auto for f in found} >= {
        "standing", "sliding", "stress", "flexible_stress", "friction_isolator", "swing",
    }  # fmt: skip
    assert len({f.verdict for found in auto for f in found}) == 3


def test_who_decides_is_said_and_how_well(motions: tuple[Motion, ...], charts: ChartCache) -> None:
    """A bound says at most, and is one; a chart tells its error; what lies beside its capacity is integrated."""
    level = LevelMotions("design", "max", motions[:1])
    table = respond("sliding", motions[0], friction_static=0.2, fidelity="bound")
    truth = float(respond("sliding", motions[0], friction_static=0.2)["displacement"].iloc[0])
    rooms = (2.0 * float(table["high"].iloc[0]), 1.3 * truth, truth * (1.0 + 1e-4))
    scenes = [classify(replace(BLOCK, object_number=str(i), friction=0.2, clearance_m=c)) for i, c in enumerate(rooms)]
    bound, chart, history = (of_model(run([scene], level, "auto", charts)[0], "sliding")[0] for scene in scenes)
    assert (bound.decided_by, bound.fidelity) == ("certificate", "bound")
    assert "at most" in bound.sentence
    # The bound holds for the response; two thousandths more are for the history that might be run instead.
    assert bound.demand == pytest.approx(float(table["high"].iloc[0]), rel=2.1e-3)
    assert bound.low == pytest.approx(float(table["low"].iloc[0]), rel=2.1e-3)
    assert bound.error == pytest.approx(bound.demand - bound.low)
    assert (chart.decided_by, chart.fidelity) == ("chart", "chart")
    assert chart.error is not None
    assert chart.demand is not None
    # The error is that of reading between the nodes, and what the histories at the nodes say of themselves.
    assert 0.0 < abs(chart.demand - truth) <= chart.error <= 2.0 * DECIDES * truth
    assert "at most" not in chart.sentence
    assert (history.decided_by, history.fidelity, history.demand) == ("history", "history", truth)


def test_nothing_is_integrated_that_no_verdict_needs(motions: tuple[Motion, ...], charts: ChartCache) -> None:
    """What a bound decides costs no history, except one of what fails, to tell what it does."""
    level = LevelMotions("design", "max", motions)
    pillar = replace(BLOCK, height_m=4.0, cg_height_m=2.0, base_width_m=0.5, base_depth_m=0.5, friction=0.9)
    efforts = run([classify(pillar)], level, "auto", charts)[1]
    assert _counts(efforts["sliding"]) == (1, [1, 0, 0], 0, 0)
    assert _counts(efforts["standing"]) == (1, [1, 0, 0], 0, 1)
    assert efforts["standing"].needing == 1


def _counts(effort: Effort) -> tuple[int, list[int], int, int]:
    return effort.analyses, effort.decided, effort.verdicts, effort.numbers


def test_a_chart_is_built_only_where_it_pays(motions: tuple[Motion, ...]) -> None:
    """Few objects are integrated; where there are more than a chart takes analyses, it is built."""
    level = LevelMotions("design", "max", motions[:1])
    few, many = (blocks(np.geomspace(0.1, 0.4, count)) for count in (20, 400))
    built: Mapping[str, Effort] = run(many, level, "auto")[1]
    assert run(few, level, "auto")[1]["sliding"].decided[1] == 0
    assert built["sliding"].decided[1] > 0
    assert built["sliding"].verdicts + built["sliding"].numbers < 20


def test_an_assumed_range_that_straddles_the_capacity_is_settled_as_undetermined(motions: tuple[Motion, ...]) -> None:
    level = LevelMotions("design", "max", motions[:1])
    scene = classify(BLOCK)
    wide = Estimate(0.3, "-", Origin.ASSUMED, 0.02, 0.9)
    open_ = replace(scene, parameters={**scene.parameters, "friction_static": wide})
    found = of_model(run([open_], level, "auto")[0], "sliding")[0]
    assert found.verdict is Verdict.UNDETERMINED
    assert found.low == 0.0
