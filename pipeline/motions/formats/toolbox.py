"""Tools that the readers share: lines with their numbers, blocks of numbers, and traces that say what they are."""

from __future__ import annotations

import re
from array import array
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from pipeline.motions.errors import MotionError
from pipeline.quantities import Array, G

MAX_BYTES = 64_000_000
"""Largest text file that is opened; the longest records of many-channel buildings have a quarter of it."""

MAX_LINES = 5_000_000
"""Most lines; with MAX_BYTES it keeps a file made of line ends below 1 GB of memory (60 bytes a line)."""

MAX_LINE = 10_000
"""Most characters in a line, of which numbers are made at once."""

HEAD = 8192
"""Bytes that deciding on a format may read."""

FACTORS = {"m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "gal": 0.01, "in/s2": 0.0254, "g": G, "mg": 0.001 * G}
"""Metres per second squared in one of each unit of acceleration."""

NUMBER = r"-?(?:\d{1,7}\.?\d{0,6}|\.\d{1,6})"
"""A number in the text of a header, as a pattern; always one that float() takes."""

STEP_LEAST, STEP_MOST = 1e-5, 1.0
"""Time steps in s that an accelerograph can have."""

Source = str | Path | IO[bytes]
Orientation = float | str | None


class FormatError(MotionError):
    """A record file that does not hold what its format promises.

    The message names the file, the line, what is wrong or was expected, and what to do.
    """


@dataclass(frozen=True, eq=False)
class Series:
    """A velocity or displacement that the agency computed, at the samples of the acceleration.

    It stands in for the bare array in a trace's header, because obspy compares headers, which arrays do not stand.
    ``np.asarray(series)`` gives the values.

    Attributes
    ----------
    values : array, shape (n,)
        In m/s or m.
    """

    values: Array

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.array(self.values, dtype=dtype, copy=copy)

    def __len__(self) -> int:
        return len(self.values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Series) and np.array_equal(self.values, other.values)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines of a record file without their ends; line numbers in messages start at 1, indices at 0.

    Attributes
    ----------
    file : str
        What messages call the file.
    lines : list of bytes
        Without line ends.
    """

    file: str
    lines: list[bytes]

    def __len__(self) -> int:
        return len(self.lines)

    def error(self, index: int, wrong: str, remedy: str = "fetch the file again, or mend the line") -> FormatError:
        """Return the error at a line.

        Parameters
        ----------
        index : int
            The line, from 0.
        wrong : str
            What is wrong there.
        remedy : str
            What mends it.

        Returns
        -------
        FormatError
        """
        return FormatError(f"{self.file}: line {index + 1}: {wrong}; {remedy}")

    def text(self, index: int, expected: str = "a line") -> str:
        """Return a line as printable text without trailing blanks.

        Parameters
        ----------
        index : int
            The line, from 0.
        expected : str
            What the message says was expected there.

        Returns
        -------
        str
            The line.

        Raises
        ------
        FormatError
            If the file ends before it.
        """
        if index >= len(self.lines):
            raise self.error(len(self.lines), f"the file ends where {expected} was expected", "fetch the file again")
        return printable(self.lines[index])

    def match(self, index: int, pattern: re.Pattern[str], expected: str) -> re.Match[str]:
        """Return the match of a pattern anywhere in a line.

        Parameters
        ----------
        index : int
            The line, from 0.
        pattern : re.Pattern
            What is looked for.
        expected : str
            What the message says was expected there.

        Returns
        -------
        re.Match
            The first one.

        Raises
        ------
        FormatError
            That says what was expected and what is there.
        """
        text = self.text(index, expected)
        found = pattern.search(text)
        if found is None:
            raise self.error(index, f"expected {expected}, found {shown(text)}")
        return found

    def blank_until_end(self, index: int) -> bool:
        """Whether nothing but blanks, NUL bytes and end-of-file marks follows."""
        return all(not line.strip(b" \t\0\x1a") for line in self.lines[index:])


def printable(raw: bytes) -> str:
    """Return bytes of a header as text: Latin-1, control characters as blanks, no trailing blanks."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", " ", raw.decode("latin-1")).rstrip()


def shown(text: str) -> str:
    """Quote a piece of a file for a message, shortened."""
    return repr(text[:60] + ("..." if len(text) > 60 else ""))


def head(source: Source) -> str:
    """Return the first 8 kB of a source as text, "" for what cannot be read as bytes; a stream keeps its position."""
    try:
        if isinstance(source, (str, Path)):
            with Path(source).open("rb") as stream:
                raw = stream.read(HEAD)
        else:
            position = source.tell()
            raw = source.read(HEAD)
            source.seek(position)
    except OSError:
        return ""
    # A text may end in NUL bytes or end-of-file marks; in front of anything else they mean that it is no text.
    if not isinstance(raw, bytes) or b"\0" in raw.rstrip(b"\0\x1a\r\n "):
        return ""
    return raw.decode("latin-1")


def open_lines(source: Source) -> Lines:
    """Read a text file with any line ends.

    Parameters
    ----------
    source : str, Path or binary stream
        The file.

    Returns
    -------
    Lines
        Its lines, without an empty last one.

    Raises
    ------
    FormatError
        For a file that is larger than MAX_BYTES, has more than MAX_LINES lines, or a line of more than MAX_LINE
        characters.
    OSError
        For a file that cannot be read.
    """
    if isinstance(source, (str, Path)):
        file = str(source)
        with Path(source).open("rb") as stream:
            raw = stream.read(MAX_BYTES + 1)
    else:
        file = str(getattr(source, "name", "stream"))
        raw = source.read(MAX_BYTES + 1)
    if len(raw) > MAX_BYTES:
        raise FormatError(f"{file}: line 1: is larger than {MAX_BYTES} bytes; split it into one file a channel")
    raw = raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    count = raw.count(b"\n") + 1
    if count > MAX_LINES:
        raise FormatError(f"{file}: line {MAX_LINES}: has {count} lines, more than a record; split it by channels")
    lines = raw.split(b"\n")
    long = next((i for i, line in enumerate(lines) if len(line) > MAX_LINE), None)
    if long is not None:
        wrong = f"has {len(lines[long])} characters, which no line of a record has"
        raise Lines(file, lines).error(long, wrong, "fetch the file again")
    if not lines[-1].strip(b"\0\x1a "):
        lines.pop()
    return Lines(file, lines)


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


_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d*)?)\s*([EW])")
_AZIMUTH = re.compile(r"(\d{1,3}(?:\.\d*)?)\s*(?:DEG(?:REES)?)?\.?")
_WORDS: dict[str, Orientation] = {"UP": "up", "DOWN": "down", "DN": "down", "DWN": "down"}
_WORDS |= {"N": 0.0, "NORTH": 0.0, "E": 90.0, "EAST": 90.0, "S": 180.0, "SOUTH": 180.0, "W": 270.0, "WEST": 270.0}


def orientation(text: str) -> Orientation:
    """Return what a header's words say of an orientation.

    Parameters
    ----------
    text : str
        Such as "90 Deg", "360", "N16W", "South", "Up".

    Returns
    -------
    float, str or None
        Degrees clockwise from north in [0, 360), "up" or "down"; what is none of these comes back as its own text, None
        for nothing.
    """
    word = text.strip().upper()
    if word in _WORDS:
        return _WORDS[word]
    if (quadrant := _QUADRANT.fullmatch(word)) and float(quadrant[2]) <= 90.0:
        turn = float(quadrant[2]) if quadrant[1] == "N" else 180.0 - float(quadrant[2])
        return (turn if quadrant[3] == "E" else -turn) % 360.0
    if (azimuth := _AZIMUTH.fullmatch(word)) and float(azimuth[1]) <= 360.0:
        return float(azimuth[1]) % 360.0
    return text.strip() or None


def seed_orientation(channel: str) -> Orientation:
    """Return what the last letter of a SEED channel code says (N and E within 5 degrees), None where it says nothing.

    Parameters
    ----------
    channel : str
        The code, of three letters.

    Returns
    -------
    float, str or None
        Degrees clockwise from north, or "up".

    References
    ----------
    SEED 2.4 manual, appendix A.
    """
    letters: dict[str, Orientation] = {"N": 0.0, "E": 90.0, "Z": "up"}
    return letters.get(channel[2]) if re.fullmatch(r"[A-Z]{2}[A-Z0-9]", channel) else None


def channel_code(rate: float, direction: Orientation, number: int) -> str:
    """Return a SEED code for an accelerometer: Z, N and E where the orientation says so, else the channel's number.

    Parameters
    ----------
    rate : float
        Samples per second.
    direction : float, str or None
        As `orientation` returns it.
    number : int
        Of the channel; its last digit is used.

    Returns
    -------
    str
        Three letters.
    """
    band = "H" if rate >= 80.0 else "B"
    letters: dict[Orientation, str] = {"up": "Z", "down": "Z", 0.0: "N", 90.0: "E"}
    return f"{band}N{letters.get(direction) or number % 10}"


def start_time(lines: Lines, index: int, *parts: float) -> Any:
    """Return the time of the parts of a header.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and the line that says it, from 0.
    *parts : float
        Year, month, day, hour, minute and second.

    Returns
    -------
    obspy.UTCDateTime
        The time.

    Raises
    ------
    FormatError
        For parts that make no time.
    """
    from obspy import UTCDateTime

    year, month, day, hour, minute, second = parts
    inside = 1850 <= year <= 2200 and 1 <= month <= 12 and 1 <= day <= 31
    if not (inside and 0 <= hour < 24 and 0 <= minute < 60 and 0 <= second < 61):
        raise lines.error(index, f"{', '.join(f'{p:g}' for p in parts)} is no date and time")
    try:
        return UTCDateTime(int(year), int(month), int(day), int(hour), int(minute)) + float(second)
    except ValueError as error:
        raise lines.error(index, f"{year:g}-{month:g}-{day:g} is no date") from error


def make_trace(
    lines: Lines,
    *,
    data: Array,
    dt: float,
    form: str,
    units: str,
    si_factor: float | None,
    direction: Orientation,
    processed: bool | None,
    station: str = "",
    network: str = "",
    location: str = "",
    channel: str = "",
    start: Any = None,
    start_is: str = "unknown",
    headonly: bool = False,
    peak: Mapping[str, float | None] | None = None,
    series: Mapping[str, Series] | None = None,
    more: Mapping[str, str] | None = None,
) -> Any:
    """Return the trace of one channel, in the file's own unit.

    Parameters
    ----------
    lines : Lines
        The file.
    data : array, shape (n,)
        The samples, in the file's unit.
    dt : float
        Time step in s.
    form : str
        The format.
    units : str
        "g", "cm/s2", "counts", ...
    si_factor : float or None
        Times the samples gives m/s2; None where the file does not say.
    direction : float, str or None
        Degrees clockwise from north, "up", "down", the header's own words, or None.
    processed : bool or None
        Whether the agency has filtered it; None where the file does not say.
    station, network, location, channel : str
        SEED codes.
    start : obspy.UTCDateTime or None
        The time of the first sample, or of what `start_is` says.
    start_is : str
        "record", "earthquake" where only its origin time is known, or "unknown".
    headonly : bool
        Whether the header alone is wanted.
    peak : mapping of str to float or None
        What the agency printed: acceleration [m/s2], velocity [m/s], displacement [m].
    series : mapping of str to Series, or None
        Velocity [m/s] and displacement [m], where there are any.
    more : mapping of str to str, or None
        What else there is to know: notes, resampled, title.

    Returns
    -------
    obspy.Trace
        Its ``stats.kouros`` holds units, si_factor, orientation, processed, format, file, start (`start_is`), peak
        (None for what the agency did not print), and the items of `series` and `more`.
    """
    from obspy import Trace
    from obspy.core import AttribDict

    printed = {"acceleration": None, "velocity": None, "displacement": None} | dict(peak or {})
    header: dict[str, Any] = {
        "network": network[:8],
        "station": station[:20],
        "location": location[:8],
        "channel": channel,
        "delta": dt,
        "kouros": AttribDict(
            units=units,
            si_factor=si_factor,
            orientation=direction,
            processed=processed,
            format=form,
            file=lines.file,
            start=start_is,
            peak=AttribDict(printed),
            **(series or {}),
            **(more or {}),
        ),
    }
    if start is not None:
        header["starttime"] = start
    if headonly:
        return Trace(header=header | {"npts": len(data)})
    return Trace(data=np.ascontiguousarray(data), header=header)
