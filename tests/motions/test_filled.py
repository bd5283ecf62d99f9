"""Gaps that are filled in known ways, in real channels and made ones; and both as they are."""

import numpy as np
import obspy
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from pipeline.motions.filled import filled
from pipeline.resources import resource
from tests.motions.formats.conftest import agency_file

__all__ = ["agency_file"]

DT = 0.01
WHOLE = ["CE89146.V1", "CE89146.V2", "CHAN15.V2", "ce36456p_CE36456.V2", "np01002r_4225a_u.smc", "0111a.smc"]


def made(seed: int, digit: float = 0.0, n: int = 6000) -> np.ndarray:
    """Noise with the spectrum of a Brune source, in an envelope, with the noise of a digitiser."""
    rng = np.random.default_rng(seed)
    f = np.fft.rfftfreq(n, DT)
    row = np.fft.irfft(np.fft.rfft(rng.normal(size=n)) * f**2 / (1 + (f / 0.3) ** 2) * np.exp(-0.1 * f), n)
    t = np.arange(n) * DT / 12.0
    row *= t**1.5 * np.exp(1.5 * (1.0 - t))
    row = row / np.abs(row).max() + 1e-4 * rng.normal(size=n)
    return np.round(row / digit) * digit if digit else row


def line(x, a, n):
    return np.interp(np.arange(a, a + n), [a - 1, a + n], [x[a - 1], x[a + n]])


def around(x, a, n):
    known = np.r_[a - 300 : a, a + n : a + n + 300]
    return known, x[known], np.arange(a, a + n)


def spline(x, a, n):
    known, values, at = around(x, a, n)
    return CubicSpline(known, values)(at)


def monotone(x, a, n):
    known, values, at = around(x, a, n)
    return PchipInterpolator(known, values)(at)


def cosine(x, a, n):
    return x[a - 1] + (x[a + n] - x[a - 1]) * 0.5 * (1.0 - np.cos(np.pi * np.arange(1, n + 1) / (n + 1)))


def smooth_and_cut(x, a, n):
    bridge = spline(x, a, n)
    return np.clip(bridge, *np.quantile(bridge, [0.2, 0.8]))


def zeros(x, a, n):
    return np.zeros(n)


def again(x, a, n):
    return x[a - n : a]


FILLS = (line, zeros, spline, monotone, cosine, smooth_and_cut, again)


def place(said: str) -> tuple[int, int]:
    return int(said.split("from sample ")[1].split(maxsplit=1)[0]), int(said.split("for ")[1].split(maxsplit=1)[0])


@pytest.mark.parametrize("fill", [fill for fill in FILLS if fill is not smooth_and_cut])
@pytest.mark.parametrize("seconds", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("digit", [0.0, 1e-5])
def test_a_filled_gap_is_told_with_its_place(fill, seconds, digit):
    n = round(seconds / DT)
    for seed in range(5):
        row = made(seed, digit)
        start = 900 + 60 * seed
        row[start : start + n] = fill(row, start, n)
        row = np.round(row / digit) * digit if digit else row
        said = filled(row, DT)
        assert said is not None
        first, samples = place(said)
        # A smooth curve may go on beyond its ends by chance, or bend more there.
        assert abs(first - start) <= max(4, n // 50)
        assert abs(samples - n) <= max(8, n // 25)
        assert f"({first * DT:.6g} s)" in said
        assert (f"from sample {start - n} " in said) == (fill is again)


@pytest.mark.parametrize("digit", [0.0, 1e-5, 1e-3])
def test_made_shaking_has_no_gap(digit):
    assert [filled(made(seed, digit), DT) for seed in range(40)] == [None] * 40


@pytest.fixture(scope="module")
def channels(agency_file):
    """Return the channels of real records as their files have them: (row, s)."""
    streams = [obspy.read(str(agency_file(name))) for name in WHOLE]
    streams.append(obspy.read(str(resource("site_motions", "demo") / "*.mseed")))
    return [(np.asarray(t.data, dtype=float), t.stats.delta) for stream in streams for t in stream]


def test_real_records_have_no_gap(channels):
    assert [filled(row, dt) for row, dt in channels] == [None] * len(channels)


@pytest.mark.parametrize("fill", FILLS)
def test_gaps_in_the_strong_part_of_real_records_are_found(channels, fill):
    """In 9 of 10 channels, as the module says; of a curve that was cut off too, its pieces count, 7 of 10."""
    found = []
    for row, dt in channels:
        count = float(np.diff(np.unique(row)).min())
        arrived = np.cumsum((row - np.median(row)) ** 2)
        start, n = (
            int(np.searchsorted(arrived, 0.3 * arrived[-1])),
            max(25, round((2.0 if fill is smooth_and_cut else 0.5) / dt)),
        )
        spoilt = np.array(row)
        values = fill(row, start, n)
        spoilt[start : start + n] = values if fill is again else np.round(values / count) * count
        found.append(filled(spoilt, dt) is not None)
    assert np.mean(found) >= (0.7 if fill is smooth_and_cut else 0.9)


def test_what_is_smooth_or_recurs_by_nature_is_no_gap():
    t = np.arange(6000) * DT
    quiet = made(1)
    quiet[:1000] = 0.0
    quiet[-500:] = np.linspace(quiet[-501], 0.0, 500)
    for row in (np.sin(2 * np.pi * t), np.tile(made(2, n=200), 30), quiet, np.repeat(made(3, n=1500), 4), 0.0 * t):
        assert filled(row, DT) is None


def test_a_gap_before_the_shaking_moves_nothing_and_is_let_pass():
    row = made(4)
    row[:500] = 1e-3 * np.random.default_rng(0).normal(size=500)
    row[200:300] = 0.0
    assert filled(row, DT) is None
