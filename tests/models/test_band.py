"""The largest of a response spectrum over a band of frequencies, against dense searches and a closed form."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from shaking import along_x, random_motion

from pipeline import respond
from pipeline.cache import SPECTRA, Cache
from pipeline.models import band
from pipeline.models.band import MISSED, band_accelerations, pseudo_accelerations, sharing_spectra
from pipeline.models.oscillator import oscillate, oscillate_any
from pipeline.motions import read_motion
from pipeline.quantities import Array
from pipeline.records import Excitation, Motion
from pipeline.resources import resource

SECTION = {"mass": 10.0, "lever": 0.3, "area": 1e-3, "section_modulus": 1e-5}


@pytest.fixture(scope="module")
def record() -> Motion:
    return read_motion(resource("site_motions", "demo"))[0]


def spectrum(motion: Excitation, frequencies: Array, zeta: float) -> Array:
    w = 2.0 * np.pi * frequencies
    return np.asarray(w**2 * oscillate(motion, w, np.full_like(w, zeta), np.ones_like(w))[0])


def bands(rng: np.random.Generator, count: int) -> tuple[Array, Array]:
    low = np.exp(rng.uniform(np.log(0.3), np.log(20.0), count))
    return low, np.minimum(low * np.exp(rng.uniform(np.log(1.05), np.log(20.0), count)), 60.0)


@pytest.mark.parametrize("zeta", [0.01, 0.02, 0.05])
def test_a_dense_search_of_a_real_record_finds_no_more(record: Motion, zeta: float) -> None:
    """200 random bands, searched at a fortieth of a half-power width.

    Both searches have points, and no more: the dense one is 2e-4 off a resonance's peak at most, (1/40)^2 / 2.
    """
    rng = np.random.default_rng(int(1000.0 * zeta))
    motion = record.excitation(float(rng.uniform(0.0, 180.0)))
    frequencies = np.exp(np.arange(np.log(0.3), np.log(60.0), 2.0 * zeta / 40.0))
    values = spectrum(motion, frequencies, zeta)
    low, high = bands(rng, 200)
    least, most = band_accelerations(motion, low, high, np.full_like(low, zeta))
    # A band's ends lie between the points of the search.
    ends = spectrum(motion, np.concatenate([low, high]), zeta).reshape(2, -1).T
    inside = [
        np.concatenate([values[(begin <= frequencies) & (frequencies <= end)], both])
        for begin, end, both in zip(low, high, ends, strict=True)
    ]
    missed = np.array([one.max() for one in inside]) / most - 1.0
    assert missed.max() < MISSED
    # Nor is it above the curve, but where a band ends between two points of the grid.
    assert missed.min() > -MISSED
    # The least has kinks, where the largest has none: it is told less finely.
    above = least / np.array([one.min() for one in inside]) - 1.0
    assert above.max() < 2.0 * MISSED


def test_three_samples_of_a_band_miss_its_largest(record: Motion) -> None:
    """Both ends and the middle are more than 5 % below the largest in most bands: why the band is searched."""
    rng = np.random.default_rng(1)
    low, high = bands(rng, 300)
    motion = record.excitation(20.0)
    most = band_accelerations(motion, low, high, np.full_like(low, 0.02))[1]
    sampled = spectrum(motion, np.concatenate([low, np.sqrt(low * high), high]), 0.02).reshape(3, -1).max(axis=0)
    assert np.mean(most > 1.05 * sampled) > 0.5


@pytest.mark.parametrize("zeta", [0.01, 0.03, 0.1])
def test_resonance_in_closed_form(zeta: float) -> None:
    """Under A sin(W t) for ever the largest is A / (2 zeta sqrt(1 - zeta^2)), at W / sqrt(1 - 2 zeta^2).

    150 cycles: of the transient exp(-2 pi 150 zeta) is left, 8e-5 at the most; the wave is drawn by 100 lines a cycle,
    whose fundamental is 3e-4 below the sine's.
    """
    f, peak = 3.0, 2.0
    t = np.arange(0.0, 150.0 / f, 0.01 / f)
    motion = along_x(peak * np.sin(2.0 * np.pi * f * t), 0.01 / f).excitation(0.0)
    low, high, damping = np.array([0.5 * f]), np.array([2.2 * f]), np.array([zeta])
    most = band_accelerations(motion, low, high, damping)[1]
    assert most[0] == pytest.approx(peak / (2.0 * zeta * math.sqrt(1.0 - zeta**2)), rel=2e-3)
    # Left of the peak the largest is at the band's upper end.
    r = 0.8
    damping = np.array([0.1])
    most = band_accelerations(motion, np.array([0.2 * f]), np.array([r * f]), damping)[1]
    assert most[0] == pytest.approx(spectrum(motion, np.array([r * f]), 0.1)[0], rel=1e-4)


def test_a_band_is_found_alike_in_any_company(record: Motion) -> None:
    """To the last bit: the grid does not depend on who asks, nor on whether the motion was met before."""
    low, high = bands(np.random.default_rng(2), 50)
    zeta = np.where(np.arange(50) % 2, 0.01, 0.05)
    together = band_accelerations(record.excitation(70.0), low, high, zeta)
    for at in (0, 7, 31):
        alone = band_accelerations(record.excitation(70.0), low[at : at + 1], high[at : at + 1], zeta[at : at + 1])
        assert (alone[0][0], alone[1][0]) == (together[0][at], together[1][at])


def test_twice_the_shaking_is_twice_the_acceleration() -> None:
    """The oscillator is linear; shaking is told apart by 2^-30 of its peak, which is all that may differ."""
    motion = random_motion(3)
    low, high, zeta = np.array([1.0, 4.0]), np.array([9.0, 40.0]), np.array([0.02, 0.02])
    once, more = (band_accelerations(m.excitation(33.0), low, high, zeta) for m in (motion, motion.scaled(0.3, "test")))
    np.testing.assert_allclose(more[1], 0.3 * once[1], rtol=1e-7)
    np.testing.assert_allclose(more[0], 0.3 * once[0], rtol=1e-7)


def test_nothing_shakes_nothing() -> None:
    least, most = band_accelerations(along_x([0.0] * 50, 0.01).excitation(0.0), *np.array([[1.0], [9.0], [0.02]]))
    assert (least[0], most[0]) == (0.0, 0.0)


def test_the_stress_of_a_band_is_that_of_its_largest_and_least() -> None:
    """m A l / S - m g / A with both: by hand from the spectrum's ends of the band."""
    motion = random_motion(5)
    row = respond("flexible_stress", motion, frequency=2.0, frequency_high=12.0, damping=0.03, **SECTION).iloc[0]
    each = np.geomspace(2.0, 12.0, 4000)
    felt = respond("oscillator", motion, frequency=each, damping=0.03)["pseudo_acceleration"]
    assert row["pseudo_acceleration"] == pytest.approx(felt.max(), rel=MISSED)
    assert row["tension"] == pytest.approx(10.0 * row["pseudo_acceleration"] * 0.3 / 1e-5 - 98066.5, rel=1e-12)
    assert row["tension_least"] == pytest.approx(10.0 * felt.min() * 0.3 / 1e-5 - 98066.5, rel=3.0 * MISSED)


def test_in_the_worst_direction_the_largest_is_no_less_than_at_any_frequency() -> None:
    motion = random_motion(6)
    given = {**SECTION, "damping": 0.02}
    band = respond("flexible_stress", motion, angle=None, frequency=1.0, frequency_high=20.0, **given).iloc[0]
    each = respond("flexible_stress", motion, angle=None, frequency=np.geomspace(1.0, 20.0, 300), **given)
    assert band["tension"] > (1.0 - MISSED) * each["tension"].max()
    assert band["tension_least"] < (1.0 + 2.0 * MISSED) * each["tension"].min()
    bound = respond(
        "flexible_stress", motion, angle=None, fidelity="bound", frequency=1.0, frequency_high=20.0, **given
    ).iloc[0]
    assert bound["low"] <= each["tension"].max() <= bound["high"]


@pytest.mark.parametrize("model", ["stress", "flexible_stress"])
def test_concentration_multiplies_the_bending_alone(model: str) -> None:
    """sigma = K M / S - N / A; N / A = 98066.5 Pa."""
    motion = random_motion(7)
    more = {"frequency": 3.0, "damping": 0.02} if model == "flexible_stress" else {}
    plain, twice = respond(model, motion, concentration=[1.0, 2.0], **SECTION, **more)["tension"]
    assert twice == pytest.approx(2.0 * (plain + 98066.5) - 98066.5, rel=1e-12)


def test_who_shares_spectra_finds_the_same(record: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Found alone, found and kept, and taken over: bit for bit, and what is there is not found again.

    What was put away by the one who found it is read by another, who remembers nothing and wants more besides.
    """
    rng = np.random.default_rng(7)
    motion = record.excitation(None)
    low, high = bands(rng, 40)
    zeta = rng.choice([0.01, 0.05], low.size)

    def anew(some: slice) -> tuple[Array, Array]:
        band._pieces._found.clear()
        return band_accelerations(motion, low[some], high[some], zeta[some])

    alone = anew(slice(None))
    with sharing_spectra(Cache(tmp_path)):
        first = anew(slice(20))
        files = {file: file.read_bytes() for file in (tmp_path / SPECTRA).iterdir()}
        second = anew(slice(None))
    assert files
    assert all(file.read_bytes() == content for file, content in files.items())
    for mine, both, part in zip(alone, second, first, strict=True):
        np.testing.assert_array_equal(both, mine)
        np.testing.assert_array_equal(part, mine[:20])
    with sharing_spectra(Cache(tmp_path)):
        monkeypatch.setattr(band, "_piece", lambda *_: pytest.fail("what is kept was found again"))
        np.testing.assert_array_equal(anew(slice(None)), alone)


@pytest.mark.parametrize("angle", [None, 30.0])
def test_single_oscillators_do_not_hang_on_what_was_asked_before(record: Motion, angle: float | None) -> None:
    """Bit for bit those of all oscillators run at once: alone, again in another order, and more than are remembered."""
    rng = np.random.default_rng(3)
    motion = record.excitation(angle)
    frequency = np.round(np.exp(rng.uniform(np.log(0.3), np.log(30.0), 6000)), 2)
    zeta = rng.choice([0.01, 0.02, 0.05], frequency.size)
    w = 2.0 * np.pi * frequency
    want = w**2 * oscillate_any(motion, w, zeta)
    for some in (slice(1), slice(0, 300), rng.permutation(400), slice(None), slice(5500, 6000)):
        np.testing.assert_array_equal(pseudo_accelerations(motion, frequency[some], zeta[some]), want[some])
