"""68 objects beside what an engineer and a mount-maker wrote down of each before any was run.

What they wrote stays as it was written (tests/data/collections/advised_expected.csv); where Kouros says otherwise and
is right, or nobody can say, that is named here with the reason.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import pytest

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items
from pipeline.execute import Threads
from pipeline.mitigate import advise
from pipeline.mitigate.installed import Placed, stood_of
from pipeline.mitigate.trials import HarmAim
from pipeline.motions import read_motion
from pipeline.records import Origin, Recommendation, Sampling, Scene
from pipeline.resources import resource
from tests.soak import SOAK

pytestmark = pytest.mark.slow_file

FOLDER = Path(__file__).parents[1] / "data" / "collections"

UNWEIGHED = {
    "N.07": "an egg that rests in a ring is no body with a foot: the range covers it",
    "N.08": "a disc fills more of its box than a thing of stone that may be anything",
    "S.02": "most of an orrery's outline is air, more than of a microscope's: the range covers it",
    "E.02": "a log fills more of its box than a thing of wood that may be anything",
    "A.05": "of cloth, which a scroll is lighter than",
    "R.03": "thick-walled for transport",
    "A.09": "it is taken as wide as its thickness, as its third size is not recorded",
    "C.04": "forty things, followed as one",
    "P.02": "of what leans no mass is asked",
}
"""Objects whose mass by the best estimate is not what such things weigh, each with why."""

DISPUTED = {
    ("C.02", "wide_base"): "a plate under a monitor is clumsy, and no harm",
    ("E.03", "clamps"): "its base is that of its stand, which takes clamps",
    ("E.07", "wide_base"): "a plate under a figure is no harm",
    ("E.08", "clips"): "they hold the foot of its stand",
    ("S.10", "wax"): "at 12 kg some trust it to wax; it is told to be looked at twice a year",
}
"""Measures that nobody had written down and that are no mistake, each with why."""


def expected() -> Mapping[str, Mapping[str, str]]:
    with (FOLDER / "advised_expected.csv").open(encoding="utf-8", newline="") as stream:
        return {row["number"]: row for row in csv.DictReader(stream)}


MISSED = 7 if SOAK else 4
"""Of 68 states as many were otherwise than written when this was first reached, of half four; more is a loss."""


@pytest.fixture(scope="module")
def scenes() -> Mapping[str, Scene]:
    path = FOLDER / "advised_objects.csv"
    mapping = guess(path, choices={"title": "Title / Description"}).mapping
    reading = read_items(path, mapping)
    assert reading.rejected == ()
    return {item.object_number: classify(item) for item in reading.items}


@pytest.fixture(scope="module")
def advised(scenes: Mapping[str, Scene]) -> Mapping[str, tuple[float, list[Recommendation]]]:
    """The probability of harm and the advice under one motion of 0.4 g and 38 cm/s that fits EN 1998-1."""
    level = [LevelMotions("design", "max", (read_motion(resource("site_motions", "demo_suite"))[4],))]
    # Every day each second object: what one is advised does not hang on others.
    some = dict(list(scenes.items())[:: 1 if SOAK else 2])
    aim, context, found = HarmAim(0.1, Sampling(128)), Context(Threads(1)), list(some.values())
    _, findings = assess(found, level, context)
    drawn = likelihoods(stood_of([Placed(scene) for scene in found]), len(found), level, aim.sampling, context.executor)
    chances = [tuple(one) for one in drawn]
    advice = advise(found, findings, level, context, chances=chances, aim=aim)
    harm = [max((one.probability for one in of_one), default=0.0) for of_one in chances]
    return dict(zip(some, zip(harm, advice, strict=True), strict=True))


def test_masses_are_those_of_such_things(scenes: Mapping[str, Scene]) -> None:
    """Three of four best estimates within what comparable things weigh, and all ranges about their middle but three."""
    near, about, all_of_them = set(), set(), set()
    for number, row in expected().items():
        mass = scenes[number].parameters.get("mass")
        if not row["mass_low_kg"] or (mass is not None and mass.origin is not Origin.ASSUMED):
            continue
        all_of_them.add(number)
        low, high = float(row["mass_low_kg"]), float(row["mass_high_kg"])
        if mass is not None and low <= mass.value <= high:
            near.add(number)
        if mass is not None and mass.low <= (low * high) ** 0.5 <= mass.high:
            about.add(number)
    assert all_of_them - near == set(UNWEIGHED)
    assert all_of_them - about == {"A.09", "C.04", "P.02"}


@pytest.mark.long("mitigate/test_four_museums::test_nothing_that_harms_is_advised")
def test_nothing_that_harms_is_advised(advised: Mapping[str, tuple[float, list[Recommendation]]]) -> None:
    wrong = {}
    for number, row in expected().items():
        if number not in advised:
            continue
        for one in advised[number][1]:
            good = {*row["right"].split("|"), *row["acceptable"].split("|")}
            if one.measure not in good and (number, one.measure) not in DISPUTED:
                wrong[number] = one.measure
    assert wrong == {}


@pytest.mark.long("mitigate/test_four_museums::test_states_are_those_that_an_engineer_expects")
def test_states_are_those_that_an_engineer_expects(
    scenes: Mapping[str, Scene], advised: Mapping[str, tuple[float, list[Recommendation]]]
) -> None:
    missed = {}
    for number, row in expected().items():
        if number not in advised:
            continue
        harm = advised[number][0]
        state = "act" if harm >= 0.1 else "watch" if harm >= 0.01 else "fine"
        state = "cannot" if scenes[number].missing or not scenes[number].models else state
        if state not in row["strong"].split("|"):
            missed[number] = (state, row["strong"])
    assert len(missed) <= MISSED, missed
