"""Furniture that is not fastened: what it passes on where it rests, slides and rocks, and what is said."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from functools import cache

import numpy as np
import pytest

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.furnished import EVEN, _variants, isolating
from pipeline.analysis.furniture import FurnitureFilter, LooseBodies, LooseBody, filter_of
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.questions import rule_questions
from pipeline.analysis.house.rule import HouseRule
from pipeline.analysis.loose import IMPACT, movement, passed_on
from pipeline.analysis.response import respond, trace
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.motions import read_motion
from pipeline.quantities import Array, G
from pipeline.records import Anchorage, Finding, Furniture, Item, Motion, Numerics, Support, Verdict
from pipeline.resources import resource
from pipeline.tables.assumed import assumed

HELD = LooseBody(half_width=50.0, cg_height=0.5, friction=50.0, shelf_height=1.0)
"""So wide and so rough that nothing moves it."""

SLIDES = LooseBody(half_width=0.5, cg_height=0.6, friction=0.2, shelf_height=1.0)
"""b/h is 0.83: under a friction of 0.2 no edge lifts."""

ROCKS = LooseBody(half_width=0.25, cg_height=1.0, friction=2.0, shelf_height=1.2)
"""b/h is 0.25, and it does not slide."""

CUP = Item("1", "G", title="Bowl", object_name="Bowl", support=Support.FREESTANDING, height_m=0.06, width_m=0.3,
           depth_m=0.3, base_width_m=0.3, base_depth_m=0.3, cg_height_m=0.03, mass_kg=1.0, friction=0.9,
           clearance_m=0.3, susceptible=False, furniture=Furniture.SHOWCASE)  # fmt: skip
"""Squat and rough: whatever happens to it is its furniture's doing."""


@cache
def strong() -> Motion:
    """The strongest part of the demonstration's record."""
    demo = read_motion(resource("site_motions", "demo"))[0]
    return Motion(demo.dt, demo.acceleration[:, round(15.0 / demo.dt) : round(30.0 / demo.dt)], "strong")


def pulse(push: float, seconds: float, dt: float = 0.005, quiet: float = 2.0) -> Motion:
    """A constant push along x after half a second of rest; its flanks take a sample each."""
    x = np.zeros(round((0.5 + seconds + quiet) / dt))
    first = round(0.5 / dt)
    x[first : first + round(seconds / dt)] = push
    return Motion(dt, [x, 0.0 * x, 0.0 * x], "pulse")


def bodies(body: LooseBody) -> FurnitureFilter:
    """A level showcase that is not fastened and surely of that size."""
    return FurnitureFilter((3.0, 6.0, 12.0), (0.03, 0.05, 0.1), 0.0, False, LooseBodies(body, body, body, body))


# ----------------------------------------------------------------------------------------------------------------------
# What it passes on


def test_what_neither_slides_nor_rocks_passes_on_what_shakes_it() -> None:
    """The very motion, and in every variant that of the same furniture fastened."""
    assert passed_on(strong(), HELD) is strong()
    assert movement(strong(), HELD) == 0.0
    loose, fast = (_variants(strong(), furniture=one) for one in (bodies(HELD), FurnitureFilter(*_plain(bodies(HELD)))))
    # Two variants more, of what would rock first: under the hardest push, and under the floor's own.
    before, after = [motion.hash for motion in fast], [motion.hash for motion in loose]
    assert after == [*before[:-2], before[1 + EVEN], before[-1], *before[-2:]]


def test_isolators_are_tried_on_what_rocks_first_too() -> None:
    """What moves last may rest where a narrower case of the same kind rocks: its shaking comes with the one variant."""
    level, firm = LevelMotions("design", "max", (strong(),)), bodies(HELD)
    alone = isolating(level, FurnitureFilter(*_plain(firm)))
    tippy = isolating(level, replace(firm, loose=LooseBodies(HELD, HELD, ROCKS, HELD)))
    assert len(alone.variants) == 1
    assert [motion.hash for motion in tippy.variants[0]] == [motion.hash for motion in alone.motions]
    rocked = passed_on(strong(), ROCKS)
    assert rocked.hash != strong().hash
    assert rocked.hash in {motion.hash for some in tippy.others for motion in some}
    assert len(tippy.variants) == 3


def _plain(furniture: FurnitureFilter) -> tuple[tuple[float, ...], tuple[float, ...], float]:
    return furniture.frequency, furniture.damping, furniture.level_error


def test_friction_limits_what_sliding_furniture_passes_on() -> None:
    """|a| <= mu (g + a_z) at every sample, which is reached; and it moves against its floor as `sliding` says.

    What is passed on are means over two steps of 5 ms, in which the weight changes by up to 5 %: without a vertical
    motion the limit is exact.  The path is found from what is passed on alone: twice integrated, by trapezoids, against
    the floor's.  What is left out between samples is below 1 % of it.
    """
    level = Motion(strong().dt, [*strong().acceleration[:2], 0.0 * strong().acceleration[2]])
    for motion, most in ((level, 1.0 + 1e-9), (strong(), 1.05)):
        x, y, z = passed_on(motion, SLIDES).acceleration
        share = np.hypot(x, y) / (G + z)
        assert 0.999 * SLIDES.friction < share.max() <= most * SLIDES.friction
    passed = passed_on(strong(), SLIDES)
    refine = round(strong().dt / passed.dt)
    floor = np.zeros((2, passed.samples))
    fine = np.arange((strong().samples - 1) * refine + 1) / refine
    for row in range(2):
        floor[row, : fine.size] = np.interp(fine, np.arange(strong().samples), strong().acceleration[row])
    against = _twice(passed.acceleration[:2] - floor, passed.dt)
    far = respond("sliding", strong(), friction_static=SLIDES.friction)["displacement"].iloc[0]
    assert far > 0.02
    assert np.hypot(*against).max() == pytest.approx(far, rel=0.01)
    assert movement(strong(), SLIDES) == pytest.approx(far, rel=1e-12)
    # It ends with the velocity of its floor: momentum is conserved to rounding.
    assert passed.acceleration[:2].sum(axis=1) == pytest.approx(floor.sum(axis=1), abs=1e-6 * np.abs(floor).sum())


def _twice(a: Array, dt: float) -> Array:
    v = np.cumsum(0.5 * dt * (a + np.roll(a, 1, axis=1)), axis=1)
    return np.cumsum(0.5 * dt * (v + np.roll(v, 1, axis=1)), axis=1)


def test_a_pushed_case_slides_as_newmark_says() -> None:
    """Pushed at A for t it is carried at mu g until it has the floor's velocity A t: for A t / (mu g), then at rest."""
    push, seconds = 6.0, 0.3
    passed = passed_on(pulse(push, seconds), SLIDES)
    limit = SLIDES.friction * G
    t = np.arange(passed.samples) * passed.dt - 0.5
    carried = push * seconds / limit
    assert passed.acceleration[0][(t > 0.01) & (t < carried - 0.01)] == pytest.approx(limit, rel=1e-9)
    assert passed.acceleration[0][t > carried + 0.02] == pytest.approx(0.0, abs=1e-9)
    assert not passed.acceleration[1].any()


def test_a_pushed_case_rocks_as_its_moment_says() -> None:
    """Just after the push A begins, flat still: theta'' = (A h - g b) / (4 R^2 / 3), against the push.

    What stands at z feels A - z theta'', and b theta'' upwards.  A tenth of a second later theta is 0.02, a fifteenth
    of the critical angle, by which both have changed by 3 %.
    """
    push = 4.0
    b, h, z = ROCKS.half_width, ROCKS.cg_height, ROCKS.shelf_height
    turn = (push * h - G * b) / (4.0 / 3.0 * (b * b + h * h))
    passed = passed_on(pulse(push, 0.3), ROCKS)
    t = np.arange(passed.samples) * passed.dt - 0.5
    early = (t > 0.03) & (t < 0.1)
    assert passed.acceleration[0][early] == pytest.approx(push - z * turn, rel=0.05)
    assert passed.acceleration[2][early] == pytest.approx(b * turn, rel=0.05)
    assert passed.acceleration[1] == pytest.approx(0.0, abs=1e-9)
    # Before the push it is the floor's own.
    assert not passed.acceleration[:, t < -2.0 * IMPACT].any()


@pytest.mark.parametrize("dt", [0.01, 0.005, 0.0025])
def test_what_rocks_and_comes_to_rest_conserves_momentum(dt: float) -> None:
    """Its place is 0 again upwards, and its velocity that of the floor: the impulses of all impacts are passed on.

    The integral of what is passed on is that of the floor within 1 % of the sum of its sizes; the largest push upwards
    does not grow as samples get finer, as an impact takes as long whatever they are: 10 % of what 2.5 ms give, of which
    the place of an impact between two samples of 10 ms is the most.
    """
    floor = pulse(4.0, 0.2, dt)
    passed = passed_on(floor, ROCKS)
    for row in (0, 2):
        total, size = passed.acceleration[row].sum() * passed.dt, np.abs(passed.acceleration[row]).sum() * passed.dt
        assert total == pytest.approx(floor.acceleration[row].sum() * floor.dt, abs=0.01 * size)
    finest = passed_on(pulse(4.0, 0.2, 0.0025), ROCKS)
    assert passed.acceleration[2].max() == pytest.approx(finest.acceleration[2].max(), rel=0.1)


def test_a_case_that_falls_is_followed_to_its_critical_angle() -> None:
    """What stands in it falls with it: the motion ends as `standing` passes alpha."""
    floor = pulse(6.0, 1.0)
    rotation = trace("standing", floor, half_width=0.25, cg_height=1.0, friction_static=2.0)["rotation"].to_numpy()
    falls = int(np.flatnonzero(np.abs(rotation) >= np.arctan2(0.25, 1.0))[0])
    assert passed_on(floor, ROCKS).samples == falls


def test_it_rocks_alike_whichever_way_the_motion_is_turned() -> None:
    """Nobody knows how it stands: turned by 37 degrees, the motion passed on is the same turned, to rounding."""
    turn = np.radians(37.0)
    x, y, z = strong().acceleration
    turned = Motion(strong().dt, [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, z])
    plain, other = (passed_on(one, ROCKS) for one in (strong(), turned))
    assert np.abs(plain.acceleration[2]).max() > 1.5 * np.abs(z).max()
    back_x = np.cos(turn) * other.acceleration[0] + np.sin(turn) * other.acceleration[1]
    # A chaotic sequence of impacts would take a difference of rounding anywhere: this one does not.
    assert back_x == pytest.approx(plain.acceleration[0], abs=1e-6 * G)


# ----------------------------------------------------------------------------------------------------------------------
# Whose word it is, and what is found


def rule(**fields: object) -> HouseRules:
    given = {"said_by": "Ann", "said_on": date(2031, 5, 1), **fields}
    return HouseRules([HouseRule(**given)], tuple(assumed().classes))  # type: ignore[arg-type]


def found(item: Item, *levels: LevelMotions) -> list[Finding]:
    return assess([classify(item)], levels or (shaking(1.0),), Context(Threads(1)))[1][0]


def shaking(times: float) -> LevelMotions:
    return LevelMotions("design", "max", (strong().scaled(times, "strong"),))


def test_the_record_comes_before_the_rule_and_the_rule_before_the_table() -> None:
    told = rule(gallery="G", furniture_anchorage="unanchored")
    nobody, ruled = classify(CUP), classify(CUP, house=told)
    recorded = classify(replace(CUP, furniture_anchorage=Anchorage.ANCHORED), house=told)
    assert [one.anchorage for one in (nobody, ruled, recorded)] == [None, Anchorage.UNANCHORED, Anchorage.ANCHORED]
    assert [filter_of(one).loose is None for one in (nobody, ruled, recorded)] == [True, False, True]  # type: ignore[union-attr]
    notes = [next(t for t in one.assumptions if t.startswith("furniture:")) for one in (nobody, ruled, recorded)]
    assert notes[0].endswith("; taken as fastened, which nobody says")
    assert notes[1].endswith("; not fastened, by the house rule for gallery G (Ann, 2031-05-01)")
    assert notes[2].endswith("; fastened, as recorded")
    assert "it stands in furniture that is not fastened, by the house rule for gallery G" in ruled.statements[0]
    # What moves as the floor does is fastened to it, whatever is said.
    bare = replace(CUP, furniture=Furniture.FLOOR, furniture_anchorage=Anchorage.UNANCHORED)
    assert (classify(bare).anchorage, filter_of(classify(bare))) == (None, None)


def test_the_survey_asks_whether_it_is_fastened_until_somebody_says_it() -> None:
    unsaid = [classify(replace(CUP, object_number=str(n))) for n in range(5)]
    said = [classify(replace(CUP, furniture_anchorage=Anchorage.ANCHORED)) for _ in range(5)]
    (question,) = (one for one in rule_questions(unsaid, []) if one.field == "furniture_anchorage")
    assert question.objects == 5
    assert question.plain(date(2031, 5, 1))["furniture_anchorage"] == "anchored | unanchored"
    assert not [one for one in rule_questions(said, []) if one.field == "furniture_anchorage"]


def test_furniture_that_is_not_fastened_is_judged_itself() -> None:
    """It is open whether it falls, and what it does by the best estimates is said; its numbers are assumptions."""
    (finding,) = (one for one in found(replace(CUP, furniture_anchorage=Anchorage.UNANCHORED)) if _itself(one))
    assert (finding.object_number, finding.gallery, finding.title) == ("1", "G", "Tipping of its furniture")
    assert finding.verdict is Verdict.UNDETERMINED
    assert "not fastened" in finding.sentence
    assert "on its floor" in finding.sentence or "it slides" in finding.sentence or "comes back" in finding.sentence
    assert any("friction on its floor: 0.4 (0.25 to 0.6), furniture.csv for a showcase" in t for t in _notes(CUP))
    assert not [one for one in found(CUP) if _itself(one)]
    # What nothing can be said of does not look assessed because its furniture is.
    assert not found(Item("1", "G", object_name="Bowl", furniture_anchorage=Anchorage.UNANCHORED))
    # Under a twentieth of the shaking its furniture does not even slide.
    (weak,) = (
        one for one in found(replace(CUP, furniture_anchorage=Anchorage.UNANCHORED), shaking(0.05)) if _itself(one)
    )
    assert weak.verdict is Verdict.PASS
    assert weak.sentence.endswith("it stays where it stands.")


def _itself(finding: Finding) -> bool:
    return finding.model == "unanchored"


def _notes(item: Item) -> tuple[str, ...]:
    return classify(replace(item, furniture_anchorage=Anchorage.UNANCHORED)).assumptions


def test_history_and_auto_say_the_same_in_loose_furniture() -> None:
    item = replace(CUP, friction=0.3, furniture_anchorage=Anchorage.UNANCHORED)
    both = [
        assess([classify(item)], [shaking(1.0)], Context(Threads(1)), Numerics(fidelity))[1][0]
        for fidelity in ("auto", "history")
    ]
    assert [(one.model, one.verdict) for one in both[0]] == [(one.model, one.verdict) for one in both[1]]
