"""Bare columns of numbers: time at even steps, then one acceleration or three, and not a word on their units.

Which unit, which orientation, and whether raw or processed, the manifest must say.

source : no agency's; what programs print
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from pipeline.motions.formats import blocks, cwa, irregular, record_text, trace_headers
from pipeline.motions.formats.record_text import Lines, Source

_NUMBER = re.compile(r"^[+-]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[Ee][+-]?\d{1,3})?$")
_LEAST_ROWS, _MOST_COLUMNS = 5, 4
_MOST_COMMENTS = 100


def is_format(source: Source) -> bool:
    """Whether a source is such columns: only numbers, the first of each row a time that goes on evenly."""
    text = record_text.head(source)
    # The last line of what was read may be half of one.
    lines = text.splitlines() if len(text) < record_text.HEAD else text.splitlines()[:-1]
    rows = [_split(line) for line in lines[_top(lines) :] if line.strip()]
    # Taiwan's header is all comments, and columns follow it.
    if cwa.is_format(source) or len(rows) < _LEAST_ROWS or not 2 <= len(rows[0]) <= _MOST_COLUMNS:
        return False
    if any(len(row) != len(rows[0]) or not all(_NUMBER.match(cell) for cell in row) for row in rows):
        return False
    times = np.array([float(row[0]) for row in rows])
    return bool(np.isfinite(times).all()) and irregular.even_step(times, _digit([row[0] for row in rows])) is not None


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of columns, one for each after the time; the file says no unit (`units` is "")."""
    top = _top([lines.text(index) for index in range(min(len(lines), _MOST_COMMENTS + 1))])
    text = lines.text(top, "the first row of numbers")
    columns = len(_split(text))
    if not 2 <= columns <= _MOST_COLUMNS:
        raise lines.error(top, f"expected 2 to {_MOST_COLUMNS} numbers, found {record_text.shown(text)}")
    table = blocks.rows(lines, top, columns, "time and acceleration", _separator(text))
    first = [lines.text(index) for index in range(top, min(top + 20, len(lines)))]
    dt = irregular.even_step(table[:, 0], _digit([_split(line)[0] for line in first if _split(line)]))
    if dt is None:
        raise lines.error(*_uneven(top, table[:, 0]), "give equal time steps: resample the record first")
    blocks.step(lines, top, dt)
    return [
        trace_headers.make_trace(
            lines,
            data=table[:, number].copy(),
            dt=dt,
            form="columns",
            units="",
            si_factor=None,
            direction=None,
            processed=None,
            location=f"{number:02d}",
            channel=trace_headers.channel_code(1.0 / dt, None, number),
            headonly=headonly,
        )
        for number in range(1, columns)
    ]


def _uneven(top: int, times: Any) -> tuple[int, str]:
    steps = np.diff(times)
    worst = int(np.argmax(np.abs(steps - np.median(steps)))) + 1
    return top + worst, f"time {times[worst]:g} s is off the even step of {np.median(steps):g} s"


def _top(lines: list[str]) -> int:
    plain = (i for i, line in enumerate(lines[:_MOST_COMMENTS]) if line.strip() and line.lstrip()[0] not in "#%")
    return next(plain, 0)


def _separator(text: str) -> bytes | None:
    return next((mark.encode() for mark in ",;" if mark in text), None)


def _split(line: str) -> list[str]:
    separator = _separator(line)
    return [cell.strip() for cell in line.split(separator.decode())] if separator else line.split()


def _digit(cells: list[str]) -> float:
    # One in the last printed place, of the time that is printed finest.
    digits = 0
    for cell in cells:
        mantissa, _, power = cell.lower().partition("e")
        shift = int(power) if re.fullmatch(r"[+-]?\d{1,3}", power) else 0
        digits = max(digits, len(mantissa.partition(".")[2]) - shift)
    return float(10.0 ** -min(digits, 15))


read_format = record_text.reader(_traces)
