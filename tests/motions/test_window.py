"""A window goes first: what lies outside of it costs nothing and spoils nothing; earthquakes are found and chosen."""

import contextlib
import io
import json
import subprocess
import sys

import numpy as np
import obspy
import pytest

from pipeline.motions import MotionError, read_motion
from pipeline.motions import parts as parts_module
from pipeline.motions.corners import STEP
from pipeline.motions.earthquakes import AFTER, BEFORE, earthquakes, window_of
from pipeline.motions.entries import entries
from pipeline.motions.intensity import measures
from pipeline.motions.parts import CHUNK, MARGIN, scan, whole
from tests.soak import SOAK, some

from .conftest import DT, tone

START = obspy.UTCDateTime(2020, 1, 1)
RATE = 100.0


def shaken(seconds, *at, size=2000.0, seed=0):
    """Whole mm/s2 of noise with a minute of shaking, 0.5 to 8 Hz, from each of the times."""
    rng = np.random.default_rng(seed)
    data = 2.0 * rng.normal(size=int(seconds * RATE))
    t = np.arange(6000) / RATE
    shake = sum(
        np.sin(2 * np.pi * f * t + p) for f, p in zip(rng.uniform(0.5, 8, 40), rng.uniform(0, 6, 40), strict=True)
    )
    shake *= size / 12.0 * np.sin(np.pi * t / 60.0) ** 2
    for second in at:
        data[int(second * RATE) : int(second * RATE) + 6000] += shake
    return np.round(data).astype(np.int32)


def write(folder, data, *, start=START, name="{}.mseed", keep=None):
    """Three components, of which `keep` (channel -> spans in s) leaves pieces."""
    for code, factor in (("HNE", 1.0), ("HNN", 0.8), ("HNZ", 0.5)):
        values = np.round(factor * data).astype(np.int32)
        header = {"network": "XX", "station": "A", "channel": code, "sampling_rate": RATE, "starttime": start}
        trace = obspy.Trace(values, header)
        stream = obspy.Stream([trace])
        if keep and code in keep:
            stream = obspy.Stream([trace.slice(start + a, start + b) for a, b in keep[code]])
        stream.write(str(folder / name.format(code)), format="MSEED", encoding="STEIM2", reclen=512)


COMMON = {
    "files": ["HNE.mseed", "HNN.mseed", "HNZ.mseed"],
    "components": {
        "HNE": {"axis": "x", "orientation": 90},
        "HNN": {"axis": "y", "orientation": 0},
        "HNZ": {"axis": "z", "orientation": "up"},
    },
    "units": "mm/s2",
    "processed": False,
}


def test_a_window_of_a_day_is_that_window_alone(tmp_path, write_manifest):
    """The same corner to a step of the search; filtered with the record around it, peaks differ by far less than 1 %.

    The straight line that goes first is that of what was read, which moves the arrival that is found by a few samples.
    """
    whole = shaken(4 * 3600.0, 7200.0)
    write(tmp_path, whole)
    (part,) = read_motion(write_manifest(**COMMON, window_s=[7150.0, 7300.0]))
    write(tmp_path, whole[715000:730001], start=START + 7150)
    (alone,) = read_motion(write_manifest(**COMMON))
    assert part.samples == alone.samples == 15001
    a, b = measures(part), measures(alone)
    corners = [next(s for s in m.steps if s.startswith("high-pass corner")).split()[2] for m in (part, alone)]
    assert float(corners[0]) == pytest.approx(float(corners[1]), rel=STEP - 1.0)
    for name in ("pga_x", "pga_y", "pga_z", "pgv_x", "pgv_y", "pgv_z"):
        assert a[name] == pytest.approx(b[name], rel=2e-3)


def test_a_window_of_a_day_unpacks_the_window_and_its_margins(tmp_path, write_manifest, monkeypatch):
    """Counted where samples are unpacked: 400 s and 300 s on both sides, of 24 hours; of four every day."""
    write(tmp_path, np.tile(shaken(3600.0, 1800.0), 24 if SOAK else 4))
    unpacked = []
    original = obspy.read

    def counting(source, **how):
        stream = original(source, **how)
        if not how.get("headonly"):
            unpacked.append(sum(trace.stats.npts for trace in stream))
        return stream

    monkeypatch.setattr(obspy, "read", counting)
    (motion,) = read_motion(write_manifest(**COMMON, window_s=[5300.0, 5700.0]))
    assert motion.samples == 40001
    needed = 3 * (400.0 + 2 * MARGIN) * RATE
    assert needed <= sum(unpacked) <= 1.01 * needed


@pytest.mark.long("test_a_window_of_a_day_unpacks_the_window_and_its_margins")
def test_the_memory_of_a_day_is_that_of_its_window(tmp_path, write_manifest):
    """Each in a process of its own: 24 hours are 26 million samples, 200 MB as numbers, 8 GB when processed.

    But for `make soak` it is an eighth of that, of which still the processing alone is far beyond what is granted.
    """
    day = np.tile(shaken(3600.0, 1800.0), 24 if SOAK else 3)
    write(tmp_path, day)
    used = []
    for changes, data in (({"window_s": [5300.0, 5700.0]}, None), ({}, day[530000:570001])):
        if data is not None:
            write(tmp_path, data)
        folder = write_manifest(**COMMON, **changes)
        script = (
            "import sys, json, resource; from pipeline.motions import read_motion; (m,) = read_motion(sys.argv[1]); "
            "print(json.dumps([m.samples, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]))"
        )
        done = subprocess.run([sys.executable, "-c", script, str(folder)], capture_output=True, text=True, check=True)
        samples, megabytes = json.loads(done.stdout)
        assert samples == 40001
        used.append(megabytes)
    assert used[0] < used[1] + 150.0


def test_a_day_without_a_window_is_refused_with_what_it_holds(tmp_path, write_manifest):
    write(tmp_path, np.concatenate([np.tile(shaken(3600.0), 11), shaken(3600.0, 1800.0)]))
    with pytest.raises(MotionError, match=r"more than a record.*window_s or origin_time.*2020-01-01T11:30:\d\dZ"):
        read_motion(write_manifest(**COMMON))


def test_a_gap_matters_inside_of_the_window_only(tmp_path, write_manifest):
    data = shaken(1200.0, 600.0)
    write(tmp_path, data, keep={"HNN": [(0, 300), (302, 800), (900, 1199)]})
    (with_gap,) = read_motion(write_manifest(**COMMON, window_s=[550.0, 750.0]))
    write(tmp_path, data)
    (whole,) = read_motion(write_manifest(**COMMON, window_s=[550.0, 750.0]))
    # Around the window the gap leaves less to filter, which is felt below the corner.
    assert measures(with_gap)["pgv_y"] == pytest.approx(measures(whole)["pgv_y"], rel=0.01)
    assert np.array_equal(with_gap.acceleration.shape, whole.acceleration.shape)
    for span in ([250.0, 350.0], [700.0, 850.0], [810.0, 890.0]):
        write(tmp_path, data, keep={"HNN": [(0, 300), (302, 800), (900, 1199)]})
        with pytest.raises(MotionError, match=r"HNN\.mseed: .*component y .*(gap|no samples)"):
            read_motion(write_manifest(**COMMON, window_s=span))
    with pytest.raises(MotionError, match="window_s ends at 1300 s, after the record's end at 1199 s"):
        read_motion(write_manifest(**COMMON, window_s=[550.0, 1300.0]))


def test_what_is_broken_outside_of_the_window_does_not_matter(three, write_manifest):
    """A NaN, and a spike of 100 g, far from a window of a processed record."""
    broken = tone(200000)
    spiked = tone(200000, 2.0)
    broken[100], spiked[150000] = np.nan, 1000.0
    three(x=broken, y=spiked, z=tone(200000, 0.5))
    accept = {"cut_off": "a part of a tone", "drift": "a part of a tone"}
    (motion,) = read_motion(write_manifest(window_s=[500.0, 1000.0], accept=accept))
    assert np.array_equal(motion.acceleration[0], tone(200000)[50000:100001])
    with pytest.raises(MotionError, match="has a spike, no shaking: 1 of its samples"):
        read_motion(write_manifest(window_s=[500.0, 1600.0], accept=accept))
    with pytest.raises(MotionError, match=r"is nan at sample 100 "):
        read_motion(write_manifest(window_s=[0.0, 500.0], accept=accept))


def test_a_window_of_a_text_is_cut_before_it_is_checked(tmp_path, write_manifest):
    data = shaken(600.0, 200.0) / 1000.0
    broken = data.copy()
    broken[0:200] = 300.0
    t = np.arange(data.size) / RATE
    rows = [f"{a:.2f},{x:.9g},{y:.9g},{z:.9g}" for a, x, y, z in zip(t, broken, data, 0.5 * data, strict=True)]
    head = ["# processed: yes", "time (s), HNE (m/s2), HNN (m/s2), HNZ (m/s2)"]
    (tmp_path / "a.csv").write_text("\n".join(head + rows) + "\n")
    components = {"HNE": {"axis": "x"}, "HNN": {"axis": "y"}, "HNZ": {"axis": "z"}}
    wanted = {"files": ["a.csv"], "components": components, "units": None, "processed": True}
    with pytest.raises(MotionError):
        read_motion(write_manifest(**wanted))
    (motion,) = read_motion(
        write_manifest(**wanted, window_s=[150.0, 350.0], accept={"drift": "noise that nobody filtered"})
    )
    np.testing.assert_allclose(motion.acceleration[0], data[15000:35001], rtol=1e-8)


def test_earthquakes_are_found_where_they_were_put(tmp_path):
    """To some seconds: the shaking swells and dies away over half a minute."""
    write(tmp_path, shaken(9000.0, 1000.0, 4000.0, 7000.0))
    found = earthquakes(scan(tmp_path / "HNE.mseed"))
    assert [round((one.begins - START) / 10.0) for one in found] == pytest.approx([100, 400, 700], abs=1.0)
    assert all(40.0 <= one.ends - one.begins <= 62.0 for one in found)
    write(tmp_path, shaken(9000.0))
    assert earthquakes(scan(tmp_path / "HNE.mseed")) == []


@pytest.mark.long("test_pieces_of_several_earthquakes_in_one_file")
def test_several_earthquakes_are_listed_and_one_is_chosen(tmp_path, write_manifest):
    write(tmp_path, shaken(3000.0, 500.0, 2000.0))
    folder = write_manifest(**COMMON)
    with pytest.raises(
        MotionError, match=r"holds 2 earthquakes.*00:08:2\d.*00:33:2\d.*origin_time or window_s"
    ) as refused:
        read_motion(folder)
    assert refused.value.judgement == "several"
    (folder / "manifest.toml").write_text('[site]\nname = "t"\nlatitude = 1.0\nlongitude = 1.0\n')
    told = "\n".join(entries(folder))
    assert '# origin_time = "2020-01-01T00:08:2' in told
    assert '# origin_time = "2020-01-01T00:33:2' in told
    (second,) = read_motion(write_manifest(**COMMON, origin_time="2020-01-01T00:33:10Z"))
    (same,) = read_motion(write_manifest(**COMMON, window_s=[1950.0, 2100.0]))
    assert any("that of the earthquake found there" in step for step in second.steps)
    # Other windows get other corners, both far below what shakes.
    for name in ("pga", "pgv"):
        assert measures(second)[name] == pytest.approx(measures(same)[name], rel=2e-3)
    (exact,) = read_motion(write_manifest(**COMMON, origin_time="2020-01-01T00:33:10Z", window_s=[-40.0, 110.0]))
    assert np.array_equal(exact.acceleration, same.acceleration)
    with pytest.raises(MotionError, match=r"no earthquake is found within 300 s.*00:08:2"):
        read_motion(write_manifest(**COMMON, origin_time="2020-01-01T00:20:00Z"))


def test_shaking_that_a_foreshock_began_is_of_the_earthquake_behind_it(tmp_path):
    """A foreshock 15 s before the main shock of 1200 to 1260 s; an aftershock from 1400 s is not taken in its place."""
    data = shaken(3600.0, 1200.0) + shaken(3600.0, 1400.0, size=900.0, seed=1)
    data[118500:119500] += np.round(60.0 * np.sin(2.0 * np.pi * 0.03 * np.arange(1000))).astype(np.int32)
    write(tmp_path, data)
    pieces = scan(tmp_path / "HNE.mseed")
    for origin, begins, ends in ((1198.0, 1185.0, 1262.0), (1245.0, 1400.0, 1462.0)):
        start, end = window_of([pieces], START + origin)
        assert origin + start == pytest.approx(begins - BEFORE, abs=5.0)
        assert origin + end == pytest.approx(ends + AFTER, abs=8.0)


def test_pieces_of_several_earthquakes_in_one_file(tmp_path, write_manifest):
    """As a triggered instrument writes them: a trace for each earthquake and channel."""
    spans = [(480, 600), (1980, 2100)]
    write(tmp_path, shaken(3000.0, 500.0, 2000.0), keep=dict.fromkeys(("HNE", "HNN", "HNZ"), spans))
    with pytest.raises(MotionError, match="has a gap or an overlap after sample 12000"):
        read_motion(write_manifest(**COMMON))
    (motion,) = read_motion(write_manifest(**COMMON, origin_time="2020-01-01T00:33:10Z"))
    assert 60.0 < motion.duration <= 120.0
    (folder := write_manifest(**COMMON)).joinpath("manifest.toml").write_text(
        '[site]\nname = "t"\nlatitude = 1.0\nlongitude = 1.0\n'
    )
    told = "\n".join(entries(folder))
    assert '# origin_time = "2020-01-01T00:33:2' in told or "it holds 2 earthquakes" in told or told.count("HNE") >= 2


def test_a_time_without_a_clock_chooses_nothing(tmp_path, write_manifest):
    rows = [f"{0.01 * i:.2f},{v:.6g},{v:.6g}" for i, v in enumerate(tone())]
    (tmp_path / "a.csv").write_text("\n".join(["# processed: yes", "time (s), HNE (m/s2), HNN (m/s2)", *rows]) + "\n")
    wanted = {"files": ["a.csv"], "components": {"HNE": {"axis": "x"}, "HNN": {"axis": "y"}}, "vertical": "absent"}
    with pytest.raises(MotionError, match=r"level\[0\]\.record\[0\]: origin_time: a\.csv does not say when"):
        read_motion(write_manifest(**wanted, units=None, processed=True, origin_time="2020-01-01T00:00:00Z"))


@pytest.mark.parametrize("when", ["2020-13-01T00:00:00Z", "yesterday", "2020-01-01T00:00:00+09:00", "2020-01-01"])
def test_a_time_that_is_none_is_refused(three, write_manifest, when):
    three()
    with pytest.raises(MotionError, match=r"origin_time: .* is no time"):
        read_motion(write_manifest(origin_time=when))


def test_noise_before_the_event_is_at_the_start_of_the_window(tmp_path, write_manifest):
    """Ten hours into a file nobody means the file's first seconds."""
    data = shaken(3000.0, 2000.0)
    data[:100000] += 500
    write(tmp_path, data)
    wanted = {"baseline": {"method": "pre-event"}, "pre_event_s": 40.0, "highpass_hz": "none"}
    (motion,) = read_motion(write_manifest(**COMMON, **wanted, window_s=[1950.0, 2100.0]))
    # The mean of 4,000 samples of noise of 2 mm/s2 is known to 0.03 mm/s2: four of these.
    assert np.abs(motion.acceleration[:, :4000].mean(axis=1)).max() < 1.3e-4


def test_a_scan_says_what_reading_says(tmp_path):
    """In chunks and as a whole: the same pieces, of files with gaps and of several channels in one."""
    write(tmp_path, shaken(7200.0, 500.0), keep={"HNE": [(0, 3000), (3010, 7199)]})
    names = [tmp_path / f"{code}.mseed" for code in ("HNE", "HNN", "HNZ")]
    one = tmp_path / "all.mseed"
    one.write_bytes(b"".join(name.read_bytes() for name in names))
    said = sorted((t.id, t.stats.starttime.ns, t.stats.npts) for t in obspy.read(str(one)).merge(-1))
    for chunk in (CHUNK, 64 * 512):
        parts_module.CHUNK = chunk
        try:
            found = scan(one)
            assert sorted((p.id, p.start.ns, p.samples) for p in found) == said
            for piece in found:
                (trace,) = obspy.read(str(one)).merge(-1).select(channel=piece.channel).slice(piece.start, piece.end)
                a, b = piece.start + 111.111, piece.start + 333.333
                read = piece.between(a, b)
                assert np.array_equal(read.data, whole(one, trace).between(a, b).data)
                assert read.stats.npts == 22222
        finally:
            parts_module.CHUNK = CHUNK


@pytest.mark.parametrize("seed", some(range(40), 20))
def test_damaged_continuous_data_is_refused_or_read(tmp_path, write_manifest, seed):
    """Bytes overwritten, cut out or doubled anywhere: a motion of numbers or a refusal, and nothing else."""
    write(tmp_path, shaken(600.0, 200.0))
    rng = np.random.default_rng(seed)
    raw = bytearray((tmp_path / "HNN.mseed").read_bytes())
    at, count = int(rng.integers(len(raw))), int(rng.integers(1, 2000))
    kind = seed % 4
    if kind == 0:
        raw[at : at + count] = rng.bytes(min(count, len(raw) - at))
    elif kind == 1:
        del raw[at : at + count]
    elif kind == 2:
        raw[at:at] = raw[at : at + count]
    else:
        raw[at // 512 * 512 : at // 512 * 512 + 48] = rng.bytes(48)
    (tmp_path / "HNN.mseed").write_bytes(raw)
    with contextlib.suppress(MotionError):
        (motion,) = read_motion(write_manifest(**COMMON, window_s=[150.0, 350.0]))
        assert np.isfinite(motion.acceleration).all()
        assert motion.dt == DT


def test_a_file_of_nothing_but_gaps_is_refused_in_bounded_time(tmp_path, write_manifest, monkeypatch):
    monkeypatch.setattr(parts_module, "MOST_PIECES", 50)
    write(tmp_path, shaken(600.0, 200.0))
    stream = io.BytesIO()
    for i in range(60):
        header = {"network": "XX", "station": "A", "channel": "HNN", "sampling_rate": RATE, "starttime": START + 5 * i}
        obspy.Trace(np.arange(100, dtype=np.int32), header).write(stream, format="MSEED", reclen=512)
    (tmp_path / "HNN.mseed").write_bytes(stream.getvalue())
    with pytest.raises(MotionError, match="in more than 50 pieces"):
        read_motion(write_manifest(**COMMON, window_s=[150.0, 350.0]))
