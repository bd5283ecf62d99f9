"""Numbers of one record that cannot all be true."""

from __future__ import annotations

import pytest

from pipeline.collection.consistency import HEAVIEST, LIGHTEST, contradictions

CUBE = {"height_m": 0.1, "width_m": 0.1, "depth_m": 0.1}


@pytest.mark.parametrize("mass", [HEAVIEST * 0.999e-3, LIGHTEST * 1.001e-3, 1.0])
def test_what_some_material_can_weigh_is_taken(mass: float) -> None:
    assert contradictions(CUBE | {"mass_kg": mass}) == []


@pytest.mark.parametrize(("mass", "than"), [(22.61, "heavier than osmium"), (0.00009, "lighter than a mobile")])
def test_what_nothing_can_weigh_is_refused(mass: float, than: str) -> None:
    """A litre of osmium weighs 22.6 kg."""
    ((field, problem),) = contradictions(CUBE | {"mass_kg": mass})
    assert field == "mass_kg"
    assert than in problem.message
    assert "0.1 x 0.1 x 0.1 m" in problem.message


def test_without_a_box_there_is_no_density() -> None:
    assert contradictions({"height_m": 0.1, "width_m": 0.1, "mass_kg": 1e5}) == []


def test_a_centre_of_gravity_lies_within() -> None:
    assert contradictions({"height_m": 1.0, "cg_height_m": 1.02}) == []
    ((field, problem),) = contradictions({"height_m": 1.0, "cg_height_m": 1.2})
    assert field == "cg_height_m"
    assert "1.2 m would lie above the object, which is 1 m high" in problem.message


def test_a_base_wider_than_the_object_is_doubted_and_kept() -> None:
    assert contradictions({"width_m": 0.2, "depth_m": 0.4, "base_width_m": 0.4}) == []
    ((field, problem),) = contradictions({"width_m": 0.2, "depth_m": 0.2, "base_width_m": 0.3})
    assert (field, problem.field) == ("", "base_width_m")
    assert "the base is used" in problem.remedy
