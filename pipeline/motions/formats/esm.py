"""ESM ASCII (DYNA 1.0 to 1.2, and ITACA 1), as ESM, ITACA and AFAD (TADAS) write it: one component.

Lines of "KEY: value", then one number a line.  The orientation is the one that the channel code stands for (SEED: N and
E within 5 degrees); a channel that ends in 1 or 2 has none in its file.  ITACA 1 has COMPONENT (WE, NS, UP) in place of
STREAM, a time of the first sample without its day, and says by DATA_TYPE whether a record is processed.

source : ESM, header format DYNA 1.2, https://esm-db.eu
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import agreement, blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import Keys, Lines, Source

_KEY = re.compile(r"^([A-Z][A-Z0-9_/^]{1,59}):(.*)$")
_CLOCK = r"(?P<H>\d\d):(?P<M>\d\d):(?P<S>\d\d(?:\.\d{0,9})?)$"
_DATES = (
    re.compile(r"^(?P<y>\d{4})(?P<m>\d\d)(?P<d>\d\d)_(?P<H>\d\d)(?P<M>\d\d)(?P<S>\d\d(?:\.\d{1,6})?)$"),
    # AFAD (TADAS), and its older files, as ESM has them.
    re.compile(r"^(?P<y>\d{4})/(?P<m>\d\d)/(?P<d>\d\d)[ _]" + _CLOCK),
    re.compile(r"^(?P<d>\d\d)/(?P<m>\d\d)/(?P<y>\d{4})[ _]" + _CLOCK),
)
_TYPE = re.compile(r"^(UNPROCESSED |PROCESSED )?ACCELERATION$", re.IGNORECASE)
_COMPONENTS: dict[str, trace_headers.Orientation] = {"WE": 90.0, "EW": 90.0, "NS": 0.0, "SN": 0.0, "UP": "up"}
"""East and north are positive, whichever way the two letters go."""
_CLOCKS = re.compile(r"^(\d\d):?(\d\d):?(\d\d(?:\.\d{0,9})?)$")
_NUMBER = re.compile(r"^[+-]?\d{0,9}\.?\d{1,12}(?:[Ee][+-]?\d{1,2})?$")
_MOST_KEYS = 200
_PLACES = {
    "latitude": "STATION_LATITUDE", "longitude": "STATION_LONGITUDE",
    "event_latitude": "EVENT_LATITUDE", "event_longitude": "EVENT_LONGITUDE",
}  # fmt: skip
_UNITS = {"cm/s^2": "cm/s2", "cm/s2": "cm/s2", "cm/s**2": "cm/s2", "m/s^2": "m/s2", "m/s2": "m/s2", "g": "g"}


def is_format(source: Source) -> bool:
    """Whether a source is an ESM file, from its first keys."""
    text = record_text.head(source)
    return text.startswith("EVENT_NAME:") and "\nSTATION_CODE:" in text and "\nSAMPLING_INTERVAL_S:" in text


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the trace of acceleration of an ESM file."""
    keys = _header(lines)
    said = keys.said
    at, kind = said("DATA_TYPE")
    if not _TYPE.match(kind):
        raise lines.other(at, f"the file holds {record_text.shown(kind)}")
    at, unit = said("UNITS")
    if unit.lower() not in _UNITS:
        raise lines.error(at, f"expected one of {', '.join(_UNITS)}, found {record_text.shown(unit)}")
    unit = _UNITS[unit.lower()]
    dt = blocks.step(lines, said("SAMPLING_INTERVAL_S")[0], _number(lines, *said("SAMPLING_INTERVAL_S")))
    at, number = said("NDATA")
    if not re.fullmatch(r"\d{1,9}", number):
        raise lines.error(at, f"expected the number of samples, found {record_text.shown(number)}")
    count = blocks.samples(lines, at, int(number))
    data = blocks.free(lines, keys.end, count, "acceleration")
    when = _start(lines, keys)
    at, peak = keys.get("PGA_CM/S^2", (0, ""))
    if peak:
        digit = 0.01 * 10.0 ** -len(peak.partition(".")[2])
        trace_headers.said_peak(lines, at, 0.01 * _number(lines, at, peak), digit, data, trace_headers.FACTORS[unit])
    at_length, length = keys.get("DURATION_S", (0, ""))
    if length:
        agreement.said_length(lines, at_length, _number(lines, at_length, length), count, dt)
    at_time, time = keys.get("TIME_PGA_S", (0, ""))
    if time and peak:
        agreement.said_time(lines, at_time, _number(lines, at_time, time), data, dt)
    channel, direction, how = _channel(keys, dt)
    # A code of two letters in ESM; in the files of AFAD the name of the place.
    place = keys.get("LOCATION", (0, ""))[1]
    processed, assumed = _processed(keys)
    trace = trace_headers.make_trace(
        lines,
        data=data,
        dt=dt,
        form="ESM ASCII",
        units=unit,
        si_factor=trace_headers.FACTORS[unit],
        direction=direction,
        processed=processed,
        station=said("STATION_CODE")[1],
        network=keys.get("NETWORK", (0, ""))[1],
        location=place if len(place) <= 2 else "",
        channel=channel,
        start=when,
        start_is="unknown" if when is None else "record",
        headonly=headonly,
        peak={"acceleration": 0.01 * _number(lines, at, peak) if peak else None},
        more={"notes": f"{how}; {assumed}" if assumed else how},
        about=_about(keys),
    )
    return [trace]


def _header(lines: Lines) -> Keys:
    keys = Keys(lines)
    for index in range(min(len(lines), _MOST_KEYS)):
        found = _KEY.match(lines.text(index))
        if found is None:
            keys.end = index
            return keys
        keys.add(index, found[1], found[2].strip())
    raise lines.error(min(len(lines), _MOST_KEYS), "expected the first value of acceleration", "fetch the file again")


def _start(lines: Lines, keys: Keys) -> Any:
    """Return the time of the first sample; ITACA 1 says its clock alone, which may be of the day before or after."""
    if (clock := _CLOCKS.match(keys.get("TIME_FIRST_SAMPLE_S", (0, ""))[1])) and (origin := _origin(keys)):
        parts = (origin.year, origin.month, origin.day, *map(float, clock.groups()))
        when = trace_headers.start_time(lines, keys["TIME_FIRST_SAMPLE_S"][0], *parts)
        return when + 86400.0 * round((origin - when) / 86400.0)
    if "TIME_FIRST_SAMPLE_S" in keys:
        return None
    at, first = keys.said("DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS")
    date = next((found for form in _DATES if (found := form.match(first))), None)
    if first and date is None:
        raise lines.error(at, f"expected a time such as 20190728_160919.870, found {record_text.shown(first)}")
    return None if date is None else trace_headers.start_time(lines, at, *(float(date[part]) for part in "ymdHMS"))


def _channel(keys: Keys, dt: float) -> tuple[str, trace_headers.Orientation, str]:
    """Return the channel's code, its orientation, and by what it is known."""
    if "STREAM" in keys or "COMPONENT" not in keys:
        code = keys.said("STREAM")[1]
        how = "orientation by the channel code (SEED: N and E within 5 degrees)"
        return code, trace_headers.seed_orientation(code), how
    word = keys["COMPONENT"][1]
    direction = _COMPONENTS.get(word.upper(), trace_headers.orientation(word))
    return trace_headers.channel_code(1.0 / dt, direction, None), direction, f"orientation by COMPONENT: {word[:20]}"


def _number(lines: Lines, index: int, text: str) -> float:
    if not _NUMBER.match(text):
        raise lines.error(index, f"expected a number, found {record_text.shown(text)}")
    return float(text)


def _about(keys: Keys) -> dict[str, Any]:
    name = keys.get("EVENT_NAME", (0, ""))[1]
    said = {key: header_facts.number(keys, f"{word}_DEGREE") for key, word in _PLACES.items()}
    return header_facts.about(
        **said,
        **header_facts.magnitude({kind: header_facts.number(keys, f"MAGNITUDE_{kind}") for kind in "WSL"}),
        event_name="" if name.isdigit() else name.title() if name.isupper() else name,
        event_time=_origin(keys),
        event_depth_km=header_facts.number(keys, "EVENT_DEPTH_KM"),
        distance_km=header_facts.number(keys, "EPICENTRAL_DISTANCE_KM"),
        station_name=keys.get("STATION_NAME", (0, ""))[1],
        sensor_depth=header_facts.number(keys, "SENSOR_DEPTH_M"),
    )


def _origin(keys: Keys) -> Any:
    day = re.match(r"^(\d{4})/?(\d\d)/?(\d\d)$", keys.get("EVENT_DATE_YYYYMMDD", (0, ""))[1])
    clock = _CLOCKS.match(keys.get("EVENT_TIME_HHMMSS", (0, ""))[1])
    return header_facts.moment(*map(float, day.groups()), *map(float, clock.groups())) if day and clock else None


def _processed(keys: dict[str, tuple[int, str]]) -> tuple[bool | None, str]:
    if (kind := _TYPE.match(keys["DATA_TYPE"][1])) and kind[1]:
        return not kind[1].upper().startswith("UN"), ""
    how = keys.get("PROCESSING", (0, ""))[1].lower()
    filtered = keys.get("FILTER_TYPE", (0, ""))[1]
    corners = [keys[key][1] for key in ("LOW_CUT_FREQUENCY_HZ", "HIGH_CUT_FREQUENCY_HZ") if key in keys]
    if filtered and len(corners) == 2 and not any(corners):
        # AFAD's raw files name the filter of its processed ones, without order and corners.
        return False, f"raw: it names the filter {filtered[:20]}, but no corner"
    if how.startswith(("manual", "automatic")) or filtered:
        return True, ""
    baseline = keys.get("BASELINE_CORRECTION", (0, ""))[1].upper()
    return (False if how == "none" or baseline == "BASELINE NOT REMOVED" else None), ""


read_format = record_text.reader(_traces)
