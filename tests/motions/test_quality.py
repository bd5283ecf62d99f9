"""Clipped channels and records that are cut off: real records, whole, and spoilt in known ways."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import obspy
import pytest

from pipeline.motions.doubts import doubts
from pipeline.motions.quality import alike, clipped, cut_off, one_sided, uneven
from pipeline.resources import resource
from tests.motions.formats.conftest import agency_file
from tests.soak import some

__all__ = ["agency_file"]

CHANNELS = ("one", "two", "up")
RECORDS = {
    "redwood raw": [f"np01002r_4225{c}_u.smc" for c in "acb"],
    "redwood": [f"np01002p_4225{c}_a.smc" for c in "acb"],
    "shafter": ["0111a.smc", "0111c.smc", "0111b.smc"],
    "meloland": ["CHAN15.V2", "CHAN24.V2", "CHAN14.V2"],
    "weitchpec raw": ["CE89146.V1"],
    "weitchpec": ["CE89146.V2"],
    "coalinga": ["ce36456p_CE36456.V2"],
    "waipawa": ["20180212_211557_WPWS_20.V2A"],
    "ridgecrest": [],
}


@pytest.fixture(scope="module")
def record(agency_file):
    """Return the samples of a record as its files have them, (3, n), horizontals first, and its step in s."""

    @cache
    def read(name):
        if name == "ridgecrest":
            stream = obspy.read(str(resource("site_motions", "demo") / "*.mseed"))
            traces = [stream.select(channel=channel)[0] for channel in ("HNE", "HNN", "HNZ")]
        else:
            traces = [t for file in RECORDS[name] for t in obspy.read(str(agency_file(file)))]
            traces.sort(key=lambda t: t.stats.kouros.orientation == "up")
        n = min(t.stats.npts for t in traces)
        data = np.stack([np.asarray(t.data[:n], dtype=float) for t in traces])
        data.flags.writeable = False
        return data, traces[0].stats.delta

    return read


def runs(held):
    """The lengths of the runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], held.astype(int), [0]])))
    return edges[1::2] - edges[::2]


@pytest.mark.parametrize("name", RECORDS)
def test_good_records_are_neither_clipped_nor_cut_off_nor_uneven(record, name):
    data, dt = record(name)
    assert uneven(data) is None
    assert clipped(data, dt, CHANNELS) is None
    assert cut_off(data, dt, CHANNELS) is None


def overflowed(row, limit):
    """As a counter does that has no more digits: beyond the limit it goes on at the other one."""
    return (row + limit) % (2.0 * limit) - limit


def left_out(row, limit):
    return np.where(np.abs(row) > limit, 0.0, row)


@pytest.mark.parametrize("name", ["weitchpec", "coalinga", "ridgecrest", "meloland"])
@pytest.mark.parametrize(("spoil", "said"), [(overflowed, "from one limit to the other"), (left_out, "drops out")])
def test_what_jumps_at_its_limit_is_told(record, name, spoil, said):
    data, dt = record(name)
    row = data[0] - np.median(data[0])
    told = clipped(spoil(row, 0.4 * np.abs(row).max())[None], dt, CHANNELS[:1])
    assert told is not None
    assert said in told or "is clipped" in told


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("share", [0.5, 0.8, 0.95])
def test_a_clipped_record_is_found(record, name, share):
    """Each channel by itself is cut off at a share of its peak, as an instrument does: about its level.

    Four samples in a row at the limit must be found; three may be missed where their edges are blunt.  Of one sample
    there is nothing to be seen: at 95 % some crests of 50 and 100 samples a second have no more.
    """
    data, dt = record(name)
    level = data.mean(axis=1)
    for row, channel in enumerate(CHANNELS):
        limit = share * np.abs(data[row] - level[row]).max()
        spoilt = np.array(data)
        spoilt[row] = np.clip(data[row], level[row] - limit, level[row] + limit)
        held = spoilt[row] != data[row]
        said = clipped(spoilt, dt, CHANNELS)
        if runs(held).max() >= 4:
            assert said is not None
        if said is not None:
            assert said.startswith(f"{channel} is clipped")
            at = int(said.split("sample ")[1].split(" ")[0])
            assert held[at : at + 2].any()
            assert f"({at * dt:.6g} s)" in said


def test_every_strong_record_clipped_at_half_its_peak_is_found(record):
    for name in RECORDS:
        data, dt = record(name)
        level = data.mean(axis=1, keepdims=True)
        limit = 0.5 * np.abs(data - level).max(axis=1, keepdims=True)
        assert clipped(np.clip(data, level - limit, level + limit), dt, CHANNELS) is not None, name


def test_a_limit_that_wavers_by_a_count_is_found(record):
    """The converter of a clipped amplifier still flickers: counts, and the limit or one below it by chance."""
    data, dt = record("ridgecrest")
    limit = np.floor(0.5 * np.abs(data).max())
    spoilt = np.array(data)
    over = data > limit
    spoilt[over] = limit - np.random.default_rng(3).integers(0, 2, size=np.count_nonzero(over))
    assert clipped(spoilt, dt, CHANNELS) is not None
    assert clipped(spoilt * 4.6e-6, dt, CHANNELS) is not None


@pytest.mark.parametrize(
    ("phase", "step", "dt"),
    [
        pytest.param(*case, marks=pytest.mark.long("test_sines_and_sweeps_are_not_clipped") if at % 3 else [])
        for at, case in enumerate(
            some(product([0.0, 0.3, np.pi / 8, np.pi / 4, np.pi / 2], [0.0, 1e-5, 1e-3, 1e-2], [0.005, 0.01, 0.02]), 15)
        )
    ],
)
def test_sines_and_sweeps_are_not_clipped(dt, step, phase):
    """From 200 samples a period to three, also in step with the sampling, where every crest has the same samples.

    step : what numbers are rounded to, relative to the peak
    """
    t = np.arange(round(40.0 / dt)) * dt
    envelope = np.minimum(1.0, np.minimum(t, t[-1] - t) / 3.0)
    tones = [np.sin(2 * np.pi * f * t + phase) for f in (0.25, 1.0, 1.3, 2.5, 5.0, 6.25, 10.0, 12.5, 16.0)]
    sweep = np.sin(2 * np.pi * (0.5 * t + 0.25 * t * t) + phase)
    for row in (*tones, sweep, *(envelope * tone for tone in tones), envelope * sweep):
        rounded = np.round(row / step) * step if step else row
        assert clipped(np.stack([rounded] * 3), dt, CHANNELS) is None


def test_pairs_are_enough_where_they_come_unevenly():
    """Two samples at the limit, three times: at even distances a sine may do that, at uneven ones a clipped channel."""
    t = np.arange(3000) * 0.01
    row = np.random.default_rng(5).normal(size=3000) * 0.1
    for starts, found in (((500, 1000, 1500), False), ((500, 1000, 1730), True)):
        spoilt = np.array(row)
        for at in starts:
            spoilt[at : at + 2] = 1.0
        said = clipped(np.stack([0.1 * np.sin(t), spoilt, row]), 0.01, CHANNELS)
        assert (said is not None) == found
    assert "held for 2 samples from sample 500 (5 s), and 3 tops" in said


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7, 0.9, 0.95])
def test_a_record_cut_between_d5_and_d95_is_found(record, name, share):
    """Cut off, and begun, when a share of the Arias intensity of its horizontals has arrived."""
    data, dt = record(name)
    level = data[:2] - np.median(data[:2], axis=1, keepdims=True)
    arrived = np.cumsum((level**2).sum(axis=0))
    at = int(np.searchsorted(arrived, share * arrived[-1]))
    said = cut_off(data[:, :at], dt, CHANNELS)
    assert " ends during strong shaking" in said
    assert said.split()[0] in CHANNELS[:2]
    # The start of the last second is named, to the sample.
    assert f"from sample {at - round(min(1.0 / dt, 0.1 * at))} " in said
    assert " begins during strong shaking: over 1 s from sample 0 (0 s)" in cut_off(data[:, at:], dt, CHANNELS)


def test_shares_by_hand():
    """A tone of 1 for 20 s, then a rest of 0.21 or 0.23 of it: 22 % is where a record counts as complete."""
    t = np.arange(4000) * 0.01
    for rest, complete in ((0.21, True), (0.23, False)):
        row = np.sin(2 * np.pi * 5.0 * t) * np.where((t > 5.0) & (t < 25.0), 1.0, rest)
        said = cut_off(np.stack([row, 0.0 * t, 50.0 * row]), 0.01, CHANNELS)
        assert (said is None) == complete
    assert said.startswith("one ends during strong shaking: over 1 s from sample 3900 (39 s)")


def test_silence_is_not_judged():
    assert cut_off(np.zeros((3, 100)), 0.01, CHANNELS) is None
    assert clipped(np.zeros((3, 100)), 0.01, CHANNELS) is None


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("offset", [0.0, 5.0])
def test_no_record_is_one_sided(record, name, offset):
    """Nor with an offset of five times its peak, as of gravity in a logger's vertical."""
    data, _ = record(name)
    assert [one_sided(row + offset * np.abs(row).max()) for row in data] == [None] * 3


def test_spectra_and_envelopes_are_one_sided():
    """The square root of a Brune spectrum's power, and the envelope of a record; both fall from one peak."""
    t = np.arange(1, 401) * 0.01
    for row in (t / (1.0 + t**2), -np.exp(-t), t * np.exp(1.0 - t)):
        assert "crosses its own trend" in one_sided(row)
    assert one_sided(np.sin(2.0 * np.pi * t)) is None
    assert one_sided(np.zeros(400)) is None


def shaken(seed: int = 1, n: int = 6000) -> np.ndarray:
    """Noise about 2 Hz at 100 samples a second, louder in its middle, in hundredths of cm/s2, with an offset."""
    rng = np.random.default_rng(seed)
    f = np.fft.rfftfreq(n, 0.01)
    row = np.fft.irfft(np.fft.rfft(rng.standard_normal(n)) * np.exp(-((np.log(np.maximum(f, 1e-9) / 2.0)) ** 2)), n)
    row *= np.exp(-(((np.arange(n) - 2500) / 900.0) ** 2))
    return np.round(200.0 * row / np.abs(row).max() - 3.0, 2)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("spikes", [[(4000, 150.0)], [(2400, -400.0), (3300, 380.0), (3900, 500.0)]])
def test_samples_that_stand_alone_are_spikes(seed, spikes):
    row = shaken(seed)
    assert clipped(row[None], 0.01, ("HNE",)) is None
    for at, size in spikes:
        row[at] += size
    said = clipped(row[None], 0.01, ("HNE",))
    assert f"{len(spikes)} of its samples stand alone" in said
    largest = max(spikes, key=lambda one: abs(one[1]))[0]
    assert f"from sample {largest} ({0.01 * largest:g} s)" in said


def test_a_jump_and_a_kink_are_no_spikes():
    """As test signals have them: one that decays from its first sample on, a triangle."""
    t = 0.01 * np.arange(3000)
    decaying = np.where(t > 5.0, np.exp(5.0 - t), 0.0)
    triangle = np.clip(1.0 - np.abs(t - 10.0), 0.0, None)
    for row in (decaying, triangle, np.sin(2.0 * np.pi * t)):
        said = clipped(row[None], 0.01, ("x",))
        assert said is None or "spike" not in said


@pytest.mark.parametrize("level", [0.0, None])
@pytest.mark.parametrize("seed", range(6))
def test_a_level_that_is_held_amid_the_shaking_is_a_drop_out(seed, level):
    """30 samples that are zero, or hang at the last one, though the step into them is none."""
    row = shaken(seed)
    start = 2200 + int(np.argmax(np.abs(row[2200:2260] + 3.0)))
    row[start : start + 30] = row[start - 1] if level is None else level
    assert "HNE" in clipped(row[None], 0.01, ("HNE",))


def test_a_pause_between_two_bursts_is_no_drop_out():
    t = 0.01 * np.arange(3000)
    row = np.where((t < 10.0) | (t > 11.0), np.sin(2.0 * np.pi * t), 0.0)
    assert clipped(row[None], 0.01, ("x",)) is None


@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (1, 2)])
@pytest.mark.parametrize("factor", [1.0, -1.0, 0.5])
def test_one_component_given_twice_is_told(factor, pair):
    rows = np.array([shaken(1), shaken(2), shaken(3)])
    assert alike(rows) is None
    a, b = pair
    rows[b] = np.round(factor * rows[a], 2)
    said = alike(rows)
    assert said is not None
    assert f"{'xyz'[b]} {factor:g} times {'xyz'[a]}" in said
    rows[b] = 0.0
    assert alike(rows) is None, "a dead channel is told otherwise"


@pytest.mark.parametrize(
    ("sizes", "said"),
    [
        ((1.0, 1.5, 0.6), None),
        ((1.0, 2.7, 0.26), None),
        ((1.0, 1.0, 2.0), None),
        ((1.0, 1.0, 0.0), None),
        ((1.0 / 9.80665, 1.0, 0.6), "y is 9.81 times as strong as x"),
        ((1.0, 0.01, 0.6), "x is 100 times as strong as y"),
        ((1.0, 1.0, 9.80665), "z is 9.81 times as strong as"),
        ((0.9, 1.0, 0.01), "y is 100 times as strong as z"),
    ],
)
def test_a_component_of_another_unit_is_doubted(sizes, said):
    """Ratios of real recordings pass (see UNEVEN); a component in g, or in other hundredths, does not."""
    row = shaken(1) + 3.0
    rows = np.array([size * row for size in sizes]) - 3.0
    found = uneven(rows)
    assert (found is None) == (said is None)
    assert found is None or found.startswith(said)
    assert found is None or doubts([found]) == (found,)
