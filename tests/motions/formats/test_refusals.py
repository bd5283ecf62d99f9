"""What is refused, by which words: the file, the line, what was expected and what is there."""

from __future__ import annotations

import re

import numpy as np
import obspy
import pytest

from pipeline.motions import MotionError
from pipeline.motions.formats import FormatError
from tests.motions.formats import specimens as hand

CASES = {
    # name: content, line, words of the message
    "at2 unit": (hand.at2().replace(b"UNITS OF G", b"UNITS OF CM/S"), 3, "which is none of an acceleration"),
    "at2 short": (hand.at2()[:-40], 17, "the file ends after 58 of the 60 values"),
    "at2 long": (hand.at2() + b"1.0\r\n", 17, "more values of acceleration than the 60"),
    "at2 word": (hand.at2().replace(b"1.0000000E+00", b"one", 1), 5, "expected values of acceleration, found '"),
    "at2 overflow": (hand.at2().replace(b"1.0000000E+00", b"1.0E+999", 1), 5, "beyond all bounds"),
    "at2 step": (hand.at2().replace(b".0100 SEC", b"9.0100 SEC"), 4, "time step of 9.01 s"),
    "esm velocity": (hand.esm(DATA_TYPE="VELOCITY"), 14, "holds 'VELOCITY'"),
    "esm unit": (hand.esm(UNITS="furlong"), 10, "found 'furlong'"),
    "esm count": (hand.esm(NDATA="61"), 77, "60 of the 61 values"),
    "esm key": (hand.esm().replace(b"UNITS:", b"UNIT:"), 17, "without UNITS"),
    "esm twice": (hand.esm().replace(b"EVENT_ID:", b"UNITS:"), 10, "UNITS is given twice"),
    "esm date": (hand.esm(DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS="20190231_160919.870"), 6, "no date"),
    "geonet counts": (hand.geonet().replace(b"points  60", b"points  61", 1), 20, "line 10 says 61"),
    "geonet step": (hand.geonet().replace(b"0.010 sec", b"0.020 sec", 1), 23, "0.01 s, and line 11 one of 0.02 s"),
    "geonet field": (hand.geonet().replace(b"  100.00", b"  1OO.00", 1), 27, "10 values of acceleration of 8"),
    "csmip channel": (hand.csmip(channels=("",)).replace(b"Chan  1:", b"Channel"), 25, "'Chan  1: 360 Deg'"),
    "csmip no data": (hand.csmip(1).replace(b" Accelerogram points", b" values"), 61, "no line such as"),
    "csmip unit": (hand.csmip().replace(b"in cm/sec2", b"in ft/sec2", 1), 46, "no unit of acceleration"),
    "csmip unit unsaid": (
        hand.csmip().replace(b"in cm/sec2.", b"", 1).replace(b"Peak acc", b"High acc"), 46, "does not say the unit",
    ),
    "csmip lengths": (hand.csmip().replace(b"60 points of vel", b"56 points of vel", 1), 55, "56 samples of 0.01 s"),
    "csmip order": (hand.csmip().replace(b"of veloc", b"of accel").replace(b"/sec.", b"/sec2."), 55, "out of order"),
    "csmip end": (hand.csmip(channels=("Up",)).replace(b"/&", b"%%"), 73, "a line of data, or '/&'"),
    "csmip stars": (hand.csmip().replace(b" 100.00000", b"**********", 1), 47, "found '**********"),
    "csmip rubbish": (hand.csmip() + b"rubbish\r\n", 220, "'Corrected accelerogram'"),
    "smc spectrum": (hand.smc().replace(b"2 CORRECTED ACCELEROGRAM", b"5 RESPONSE SPECTRA"), 1, "holds response"),
    "smc short": (hand.smc().rsplit(b"\r\n", 2)[0], 37, "60 values of acceleration are announced"),
    "smc long": (hand.smc() + b"1.0000E+0\r\n" * 2, 39, "goes on after the number of values"),
    "smc orientation": (hand.smc().replace(b"component=    133", b"component=     43"), 6, "line 13 133.0"),
    "smc time goes back": (hand.smc(False, values=np.array([0.0, 1, 2, 3, 1, 5, 9, 9, 10, 1])), 30, "from 2 s to 1 s"),
    "smc odd": (hand.smc(False, values=np.array([0.0, 1, 2])), 14, "3 values make no pairs"),
    "smc long time": (hand.smc(False, values=np.array([0.0, 1, 9e4, 3])), 30, "too few to be resampled"),
    "cosmos unit": (hand.cosmos().replace(b"cm/sec2 (04)", b"deg (25)", 1), 48, "25 is no code of a unit"),
    "cosmos velocity": (hand.cosmos().replace(b"acceleration pts", b"veloc. pts").replace(b"4)", b"5)"), 1, "without"),
    "cosmos format": (hand.cosmos().replace(b"(8F10.5)", b"(free)", 1), 48, "'Format=(10I8)' or alike"),
    "cosmos wide": (hand.cosmos().replace(b"(8F10.5)", b"(99F99.5)", 1), 48, "99 columns of 99 characters"),
    "cosmos end": (hand.cosmos().rsplit(b"End-of-data", 1)[0], 171, "the file ends where 'End-of-data'"),
    "csv unit": (hand.csv("time (s),HNE (m)"), 1, "declare each column's unit"),
    "csv no unit": (hand.csv("time (s),HNE"), 1, "declare each column's unit"),
    "csv missing": (hand.csv().replace(b"0.030,", b"0.030", 1), 5, "expected 4 numbers"),
    "csv nan": (hand.csv().replace(b"100.000000", b"nan", 1), 2, "expected 4 numbers with a decimal point"),
    "csv comma": (hand.csv("time (s),A (g)", ";").replace(b"0.030;", b"0,030;", 1), 5, "expected 2 numbers"),
    "csv gap": (hand.csv().replace(b"\n0.300,", b"\n0.304,", 1), 32, "go on by 0.014 s to 0.304 s"),
    "csv processed": (hand.csv(comments="# processed: perhaps"), 1, "processed: yes, or no"),
    "csv start": (hand.csv(comments="# start: yesterday"), 1, "start: 2019-07-06"),
}  # fmt: skip
READERS = {"at2": "PEER_AT2", "csv": "MOTION_CSV"}


@pytest.mark.parametrize("case", CASES)
def test_refused(tmp_path, case):
    content, line, words = CASES[case]
    path = tmp_path / "record"
    path.write_bytes(content)
    form = case.split()[0]
    with pytest.raises(FormatError) as refusal:
        obspy.read(str(path), format=READERS.get(form, form.upper()))
    said = str(refusal.value)
    assert said.startswith(f"{path}: line {line}: "), said
    assert words in said, said
    assert re.search(r"; \S.+$", said), said


def test_a_refusal_is_a_refused_motion():
    """Exit code 4 of the command, and a ValueError for everybody else."""
    assert issubclass(FormatError, MotionError)
    assert issubclass(FormatError, ValueError)
    assert FormatError.exit_code == 4


def test_too_large_a_file_is_not_read(tmp_path):
    """A file without data blocks on the disk, of 10 GB: refused at once, without its bytes in memory."""
    path = tmp_path / "record"
    path.write_bytes(hand.at2())
    with path.open("r+b") as stream:
        stream.truncate(10_000_000_000)
    with pytest.raises(FormatError, match="larger than"):
        obspy.read(str(path), format="PEER_AT2")


def test_control_characters_of_a_header_do_not_reach_the_terminal(tmp_path):
    path = tmp_path / "record"
    path.write_bytes(hand.at2(title="\x1b[31mred\x07, 230"))
    said = obspy.read(str(path))[0].stats.kouros
    assert said.title.isprintable()
    assert said.orientation == 230.0


def test_a_text_of_another_kind_is_unknown(tmp_path):
    """A table that is no motion, and a CSV without units: no reader of Kouros takes them."""
    for content in (b"time,value\n0,1\n", b"name (s),HNE (g)\n0,1\n", b"time (s),depth (m)\n0,1\n", b"hello\n" * 50):
        path = tmp_path / "text"
        path.write_bytes(content)
        with pytest.raises(TypeError, match="Unknown format"):
            obspy.read(str(path))
