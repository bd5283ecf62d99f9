"""Planning and judging: nothing is modelled that is not required, and a verdict is what the range says."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.analysis.assess import LevelMotions, assess, judge
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.plan import plan
from pipeline.analysis.response import respond
from pipeline.analysis.response_charts import ChartCache
from pipeline.execute import Threads
from pipeline.mitigate import changed
from pipeline.models import MODELS
from pipeline.motions import read_motion
from pipeline.quantities import G
from pipeline.records import Estimate, Finding, Hanging, Motion, Numerics, Origin, Scene, Support, Verdict
from pipeline.resources import resource
from tests.museum import PAINTING, VASE

PLATE = replace(VASE, object_number="2", title="Plate", height_m=0.03, width_m=0.3, depth_m=0.3)
LOST = replace(VASE, object_number="4", height_m=None, width_m=None, depth_m=None)


class Silent:
    def step(self, what: str, done: int, total: int) -> None:
        assert 0 <= done <= total


@pytest.fixture(scope="module")
def motion() -> Motion:
    return read_motion(resource("site_motions", "demo"))[0]


def run(scenes: list[Scene], *motions: Motion, combine: str = "max", x_azimuth: float = 90.0) -> list[list[Finding]]:
    level = LevelMotions("design", combine, motions, x_azimuth)
    return assess(scenes, [level], Context(Threads(2)), Numerics("history"))[1]


def span(value: float, low: float, high: float) -> Estimate:
    return Estimate(value, "m", Origin.ASSUMED, low, high)


@pytest.mark.parametrize(
    ("demand", "low", "high", "capacity", "verdict"),
    [
        (0.5, 0.5, 0.5, span(1, 1, 1), Verdict.PASS),
        (1.0, 1.0, 1.0, span(1, 1, 1), Verdict.PASS),  # exactly the capacity
        (1.1, 1.1, 1.1, span(1, 1, 1), Verdict.FAIL),
        (0.5, 0.4, 1.2, span(1, 1, 1), Verdict.UNDETERMINED),
        (1.5, 0.9, 2.0, span(1, 1, 1), Verdict.UNDETERMINED),
        (0.5, 0.4, 0.6, span(1, 0.5, 2), Verdict.UNDETERMINED),  # the capacity is what is not known
        (3.0, 2.5, 4.0, span(1, 0.5, 2), Verdict.FAIL),
        (0.0, 0.0, 0.0, span(0, 0, 0), Verdict.PASS),  # what does not move needs no room
        (0.1, 0.1, 0.1, span(0, 0, 0), Verdict.FAIL),
        (np.inf, np.inf, np.inf, span(1, 1, 1), Verdict.FAIL),
    ],
)
def test_judge(demand: float, low: float, high: float, capacity: Estimate, verdict: Verdict) -> None:
    """Pass or fail only where the whole range says so."""
    assert judge(demand, low, high, capacity).verdict is verdict


def test_every_model_is_either_run_or_has_its_reason() -> None:
    scenes = [classify(item) for item in (VASE, PLATE, PAINTING, LOST)]
    todo = plan(scenes)
    titles = {m.title for m in MODELS}
    for index in range(len(scenes)):
        ran = {w.model.title for w in todo.work if index in w.scenes}
        assert ran | set(todo.skipped[index]) == titles
        assert not ran & set(todo.skipped[index])
        assert all(todo.skipped[index].values())
    assert "hangs on a wall" in todo.skipped[2]["Rocking"]
    assert todo.skipped[3]["Rocking"].startswith("not recorded: height")


def test_equal_work_is_done_once() -> None:
    """A hundred vases of one kind ask for one set of frictions: the best estimate and its two ends."""
    scenes = [classify(replace(VASE, object_number=str(i), height_m=0.2 + 0.001 * i)) for i in range(100)]
    sliding = next(w for w in plan(scenes).work if w.model.name == "sliding")
    assert len(sliding.scenes) == 100
    assert sliding.values["friction_static"].size == 3


@pytest.mark.long("night/test_jobs::test_findings_do_not_depend_on_the_rest_of_the_collection")
def test_what_is_found_of_an_object_does_not_hang_on_which_others_are_looked_at_with_it(motion: Motion) -> None:
    """Twenty-four vases of four sizes, each with room or friction of its own: they ask for the same histories.

    Which of these are run, and so how narrow the range of a demand is, is decided by capacity: of each alone.
    """
    items = [
        replace(
            VASE,
            object_number=str(n),
            height_m=0.3 + 0.1 * (n % 4),
            clearance_m=(None, 0.01, 0.05, 0.2)[n // 4 % 4],
            susceptible=(None, False)[n // 12],
        )
        for n in range(24)
    ]
    weaker = Motion(motion.dt, 0.5 * motion.acceleration, "weaker")
    scenes = [classify(item) for item in items]
    level = LevelMotions("design", "max", (motion, weaker), 90.0)

    def found(some: list[Scene]) -> list[list[Finding]]:
        return assess(some, [level], Context(Threads(1), charts=ChartCache()))[1]

    together = found(scenes)
    assert {f.fidelity for findings in together for f in findings} >= {"bound", "history"}
    for scene, findings in zip(scenes, together, strict=True):
        assert found([scene]) == [findings]


def test_the_certificate_agrees_with_the_history(motion: Motion) -> None:
    """Blocks around the onset: uplift_ratio <= 1 by the certificate if and only if the integration never lifts an edge.

    The certificate looks at all directions at once, the history at one: that of the largest resultant.
    """
    slopes = np.linspace(0.3, 1.5, 60)
    x, y, z = motion.acceleration
    ratio = np.hypot(x, y) / (G + z)
    worst = int(np.argmax(ratio))
    angle = float(np.degrees(np.arctan2(y[worst], x[worst])))
    table = respond("rocking", motion, angle=angle, half_width=slopes, cg_height=1.0)
    lifted = table["rotation_ratio"].to_numpy() > 0.0
    np.testing.assert_array_equal(lifted, ratio.max() / slopes > 1.0)
    sliding = respond("sliding", motion, friction_static=slopes)["displacement"].to_numpy()
    np.testing.assert_array_equal(sliding > 0.0, ratio.max() > slopes)


def test_findings_follow_the_models(motion: Motion) -> None:
    """Each number of a finding, found again by calling the model itself."""
    scenes = [classify(item) for item in (VASE, replace(PAINTING, hanging=Hanging.WIRE))]
    vase, painting = run(scenes, motion)
    by_model = {f.model: f for f in vase}
    parameters = scenes[0].parameters
    slope = parameters["half_width"].value / parameters["cg_height"].value
    x, y, z = motion.acceleration
    mu = parameters["friction_static"]
    passed_on = min(float(np.max(np.hypot(x, y) / (G + z))), mu.value)
    assert by_model["standing"].demand == pytest.approx(passed_on / slope, rel=1e-12)
    assert by_model["standing"].decided_by == "certificate"
    ends = respond("sliding", motion, friction_static=[mu.value, mu.low, mu.high])["displacement"].to_numpy()
    sliding = by_model["sliding"]
    assert (sliding.demand, sliding.high, sliding.low) == pytest.approx(tuple(ends), rel=1e-12)
    assert sliding.decided_by == "history"
    assert sliding.capacity == parameters["clearance"].value
    assert sliding.utilisation == pytest.approx(ends[0] / sliding.capacity)
    swing = next(f for f in painting if f.model == "swing")
    at = scenes[1].parameters
    table = respond("swing", motion, angle=None, length=at["length"].value, damping=at["damping"].value)
    assert swing.demand == pytest.approx(float(table["displacement"].iloc[0]), rel=1e-12)
    for finding in (*vase, *painting):
        assert finding.low is not None
        assert finding.demand is not None
        assert finding.high is not None
        assert finding.low <= finding.demand <= finding.high
        assert finding.motion_hash == motion.hash
        assert finding.assumptions


def test_rocking_itself_is_the_failure_unless_the_museum_says_otherwise(motion: Motion) -> None:
    """Paper, section 4: onset; an object declared not susceptible fails only by falling over."""
    # 4 m high with B/H' = 0.5 it lifts (0.9 g / 0.5) but is far too large to fall: V_max 0.57 m/s < B / sqrt(H') = 1.
    pillar = replace(
        VASE, title="Stele", support=Support.FREESTANDING, height_m=4.0, base_width_m=2.0, base_depth_m=2.0,
        cg_height_m=2.0, friction=0.6, clearance_m=1.0,
    )  # fmt: skip
    sturdy = replace(pillar, object_number="2", susceptible=False)
    slender = replace(sturdy, object_number="3", height_m=0.4, cg_height_m=0.2, base_width_m=0.03, base_depth_m=0.03)
    rocks, stands, falls = (next(f for f in found if f.model == "standing") for found in run(
        [classify(item) for item in (pillar, sturdy, slender)], motion))  # fmt: skip
    assert (rocks.verdict, rocks.outcome) == (Verdict.FAIL, "rocks")
    assert stands.verdict is Verdict.PASS
    assert (falls.verdict, falls.outcome) == (Verdict.FAIL, "overturns")


@pytest.mark.parametrize("x_azimuth", [90.0, 120.0])
def test_an_object_of_known_orientation_is_shaken_along_its_own_axes(motion: Motion, x_azimuth: float) -> None:
    """Its width points 30 degrees clockwise from north: half its width counts along it, half its depth across it."""
    slab = replace(
        VASE, support=Support.FREESTANDING, orientation_deg=30.0, base_width_m=0.3, base_depth_m=0.1, cg_height_m=0.2,
        friction=0.9, clearance_m=0.1,
    )  # fmt: skip
    scenes = [classify(replace(slab, orientation_deg=turned)) for turned in (30.0, 210.0, None)]
    scenes += [classify(replace(slab, orientation_deg=turned, friction=0.2)) for turned in (30.0, None)]
    found = [{f.model: f for f in each} for each in run(scenes, motion, x_azimuth=x_azimuth)]
    width = x_azimuth - 30.0
    one, other = (
        respond("rocking", motion, angle=angle, half_width=half, cg_height=0.2).iloc[0]
        for angle, half in ((width, 0.15), (width + 90.0, 0.05))
    )
    demand = max(one["uplift_ratio"], other["uplift_ratio"])
    assert found[0]["standing"].demand == pytest.approx(demand, rel=1e-12)
    assert other["uplift_ratio"] == demand
    assert found[0]["standing"].outcome == ("overturns" if other["overturned"] else "rocks")
    # Half a turn is the same object; without an orientation every direction counts, with the narrow side.
    assert found[1]["standing"].demand == pytest.approx(demand, rel=1e-12)
    assert found[2]["standing"].demand > demand
    # Sliding is in two directions, whichever way it is turned.
    assert found[3]["sliding"].demand == found[4]["sliding"].demand > 0.0


def test_a_section_of_known_orientation_bends_about_its_own_axes(motion: Motion) -> None:
    """K M / S - N / A with S = depth x width^2 / 6 under A_max along the width, and the other way round; K = 2."""
    held = replace(
        VASE, support=Support.FASTENED, orientation_deg=75.0, mass_kg=20.0, section_width_m=0.08, section_depth_m=0.03,
        allowable_stress_pa=1e7, cg_height_m=0.2,
    )  # fmt: skip
    (found,) = run([classify(held)], motion)
    tension = [
        2.0 * 20.0 * np.abs(motion.along(angle)).max() * 0.2 / (across * along**2 / 6.0) - 20.0 * G / (0.08 * 0.03)
        for angle, along, across in ((15.0, 0.08, 0.03), (105.0, 0.03, 0.08))
    ]
    assert {f.model: f.demand for f in found}["stress"] == pytest.approx(max(tension), rel=1e-12)


def test_a_painting_on_a_known_wall_swings_along_it(motion: Motion) -> None:
    wall = replace(PAINTING, orientation_deg=40.0, damping=0.05, suspension_length_m=0.5, hanging=Hanging.WIRE)
    finding = next(f for f in run([classify(wall)], motion)[0] if f.model == "swing")
    table = respond("swing", motion, angle=50.0, length=0.5, damping=0.05)
    assert finding.demand == pytest.approx(float(table["displacement"].iloc[0]), rel=1e-12)


def test_levels_take_the_worst_motion_or_the_mean(motion: Motion) -> None:
    half = motion.scaled(0.5, "test")
    scene = classify(replace(VASE, friction=0.1))
    found = {
        combine: {f.model: f for f in run([scene], half, motion, combine=combine)[0]} for combine in ("max", "mean")
    }
    one, two = (respond("sliding", m, friction_static=0.1)["displacement"].iloc[0] for m in (half, motion))
    assert found["max"]["sliding"].demand == pytest.approx(max(one, two), rel=1e-12)
    assert found["mean"]["sliding"].demand == pytest.approx(0.5 * (one + two), rel=1e-12)
    assert found["max"]["sliding"].motion_hash == motion.hash


def test_what_cannot_be_assessed_has_no_findings(motion: Motion) -> None:
    assert run([classify(LOST)], motion) == [[]]


def test_the_number_of_workers_changes_nothing(motion: Motion) -> None:
    scenes = [classify(replace(VASE, object_number=str(i), height_m=0.1 + 0.01 * i)) for i in range(40)]
    level = [LevelMotions("design", "max", (motion,))]
    assert assess(scenes, level, Context(Threads(1)))[1] == assess(scenes, level, Context(Threads(2)))[1]


@pytest.mark.parametrize(
    ("measure", "parameters", "given"),
    [
        ("friction_isolator", {"friction": 0.05, "clearance": 0.3}, {"friction_static": 0.05}),
        (
            "horizontal_isolator",
            {"frequency": 0.5, "damping": 0.02, "friction": 0.05, "stroke": 0.3},
            {"frequency": 0.5, "damping": 0.02, "friction": 0.05},
        ),
    ],
)
def test_the_error_of_a_finding_is_that_of_its_demand(
    motion: Motion, measure: str, parameters: dict[str, float], given: dict[str, float]
) -> None:
    """An isolator is held against its stroke: the error is in m, and covers what the reference still moves it by.

    That of the acceleration it passes on is another one: through the spring alone it is w^2 times as large.
    """
    scene = changed(classify(VASE), measure, parameters)
    level = LevelMotions("design", "max", (motion,))
    _, (fine,) = assess([scene], [level], Context(Threads(1)), Numerics("reference"))
    _, (found,) = assess([scene], [level], Context(Threads(1)), Numerics("history"))
    (history,), (reference,) = (f for f in found if f.unit == "m"), (f for f in fine if f.unit == "m")
    assert history.demand is not None
    assert reference.demand is not None
    assert history.error is not None
    off = abs(history.demand - reference.demand)
    assert off <= history.error
    passed_on = respond(measure, motion, **given)["error"].iloc[0]  # type: ignore[arg-type]
    assert history.error * (2.0 * np.pi * parameters.get("frequency", 0.0)) ** 2 <= passed_on


def test_whether_it_fell_has_no_error(motion: Motion) -> None:
    """A yes or a no: the error of how far it tipped is not its own."""
    robust = replace(VASE, susceptible=False, width_m=0.05, depth_m=0.05, base_width_m=0.05, base_depth_m=0.05)
    (found,) = run([classify(robust)], motion)
    fell = next(f for f in found if f.demand_name == "overturned")
    assert fell.decided_by == "history"
    assert fell.error == 0.0
