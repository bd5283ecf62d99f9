"""The demonstration site: one real record, against peaks that were computed independently of this code."""

import shutil

import numpy as np
import pytest

from pipeline.motions import MotionError, measures, read_motion, read_site, summaries
from pipeline.motions.filtering import highpass, remove_baseline
from pipeline.motions.intensity import strong_part
from pipeline.motions.manifest import load_manifest
from pipeline.motions.processing import process
from pipeline.motions.reading import read_record
from pipeline.quantities import G
from pipeline.records import Motion
from pipeline.resources import resource

DEMO = resource("site_motions", "demo")


@pytest.fixture(scope="module")
def record():
    return load_manifest(DEMO).level[0].record[0]


@pytest.fixture(scope="module")
def recording(record):
    return read_record(DEMO, record)


@pytest.fixture(scope="module")
def site():
    return read_site(DEMO)


def test_response_removal_gives_the_known_peaks(recording):
    """0.325, 0.535, 0.388 g (E, N, Z) by full response removal; counts over sensitivity would be 4 to 12 % off.

    2 %: how far the choice of the taper's upper corner (40 to 47 Hz) moves these peaks.
    """
    assert recording.data.shape == (3, 39001)
    np.testing.assert_allclose(np.abs(recording.data).max(axis=1) / G, [0.3249, 0.5345, 0.3877], rtol=0.02)


def test_velocities_after_the_high_pass(recording):
    """21.26, 39.51, 17.38 cm/s by an independent zero-phase 0.1 Hz high-pass; 1 %: its order differs by design."""
    data, _ = remove_baseline(recording.data, recording.dt)
    data, _, _ = highpass(data, recording.dt, 0.1)
    m = measures(Motion(recording.dt, data))
    np.testing.assert_allclose([m["pgv_x"], m["pgv_y"], m["pgv_z"]], [0.2126, 0.3951, 0.1738], rtol=0.01)
    # 1.592, 3.237, 1.775 m/s were computed so, to the 1 % that the filter takes.
    np.testing.assert_allclose([m["arias_x"], m["arias_y"], m["arias_z"]], [1.592, 3.237, 1.775], rtol=0.01)


def test_the_window_changes_no_peak(recording, record):
    """Cut or whole, the velocity peaks agree to 0.5 %: what happens outside of the window does not matter."""
    plain = record.model_copy(update={"scale_to_pga_g": None})
    windowed = measures(process(recording, plain).motion)
    whole = measures(process(recording, plain.model_copy(update={"window_s": None})).motion)
    for key in ("pga_x", "pga_y", "pga_z"):
        assert windowed[key] == whole[key]
    for key in ("pgv_x", "pgv_y", "pgv_z", "pgv_resultant"):
        assert windowed[key] == pytest.approx(whole[key], rel=0.005)


def test_scaled_to_seven_tenths_of_g(site):
    m = site.levels[0].motions[0].measures
    assert m["pga"] == m["pga_y"] == pytest.approx(0.7 * G, rel=1e-14)
    # One factor for all three components: the ratios are those of the record.
    assert m["pga_x"] / m["pga_y"] == pytest.approx(0.3281 / 0.5339, rel=1e-3)


def test_steps_tell_the_whole_story(site):
    steps = " | ".join(site.levels[0].motions[0].motion.steps)
    parts = [
        "read CI.CLC..HNE.mseed",
        "response of CI.CLC.xml",
        "baseline",
        "high-pass 0.1 Hz",
        "cut to 20 s",
        "scaled",
    ]
    places = [steps.index(part) for part in parts]
    assert places == sorted(places)


def test_nobody_answers_for_it(site):
    (level,) = site.levels
    assert (level.name, level.combine, level.approved_by, level.approved_on) == ("design", "max", "", "")
    assert "SCEDC" in level.motions[0].source
    assert "10.7914/SN/CI" in level.motions[0].motion.source


def test_reading_twice_gives_the_same_motion(site):
    (again,) = read_motion(DEMO / "manifest.toml")
    assert again.hash == site.levels[0].motions[0].motion.hash


def test_summary_keeps_the_peaks(site):
    (summary,) = summaries(site.levels)
    motion = site.levels[0].motions[0].motion
    assert summary.hash == motion.hash
    assert (summary.samples, summary.dt, summary.level) == (motion.samples, motion.dt, "design")
    assert set(summary.series) == {"t", "x", "y", "z"}
    lengths = {len(values) for values in summary.series.values()}
    assert len(lengths) == 1
    assert lengths.pop() <= 600
    for row, axis in enumerate("xyz"):
        assert max(summary.series[axis]) == motion.acceleration[row].max()
        assert min(summary.series[axis]) == motion.acceleration[row].min()
    t = np.array(summary.series["t"])
    assert (np.diff(t) > 0.0).all()
    start, end = strong_part(motion)
    assert t[0] == pytest.approx(start - 5.0, abs=0.1)
    assert t[-1] == pytest.approx(end + 5.0, abs=0.1)
    # Each extreme is drawn where it happened, within a bin (here 0.09 s).
    at = np.argmax(np.abs(summary.series["y"]))
    assert t[at] == pytest.approx(np.argmax(np.abs(motion.acceleration[1])) * motion.dt, abs=0.09)


def changed(tmp_path, old, new):
    shutil.copytree(DEMO, tmp_path / "site")
    file = tmp_path / "site" / "manifest.toml"
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    return file.parent


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('axis = "x", orientation = 90', 'axis = "x", orientation = 270'),
        ('orientation = "up" }', 'orientation = "down" }'),
    ],
)
def test_the_manifest_may_not_contradict_the_station(tmp_path, old, new):
    with pytest.raises(MotionError, match="the StationXML"):
        read_site(changed(tmp_path, old, new))


def test_counts_without_a_response_are_refused(tmp_path):
    folder = changed(tmp_path, 'response = "CI.CLC.xml"', "#")
    text = (folder / "manifest.toml").read_text(encoding="utf-8")
    (folder / "manifest.toml").write_text(
        "\n".join(line for line in text.splitlines() if not line.startswith('"CI.CLC.xml"')), encoding="utf-8"
    )
    with pytest.raises(MotionError, match="neither the file nor the manifest says its unit"):
        read_site(folder)
    # Naming a unit for counts shows in the peak.
    text = (folder / "manifest.toml").read_text(encoding="utf-8")
    (folder / "manifest.toml").write_text(text.replace("processed = false", 'processed = false\nunits = "m/s2"'))
    with pytest.raises(MotionError, match="wrong unit"):
        read_site(folder)
