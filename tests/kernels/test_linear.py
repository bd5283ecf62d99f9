"""The closed forms of the damped oscillator against 50 digits, and the search for rest against a scan."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from pipeline.kernels.linear import advance, peak_inside, transition
from pipeline.kernels.quiet import BLOCK, block_maxima, largest, next_above
from pipeline.models.common import Quiet
from pipeline.quantities import G
from pipeline.records import Excitation


def exact(w: float, zeta: float, t: float) -> tuple[mpmath.mpf, ...]:
    """Return the responses to unit displacement, velocity, step and ramp by a matrix exponential of 50 digits."""
    with mpmath.workdps(50):
        w_, z_, t_ = mpmath.mpf(w), mpmath.mpf(zeta), mpmath.mpf(t)
        # (u, v, step, ramp): the force is step + ramp, ramp' = 0, step' = ramp.
        system = mpmath.matrix([[0, 1, 0, 0], [-w_ * w_, -2 * z_ * w_, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
        out = mpmath.expm(system * t_, method="taylor")
        return out[0, 0], out[0, 1], out[0, 2], out[0, 3]


@pytest.mark.parametrize("zeta", [0.0, 1e-9, 0.02, 0.5, 0.999999999, 1.0, 1.000000001, 2.0, 10.0])
@pytest.mark.parametrize("x", [1e-8, 1e-3, 0.2, 0.24999, 0.25001, 0.49, 0.51, 1.0, 6.0])
def test_transition_to_its_last_digits(zeta: float, x: float) -> None:
    """1e-12 of each response's own scale (1, t, t^2/2, t^3/6), for any step and for damping up to 2.

    Far above that the ramp's response is a difference of terms 2 zeta / x times as large: 1e-11 at damping 10.
    """
    w, t = 7.0, x / 7.0
    got, want = transition(w, zeta, t), exact(w, zeta, t)
    for value, truth, scale in zip(got, want, (1.0, t, t * t / 2.0, t**3 / 6.0), strict=True):
        assert value == pytest.approx(float(truth), rel=0.0, abs=(1e-12 if zeta <= 2.0 else 1e-11) * scale)


def test_a_free_mass_has_no_frequency() -> None:
    """w = 0: u = u0 + v0 t + f0 t^2/2 + f1 t^3/6."""
    u, v = advance(1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.5)
    assert u == pytest.approx(1.0 + 1.0 + 3.0 / 8.0 + 4.0 / 48.0, rel=1e-15)
    assert v == pytest.approx(2.0 + 1.5 + 0.5, rel=1e-15)


def test_steps_compose() -> None:
    """Two half steps are one: a group property of the exact solution."""
    for w, zeta in ((3.0, 0.05), (3.0, 1.0), (40.0, 2.0)):
        whole = advance(0.1, -0.3, 1.0, 5.0, w, zeta, 0.2)
        middle = advance(0.1, -0.3, 1.0, 5.0, w, zeta, 0.1)
        twice = advance(middle[0], middle[1], 1.5, 5.0, w, zeta, 0.1)
        assert twice == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("seed", range(30))
def test_peaks_inside_a_step_against_ten_thousand_points(seed: int) -> None:
    """The largest |u| strictly inside is found wherever it exceeds both ends; 1e-7 for the points' spacing."""
    rng = np.random.default_rng(seed)
    w, zeta, span = 5.0, float(rng.choice([0.0, 0.1, 1.0, 2.0])), 0.06
    u, v, f0, f1 = rng.normal(size=4) * np.array([1e-3, 0.1, 3.0, 100.0])
    points = np.array([advance(u, v, f0, f1, w, zeta, t)[0] for t in np.linspace(0.0, span, 10001)])
    top = np.abs(points).max()
    ends = max(abs(points[0]), abs(points[-1]))
    found = peak_inside(u, v, f0, f1, w, zeta, span, 0.0, 0.0, 1.0, 0.0)
    assert max(found, ends) == pytest.approx(top, rel=1e-7)


def test_peak_inside_a_step_that_begins_at_rest() -> None:
    """v = 0 at the beginning is a root of the slope that must not hide the other one."""
    span = 0.06
    f0, f1 = 1.0, -2.5 / span
    points = np.array([advance(0.0, 0.0, f0, f1, 0.1, 0.0, t)[0] for t in np.linspace(0.0, span, 10001)])
    found = peak_inside(0.0, 0.0, f0, f1, 0.1, 0.0, span, 0.0, 0.0, 1.0, 0.0)
    assert max(found, abs(points[-1])) == pytest.approx(np.abs(points).max(), rel=1e-7)


@pytest.mark.parametrize("zeta", [0.0, 0.3, 1.0, 2.0])
@pytest.mark.parametrize("turns", [(0.02, 0.03), (0.1, 0.4), (0.3, 0.7), (0.6, 0.9), (0.8, 0.95)])
def test_two_turns_inside_a_step(turns: tuple[float, float], zeta: float) -> None:
    """u' of a slow oscillator vanishes near both shares of a step, in one half of it or not: the larger |u| of both.

    Ten thousand points, and the curvature between them: 1e-7.
    """
    span, w = 0.06, 0.05
    first, second = turns[0] * span, turns[1] * span
    u, v, f0, f1 = 0.0, first * second, -first - second + 2.0 * zeta * w * first * second, 2.0
    points = np.array([advance(u, v, f0, f1, w, zeta, t)[0] for t in np.linspace(0.0, span, 10001)])
    rates = np.diff(points)
    stationary = np.abs(points[1:-1][rates[:-1] * rates[1:] < 0.0])
    assert stationary.size == 2
    found = peak_inside(u, v, f0, f1, w, zeta, span, 0.0, 0.0, 1.0, 0.0)
    assert found == pytest.approx(stationary.max(), rel=1e-7)


@pytest.mark.parametrize("n", [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 5 * BLOCK + 3])
def test_rest_is_skipped_exactly(n: int) -> None:
    """The blocks' maxima find the same sample as a scan, from any start and for any limit; so does the largest |x|.

    Along one direction the friction that would hold an object is that in two with nothing across it.
    """
    rng = np.random.default_rng(n)
    x, y, z = rng.normal(size=(3, n))
    z *= 8.0
    ratio = Quiet(Excitation(0.01, x, y, z, None)).ratio
    with np.errstate(divide="ignore"):
        want = np.where(G + z > 0.0, np.hypot(x, y) / np.maximum(0.0, G + z), np.inf)
    np.testing.assert_allclose(ratio, want, rtol=1e-14)
    along = Quiet(Excitation(0.01, x, None, z, None))
    alone = Quiet(Excitation(0.01, x, np.zeros(n), z, None))
    np.testing.assert_allclose(along.ratio, alone.ratio, rtol=1e-15)
    maxima, pushes = block_maxima(ratio), block_maxima(np.abs(x))
    np.testing.assert_array_equal(along.pushes, pushes)
    for start in range(0, n, 7):
        for limit in (0.0, 0.1, 0.3, np.inf):
            above = np.flatnonzero(ratio[start:] > limit)
            assert next_above(ratio, maxima, start, limit) == (start + above[0] if above.size else n)
        for end in range(start, n + 1, 11):
            assert largest(x, pushes, start, end) == np.abs(x[start:end]).max(initial=0.0)
