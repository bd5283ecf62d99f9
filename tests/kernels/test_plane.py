"""The steps and the stop of a body slipping in two directions, against a general integrator at tight tolerances."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pipeline.kernels.plane_step import plane_step
from pipeline.kernels.plane_stop import come_to_rest
from pipeline.quantities import Array

PUSH, RATE, GRIP, RATE_OF_GRIP = np.array([0.9, -0.4]), np.array([2.0, 5.0]), 1.5, -1.0
SPEED = np.array([-0.3, 0.5])


def slipped(b: float, c: float, h: float) -> Array:
    """Return ux, uy, vx, vy, path after h, by an explicit method of order 8 at 1e-13."""

    def rates(t: float, y: Array) -> Array:
        v = y[2:4]
        size = np.hypot(*v)
        push = -(PUSH + RATE * t) - b * y[:2] - c * v - (GRIP + RATE_OF_GRIP * t) * v / size
        return np.array([*v, *push, size])

    start = np.array([0.02, 0.01, *SPEED, 0.0])
    return np.asarray(solve_ivp(rates, (0.0, h), start, method="DOP853", rtol=1e-13, atol=1e-16).y[:, -1])


@pytest.mark.parametrize(("b", "c"), [(0.0, 0.0), (40.0, 1.5)])
def test_a_step_is_of_order_4(b: float, c: float) -> None:
    """Half the step leaves 1/32 of the error of one step, for displacement, velocity and path; a third is granted."""
    size = float(np.hypot(*SPEED))
    errors = []
    for h in (0.04, 0.02):
        ux, uy, vx, vy, ex, ey, speed, path, error, least = plane_step(
            0.02, 0.01, *SPEED, *(SPEED / size), size, *PUSH, *RATE, GRIP, RATE_OF_GRIP, b, c, h
        )
        missed = np.abs(np.array([ux, uy, vx, vy, path]) - slipped(b, c, h))
        # The estimate is that of order 3, the error of order 4: twice it is granted, as it may be small by chance.
        assert missed[2:4].max() < 2.0 * error
        assert least > 0.0
        assert (ex * speed, ey * speed) == pytest.approx((vx, vy), rel=1e-12)
        errors.append(missed.max())
    assert errors[0] < 1e-5
    assert errors[1] < errors[0] / 32.0 * 3.0


@pytest.mark.parametrize("degrees", [3.0, 40.0, 100.0, 170.0])
@pytest.mark.parametrize("push", [0.0, 0.4, 0.9])
def test_a_block_on_an_incline_comes_to_rest_where_an_integrator_says(degrees: float, push: float) -> None:
    """Constant push and grip: closed forms, against an integration up to 1e-7 of the speed (1e-14 of the way left)."""
    grip, speed = 1.0, 0.3
    vx, vy = speed * math.cos(math.radians(degrees)), speed * math.sin(math.radians(degrees))

    def rates(_t: float, y: Array) -> list[float]:
        size = math.hypot(y[2], y[3])
        return [y[2], y[3], push - grip * y[2] / size, -grip * y[3] / size, size]

    def slow(_t: float, y: Array) -> float:
        return math.hypot(y[2], y[3]) - 1e-7 * speed

    slow.terminal = True  # type: ignore[attr-defined]
    truth = solve_ivp(rates, (0.0, 9.0), [0.0, 0.0, vx, vy, 0.0], method="DOP853", rtol=1e-12, atol=1e-15, events=slow)
    load = np.array([-push, 0.0, 0.0, 0.0, grip, 0.0, grip, 0.0])
    wait, dx, dy, path, off = come_to_rest(
        speed, vx, vy, vx / speed, vy / speed, push, 0.0, 0.0, 0.0, load, 0.0, 9.0, 0.1, 0.0, False
    )
    # The body is stopped 1e-7 of its speed early: that much of the time, over what friction has left of it.
    assert wait == pytest.approx(truth.t[-1], rel=1e-5)
    # Push and grip do not change: the way is exact, and says so.
    assert off < 1e-9 * path
    assert (dx, dy, path) == pytest.approx(tuple(truth.y[[0, 1, 4], -1]), rel=1e-9, abs=1e-10)


def test_a_push_beyond_the_grip_brings_nothing_to_rest() -> None:
    """Across a push stronger than the grip a body turns, and never stops."""
    load = np.array([-2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0])
    assert come_to_rest(0.3, 0.0, 0.3, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, load, 0.0, 9.0, 0.1, 0.0, False)[0] < 0.0
