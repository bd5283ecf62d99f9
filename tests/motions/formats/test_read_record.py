"""A site's manifest with files of these formats: unit, orientation and processing come from the files."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from pipeline.motions import MotionError, load_manifest, read_motion
from pipeline.motions.reading import read_record
from pipeline.motions.record import Horizontal, Record, Vertical
from pipeline.quantities import G
from tests.motions.formats import specimens as hand

MELOLAND = {
    "CHAN24.V2": {"axis": "x", "orientation": 270},
    "CHAN15.V2": {"axis": "y", "orientation": 360},
    "CHAN14.V2": {"axis": "z", "orientation": "up"},
}
WEITCHPEC = {
    "HNE": {"axis": "x", "orientation": 90},
    "HNN": {"axis": "y", "orientation": 0},
    "HNZ": {"axis": "z", "orientation": "up"},
}


def site(folder, write, agency_file, files, components, **changes):
    for name in files:
        shutil.copy(agency_file(name), folder / name)
    return write(files=files, components=components, units=changes.pop("units", None), **changes)


def recording(folder):
    return read_record(folder, load_manifest(folder).level[0].record[0])


def silent(components, files, **changes):
    """A record whose manifest leaves to the files what they know; built without the manifest's own checks."""
    made = {
        key: (Vertical if c["axis"] == "z" else Horizontal).model_construct(axis=c["axis"], orientation=None)
        for key, c in components.items()
    }
    record = {
        "name": "silent", "files": tuple(files), "response": None, "components": made, "units": None, "processed": None,
        "highpass_hz": None, "sha256": {},
    }  # fmt: skip
    return Record.model_construct(**(record | changes))


def test_meloland_keeps_its_own_velocity(tmp_path, write_manifest, agency_file):
    """PGV of the agency: 90.94, 71.65 and 29.34 cm/s; integrated from rest the second is 3.5 % off."""
    folder = site(tmp_path, write_manifest, agency_file, list(MELOLAND), MELOLAND)
    found = recording(folder)
    assert found.processed
    assert found.data.shape == found.velocity.shape == (3, 5690)  # the shortest of 5694, 5690 and 5696 samples
    assert np.abs(found.velocity).max(axis=1) == pytest.approx([0.9094, 0.7165, 0.2934], abs=5.01e-5)
    assert np.abs(found.data).max(axis=1) / G == pytest.approx([0.298461, 0.311034, 0.229528], rel=2e-3)
    rest = np.abs(np.cumsum(found.data[1]) * found.dt).max()
    assert abs(rest / 0.7165 - 1.0) == pytest.approx(0.035, abs=0.002)
    (motion,) = read_motion(folder)
    assert np.abs(motion.acceleration[0]).max() / G == pytest.approx(0.298461, rel=2e-3)


def test_what_the_manifest_leaves_out_is_taken_from_the_files(tmp_path, agency_file):
    for name in MELOLAND:
        shutil.copy(agency_file(name), tmp_path / name)
    found = read_record(tmp_path, silent(MELOLAND, MELOLAND))
    assert found.azimuths == (270.0, 0.0)
    assert found.processed
    assert "processed, by the files" in found.steps
    assert "CHAN24.V2: orientation 270.0, by the file" in found.steps


def test_all_channels_of_one_file(tmp_path, write_manifest, agency_file):
    """PGA of the agency's raw and processed version of the same record."""
    for name, processed, pga in (
        ("CE89146.V1", False, (0.04529, 0.0791795, 0.021055)),
        ("CE89146.V2", True, (0.0450715, 0.0788037, 0.0209338)),
    ):
        folder = site(tmp_path, write_manifest, agency_file, [name], WEITCHPEC, processed=processed)
        found = recording(folder)
        assert np.abs(found.data).max(axis=1) / G == pytest.approx(pga, rel=2e-3)
        assert (found.velocity is not None) == processed


def test_raw_counts_by_the_sensitivity_of_the_header(tmp_path, write_manifest, agency_file):
    folder = site(tmp_path, write_manifest, agency_file, ["NP1795-n.305.v0c"], WEITCHPEC, processed=False)
    found = recording(folder)
    factor = 0.794729e-6 / 1.2 * G
    assert np.abs(found.data[0]).max() == pytest.approx(985881 * factor, rel=1e-6)
    assert any("counts to m/s2" in step for step in found.steps)
    assert any("si_factor from the header" in step for step in found.steps)


def test_counts_of_no_sensitivity_are_refused(tmp_path):
    content = hand.cosmos(0).replace(b"       2.000000", b"    -999.000000")
    (tmp_path / "a.v0c").write_bytes(content)
    with pytest.raises(MotionError, match="does not say their sensitivity"):
        read_record(tmp_path, silent(WEITCHPEC, ["a.v0c"]))


def test_what_neither_says_is_an_error(tmp_path):
    """Two columns without an orientation, and a table that does not say whether it is processed."""
    components = {"HN1": {"axis": "x"}, "HN2": {"axis": "y"}, "HNZ": {"axis": "z"}}
    (tmp_path / "a.csv").write_bytes(hand.csv("time (s),A (cm/s2),B (g),V up (g)"))
    with pytest.raises(MotionError, match=r"component x \('HN1'\): its orientation is not known.*give orientation"):
        read_record(tmp_path, silent(components, ["a.csv"]))
    (tmp_path / "a.csv").write_bytes(hand.csv("time (s),HN1 90 (cm/s2),HN2 0 (g),V up (g)"))
    with pytest.raises(MotionError, match=r"neither the manifest nor the files.*give processed"):
        read_record(tmp_path, silent(components, ["a.csv"]))
    (tmp_path / "a.csv").write_bytes(hand.csv("time (s),HN1 90 (cm/s2),HN2 0 (g),V up (g)", comments="# processed: no"))
    assert read_record(tmp_path, silent(components, ["a.csv"])).processed is False


def test_the_manifest_overrules_and_says_so(tmp_path, write_manifest):
    (tmp_path / "a.v2").write_bytes(hand.csmip())
    components = WEITCHPEC | {"HNE": {"axis": "x", "orientation": 100}, "HNN": {"axis": "y", "orientation": 10}}
    folder = write_manifest(files=["a.v2"], components=components, units="mm/s2", processed=False)
    found = recording(folder)
    assert found.azimuths == (100.0, 10.0)
    assert found.velocity is None
    assert np.abs(found.data).max() == pytest.approx(0.1, rel=1e-6)  # 100 of the manifest's mm/s2
    told = "\n".join(found.steps)
    assert "the manifest's orientation 100.0 overrules the file's 90.0" in told
    assert "the manifest's unit mm/s2 overrules the file's cm/s2" in told
    assert "the manifest says that the record is raw, and overrules its files (processed)" in told


def test_a_vertical_channel_is_no_horizontal_component(tmp_path, write_manifest):
    (tmp_path / "a.v2").write_bytes(hand.csmip())
    components = {
        "HNZ": {"axis": "x", "orientation": 90},
        "HNN": {"axis": "y", "orientation": 0},
        "HNE": {"axis": "z", "orientation": "up"},
    }
    folder = write_manifest(files=["a.v2"], components=components, units=None)
    with pytest.raises(MotionError, match="oriented 'up', which is no component x"):
        recording(folder)


def test_down_turns_the_velocity_too(tmp_path, write_manifest):
    (tmp_path / "a.v2").write_bytes(hand.csmip(channels=("360 Deg", " Down", " 90 Deg")))
    components = WEITCHPEC | {"HNZ": {"axis": "z", "orientation": "down"}}
    found = recording(write_manifest(files=["a.v2"], components=components, units=None))
    assert found.data[2, 0] == pytest.approx(-1.0)
    assert found.velocity[:, 0] == pytest.approx([0.09, 0.09, -0.09])


def test_a_damaged_file_is_refused_by_file_and_line(tmp_path, write_manifest):
    (tmp_path / "a.v2").write_bytes(hand.csmip()[:9000])
    folder = write_manifest(files=["a.v2"], components=WEITCHPEC, units=None)
    with pytest.raises(MotionError, match=r"a\.v2: line \d+: .*; .*fetch the file again"):
        recording(folder)
