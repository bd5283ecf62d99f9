"""A second earthquake in the coda of the first is told as a doubt; a clean record is called nothing of the kind."""

import gzip
import hashlib
import shutil
from pathlib import Path

import numpy as np
import obspy
import pytest

from pipeline.motions import read_motion
from pipeline.motions.reading import open_traces
from pipeline.motions.several import renewals
from pipeline.resources import resource

DEMO = resource("site_motions", "demo")
AGENCY = Path(__file__).parents[1] / "data" / "motions"


@pytest.fixture(scope="module")
def demo():
    """Of the demonstration's record, an aftershock of a tenth of the mainshock's size included, in counts."""
    return [obspy.read(str(DEMO / f"CI.CLC..HN{one}.mseed"))[0] for one in "ENZ"]


def with_copy(traces, later, size):
    """The record, and from `later` s on once more, `size` times as large, until the copy's own end."""
    made = []
    for trace in traces:
        data = trace.data.astype(float) - np.median(trace.data)
        count = round(later / trace.stats.delta)
        both = np.zeros(data.size + count)
        both[: data.size] = data
        both[count:] += size * data
        made.append(both)
    return np.array(made)


@pytest.mark.parametrize("size", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("later", [60.0, 90.0, 120.0, 200.0, 390.0])
def test_a_copy_of_the_record_is_found_where_it_was_put(demo, later, size):
    """Its first arrival is 32 s after the record's beginning; the S waves follow within 10 s."""
    (found,) = renewals(with_copy(demo, later, size), demo[0].stats.delta)
    assert later + 25.0 <= found.second <= later + 45.0


def test_the_record_itself_is_one(demo):
    assert renewals(with_copy(demo, 0.0, 0.0), demo[0].stats.delta) == []


RECORDS = [
    ["0111a.smc", "0111b.smc", "0111c.smc"],
    ["np01002p_4225a_a.smc", "np01002p_4225b_a.smc", "np01002p_4225c_a.smc"],
    ["np01002r_4225a_u.smc", "np01002r_4225b_u.smc", "np01002r_4225c_u.smc"],
    ["CHAN14.V2", "CHAN15.V2", "CHAN24.V2"],
    ["CE89146.V1"],
    ["CE89146.V2"],
    ["ce36456p_CE36456.V2"],
    ["20180212_211557_WPWS_20.V2A"],
    ["NP1795-n.305.v0c"],  # three pulses of a second or two that test the sensor
]


@pytest.mark.parametrize("names", RECORDS, ids=lambda names: names[0])
def test_clean_records_are_called_one_earthquake(tmp_path, names):
    traces = []
    for name in names:
        (tmp_path / name).write_bytes(gzip.decompress((AGENCY / f"{name}.gz").read_bytes()))
        traces += open_traces(tmp_path / name, [])
    count = min(trace.stats.npts for trace in traces)
    assert renewals(np.array([np.asarray(t.data[:count], float) for t in traces]), traces[0].stats.delta) == []


def test_it_is_told_among_the_steps_and_never_refused(tmp_path, demo):
    """The whole way: files, manifest, steps; the window that is asked for holds one earthquake alone."""
    shutil.copytree(DEMO, tmp_path / "site")
    manifest = (tmp_path / "site" / "manifest.toml").read_text(encoding="utf-8")
    for trace, data in zip(demo, with_copy(demo, 120.0, 0.5), strict=True):
        file = tmp_path / "site" / f"{trace.id}.mseed"
        before = hashlib.sha256(file.read_bytes()).hexdigest()
        made = obspy.Trace(np.round(data).astype(np.int32), trace.stats)
        made.write(str(file), format="MSEED", encoding="STEIM2", reclen=512)
        manifest = manifest.replace(before, hashlib.sha256(file.read_bytes()).hexdigest())
    (tmp_path / "site" / "manifest.toml").write_text(manifest, encoding="utf-8")
    (motion,) = read_motion(tmp_path / "site")
    assert not [step for step in motion.steps if "may hold" in step]
    (tmp_path / "site" / "manifest.toml").write_text(manifest.replace("[20.0, 120.0]", "[20.0, 380.0]"), "utf-8")
    (motion,) = read_motion(tmp_path / "site")
    (said,) = [step for step in motion.steps if "may hold" in step]
    assert said.startswith("may hold two earthquakes, or one whose fault broke in parts: it shakes anew at 15")
    assert "2019-07-06T03:21:" in said or "2019-07-06T03:22:" in said


def test_two_bursts_of_one_rupture_are_a_doubt():
    """As Tohoku 2011: two bursts of 20 s, 45 s apart; nobody calls it two earthquakes."""
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 300.0, 0.01)
    level = np.full(t.size, 1e-3)
    for at in (40.0, 85.0):
        after = np.maximum(t - at, 0.0)
        level += (after > 0.0) * np.minimum(after / 3.0, 1.0) * np.exp(-after / 12.0)
    found = renewals(level * rng.normal(size=(3, t.size)), 0.01)
    assert [84 <= one.second <= 90 for one in found] == [True]


@pytest.mark.parametrize("decay", [8.0, 20.0, 60.0])
def test_a_long_coda_with_late_surface_waves_is_one(decay):
    """A basin: S waves 25 s after the P waves and three times as large, surface waves of 3 s that swell after them."""
    rng = np.random.default_rng(5)
    t = np.arange(0.0, 400.0, 0.01)
    p, s = np.maximum(t - 30.0, 0.0), np.maximum(t - 55.0, 0.0)
    level = 1e-3 + 0.3 * (p > 0.0) * np.exp(-p / 40.0) + (s > 0.0) * np.exp(-s / decay)
    basin = 3.0 * (s / 30.0) * np.exp(1.0 - s / 30.0) * np.sin(2.0 * np.pi * t / 3.0)
    assert renewals(level * rng.normal(size=(3, t.size)) + basin, 0.01) == []
