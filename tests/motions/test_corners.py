"""Corners of known noise and drift, and beside the published search for a corner, written anew here."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.signal import butter, detrend, sosfilt
from scipy.signal.windows import tukey

from pipeline.motions.corners import choose_corner, source_corner
from pipeline.motions.filtering import highpass
from pipeline.motions.intensity import integrate
from pipeline.motions.onset import first_arrival
from pipeline.records import Motion
from tests.soak import some

from .test_baseline import DT, clean
from .test_window import shaken


def noisy(cross, level, seed=2):
    """A broadband event from 10 to 20 s, plus noise below ``cross`` Hz that was there before the event, too."""
    rng = np.random.default_rng(seed)
    noise = sosfilt(butter(4, cross, fs=1 / DT, output="sos"), rng.normal(size=(3, 20_000)))[:, -6000:]
    event = sosfilt(butter(2, [0.1, 10.0], "bandpass", fs=1 / DT, output="sos"), rng.normal(size=(3, 6000)))
    t = np.arange(6000) * DT
    event *= np.where(np.abs(t - 15.0) < 5.0, np.cos(np.pi * (t - 15.0) / 10.0) ** 2, 0.0)
    return Motion(DT, event + level * noise / noise.std(axis=1, keepdims=True))


def running(seed, n=10_000):
    """Shaking at 15 s whose coda of 1.5 to 3 s still runs when the record ends, with the noise of an instrument.

    In the last tenth the displacement has a third of its peak: waves, no drift.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(n) * DT
    strong = sosfilt(butter(2, [0.2, 10.0], "bandpass", fs=1 / DT, output="sos"), rng.normal(size=(3, n)))
    coda = sosfilt(butter(2, [0.33, 0.67], "bandpass", fs=1 / DT, output="sos"), rng.normal(size=(3, n)))
    after = np.clip(t - 15.0, 0.0, None)
    shape = np.where(t > 15.0, after * np.exp(-after / 4.0), 0.0)
    shaken = 0.3 * strong * shape + 0.2 * coda * np.where(t > 18.0, np.exp(-after / 60.0), 0.0)
    drift = np.cumsum(rng.normal(size=(3, n)), axis=1) * 2e-6
    return Motion(DT, shaken + drift + 1e-4 * rng.normal(size=(3, n)))


def published(row, dt):
    """The corner of Ramos-Sepulveda et al. (2025), as gmprocess 2.8.0 (CC0) describes it, in words of this test.

    Tapered acceleration, a filter of fifth order in the frequency domain, displacement, a quintic of at most 2 %.
    """
    n = row.size
    lines = np.fft.rfft(detrend(row) * tukey(n, 0.1) * tukey(n, 0.05))[1:]
    f = np.fft.rfftfreq(n, dt)[1:]
    s = np.linspace(-1.0, 1.0, n)

    def left(log_corner):
        filtered = lines / np.sqrt(1.0 + (np.exp(log_corner) / f) ** 10) / (2 * np.pi * f) ** 2
        moved = np.fft.irfft(np.concatenate([[0.0], filtered]), n)
        return np.abs(np.polyval(np.polyfit(s, moved, 5), s)).max() / np.abs(moved).max() - 0.02

    return float(np.exp(brentq(left, np.log(0.001), np.log(0.5), rtol=1e-3)))


def pgv(motion, corner):
    data, _, start = highpass(detrend(motion.acceleration, axis=1), motion.dt, corner)
    return np.abs(integrate(Motion(motion.dt, data, start=start))[0][:2]).max()


@pytest.mark.parametrize("seed", some(range(8), 4))
def test_waves_that_still_run_are_no_drift(seed):
    """Within a factor of two of the published corner, and 5 % of the PGV there.

    By the displacement in the last tenth, as it was once judged, these records had to be filtered at 0.3 to 1 Hz.
    """
    motion = running(seed)
    corner = choose_corner(motion)
    peer = max(3.0 / motion.duration, *(published(row, DT) for row in motion.acceleration[:2]))
    assert peer / 2.0 < corner.frequency < 2.0 * peer
    assert pgv(motion, corner.frequency) == pytest.approx(pgv(motion, peer), rel=0.05)
    _, moved = integrate(Motion(DT, highpass(motion.acceleration, DT, corner.frequency)[0]))
    assert np.abs(detrend(moved[:2, 9000:], axis=1)).max() > 0.02 * np.abs(moved[:2]).max()


def test_corner_of_a_clean_record_comes_from_its_length():
    """60 s hold three periods of 0.05 Hz."""
    corner = choose_corner(clean())
    assert corner.frequency == pytest.approx(3.0 / 59.99, rel=1e-12)
    assert corner.reason.startswith("record length: 3 periods in 59.99 s")
    # Without any noise the pre-event part asks for nothing, and says how far down it can be trusted.
    quiet = choose_corner(clean(), 5.0)
    assert quiet.frequency == corner.frequency
    assert "is there down to 0.2 Hz" in quiet.reason


@pytest.mark.parametrize("cross", [0.2, 0.4])
def test_corner_follows_the_noise(cross):
    """Noise up to a known frequency: the corner lies where it meets the event, within an octave of that frequency.

    The filter falls off by 24 dB an octave, so that the noise cannot matter much above it; a third of an octave is
    the resolution.
    """
    motion = noisy(cross, 0.03)
    loud = choose_corner(motion, 10.0, drift_share=0.9)
    assert cross / 2.0 < loud.frequency < 2.0 * cross
    assert loud.reason.startswith("pre-event noise")


def test_the_first_arrival_is_found():
    """The event rises from 10 s as a cosine squared: it leaves the noise behind at 10 to 12 s, less a second."""
    motion = noisy(0.2, 0.001)
    quiet = np.array(motion.acceleration) + 1e-3 * np.random.default_rng(1).normal(size=(3, 6000))
    assert 9.0 < first_arrival(Motion(DT, quiet)) < 11.0
    # A record that begins in the event has no noise before it.
    assert first_arrival(Motion(DT, np.array(motion.acceleration)[:, 1300:])) is None


def test_the_source_of_a_small_earthquake():
    """Brune's corner at 10 bar: of magnitude 5, a moment of 3.5e23 dyne cm and 3.7 km/s, 0.55 Hz."""
    assert source_corner(5.0) == pytest.approx(0.55, abs=0.01)
    small = choose_corner(clean(), magnitude=3.0)
    assert small.frequency == pytest.approx(0.1 * source_corner(3.0))
    assert small.reason.startswith("source")


@pytest.mark.parametrize("quiet", [6.0, 10.0, 16.0])
def test_nothing_is_known_below_what_the_noise_resolves(quiet):
    """White noise of a millionth of the event: the corner is one over its length, where gmprocess begins its spectra.

    The event has nothing below 0.5 Hz, so that the PGV is the same.
    """
    rng = np.random.default_rng(4)
    motion = Motion(DT, clean(at=quiet + 5.5).acceleration + 4e-6 * rng.normal(size=(3, 6000)))
    corner = choose_corner(motion)
    arrival = first_arrival(motion)
    assert arrival == pytest.approx(quiet, abs=1.5)
    assert corner.frequency == pytest.approx(1.0 / arrival, rel=0.01)
    assert corner.reason.startswith("pre-event noise")
    assert "below which it is unknown" in corner.reason
    assert pgv(motion, corner.frequency) == pytest.approx(pgv(motion, 0.05), rel=0.01)


def test_corner_is_raised_by_a_bent_baseline():
    """A bend over the whole record: the corner is within a factor of two of the published one; the PGV stays."""
    s = np.linspace(-1.0, 1.0, 6000)
    bend = 0.004 * (1 - s**2) ** 2 * np.cos(2 * np.pi * s)
    # Its noise before the event, which the bend is, is too short to be looked at.
    bent = Motion(DT, clean(at=8.0).acceleration + np.stack([bend, -bend, 100.0 * bend]), "bent")
    corner = choose_corner(bent)
    assert corner.reason.startswith("displacement drift")
    peer = max(published(row, DT) for row in bent.acceleration[:2])
    assert peer / 2.0 < corner.frequency < 2.0 * peer
    assert pgv(bent, corner.frequency) == pytest.approx(pgv(bent, peer), rel=0.05)


@pytest.mark.parametrize("kind", ["noise", "drift"])
def test_what_the_record_does_not_decide_is_the_stronger_motion_and_told(kind):
    """A slow wave under a sharper event: as noise or drift it is filtered out, as part of the event it is the PGV."""
    corner = choose_corner(motion := undecided(kind))
    assert corner.reason.startswith("pre-event noise" if kind == "noise" else "displacement drift")
    words = corner.reason.split("does not decide between ")[1].split()
    low, high = float(words[0]), float(words[words.index("and") + 1])
    assert low < high
    assert corner.frequency == pytest.approx(low, rel=5e-3)
    strong, weak = pgv(motion, corner.frequency), pgv(motion, high)
    assert strong > 1.05 * weak
    assert f"{100 * strong:.3g} cm/s" in corner.reason
    assert f"{100 * weak:.3g} cm/s" in corner.reason


def undecided(kind):
    """A sharp event at 15 s, and a wave of 6 s period that runs all the time, or one of 10 s about 12 s."""
    t = np.arange(6000) * DT
    if kind == "noise":
        u = 0.1 * tukey(6000, 0.4) * np.sin(2 * np.pi / 6.0 * t)
    else:
        u = 0.3 * np.exp(-(((t - 12.0) / 4.0) ** 2)) * np.sin(0.2 * np.pi * (t - 12.0))
    slow = np.stack([np.gradient(np.gradient(u, DT), DT)] * 3)
    return Motion(DT, slow + 0.05 * clean().acceleration + 1e-5 * np.random.default_rng(0).normal(size=(3, 6000)))


@pytest.mark.parametrize("second", [4.0, 8.0, 12.0])
def test_noise_where_an_event_has_nothing_does_not_take_its_waves(second):
    """Tones of 0.5 Hz and above, in noise of a five-hundredth, which adds about as little to the PGV: 1 %.

    Judged by single bands, the noise below the lowest tone asked for 0.22 Hz, which takes 3 % of the PGV.
    """
    rng = np.random.default_rng(3)
    t = np.arange(6000) * DT
    shape = np.where(np.abs(t - 30.0) < 15.0, np.cos(np.pi * (t - 30.0) / 30.0) ** 2, 0.0)
    tones = np.sin(np.pi * t) + np.sin(2.0 * np.pi * second * t)
    still = np.stack([shape * tones] * 3)
    motion = Motion(DT, still + 2e-3 * rng.normal(size=(3, 6000)))
    corner = choose_corner(motion)
    assert corner.frequency < 0.25
    true = np.abs(integrate(Motion(DT, still))[0][:2]).max()
    assert pgv(motion, corner.frequency) == pytest.approx(true, rel=0.01)


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(seed, marks=pytest.mark.long("test_the_corner_does_not_hang_on_the_window") if seed else [])
        for seed in some(range(8), 4)
    ],
)
def test_the_corner_does_not_hang_on_the_window(seed):
    """Windows of 115 to 150 s about one earthquake in noise: a factor of two about the middle, 0.5 % in the PGV.

    It has nothing below 0.5 Hz, of which a corner of 0.06 Hz takes less than 0.1 %; the noise adds up to 0.2 %.
    Judged by single bands the corners of such windows were from 0.05 to 0.76 Hz.
    """
    data = shaken(150.0, 50.0, seed=seed) * 1e-3
    found = []
    for begin, end in ((0.0, 150.0), (12.0, 129.0), (32.0, 149.0), (20.0, 135.0)):
        row = data[int(begin / DT) : int(end / DT)]
        motion = Motion(DT, np.stack([row, 0.8 * row, 0.5 * row]))
        corner = choose_corner(motion).frequency
        found.append((corner, pgv(motion, corner)))
    corners, peaks = zip(*found, strict=True)
    assert max(corners) < 2.0 * np.median(corners)
    assert min(corners) > 0.5 * np.median(corners)
    assert max(peaks) < 1.005 * min(peaks)


def test_corner_asks_for_the_displacement_of_the_horizontals_only():
    """The vertical's may be as unsettled as it likes."""
    motion = clean()
    rough = np.array(motion.acceleration)
    rough[2] = noisy(0.4, 0.5).acceleration[2]
    assert choose_corner(Motion(DT, rough), 5.0).frequency == choose_corner(motion, 5.0).frequency


def test_corner_refusals():
    ramp = np.cumsum(np.random.default_rng(0).normal(size=(3, 6000)), axis=1)
    with pytest.raises(ValueError, match="no corner up to 1 Hz"):
        choose_corner(Motion(DT, ramp), drift_share=1e-4)
    with pytest.raises(ValueError, match="nowhere 3 times the noise"):
        choose_corner(Motion(DT, np.random.default_rng(0).normal(size=(3, 6000))), 10.0)
    with pytest.raises(ValueError, match="pre_event must be"):
        choose_corner(clean(), 100.0)
    with pytest.raises(ValueError, match="at most half the record"):
        choose_corner(clean(), 40.0)
    with pytest.raises(ValueError, match="drift_share between 0 and 1"):
        choose_corner(clean(), drift_share=0.0)
