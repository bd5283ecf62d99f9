"""Heads that a logger's or a network's program prints, with their truth: unit, step, number, peak and direction."""

from __future__ import annotations

import numpy as np
import pytest

from pipeline.motions.errors import MotionError
from pipeline.motions.formats.trace_headers import FACTORS
from pipeline.motions.reading import open_traces

DT, COUNT = 0.01, 400
T = np.arange(COUNT) * DT
ROWS = np.array([peak * np.sin(2 * np.pi * f * T) * np.sin(np.pi * T / T[-1]) ** 2
                 for peak, f in ((0.095, 2.0), (0.12, 3.0), (0.06, 5.0))])  # fmt: skip
"""North, east and up, in g."""


def table(head: str, separator: str, rows: np.ndarray, quote: str = "") -> str:
    lines = [separator.join(f"{quote}{value:.7f}{quote}" for value in row) for row in np.column_stack([T, *rows])]
    return head + "\n".join(lines) + "\n"


def wrapped(head: str, row: np.ndarray, width: int, form: str) -> str:
    cells = [format(value, form) for value in row]
    return head + "\n".join("".join(cells[i : i + width]) for i in range(0, COUNT, width)) + "\n"


GAL = 980.665 * ROWS
KNOWN = {
    "channels with their direction in brackets": (
        table("Recorder: X-100\nSampling Rate: 100 sps\nUnits: g\nTime\tCh1 (N)\tCh2 (E)\tCh3 (Z)\n", "\t", ROWS),
        [("g", 0.0), ("g", 90.0), ("g", "up")],
    ),
    "azimuths before the unit": (
        table('"Time [s]","H1 (045) [g]","H2 (135) [g]","V (up) [g]"\n', ",", ROWS, '"'),
        [("g", 45.0), ("g", 135.0), ("g", "up")],
    ),
    "a title with ACC IN": (
        wrapped("STATION MUS  COMP N35W  ACC IN CM/SEC/SEC\nNPTS=400  DT=0.0100 SEC\n", GAL[0], 8, "10.4f"),
        [("cm/s2", 325.0)],
    ),
    "numbers that touch": (
        wrapped("STATION MUS  COMP N35W  ACC IN CM/SEC/SEC\nNPTS=400  DT=0.0100 SEC (8F9.4)\n", GAL[0], 8, "9.4f"),
        [("cm/s2", 325.0)],
    ),
    "the unit of the European database": (
        wrapped(
            "Component: N-S\nUnits: m/s*s\nSampling period: 0.0100 s\nNumber of data: 400\n", GAL[0] / 100, 8, "13.5e"
        ),
        [("m/s2", 0.0)],
    ),
    "an origin time that is none of K-NET's": (
        "Origin Time 18/09/2011 12:40:51\nStation Code GTK\nSampling Freq(Hz) 100Hz\nDirection N-S\n"
        "Max. Acc. (cm/sec2) 91.9\nUnit: cm/sec2\n" + "".join(f"{value:.5f}\n" for value in GAL[0]),
        [("cm/s2", None)],
    ),
}


@pytest.mark.parametrize("name", KNOWN)
def test_heads(tmp_path, name):
    content, told = KNOWN[name]
    file = tmp_path / "record.txt"
    file.write_text(content, encoding="utf-8")
    traces = open_traces(file, [])
    assert [(t.stats.kouros.units, t.stats.kouros.orientation) for t in traces] == told
    for trace, row in zip(traces, ROWS, strict=False):
        assert trace.stats.npts == COUNT
        assert trace.stats.delta == pytest.approx(DT, rel=1e-6)
        unit = FACTORS[trace.stats.kouros.units]
        assert unit * trace.data == pytest.approx(9.80665 * row, abs=2e-6)


@pytest.mark.parametrize("name", ["Acc (1)", "Acc (12)", "Ch1 (raw)", "Ch1 (V)"])
def test_what_stands_in_brackets_may_be_no_direction(tmp_path, name):
    file = tmp_path / "record.txt"
    file.write_text(table(f"Time (s),{name},Ch2,Ch3\n", ",", ROWS), encoding="utf-8")
    assert not isinstance(open_traces(file, [])[0].stats.kouros.orientation, float)


def test_an_origin_time_alone_is_no_damaged_record_of_k_net(tmp_path):
    file = tmp_path / "record.txt"
    file.write_text("Origin Time 18/09/2011\nStation GTK\n" + "".join(f"{v:.5f}\n" for v in GAL[0]), encoding="utf-8")
    with pytest.raises(MotionError, match="nothing says the time step"):
        open_traces(file, [])
