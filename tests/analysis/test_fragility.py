"""Fragility curves against closed forms: lognormal fits, hazard integrals, and motions scaled until something fails."""

from dataclasses import replace
from math import exp, log, sqrt
from statistics import median

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import CensoredData, norm

from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.fragility.curve import NINETY, fit, stated
from pipeline.analysis.fragility.hazard import Hazard, NoHazardError
from pipeline.analysis.fragility.objects import Stripe, fragilities, hazard_of
from pipeline.analysis.fragility.published import all_published, in_si, published
from pipeline.analysis.fragility.scaling import FACTORS
from pipeline.analysis.plan import plan
from pipeline.analysis.response import respond
from pipeline.cli.console import Console
from pipeline.execute import Threads
from pipeline.motions.synthesis import half_sine_pulse
from pipeline.quantities import G
from pipeline.records import Fragility, Furniture, Item, Motion, RunRecord, Support

pytestmark = pytest.mark.slow_file

SILENT = Console(quiet=True)

BLOCK = Item(
    "1", "A", "Block", support=Support.FREESTANDING, furniture=Furniture.FLOOR,
    height_m=0.4, base_width_m=0.1, base_depth_m=0.1, width_m=0.1,
    depth_m=0.1, cg_height_m=0.2, friction=0.3, clearance_m=0.05, mass_kg=2.0,
)  # fmt: skip


def rectangular(acceleration: float, seconds: float, dt: float = 0.001) -> Motion:
    """One pulse of constant acceleration along x; its flanks take one step each."""
    n = round(seconds / dt)
    x = np.zeros(n + 200)
    x[1 : n + 1] = acceleration
    return Motion(dt, [x, np.zeros_like(x), np.zeros_like(x)], f"pulse {acceleration:g} {seconds:g}")


def stripe(*motions: Motion, years: float | None = None) -> Stripe:
    return Stripe(motions, tuple(float(np.abs(m.acceleration[:2]).max()) for m in motions), years)


def curves(*items: Item, stripes: list[Stripe]) -> list[dict[str, Fragility]]:
    scenes = [classify(item) for item in items]
    found = fragilities(scenes, plan(scenes).work, stripes, Context(Threads(1)))
    return [{f.model: f for f in one} for one in found]


# -- fits ------------------------------------------------------------------------------------------------------------


def test_a_whole_sample_has_its_geometric_mean_and_deviation() -> None:
    capacity = np.array([[0.2, 0.4, 0.5, 0.9]]) * G
    found = fit(capacity, np.full(4, 0.01), np.full(4, 100.0))
    logs = np.log(capacity[0])
    assert found.median[0] == pytest.approx(exp(logs.mean()), rel=1e-12)
    assert found.dispersion[0] == pytest.approx(logs.std(ddof=1), rel=1e-12)
    assert found.bound == [""]


@pytest.mark.parametrize("seed", range(4))
def test_a_sample_cut_off_on_both_sides_is_fitted_by_maximum_likelihood(seed: int) -> None:
    """Truth: scipy's own maximum likelihood for censored samples, by another method (Nelder-Mead: to 1e-4)."""
    rng = np.random.default_rng(seed)
    logs = rng.normal(0.0, 0.5, 12)
    low, high = -0.6, 0.5
    capacity = np.where(logs < low, 0.0, np.where(logs > high, np.inf, np.exp(logs)))
    found = fit(capacity[None, :], np.full(12, exp(low)), np.full(12, exp(high)))
    told = CensoredData(
        logs[(logs >= low) & (logs <= high)],
        left=np.full(int((logs < low).sum()), low),
        right=np.full(int((logs > high).sum()), high),
    )
    mean, deviation = norm.fit(told)
    assert np.isfinite(capacity).sum() < 12 or (capacity > 0.0).sum() < 12
    assert log(found.median[0]) == pytest.approx(mean, abs=1e-3)
    assert found.dispersion[0] == pytest.approx(deviation * sqrt(12 / 11), rel=1e-3)


def test_what_mostly_never_fails_or_always_does_has_only_a_bound() -> None:
    capacity = np.array([[np.inf, np.inf, 1.0], [0.0, 0.0, 1.0], [np.inf, 1.0, 1.0]])
    found = fit(capacity, np.full(3, 0.1), np.full(3, 3.0))
    assert found.bound == ["above", "below", ""]
    assert found.median[0] > 1.0
    assert found.median[1] < 1.0
    (alone,) = fit(np.array([[2.0]]), np.array([0.1]), np.array([3.0])).dispersion
    assert np.isnan(alone)  # one motion tells no scatter


# -- hazard ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("slope", "at", "dispersion"), [(2.0, 0.3, 0.5), (3.5, 0.8, 0.35), (1.2, 0.1, 0.6)])
def test_a_power_law_gives_the_closed_form(slope: float, at: float, dispersion: float) -> None:
    """lambda = k0 m^-k exp(k^2 beta^2 / 2) (Cornell et al. 2002); drawn out so far that nothing is left outside."""
    k0 = 1e-3
    period = {x: 1.0 / (k0 * x**-slope) for x in (0.2, 0.5)}
    hazard = Hazard.of(list(period), list(period.values()), extended=1e9)
    truth = k0 * at**-slope * exp(0.5 * (slope * dispersion) ** 2)
    assert hazard.failures(at, dispersion) == pytest.approx(truth, rel=1e-10)
    assert hazard.failures(at, 0.0) == pytest.approx(k0 * at**-slope, rel=1e-10)


@pytest.mark.parametrize("at", [0.08, 0.3, 1.0, 3.0])
def test_a_bent_curve_with_ends_gives_the_integral_the_other_way_round(at: float) -> None:
    """Truth: the fragility averaged over the slope of the hazard, by adaptive quadrature, piece by piece."""
    hazard = Hazard.of([0.15, 0.4, 0.7], [50.0, 475.0, 2475.0])
    dispersion = 0.5
    x, rate = hazard.intensity, hazard.rate
    total = rate[-1] * norm.cdf(log(x[-1] / at) / dispersion)
    for a, b, r, s in zip(x[:-1], x[1:], rate[:-1], rate[1:], strict=True):
        k = -log(s / r) / log(b / a)
        total += quad(
            lambda y, a=a, r=r, k=k: norm.cdf(log(y / at) / dispersion) * k * r / y * (y / a) ** -k, a, b, epsrel=1e-11
        )[0]
    assert hazard.failures(at, dispersion) == pytest.approx(total, rel=1e-9)


def test_the_curve_goes_through_its_levels_and_no_further_than_twice() -> None:
    hazard = Hazard.of([2.0, 4.0], [475.0, 2475.0])
    assert hazard.ends == (1.0, 8.0)
    assert hazard.rate[1:-1].tolist() == pytest.approx([1 / 475, 1 / 2475])
    assert hazard.rate[0] / hazard.rate[1] == pytest.approx(hazard.rate[1] / hazard.rate[2])


@pytest.mark.parametrize(
    ("intensities", "periods", "why"),
    [
        ([2.0], [475.0], "two levels or more"),
        ([2.0, 3.0], [475.0, 475.0], "two levels or more"),
        ([3.0, 2.0], [475.0, 2475.0], "a rarer level must shake more"),
        ([2.0, 2.0], [475.0, 2475.0], "a rarer level must shake more"),
        ([0.0, 2.0], [475.0, 2475.0], "a rarer level must shake more"),
        ([2.0, float("inf")], [475.0, 2475.0], "a rarer level must shake more"),
    ],
)
def test_levels_that_make_no_curve_say_why(intensities: list[float], periods: list[float], why: str) -> None:
    with pytest.raises(NoHazardError, match=why):
        Hazard.of(intensities, periods)


def test_levels_without_a_period_take_no_part() -> None:
    pulse = half_sine_pulse(2.0, 0.5)
    stripes = [stripe(pulse, years=475.0), stripe(pulse.scaled(2.0, "test"), years=2475.0), stripe(pulse)]
    assert hazard_of(stripes).intensity.size == 4
    with pytest.raises(NoHazardError, match="two levels"):
        hazard_of(stripes[1:])


# -- scaling ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("height", [0.2, 0.4, 0.9])
def test_rocking_begins_where_the_push_over_the_weight_is_the_slope(height: float) -> None:
    """Truth: A = g B/H' under a horizontal pulse, whatever the pulse; interpolation of what is straight is exact."""
    (found,) = curves(
        replace(BLOCK, height_m=height, cg_height_m=0.5 * height, friction=2.0),
        stripes=[stripe(half_sine_pulse(2.0, 0.5))],
    )
    assert found["standing"].median == pytest.approx(G * 0.1 / height, rel=1e-12)
    assert found["standing"].inputs == 0.0
    assert found["standing"].dispersion == pytest.approx(
        sqrt(stated("record").value ** 2 + stated("modelling").value ** 2)
    )


@pytest.mark.parametrize("friction", [0.05, 0.1, 0.2, 0.4])
@pytest.mark.parametrize("clearance", [0.01, 0.05, 0.2])
def test_sliding_begins_where_newmark_says(friction: float, clearance: float) -> None:
    """Truth: d = V^2 / (2 mu g) (1 - mu g/A), V = A T (Newmark 1965), solved for A: a quadratic.

    Between two factors, 1.6 apart, a displacement is taken as a power of the factor.  It is nearly one, but for where
    it begins: within 7 %, as stated.
    """
    seconds, push = 0.25, 3.0
    resist = friction * G
    truth = 0.5 * (resist + sqrt(resist**2 + 8.0 * resist * clearance / seconds**2))
    (found,) = curves(
        replace(BLOCK, friction=friction, clearance_m=clearance), stripes=[stripe(rectangular(push, seconds))]
    )
    assert found["sliding"].median == pytest.approx(truth, rel=0.07)


def test_what_never_fails_and_what_always_does_are_bounds() -> None:
    weak, strong = half_sine_pulse(0.01 * G, 0.5), half_sine_pulse(50.0 * G, 0.5)
    (never,), (always,) = (curves(BLOCK, stripes=[stripe(m)]) for m in (weak, strong))
    assert (never["standing"].bound, always["standing"].bound) == ("above", "below")
    assert never["standing"].median == pytest.approx(FACTORS[-1] * 0.01 * G, rel=1e-3)
    assert always["standing"].median == pytest.approx(FACTORS[0] * 50.0 * G, rel=1e-3)
    assert never["standing"].low == never["standing"].high == never["standing"].median
    assert never["standing"].annual_rate is None


def test_a_motion_that_does_not_shake_cannot_be_scaled() -> None:
    still = Motion(0.01, np.zeros((3, 100)), "still")
    assert curves(BLOCK, stripes=[stripe(still)]) == [{}]
    assert curves(BLOCK, stripes=[]) == [{}]


def test_overturning_counts_from_the_weakest_that_overturns_although_a_stronger_does_not() -> None:
    """Truth: the model itself, asked at the very factors; some of these blocks stand again under stronger shaking."""
    rng, n = np.random.default_rng(9), 800
    x = np.convolve(2.0 * rng.normal(size=n) * np.sin(np.pi * np.arange(n) / (n - 1)), np.full(12, 0.2), "same")
    motion = Motion(0.01, [x, np.zeros_like(x), np.zeros_like(x)], "noise")
    pga = float(np.abs(x).max())
    seen = []
    for cg in (0.1, 0.6, 0.9, 1.2):
        side = 0.25 * cg
        item = replace(
            BLOCK, susceptible=False, height_m=2.0 * cg, cg_height_m=cg, base_width_m=side, base_depth_m=side,
            clearance_m=9.0, orientation_deg=90.0,
        )  # fmt: skip
        (found,) = curves(item, stripes=[stripe(motion)])
        asked = [respond("rocking", motion.scaled(f, "test"), half_width=0.5 * side, cg_height=cg) for f in FACTORS]
        falls = [bool(table["overturned"].iloc[0]) for table in asked]
        first = falls.index(True)
        assert found["standing"].returns is not all(falls[first:])
        assert FACTORS[first - 1] * pga < found["standing"].median < FACTORS[first] * pga
        seen.append(found["standing"].returns)
    assert any(seen)
    assert not all(seen)


def test_uncertain_inputs_add_their_squares() -> None:
    """Rocking begins at g b/h: the dispersions of ln b and ln h are those of the capacity, to rounding."""
    scene = classify(replace(BLOCK, friction=2.0))
    wide = {"half_width": (0.04, 0.06), "cg_height": (0.15, 0.25)}
    known = dict(scene.parameters)
    for name, (low, high) in wide.items():
        known[name] = replace(known[name], low=low, high=high)
    scene = replace(scene, parameters=known)
    ((found, *_),) = fragilities(
        [scene], [w for w in plan([scene]).work if w.model.name == "standing"], [stripe(half_sine_pulse(2.0, 0.5))],
        Context(Threads(1)),
    )  # fmt: skip
    truth = sqrt(sum((log(high / low) / (2.0 * NINETY)) ** 2 for low, high in wide.values()))
    assert found.inputs == pytest.approx(truth, rel=1e-9)
    unsure = sqrt(truth**2 + stated("modelling").value ** 2 + stated("record").value ** 2)
    assert found.high / found.median == pytest.approx(exp(NINETY * unsure), rel=1e-9)
    assert found.low * found.high == pytest.approx(found.median**2, rel=1e-9)


def test_record_to_record_is_measured_from_seven_motions_on() -> None:
    """Truth: the capacity of each pulse by Newmark's closed form; 7 % of each is 0.04 of the scatter at most."""
    seconds = np.geomspace(0.05, 0.6, 7)
    resist = BLOCK.friction * G
    truth = np.log([0.5 * (resist + sqrt(resist**2 + 8.0 * resist * 0.05 / s**2)) for s in seconds])
    pulses = [rectangular(0.6 * G, s) for s in seconds]
    (found,) = curves(BLOCK, stripes=[stripe(*pulses)])
    assert not found["sliding"].stated
    assert found["sliding"].record == pytest.approx(truth.std(ddof=1), abs=0.04)
    assert log(found["sliding"].median) == pytest.approx(truth.mean(), abs=0.07)
    rough = replace(BLOCK, friction=2.0)
    (found,) = curves(rough, stripes=[stripe(*pulses)])
    assert found["standing"].record == pytest.approx(0.0, abs=1e-9)
    (few,) = curves(rough, stripes=[stripe(*pulses[2:5])])
    assert few["standing"].stated
    assert few["standing"].record == stated("record").value


def test_two_levels_give_a_rate_and_one_says_why_not() -> None:
    pulse = half_sine_pulse(0.2 * G, 0.5)
    stripes = [stripe(pulse, years=475.0), stripe(pulse.scaled(2.0, "test"), years=2475.0)]
    rough = replace(BLOCK, friction=2.0)
    (found,) = curves(rough, stripes=stripes)
    curve = found["standing"]
    assert curve.motions == 2
    assert curve.annual_rate == pytest.approx(hazard_of(stripes).failures(0.25 * G, curve.dispersion), rel=1e-6)
    assert curve.rate_low is not None
    assert curve.rate_high is not None
    assert curve.rate_low < curve.annual_rate < curve.rate_high
    (alone,) = curves(rough, stripes=stripes[:1])
    assert alone["standing"].annual_rate is None
    assert "two levels or more" in alone["standing"].note
    (far,) = curves(replace(BLOCK, base_width_m=0.6, base_depth_m=0.6), stripes=stripes)
    assert far["standing"].annual_rate is None


# -- what others published -------------------------------------------------------------------------------------------


def test_the_material_says_which_shelf() -> None:
    """FEMA P-58 calls glass or metal on wood slippery; a cabinet is no thing on a shelf."""
    medians = {p.what: in_si(p) / G for p in all_published() if p.unit == "g"}
    assert medians == pytest.approx(
        {
            "objects on shelves, restraint unknown": 0.4,
            "objects on a slippery shelf, as glass or metal on wood": 0.25,
            "objects on shelves in cabinets with latches": 0.6,
            "objects held by museum putty in cabinets with latches": 1.0,
        }
    )

    def median_of(**told: str) -> float | None:
        found = published(classify(replace(BLOCK, **told)))  # type: ignore[arg-type]
        return None if found is None else found.median

    assert median_of(medium="Marble") == 0.4
    assert median_of(medium="Glass") == median_of(medium="Bronze", surface_material="Oak") == 0.25
    assert (
        median_of(medium="Glass", surface_material="Marble") == median_of(medium="Glass", base_material="Wood") == 0.4
    )
    assert median_of(medium="Bronze", object_name="Cabinet") is None
    assert published(classify(Item("2", "A", "Painting", support=Support.HUNG, height_m=1.0))) is None


def test_scatter_of_objects_is_not_that_of_buildings() -> None:
    """From record to record 0.45 to 0.9 in peak acceleration, 0.4 to 0.5 in velocity; FEMA P-695 has 0.2 to 0.4."""
    assert (stated("record").low, stated("record").high) == (0.45, 0.90)
    assert (stated("record_velocity").low, stated("record_velocity").high) == (0.40, 0.50)


def test_small_objects_of_the_demonstration_fail_where_shelf_contents_were_seen_to(demo_record: RunRecord) -> None:
    """Freestanding objects below half a metre: the median of their medians is 0.30 g, beside a published 0.40 g.

    The published median is of things falling from shelves, ours of any harm, of which sliding too far is the most, and
    the demonstration's motions are rich in velocity: a factor of 1.5 would be no surprise, and is what is held here.
    """
    small = [
        a.fragilities[0].median / G
        for a in demo_record.assessments
        if a.fragilities and a.scene.support is Support.FREESTANDING and (a.scene.item.height_m or 9.0) < 0.5
    ]
    middle = median(small)
    print(
        f"{len(small)} small freestanding objects: median {middle:.2f} g, published 0.40 g, factor {middle / 0.4:.2f}"
    )
    assert len(small) > 500
    assert 0.4 / 1.5 < middle < 0.4 * 1.5
