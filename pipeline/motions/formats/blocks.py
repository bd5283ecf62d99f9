"""Blocks of numbers in record files, and the counts and time steps that headers announce for them."""

from __future__ import annotations

from array import array

import numpy as np

from pipeline.motions.formats.record_text import FormatError, Lines, printable, shown
from pipeline.quantities import Array

STEP_LEAST, STEP_MOST = 1e-5, 1.0
"""Time steps in s that an accelerograph can have."""

_NUMERIC = b" +-.0123456789EeDd"
_PADDING = b"\t\0\x1a"
_PLAIN = bytes.maketrans(_PADDING + b"Dd", b"   Ee")


def fixed(lines: Lines, start: int, count: int, columns: int, width: int, what: str) -> tuple[Array, int]:
    """Read a Fortran block: numbers in fields of equal width.

    Parameters
    ----------
    lines, start : Lines, int
        The file, and the block's first line, from 0.
    count : int
        Numbers in the block.
    columns, width : int
        Fields in a line, and characters of a field.
    what : str
        What the numbers are, for messages.

    Returns
    -------
    array, shape (count,)
        The numbers, in the file's unit.
    int
        The index of the line after the block.

    Raises
    ------
    FormatError
        At the first line that is missing, too short or long, or holds something else than numbers.
    """
    if not (1 <= columns <= 100 and 1 <= width <= 40):
        raise lines.error(start - 1, f"{columns} columns of {width} characters make no block of numbers")
    rows = -(-count // columns)
    end = start + rows
    # Before anything is allocated: a header may announce what it likes.
    if end > len(lines):
        wrong = f"the file ends where line {end} was expected ({count} values of {what} are announced)"
        raise lines.error(len(lines), wrong, "it is cut off: fetch the file again")
    full = columns * width
    last = (count - (rows - 1) * columns) * width
    block = []
    for index in range(start, end):
        size = last if index == end - 1 else full
        line = lines.lines[index].rstrip(b" \0\x1a")
        # Fortran fills its fields to their right end: a shorter line has lost a value, or the end of one.
        if line.translate(None, _NUMERIC) or len(line) != size:
            raise _no_numbers(lines, index, what, size // width, width)
        block.append(line)
    joined = b"".join(block).translate(_PLAIN)
    try:
        values = np.frombuffer(joined, dtype=f"S{width}").astype(np.float64)
    except ValueError:
        values = np.full(count, np.nan)
    if not np.isfinite(values).all():
        raise _first_bad_field(lines, start, block, width, what)
    return values, end


def _first_bad_field(lines: Lines, start: int, block: list[bytes], width: int, what: str) -> FormatError:
    for offset, line in enumerate(block):
        for at in range(0, len(line), width):
            field = line[at : at + width].translate(_PLAIN)
            try:
                good = bool(np.isfinite(float(field)))
            except ValueError:
                good = False
            if not good:
                place = f"columns {at + 1} to {at + width}"
                wrong = f"expected a value of {what} in {place}, found {shown(printable(field).strip())}"
                return lines.error(start + offset, wrong)
    return lines.error(start, f"the block of {what} holds no numbers")


def _no_numbers(lines: Lines, index: int, what: str, columns: int, width: int) -> FormatError:
    wrong = f"expected {columns} values of {what} of {width} characters, found {shown(lines.text(index))}"
    return lines.error(index, wrong, "the file is cut off or damaged: fetch it again")


def free(lines: Lines, start: int, count: int, what: str) -> Array:
    """Read blank-separated numbers that fill the rest of a file.

    Parameters
    ----------
    lines, start : Lines, int
        The file, and the first line of numbers, from 0.
    count : int
        How many the file announces.
    what : str
        What the numbers are, for messages.

    Returns
    -------
    array, shape (count,)
        The numbers, in the file's unit.

    Raises
    ------
    FormatError
        At a line that holds something else, or where there are fewer or more numbers.
    """
    values = array("d")
    for index in range(start, len(lines)):
        line = lines.lines[index]
        try:
            if line.translate(None, _NUMERIC + _PADDING):
                raise ValueError
            values.extend(map(float, line.translate(_PLAIN).split()))
        except ValueError:
            wrong = f"expected values of {what}, found {shown(lines.text(index))}"
            raise lines.error(index, wrong) from None
        if len(values) > count:
            wrong = f"holds more values of {what} than the {count} that the file announces"
            raise lines.error(index, wrong, "the file is damaged: fetch it again")
    if len(values) < count:
        wrong = f"the file ends after {len(values)} of the {count} values of {what} that it announces"
        raise lines.error(len(lines), wrong, "it is cut off: fetch the file again")
    found = np.array(values)
    if not np.isfinite(found).all():
        past = int(np.flatnonzero(~np.isfinite(found))[0])
        # The line that holds that value: values are counted again, because only now is it known that one is bad.
        index = start
        while (held := len(lines.lines[index].translate(_PLAIN).split())) <= past:
            past -= held
            index += 1
        raise lines.error(index, f"expected values of {what}, found a number beyond all bounds")
    return found


def rows(lines: Lines, start: int, columns: int, what: str, separator: bytes | None = None) -> Array:
    """Read rows of equally many numbers that fill the rest of a file.

    Parameters
    ----------
    lines, start : Lines, int
        The file, and the first row, from 0.
    columns : int
        Numbers in a row.
    what : str
        What the numbers are, for messages.
    separator : bytes or None
        Between the numbers, None for blanks; those that end a row of a spreadsheet are passed over.

    Returns
    -------
    array, shape (n, columns)
        The numbers, in the file's unit.

    Raises
    ------
    FormatError
        At a row that holds something else, or more or fewer numbers, and where there are fewer than two rows.
    """
    end = len(lines)
    while end > start and not lines.lines[end - 1].strip(b" \t\0\x1a" + (separator or b"")):
        end -= 1
    values = array("d")
    for index in range(start, end):
        line = lines.lines[index].rstrip(b" \t\0\x1a" + (separator or b""))
        fields = line.split(separator)
        try:
            if len(fields) != columns or line.translate(None, _NUMERIC + b"\t" + (separator or b"")):
                raise ValueError
            values.extend(map(float, fields))
        except ValueError:
            wrong = f"expected {columns} numbers of {what}, found {shown(lines.text(index))}"
            raise lines.error(index, wrong) from None
    samples(lines, start, end - start)
    table = np.array(values).reshape(-1, columns)
    if not np.isfinite(table).all():
        bad = start + int(np.flatnonzero(~np.isfinite(table).all(axis=1))[0])
        raise lines.error(bad, "holds a number beyond all bounds")
    return table


def step(lines: Lines, index: int, seconds: float) -> float:
    """Return a time step that an accelerograph can have.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and the line that says it, from 0.
    seconds : float
        In s.

    Returns
    -------
    float
        The same, in s.

    Raises
    ------
    FormatError
        For a step below STEP_LEAST or above STEP_MOST.
    """
    if not STEP_LEAST <= seconds <= STEP_MOST:
        raise lines.error(index, f"a time step of {seconds:g} s is none that a record can have")
    return seconds


def samples(lines: Lines, index: int, count: int) -> int:
    """Return a number of samples that makes a record.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and the line that says it, from 0.
    count : int
        The number.

    Returns
    -------
    int
        The same.

    Raises
    ------
    FormatError
        For fewer than two.
    """
    if count < 2:
        raise lines.error(index, f"announces {count} samples, which make no record", "use another record")
    return count
