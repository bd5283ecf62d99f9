"""Harm to objects that may be of several classes: against closed forms, and on a museum that is simulated.

A block under a rectangular pulse A for T leaves its place where its friction is below A^2 T^2 / (g (A T^2 + 2 r)), with
r its room.  Without the scatter of the models the probability of that is a share of the distribution of its friction.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.likelihood.analyses import CERTAIN, LEAST, Kind, Stood, scenes_by_class
from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate.by_class import NAMED_FIRST, for_every_class
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.mitigate.installed import Placed, PlacedAs, stood_of
from pipeline.mitigate.search import advise
from pipeline.mitigate.trials import HarmAim
from pipeline.models.rigid_body import FALLS_IN, HALF
from pipeline.night.assessment import likeness, place
from pipeline.quantities import G
from pipeline.records import (
    Assessment,
    Band,
    Decision,
    DecisionKind,
    Estimate,
    Item,
    Likelihood,
    Motion,
    Sampling,
    Scene,
    Support,
    Verdict,
)
from pipeline.report.pages.chances import chance_view
from pipeline.report.pages.tallies import state_of
from pipeline.report.pages.views import State
from tests.soak import some

LONG = pytest.mark.long("test_the_probability_is_that_of_each_class_weighed_by_its_chance")

MANY = Sampling(4096, 2.0)
"""As many samples, whatever the word: of none is that certain."""

PUSH, SECONDS = 6.0, 0.3
LOW, BEST, HIGH = 0.2, 0.3, 0.6


@pytest.fixture(autouse=True)
def no_scatter(monkeypatch: pytest.MonkeyPatch) -> None:
    """The closed form is of a block without it."""
    monkeypatch.setattr("pipeline.analysis.likelihood.draws.FARTHEST", 0.0)


@cache
def shaking() -> LevelMotions:
    n = round(SECONDS / 0.001)
    x = np.zeros(n + 3)
    x[1 : n + 1] = PUSH
    motion = Motion(0.001, np.vstack([x, np.zeros((2, x.size))]), "pulse")
    return LevelMotions("design", "max", (motion,), x_azimuth=90.0)


def exact(room: float) -> float:
    limit = PUSH**2 * SECONDS**2 / (G * (PUSH * SECONDS**2 + 2.0 * room))
    return float(np.interp(math.log(limit), np.log([LOW, BEST, HIGH]), [0.0, 0.5, 1.0]))


def slider(room: float, object_class: str = "cabinet", number: str = "1") -> Scene:
    known = {
        "friction_static": Estimate.assumed(BEST, LOW, HIGH, "-", "", ""),
        "clearance": Estimate.measured(room, "m"),
    }
    return Scene(Item(number, "G"), object_class, "", Support.FREESTANDING, ("sliding",), known)


def as_each(*each: tuple[str, float, float]) -> Placed:
    """A block as each of some classes: name, chance, room."""
    those = tuple(PlacedAs((name,), chance, Placed(slider(room, name))) for name, chance, room in each)
    return replace(those[0].placed, may_be=those)


def drawn(objects: Sequence[Placed], sampling: Sampling = MANY) -> list[Likelihood]:
    return [one for (one,) in likelihoods(stood_of(objects), len(objects), [shaking()], sampling, Threads(1))]


def within(p: float, samples: int) -> float:
    """Four standard errors of samples that were independent; balanced ones are better."""
    return 4.0 * math.sqrt(p * (1.0 - p) / samples)


@pytest.mark.parametrize(
    "chances",
    [
        pytest.param(chances, marks=[] if len(chances) == 3 else LONG)
        for chances in some([(0.62, 0.31), (0.9, 0.06), (0.4, 0.3, 0.2)], 2)
    ],
)
def test_the_probability_is_that_of_each_class_weighed_by_its_chance(chances: tuple[float, ...]) -> None:
    rooms = (0.04, 0.12, 0.07)[: len(chances)]
    names = ("vessel", "lamp", "dish")
    (one,) = drawn([as_each(*zip(names, chances, rooms, strict=False))])
    shares = np.array(chances) / sum(chances)
    true = float(shares @ [exact(room) for room in rooms])
    assert one.samples == 4096
    assert one.probability == pytest.approx(true, abs=within(true, 4096))
    assert one.states["leaves"] == one.probability
    assert one.error == pytest.approx(math.sqrt(true * (1.0 - true) / 4096), rel=0.05)
    assert [each.classes for each in one.classes] == [(name,) for name in names[: len(chances)]]
    for each, share, room in zip(one.classes, shares, rooms, strict=True):
        assert each.chance == pytest.approx(share)
        # Samples that are balanced are in proportion: of 4,096 to one at either end.
        assert each.samples == pytest.approx(4096 * share, abs=2.0)
        assert each.probability == pytest.approx(exact(room), abs=within(exact(room), each.samples))
    parts = sum((each.probability or 0.0) * each.samples for each in one.classes) / 4096
    assert parts == pytest.approx(one.probability)


def test_what_another_object_may_be_changes_no_digit() -> None:
    sure = Placed(slider(0.07))
    unsure = as_each(("vessel", 0.6, 0.04), ("lamp", 0.4, 0.12))
    usual = Sampling()
    alone = drawn([sure], usual), drawn([unsure], usual)
    assert drawn([sure, unsure], usual) == [*alone[0], *alone[1]]
    assert alone[0][0].classes == ()


def test_a_state_harms_it_only_as_what_it_is() -> None:
    """A vase that rocks and does not fall: rocking harms it as one class, of a chance of 0.25, and not as the other."""
    vase = Item(
        "1", "G", object_name="vase", medium="porcelain", height_m=0.4, width_m=0.3, base_width_m=0.3, friction=3.0
    )
    fragile = replace(classify(vase), furniture=None)
    sound = replace(fragile, parameters={**fragile.parameters, FALLS_IN: Estimate.measured(HALF, "-")})
    x = np.zeros(400)
    x[1:20] = 1.2 * G
    kick = LevelMotions("design", "max", (Motion(0.002, np.vstack([x, np.zeros((2, x.size))]), "kick"),))
    kinds = Kind(("seat",), 0.0, 0.75), Kind(("vessel",), 0.75, 1.0)
    stood = [Stood(0, sound, kind=kinds[0]), Stood(0, fragile, kind=kinds[1]), Stood(1, sound), Stood(2, fragile)]
    found = [one for (one,) in likelihoods(stood, 3, [kick], Sampling(256, 2.0), Threads(1))]
    mixed, never, always = found
    assert len({(one.states["rocks"], one.states["falls"]) for one in found}) == 1, "it does the same whatever harms it"
    rocks = mixed.states["rocks"]
    assert 0.5 < rocks <= 1.0
    assert mixed.states["falls"] == 0.0
    assert (never.probability, always.probability) == (0.0, rocks)
    assert (never.harm, always.harm, mixed.harm) == ("", "rocks", "rocks")
    assert mixed.probability == pytest.approx(0.25 * rocks, abs=within(0.25 * rocks, 256))


SURE = Sampling(512, 0.9999)
"""Stops late enough for what one thing alone would tell to be certain."""


def test_knowing_the_class_is_worth_what_the_closed_form_says() -> None:
    """Never harmed as one class, always as the other: where it is found to be the first (0.7), acting (0.1) is spared.

    Which of four parts the friction lies in tells nothing then, and neither does the class where both are acted on.
    """
    (one, both) = drawn(
        [as_each(("vessel", 0.7, 100.0), ("lamp", 0.3, 1e-4)), as_each(("vessel", 0.7, 1e-4), ("lamp", 0.3, 2e-4))],
        SURE,
    )
    assert (one.open_for, both.open_for) == ("class", "")
    # Balanced samples: as many as the chance says, to one.
    assert one.moves == pytest.approx(0.7, abs=1.0 / one.samples)
    assert one.worth == pytest.approx(0.7 * 0.1, abs=0.1 / one.samples)


def test_the_mixture_is_calibrated_where_the_first_class_alone_is_not() -> None:
    """A museum that is simulated: what each thing is is drawn by its chances, harm by the probability of that class.

    The Brier score of the mixture is that of a forecast that is right, the mean of p (1 - p); that of the first class
    alone is worse by the mean of (p1 - p)^2.  Tolerances: four standard errors of the scores of 40,000 outcomes, and of
    what 1,024 samples make the probabilities err by.
    """
    rng = np.random.default_rng(3)
    rooms = np.column_stack([rng.uniform(0.1, 0.4, 40), rng.uniform(0.02, 0.1, 40)])
    chances = rng.uniform(0.5, 0.95, 40)
    objects = [
        as_each(("vessel", float(c), float(a)), ("lamp", float(1.0 - c), float(b)))
        for c, (a, b) in zip(chances, rooms, strict=True)
    ]
    found = drawn(objects, Sampling(1024, 2.0))
    first = drawn([one.may_be[0].placed for one in objects], Sampling(1024, 2.0))
    by_class = np.array([[exact(a), exact(b)] for a, b in rooms])
    true = chances * by_class[:, 0] + (1.0 - chances) * by_class[:, 1]
    is_first = rng.random((1000, 40)) < chances
    harmed = rng.random((1000, 40)) < np.where(is_first, by_class[:, 0], by_class[:, 1])
    mixed_score = (harmed - np.array([one.probability for one in found])) ** 2
    first_score = (harmed - np.array([one.probability for one in first])) ** 2
    noise = 4.0 * float(np.std(mixed_score)) / math.sqrt(mixed_score.size) + 1.0 / (4.0 * 1024)
    assert np.mean(mixed_score) == pytest.approx(np.mean(true * (1.0 - true)), abs=noise)
    worse = float(np.mean((by_class[:, 0] - true) ** 2))
    difference = first_score - mixed_score
    off = 4.0 * float(np.std(difference)) / math.sqrt(difference.size) + 1.0 / 1024
    assert worse > 2.0 * off, "a difference that this test can see"
    assert np.mean(difference) == pytest.approx(worse, abs=off)


ROBIN = Item(
    "70.32",
    "G",
    title="Robin",
    classification="Ceramics",
    medium="porcelain",
    height_m=0.21,
    width_m=0.10,
    depth_m=0.14,
)
"""A porcelain robin: by the title perhaps a figure, by the classification a vessel."""


def test_classes_that_count_are_those_likely_enough_for_which_something_else_is_computed() -> None:
    scene = classify(ROBIN)
    each = scenes_by_class(scene)
    assert each[0].classes[0] == scene.object_class
    assert each[0].scene is scene
    assert len(each) > 1
    known = dict(scene.chances)
    for one in each:
        assert one.chance == pytest.approx(sum(known[name] for name in one.classes))
        assert all(known[name] >= LEAST for name in one.classes)
        assert one.scene.object_class == one.classes[0]
    named = {name for one in each for name in one.classes}
    # Nothing is computed for what lies in a case or is held by a mount; the others that are likely are all there.
    left = {name for name, p in scene.chances if p >= LEAST} - named
    assert all(not classify(ROBIN, None, (name, "test")).models for name in left)


def test_what_people_decide_and_what_makes_no_difference_is_certain() -> None:
    decided = Decision(
        1,
        ROBIN.object_number,
        DecisionKind.CLASS,
        who="A",
        why="seen",
        date="2026-01-01",
        recorded="",
        object_class="figurine",
    )
    assert place(ROBIN, None, ()).may_be
    assert not place(ROBIN, None, (decided,)).may_be
    assert not scenes_by_class(classify(ROBIN, None, ("figurine", "A")))
    assert not scenes_by_class(replace(classify(ROBIN), chances=(("vessel", 0.97), ("figurine", LEAST - 0.01))))
    # What is computed alike for two classes is one.
    same = replace(classify(ROBIN), chances=(("vessel", 0.6), ("vessel", 0.4)))
    assert not scenes_by_class(same)


def test_nothing_is_weighed_where_nothing_is_computed_for_what_it_is_taken_for() -> None:
    scene = classify(ROBIN)
    assert not scenes_by_class(replace(scene, models=()))
    assert not scenes_by_class(replace(scene, missing=("height",)))


def test_what_is_alike_in_all_but_what_it_may_be_is_not_alike() -> None:
    one = as_each(("vessel", 0.6, 0.04), ("lamp", 0.4, 0.12))
    assert likeness(one) == likeness(replace(one, scene=replace(one.scene, item=replace(one.scene.item, title="Lid"))))
    assert likeness(one) != likeness(replace(one, may_be=()))
    assert likeness(one) != likeness(as_each(("vessel", 0.7, 0.04), ("lamp", 0.3, 0.12)))
    assert likeness(one) != likeness(as_each(("vessel", 0.6, 0.04), ("lamp", 0.4, 0.11)))


def test_an_isolator_under_it_is_under_whatever_it_is() -> None:
    one = as_each(("vessel", 0.75, 0.04), ("lamp", 0.25, 0.12))
    stood = stood_of([Placed(slider(0.1)), one])
    assert [(each.of, each.kind) for each in stood] == [
        (0, CERTAIN),
        (1, Kind(("vessel",), 0.0, 0.75)),
        (1, Kind(("lamp",), 0.75, 1.0)),
    ]


def passing(found: Likelihood, scene: Scene) -> Assessment:
    """An object all of whose models pass, with a probability."""
    _, ((one,),) = assess([scene], [shaking()], Context(Threads(1)))
    assert one.verdict is Verdict.PASS
    return Assessment(scene, (one,), (), likelihoods=(found,))


def test_a_proof_holds_of_the_class_that_it_is_of() -> None:
    (mixed,) = drawn([as_each(("vessel", 0.95, 0.6), ("lamp", 0.05, 0.1))], SURE)
    assert mixed.band is Band.UNLIKELY
    scene = slider(0.6)
    assert state_of(passing(mixed, scene)) is State.WATCH
    assert state_of(passing(replace(mixed, classes=()), scene)) is State.FINE


def test_where_only_another_class_makes_harm_possible_no_measure_is_sought_but_what_it_is_is_asked() -> None:
    one = as_each(("vessel", 0.6, 0.6), ("lamp", 0.4, 0.05))
    (mixed,) = drawn([one], SURE)
    assert mixed.band is Band.POSSIBLE
    assert mixed.classes[0].probability == 0.0
    levels = [shaking()]
    _, findings = assess([one.scene], levels, Context(Threads(1)))
    aim = HarmAim(0.1, SURE)
    assert advise([one.scene], findings, levels, Context(Threads(1)), chances=[(mixed,)], aim=aim) == [[]]
    view = chance_view(Assessment(one.scene, tuple(findings[0]), (), likelihoods=(mixed,)))
    assert view is not None
    assert view.unnamed
    # It need not happen, and is not told as if it did.
    assert view.sentence.startswith("Harm is possible; if it comes to that, it most likely ")
    assert view.check.startswith("Say first what it is: ")
    assert view.classes.startswith("vessel (0.60): harm below 1 %, lamp (0.40): harm ")


@pytest.mark.parametrize(("friction", "short"), [(0.5, False), (0.05, True)])
def test_a_measure_is_tried_for_whatever_it_is(friction: float, short: bool) -> None:
    """Room enough for one class is enough for another one or not, as the closed form says of its friction."""
    rough, other = (Estimate.measured(mu, "-") for mu in (0.5, friction))
    one = as_each(("vessel", 0.6, 0.02), ("lamp", 0.4, 0.02))

    def with_friction(each: PlacedAs, mu: Estimate) -> PlacedAs:
        known = {**each.placed.scene.parameters, "friction_static": mu}
        return replace(each, placed=Placed(replace(each.placed.scene, parameters=known)))

    may_be = with_friction(one.may_be[0], rough), with_friction(one.may_be[1], other)
    one = replace(may_be[0].placed, may_be=may_be)
    levels, aim, context = [shaking()], HarmAim(0.1, SURE), Context(Threads(1))
    _, findings = assess([one.scene], levels, context)
    advice = advise([one.scene], findings, levels, context, chances=[tuple(drawn([one], SURE))], aim=aim)
    ((before,),) = advice
    assert before.measure == "clearance", before.rejected
    ((after,),) = for_every_class([one], advice, levels, context, aim, own_catalogue())
    moves = PUSH * SECONDS**2 * (PUSH - friction * G) / (2.0 * friction * G)
    assert (moves > after.parameters["clearance"]) is short
    # 16 samples at least: a balanced share of them to one, and half a harmed one more, for of none nothing is certain.
    assert after.remaining == pytest.approx(0.4 if short else 0.0, abs=1.5 / 17)
    assert after.sentence == (f"{before.sentence} {NAMED_FIRST}" if short else before.sentence)
