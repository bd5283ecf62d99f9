"""The figures of what is advised, beside integrations of another kind: scipy's DOP853, implicit steps, and statics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from pipeline.motions import read_motion
from pipeline.quantities import G
from pipeline.records import Furniture, Item, Motion, Support
from pipeline.resources import resource
from tests.soak import soaked

from .scenes import BLOCK, HEAVY, STUMP, TOWER, solve

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def motions() -> Sequence[Motion]:
    """Two earthquakes that travel with Kouros: Ridgecrest at 0.7 g, and one of the suite as it is."""
    both = read_motion(resource("site_motions", "demo"))[0], read_motion(resource("site_motions", "demo_suite"))[1]
    return [strong_part(one) for one in both]


def strong_part(motion: Motion) -> Motion:
    """Twelve seconds about its peak: what follows would be integrated to no end."""
    peak = int(np.argmax(np.hypot(*motion.acceleration[:2])))
    first, last = (max(0, peak + round(seconds / motion.dt)) for seconds in (-4.0, 8.0))
    return motion.changed(motion.acceleration[:, first:last], "its strong part")


def pushes(motion: Motion) -> tuple[Array, Array, Array, Array]:
    x, y, z = motion.acceleration
    return motion.dt * np.arange(len(x)), x, y, G + z


def integrated(
    rates: Callable[[float, Array], Array], end: float, start: Sequence[float], step: float, **more: object
) -> Array:
    """Return the states at even times."""
    found = solve_ivp(
        rates, (0.0, end), start, method="DOP853", max_step=step, rtol=1e-8, atol=1e-10, dense_output=False, **more
    )
    assert found.success
    states: Array = found.y
    return states


def shaken(motion: Motion, hertz: float, damping: float) -> float:
    """Peak resultant of the absolute acceleration of an oscillator [m/s2]."""
    t, x, y, _ = pushes(motion)
    w = 2.0 * pi * hertz
    felt = []
    for push in (x, y):
        states = integrated(
            lambda at, s, push=push: np.array(
                [s[1], -np.interp(at, t, push) - 2.0 * damping * w * s[1] - w * w * s[0]]
            ),
            float(t[-1]),
            [0.0, 0.0],
            motion.dt,
            t_eval=t,
        )
        felt.append(-2.0 * damping * w * states[1] - w * w * states[0])
    return float(np.hypot(*felt).max())


def slid(motion: Motion, friction: float) -> float:
    """How far a block slides on the plane [m]: implicit steps, fifty to one of the record."""
    t, x, y, n = pushes(motion)
    fine = np.arange(0.0, float(t[-1]), motion.dt / 50.0)
    xs, ys, ns = (np.interp(fine, t, one) for one in (x, y, n))
    h, v, u, far = motion.dt / 50.0, np.zeros(2), np.zeros(2), 0.0
    for a, b, normal in zip(xs, ys, friction * np.maximum(ns, 0.0), strict=True):
        v = v - h * np.array([a, b])
        speed = float(np.hypot(*v))
        # Friction takes what speed it can within the step: an implicit step, which never turns the block back.
        v = v * max(0.0, 1.0 - h * normal / speed) if speed > 0.0 else v
        u = u + h * v
        far = max(far, float(np.hypot(*u)))
    return far


def swung(motion: Motion, length: float) -> float:
    """How far a spherical pendulum gets from the plumb line of its hook [m]: Cartesian, with its string."""
    t, x, y, n = pushes(motion)

    def rates(at: float, s: Array) -> Array:
        r, v = s[:3], s[3:]
        push = np.array([-np.interp(at, t, x), -np.interp(at, t, y), -np.interp(at, t, n)])
        # The string takes what would lengthen it: r . r'' + v . v = 0.
        return np.concatenate([v, push - r * (r @ push + v @ v) / length**2])

    states = integrated(rates, float(t[-1]), [0.0, 0.0, -length, 0.0, 0.0, 0.0], 2.0 * motion.dt, t_eval=t)
    return float(np.hypot(states[0], states[1]).max())


def tipping(motion: Motion, item: Item) -> float:
    _, x, y, n = pushes(motion)
    cg, half = item.cg_height_m or 0.0, 0.5 * (item.base_width_m or 0.0)
    return (item.mass_kg or 0.0) * float((np.hypot(x, y) * cg - n * half).max())


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("item", [TOWER, STUMP, HEAVY, replace(TOWER, mass_kg=2.0)], ids=["20", "200", "500", "2"])
def test_forces_on_fixings_are_those_of_statics(motions: Sequence[Motion], which: int, item: Item) -> None:
    """m A, and m (|a| h - N b) of pieces, or m A h of what is built without the help of the weight."""
    motion = motions[which].scaled(1.3 if which == 0 else 2.5, "more")
    advice = solve(item, motion)
    push = float(np.hypot(*motion.acceleration[:2]).max())
    mass, height = item.mass_kg or 0.0, item.cg_height_m or 0.0
    assert advice.parameters["force"] == pytest.approx(mass * push, rel=1e-9)
    moment = tipping(motion, item) if "pieces" in advice.parameters else mass * push * height
    assert advice.parameters["moment"] == pytest.approx(moment, rel=1e-9)


@pytest.mark.long("analysis/test_furniture::test_a_case_of_6_hz_takes_sliding_from_3_to_11_cm")
def test_a_showcase_multiplies_the_force_as_an_oscillator_does(motions: Sequence[Motion]) -> None:
    """6 Hz and 5 %, the best estimates of furniture.csv: no resonance at the worst of 3 to 12 Hz and 3 %."""
    motion = motions[0]
    advice = solve(replace(TOWER, mass_kg=2.0, furniture=Furniture.SHOWCASE, surface_material="wood"), motion)
    assert "pieces" in advice.parameters
    assert advice.parameters["force"] / 2.0 == pytest.approx(shaken(motion, 6.0, 0.05), rel=0.02)


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize(
    "friction",
    [0.12, pytest.param(0.2, marks=pytest.mark.long("test_room_is_what_an_implicit_integration_slides"))],
)
def test_room_is_what_an_implicit_integration_slides(motions: Sequence[Motion], which: int, friction: float) -> None:
    motion = motions[which].scaled(1.0 if which == 0 else 0.7, "so that a display has the room")
    far = slid(motion, friction)
    advice = solve(replace(BLOCK, friction=friction, clearance_m=0.2 * far), motion)
    assert advice.measure == "clearance"
    assert advice.parameters["movement"] == pytest.approx(far, rel=0.01, abs=1e-4)
    assert far <= advice.parameters["clearance"] <= 1.1 * far + 0.011


@pytest.mark.long("test_room_is_what_an_implicit_integration_slides")
@pytest.mark.parametrize(("which", "length"), [pytest.param(0, 0.6, marks=soaked), (1, 2.0)])
def test_what_hangs_from_above_swings_as_a_string(motions: Sequence[Motion], which: int, length: float) -> None:
    """A chandelier of 120 kg may swing in a hall: the largest distance of its middle, and a tenth more."""
    lamp = Item("L", "G", title="Chandelier", object_name="chandelier", medium="brass", support=Support.SUSPENDED,
                height_m=0.5, width_m=0.5, depth_m=0.5, suspension_length_m=length, mass_kg=120.0, damping=0.0,
                clearance_m=0.01)  # fmt: skip
    motion = motions[which].scaled(0.5, "half")
    far = swung(motion, length)
    advice = solve(lamp, motion)
    assert advice.measure == "clearance"
    assert advice.parameters["movement"] == pytest.approx(far, rel=0.01)
    assert far <= advice.parameters["clearance"] <= 1.1 * far + 0.011
