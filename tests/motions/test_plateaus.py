"""Channels that are clipped at a known level and filtered afterwards, as a digitiser does, and clean ones."""

import numpy as np
import pytest
from scipy.signal import butter, resample_poly, sosfilt

from pipeline.motions.plateaus import full_scale, held
from pipeline.motions.quality import clipped

DT = 0.01


def shaking(seed, n=6000):
    """Band-limited noise in an envelope that rises within 5 s and dies away over 20 s."""
    t = np.arange(n) * DT
    row = sosfilt(
        butter(2, [0.2, 5.0], "bandpass", fs=1 / DT, output="sos"), np.random.default_rng(seed).normal(size=n)
    )
    return row * (t / 5.0) * np.exp(1.0 - t / 5.0)


def smoothed(row, share):
    """Clipped at four times the rate, then through the decimator's filter: no sample lies at the limit itself."""
    fine = resample_poly(row, 4, 1)
    limit = share * np.abs(fine).max()
    return resample_poly(np.clip(fine, -limit, limit), 1, 4), limit


@pytest.mark.parametrize(("share", "least"), [(0.7, 0.7), (0.5, 0.9), (0.3, 0.95)])
def test_smoothed_limits_are_found_at_their_level(share, least):
    """In so many of forty seeds; where one is found, its level is the limit within the filter's ripple of 10 %."""
    found = 0
    for seed in range(40):
        row, limit = smoothed(shaking(seed), share)
        plateau = held(row, DT)
        if plateau is not None:
            found += 1
            assert abs(plateau.level) == pytest.approx(limit, rel=0.1)
    assert found >= least * 40


def test_clean_shaking_holds_no_level():
    """Of 300 at most three: by chance the crests of two waves may add up to a level for a while."""
    assert sum(held(shaking(seed), DT) is not None for seed in range(300)) <= 3


def test_a_level_held_for_long_is_told_with_its_place():
    """Held for 11 s below a spike that it comes back from: not the extreme, and flat to the last count."""
    row = 1000.0 * shaking(3)
    level = 0.6 * np.abs(row).max()
    row[1000:2100] = level
    said = clipped(np.stack([row]), DT, ("HHZ",))
    assert said is not None
    assert said.startswith("HHZ is clipped")


def test_a_step_of_a_quiet_channel_is_no_clipping():
    row = 1e-3 * np.random.default_rng(0).normal(size=6000)
    row[2000:2100] += 1.0
    assert held(row, DT) is None


@pytest.mark.parametrize(("peak", "found"), [(8_364_412, True), (6_000_000, False), (32_700, True), (2.0**26, False)])
def test_the_full_scale_of_digitisers(peak, found):
    assert (full_scale(np.array([0.0, peak, -5.0])) is not None) == found
