"""Objects that share a plinth or a case: one isolator, verified for each of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pipeline.analysis.response import respond
from pipeline.analysis.transmission import transmit
from pipeline.mitigate.proposals import listed
from pipeline.quantities import G
from pipeline.records import Furniture, Motion
from pipeline.report.units import Units

from .scenes import BLOCK, TOWER, demo_motion, solve_all

A = replace(TOWER, object_number="A", case="X", allowable_stress_pa=2e5)
B = replace(A, object_number="B", mass_kg=10.0, allowable_stress_pa=1.1e5)
C = replace(BLOCK, object_number="C", case="X", clearance_m=0.3)
"""It passes as it stands."""
D = replace(BLOCK, object_number="D", case="X")
"""Alone it needs 5 cm of room."""


@pytest.fixture(scope="module")
def motion() -> Motion:
    return demo_motion()


def said(item_advice: object) -> str:
    advice = item_advice
    values = {k: (v, advice.units[k]) for k, v in advice.parameters.items()}  # type: ignore[attr-defined]
    return Units().fill(advice.sentence, values, "test")  # type: ignore[attr-defined]


def test_all_of_a_case_share_one_isolator(motion: Motion) -> None:
    """The object that alone would need room is spared too; what passes is named, and told nothing."""
    a, b, c, d = solve_all([A, B, C, D], [motion])
    assert c == []
    ((of_a,), (of_b,), (of_d,)) = a, b, d
    assert {of_a.measure, of_b.measure, of_d.measure} == {"horizontal_isolator"}
    assert of_a.parameters == of_b.parameters == of_d.parameters
    assert said(of_a).startswith("Put case X, with B, C and D in it, on a horizontal isolator (a generic one")
    assert said(of_d).startswith("Put case X, with A, B and C in it, on a horizontal isolator (a generic one")


def test_the_shared_isolator_is_right_for_each(motion: Motion) -> None:
    """Each object's own model, on what the isolator passes on, standing free on it or fastened as it is told."""
    a, b, _, d = solve_all([A, B, C, D], [motion])
    at = a[0].parameters
    given = {"frequency": at["frequency"], "damping": at["damping"], "friction": at["friction"]}
    carried = transmit("horizontal_isolator", motion, refine=4, **given)  # type: ignore[arg-type]
    assert float(respond("horizontal_isolator", motion, **given)["displacement"].iloc[0]) < at["stroke"]  # type: ignore[arg-type]
    x, y, z = carried.acceleration
    push, lift = float(np.hypot(x, y).max()), float((np.hypot(x, y) / (G + z)).max())
    for advice, mass, allowed in ((a[0], 20.0, 2e5), (b[0], 10.0, 1.1e5)):
        held = mass * push * 0.5 / (0.1**3 / 6.0) - mass * G / 0.01 <= allowed
        free = lift <= 0.2
        assert held if advice.sentence.endswith("fastened to it.") else free
    # The block never rocks; it has 2 cm to slide in.
    slides = float(respond("sliding", carried, friction_static=0.1)["displacement"].iloc[0])
    assert d[0].sentence.endswith("It may stand free on it." if slides <= 0.02 else "It must be fastened to it.")
    assert 20.0 * push * 0.1 / (0.3**3 / 6.0) - 20.0 * G / 0.09 <= 5e6


def test_one_whose_frequency_is_known_shares_the_isolator_of_its_case(motion: Motion) -> None:
    """It meets its own frequency among those of the case, and its neighbour is carried all the same: 20 and 10 kg."""
    there = {"furniture": Furniture.PEDESTAL}
    a, b = solve_all([replace(A, frequency_hz=40.0, **there), replace(B, frequency_hz=None, **there)], [motion])
    assert [one.measure for one in (a[0], b[0])] == ["horizontal_isolator"] * 2
    assert a[0].parameters == b[0].parameters
    assert a[0].parameters["load"] == 30.0
    assert "with B in it" in said(a[0])


def test_one_object_that_no_isolator_saves_refuses_it_for_all(motion: Motion) -> None:
    hopeless = replace(A, object_number="H", allowable_stress_pa=1e2, base_width_m=0.02, base_depth_m=0.02)
    a, h = solve_all([A, hopeless], [motion])
    assert a[0].measure != "horizontal_isolator"
    assert h[0].measure == "remove"
    for advice in (a[0], h[0]):
        assert any(text.endswith("within its stroke for all 2 objects of its case") for text in advice.rejected)
    elsewhere = solve_all([A, replace(hopeless, case="Y")], [motion])
    assert elsewhere[0][0].measure == "horizontal_isolator"
    other_room = solve_all([A, replace(hopeless, gallery="H")], [motion])
    assert other_room[0][0].measure == "horizontal_isolator"


def test_what_cannot_be_assessed_is_named(motion: Motion) -> None:
    unknown = replace(
        A, object_number="U", height_m=None, cg_height_m=None, width_m=None, depth_m=None, base_width_m=None,
        base_depth_m=None,
    )  # fmt: skip
    a, u = solve_all([A, unknown], [motion])
    assert u == []
    assert said(a[0]).startswith("Put case X (not checked: U) on a horizontal isolator")


def test_wax_stays_with_each_object(motion: Motion) -> None:
    weak = motion.scaled(0.6, "weak")
    light = replace(TOWER, object_number="L", case="X", mass_kg=2.0)
    first, second = solve_all([light, replace(light, object_number="M", mass_kg=1.0)], [weak])
    assert first[0].measure == second[0].measure == "wax"
    areas = [one[0].parameters["pieces"] * one[0].parameters["size"] ** 2 for one in (first, second)]
    assert areas[0] > areas[1]


def test_hostile_names_of_cases_are_words(motion: Motion) -> None:
    """Braces in a case's name or an object's number are no placeholders, of the sentence or of its words."""
    case = "{stroke} {how} <b> {{x}} {0.__class__}"
    a, b = solve_all([replace(A, case=case), replace(B, case=case, object_number="{demand} }{")], [motion])
    assert case in said(a[0])
    assert said(a[0]).count("It must be fastened to it.") + said(a[0]).count("It may stand free on it.") == 1
    assert "{demand} }{" in said(a[0])
    assert case in said(b[0])


def test_a_long_list_is_cut() -> None:
    assert listed(["1"]) == "1"
    assert listed(["1", "2"]) == "1 and 2"
    assert listed([str(i) for i in range(20)]).endswith("10, 11 and 8 more")
