"""Real files whose step, unit or series was changed in one place: what else their headers say contradicts it."""

import gzip
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from pipeline.motions.errors import MotionError
from pipeline.motions.formats import agreement
from pipeline.motions.formats.record_text import FormatError, Lines
from tests.motions.conftest import tone

with warnings.catch_warnings():
    # obspy looks up its plugins in a deprecated way on some versions of Python.
    warnings.simplefilter("ignore")
    import obspy

DATA = Path(__file__).parents[2] / "data" / "motions"
LINES = Lines("record", [b"a header"])


def changed(tmp_path, name, *changes):
    text = gzip.decompress((DATA / f"{name}.gz").read_bytes())
    for old, new in changes:
        text, count = re.subn(old, new, text)
        assert count
    file = tmp_path / name
    file.write_bytes(text)
    return str(file)


@pytest.mark.parametrize(
    ("name", "changes", "said"),
    [
        # Steps that the header says once, as who mends a header by hand changes them.
        (
            "ce36456p_CE36456.V2",
            [(rb"(?i)spaced at +\.020", b"spaced at   .010"), (rb"      \.020      \.100", b"      .010      .100")],
            "line 18: says a peak at 10.94 s, and with its step of 0.01 s that is at 5.47 s",
        ),
        (
            "CHAN14.V2",
            [(rb"(?i)spaced at +\.010", b"spaced at   .020")],
            "line 18: says a peak at 3.32 s, and with its step of 0.02 s that is at 6.64 s",
        ),
        ("CE89146.V1", [(rb"at 200 pts/sec", b"at 100 pts/sec")], "line 12: says a peak at 30.59 s"),
        (
            "NP1795-n.305.v0c",
            [(rb"       5\.000000     100\.000000", b"       2.500000     100.000000")],
            "line 25: says a length of 100 s, and 20000 samples with a step of 0.0025 s have 50 s",
        ),
        (
            "20180212_211557_WPWS_20.V2A",
            [(rb"Duration 115\.98 sec", b"Duration  57.99 sec")],
            "line 10: says a length of 57.99 s, and 5800 samples with a step of 0.02 s have 116 s",
        ),
        # Peaks of another unit, as of samples that were multiplied.
        (
            "0111a.smc",
            [(rb"pk     =    104\.4", b"pk     =   1023.8")],
            "line 7: says a peak acceleration of 10.24 m/s2",
        ),
        (
            "20180212_211557_WPWS_20.V2A",
            [(rb"peak     1\.65 mm/s ", b"peak    16.20 mm/s ")],
            "line 15: says a peak velocity of 0.0162 m/s, and the samples have 0.001647 m/s",
        ),
        (
            "CHAN14.V2",
            [(rb"PEAK DISPLACEMENT =    -8\.930", b"PEAK DISPLACEMENT =   -87.600")],
            "line 20: says a peak displacement of 0.876 m, and the samples have 0.08928 m",
        ),
        (
            "NP1795-n.305.v0c",
            [(rb"985881\.000000", b" 98588.000000")],
            "line 25: says a peak reading of 9.859e+04, and the samples have 9.859e+05",
        ),
    ],
)
def test_what_a_header_says_twice_has_to_agree(tmp_path, name, changes, said):
    with pytest.raises(MotionError) as refused:
        obspy.read(changed(tmp_path, name, *changes))
    assert said in str(refused.value)


def test_a_velocity_of_another_step_is_refused():
    """The derivative of a velocity is its acceleration; with half the step it is twice as large."""
    velocity = 0.3 * tone(frequency=1.3)
    acceleration = np.gradient(velocity, 0.01)
    agreement.own_velocity(LINES, 0, acceleration, velocity, 0.01)
    with pytest.raises(FormatError, match=r"velocity changes 2 times as fast as the acceleration says, .* 0\.005 s"):
        agreement.own_velocity(LINES, 0, acceleration, velocity, 0.005)
    with pytest.raises(FormatError, match=r"changes 0\.102 times as fast"):
        agreement.own_velocity(LINES, 0, 9.81 * acceleration, velocity, 0.01)


def test_a_time_that_counts_from_another_second_tells_nothing():
    data = tone(frequency=0.7)
    at = 0.01 * float(np.argmax(np.abs(data)))
    agreement.said_time(LINES, 0, at, data, 0.01)
    agreement.said_time(LINES, 0, at + 7.3, data, 0.01)
    with pytest.raises(FormatError, match=r"with one of 0\.01 s where it says"):
        agreement.said_time(LINES, 0, at, data, 0.02)


def test_a_length_that_was_not_filled_in_tells_nothing():
    agreement.said_length(LINES, 0, 0.0, 1000, 0.01)
    # Counted from the first sample to the last, or to its end.
    agreement.said_length(LINES, 0, 9.99, 1000, 0.01)
    agreement.said_length(LINES, 0, 10.0, 1000, 0.01)
    with pytest.raises(FormatError, match=r"a length of 10 s, and 1000 samples with a step of 0\.02 s have 20 s"):
        agreement.said_length(LINES, 0, 10.0, 1000, 0.02)
