"""Furniture: whose word says what an object stands in, what that does to the shaking, and what verdicts come of it."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from functools import cache

import numpy as np
import pytest
from scipy.signal import lsim

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify, furniture_kind
from pipeline.analysis.context import Context
from pipeline.analysis.furnished import _off_level, _variants, best_furnished, furnished
from pipeline.analysis.furniture import FurnitureFilter, filter_of, furniture_of
from pipeline.analysis.house.matching import NO_EFFECT, HouseRules
from pipeline.analysis.house.rule import HouseRule
from pipeline.analysis.response import respond
from pipeline.analysis.transmission import cascade, transmit
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate.installed import InstalledMeasure, assess_above, placed
from pipeline.mitigate.search import advise
from pipeline.models.common import largest_push
from pipeline.motions import read_motion
from pipeline.quantities import Array, G
from pipeline.records import Finding, Furniture, Item, Motion, Numerics, Origin, Scene, Support, Verdict
from pipeline.resources import resource
from pipeline.tables.assumed import assumed
from pipeline.tables.furniture_rows import usual_furniture
from tests.museum import carnegie
from tests.soak import SOAK

VASE = Item("1", "G", title="Vase", object_name="Vase", support=Support.FREESTANDING, height_m=0.12, width_m=0.3,
            depth_m=0.3, base_width_m=0.3, base_depth_m=0.3, cg_height_m=0.05, mass_kg=3.0, friction=0.18,
            clearance_m=0.2, susceptible=False)  # fmt: skip
"""Squat: it slides, and neither rocks nor breaks."""

CASE = FurnitureFilter((3.0, 6.0, 12.0), (0.03, 0.05, 0.1), float(np.radians(0.5)))


@cache
def demo() -> Motion:
    return read_motion(resource("site_motions", "demo"))[0]


def strong(seconds: tuple[float, float] = (15.0, 30.0)) -> Motion:
    """The strongest part of the demonstration's record."""
    first, last = (round(second / demo().dt) for second in seconds)
    return Motion(demo().dt, demo().acceleration[:, first:last], "strong")


def level(*motions: Motion, combine: str = "max") -> LevelMotions:
    return LevelMotions("design", combine, motions or (strong(),))


def found(item: Item, *levels: LevelMotions, fidelity: str = "auto") -> list[Finding]:
    _, (each,) = assess([classify(item)], levels or (level(),), Context(Threads(1)), Numerics(fidelity))
    return each


def sliding(findings: list[Finding]) -> Finding:
    return next(finding for finding in findings if finding.model == "sliding")


# ----------------------------------------------------------------------------------------------------------------------
# Whose word it is


def rule(**fields: object) -> HouseRules:
    given = {"said_by": "Ann", "said_on": date(2031, 5, 1), **fields}
    return HouseRules([HouseRule(**given)], tuple(assumed().classes))  # type: ignore[arg-type]


def test_the_record_comes_before_the_rule_and_the_rule_before_the_case_and_the_class() -> None:
    """Each in its turn says another kind, and the scene says whose word it is."""
    plain = replace(VASE, title="Vase", height_m=0.3)
    cased = replace(plain, case="Plinth 3")
    told = rule(gallery="G", furniture="shelf")
    recorded = replace(cased, furniture=Furniture.FLOOR)
    by_record, by_rule = classify(recorded, house=told), classify(cased, house=told)
    by_case, by_class = classify(cased), classify(plain)
    assert [(s.furniture, s.furniture_origin) for s in (by_record, by_rule, by_case, by_class)] == [
        (Furniture.FLOOR, Origin.MEASURED), (Furniture.SHELF, Origin.STATED),
        (Furniture.PEDESTAL, Origin.DERIVED), (Furniture.SHOWCASE, Origin.ASSUMED),
    ]  # fmt: skip
    assert not any("furniture" in text for text in by_record.assumptions)
    notes = [next(t for t in s.assumptions if t.startswith("furniture:")) for s in (by_rule, by_case, by_class)]
    assert "a shelf, by the house rule for" in notes[0]
    assert "a pedestal or plinth, for its record names the case or plinth 'Plinth 3'" in notes[1]
    assert "a showcase, assumed for: vessel, usual_furniture.csv; not recorded; of 6 Hz (3 to 12)" in notes[2]


def test_the_kind_alone_is_that_of_the_whole_scene() -> None:
    """Of a real collection, as its records stand, with rules of the house, and with a class that a person gave."""
    items = carnegie().items[:: 1 if SOAK else 10]
    house = rule(medium="bronze", furniture="shelf")
    for told in ({}, {"house": house}, {"decided": ("clock", "Ann")}):
        kinds = [(furniture_kind(item, **told), classify(item, **told).furniture) for item in items]  # type: ignore[arg-type]
        assert all(alone is whole for alone, whole in kinds)
        # Not the same whatever it is.
        assert len({alone for alone, _ in kinds}) > 1


@pytest.mark.parametrize("support", [Support.FREESTANDING, Support.FASTENED, Support.HUNG, Support.SUSPENDED])
@pytest.mark.parametrize("height", [None, 0.05, 0.8, 3.0])
def test_every_object_has_furniture(support: Support, height: float | None) -> None:
    """Of every class and height; what hangs, hangs from what holds it up, whatever its class usually stands on."""
    for name in assumed().classes:
        guess = furniture_of(Item("1", "G", height_m=height), name, support, NO_EFFECT)
        assert guess.origin is Origin.ASSUMED
        hung = {Support.HUNG: {Furniture.WALL}, Support.SUSPENDED: {Furniture.RAIL}}
        assert guess.furniture in hung.get(support, set(Furniture) - {Furniture.WALL, Furniture.RAIL})


@pytest.mark.parametrize(
    ("name", "sizes", "kind"),
    [
        ("rocking horse", (1.15, 0.45, 1.5), Furniture.FLOOR),
        ("doll's house", (1.92, 1.33, 0.61), Furniture.FLOOR),
        ("ship model", (0.5, 1.2, 0.2), Furniture.PEDESTAL),
        ("statue", (0.9, 0.4, 0.4), Furniture.PEDESTAL),
        ("canoe", (0.45, 0.6, 5.0), Furniture.FLOOR),
    ],
)
def test_what_is_as_large_as_a_person_stands_on_no_pedestal(
    name: str, sizes: tuple[float, float, float], kind: Furniture
) -> None:
    """A pedestal is 0.3 to 0.8 m across (furniture.csv): a horse of 1.5 m stands on the floor or on a low block."""
    height, width, depth = sizes
    item = Item("1", "G", object_name=name, height_m=height, width_m=width, depth_m=depth)
    assert furniture_kind(item) is kind


@pytest.mark.parametrize(
    ("place", "kind"),
    [
        ("Bahçe", Furniture.FLOOR),
        ("Sculpture garden, north", Furniture.FLOOR),
        ("中庭", Furniture.FLOOR),
        ("Garden Room", Furniture.SHOWCASE),  # of its name a room
        ("Gallery 3 (Courtyard side)", Furniture.SHOWCASE),
    ],
)
def test_no_case_stands_under_the_sky(place: str, kind: Furniture) -> None:
    jar = Item("1", place, object_name="jar", medium="terracotta", height_m=0.4, width_m=0.3, depth_m=0.3)
    assert furniture_kind(jar) is kind
    assert furniture_kind(replace(jar, case="Case 3")) is Furniture.SHOWCASE


def test_only_rows_that_say_so_leave_an_object_on_bare_ground() -> None:
    """A cabinet stands on the floor because a row of the table says it, and the scene names the table."""
    bare = [row for row in usual_furniture() if row.furniture is Furniture.FLOOR and row.unsized]
    assert {row.object_class for row in bare} == {"seat", "table"}
    scene = classify(replace(VASE, title="Cabinet", object_name="Cabinet", height_m=1.2))
    assert (scene.furniture, filter_of(scene)) == (Furniture.FLOOR, None)
    assert any(
        "the floor itself, assumed for: cabinet" in text and "usual_furniture.csv" in text for text in scene.assumptions
    )


@pytest.mark.parametrize(
    ("name", "height", "kind"),
    [
        ("Chair", 0.9, Furniture.FLOOR),
        ("Chair", None, Furniture.FLOOR),  # nobody said that it is a toy
        ("Chair", 0.12, Furniture.SHOWCASE),
        ("Footstool", 0.25, Furniture.FLOOR),
        ("Table", 0.15, Furniture.SHOWCASE),
        ("Table", 0.75, Furniture.FLOOR),
        ("Bust", 0.08, Furniture.SHOWCASE),
        ("Bust", 0.5, Furniture.PEDESTAL),
        ("Bust", None, Furniture.PEDESTAL),
        ("Ship model", 0.1, Furniture.SHOWCASE),
        ("Ship model", 0.6, Furniture.PEDESTAL),
    ],
)
def test_what_is_smaller_than_its_kind_stands_in_a_case(name: str, height: float | None, kind: Furniture) -> None:
    side = None if height is None else 0.6 * height
    assert furniture_kind(Item("1", "G", object_name=name, height_m=height, width_m=side, depth_m=side)) is kind


# ----------------------------------------------------------------------------------------------------------------------
# What it does to the shaking


def _independent(
    motion: Motion, frequency: float, damping: float, friction: float, fine: int = 20
) -> tuple[float, float]:
    """Largest slide of a body on the floor and on an oscillator: scipy's exact filter, then small steps of Coulomb.

    Each step of dt / fine: it slips by what pushes it less the friction along its velocity, and sticks when that would
    turn it round and the friction can hold it.
    """
    t = np.arange(motion.samples) * motion.dt
    s = np.arange((motion.samples - 1) * fine + 1) * (motion.dt / fine)
    w = 2.0 * np.pi * frequency
    ground = np.stack([np.interp(s, t, row) for row in motion.acceleration])
    on_top = ground.copy()
    for row in range(2):
        # Absolute acceleration of the mass: -(2 zeta w u' + w^2 u).
        system = ([[0.0, 1.0], [-w * w, -2.0 * damping * w]], [[0.0], [-1.0]], [[-w * w, -2.0 * damping * w]], [[0.0]])
        on_top[row] = lsim(system, ground[row], s)[1]
    return _slide(ground, motion.dt / fine, friction), _slide(on_top, motion.dt / fine, friction)


def _slide(a: Array, dt: float, friction: float) -> float:
    vx = vy = x = y = most = 0.0
    for ax, ay, az in a.T.tolist():
        grip = friction * max(0.0, G + az) * dt
        # What friction may take from the velocity in this step.
        vx, vy = vx - ax * dt, vy - ay * dt
        speed = (vx * vx + vy * vy) ** 0.5
        keep = max(0.0, 1.0 - grip / speed) if speed > 0.0 else 0.0
        vx, vy = vx * keep, vy * keep
        x, y = x + vx * dt, y + vy * dt
        most = max(most, x * x + y * y)
    return most**0.5


def test_a_case_of_6_hz_takes_sliding_from_3_to_11_cm() -> None:
    """Friction 0.18 under the demonstration's record: 2.9 cm on the floor, and 10.6 cm were found independently.

    We find 10.71 cm, 1 % more, and the integration above agrees with that within 0.3 %: the tolerance is of 10.6 to
    three figures, of an integration of which only the result is known.
    """
    item = replace(VASE, furniture=Furniture.SHOWCASE)
    on_floor = sliding(found(replace(item, furniture=Furniture.FLOOR), level(demo())))
    in_case = sliding(found(item, level(demo())))
    assert on_floor.demand == pytest.approx(0.029, abs=0.0005)
    assert in_case.demand == pytest.approx(0.106, rel=0.015)
    floor, case = _independent(demo(), 6.0, 0.05, 0.18)
    assert on_floor.demand == pytest.approx(floor, rel=0.01)
    assert in_case.demand == pytest.approx(case, rel=0.005)
    # The range is that of the whole range of the furniture, from a stiff case on.
    assert in_case.low == pytest.approx(on_floor.demand, rel=1e-9)
    assert in_case.high is not None
    assert in_case.high > 0.3


def test_off_level_a_block_slides_as_newmark_says() -> None:
    """A push A uphill for t, friction mu, off level by phi: d = V^2 / (2 a) (1 - a / A), a = g (mu cos phi - sin phi).

    The slope adds its g sin(phi) to the push and takes it from the brake.  cos(phi) is taken as 1: 4e-5 of it.
    """
    push, seconds, friction, phi, dt = 3.0, 0.5, 0.2, np.radians(0.5), 0.001
    x = np.zeros(4001)
    x[1 : round(seconds / dt) + 1] = push
    motion = Motion(dt, [x, 0.0 * x, 0.0 * x])
    # Sliding back from where the push is, it comes to rest behind: that way is downhill.
    leaning = _off_level(motion, motion, G * np.sin(phi))
    tilt = G * np.sin(phi)
    assert leaning.acceleration[0, -1] == pytest.approx(tilt)
    assert not leaning.acceleration[1].any()
    brake, pushed = G * friction - tilt, push + tilt
    velocity = (push - brake) * seconds
    expected = 0.5 * velocity * seconds + velocity**2 / (2.0 * brake)
    slid = respond("sliding", leaning, friction_static=friction)["displacement"].iloc[0]
    # The flanks of the push take a sample each: one of 500.
    assert slid == pytest.approx(expected, rel=5e-3)
    assert pushed > push
    # Its velocity is that of the shaking alone.
    assert leaning.v_max == pytest.approx(push * seconds, rel=2e-3)


@pytest.mark.long("test_a_verdict_holds_under_every_variant_of_the_furniture")
def test_few_variants_come_close_to_a_fine_grid() -> None:
    """Of 41 frequencies by 4 directions of the lean none pushes harder by a sixth, and none moves a slide by a quarter.

    Every day it is every second frequency.

    docs/explanation/furniture.md has the figures of more motions and of rocking.
    """
    motion, frictions = demo(), [0.12, 0.18, 0.25, 0.35, 0.5]
    tilt = G * np.sin(CASE.level_error)
    pushes, slides = [], []
    for frequency in np.geomspace(3.0, 12.0, 41)[:: 1 if SOAK else 2]:
        passed = transmit("plinth", motion, refine=2, frequency=float(frequency), damping=0.03)
        pushes.append(largest_push(passed.excitation(None)))
        for way in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
            leaning = passed.acceleration.copy()
            leaning[:2] += tilt * np.array(way)[:, None]
            slides.append(
                respond("sliding", passed.changed(leaning, "leans"), friction_static=frictions)["displacement"]
            )
    few = _variants(motion, furniture=CASE)
    mine = np.max([respond("sliding", m, friction_static=frictions)["displacement"] for m in few], axis=0)
    assert max(largest_push(m.excitation(None)) for m in few) > max(pushes) / 1.17
    assert np.all(mine > 0.8 * np.max(slides, axis=0))


@pytest.mark.parametrize(
    "words", ["on sloping stone floor", "floor is uneven here", "auf schiefem Fußboden", "sol en pente", "not level"]
)
def test_a_floor_that_is_said_to_slope_lifts_an_edge_by_less(words: str) -> None:
    """Statics: off level by phi a block of b / h tips at a push of g tan(atan(b / h) - phi), nearly g (b / h - phi)."""
    stele = Item("1", "G", object_name="stele", medium="marble", height_m=1.6, width_m=0.5, depth_m=0.3,
                 base_width_m=0.5, base_depth_m=0.24, cg_height_m=0.8, displayed="on floor")  # fmt: skip
    flat, slope = classify(stele), classify(replace(stele, displayed=f"on floor, {words}"))
    assert filter_of(flat) is None
    leans = filter_of(slope)
    assert leans is not None
    tips, phi = np.arctan2(0.12, 0.8), leans.level_error
    assert np.radians(0.5) < phi < np.radians(3.0)
    t = np.arange(0.0, 8.0, 0.01)
    rises = np.minimum(t / 4.0, 1.0)
    for share, lifts in ((0.97, False), (1.06, True)):
        push = G * np.tan(tips - phi) * share
        pushed = Motion(0.01, [push * rises, 0.0 * t, 0.0 * t])
        assert push < 0.12 / 0.8 * G
        worst = max(largest_push(one.excitation(None)) for one in _variants(pushed, furniture=leans))
        assert (worst > 0.12 / 0.8 * G) is lifts


def test_furniture_leans_with_its_floor() -> None:
    vase = replace(VASE, furniture=Furniture.SHOWCASE)
    flat, slope = (filter_of(classify(one)) for one in (vase, replace(vase, displayed="sloping floor")))
    assert flat is not None
    assert slope is not None
    assert slope.level_error - flat.level_error == pytest.approx(np.radians(1.5))


def test_the_chain_is_floor_furniture_isolator_object() -> None:
    """What stands on an isolator in a showcase feels what both pass on, one after the other."""
    scene = classify(replace(VASE, furniture=Furniture.SHOWCASE, friction=0.03))
    given = {"frequency": 0.5, "damping": 0.1, "friction": 0.02, "stroke": 0.5}
    one = placed(scene, [InstalledMeasure("horizontal_isolator", given, "Ann")])
    ((above, _),) = assess_above([one], [level()], Context(Threads(1)), Numerics("history"))
    isolator = ("horizontal_isolator", {"frequency": 0.5, "damping": 0.1, "friction": 0.02})
    felt = cascade([("plinth", {"frequency": 6.0, "damping": 0.05}), isolator], strong())
    alone = respond("sliding", felt, friction_static=0.03)["displacement"].iloc[0]
    assert alone > 0.01
    # What the showcase passes on is sampled 15 times in its period, here as finely as it takes.
    assert sliding(above).demand == pytest.approx(alone, rel=0.02)
    assert sliding(above).motion == "strong"
    # The isolator itself is shaken by the showcase, and by a stiffer or softer one besides.
    (own,) = (f for f in found_of(one.scene) if f.model == "horizontal_isolator")
    shaken = best_furnished([strong()], filter_of(scene))[0]
    moved = respond("horizontal_isolator", shaken, frequency=0.5, damping=0.1, friction=0.02)["displacement"].iloc[0]
    assert own.demand == pytest.approx(moved, rel=2e-3)
    assert own.low is not None
    assert own.high is not None
    assert own.low < own.demand < own.high


def found_of(scene: Scene) -> list[Finding]:
    return assess([scene], [level()], Context(Threads(1)), Numerics("history"))[1][0]


# ----------------------------------------------------------------------------------------------------------------------
# What verdicts come of it


@pytest.mark.parametrize("combine", ["max", "mean"])
@pytest.mark.parametrize(
    "fidelity",
    [
        "auto",
        pytest.param("history", marks=pytest.mark.long("test_a_verdict_holds_under_every_variant_of_the_furniture")),
    ],
)
def test_a_verdict_holds_under_every_variant_of_the_furniture(combine: str, fidelity: str) -> None:
    """Each variant is run by itself, as a floor of its own: passes if all pass, fails if all fail, else it is open.

    The room is put below, between and above what the variants demand.
    """
    motions = (strong(), strong((20.0, 40.0)).scaled(0.8, "another"))
    case, bare = (replace(VASE, furniture=kind) for kind in (Furniture.SHOWCASE, Furniture.FLOOR))
    shaking = furnished(level(*motions, combine=combine), filter_of(classify(case)))
    alone = [sliding(found(bare, LevelMotions("v", combine, some), fidelity="history")) for some in shaking.variants]
    demands = np.array([one.demand for one in alone])
    assert demands.max() > 3.0 * demands.min()
    for room in (
        0.9 * demands.min(),
        demands.min() * 1.05,
        float(np.median(demands)),
        0.97 * demands.max(),
        1.1 * demands.max(),
    ):
        finding = sliding(
            found(replace(case, clearance_m=float(room)), level(*motions, combine=combine), fidelity=fidelity)
        )
        passes, fails = bool((demands <= room).all()), bool((demands > room).all())
        expected = Verdict.PASS if passes else Verdict.FAIL if fails else Verdict.UNDETERMINED
        assert finding.verdict is expected
        assert finding.motion in {motion.name for motion in motions}
        if expected is not Verdict.PASS or fidelity == "history":
            # A history may be off by what it states; no verdict hangs on the ends of an open range, which are scanned.
            assert finding.demand == pytest.approx(demands[0], rel=2e-3)
            ends = 2e-3 if fidelity == "history" else 2e-2
            assert finding.high == pytest.approx(demands.max(), rel=ends)
            assert finding.low == pytest.approx(demands.min(), rel=ends)


def test_a_finding_names_its_furniture_and_the_motion_of_the_site() -> None:
    """Its motion has a page and its assumptions are said; no chart is drawn of what a showcase passes on."""
    finding = sliding(found(replace(VASE, case="Case 7")))
    assert finding.motion_hash == strong().hash
    assert finding.mark is None
    assert any("a showcase, for its record names the case or plinth 'Case 7'" in text for text in finding.assumptions)
    assert any(text.startswith("level: off by up to 0.5°") for text in finding.assumptions)


def test_a_flexible_object_meets_its_own_frequency() -> None:
    """A statue of 5 Hz in a case of 3 to 12: the range reaches what one of 5 Hz passes on, an oscillator on another.

    The grid of frequencies is 6 % apart, so that its nearest is within 3 %: the peak of two oscillators of 3 and 2 % is
    as wide as both, 10 %, and 0.8 of it is met.
    """
    statue = Item("2", "G", title="Statue", object_name="Statue", medium="marble", support=Support.FASTENED,
                  height_m=0.5, width_m=0.2, depth_m=0.2, mass_kg=20.0, frequency_hz=5.0, damping=0.02,
                  section_width_m=0.05, section_shape="round", furniture=Furniture.SHOWCASE)  # fmt: skip
    (finding,) = (one for one in found(statue) if one.model == "flexible_stress")
    worst = replace(statue, furniture=Furniture.FLOOR)
    at_5 = transmit("plinth", strong(), refine=4, frequency=5.0, damping=0.03)
    (alone,) = (one for one in found(worst, level(at_5)) if one.model == "flexible_stress")
    assert finding.high is not None
    assert alone.demand is not None
    assert finding.high > 0.8 * alone.demand


def test_measures_are_tried_in_the_furniture() -> None:
    """What keeps a body on the floor from meeting its neighbour is too little in a showcase."""
    tight = replace(VASE, clearance_m=0.02)
    for kind in (Furniture.FLOOR, Furniture.SHOWCASE):
        scene = classify(replace(tight, furniture=kind))
        _, findings = assess([scene], [level()], Context(Threads(1)))
        ((advice, *_),) = advise([scene], findings, [level()], Context(Threads(1)))
        if kind is Furniture.FLOOR:
            before = advice
    assert sliding(findings[0]).verdict is Verdict.FAIL
    assert (advice.measure, advice.parameters) != (before.measure, before.parameters)
