"""Several levels of shaking: one measure for all of them, and where there is none the sentence says so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.response import respond
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate import MeasureCatalogue, advise, changed
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.mitigate.saying import ONLY_HERE
from pipeline.motions.synthesis import sine
from pipeline.quantities import G
from pipeline.records import Item, Motion, Recommendation, Verdict

from .scenes import BLOCK, PICTURE, TOWER, demo_motion


@pytest.fixture(scope="module")
def motion() -> Motion:
    return demo_motion()


def two(weak: Motion, strong: Motion) -> list[LevelMotions]:
    return [LevelMotions("weak", "max", (weak,)), LevelMotions("strong", "max", (strong,))]


def solve(
    item: Item, levels: Sequence[LevelMotions], catalogue: MeasureCatalogue | None = None
) -> dict[str, Recommendation]:
    scenes = [classify(item)]
    _, findings = assess(scenes, levels, Context(Threads(1)))
    ((*found,),) = advise(scenes, findings, levels, Context(Threads(1)), catalogue=catalogue)
    return {one.level: one for one in found}


def test_the_room_of_the_strong_level_is_kept_at_both(motion: Motion) -> None:
    """Room by hand from the slide under the strong motion, a tenth more, up to a whole centimetre."""
    strong = motion.scaled(1.3, "strong")
    advice = solve(BLOCK, two(motion, strong))
    slides = [float(respond("sliding", m, friction_static=0.1)["displacement"].iloc[0]) for m in (motion, strong)]
    assert slides[0] < slides[1]
    for level, slid in zip(("weak", "strong"), slides, strict=True):
        assert advice[level].measure == "clearance"
        assert advice[level].parameters["clearance"] == pytest.approx(np.ceil(110.0 * slides[1]) / 100.0)
        # Each level has its own evidence.
        (check,) = (c for c in advice[level].checks if c.model == "sliding")
        assert check.demand == pytest.approx(slid, rel=2e-3)
        assert ONLY_HERE not in advice[level].sentence


def test_what_is_advised_for_one_level_passes_at_all(motion: Motion) -> None:
    """Under the weak motion room is enough; under the strong one it slides further than any display has room for."""
    levels = two(motion.scaled(0.5, "weak"), motion.scaled(1.6, "strong"))
    slippery = replace(BLOCK, friction=0.001, base_width_m=2.0, base_depth_m=2.0)
    alone = solve(slippery, levels[:1])
    assert alone["weak"].measure == "clearance"
    advice = solve(slippery, levels)
    assert {one.measure for one in advice.values()} == {"grip_pad"}
    assert advice["weak"].parameters == advice["strong"].parameters
    for one in advice.values():
        _, (found,) = assess([changed(classify(slippery), one.measure, one.parameters)], levels, Context(Threads(1)))
        assert {f.level for f in found} == {"weak", "strong"}
        assert all(f.verdict is Verdict.PASS for f in found)


def test_a_measure_for_one_level_only_says_so(motion: Motion) -> None:
    """Nothing helps under the strong motion: the weak one keeps its own answer, and is not passed off as more."""
    hopeless = replace(TOWER, allowable_stress_pa=1e3, base_width_m=0.05, base_depth_m=0.05, friction=0.01)
    weak = motion.scaled(0.06, "weak")
    tight = replace(hopeless, clearance_m=0.0001)
    advice = solve(tight, two(weak, motion.scaled(3.0, "strong")))
    assert advice["strong"].measure == "remove"
    assert advice["weak"].measure == "clearance"
    assert advice["weak"].sentence.endswith(f" {ONLY_HERE}")
    assert ONLY_HERE not in advice["strong"].sentence


def test_an_isolator_that_resonates_at_another_level_is_not_advised(motion: Motion) -> None:
    """At 0.15 g and its own frequency the isolator runs out of stroke, though the object stands as it is."""
    own = own_catalogue()
    soft = next(one for one in own.isolators if one.name == "generic 0.5 Hz, friction 0.05")
    only = MeasureCatalogue(own.measures, (soft,))
    fragile = replace(TOWER, allowable_stress_pa=2e5, friction=0.5)
    slow = sine(0.15 * G, 0.5, 10.0)
    given = {"frequency": soft.frequency, "damping": soft.damping, "friction": soft.friction}
    assert float(respond("horizontal_isolator", slow, **given)["displacement"].iloc[0]) > 0.30  # type: ignore[arg-type]
    levels = two(slow, motion)
    assert solve(fragile, levels[1:], only)["strong"].measure == "horizontal_isolator"
    advice = solve(fragile, levels, only)
    assert set(advice) == {"strong"}, "it stands under the slow motion"
    assert advice["strong"].measure == "strengthen"
    assert any(text.startswith("Horizontal isolator: ") for text in advice["strong"].rejected)


@pytest.mark.long("mitigate/test_demo::test_pictures_fixed_to_the_wall_need_the_force_of_their_mass")
def test_a_hung_picture_is_fixed_for_the_strongest_push(motion: Motion) -> None:
    """The force of a second fixing is that of the strong level, also where the weak one is asked about."""
    weak, strong = motion.scaled(3.0, "weak"), motion.scaled(4.0, "strong")
    advice = solve(replace(PICTURE, suspension_length_m=3.0), two(weak, strong))
    push = float(np.hypot(*strong.acceleration[:2]).max())
    assert {one.measure for one in advice.values()} == {"restrain"}
    for one in advice.values():
        assert one.parameters["force"] == pytest.approx(8.0 * push)
        assert [check.model for check in one.checks] == ["hanger_load"]
