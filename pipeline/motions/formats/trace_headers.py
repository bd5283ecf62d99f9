"""Traces of single channels as obspy has them, with orientation, unit and time as the headers of files say them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.motions.formats.record_text import Lines
from pipeline.quantities import Array, G

FACTORS = {"m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "gal": 0.01, "in/s2": 0.0254, "g": G, "mg": 0.001 * G}
FACTORS |= {"g/10": 0.1 * G, "%g": 0.01 * G, "ft/s2": 0.3048, "mgal": 1e-5, "nm/s2": 1e-9}
"""Metres per second squared in one of each unit of acceleration."""

STEP_TOLERANCE = 2e-3
"""How far a printed time step may be from that of the times, of itself: 1/128 s is printed as 0.0078."""

PEAK_TOLERANCE = 0.1
"""How far a printed peak may be from that of the samples, of itself: what filters, rounding and trends removed between
the two come to (judgement); a wrong unit, a cut-off peak or another record is farther off."""

Orientation = float | str | None


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


_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d*)?)\s*([EW])")
_AZIMUTH = re.compile(r"(?:(\d{1,3}(?:\.\d*)?)\s*(?:DEG(?:REES)?|°)?\.?|N\s*(\d{3}(?:\.\d*)?)\s*E)")
"""Degrees clockwise from north; from 100 on networks write them as N129E, too."""

_WORDS: dict[str, Orientation] = {"UP": "up", "DOWN": "down", "DN": "down", "DWN": "down"}
_WORDS |= {"NS": 0.0, "N-S": 0.0, "EW": 90.0, "E-W": 90.0, "UD": "up", "U-D": "up", "UPDO": "up"}
_WORDS |= {"NORTH-SOUTH": 0.0, "EAST-WEST": 90.0, "UP-DOWN": "up", "UPWARD": "up"}
_VERTICAL = {"V", "Z", "VER", "VERT", "VERTICAL"}
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
    if (azimuth := _AZIMUTH.fullmatch(word)) and float(azimuth[1] or azimuth[2]) <= 360.0:
        return float(azimuth[1] or azimuth[2]) % 360.0
    return text.strip() or None


def component(text: str) -> tuple[Orientation, str]:
    """Return what the one word of a header that has nothing better says of an orientation.

    Parameters
    ----------
    text : str
        Such as "N90E", "V", "L".

    Returns
    -------
    float, str or None
        As `orientation`, and "up" for what is only called vertical.
    str
        What was taken for granted, "" for nothing.
    """
    said = orientation(text)
    if isinstance(said, str) and said.upper().strip("+ ") in _VERTICAL:
        return "up", f"{said} is taken as vertical, positive up"
    return said, ""


def said_peak(
    lines: Lines, index: int, said: float, digit: float, data: Array, factor: float, what: str = "acceleration"
) -> None:
    """Refuse a record whose header prints another peak than its samples have.

    Agencies print the peak of the samples, of the samples about their mean, or with its sign: any of these will do.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and the line that says it, from 0.
    said : float
        The peak in m/s2, m/s or m; zero is taken for one that was not filled in.
    digit : float
        One in its last printed place, in the same.
    data : array, shape (n,) or (k, n)
        The samples, or those of k components, of which one has to have the peak.
    factor : float
        Times the samples gives m/s2, m/s or m.
    what : {"acceleration", "velocity", "displacement", "reading"}
        What they are.

    Raises
    ------
    FormatError
        That names both, where they are more than PEAK_TOLERANCE apart, and more than the last digit.
    """
    said = abs(said)
    if said == 0.0:
        return
    rows = np.atleast_2d(data)
    as_they_are = factor * np.abs(rows).max(axis=1)
    about = factor * np.abs(rows - rows.mean(axis=1, keepdims=True)).max(axis=1)
    slack = PEAK_TOLERANCE * said + digit
    if np.abs(np.concatenate([as_they_are, about]) - said).min() > slack:
        found = float(as_they_are.max())
        unit = {"acceleration": " m/s2", "velocity": " m/s", "displacement": " m"}.get(what, "")
        wrong = f"says a peak {what} of {said:.4g}{unit}, and the samples have {found:.4g}{unit}"
        raise lines.error(index, wrong, "it is damaged, or of another unit or record: fetch it again")


def said_step(lines: Lines, index: int, said: float, dt: float) -> None:
    """Refuse a record whose header says another time step [s] than its column of times has."""
    if abs(dt - said) > STEP_TOLERANCE * dt:
        wrong = f"says a step of {said:g} s, and the times have one of {dt:g} s"
        raise lines.error(index, wrong, "find out which is right, and mend the other")


def said_count(lines: Lines, index: int, said: int, count: int) -> None:
    """Refuse a record whose header announces another number of samples than it has."""
    if said != count:
        wrong = f"announces {said} samples, and {count} are there"
        raise lines.error(index, wrong, "it is cut off or damaged: fetch it again")


def said_unit(lines: Lines, index: int, said: str, units: Iterable[str]) -> None:
    """Refuse a record whose header says a unit of acceleration that none of its columns has."""
    other = {unit for unit in units if unit in FACTORS}
    if said in FACTORS and other and FACTORS[said] not in {FACTORS[unit] for unit in other}:
        wrong = f"says {said} for the unit, and the names of the columns say {', '.join(sorted(other))}"
        raise lines.error(index, wrong, "find out which is right, and mend the other")


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


def channel_code(rate: float, direction: Orientation, number: int | None) -> str:
    """Return a SEED code for an accelerometer: Z, N and E where the orientation says so, else the channel's number.

    Parameters
    ----------
    rate : float
        Samples per second.
    direction : float, str or None
        As `orientation` returns it.
    number : int or None
        Of the channel; its last digit is used.  None where a file of one channel has none: 1 for what points more to
        the north or south and 2 to the east or west, as SEED numbers them, so that two files of a station differ.

    Returns
    -------
    str
        Three letters.
    """
    if number is None:
        number = 1 if not isinstance(direction, float) or not 45.0 <= direction % 180.0 < 135.0 else 2
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
    about: Mapping[str, Any] | None = None,
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
    about : mapping of str to Any, or None
        What the header says of earthquake and station, as `header_facts.about` returns it.

    Returns
    -------
    obspy.Trace
        Its ``stats.kouros`` holds units, si_factor, orientation, processed, format, file, start (`start_is`), peak
        (None for what the agency did not print), and the items of `series`, `more` and `about`.
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
            **(about or {}),
        ),
    }
    if start is not None:
        header["starttime"] = start
    if headonly:
        return Trace(header=header | {"npts": len(data)})
    return Trace(data=np.ascontiguousarray(data), header=header)
