"""Any table of numbers, with a person's word on its columns, to a file that says all of it by itself."""

from __future__ import annotations

import re
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.motions.errors import refusal
from pipeline.motions.formats import blocks, irregular, labels, record_text, trace_headers
from pipeline.motions.formats import columns as text_columns
from pipeline.motions.formats.record_text import FormatError, Lines
from pipeline.motions.formats.trace_headers import FACTORS, Orientation
from pipeline.quantities import Array
from pipeline.resources import replacing

_NUMBER = re.compile(r"^[+-]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[EeDd][+-]?\d{1,3})?$")
_DECIMAL = re.compile(r"(?<=\d),(?=\d)")
_SKIPPED = {"-", "skip"}
_TIMES = {"time": 1.0, "t": 1.0, "time_ms": 0.001}
_NAMES: dict[str, Orientation] = {
    "ns": 0.0, "n": 0.0, "sn": 180.0, "ew": 90.0, "e": 90.0, "we": 270.0, "ud": "up", "u": "up", "z": "up", "v": "up",
    "up": "up", "down": "down", "du": "down",
}  # fmt: skip
_MOST_HEAD, _MOST_COLUMNS = 200, 100


@dataclass(frozen=True)
class Converted:
    """A table that was made a record's file.

    Attributes
    ----------
    file : Path
        The file that was, or would be, written.
    samples, dt : int, float
        Of each component, and the time step in s.
    components : tuple of (str, float or str)
        Each column's name, and its orientation: degrees clockwise from north, "up" or "down".
    peaks : tuple of float
        The largest absolute acceleration of each, in m/s2.
    steps : tuple of str
        What was taken for granted or done to the numbers.
    """

    file: Path
    samples: int
    dt: float
    components: tuple[tuple[str, float | str], ...]
    peaks: tuple[float, ...]
    steps: tuple[str, ...]


def convert(
    file: Path,
    columns: Sequence[str],
    unit: str,
    out: Path,
    *,
    dt: float | None = None,
    orientation: Sequence[str] = (),
    processed: bool | None = None,
    dry_run: bool = False,
) -> Converted:
    """Write a table's accelerations as CSV with unit, orientation and step in its head, as `formats.table` reads it.

    Parameters
    ----------
    file : Path
        A text whose rows, after any head, are numbers between commas, semicolons, tabs or blanks; with a decimal point,
        or a decimal comma where commas do not part the columns.
    columns : sequence of str
        What each column is: "time" (s) or "time_ms", "ns", "ew", "ud" and their like, any other name for a component
        whose orientation is given, "-" for what is left out.  One alone of rows of several numbers: they are read on.
    unit : str
        Of all components; one of `formats.trace_headers.FACTORS`.
    out : Path
        Folder of the new file, which is called as the old one; made where there is none.
    dt : float or None
        Step in s, where no column is the time; where times are irregular, the step that they are resampled to.
    orientation : sequence of str
        Of each component in order, "up", "down" or degrees clockwise from north; left out, the names say it.
    processed : bool or None
        Whether an agency has filtered it; None leaves that to the manifest.
    dry_run : bool
        Read and check, and write nothing.

    Returns
    -------
    Converted

    Raises
    ------
    MotionError
        Naming file, line, column or what was left unsaid.
    """
    if unit not in FACTORS:
        raise refusal(file, "--unit", f"{unit[:20]!r} is no unit that is known", f"give one of {', '.join(FACTORS)}")
    named = [name.strip().lower() for name in columns]
    parts = [(number, name) for number, name in enumerate(named) if name not in _SKIPPED and name not in _TIMES]
    clocks = [(number, name) for number, name in enumerate(named) if name in _TIMES]
    if not parts or len(clocks) > 1 or len(named) > _MOST_COLUMNS or len({name for _, name in parts}) < len(parts):
        wrong = f"{','.join(named)[:60]!r} names no component, one twice, or two times"
        raise refusal(
            file, "--columns", wrong, "name each column once, such as time,ns,ew,ud, and - for what is not one"
        )
    turned = _orientations(file, [name for _, name in parts], orientation)
    lines = record_text.open_lines(file)
    table, top, steps = _numbers(lines, len(named))
    _check_head(lines, top, len(named), [number for number, _ in parts], unit, dt)
    if clocks:
        number, clock = clocks[0]
        data, step, told = _timed(lines, top, _TIMES[clock] * table[:, number], table[:, [n for n, _ in parts]], dt)
        steps += told
    elif dt is None:
        raise refusal(file, "--dt", "no column is the time", "give the step in seconds, such as --dt 0.01")
    else:
        data, step = table[:, [n for n, _ in parts]], dt
    if not blocks.STEP_LEAST <= step <= blocks.STEP_MOST:
        raise refusal(file, "--dt", f"a time step of {step:g} s is none that a record can have", "give it in seconds")
    dead = next((name for (_, name), row in zip(parts, data.T, strict=True) if np.ptp(row) == 0.0), None)
    if dead is not None:
        raise refusal(file, f"column {dead!r}", "is dead: every row is the same", "leave it out by - in --columns")
    target = out / f"{file.stem}.csv"
    if target.exists():
        raise refusal(target, "file", "is there already, and nothing is overwritten", "choose another folder")
    codes = [trace_headers.channel_code(1.0 / step, turn, i) for i, turn in enumerate(turned, start=1)]
    if not dry_run:
        out.mkdir(parents=True, exist_ok=True)
        with replacing(target) as aside:
            aside.write_text(_text(data, step, codes, turned, unit, processed), encoding="ascii")
    return Converted(
        file=target,
        samples=len(data),
        dt=step,
        components=tuple((name, turn) for (_, name), turn in zip(parts, turned, strict=True)),
        peaks=tuple(float(FACTORS[unit] * np.abs(row).max()) for row in data.T),
        steps=tuple(steps),
    )


def _orientations(file: Path, names: list[str], given: Sequence[str]) -> list[float | str]:
    if given and len(given) != len(names):
        wrong = f"gives {len(given)} orientations for {len(names)} components ({', '.join(names)})"
        raise refusal(file, "--orientation", wrong, "give one for each, in the order of the columns")
    turned: list[float | str] = []
    for name, word in zip(names, given or names, strict=True):
        said = trace_headers.orientation(word) if given else _NAMES.get(name)
        if not isinstance(said, float) and said not in {"up", "down"}:
            wrong = f"{word[:20]!r} says no orientation of {name[:20]!r}"
            raise refusal(file, "--orientation", wrong, "give up, down or degrees from north, such as 30,120,up")
        turned.append(said)
    return turned


def _numbers(lines: Lines, columns: int) -> tuple[Array, int, list[str]]:
    """The rows as a table, or where one column is named and a row has several numbers, all of them as one series."""
    found = ((i, how) for i in range(min(len(lines), _MOST_HEAD)) if (how := _form(lines.text(i), columns)))
    top, form = next(found, (0, None))
    if form is None and columns == 1 and (wrapped := text_columns.series(lines)):
        values, top, width = wrapped
        row = lines.text(top).split()
        counted = len(row) == width + 1
        told = [f"{top} lines before the first row of numbers were passed over"] if top else []
        told += ["the last number of each row counts the rows, and is left out"] if counted else []
        return values[:, None], top, [*told, f"the {width} numbers of a row are read on as one series"]
    if form is None:
        wrong = f"none of the first {min(len(lines), _MOST_HEAD)} lines has {columns} numbers"
        raise lines.error(0, wrong, "name every column in --columns, with - for what is not used")
    end = len(lines)
    while end > top and not lines.lines[end - 1].strip(b" \t\0\x1a"):
        end -= 1
    separator, comma = form
    numbers = array("d")
    for index in range(top, end):
        cells = _cells(lines.text(index), separator, comma)
        if len(cells) != columns or not all(_NUMBER.match(cell) for cell in cells):
            raise lines.error(index, f"expected {columns} numbers, found {record_text.shown(lines.text(index))}")
        numbers.extend(float(cell.translate(_EXPONENT)) for cell in cells)
    blocks.samples(lines, top, end - top)
    table = np.array(numbers).reshape(-1, columns)
    if not np.isfinite(table).all():
        bad = top + int(np.flatnonzero(~np.isfinite(table).all(axis=1))[0])
        raise lines.error(bad, "holds a number beyond all bounds")
    head = [f"{top} lines before the first row of numbers were passed over"] if top else []
    return table, top, head + (["commas are decimal commas"] if comma else [])


def _check_head(lines: Lines, top: int, width: int, chosen: Sequence[int], unit: str, dt: float | None) -> None:
    """Refuse what the lines before the numbers say otherwise: no acceleration, another unit, another step."""
    form = _form(lines.text(top), width)
    try:
        head = labels.read_head(lines, top, width, form[0] if form else None)
    except FormatError:
        return  # it contradicts itself, and a person has said what holds
    for number in chosen:
        named = bool(head.columns) and bool(head.columns[number].kind)
        kind = head.columns[number].kind if named else head.kind
        said = head.columns[number].unit if named else head.unit
        at = head.at.get("columns" if named else "unit", 0)
        line = f"{record_text.shown(lines.text(at))}"
        if kind in {"velocity", "displacement", "a spectrum"}:
            wrong = f"says that the numbers are {kind} ({line}), no acceleration"
            raise lines.error(at, wrong, "give the file of the acceleration, or mend that line where it is wrong")
        if said in FACTORS and FACTORS[said] != FACTORS[unit]:
            raise lines.error(
                at, f"says {said} ({line}), and --unit {unit}", "find out which is right, and mend the other"
            )
    spectra = next((i for i in range(top) if labels.of_spectra(lines.text(i))), None)
    if spectra is not None or (head.columns and labels.is_period(head.columns[0].name)):
        at = head.at["columns"] if spectra is None else spectra
        wrong = f"names spectra ({record_text.shown(lines.text(at))}), no acceleration"
        raise lines.error(at, wrong, "give the file of the acceleration, or mend that line where it is wrong")
    if dt is not None and head.step is not None and abs(dt - head.step) > 2e-3 * dt:
        wrong = f"says a step of {head.step:g} s, and --dt {dt:g} s"
        raise lines.error(head.at["step"], wrong, "find out which is right, and mend the other")


_EXPONENT = str.maketrans("Dd", "Ee")


def _form(text: str, columns: int) -> tuple[str | None, bool] | None:
    """How a row of so many numbers is written: what parts them, and whether their comma is the decimal one."""
    ways: list[tuple[str | None, bool]] = [(";", False), ("\t", False), (",", False), (None, False)]
    # A comma that parts columns is none between digits: only where that fails is it the decimal one.
    ways += [(";", True), ("\t", True), (None, True)]
    for separator, comma in ways:
        cells = _cells(text, separator, comma)
        if len(cells) == columns and all(_NUMBER.match(cell) for cell in cells):
            return separator, comma
    return None


def _cells(text: str, separator: str | None, comma: bool) -> list[str]:
    text = text.rstrip(" ")
    if separator is not None:
        text = text.removesuffix(separator)
    if comma:
        text = _DECIMAL.sub(".", text)
    return [cell.strip().strip('"') for cell in text.split(separator)]


def _timed(lines: Lines, top: int, times: Array, data: Array, dt: float | None) -> tuple[Array, float, list[str]]:
    # Rounded to what is printed, be it in the millisecond or in the tenth of a step.
    spacing = float(times[-1] - times[0]) / (len(times) - 1)
    even = irregular.even_step(times, max(_digit(times[:200]), 1e-9 * abs(float(times[-1]))))
    if even is not None and (dt is None or abs(even - dt) <= 1e-3 * dt):
        return data, even, []
    if even is not None:
        wrong = f"the time of the rows has a step of {even:g} s, and --dt says {dt:g} s"
        raise lines.error(top, wrong, "drop --dt, or give the column of the time as -")
    if dt is None:
        steps = np.diff(times)
        worst = int(np.argmax(np.abs(steps - np.median(steps)))) + 1
        wrong = f"time {times[worst]:g} s is off the even step of {spacing:g} s"
        raise lines.error(top + worst, wrong, "mend it, or give --dt, the step that it shall be resampled to")
    made = [irregular.resampled(lines, top, 1, times, row, dt) for row in data.T]
    return np.column_stack([row for row, _ in made]), dt, [f"resampled {made[0][1]}"]


def _digit(times: Array) -> float:
    # As few decimals as all of them can be written with; nine for what was computed.
    return next((10.0**-places for places in range(9) if np.allclose(times, np.round(times, places), 0, 1e-12)), 1e-9)


def _text(
    data: Array, dt: float, codes: list[str], turned: list[float | str], unit: str, processed: bool | None
) -> str:
    cells = [
        f"{code} {turn if isinstance(turn, str) else f'{turn:g} deg'} ({unit})"
        for code, turn in zip(codes, turned, strict=True)
    ]
    lines = [] if processed is None else [f"# processed: {'yes' if processed else 'no'}"]
    lines.append(", ".join(["time (s)", *cells]))
    for number, row in enumerate(data):
        lines.append(", ".join([f"{dt * number:.17g}", *(f"{value:.17g}" for value in row)]))
    return "\n".join(lines) + "\n"
