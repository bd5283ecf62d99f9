"""Tables of any program made records: the values, the unit and the orientation that come back through obspy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import obspy
import pytest

from pipeline.motions import MotionError
from pipeline.motions.converting import convert
from tests.motions.formats.specimens import tone

NS, EW, UD = 100.0 * tone(), -50.0 * tone(), 25.0 * tone()


def table(tmp_path: Path, separator: str, head: str = "", times: bool = True, comma: bool = False) -> Path:
    rows = [
        separator.join(([f"{0.01 * i:.2f}"] if times else []) + [f"{value:.4f}" for value in row])
        for i, row in enumerate(zip(NS, EW, UD, strict=True))
    ]
    text = "\n".join(rows) + "\n"
    path = tmp_path / "shake.txt"
    path.write_text(head + (text.replace(".", ",") if comma else text))
    return path


@pytest.mark.parametrize("separator", [",", "; ", "\t", "   ", ", "])
@pytest.mark.parametrize("head", ["", "Logger 7, 2024\nN E Z\n\n"])
def test_what_went_in_comes_out(tmp_path, separator, head):
    done = convert(
        table(tmp_path, separator, head), ["time", "ns", "ew", "ud"], "gal", tmp_path / "out", processed=False
    )
    stream = obspy.read(str(done.file))
    assert [trace.stats.kouros.orientation for trace in stream] == [0.0, 90.0, "up"]
    for trace, values in zip(stream, (NS, EW, UD), strict=True):
        assert (trace.stats.kouros.units, trace.stats.kouros.processed) == ("gal", False)
        assert trace.stats.delta == pytest.approx(0.01, rel=1e-12)
        assert trace.data.tolist() == [float(f"{value:.4f}") for value in values]
    assert done.peaks == pytest.approx((1.0, 0.5, 0.25))


@pytest.mark.parametrize("separator", [";", "\t", "  "])
def test_decimal_commas(tmp_path, separator):
    done = convert(table(tmp_path, separator, comma=True), ["time", "ns", "ew", "ud"], "gal", tmp_path / "out")
    assert np.abs(obspy.read(str(done.file))[1].data - EW).max() <= 5.01e-5
    assert "commas are decimal commas" in done.steps


def test_without_a_time(tmp_path):
    file = table(tmp_path, " ", times=False)
    done = convert(file, ["h1", "-", "v"], "g", tmp_path / "out", dt=0.005, orientation=["30", "down"])
    first, second = obspy.read(str(done.file))
    assert (first.stats.delta, first.stats.kouros.orientation) == (0.005, 30.0)
    assert (second.stats.kouros.orientation, second.stats.kouros.processed) == ("down", None)
    assert np.abs(second.data - UD).max() <= 5.01e-5


def test_irregular_times_are_resampled_where_a_step_is_given(tmp_path):
    """A straight line stays one whatever its times."""
    path = tmp_path / "line.txt"
    times = np.array([0.0, 0.013, 0.02, 0.031, 0.047, 0.06, 0.08, 0.1])
    path.write_text("".join(f"{t:.3f} {3.0 * t:.6f}\n" for t in times))
    with pytest.raises(MotionError, match="off the even step"):
        convert(path, ["time", "ns"], "m/s2", tmp_path / "out")
    done = convert(path, ["time", "ns"], "m/s2", tmp_path / "out", dt=0.01)
    (trace,) = obspy.read(str(done.file))
    assert trace.data == pytest.approx(3.0 * trace.times(), abs=1e-9)
    assert "resampled" in done.steps[-1]


def test_a_dry_run_writes_nothing_and_nothing_is_overwritten(tmp_path):
    file, out = table(tmp_path, ","), tmp_path / "out"
    done = convert(file, ["time", "ns", "ew", "ud"], "gal", out, dry_run=True)
    assert not out.exists()
    convert(file, ["time", "ns", "ew", "ud"], "gal", out)
    with pytest.raises(MotionError, match="nothing is overwritten"):
        convert(file, ["time", "ns", "ew", "ud"], "gal", out)
    assert done.file.exists()


REFUSED = {
    "unit": (["time", "ns", "ew", "ud"], "furlong", {}, "no unit that is known"),
    "count": (["time", "ns", "ew"], "gal", {}, "lines has 3 numbers"),
    "twice": (["time", "ns", "ns", "ud"], "gal", {}, "names no component, one twice"),
    "times": (["time", "t", "ns", "ud"], "gal", {}, "or two times"),
    "no time": (["-", "ns", "ew", "ud"], "gal", {}, "no column is the time"),
    "step": (["-", "ns", "ew", "ud"], "gal", {"dt": 100.0}, "is none that a record can have"),
    "other step": (["time", "ns", "ew", "ud"], "gal", {"dt": 0.02}, "has a step of 0.01 s, and --dt says 0.02 s"),
    "name": (["time", "x", "ew", "ud"], "gal", {}, "'x' says no orientation"),
    "orientations": (["time", "a", "b", "c"], "gal", {"orientation": ["0", "90"]}, "2 orientations for 3 components"),
    "orientation": (["time", "a", "b", "c"], "gal", {"orientation": ["0", "90", "?"]}, "'?' says no orientation"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(tmp_path, case):
    columns, unit, options, words = REFUSED[case]
    with pytest.raises(MotionError) as refusal:
        convert(table(tmp_path, ","), columns, unit, tmp_path / "out", **options)
    assert words in str(refusal.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("find", "put", "words"),
    [
        ("0.30,", "0.30;", "line 31: expected 4 numbers"),
        ("0.30,", "1e999,", "line 31"),
        ("\n0.30,", "\n0.34,", "0.34 s"),
    ],
)
def test_a_bad_row_is_named(tmp_path, find, put, words):
    path = table(tmp_path, ",")
    path.write_text(path.read_text().replace(find, put, 1))
    with pytest.raises(MotionError, match=words):
        convert(path, ["time", "ns", "ew", "ud"], "gal", tmp_path / "out")


def test_a_dead_column_is_refused(tmp_path):
    path = tmp_path / "dead.txt"
    path.write_text("".join(f"{0.01 * i:.2f},{i % 7},0\n" for i in range(50)))
    with pytest.raises(MotionError, match="'ew': is dead"):
        convert(path, ["time", "ns", "ew"], "gal", tmp_path / "out")


def test_one_component_of_several_numbers_a_row_is_read_on(tmp_path):
    """Seven numbers a row, the last row shorter, under a head that says nothing."""
    rows = [" ".join(f"{value:.4f}" for value in NS[i : i + 7]) for i in range(0, len(NS), 7)]
    (tmp_path / "a.txt").write_text("\n".join(["A station", *rows]) + "\n")
    done = convert(tmp_path / "a.txt", ["ns"], "gal", tmp_path / "out", dt=0.01)
    (trace,) = obspy.read(str(done.file))
    assert trace.data.tolist() == [float(f"{value:.4f}") for value in NS]
    assert "the 7 numbers of a row are read on as one series" in done.steps
