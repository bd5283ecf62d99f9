"""A processed motion that is written and read again is the same: samples, time step, and its first velocity."""

import numpy as np
import pytest

from pipeline.motions import MotionError, read_motion
from pipeline.motions.intensity import integrate, measures
from pipeline.motions.manifest import load_manifest
from pipeline.motions.record import ESTIMATED, NO_VERTICAL
from pipeline.motions.writing import write_site
from pipeline.tools.strong_motion import process
from tests.soak import some

from .conftest import DT, tone

LONG = pytest.mark.long("test_bit_for_bit")
DAILY = ("filtered", "with an estimated vertical")

N = 12000
TWO = {"e.mseed": {"axis": "x", "orientation": 90}, "n.mseed": {"axis": "y", "orientation": 0}}


def shaken(amplitude):
    quiet = 1e-4 * np.random.default_rng(7).normal(size=N)
    quiet[3000:9000] += tone(6000, amplitude)
    return quiet


CASES = {
    "as recorded": {},
    "filtered": {"processed": False, "highpass_hz": 0.2},
    "windowed": {"processed": False, "highpass_hz": 0.2, "window_s": [25.0, 100.0]},
    "windowed, not filtered": {"window_s": [41.27, 78.0], "accept": {"cut_off": "the middle of a tone"}},
    "scaled, and turned": {
        "processed": False, "highpass_hz": 0.2, "scale_to_pga_g": 0.4,
        "components": {
            "e.mseed": {"axis": "x", "orientation": 30}, "n.mseed": {"axis": "y", "orientation": 300},
            "z.mseed": {"axis": "z", "orientation": "down"},
        },
    },
    "resampled": {"processed": False, "highpass_hz": 0.2, "resample_s": 1.0 / 256.0},
    "without a vertical": {"processed": False, "files": list(TWO), "components": TWO, "vertical": "absent"},
    "with an estimated vertical": {
        "processed": False, "highpass_hz": 0.2, "window_s": [25.0, 100.0], "files": list(TWO), "components": TWO,
        "vertical": "estimated",
    },
}  # fmt: skip


@pytest.mark.parametrize("case", [pytest.param(case, marks=[] if case in DAILY else LONG) for case in some(CASES, 4)])
def test_bit_for_bit(three, write_manifest, tmp_path, case):
    three(*map(shaken, (1.0, 2.0, 0.5)))
    folder = write_manifest(**CASES[case])
    (motion,) = read_motion(folder)
    out = process(folder, tmp_path / "out", "")
    (again,) = read_motion(out)
    assert again.hash == motion.hash
    assert again.start == motion.start
    assert again.v_max == motion.v_max
    assert measures(again) == measures(motion)
    for said in (NO_VERTICAL, ESTIMATED):
        assert (said in again.steps) == (said in motion.steps)
    # And once more, from what was written.
    (third,) = read_motion(process(out.parent, tmp_path / "third", ""))
    assert (third.hash, third.start) == (motion.hash, motion.start)


def test_a_window_cut_amid_the_shaking_starts_with_its_velocity(three, write_manifest, tmp_path):
    """The velocity of the whole record at that time; without it the displacement would drift."""
    three(*map(shaken, (1.0, 2.0, 0.5)))
    (whole,) = read_motion(write_manifest())
    wanted = {"window_s": [41.27, 78.0], "accept": {"cut_off": "the middle of a tone"}}
    folder = write_manifest(**wanted)
    (again,) = read_motion(process(folder, tmp_path / "out", ""))
    np.testing.assert_allclose(integrate(again)[0], integrate(whole)[0][:, 4127:7801], atol=1e-12)
    assert max(map(abs, again.start)) > 0.01


def test_compact_files_keep_the_start_and_the_samples_to_a_millimetre(three, write_manifest, tmp_path):
    three(*map(shaken, (1.0, 2.0, 0.5)))
    folder = write_manifest(**CASES["windowed"])
    (motion,) = read_motion(folder)
    site = load_manifest(folder).site
    out = write_site(tmp_path / "out", [("design", motion)], site, licence="none", why="test", compact=True)
    (again,) = read_motion(out)
    np.testing.assert_allclose(again.acceleration, motion.acceleration, atol=1e-3)
    assert again.start == motion.start
    # Half of 1 mm/s2 in a time step, and the trapezium's two ends.
    assert np.abs(integrate(again)[0] - integrate(motion)[0]).max() < 1.1e-3 * DT


def test_a_start_is_for_processed_records(three, write_manifest):
    three()
    with pytest.raises(MotionError, match="start_m_s is for a record with processed = true"):
        read_motion(write_manifest(processed=False, start_m_s=[0.1, 0.0, 0.0]))
    (motion,) = read_motion(write_manifest(start_m_s=[0.1, -0.2, 0.0], accept={"drift": "it ends as it begins"}))
    assert motion.start == (0.1, -0.2, 0.0)
