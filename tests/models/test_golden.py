"""Every golden case at both fidelities.  The values are two independent integrations that agree to 1e-9 or better."""

from __future__ import annotations

from typing import Any

import golden
import numpy as np
import pytest

from pipeline import respond

UNSTABLE = "ri_K_negative"
RUN = [case for case in golden.CASES if case["name"] != UNSTABLE]


def close(case: dict[str, Any], key: str, got: float, want: float, rtol: float) -> None:
    # A residual can be nothing but rounding (4e-18 m after half a metre): it is held against the largest displacement.
    scale = abs(want)
    if key == "residual":
        scale = max(scale, 1e-3 * abs(golden.expected(case)["max_disp"]))
    assert got == pytest.approx(want, rel=0.0, abs=rtol * scale), f"{case['name']} {key}"


def check(case: dict[str, Any], fidelity: str) -> None:
    model, parameters = golden.asked(case)
    row = respond(model, golden.motion_of(case), fidelity=fidelity, **parameters).iloc[0]
    for key, column in golden.OUTPUTS[case["model"]].items():
        want = golden.expected(case).get(key)
        got = row[column]
        if key == "overturned":
            assert bool(got) is want
        elif key in ("t_overturn", "t_uplift") and want is None:
            assert np.isnan(got)
        elif key == "n_impacts":
            if not case["n_impacts_sensitive"] and not case["sensitive"]:
                assert got == want
        elif want is not None and not case["sensitive"]:
            if fidelity == "reference":
                rtol = max(1e-6, 10.0 * case["trusted_rtol"].get(key, 0.0))
            else:
                # An input error of one part in 1e16 grows by the condition; so does an integration error.
                rtol = golden.HISTORY[case["model"]] * max(1.0, case["condition"])
            close(case, key, float(got), want, rtol)
    if case["sensitive"] and case["model"].startswith("sliding"):
        assert (row["displacement"] > 0.0) == (golden.expected(case)["max_disp"] > 0.0)
    assert ("contact lost" in row["note"]) == bool(case.get("contact_lost"))


@pytest.mark.parametrize("case", RUN, ids=lambda case: str(case["name"]))
def test_reference_meets_two_independent_integrations(case: dict[str, Any]) -> None:
    """1e-6 relative, or ten times what the two methods themselves differ by."""
    check(case, "reference")


@pytest.mark.parametrize("case", RUN, ids=lambda case: str(case["name"]))
def test_history_meets_two_independent_integrations(case: dict[str, Any]) -> None:
    """The accuracy that each model's method promises, times the case's condition; every outcome right."""
    check(case, "history")


def test_gravity_that_overcomes_the_pad_has_no_frequency() -> None:
    """k < m g h grows without bound (exponentially); the model refuses a frequency that is not above 0."""
    case = next(case for case in golden.CASES if case["name"] == UNSTABLE)
    model, parameters = golden.asked(case)
    assert parameters["frequency"] < 0.0
    with pytest.raises(ValueError, match="frequency must be a finite number above 0 Hz"):
        respond(model, golden.motion_of(case), **parameters)
    with pytest.raises(ValueError, match="frequency must be a finite number above 0 Hz"):
        respond(model, golden.motion_of(case), **{**parameters, "frequency": 0.0})


def test_no_case_is_left_out() -> None:
    assert len(golden.CASES) == 79
    assert {case["model"] for case in golden.CASES} == set(golden.OUTPUTS)
