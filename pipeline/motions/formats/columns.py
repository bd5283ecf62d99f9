"""Columns or one series of numbers, bare or under a head in words: what programs, loggers and many agencies print.

Bare columns are a time at even steps, then accelerations.  Under a head (see `labels`) the step may be said in place of
a column of time, a series may be wrapped over rows of any width, and the first line of numbers may be their number and
step ("8192 0.01").  What no word says of unit, orientation, and raw or processed, the manifest must say.

source : no agency's; GeoCSV 2.0, SIMBAD, CSN (Chile), SCEC's Broadband Platform, SeismoSignal, DEEPSOIL and eqsig are
         such
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator
from datetime import date
from importlib import import_module
from typing import Any

import numpy as np

from pipeline.motions.doubts import FACTOR
from pipeline.motions.formats import blocks, header_facts, irregular, labels, record_text, trace_headers, unit_words
from pipeline.motions.formats.agreement import told_length
from pipeline.motions.formats.labels import HeadColumn, RecordHead
from pipeline.motions.formats.record_text import FormatError, Lines, Source, shown
from pipeline.quantities import Array

_NUMBER = re.compile(r"^[+-]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[Ee][+-]?\d{1,3})?$")
_PLAIN = rb"[+-]?(?:\d{1,20}+(?:\.\d{0,20}+)?+|\.\d{1,20}+)(?:[Ee][+-]?\d{1,3}+)?+"
"""The same of bytes, without a second thought."""
_FORTRAN = str.maketrans("Dd", "Ee", '"')
_COUNTER = re.compile(rb"\s(\d{1,7})\s*$")
_MOMENT = re.compile(r"^(?:(\d{4})[-/](\d\d)[-/](\d\d)[T ])?(\d\d):(\d\d):(\d\d(?:\.\d{1,9})?)(Z?)$")
_TOUCHING = re.compile(r"(?<=\d)(?=[+-]\d*\.)")
_DECIMAL = re.compile(r"(?<=\d),(?=\d)")
_BLANKS = bytes.maketrans(b",;\t", b"   ")
_AT_ONCE = 256
"""Rows that are taken together where all are plain."""
_LEAST_ROWS, _MOST_COLUMNS, _MOST_HEAD = 5, 20, 200
_CONVERT = "kouros motions convert FILE --columns ns --dt 0.01 --unit g --out FOLDER"
_BARE = 4
"""Most columns of a table that nothing names."""

_TELLING_ROWS, _ALIKE, _SMOOTH = 50, 1.5, 0.8
"""Rows from which the numbers tell whether they are one series; the largest over the smallest of their steps, and those
over the steps from row to row, up to which they do (judgement)."""

_OTHERS = ("bhrc", "cosmos", "csmip", "csmnc", "cwa", "esm", "geonet", "jma", "nsmn", "peer", "smc", "table", "unam",
           "volume1")  # fmt: skip


def is_format(source: Source) -> bool:
    """Whether a source is such numbers, under a head that says their step, or with a time; and no agency's format."""
    text, whole = record_text.first_lines(source)
    # The last line of what was read may be half of one.
    lines = Lines("", [line.encode("latin-1") for line in record_text.parted(text)[: None if whole else -1]])
    top = _top(lines)
    if top is None or len(lines) - top < _LEAST_ROWS:
        return False
    lines = _uncounted(lines, top)
    try:
        block, start = _layout(lines, top, whole=whole)
        _step(lines, start, block)
    except FormatError:
        return False
    return not any(import_module(f"{__package__}.{name}").is_format(source) for name in _OTHERS)


def series(lines: Lines) -> tuple[Array, int, int] | None:
    """Return all numbers of a file in a row, whatever head it has, without those that count its rows.

    Parameters
    ----------
    lines : Lines
        Of the file.

    Returns
    -------
    (array, int, int) or None
        The numbers, the line that they begin in, from 0, and how many a line has, the last of which may have fewer;
        None for a file without rows of numbers.

    Raises
    ------
    FormatError
        At a row that holds something else, or more or fewer numbers than the first.
    """
    top = _top(lines)
    if top is None:
        return None
    lines = _uncounted(lines, top)
    form = _form(lines.text(top))
    width = len(_cells(lines, top, form))
    return _values(lines, top, form, width)[0], top, width


def refused(file: str) -> FormatError | None:
    """Return why the numbers of a file are no record, where rows of numbers are all that follows its head.

    Parameters
    ----------
    file : str
        A text file that no reader knows.

    Returns
    -------
    FormatError or None
        Naming what is not said, with the remedy; None for what holds no such rows.
    """
    try:
        lines = record_text.open_lines(file)
        if series(lines) is None:
            return None
    except (FormatError, OSError):
        return None
    try:
        _traces(lines, headonly=True)
    except FormatError as problem:
        return problem
    return None


def _uncounted(lines: Lines, top: int) -> Lines:
    """The same without the numbers of the rows, where each ends in its own, as in files for SHAKE (8F9.6, I7)."""
    end = len(lines)
    while end > top and not lines.lines[end - 1].strip(b" \t\0\x1a"):
        end -= 1
    first = _COUNTER.search(lines.lines[top])
    if first is None or b"." not in lines.lines[top] or len(lines.lines[top].split()) < 3 or end - top < _LEAST_ROWS:
        return lines
    for index in range(top, end):
        last = _COUNTER.search(lines.lines[index])
        if last is None or int(last[1]) != int(first[1]) + index - top:
            return lines
    return Lines(
        lines.file, lines.lines[:top] + [_COUNTER.sub(b"", line) for line in lines.lines[top:end]], lines.skipped
    )


class _Block:
    """Rows of numbers, before any of them is given a meaning.

    Attributes
    ----------
    head : RecordHead
        What the lines before them say.
    step : float or None
        In s, as the head says it, or a first line of number and step.
    times : array or None
        A first column that is a time at even steps.
    data : array, shape (n, k)
        The other columns; one of all numbers, where they are one series.
    columns : tuple of HeadColumn
        Their names, where the head has them.
    """

    def __init__(self, head: RecordHead, data: Array, columns: tuple[HeadColumn, ...]) -> None:
        self.head, self.data, self.columns = head, data, columns
        self.step = head.step
        self.times: Array | None = None


def _top(lines: Lines) -> int | None:
    """The first of three lines that are numbers and nothing else."""
    found = 0
    for index in range(min(len(lines), _MOST_HEAD + 3)):
        text = record_text.printable(lines.lines[index])
        if text.strip() and _row(text, *_form(text)) is not None:
            found += 1
            if found == 3:
                return index - 2
        elif text.strip() or found:
            found = 0
    return None


def _form(text: str) -> tuple[str | None, bool]:
    """What parts the cells of a row, and whether commas are decimal commas."""
    if ";" in text or "\t" in text.strip():
        return (";" if ";" in text else "\t"), bool(_DECIMAL.search(text))
    return ("," if "," in text else None), False


def _row(text: str, separator: str | None, comma: bool) -> list[str] | None:
    """The numbers of a row, None where it has something else; a time of the calendar in front is left out."""
    text = _DECIMAL.sub(".", text) if comma else text
    if '"' in text or "D" in text or "d" in text:
        text = text.translate(_FORTRAN)
    cells = text.strip().rstrip(separator).split(separator) if separator else _TOUCHING.sub(" ", text).split()
    cells = [cell.strip() for cell in cells]
    if len(cells) > 1 and _MOMENT.match(cells[0]):
        cells = cells[1:]
    return cells if cells and all(_NUMBER.match(cell) for cell in cells) else None


def _layout(lines: Lines, top: int, *, whole: bool = True) -> tuple[_Block, int]:
    """Return the numbers from a line on, as columns or as one series, and the first line of them.

    Of a file's first part alone, it is one series where more numbers are announced than there are rows.
    """
    form = _form(lines.text(top + 1, "a row of numbers"))
    first = _row(lines.text(top), *_form(lines.text(top))) or []
    second = _row(lines.text(top + 1), *form) or []
    counted = None
    # "8192 0.01" before the numbers: another width than theirs, or no time at even steps from there.
    if len(first) == 2 and first[0].isdigit() and blocks.STEP_LEAST <= float(first[1]) <= blocks.STEP_MOST:
        third = _row(lines.text(top + 2, "a row of numbers"), *form) or second
        apart = len(second) != 2 or abs(float(third[0]) - float(second[0]) - float(first[1])) < 1e-6
        if apart and abs(float(second[0]) - float(first[0]) - float(first[1])) > 1e-6:
            counted = int(first[0]), float(first[1])
    start = top + 1 if counted else top
    width = len(_cells(lines, start, form))
    head = labels.read_head(lines, top, width + _moments(lines, start, form), form[0])
    if counted:
        head.says(lines, top, "count", counted[0])
        head.says(lines, top, "step", counted[1])
    columns = head.columns[-width:] if head.columns else ()
    if head.step is None and not (columns and columns[0].is_time) and _moments(lines, start, form):
        _clocked(lines, start, form, head)
    values, lengths = _values(lines, start, form, width)
    even = lengths == width and width > 1
    table = values.reshape(-1, width) if even else values[:, None]
    if even and columns and labels.is_index(columns[0].name) and (np.diff(table[:, 0]) == 1.0).all():
        table, columns, width = table[:, 1:], columns[1:], width - 1
        values = table.ravel()
    block = _Block(head, values, columns)
    timed = even and _timed(table, columns, head, lines, start, form)
    announced = head.count or 0
    one = width in {1, head.per_row} or (
        not columns and not timed and (announced == values.size or (not whole and announced > len(table)))
    )
    if not one and not announced and not columns and not timed and head.step is not None:
        # What follows on itself tells; a file's first part may be all noise, and is settled with the whole.
        one = not whole or _reads_on(values, width)
    if even and not one and (timed or columns or head.count == len(table)):
        block.data = table
        if timed:
            block.times, block.data, block.columns = table[:, 0], table[:, 1:], columns[1:]
    elif one:
        block.data, block.columns = values[:, None], columns if width == 1 else ()
    elif announced:
        wrong = f"announces {announced} samples, and {values.size} numbers are there, {width} a row"
        raise lines.error(head.at["count"], wrong, "it is cut off or damaged: fetch it again")
    elif head.kind in {"velocity", "displacement"}:
        raise _other(lines, head, head.kind, head.unit)
    else:
        wrong = (
            f"neither names of columns, nor a count, nor the numbers say whether {width} a row are components or one "
            f"series"
        )
        raise lines.error(start, wrong, f"name the columns, or one for all: {_CONVERT}")
    return block, start


def _reads_on(values: Array, width: int) -> bool:
    """Whether numbers are one series that is wrapped over rows: by their steps from one to the next.

    Along a series these are smaller than those from row to row, and as large between the last of a row and the first of
    the next as within one.  Between components they are larger than those from row to row; between sensors that move
    alike, those from the end of a row to the next are.
    """
    table = values[: values.size // width * width].reshape(-1, width)
    if len(table) < _TELLING_ROWS:
        return False
    follows = np.column_stack([np.diff(table, axis=1)[:-1], table[1:, 0] - table[:-1, -1]])
    each = np.sqrt((follows**2).mean(axis=0))
    down = float(np.sqrt((np.diff(table, axis=0) ** 2).mean()))
    return bool(0.0 < each.max() < _ALIKE * each.min() and each.max() < _SMOOTH * down)


def _timed(
    table: Array,
    columns: tuple[HeadColumn, ...],
    head: RecordHead,
    lines: Lines,
    start: int,
    form: tuple[str | None, bool],
) -> bool:
    if columns or not (head.step or head.count):
        # Where nothing else says the step, the first column has to.
        return columns[0].is_time if columns else table.shape[1] <= _BARE
    rows = range(start, min(start + 20, len(lines)))
    digit = _digit([cells[0] for i in rows if (cells := _row(lines.text(i), *form))])
    return len(table) >= _LEAST_ROWS and irregular.even_step(table[:, 0], digit) is not None


def _cells(lines: Lines, index: int, form: tuple[str | None, bool]) -> list[str]:
    cells = _row(lines.text(index), *form)
    if cells is None or len(cells) > _MOST_COLUMNS:
        wrong = f"expected at most {_MOST_COLUMNS} numbers, found {shown(lines.text(index))}"
        raise lines.error(index, wrong)
    return cells


def _moments(lines: Lines, index: int, form: tuple[str | None, bool]) -> int:
    """How many cells of a row are a time of the calendar, which is left out."""
    return int(bool(form[0]) and bool(_MOMENT.match(lines.text(index).split(form[0])[0].strip())))


def _clocked(lines: Lines, start: int, form: tuple[str | None, bool], head: RecordHead) -> None:
    """Take the step, and the beginning, from times of the calendar, where nothing else says the step."""
    stamps = []
    for index in range(start, len(lines)):
        found = _MOMENT.match(lines.text(index).split(form[0])[0].strip())
        if found is None:
            break
        stamps.append(found)
    if len(stamps) < _LEAST_ROWS:
        return
    try:
        days = [date(*map(int, one.group(1, 2, 3))).toordinal() if one[1] else 0 for one in stamps]
    except ValueError as error:
        raise lines.error(start, f"has a time of the calendar that is none ({error})") from error
    clock = np.array([[float(part) for part in one.group(4, 5, 6)] for one in stamps])
    times = clock @ (3600.0, 60.0, 1.0) + 86400.0 * (np.array(days) - days[0])
    times -= times[0]
    dt = irregular.even_step(times, _digit([one[6] for one in stamps[:20]]))
    if dt is None:
        worst, wrong, remedy = irregular.off_step(times)
        raise lines.error(start + worst, wrong, remedy)
    head.says(lines, start, "step", dt)
    # Without a Z nobody knows whose clock it is.
    if stamps[0][7] and stamps[0][1] and head.start is None:
        head.says(lines, start, "start", tuple(float(part) for part in stamps[0].group(1, 2, 3, 4, 5, 6)))


def _values(lines: Lines, start: int, form: tuple[str | None, bool], width: int) -> tuple[Array, int]:
    """All numbers from a line on, and how many each row has: the last of a series may have fewer, which gives 0."""
    end = len(lines)
    while end > start and not lines.lines[end - 1].strip(b" \t\0\x1a,;"):
        end -= 1
    values = array("d")
    same = width
    plain = _plain_rows(form, width)
    for index in _each_row(lines, start, end, plain, values):
        cells = _row(lines.text(index), *form)
        if cells is None or len(cells) != width:
            if cells is None or index < end - 1 or len(cells) > width:
                raise lines.error(index, f"expected {width} numbers, found {shown(lines.text(index))}")
            same = 0
        values.extend(map(float, cells))
    blocks.samples(lines, start, len(values))
    found = np.array(values)
    if not np.isfinite(found).all():
        past = int(np.flatnonzero(~np.isfinite(found))[0])
        raise lines.error(start + past // width, "holds a number beyond all bounds")
    return found, same


def _plain_rows(form: tuple[str | None, bool], width: int) -> re.Pattern[bytes]:
    """Return the pattern of rows of so many numbers that need no second look, each with its line's end."""
    gap = rb"[ \t\r]++" if form[0] is None else rb"[ \t\r]*+" + form[0].encode() + rb"[ \t\r]*+"
    row = rb"[ \t\r]*+" + _PLAIN + (b"(?:" + gap + _PLAIN + b"){%d}" % (width - 1))
    return re.compile(b"(?:" + row + rb"[ \t\r]*+\n)++")


def _each_row(lines: Lines, start: int, end: int, plain: re.Pattern[bytes], values: array[float]) -> Iterator[int]:
    """Take the numbers of many plain rows at once, and yield each row of other parts, to be looked at."""
    for at in range(start, end, _AT_ONCE):
        part = lines.lines[at : min(at + _AT_ONCE, end)]
        rows = b"\n".join([*part, b""])
        if plain.fullmatch(rows):
            values.extend(map(float, rows.translate(_BLANKS).split()))
        else:
            yield from range(at, at + len(part))


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of such numbers, one a component; what no word says of the unit leaves `units` ""."""
    top = _top(lines)
    if top is None:
        raise lines.error(0, "expected rows of numbers, which are nowhere", "give a file of accelerations")
    lines = _uncounted(lines, top)
    block, start = _layout(lines, top)
    head = block.head
    chosen = _accelerations(lines, block)
    dt = _step(lines, start, block)
    count, width = block.data.shape
    if head.count is not None:
        trace_headers.said_count(lines, head.at["count"], head.count, count)
    if head.length is not None:
        told_length(lines, head.at["length"], head.length, count, dt)
    if head.kind == "acceleration":
        trace_headers.said_unit(lines, head.at["unit"], head.unit, [one.unit for one in block.columns])
    if not block.columns and width > _BARE - 1:
        remedy = "name them: kouros motions convert FILE --columns time,ns,ew,ud --unit g --out FOLDER"
        raise lines.error(start, f"nothing names its {width} columns", remedy)
    begins = None if head.start is None else trace_headers.start_time(lines, head.at["start"], *head.start)
    traces = []
    for number in chosen:
        column = block.columns[number] if block.columns else HeadColumn("", "", "")
        unit = column.unit if column.kind else head.unit
        named = column.name and (width > 1 or labels.points(column.orientation))
        said = column.orientation if named else head.orientation
        factor, notes = trace_headers.FACTORS.get(unit), ""
        if (column.kind or head.kind) == "counts" and head.scale and head.scaled in trace_headers.FACTORS:
            factor = trace_headers.FACTORS[head.scaled] / head.scale
            notes = f"its head says {head.scale:.9g} counts for 1 {head.scaled}, at every frequency"
        elif head.factor is not None:
            notes = f"its head names a factor of {head.factor:.9g}{FACTOR}"
        data = block.data[:, number].copy()
        peak = head.peak[0] if head.peak and width == 1 and factor else None
        network, station, location, channel = head.code
        traces.append(
            trace_headers.make_trace(
                lines,
                data=data,
                dt=dt,
                form="columns",
                units=unit,
                si_factor=factor,
                direction=said,
                processed=head.processed,
                network=network,
                station=station,
                location=location or (f"{number + 1:02d}" if width > 1 or not channel else ""),
                channel=channel or trace_headers.channel_code(1.0 / dt, said, number + 1 if width > 1 else None),
                start=begins,
                start_is="unknown" if begins is None else "record",
                headonly=headonly,
                peak={"acceleration": peak},
                more={
                    key: said
                    for key, said in {
                        "column": column.name,
                        "notes": notes,
                        "unit_said": column.said or ("" if unit else head.unit_said),
                    }.items()
                    if said
                },
                about=header_facts.about(**head.about),
            )
        )
    if head.peak and not headonly and all(trace.stats.kouros.si_factor for trace in traces):
        data = np.array([trace.stats.kouros.si_factor * trace.data for trace in traces])
        trace_headers.said_peak(lines, head.at["peak"], *head.peak, data, 1.0)
    return traces


def _accelerations(lines: Lines, block: _Block) -> list[int]:
    """The columns that hold accelerations, or say nothing; velocities and displacements beside them are left out."""
    kinds = [column.kind for column in block.columns] or [block.head.kind] * block.data.shape[1]
    kinds = [kind or block.head.kind for kind in kinds]
    chosen = [number for number, kind in enumerate(kinds) if kind in {"acceleration", "counts", ""}]
    if "acceleration" in kinds:
        chosen = [number for number, kind in enumerate(kinds) if kind == "acceleration"]
    at = block.head.at.get("columns")
    over = block.columns and labels.is_period(block.columns[0].name)
    if at is not None and (over or labels.of_spectra(lines.text(at))):
        wrong = f"names spectra ({shown(lines.text(at))}), no acceleration"
        raise lines.other(at, wrong)
    if not chosen:
        unit = block.columns[0].unit if block.columns and block.columns[0].unit else block.head.unit
        raise _other(lines, block.head, kinds[0], unit)
    return chosen


def _other(lines: Lines, head: RecordHead, kind: str, unit: str) -> FormatError:
    at = head.at.get("unit", head.at.get("columns", 0))
    wrong = f"holds {kind}{f' ({unit})' if unit else ''}, no acceleration"
    return lines.other(at, wrong)


def _step(lines: Lines, start: int, block: _Block) -> float:
    head, step = block.head, block.head.step
    if block.times is None:
        if step is None:
            raise lines.error(start, "nothing says the time step", f"say it: {_CONVERT}")
        return blocks.step(lines, head.at["step"], step)
    form = _form(lines.text(start))
    first = [cells[0] for i in range(start, min(start + 20, len(lines))) if (cells := _row(lines.text(i), *form))]
    times = block.times * (unit_words.seconds(head.columns[0].unit) if head.columns else 1.0)
    dt = irregular.even_step(times, _digit(first))
    if dt is None:
        worst, wrong, remedy = irregular.off_step(times)
        raise lines.error(start + worst, wrong, remedy)
    if dt == 1.0 and not head.columns and (np.mod(times, 1.0) == 0.0).all():
        # No accelerograph takes one sample a second.
        raise lines.error(
            start, "its first column counts the rows, and nothing says the time step", f"say it: {_CONVERT}"
        )
    if step is not None:
        trace_headers.said_step(lines, head.at["step"], step, dt)
    return blocks.step(lines, start, dt)


def _digit(cells: list[str]) -> float:
    # One in the last printed place, of the time that is printed finest.
    digits = 0
    for cell in cells:
        mantissa, _, power = cell.lower().partition("e")
        shift = int(power) if re.fullmatch(r"[+-]?\d{1,3}", power) else 0
        digits = max(digits, len(mantissa.partition(".")[2]) - shift)
    return float(10.0 ** -min(digits, 15))


read_format = record_text.reader(_traces)
