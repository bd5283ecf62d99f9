"""Records that would falsify a verdict are refused, each with its file, component and sample."""

import pickle
import subprocess
import sys

import numpy as np
import obspy
import pytest

from pipeline.cache import MOTIONS, CacheWarning
from pipeline.motions import MotionError, read_motion, read_site
from pipeline.motions.gathering import gather
from pipeline.motions.reading import open_traces
from pipeline.quantities import G

from .conftest import DT, tone


def refused(folder, *words):
    with pytest.raises(MotionError) as caught:
        read_site(folder)
    assert caught.value.exit_code == 4
    for word in words:
        assert word in str(caught.value)


def test_a_processed_record_passes_untouched(three, write_manifest):
    three()
    (motion,) = read_motion(write_manifest())
    # FLOAT64 MiniSEED holds doubles: not one bit may change.
    assert np.array_equal(motion.acceleration, [tone(), tone(amplitude=2.0), tone(amplitude=0.5)])
    assert motion.dt == DT
    assert any("no filter" in step for step in motion.steps)
    assert motion.source == "made by hand; licence: none needed"


@pytest.mark.parametrize("cut", [100, 4096 // 2, 9000])
def test_truncated_miniseed(three, write_manifest, tmp_path, cut):
    three()
    path = tmp_path / "n.mseed"
    path.write_bytes(path.read_bytes()[:-cut])
    refused(write_manifest(), "n.mseed", "cut off")


def test_a_header_without_samples_is_named_and_not_passed_over(tmp_path, write_trace):
    """obspy reads it as a trace of none, and leaves that out where pieces are put together."""
    file = write_trace("e.sac", np.zeros(0, np.float32), form="SAC")
    with pytest.raises(MotionError, match=r"e\.sac: file: holds a header and no samples"):
        open_traces(file, [])
    found = gather([tmp_path])
    assert [(one.name, one.reason) for one in found.unusable] == [
        (str(file), "file: holds a header and no samples; fetch it again")
    ]


@pytest.mark.parametrize("form", ["SLIST", "SAC"])
def test_truncated_other_formats(three, write_trace, write_manifest, tmp_path, form):
    three()
    path = write_trace("n.mseed", tone().astype(np.float32), "HNN", form)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    refused(write_manifest(), "n.mseed", "cut off")


@pytest.mark.parametrize(("form", "kind"), [("MSEED", np.float64), ("SAC", np.float32)])
def test_nan(three, write_trace, write_manifest, form, kind):
    three()
    data = tone().astype(kind)
    data[[1234, 2000]] = np.nan
    write_trace("n.mseed", data, "HNN", form)
    refused(write_manifest(), "n.mseed", "component y", "sample 1234", "nan")


def test_gap(three, write_manifest, tmp_path):
    three()
    whole = obspy.read(str(tmp_path / "z.mseed"))[0]
    start = whole.stats.starttime
    parts = obspy.Stream([whole.slice(endtime=start + 10), whole.slice(starttime=start + 12)])
    parts.write(str(tmp_path / "z.mseed"), format="MSEED")
    refused(write_manifest(), "z.mseed", "component z", "gap", "after sample 1000")


def test_pieces_that_abut_are_joined(three, write_manifest, tmp_path):
    three()
    whole = obspy.read(str(tmp_path / "z.mseed"))[0]
    start = whole.stats.starttime
    parts = obspy.Stream([whole.slice(endtime=start + 10), whole.slice(starttime=start + 10 + DT)])
    parts.write(str(tmp_path / "z.mseed"), format="MSEED")
    (motion,) = read_motion(write_manifest())
    assert np.array_equal(motion.acceleration[2], tone(amplitude=0.5))


def test_dead_channel(three, write_manifest):
    three(y=np.full(4000, 0.25))
    refused(write_manifest(), "n.mseed", "component y", "dead", "0.25")


def test_not_a_record(three, write_manifest, tmp_path):
    three()
    (tmp_path / "e.mseed").write_bytes(b"")
    refused(write_manifest(), "e.mseed")
    (tmp_path / "e.mseed").write_text("<html>please log in</html>")
    refused(write_manifest(), "e.mseed")


class _Trap:
    def __reduce__(self):
        return (exec, ("raise SystemExit('the pickle ran')",))


def test_a_pickle_is_never_opened(three, write_manifest, tmp_path):
    three()
    (tmp_path / "e.mseed").write_bytes(pickle.dumps(("obspy.core.stream", _Trap())))
    refused(write_manifest(), "e.mseed", "pickle")


def test_missing_component(three, write_manifest):
    three()
    components = {"HNE": {"axis": "x", "orientation": 90}, "HN1": {"axis": "y", "orientation": 0}}
    refused(
        write_manifest(components=components | {"HNZ": {"axis": "z", "orientation": "up"}}), "HN1", "missing", "HNN"
    )


def test_one_channel_for_two_axes(three, write_manifest):
    three()
    components = {"HNE": {"axis": "x", "orientation": 90}, "e.mseed": {"axis": "y", "orientation": 0}}
    refused(write_manifest(components=components | {"HNZ": {"axis": "z", "orientation": "up"}}), "two axes")


def test_different_time_steps(three, write_trace, write_manifest):
    three()
    write_trace("n.mseed", tone(), "HNN", sampling_rate=200.0)
    refused(write_manifest(), "n.mseed", "time step of 0.005 s")


@pytest.mark.parametrize(("factor", "units"), [(100.0, "g"), (1e-10, "m/s2"), (1000.0, "m/s2")])
def test_wrong_units_show_in_the_peak(three, write_manifest, factor, units):
    three(x=tone(amplitude=factor))
    refused(write_manifest(units=units), "wrong unit", "accept.size")


def test_a_silent_unit_is_an_error(three, write_manifest):
    three()
    refused(write_manifest(units=None), "e.mseed", "unit", "cm/s2")


@pytest.mark.parametrize(
    ("units", "factor"), [("cm/s2", 0.01), ("gal", 0.01), ("g", G), ("mg", G / 1000), ("mm/s2", 1e-3)]
)
def test_units(three, write_manifest, units, factor):
    three()
    (motion,) = read_motion(write_manifest(units=units, accept={"size": "the unit alone is tested"}))
    np.testing.assert_allclose(motion.acceleration[1], factor * tone(amplitude=2.0), rtol=1e-15)


def test_the_unit_of_the_file_speaks_for_itself(three, write_trace, write_manifest):
    three()
    for name, channel in (("e", "HNE"), ("n", "HNN"), ("z", "HNZ")):
        write_trace(f"{name}.mseed", 100.0 * tone(), channel, "SLIST", ascii={"unit": "CM/S**2"})
    (motion,) = read_motion(write_manifest(units=None))
    # Ten printed digits.
    np.testing.assert_allclose(motion.acceleration[0], tone(), atol=1e-9)
    refused(write_manifest(units="m/s2"), "the file says cm/s2, the manifest m/s2")


def test_common_span(three, write_trace, write_manifest):
    three()
    data = tone(amplitude=2.0)
    start = obspy.UTCDateTime(0)
    write_trace("n.mseed", data[150:3900], "HNN", starttime=start + 1.5)
    (motion,) = read_motion(write_manifest())
    assert motion.samples == 3750
    assert np.array_equal(motion.acceleration[0], tone()[150:3900])
    assert np.array_equal(motion.acceleration[1], data[150:3900])
    assert any("common span" in s and "x 150 at the start and 100 at the end" in s for s in motion.steps)


def test_no_common_time(three, write_trace, write_manifest):
    three()
    write_trace("n.mseed", tone(), "HNN", starttime=obspy.UTCDateTime(1000))
    refused(write_manifest(), "no common time")


def test_down_is_turned_up(three, write_manifest):
    three()
    components = {"HNE": {"axis": "x", "orientation": 90}, "HNN": {"axis": "y", "orientation": 0}}
    (motion,) = read_motion(write_manifest(components=components | {"HNZ": {"axis": "z", "orientation": "down"}}))
    assert np.array_equal(motion.acceleration[2], -tone(amplitude=0.5))


def test_wildcards_in_a_name_are_letters(three, write_manifest, tmp_path):
    three()
    (tmp_path / "e.mseed").rename(tmp_path / "[en].mseed")
    components = {"HNE": {"axis": "x", "orientation": 90}, "HNN": {"axis": "y", "orientation": 0}}
    components["HNZ"] = {"axis": "z", "orientation": "up"}
    (motion,) = read_motion(write_manifest(files=["[en].mseed", "n.mseed", "z.mseed"], components=components))
    assert np.array_equal(motion.acceleration[0], tone())


def test_scale_counts_the_larger_recorded_component(three, write_manifest):
    """Recorded at 45 and 135 degrees: the larger channel gets the PGA, whatever east and north then are."""
    three()
    components = {"HNE": {"axis": "x", "orientation": 135}, "HNN": {"axis": "y", "orientation": 45}}
    components["HNZ"] = {"axis": "z", "orientation": "up"}
    (motion,) = read_motion(write_manifest(components=components, scale_to_pga_g=0.4))
    assert np.abs(motion.along(45.0)).max() == pytest.approx(0.4 * G, rel=1e-12)
    assert np.abs(motion.acceleration[2]).max() / np.abs(tone(amplitude=0.5)).max() == pytest.approx(
        0.4 * G / np.abs(tone(amplitude=2.0)).max(), rel=1e-12
    )


def test_a_filter_or_window_that_cannot_be_names_the_key(three, write_manifest):
    three()
    refused(write_manifest(processed=False, lowpass_hz=60.0), "manifest.toml", "level[0].record[0]", "lowpass_hz")
    refused(write_manifest(window_s=[0.0, 500.0]), "level[0].record[0]", "window_s")
    refused(write_manifest(scale=100.0), "level[0].record[0]", "20 g")


def test_a_kept_motion_is_the_same_until_its_manifest_changes(three, write_manifest, tmp_path):
    """To the bit; scaled to 0.4 g its peak is that, and what is damaged is made again."""
    three()
    kept = tmp_path / "kept"
    (plain,) = read_motion(write_manifest())
    for _ in range(2):
        (motion,) = read_motion(write_manifest(), kept)
        assert motion.hash == plain.hash
        assert motion.steps == plain.steps
    assert len(list((kept / MOTIONS).iterdir())) == 1
    (scaled,) = read_motion(write_manifest(scale_to_pga_g=0.4), kept)
    assert np.abs(scaled.acceleration[:2]).max() == pytest.approx(0.4 * G, rel=1e-12)
    for file in (kept / MOTIONS).iterdir():
        file.write_bytes(file.read_bytes()[:-500])
    with pytest.warns(CacheWarning, match="its contents are not what was written"):
        (again,) = read_motion(write_manifest(), kept)
    assert again.hash == plain.hash


def test_a_kept_motion_needs_no_reader_of_records(three, write_manifest, tmp_path):
    """Reading through obspy is most of the time of a first `kouros respond`."""
    three()
    site, kept = write_manifest(), tmp_path / "kept"
    (motion,) = read_motion(site, kept)
    script = (
        "import sys; from pathlib import Path; from pipeline.motions import read_motion; "
        "(m,) = read_motion(sys.argv[1], Path(sys.argv[2])); print(m.hash, 'obspy' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(site), str(kept)], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.split() == [motion.hash, "False"]
