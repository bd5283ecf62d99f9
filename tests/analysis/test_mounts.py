"""What lies in a case or is held by a mount: as what it is, by what is usual or by what the museum states."""

from collections.abc import Mapping
from dataclasses import replace
from math import log, radians, tan
from typing import Any

import pytest
from pydantic import ValidationError

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify, object_classes
from pipeline.analysis.context import Context
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.questions import rule_questions
from pipeline.analysis.house.rule import HouseRule
from pipeline.analysis.likelihood.sampling import Stood, likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate import advise
from pipeline.quantities import G
from pipeline.records import Finding, Furniture, Item, Motion, Mount, Origin, Sampling, Scene, Support, Verdict
from pipeline.tables import table
from tests.analysis.test_likelihood import pulse

COIN = Item("1", "East", title="Coin", object_name="coin", medium="silver", height_m=0.03, width_m=0.03, depth_m=0.002,
            furniture=Furniture.FLOOR)  # fmt: skip
MASK = Item("2", "East", "Mask", object_name="mask", height_m=0.3, width_m=0.2, depth_m=0.1, furniture=Furniture.FLOOR)


def stated(item: Item, **said: Any) -> Scene:
    rule = HouseRule.model_validate({"gallery": "East", "said_by": "A", "said_on": "2031-05-01", **said})
    return classify(item, house=HouseRules([rule], sorted(object_classes())))


def verdicts(scene: Scene, motion: Motion) -> Mapping[str, Verdict]:
    found = judged(scene, motion)
    return {one.model: one.verdict for one in found}


def judged(scene: Scene, motion: Motion) -> list[Finding]:
    _, (found,) = assess([scene], [LevelMotions("design", "max", (motion,))], Context(Threads(1)))
    return found


def test_a_coin_lies_on_its_largest_face_and_only_slides() -> None:
    scene = classify(COIN)
    assert (scene.object_class, scene.mount, scene.mount_origin) == ("small_flat", Mount.LYING, Origin.ASSUMED)
    assert scene.missing == ()
    assert "lies on its largest face" in scene.assumptions[0]
    # Its smallest size is vertical, however it is written down.
    for height, width, depth in ((0.03, 0.03, 0.002), (0.002, 0.03, 0.03), (0.03, 0.002, 0.03)):
        laid = classify(replace(COIN, height_m=height, width_m=width, depth_m=depth))
        assert laid.parameters["cg_height"].value == pytest.approx(0.5 * 0.002)
        assert laid.parameters["half_width"].value == pytest.approx(0.5 * 0.8 * 0.03)
    assert verdicts(scene, pulse(1.5 * G, 1.0)) == {"sliding": Verdict.FAIL}
    assert verdicts(scene, pulse(0.05 * G, 0.5)) == {"sliding": Verdict.PASS}


def test_what_is_thick_and_large_stands() -> None:
    maker = replace(COIN, height_m=0.286, width_m=0.241, depth_m=0.108)
    assert classify(maker).object_class == "small_flat"
    assert (classify(maker).mount, classify(maker).mount_origin) == (Mount.STANDING, Origin.ASSUMED)
    assert "standing" in classify(maker).models
    assert classify(replace(maker, depth_m=0.05)).mount is Mount.LYING
    assert classify(replace(maker, height_m=0.15, width_m=0.12)).mount is Mount.LYING


def test_what_a_round_thing_lacks_is_how_thick_it_is() -> None:
    mirror = replace(COIN, height_m=None, width_m=0.12, depth_m=0.12)
    thick = classify(mirror).parameters["height"]
    assert thick.high <= 0.12
    assert thick.value < 0.06


def test_sizes_are_no_matter_to_what_slides() -> None:
    bare = replace(COIN, height_m=None, width_m=None, depth_m=None)
    assert classify(bare).missing == ()
    assert verdicts(classify(bare), pulse(1.5 * G, 1.0)) == {"sliding": Verdict.FAIL}


@pytest.mark.parametrize(
    ("item", "said", "models"),
    [
        (COIN, {"mount": "standing"}, ("standing", "sliding")),
        (COIN, {"mount": "leaning"}, ("standing", "sliding")),
        (COIN, {"mount": "resting"}, ("sliding",)),
        (MASK, {"mount": "secured"}, ("sliding",)),
        (MASK, {"mount": "lying"}, ("sliding",)),
    ],
)
def test_a_house_rule_says_how_things_are_held(item: Item, said: dict[str, str], models: tuple[str, ...]) -> None:
    scene = stated(item, **said)
    assert (scene.mount, scene.mount_origin) == (Mount(said["mount"]), Origin.STATED)
    assert set(models) <= set(scene.models)
    assert ("standing" in scene.models) == ("standing" in models)
    assert any("by the house rule for gallery East" in text for text in scene.statements)
    assert scene.missing == ()


def test_what_leans_comes_away_where_the_push_exceeds_g_times_the_tangent() -> None:
    scene = stated(replace(COIN, height_m=0.3, width_m=0.3, depth_m=0.02), mount="leaning", friction=1.5)
    half, cg = scene.parameters["half_width"], scene.parameters["cg_height"]
    assert half.value / cg.value == pytest.approx(tan(radians(15.0)))
    # Below the least angle it may lean at nothing lifts.
    assert verdicts(scene, pulse(0.9 * tan(radians(8.0)) * G, 0.5))["standing"] is Verdict.PASS
    assert verdicts(scene, pulse(0.8 * G, 1.0))["standing"] is Verdict.FAIL


def test_a_mask_is_held_by_a_mount_of_which_nobody_knows_the_grip() -> None:
    """Under a long push of a everything leaves that grips less: the share of the range below a, in the logarithm."""
    scene = classify(MASK)
    assert (scene.object_class, scene.mount) == ("mounted", Mount.UNKNOWN)
    assert judged(scene, pulse(0.6 * G, 1.0))[0].verdict is Verdict.UNDETERMINED
    assert "mount" in judged(scene, pulse(0.6 * G, 1.0))[0].sentence
    level = LevelMotions("design", "max", (pulse(0.6 * G, 2.0),))
    ((found,),) = likelihoods([Stood(0, scene)], 1, [level], Sampling(512, 2.0), Threads(1))
    # The direction is drawn too, which no push of two directions hangs on; the scatter of 0.25 spreads the edge evenly.
    row = next(one for one in table("mounts") if one["mount"] == "unknown")
    low, best = float(row["grip_low"]), float(row["grip"])
    share = 0.5 * log(0.6 / low) / log(best / low)
    assert found.probability == pytest.approx(share, abs=0.04)
    held = stated(MASK, mount="secured")
    assert verdicts(held, pulse(0.6 * G, 1.0)) == {"sliding": Verdict.PASS}
    rests = stated(MASK, mount="resting", friction=0.3)
    assert verdicts(rests, pulse(0.9 * G, 1.0)) == {"sliding": Verdict.FAIL}


def test_what_the_record_says_of_its_support_comes_before_what_is_usual() -> None:
    fastened = classify(replace(MASK, support=Support.FASTENED))
    assert (fastened.mount, fastened.mount_origin, fastened.support) == (
        Mount.SECURED, Origin.MEASURED, Support.FASTENED,
    )  # fmt: skip
    assert verdicts(fastened, pulse(0.6 * G, 1.0)) == {"sliding": Verdict.PASS}
    measured = classify(replace(MASK, support=Support.FASTENED, section_width_m=0.02, mass_kg=1.0))
    assert measured.mount is None
    assert "stress" in measured.models
    assert classify(replace(MASK, support=Support.HUNG)).mount is None
    overruled = stated(replace(MASK, support=Support.FASTENED), mount="resting")
    assert overruled.mount is Mount.SECURED
    assert any("its record says secured" in text for text in overruled.statements)


def test_a_rule_of_mounts_is_for_what_lies_or_is_held_by_them() -> None:
    vase = Item("3", "East", title="Vase", classification="Ceramics", height_m=0.3, width_m=0.2, depth_m=0.2)
    scene = stated(vase, mount="secured")
    assert scene.mount is None
    assert scene.statements == ()


def test_nobody_states_that_nobody_knows() -> None:
    with pytest.raises(ValidationError, match="say how they are held"):
        HouseRule.model_validate({"gallery": "East", "mount": "unknown", "said_by": "A", "said_on": "2031-05-01"})


def test_a_survey_asks_once_how_all_of_them_are_held() -> None:
    scenes = [classify(replace(MASK, object_number=str(number))) for number in range(6)]
    asked = {question.field: question for question in rule_questions(scenes, [])}
    assert asked["mount"].objects == 6
    assert "secured" in asked["mount"].plain("2031-05-01")["mount"]
    known = [stated(scene.item, mount="secured") for scene in scenes]
    assert "mount" not in {question.field for question in rule_questions(known, [])}


@pytest.mark.parametrize("item", [COIN, MASK])
def test_what_lies_or_is_mounted_is_never_put_on_an_isolator(item: Item) -> None:
    scene = stated(item, mount="resting", friction=0.3) if item is MASK else stated(item, friction=0.3)
    level = LevelMotions("design", "max", (pulse(0.9 * G, 1.0),))
    findings = [judged(scene, level.motions[0])]
    ((advice,),) = advise([scene], findings, [level], Context(Threads(1)))
    assert advice.measure in {"clearance", "surface", "grip_pad", "pins", "wax", "putty", "clips", "hold"}
    assert all(check.passes for check in advice.checks)
    if item is MASK:
        assert advice.measure == "hold"
        # The pull of weight and push together.
        assert advice.parameters["times"] == pytest.approx((1.0 + 0.9**2) ** 0.5, abs=0.1)
