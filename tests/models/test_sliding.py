"""Sliding against closed forms: Newmark's rectangular pulse, the frictionless body, the half sine."""

from __future__ import annotations

import numpy as np
import pytest
from golden import formula
from scipy.integrate import quad
from scipy.optimize import brentq
from shaking import along_x, base_displacement, random_motion

from pipeline import Motion, respond, trace
from pipeline.quantities import G


@pytest.mark.parametrize("samples", [2, 41])
@pytest.mark.parametrize(
    ("mu", "peak", "duration"),
    [(0.2, 0.5, 0.2), (0.1, 0.4, 0.2), (0.25, 0.5, 0.1), (0.01, 1.0, 0.05), (0.5, 0.51, 1.0), (1e-6, 0.3, 0.3)],
)
@pytest.mark.parametrize("directions", [1, 2])
def test_rectangular_pulse_newmark_1965(mu: float, peak: float, duration: float, samples: int, directions: int) -> None:
    """d = V^2 / (2 mu g) (1 - mu g / A), V = A T: exact for a rectangular pulse, however it is sampled.

    One direction has a closed form (only rounding is granted); two directions stop in closed form too, after steps
    that are right to 1e-5 of the distance.
    """
    a = peak * G
    motion = along_x(np.full(samples, -a), duration / (samples - 1))
    coast = a * duration / (mu * G)
    row = respond("sliding", motion, friction_static=mu, directions=directions, tail=1.1 * coast).iloc[0]
    want = (a * duration) ** 2 / (2.0 * mu * G) * (1.0 - mu * G / a)
    rel = 1e-11 if directions == 1 else 1e-5
    assert row["displacement"] == pytest.approx(want, rel=rel)
    assert row["residual"] == pytest.approx(want, rel=rel)
    assert row["path_length"] == pytest.approx(want, rel=rel)


def test_rectangular_pulse_worked_value() -> None:
    """Newmark 1965, worked: mu 0.2, 0.5 g, 0.2 s slides 0.14709975 m."""
    row = respond("sliding", along_x([-0.5 * G] * 2, 0.2), friction_static=0.2, directions=1).iloc[0]
    assert row["displacement"] == pytest.approx(formula("newmark_rectangular_pulse", mu=0.2), rel=1e-12)


@pytest.mark.parametrize("directions", [1, 2])
def test_without_friction_it_stays_in_space(directions: int) -> None:
    """mu = 0: u is minus the base's displacement, to the rounding of a sum of 600 steps."""
    motion = random_motion(11)
    _, x = base_displacement(motion.acceleration[0], motion.dt)
    _, y = base_displacement(motion.acceleration[1], motion.dt)
    history = trace("sliding", motion, friction_static=0.0, directions=directions)
    scale = float(np.abs([x, y]).max())
    np.testing.assert_allclose(history["u_x"], -x, rtol=0.0, atol=1e-9 * scale)
    if directions == 2:
        np.testing.assert_allclose(history["u_y"], -y, rtol=0.0, atol=1e-9 * scale)
    # Nothing holds it: it feels nothing (the jump at the very first sample is tested with the supports).
    np.testing.assert_allclose(history["a_x"][1:], 0.0, atol=1e-12)
    row = respond("sliding", motion, friction_static=0.0, directions=directions, tail=0.0).iloc[0]
    end = np.hypot(x[-1], y[-1] if directions == 2 else 0.0)
    assert row["residual"] == pytest.approx(end, rel=1e-8)


def test_half_sine_by_its_own_phases() -> None:
    """Under one half sine the body starts at sin(w t1) = mu g / A and stops where its velocity, known in closed form,
    vanishes.  The tolerance is the polygon's: its area is (w dt)^2 / 12 below the sine's."""
    peak, w, mu, dt = 4.0, 2.0 * np.pi, 0.1, 1e-4
    n = round(0.5 / dt) + 1
    motion = along_x(-peak * np.sin(w * np.arange(n) * dt), dt)
    begin = np.arcsin(mu * G / peak) / w

    def velocity(t: float) -> float:
        shaking = min(t, 0.5)
        return peak / w * (np.cos(w * begin) - np.cos(w * shaking)) - mu * G * (t - begin)

    stop = brentq(velocity, 0.3, 5.0, xtol=1e-14)
    want = quad(velocity, begin, 0.5, epsabs=1e-14)[0] + quad(velocity, 0.5, stop, epsabs=1e-14)[0]
    row = respond("sliding", motion, friction_static=mu, directions=1).iloc[0]
    assert row["displacement"] == pytest.approx(want, rel=1e-7)


def test_at_exactly_the_limit_it_stays_and_just_above_it_moves() -> None:
    """|a| <= mu N holds; one part in 1e9 above, it slides by V^2/(2 mu g)(1 - mu g / A)."""
    mu = 0.25
    held = respond("sliding", along_x([mu * G] * 2, 0.5), friction_static=mu, directions=[1]).iloc[0]
    assert held["displacement"] == 0.0
    above = mu * G * (1.0 + 1e-9)
    moved = respond("sliding", along_x([above] * 2, 0.5), friction_static=mu, directions=1).iloc[0]
    assert moved["displacement"] == pytest.approx((above * 0.5) ** 2 / (2.0 * mu * G) * 1e-9, rel=1e-5)


def test_weight_lost_for_exactly_an_interval() -> None:
    """While a_z = -g there is no friction: u follows minus the base; then it slides on a plane of full weight.

    x is a constant push A for T with a_z = -g, nothing after: V = A T is reached without friction, and
    d = A T^2 / 2 + V^2 / (2 mu g), less the ramp interval of 1e-5 s (one part in 1e4 of T).
    """
    push, mu, dt, n = 1.0, 0.5, 1e-5, 10001
    z = np.zeros(2 * n)
    z[:n] = -G
    x = np.zeros(2 * n)
    x[:n] = -push
    duration = (n - 1) * dt
    motion = Motion(dt, np.vstack([x, np.zeros_like(x), z]))
    want = 0.5 * push * duration**2 + (push * duration) ** 2 / (2.0 * mu * G)
    for directions in (1, 2):
        row = respond("sliding", motion, friction_static=mu, directions=directions).iloc[0]
        assert row["displacement"] == pytest.approx(want, rel=5e-4)


def test_push_that_ends_as_contact_is_lost_still_moves_it() -> None:
    """The push is zero at the very sample at which the weight is: between the samples it is not, and it slides.

    a = -(1 - t/dt), N = g - (g + dz) t/dt: the weight reaches zero before the push does.  The certificate of rest must
    not call that rest, and the uplift ratio |a| / (N b/h) is unbounded.
    """
    a = np.zeros((3, 4))
    a[0, 0], a[2, 1] = -1.0, -20.0
    motion = Motion(0.01, a)
    slid = respond("sliding", motion, friction_static=0.5).iloc[0]
    assert slid["displacement"] > 0.0
    rocked = respond("rocking", motion, half_width=0.5, cg_height=1.0).iloc[0]
    assert rocked["uplift_time"] == pytest.approx(0.01 * (G / 20.0 - 0.06), abs=0.002)
    assert rocked["uplift_ratio"] > 1.0


def test_certificate_of_rest_never_hides_a_slide() -> None:
    """What the certificate calls 0 must be 0 by integration, contact lost or not."""
    from pipeline.models.sliding import SLIDING
    from pipeline.records import Excitation

    a = np.zeros((3, 4))
    a[0, 0], a[2, 1] = -1.0, -20.0
    motion = Motion(0.01, a)
    assert SLIDING.certificate is not None
    bound = SLIDING.certificate(Excitation(0.01, a[0], a[1], a[2], None), {"friction_static": np.array([0.5])})
    assert bound[0] >= respond("sliding", motion, friction_static=0.5)["displacement"][0]
