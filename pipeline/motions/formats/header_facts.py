"""What headers say beside the samples: the earthquake, the station, and how far they are apart.

A trace carries it in ``stats.kouros`` under the keys of `about`; what a header leaves open, or fills with zeros, is not
there.  It names and describes a record: nothing of it changes how the record is processed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from pipeline.motions.formats.record_text import Keys

_DEGREES = r"(-?\d{1,3}(?:\.\d{1,8})?)"
_POINT = rf"{_DEGREES}\s*([NS]?)\s*,?\s*{_DEGREES}\s*([EW]?)"
_HYPOCENTRE = re.compile(
    rf"hypocenter(?:\([^)]{{1,20}}\))?:\s*{_POINT}(?:,?\s*h\s*=\s*(\d{{1,3}}(?:\.\d*)?)\s*km)?", re.I
)
_COORDINATES = re.compile(rf"\b(?:coords:|station\s+(?:no\.|id\.)\s*\w{{0,8}}|station)\s+{_POINT}(?=\s|$)", re.I)
_MAGNITUDE = re.compile(r"\bM([WSLBD])\s*=?\s*(\d\.\d{1,2})\b", re.IGNORECASE)
SECONDS = r"\s{0,2}(\d{1,2}(?:\.\d{0,6})?|\.\d{1,6})"
"""Seconds of a time as a pattern: Fortran prints those below one as ".0" behind blanks."""

_ORIGIN = re.compile(
    r"origin(?:\s?\([^)]{1,20}\))?:\s*(\d{1,4})/(\d{1,2})/(\d{1,4}),?\s+(\d{1,2}):\s?(\d{1,2}):"
    rf"{SECONDS}\s*(UTC|GMT|P[SD]T)",
    re.IGNORECASE,
)
_MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC")
_MONTH = rf"(?P<month>{'|'.join(_MONTHS)})[A-Z]{{0,6}}\.?"
_CLOCK = r"\s+-?\s*(?P<hour>\d\d):?(?P<minute>\d\d)\s*(?P<zone>UTC|GMT|P[SD]T)\b"
_MINUTES = (
    re.compile(rf"\b(?P<day>\d{{1,2}}) {_MONTH} (?P<year>\d{{4}}){_CLOCK}", re.IGNORECASE),
    re.compile(rf"\b{_MONTH} (?P<day>\d{{1,2}}), (?P<year>\d{{4}}){_CLOCK}", re.IGNORECASE),
)
_RECORD = re.compile(r"^\s*(?:record|rcrd) of\b", re.IGNORECASE)
_SEXAGESIMAL = r"(\d{1,3}) (\d\d) (\d\d)\s?([NS]), (\d{1,3}) (\d\d) (\d\d)\s?([EW])"
_EPICENTRE = re.compile(rf"^epicenter\s+-?\s*{_SEXAGESIMAL}", re.IGNORECASE)
_STATION = re.compile(rf"^station\s.{{0,16}}?\s{_SEXAGESIMAL}", re.IGNORECASE)
_EARTHQUAKE = re.compile(
    r"^\s*(?:(?:record|rcrd) of\s+)?([A-Za-z][A-Za-z .,'-]{2,50}?)\s+(earthquake)(?=\s*$|\s{2}|\s+of\b)", re.IGNORECASE
)
_STATE = re.compile(r"(?<=, )[A-Z][a-z]\b")
_PLACED = re.compile(r"\blocation:\s*(\S.*?)\s*$", re.IGNORECASE)
_UNDERGROUND = re.compile(r"\b(?:dh|down-?hole|bore-?hole|depth)\b", re.IGNORECASE)
_LENGTH = re.compile(r"(\d{1,4}(?:\.\d{1,3})?)\s?(m|ft)\b", re.IGNORECASE)
_FOOT = 0.3048
_ZONES = {"UTC": 0, "GMT": 0, "PST": 8, "PDT": 7}
_KINDS = ("W", "S", "L", "B", "D")
_SIDES = {"N": 1.0, "S": -1.0, "E": 1.0, "W": -1.0, "": 1.0}
_LONGEST = 100
UNSET = 1980
"""Year of clocks that nobody set: an origin on its first day at midnight is none."""


def about(**said: Any) -> dict[str, Any]:
    """Return what a header says, without what it leaves open.

    Parameters
    ----------
    **said : float, str or obspy.UTCDateTime
        Of event_name, event_time, event_latitude, event_longitude [degrees], event_depth_km, magnitude,
        magnitude_type, latitude, longitude [degrees, of the station], station_name, sensor_depth [m] and distance_km;
        None, "" and what cannot be are dropped, and so is a place without its other half, or at zero north and zero
        east.

    Returns
    -------
    dict
        By the same names.
    """
    known = {key: value for key, value in said.items() if value is not None and value != ""}
    for prefix in ("", "event_"):
        pair = [known.get(f"{prefix}{part}") for part in ("latitude", "longitude")]
        bounded = all(one is not None and abs(one) <= most for one, most in zip(pair, (90.0, 180.0), strict=True))
        if not bounded or not any(pair):
            known = {
                key: value for key, value in known.items() if key not in {f"{prefix}latitude", f"{prefix}longitude"}
            }
    bounds = {"magnitude": (0.1, 10.0), "event_depth_km": (0.0, 1000.0), "distance_km": (0.01, 20_100.0)}
    for key, (least, most) in bounds.items():
        if key in known and not least <= known[key] <= most:
            known.pop(key)
    if "event_latitude" not in known:
        known.pop("event_depth_km", None)
    if "magnitude" not in known:
        known.pop("magnitude_type", None)
    when = known.get("event_time")
    if when is not None and (when.year, when.julday, when.hour, when.minute) == (UNSET, 1, 0, 0):
        known.pop("event_time")
    return {key: value[:_LONGEST] if isinstance(value, str) else value for key, value in known.items()}


def of_text(text: Sequence[str]) -> dict[str, Any]:
    """Return what the text lines of CSMIP, COSMOS and their relatives say, by the names of `about`.

    Parameters
    ----------
    text : sequence of str
        The header's lines.

    Returns
    -------
    dict
        Without what no line says.
    """
    said: dict[str, Any] = {}
    for line in text:
        if "event_latitude" not in said and (found := _HYPOCENTRE.search(line)):
            said["event_latitude"], said["event_longitude"] = _point(found)
            said["event_depth_km"] = None if found[5] is None else float(found[5])
        if "latitude" not in said and (found := _COORDINATES.search(line)):
            said["latitude"], said["longitude"] = _point(found)
        if "event_time" not in said and (found := _ORIGIN.search(line)):
            said["event_time"] = _time(found)
        for prefix, pattern in (("event_", _EPICENTRE), ("", _STATION)):
            if f"{prefix}latitude" not in said and (found := pattern.search(line)):
                said[f"{prefix}latitude"], said[f"{prefix}longitude"] = _from_seconds(found)
        if "magnitude" not in said:
            said |= magnitude({kind.upper(): float(size) for kind, size in _MAGNITUDE.findall(line)})
    if said.get("event_time") is None:
        said["event_time"] = earthquake_minute(text)[1]
    return about(**said)


def earthquake_minute(text: Sequence[str]) -> tuple[int, Any]:
    """Return the time of an earthquake as headers tell it that know it to the minute, such as "15 OCT 1979 - 2317 UTC".

    Parameters
    ----------
    text : sequence of str
        The header's lines; one that only tells when the record began is passed over.

    Returns
    -------
    int, obspy.UTCDateTime or None
        The line, from 0, and the time; the number of lines and None where none says it.
    """
    for index, line in enumerate(text):
        if _RECORD.search(line) and "earthquake" not in line.lower():
            continue
        found = next((found for pattern in _MINUTES if (found := pattern.search(line))), None)
        if found:
            month = _MONTHS.index(found["month"].upper()) + 1
            parts = [int(found["year"]), month, *(int(found[part]) for part in ("day", "hour", "minute"))]
            return index, moment(*parts, 0.0, zone=-_ZONES[found["zone"].upper()])
    return len(text), None


def magnitude(sizes: dict[str, float | None]) -> dict[str, Any]:
    """Return the magnitude that says most: of moment, else surface waves, else local, else body waves and duration.

    Parameters
    ----------
    sizes : dict of str to float or None
        By "W", "S", "L", "B" or "D"; by "" one of a kind that nobody says, which comes last.

    Returns
    -------
    dict
        magnitude and magnitude_type; empty for none.
    """
    for kind in (*_KINDS, ""):
        size = sizes.get(kind)
        if size is not None and 0.1 <= size <= 10.0:
            return {"magnitude": size} | ({"magnitude_type": f"M{kind.lower()}"} if kind else {})
    return {}


def sensor(line: str) -> dict[str, Any]:
    """Return where a sensor stood, by the line of its channel, such as "Location: DH array 10.7m".

    Parameters
    ----------
    line : str
        The line.

    Returns
    -------
    dict
        sensor_place, in the agency's words, and sensor_depth [m] below the ground, where these say one; without what
        the line does not say.  A location code is no place.
    """
    found = _PLACED.search(line)
    if found is None or not re.search(r"[A-Za-z]{3}|\bDH\b", found[1]):
        return {}
    place = found[1][:_LONGEST]
    length = _LENGTH.search(place) if _UNDERGROUND.search(place) else None
    if length is None:
        return {"sensor_place": place}
    return {"sensor_place": place, "sensor_depth": float(length[1]) * (_FOOT if length[2].lower() == "ft" else 1.0)}


def number(keys: Keys, *names: str) -> float | None:
    """Return the number at the start of what the first of some keys says; None where it is none."""
    for name in names:
        found = re.match(r"\s*(-?\d{1,9}(?:\.\d{0,9})?)", keys.get(name, (0, ""))[1])
        if found:
            return float(found[1])
    return None


def place_name(line: str) -> str:
    """Return the name of a place from a line that goes on with others, such as the agency, behind two blanks."""
    name = re.split(r"\s{2,}", line.strip())[0].strip()
    return name if any(letter.isalpha() for letter in name) else ""


def earthquake_name(lines: Iterable[str]) -> str:
    """Return the first line that names an earthquake, such as "COALINGA EARTHQUAKE"; "" for none."""
    for line in lines:
        if found := _EARTHQUAKE.search(line):
            name = " ".join(f"{found[1]} {found[2]}".split())
            return _STATE.sub(lambda state: state[0].upper(), name.title()) if name.isupper() else name
    return ""


def turned(degrees: float, side: str) -> float:
    """Return degrees north or east, by the letter of their hemisphere."""
    return _SIDES[side.upper()] * abs(degrees) if side else degrees


def moment(*parts: float, zone: int = 0) -> Any:
    """Return the time of an earthquake from its parts, None where they make none: it is no reason to refuse a record.

    Parameters
    ----------
    *parts : float
        Year, month, day, hour, minute and second.
    zone : int
        Hours that they are ahead of UTC.

    Returns
    -------
    obspy.UTCDateTime or None
    """
    from obspy import UTCDateTime

    year, month, day, hour, minute, second = parts
    try:
        when = UTCDateTime(int(year), int(month), int(day), int(hour), int(minute)) + second
    except (ValueError, OverflowError):
        return None
    return when - 3600 * zone if 1850 <= year <= 2200 and 0 <= second < 61 else None


def _point(found: re.Match[str]) -> tuple[float, float]:
    return turned(float(found[1]), found[2]), turned(float(found[3]), found[4])


def _from_seconds(found: re.Match[str]) -> tuple[float, float]:
    """Degrees north and east of degrees, minutes and seconds."""
    parts = found.groups()
    north, east = (float(p[0]) + float(p[1]) / 60.0 + float(p[2]) / 3600.0 for p in (parts[:3], parts[4:7]))
    return turned(north, parts[3]), turned(east, parts[7])


def _time(found: re.Match[str]) -> Any:
    first, second, third = (int(found[i]) for i in (1, 2, 3))
    year, month, day = (first, second, third) if first > 31 else (third, first, second)
    if year < 100:
        year += 1900 if year >= 33 else 2000
    return moment(year, month, day, int(found[4]), int(found[5]), float(found[6]), zone=-_ZONES[found[7].upper()])
