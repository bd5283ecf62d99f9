"""How a work hangs: what its record, its cord and its class say of it, what it is run with, and what is open."""

from __future__ import annotations

from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from pipeline import Motion
from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.hanging import hanging_of
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.rule import HouseRule
from pipeline.analysis.plan import plan
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.models.common import NO_VERTICAL
from pipeline.quantities import G
from pipeline.records import Finding, Hanging, Item, Origin, Support, Verdict
from pipeline.tables.assumed import assumed
from pipeline.tables.hanging_rows import hanging_rows, usual_hangings

WORK = Item("1", "G", object_name="painting", height_m=0.8, width_m=1.0, damping=0.02, clearance_m=0.1)


def shaken(up: float = 0.3) -> Motion:
    """Return ten seconds at 0.4 g and 0.9 Hz, at which a pendulum of 0.3 m swings out far; up times g upwards."""
    t = np.arange(1000) * 0.01
    x = 0.4 * G * np.sin(2.0 * np.pi * 0.9 * t)
    return Motion(0.01, np.vstack([x, np.zeros_like(x), up * G * np.sin(2.0 * np.pi * 3.0 * t)]))


def found(item: Item, motion: Motion) -> dict[str, Finding]:
    _, (findings,) = assess([classify(item)], [LevelMotions("design", "max", (motion,))], Context(Threads(1)))
    return {f.model: f for f in findings}


RUN = {
    Hanging.WIRE: {"swing", "unhooking", "hanger_load"},
    Hanging.TWO_HOOKS: {"unhooking", "hanger_load"},
    Hanging.CLEAT: {"unhooking", "hanger_load"},
    Hanging.SECURITY: {"hanger_load"},
    Hanging.FIXED: {"hanger_load"},
}


@pytest.mark.parametrize("way", list(Hanging))
def test_each_way_to_hang_has_its_failures(way: Hanging) -> None:
    """A wire swings; hooks and cleats may be jumped off; of what is closed only the load is left."""
    found_ = found(replace(WORK, hanging=way), shaken())
    assert set(found_) == RUN[way]
    if way is Hanging.WIRE:
        assert found_["swing"].verdict is Verdict.FAIL
    else:
        assert {f.verdict for f in found_.values()} == {Verdict.PASS}


def test_what_is_not_recorded_is_open_where_the_ways_differ() -> None:
    """By the likeliest way it does not swing, by another as far as on a wire; nobody assumes a wire."""
    scene = classify(WORK)
    assert scene.hanging is None
    assert "how it hangs is not recorded" in " ".join(scene.assumptions)
    unknown, wire = found(WORK, shaken())["swing"], found(replace(WORK, hanging=Hanging.WIRE), shaken())["swing"]
    assert unknown.verdict is Verdict.UNDETERMINED
    assert (unknown.demand, unknown.low) == (0.0, 0.0)
    assert unknown.high == wire.high
    assert any("how it hangs is not recorded" in text for text in unknown.assumptions)
    # Where even the wire has room, nobody needs to look behind it.
    weak = shaken().scaled(0.01, "weak")
    assert found(WORK, weak)["swing"].verdict is Verdict.PASS


def test_the_record_is_taken_before_a_cord_and_a_cord_before_the_class() -> None:
    cord = replace(WORK, suspension_length_m=1.5)
    assert hanging_of(cord, "framed").known is Hanging.WIRE
    assert hanging_of(cord, "framed").origin is Origin.DERIVED
    assert hanging_of(replace(cord, hanging=Hanging.CLEAT), "framed").known is Hanging.CLEAT
    assert hanging_of(replace(WORK, suspension_length_m=0.3), "framed").known is None
    assert Hanging.CLEAT in hanging_of(replace(WORK, height_m=2.5), "framed").ways
    assert hanging_of(WORK, "vessel").origin is Origin.ASSUMED


def test_a_house_rule_says_it_of_many_and_is_named() -> None:
    """The rule closes the question where the record says nothing, with its origin; the record goes before it."""
    rule = {"class": "framed", "hanging": "two_hooks", "said_by": "Ann", "said_on": date(2031, 5, 1)}
    house = HouseRules((HouseRule.model_validate(rule),), list(assumed().classes))
    scene = classify(WORK, house=house)
    assert scene.hanging is Hanging.TWO_HOOKS
    assert "freedom" not in scene.parameters
    assert scene.parameters["hooks_open"].origin is Origin.STATED
    assert "Ann" in scene.parameters["hooks_open"].note
    assert classify(replace(WORK, hanging=Hanging.WIRE), house=house).hanging is Hanging.WIRE


def test_a_motion_without_a_vertical_says_so() -> None:
    """Of what hangs, and of what slides and tips: weight holds it, and the vertical shaking takes from that."""
    vase = Item("2", "G", object_name="vase", height_m=0.4, width_m=0.15, depth_m=0.15, mass_kg=2.0)
    ran = set()
    for item in (replace(WORK, hanging=Hanging.TWO_HOOKS), vase):
        for up, said in ((0.0, True), (0.3, False)):
            findings = found(item, shaken(up))
            ran |= findings.keys()
            for name in findings.keys() & {"unhooking", "hanger_load", "sliding", "standing"}:
                assert (NO_VERTICAL in findings[name].note) == said
    assert ran >= {"unhooking", "hanger_load", "sliding", "standing"}


def test_what_hangs_swings_along_its_width_and_opens_across_it() -> None:
    """x points east, 90 degrees from north: a width towards north lies along y, and its wall is left along x."""
    for towards, swings, opens in ((0.0, 90.0, 0.0), (90.0, 0.0, 90.0), (180.0, 90.0, 0.0)):
        scene = classify(replace(WORK, hanging=Hanging.WIRE, orientation_deg=towards))
        angles = {work.model.name: set(work.angles.tolist()) for work in plan([scene]).work}
        assert (angles["swing"], angles["unhooking"]) == ({swings}, {opens})


def test_the_tables_know_every_way_and_class() -> None:
    classes = {name for name, row in assumed().classes.items() if row.support is Support.HUNG}
    assert classes < {row.object_class for row in usual_hangings()}
    rows = hanging_rows()
    assert all("judgement" in row.source for row in rows.values())
    # 3/8 inch, the lift of a Z-clip as its maker has it.
    assert rows[Hanging.CLEAT].hook_depth == pytest.approx(3.0 / 8.0 * 0.0254, rel=5e-3)
