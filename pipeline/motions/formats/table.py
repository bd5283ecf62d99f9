"""Plain CSV with declared units: a column of time and one or more columns of acceleration.

The header row names each column with its unit in parentheses or brackets; a channel's name may end in its orientation::

    # processed: no
    # station: XX.TEST
    # start: 2019-07-06T03:19:53Z
    time (s), H1 90 deg (g), H2 360 (g), V up (g)
    0.000, 0.0012, -0.0003, 0.0004

Comma, semicolon, tab or blanks between the columns, equal time steps; decimal commas where no comma parts columns.  A
SEED code (HNE) states its orientation by itself, and so do the names NS, EW and UD, also as acc_NS, and what `labels`
knows of other languages; a time without a unit is in seconds.  The lines with # are optional, and what they do not say,
the file does not say.  K-NET CSV has its own head, see `nied`.
"""

from __future__ import annotations

import re
from array import array
from dataclasses import replace
from typing import Any

import numpy as np

from pipeline.motions.formats import agreement, blocks, irregular, labels, nied, record_text, trace_headers, unit_words
from pipeline.motions.formats.record_text import Lines, Source
from pipeline.motions.formats.trace_headers import FACTORS, Orientation
from pipeline.quantities import Array

_CELL = re.compile(r'^\s*"?\s*([^()\[\]"]{1,60}?)\s*[(\[]\s*([^()\[\]"]{1,20}?)\s*[)\]]\s*"?\s*$')
_BARE = re.compile(r'^\s*"?\s*(time|t)\s*"?\s*$', re.IGNORECASE)
_WORD = re.compile(rb"[^\s()\[\]]+[ \t]*(?:[(\[][^()\[\]]*[)\]])?")
_TIME = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 0.001}
_KEY = re.compile(r"^#\s*(processed|station|start)\s*:\s*(.*)$", re.IGNORECASE)
_START = re.compile(r"^(\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d):(\d\d(?:\.\d{1,6})?)Z?$")
_STATION = re.compile(r"^(?:(\w{1,8})\.)?(\w{1,8})$")
_SAID = {"yes": True, "true": True, "no": False, "false": False}
_NUMBER = rb"[ \t]*[+-]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[EeDd][+-]?\d{1,3})?[ \t]*"
_MOST_COMMENTS = 100
_MOST_COLUMNS = 100


def is_format(source: Source) -> bool:
    """Whether a source is such a table: its first row names a time and only accelerations, each with a known unit.

    K-NET CSV is one as well.
    """
    if nied.is_format(source):
        return True
    rows = record_text.parted(record_text.head(source))[:_MOST_COMMENTS]
    for index, line in enumerate(rows):
        if line.strip() and not line.startswith("#"):
            cells = _cells(line.encode("latin-1"))
            if any(":" in row for row in rows[index + 1 : index + 2]):
                # A clock: `columns` knows its forms.
                return False
            return len(cells) >= 2 and all(cell is not None for cell in cells) and _is_table([c for c in cells if c])
    return False


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of a table, one a column."""
    if nied.is_first(lines):
        return nied.traces(lines, headonly)
    top, keys = _top(lines)
    row = lines.lines[top]
    named = _cells(row)
    cells = [cell for cell in named if cell is not None]
    if len(cells) != len(named) or not _is_table(cells):
        wrong = f"expected 'time (s), name (unit), ...' with units of {', '.join(FACTORS)}, found"
        raise lines.error(top, f"{wrong} {record_text.shown(lines.text(top))}", "declare each column's unit")
    if len(cells) > _MOST_COLUMNS:
        raise lines.error(top, f"{len(cells)} columns are more than a record has", "split it by stations")
    lines = _with_points(_unquoted(lines, top + 1), top + 1, _separator(row))
    table = _numbers(lines, top + 1, _separator(row), len(cells))
    dt = _step(lines, top + 1, _TIME[cells[0][1]] * table[:, 0], _TIME[cells[0][1]])
    _agree(lines, top, dt, table[:, 1:].T, [unit for _, unit in cells[1:]])
    timed = _BARE.match(record_text.printable(_parts(row)[0])) is None
    processed, network, station, when = _facts(lines, keys)
    traces = []
    for number, (name, unit) in enumerate(cells[1:], start=1):
        code, direction = _channel(name)
        traces.append(
            trace_headers.make_trace(
                lines,
                data=table[:, number].copy(),
                dt=dt,
                form="CSV",
                units=unit,
                si_factor=FACTORS[unit],
                direction=direction,
                processed=processed,
                network=network,
                station=station,
                location=f"{number:02d}",
                channel=code or trace_headers.channel_code(1.0 / dt, direction, number),
                start=when,
                start_is="unknown" if when is None else "record",
                headonly=headonly,
                more={"column": name} | ({} if timed else {"notes": "its time has no unit and is taken as seconds"}),
            )
        )
    return traces


def _unquoted(lines: Lines, start: int) -> Lines:
    """The same without the quotes that programs put around every cell."""
    if start >= len(lines) or b'"' not in lines.lines[start]:
        return lines
    return replace(lines, lines=lines.lines[:start] + [line.replace(b'"', b"") for line in lines.lines[start:]])


def _with_points(lines: Lines, start: int, separator: bytes | None) -> Lines:
    """The same with points for the commas of numbers, where something else parts the columns and no number has one."""
    if separator in {None, b","} or start >= len(lines):
        return lines
    first = lines.lines[start]
    if b"." in first or not re.search(rb"\d,\d", first):
        return lines
    return replace(lines, lines=lines.lines[:start] + [line.replace(b",", b".") for line in lines.lines[start:]])


def _separator(row: bytes) -> bytes | None:
    most = max((b",", b";", b"\t"), key=row.count)
    return most if most in row else None


def _parts(row: bytes) -> list[bytes]:
    row = row.removeprefix(b"\xef\xbb\xbf")
    separator = _separator(row)
    # Between blanks, a cell is a word with its unit; whatever else stands there belongs to none.
    if separator is None:
        return _WORD.findall(row) if not _WORD.sub(b"", row).strip() else [row]
    return row.split(separator)


def _cells(row: bytes) -> list[tuple[str, str] | None]:
    cells: list[tuple[str, str] | None] = []
    for cell in _parts(row):
        text = cell.decode("utf-8", errors="replace")
        found = _CELL.match(text) if text.isprintable() or b"\t" in cell else None
        unit = found[2].strip().lower() if found else ""
        if not cells and (bare := _BARE.match(text)):
            cells.append((bare[1], "s"))
        else:
            cells.append((found[1], unit_words.unit_of(unit)[1] or unit) if found else None)
    return cells


def _is_table(cells: list[tuple[str, str]]) -> bool:
    first = len(cells) >= 2 and cells[0][0].lower() in {"time", "t"} and cells[0][1] in _TIME
    return (
        first
        and not any(labels.spectral(name) for name, _ in cells[1:])
        and all(unit in FACTORS for _, unit in cells[1:])
    )


def _top(lines: Lines) -> tuple[int, dict[str, tuple[int, str]]]:
    keys: dict[str, tuple[int, str]] = {}
    for index in range(min(len(lines), _MOST_COMMENTS)):
        text = lines.text(index)
        if found := _KEY.match(text):
            if found[1].lower() in keys:
                raise lines.error(index, f"{found[1]} is given twice")
            keys[found[1].lower()] = (index, found[2].strip())
        elif text.strip() and not text.startswith("#"):
            return index, keys
    raise lines.error(min(len(lines), _MOST_COMMENTS), "expected a row such as 'time (s), HNE (cm/s2)'")


def _numbers(lines: Lines, start: int, separator: bytes | None, columns: int) -> Array:
    if separator is None:
        return blocks.rows(lines, start, columns, "time and acceleration")
    # The whole row at once: a value that is missing is found in its line, and does not shift the values after it.
    row = re.compile(_NUMBER + (re.escape(separator) + _NUMBER) * (columns - 1))
    values = array("d")
    end = len(lines)
    while end > start and not lines.lines[end - 1].strip(b" \t\0\x1a"):
        end -= 1
    for index in range(start, end):
        line = lines.lines[index]
        if row.fullmatch(line) is None:
            wrong = f"expected {columns} numbers with a decimal point, found {record_text.shown(lines.text(index))}"
            raise lines.error(index, wrong)
        # Fortran writes exponents of double precision with a D.
        values.extend(map(float, line.upper().replace(b"D", b"E").split(separator)))
    blocks.samples(lines, start, end - start)
    table = np.array(values).reshape(-1, columns)
    if not np.isfinite(table).all():
        bad = start + int(np.flatnonzero(~np.isfinite(table).all(axis=1))[0])
        raise lines.error(bad, "holds a number beyond all bounds")
    return table


def _step(lines: Lines, start: int, times: Array, unit: float) -> float:
    dt = float(times[-1] - times[0]) / (len(times) - 1)
    blocks.step(lines, start, dt)
    # Times may be rounded to what is printed, not more: 1/128 s comes as 0.008, 0.016, 0.023.
    decimals = max(len(line.split()[0].partition(b".")[2]) for line in map(_first, lines.lines[start : start + 20]))
    digit = unit * 10.0 ** -min(decimals, 15) + 2e-9 * abs(float(times[-1]))
    rate = round(1.0 / dt)
    if rate > 0 and abs(1.0 / rate - dt) * (len(times) - 1) <= 1.02 * digit:
        dt = 1.0 / rate
    off = np.abs(times - (times[0] + dt * np.arange(len(times))))
    late = off > irregular.rounding(digit, dt, times)
    if late.any():
        worst, wrong, remedy = irregular.off_step(times)
        raise lines.error(start + worst, wrong, remedy)
    return dt


def _agree(lines: Lines, top: int, dt: float, data: Array, units: list[str]) -> None:
    """Hold what the lines before the names say of step, unit, number and peak against names and numbers."""
    head = labels.read_head(lines, top, 0, None)
    if head.step is not None:
        trace_headers.said_step(lines, head.at["step"], head.step, dt)
    if head.count is not None:
        trace_headers.said_count(lines, head.at["count"], head.count, data.shape[1])
    if head.length is not None:
        agreement.told_length(lines, head.at["length"], head.length, data.shape[1], dt)
    if head.kind == "acceleration":
        trace_headers.said_unit(lines, head.at["unit"], head.unit, units)
    if head.peak is not None:
        in_si = np.array([FACTORS[unit] for unit in units])[:, None] * data
        trace_headers.said_peak(lines, head.at["peak"], *head.peak, in_si, 1.0)


def _first(line: bytes) -> bytes:
    # What stands before the first separator: its decimals tell how finely the times are printed.
    found = re.match(rb"[ \t]*([+-]?[0-9.]+)", line)
    return found[1] if found else b"0"


def _channel(name: str) -> tuple[str, Orientation]:
    code, _, said = name.partition(" ")
    seed = code if re.fullmatch(r"[A-Z]{2}[A-Z0-9]", code) else ""
    if said.strip():
        return seed, trace_headers.orientation(said)
    words = labels.HeadColumn(name, "", "").orientation
    return seed, words if labels.points(words) else None


def _facts(lines: Lines, keys: dict[str, tuple[int, str]]) -> tuple[bool | None, str, str, Any]:
    at, word = keys.get("processed", (0, ""))
    if word and word.lower() not in _SAID:
        raise lines.error(at, f"expected processed: yes, or no, found {record_text.shown(word)}")
    processed = _SAID.get(word.lower())
    at, word = keys.get("station", (0, ""))
    station = _STATION.match(word)
    if word and station is None:
        raise lines.error(at, f"expected station: NETWORK.STATION, found {record_text.shown(word)}")
    at, word = keys.get("start", (0, ""))
    start = _START.match(word)
    if word and start is None:
        raise lines.error(at, f"expected start: 2019-07-06T03:19:53Z, found {record_text.shown(word)}")
    when = None if start is None else trace_headers.start_time(lines, at, *map(float, start.groups()))
    return processed, (station[1] or "") if station else "", station[2] if station else "", when


read_format = record_text.reader(_traces)
