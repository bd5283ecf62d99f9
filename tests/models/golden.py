"""The golden cases: their records generated, their parameters mapped to `respond`'s, their tolerances."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.quantities import Array, G
from pipeline.records import Motion

FOLDER = Path(__file__).resolve().parents[1] / "data" / "golden"

CASES: list[dict[str, Any]] = json.loads((FOLDER / "golden_dev.json").read_text(encoding="utf-8"))["cases"]
FORMULAS: list[dict[str, Any]] = json.loads((FOLDER / "formulas.json").read_text(encoding="utf-8"))

HISTORY = {
    "sliding_1d": 1e-9,
    "sliding_2d": 5e-4,
    "rocking": 1e-4,
    "pendulum": 1e-6,
    "spherical_pendulum": 1e-4,
    "sdof": 1e-9,
    "rotational": 1e-9,
    "isolator_1d": 1e-8,
    "isolator_2d": 1e-8,
}
"""Relative error granted at `history`, per model, for a case of condition 1."""

FRICTION = {"max_disp": "displacement", "residual": "residual"}
OUTPUTS = {
    "sliding_1d": {**FRICTION, "path": "path_length"},
    "sliding_2d": {**FRICTION, "path": "path_length"},
    "isolator_1d": {**FRICTION, "max_abs_acc": "acceleration"},
    "isolator_2d": {**FRICTION, "max_abs_acc": "acceleration"},
    "sdof": {"Sd": "displacement", "PSa": "pseudo_acceleration", "Sa_abs": "absolute_acceleration"},
    "pendulum": {"max_disp": "displacement", "max_theta": "rotation"},
    "spherical_pendulum": {"max_disp": "displacement"},
    "rotational": {"max_theta": "rotation", "max_abs_acc": "acceleration"},
    "rocking": {
        "max_ratio": "rotation_ratio",
        "overturned": "overturned",
        "t_overturn": "overturning_time",
        "t_uplift": "uplift_time",
        "n_impacts": "impacts",
    },
}
"""Model of a case -> its expected values -> the columns of `respond`."""


def component(spec: dict[str, Any]) -> Array:
    """Return the samples (n,) m/s2 of one component of a record."""
    kind, dt = spec["gen"], spec["dt"]
    if kind == "const":
        return np.full(spec["n"], float(spec["A"]))
    if kind == "samples":
        return np.array(spec["values"], dtype=float)
    phase = spec.get("phase", 0.0)
    if kind == "sine":
        t = np.arange(round(spec["cycles"] / (spec["f"] * dt)) + 1) * dt
        return np.asarray(spec["A"] * np.sin(2.0 * np.pi * spec["f"] * t + phase))
    t = np.arange(round(spec["T"] / dt) + 1) * dt
    if kind == "sweep":
        bend = (spec["f1"] - spec["f0"]) * t * t / (2.0 * spec["T"])
        return np.asarray(spec["A"] * np.sin(2.0 * np.pi * (spec["f0"] * t + bend) + phase))
    if kind == "multisine":
        tones = [np.sin(2.0 * np.pi * spec["f0"] * 1.37**j * t + 2.1 * j * j + phase) for j in range(spec["K"])]
        return np.asarray(spec["A"] / spec["K"] * np.sin(np.pi * t / spec["T"]) * np.sum(tones, axis=0))
    raise ValueError(f"no generator {kind!r}")


def motion_of(case: dict[str, Any]) -> Motion:
    """Return the motion of a case, its components cut to the shortest."""
    parts = {axis: component(spec) for axis, spec in case["record"].items()}
    n = min(part.size for part in parts.values())
    a = np.zeros((3, n))
    for axis, part in parts.items():
        a["xyz".index(axis)] = part[:n]
    return Motion(next(iter(case["record"].values()))["dt"], a, case["name"])


def asked(case: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the name of the model and the parameters of `respond` for a case."""
    p, kind = case["params"], case["model"]
    tail = {"tail": None if case["tail"] == "rest" else case["tail"]}
    if kind.startswith("sliding"):
        return "sliding", {
            "friction_static": p["mu_s"],
            "friction_kinetic": p["mu_k"],
            "directions": int(kind[8]),
            **tail,
        }
    if kind.startswith("isolator"):
        return "horizontal_isolator", {
            "frequency": p["f"],
            "damping": p["zeta"],
            "friction": p["mu"],
            "directions": int(kind[9]),
            **tail,
        }
    if kind == "sdof":
        return "oscillator", {"frequency": p["f"], "damping": p["zeta"], **tail}
    if kind == "pendulum":
        return "swing", {"length": p["L"], "damping": p["zeta"], **tail}
    if kind == "spherical_pendulum":
        return "swing_3d", {"length": p["L"], "damping": p["zeta"], **tail}
    if kind == "rotational":
        # k - m g h below zero has no frequency: the square root's sign is kept, so that the model sees a bad number.
        stiffness = p["k"] - p["m"] * G * p["h"]
        w = math.copysign(math.sqrt(abs(stiffness) / p["I"]), stiffness)
        return "rotational_isolator", {
            "frequency": w / (2.0 * math.pi),
            "damping": p["c"] / p["I"] / (2.0 * abs(w)),
            "cg_height": p["h"],
            "inertia_ratio": p["I"] / (p["m"] * p["h"] ** 2),
            **tail,
        }
    h = p["h"]
    b1 = p.get("b1", p.get("b"))
    rho2 = p.get("rho2")
    return "rocking", {
        "half_width": h * math.tan(p["alpha"]) if b1 is None else b1,
        "cg_height": h,
        "half_width_other": p.get("b2"),
        "gyration_radius": None if rho2 is None else math.sqrt(rho2),
        "restitution": p.get("e"),
        "initial_rotation": p.get("th0", 0.0),
        **tail,
    }


def expected(case: dict[str, Any]) -> dict[str, Any]:
    """Return the expected values of a case, gravity held at max(0, g + a_z)."""
    values: dict[str, Any] = case.get("expected_clamped", case["expected"])
    return values


def formula(name: str, **inputs: float) -> float:
    """Return the worked value of a closed form for the inputs given (all of them, or those that tell it apart)."""
    for row in FORMULAS:
        if row["name"] == name and all(math.isclose(row["inputs"][k], v) for k, v in inputs.items()):
            return float(row["value"])
    raise KeyError(name)
