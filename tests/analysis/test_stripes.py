"""Fragility curves through stripes of joint samples: published fits, closed forms, and what may not change a digit."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.stats import norm

from pipeline.analysis.fragility.counts import FLATTEST, fit_counts
from pipeline.analysis.fragility.curve import stated
from pipeline.analysis.fragility.hazard import Hazard
from pipeline.analysis.fragility.objects import Stripe, with_rate
from pipeline.analysis.likelihood.analyses import Stood
from pipeline.analysis.likelihood.draws import FARTHEST, scatter
from pipeline.analysis.likelihood.stripes import EACH, sampled_fragilities
from pipeline.execute import Threads
from pipeline.quantities import Array, G
from pipeline.records import Estimate, Fragility, Item, Motion, Sampling, Scene, Support
from pipeline.records.fragility import HazardCurve
from tests.soak import SOAK

from .test_likelihood import pulse, scenes_on_display, strong

pytestmark = pytest.mark.slow_file

CURVE = HazardCurve("pga", (0.5, 1.0, 3.0, 8.0), (1e-2, 4e-3, 5e-4, 2e-5))


def stripe(*motions: Motion, years: float | None = None) -> Stripe:
    """Motions with their peaks; that of velocity by the trapezium rule, which is exact for what is straight between."""
    speeds = [np.abs(np.cumsum(0.5 * m.dt * (m.acceleration[0, 1:] + m.acceleration[0, :-1]))).max() for m in motions]
    peaks = [float(np.abs(m.acceleration[:2]).max()) for m in motions]
    return Stripe(motions, tuple(peaks), years, tuple(map(float, speeds)))


def curves(
    scenes: Sequence[Scene],
    stripes: Sequence[Stripe],
    told: HazardCurve | None = None,
    *,
    samples: int = 512,
    threads: int = 1,
) -> list[tuple[Fragility, ...]]:
    stood = [Stood(at, scene) for at, scene in enumerate(scenes)]
    return sampled_fragilities(stood, len(scenes), stripes, 90.0, Sampling(samples), Threads(threads), told=told)


def slider(low: float, best: float, high: float, room: float) -> Scene:
    friction = Estimate.assumed(best, low, high, "-", "", "")
    parameters = {"friction_static": friction, "clearance": Estimate.measured(room, "m")}
    item = Item("1", "G", orientation_deg=90.0)
    return Scene(item, "cabinet", "", Support.FREESTANDING, ("sliding",), parameters)


# -- fits ------------------------------------------------------------------------------------------------------------


def test_a_published_probit_fit_is_reproduced() -> None:
    """Bliss (1935), beetles under carbon disulphide; Dobson (2002), table 7.4: slope 19.73 (1.48), deviance 10.12.

    The published slope is per decade of the dose, -34.94 / 19.73 its median in log10.
    """
    dose = 10.0 ** np.array([1.6907, 1.7242, 1.7552, 1.7842, 1.8113, 1.8369, 1.8610, 1.8839])
    taken = np.array([59, 60, 62, 56, 63, 59, 62, 60.0])[:, None]
    killed = np.array([6, 13, 18, 28, 52, 53, 61, 60.0])[:, None]
    found = fit_counts(dose, taken, killed)
    slope = math.log(10.0) / found.dispersion[0]
    assert slope == pytest.approx(19.73, abs=0.005)
    assert found.dispersion_error[0] * slope / found.dispersion[0] == pytest.approx(1.48, abs=0.01)
    assert math.log10(found.median[0]) == pytest.approx(34.94 / 19.73, abs=5e-4)
    assert found.deviance[0] == pytest.approx(10.12, abs=0.005)
    assert found.degrees[0] == 6


@pytest.mark.parametrize("seed", range(6))
def test_the_likelihood_is_the_largest(seed: int) -> None:
    """Truth: scipy's simplex on ln of median and dispersion, another parametrisation and method, to its 1e-6."""
    rng = np.random.default_rng(seed)
    x = np.geomspace(0.1, 3.0, 8)
    taken = rng.integers(5, 40, (8, 1)).astype(float)
    failed = rng.binomial(taken.astype(int), norm.cdf(np.log(x / 0.6) / 0.5)[:, None]).astype(float)

    def lost(logs: Array) -> float:
        z = (np.log(x) - logs[0]) / math.exp(logs[1])
        k, n = failed[:, 0], taken[:, 0]
        return -float(np.sum(k * norm.logcdf(z) + (n - k) * norm.logsf(z)))

    best = minimize(lost, [0.0, -0.5], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 5000})
    found = fit_counts(x, taken, failed)
    assert found.median[0] == pytest.approx(math.exp(best.x[0]), rel=1e-6)
    assert found.dispersion[0] == pytest.approx(math.exp(best.x[1]), rel=1e-6)
    assert found.likelihood[0] == pytest.approx(-best.fun, rel=1e-10)


def test_standard_errors_are_what_fits_scatter_by() -> None:
    """3,000 simulated experiments: the deviations of the fits within 10 %, by the theory of large samples."""
    rng = np.random.default_rng(3)
    x, n = np.geomspace(0.2, 2.0, 7), 40
    failed = rng.binomial(n, norm.cdf(np.log(x / 0.6) / 0.5)[:, None], (7, 3000)).astype(float)
    found = fit_counts(x, np.full((7, 3000), float(n)), failed)
    assert np.log(found.median).std() == pytest.approx(float(np.median(found.error)), rel=0.1)
    assert found.dispersion.std() == pytest.approx(float(np.median(found.dispersion_error)), rel=0.1)
    # Where the curve is right its deviance is that of chance: one case of twenty below one of twenty.
    assert np.mean(found.goodness < 0.05) == pytest.approx(0.05, abs=0.02)
    wrong = np.clip(failed + 25.0 * (np.arange(7) == 1)[:, None], 0, n)
    assert np.mean(fit_counts(x, np.full((7, 3000), float(n)), wrong).goodness < 0.05) > 0.9


def test_counts_that_make_no_curve_give_none() -> None:
    x, taken = np.array([0.5, 1.0, 2.0]), np.full((3, 4), 16.0)
    failed = np.array([[0, 16, 8, 0], [0, 16, 8, 0], [0, 16, 8, 16]], dtype=float)
    found = fit_counts(x, taken, failed, least=0.24)
    assert np.isnan(found.median[:2]).all()
    assert found.dispersion[2] == pytest.approx(FLATTEST)
    # Nothing between all and none: as steep as is allowed, no steeper.
    assert found.dispersion[3] == pytest.approx(0.24)
    assert np.isnan(found.dispersion_error[3])
    assert 1.0 < found.median[3] < 2.0


# -- stripes ---------------------------------------------------------------------------------------------------------


def _exact(push: float, seconds: float, ends: tuple[float, float, float], room: float) -> float:
    """Return how likely a block slides further than there is room for: `test_likelihood` says by what formula."""
    beta = stated("modelling").value

    def share(z: float) -> float:
        a = push * math.exp(beta * z)
        limit = a**2 * seconds**2 / (G * (a * seconds**2 + 2.0 * room))
        return float(np.interp(math.log(limit), np.log(ends), [0.0, 0.5, 1.0]))

    inside = quad(lambda z: share(z) * norm.pdf(z), -FARTHEST, FARTHEST, limit=400)[0]
    return float(inside + norm.cdf(-FARTHEST) * (share(-FARTHEST) + share(FARTHEST)))


@pytest.mark.parametrize("room", [0.02, 0.08])
def test_the_curve_of_a_sliding_block_is_that_of_the_closed_form(room: float) -> None:
    """Truth: Newmark's block under a rectangular pulse, friction and scatter integrated by quadrature.

    At each stripe: four binomial standard errors.  Of the curve: fitted to exact shares at the same stripes; the median
    within three of its standard errors, which are those of independent samples.
    """
    seconds, ends = 0.3, (0.2, 0.3, 0.6)
    (found,) = curves([slider(*ends, room)], [stripe(pulse(6.0, seconds))], samples=4096)
    harm = found[0]
    assert harm.state == "harm"
    assert len(harm.stripes) >= 5
    exact = []
    for push, taken, reached in harm.stripes:
        p = _exact(push, seconds, ends, room)
        exact.append((push, taken, p))
        assert taken >= 4096 // 32
        assert reached / taken == pytest.approx(p, abs=4.0 * math.sqrt((p * (1.0 - p) + 0.25 / taken) / taken))
    x, n, p = (np.array(column, dtype=float) for column in zip(*exact, strict=True))
    truth = fit_counts(x, n[:, None], (n * p)[:, None], scatter())
    assert harm.error is not None
    assert math.log(harm.median / truth.median[0]) == pytest.approx(0.0, abs=3.0 * harm.error)
    # Besides what was sampled there is the whole scatter of earthquakes, of which one motion shows none.
    counted = math.sqrt(harm.dispersion**2 - stated("record").value ** 2)
    assert harm.dispersion_error is not None
    assert counted == pytest.approx(truth.dispersion[0], abs=3.0 * harm.dispersion_error)
    assert harm.goodness is not None
    assert harm.goodness > 0.01


def test_a_lognormal_friction_is_recovered() -> None:
    """Where it slides at once at A = mu g, the capacity is the friction: known median, known dispersion.

    Friction is even in ln over a range of 2 r, whose deviation is r / sqrt(3); with the scatter both are added as
    squares.  A sum of an even and a normal distribution is no normal one; the fit of its shares is within 0.02 of its
    deviation, besides three standard errors.
    """
    best, half = 0.3, 0.4
    scene = slider(best * math.exp(-half), best, best * math.exp(half), 1e-4)
    (found,) = curves([scene], [stripe(pulse(0.3 * G, 3.0))], samples=8192)
    harm = found[0]
    counted = math.sqrt(harm.dispersion**2 - stated("record").value ** 2)
    assert harm.error is not None
    assert harm.dispersion_error is not None
    assert harm.median == pytest.approx(best * G, rel=3.0 * harm.error + 0.005)
    assert counted == pytest.approx(
        math.hypot(half / math.sqrt(3.0), scatter()), abs=3.0 * harm.dispersion_error + 0.02
    )


def test_the_scatter_of_the_models_is_that_of_the_samples() -> None:
    """Truth: the variance of a normal deviate put back to two standard deviations, by quadrature."""
    inside = quad(lambda z: z * z * norm.pdf(z), -FARTHEST, FARTHEST)[0]
    square = inside + 2.0 * FARTHEST**2 * norm.sf(FARTHEST)
    assert scatter() == pytest.approx(stated("modelling").value * math.sqrt(square), rel=1e-9)


def test_peak_velocity_is_told_where_it_decides() -> None:
    """What has far more room than one push takes it slides by V^2 / (2 mu g): a matter of velocity, not of A.

    Pulses of five lengths with the same scatter: by velocity the motions agree, by acceleration they do not.
    """
    pulses = [pulse(6.0, seconds) for seconds in (0.02, 0.03, 0.05, 0.08, 0.12)]
    (found,) = curves([slider(0.02, 0.02, 0.02, 0.2)], [stripe(*pulses)], samples=2048)
    harm = found[0]
    assert harm.measure == "pgv"
    assert harm.median_pgv is not None
    # d = V^2 / (2 mu g) (1 - mu g / A): a few percent more than without the last factor.
    assert harm.median_pgv == pytest.approx(math.sqrt(2.0 * 0.02 * G * 0.2), rel=0.15)
    assert harm.dispersion_pgv is not None
    assert harm.dispersion_pgv < harm.dispersion


@pytest.mark.long("night/test_crewed_nights::test_a_worker_with_several_threads")
def test_neither_order_nor_company_nor_workers_change_a_digit() -> None:
    scenes = scenes_on_display()[::29]
    stripes = [stripe(strong(), years=475.0), stripe(strong(6).scaled(1.7, "test"), years=2475.0)]
    whole = curves(scenes, stripes, threads=2)
    assert curves(scenes, stripes, threads=1) == whole
    assert list(reversed(curves(list(reversed(scenes)), stripes, threads=2))) == whole
    for at in (0, 3, 7, 11):
        assert curves([scenes[at]], stripes)[0] == whole[at]
    firsts = [one[0] for one in whole if one]
    assert len({one.samples for one in firsts}) > 2, "how many samples each takes is its own matter"
    assert any(one.bound == "" for one in firsts)
    assert all(one.samples % EACH == 0 for one in firsts)


def test_what_never_and_what_always_comes_to_harm_is_bounded() -> None:
    never, always = slider(0.9, 0.9, 0.9, 5.0), slider(0.01, 0.01, 0.01, 1e-6)
    (one, *_), (two, *_) = curves([never, always], [stripe(pulse(2.0, 0.2))], CURVE)
    assert (one.bound, two.bound) == ("above", "below")
    assert one.median == pytest.approx(max(a for a, _, _ in one.stripes), rel=1e-5)
    assert one.annual_rate is None
    assert two.median == pytest.approx(0.1 * 2.0)
    assert one.chances is None


def test_no_motion_and_no_model_no_curve() -> None:
    still = Motion(0.01, np.zeros((3, 100)), "still")
    scene = slider(0.2, 0.3, 0.6, 0.05)
    assert curves([scene], [stripe(still)]) == [()]
    assert curves([scene], []) == [()]
    assert curves([replace(scene, models=())], [stripe(strong())]) == [()]


# -- hazard ----------------------------------------------------------------------------------------------------------


def test_the_rate_is_the_integral_of_curve_and_hazard() -> None:
    """Truth: the fragility averaged over the slope of the hazard, piece by piece, by adaptive quadrature."""
    (found,) = curves([slider(0.2, 0.3, 0.6, 0.05)], [stripe(pulse(6.0, 0.3))], CURVE)
    harm = found[0]
    total = CURVE.rate[-1] * norm.cdf(math.log(CURVE.intensity[-1] / harm.median) / harm.dispersion)
    points = list(zip(CURVE.intensity, CURVE.rate, strict=True))
    for (a, r), (b, s) in pairwise(points):
        k = -math.log(s / r) / math.log(b / a)
        total += quad(
            lambda y, a=a, r=r, k=k: norm.cdf(math.log(y / harm.median) / harm.dispersion) * k * r / y * (y / a) ** -k,
            a,
            b,
            epsrel=1e-11,
        )[0]
    assert harm.annual_rate == pytest.approx(total, rel=1e-9)
    chances = harm.chances
    assert chances is not None
    assert chances[0] == pytest.approx(1.0 - math.exp(-50.0 * total), rel=1e-9)
    assert chances[1] < chances[0] < chances[2]


def test_more_hazard_is_more_risk() -> None:
    """Rates are in proportion to the hazard's, and grow where the same rates belong to stronger shaking."""
    scene, motion = slider(0.2, 0.3, 0.6, 0.05), stripe(pulse(6.0, 0.3))
    rates = []
    for times in (0.5, 1.0, 2.0):
        oftener = replace(CURVE, rate=tuple(times * one for one in CURVE.rate))
        rates.append(curves([scene], [motion], oftener)[0][0].annual_rate or 0.0)
    assert rates[1] == pytest.approx(2.0 * rates[0], rel=1e-12)
    assert rates[2] == pytest.approx(2.0 * rates[1], rel=1e-12)
    stronger = [
        curves([scene], [motion], replace(CURVE, intensity=tuple(f * one for one in CURVE.intensity)))[0][0].annual_rate
        for f in (0.8, 1.0, 1.2)
    ]
    assert stronger[0] < stronger[1] < stronger[2]  # type: ignore[operator]


def test_states_come_to_no_more_than_harm_and_in_their_order() -> None:
    """Every sample that falls harms.  Rates are of fits of their own to 16 samples a stripe, and may cross."""
    some = [
        one for one in curves(scenes_on_display()[:: 11 if SOAK else 22], [stripe(strong())], CURVE, threads=2) if one
    ]
    seen = 0
    for harm, *states in some:
        for state in states:
            if state.state not in ("falls", "breaks", "leaves"):
                continue
            for (a, taken, reached), (b, again, harmed) in zip(state.stripes, harm.stripes, strict=True):
                assert (a, taken) == (b, again)
                assert reached <= harmed
            if state.annual_rate is not None and harm.annual_rate is not None:
                seen += 1
                assert state.annual_rate <= harm.annual_rate * 1.5
    assert seen > (20 if SOAK else 10)


def test_a_curve_of_velocity_answers_by_velocity() -> None:
    told = HazardCurve("pgv", (0.05, 0.2, 1.0, 4.0), (1e-1, 1e-2, 5e-4, 1e-5))
    (found,) = curves([slider(0.2, 0.3, 0.6, 0.05)], [stripe(pulse(6.0, 0.3))], told)
    harm = found[0]
    assert harm.median_pgv is not None
    assert harm.dispersion_pgv is not None
    assert harm.annual_rate == pytest.approx(
        Hazard.told(told).failures(harm.median_pgv, harm.dispersion_pgv), rel=1e-12
    )


def test_beyond_the_ends_of_the_hazard_nothing_is_made_up() -> None:
    hazard = Hazard.told(CURVE)
    (found,) = curves([slider(0.2, 0.3, 0.6, 0.05)], [stripe(pulse(6.0, 0.3))])
    bare = found[0]

    def rated(median: float) -> Fragility:
        ends = (0.9 * median, median, 1.1 * median)
        return with_rate(bare, hazard, "", ends, (0.5, 0.6))

    assert rated(2.0).annual_rate == pytest.approx(hazard.failures(2.0, 0.6))
    assert rated(2.0).note == ""
    assert "ends before" in rated(7.0).note
    # What lies above could come at most as often as its upper end.
    above = norm.sf(math.log(8.0 / 6.3) / 0.5)
    assert rated(7.0).rate_high == pytest.approx(hazard.failures(6.3, 0.5) + above * CURVE.rate[-1])
    assert "at least this often" in rated(0.6).note
    assert rated(20.0).annual_rate is None
    assert rated(0.3).annual_rate is None
