"""Standard acceleration file (ASA) of the UNAM and the RACM (Mexico): the channels of an instrument side by side.

A hundred lines of 'KEY : value' in Spanish, each value parted by strokes for the channels, then fixed columns in gal.
The day is the earthquake's; the record begins at the time of day that is nearest to it.

source : Instituto de Ingeniería, UNAM, Formato estándar de archivos de aceleración (ASA), version 2.0
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import agreement, blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import Lines, Source

_TITLE = "ARCHIVO ESTANDAR DE ACELERACION"
_KEY = re.compile(r"^([A-Z][A-Za-z0-9 .,()\[\];/-]{3,60}?)\s*:\s?(.*)$")
_CHANNELS = re.compile(r",?\s*C\d{1,2}-C\d{1,2}")
_SHAPE = re.compile(r"^(\d{1,2})[FE](\d{1,2})\.(\d{1,2})$")
_DAY = re.compile(r"^(\d{4})/(\d\d)/(\d\d)$")
_CLOCK = re.compile(r"^(\d{1,2}):(\d{1,2}):(\d{1,2}(?:\.\d{0,6})?)$")
_COORDINATE = re.compile(r":\s*(\d{1,3}(?:\.\d{1,8})?)\s*L(?:AT|ONG)\.?\s*([NSEWO])\b", re.IGNORECASE)
_SIZE = re.compile(r"\bM([WSLB]?)\s*=\s*(\d\.\d{1,2})", re.IGNORECASE)
_WIDTH = re.compile(r"^FORMATO DATOS\s*\(FORTRAN,\s*\d{1,2} campos/dato\)$", re.I)
_DATA = re.compile(r"^DATOS DE ACELERACION\b")
_RULE = re.compile(r"^-{5,}\+")
_MOST_LINES = 300


def is_format(source: Source) -> bool:
    """Whether a source is an ASA file, from its title."""
    return any(line.startswith(_TITLE) for line in record_text.parted(record_text.head(source))[:12])


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of an ASA file, one a channel."""
    keys, top = _header(lines)

    def said(key: str) -> tuple[int, str]:
        if key not in keys:
            raise lines.error(top, f"the header ends without {key}", "fetch the file again")
        return keys[key][0]

    def channels(key: str, size: int) -> tuple[int, list[str]]:
        said(key)
        parts = _parts(keys[key])
        if len(parts) != size:
            raise lines.error(keys[key][0][0], f"names {len(parts)} channels, where the file has {size}")
        return keys[key][0][0], parts

    def numbers(key: str, size: int) -> tuple[int, list[float]]:
        at, parts = channels(key, size)
        if not all(re.fullmatch(r"-?\d{1,9}(?:\.\d{0,9})?|-?\.\d{1,9}", part) for part in parts):
            raise lines.error(at, f"expected {size} numbers, found {record_text.shown(' / '.join(parts))}")
        return at, [float(part) for part in parts]

    at, unit = said("UNIDADES DE LOS DATOS")
    if not re.match(r"(?i)^gal\b", unit):
        raise lines.error(at, f"expected the unit Gal, found {record_text.shown(unit)}")
    whole = next((key for key in keys if _WIDTH.match(key)), "FORMATO DATOS")
    at, text = said(whole)
    shape = _SHAPE.match(text)
    if shape is None:
        raise lines.error(at, f"expected a format such as 3F10.3, found {record_text.shown(text)}")
    size, width = int(shape[1]), int(shape[2])
    at, counts = numbers("NUM. TOTAL DE MUESTRAS", size)
    if len(set(counts)) > 1:
        raise lines.error(at, "the channels have different numbers of samples", "split the file by its channels")
    count = blocks.samples(lines, at, int(counts[0]))
    at, steps = numbers("INTERVALO DE MUESTREO (s)", size)
    if len(set(steps)) > 1:
        raise lines.error(at, "the channels have different time steps", "split the file by its channels")
    dt = blocks.step(lines, at, steps[0])
    if "DURACION DEL REGISTRO (s)" in keys:
        at, lengths = numbers("DURACION DEL REGISTRO (s)", size)
        agreement.said_length(lines, at, lengths[0], count, dt)
    at, factor = said("FACTOR DE DECIMACION")
    if factor not in {"", "1", "1.0"}:
        # It may be that the step is of before, or of after.
        raise lines.error(at, f"is decimated by {record_text.shown(factor)}", "give the file that is not")
    words = channels("ORIENTACION (rumbo;orientacion)", size)[1]
    at_peaks, peaks = numbers("ACEL. MAX.(Gal)", size)
    values, end = blocks.fixed(lines, top, size * count, size, width, "acceleration")
    beyond = sum(bool(line.strip(b" \t\0\x1a")) for line in lines.lines[end:])
    # Some instruments wrote on for a row or two; a second more is another record, or another header.
    if beyond * dt > 1.0:
        raise lines.error(end, f"the file goes on for {beyond} rows after the {count} that its header announces")
    extra = f"{beyond} rows after the announced ones were not read" if beyond else ""
    when = _start(lines, keys)
    gal, digit = trace_headers.FACTORS["gal"], 10.0 ** -int(shape[3])
    table, about = values.reshape(-1, size), _about(lines, keys)
    traces = []
    for number, word in enumerate(words, start=1):
        direction, assumed = trace_headers.component(word.split(";")[-1])
        data = table[:, number - 1].copy()
        printed = _digit(keys["ACEL. MAX.(Gal)"], number - 1)
        trace_headers.said_peak(lines, at_peaks, gal * peaks[number - 1], gal * max(digit, printed), data, gal)
        traces.append(
            trace_headers.make_trace(
                lines,
                data=data,
                dt=dt,
                form="ASA",
                units="gal",
                si_factor=gal,
                direction=direction,
                processed=False,
                station=said("CLAVE DE LA ESTACION")[1][:8],
                location=f"{number:02d}" if size > 3 else "",
                channel=trace_headers.channel_code(1.0 / dt, direction, number),
                start=when,
                start_is="unknown" if when is None else "record",
                headonly=headonly,
                peak={"acceleration": gal * peaks[number - 1]},
                more={"notes": "; ".join(filter(None, (assumed, extra)))} if assumed or extra else {},
                about=about,
            )
        )
    return traces


def _about(lines: Lines, keys: dict[str, list[tuple[int, str]]]) -> dict[str, Any]:
    said: dict[str, Any] = {}
    for prefix, name in (("", "COORDENADAS DE LA ESTACION"), ("event_", "COORDENADAS DEL EPICENTRO")):
        at = keys.get(name, [(0, "")])[0][0]
        # The longitude stands in the next line, behind an empty name.
        for key, text in (("latitude", lines.text(at)), ("longitude", lines.text(at + 1))) if at else ():
            if found := _COORDINATE.search(text):
                said[prefix + key] = header_facts.turned(float(found[1]), "W" if found[2].upper() == "O" else found[2])
    sizes = _SIZE.findall(keys.get("MAGNITUD(ES)", keys.get("MAGNITUD", [(0, "")]))[0][1])
    depth = re.match(r"\s*(\d{1,3}(?:\.\d*)?)", keys.get("PROFUNDIDAD FOCAL (Km)", [(0, "")])[0][1])
    clock = keys.get("HORA EPICENTRO (GMT)", [(0, "")])[0][1]
    day = keys.get("FECHA DEL SISMO [GMT]", keys.get("FECHA DEL SISMO (GMT)", [(0, "")]))[0][1]
    hour, date, when = _CLOCK.match(clock), _DAY.match(day), None
    if hour is not None and date is not None:
        when = header_facts.moment(*map(float, date.groups()), *map(float, hour.groups()))
    return header_facts.about(
        **said,
        **header_facts.magnitude({kind.upper(): float(size) for kind, size in sizes}),
        event_depth_km=float(depth[1]) if depth else None,
        event_time=when,
        station_name=keys.get("NOMBRE DE LA ESTACION", [(0, "")])[0][1],
    )


def _parts(said: list[tuple[int, str]]) -> list[str]:
    """Return the values of the channels: one to six, and seven to twelve, stand in lines of their own."""
    return [part.strip() for _, text in said for part in text.strip().strip("/").split("/") if text.strip()]


def _digit(said: list[tuple[int, str]], number: int) -> float:
    return float(10.0 ** -len(_parts(said)[number].partition(".")[2]))


def _header(lines: Lines) -> tuple[dict[str, list[tuple[int, str]]], int]:
    keys: dict[str, list[tuple[int, str]]] = {}
    data = None
    for index in range(min(len(lines), _MOST_LINES)):
        text = lines.text(index)
        if _DATA.match(text):
            data = index
        elif data is not None and _RULE.match(text) and index > data + 1:
            return keys, index + 1
        elif data is None and (found := _KEY.match(text)):
            keys.setdefault(_CHANNELS.sub("", found[1]).replace(", (", " (").strip(), []).append(
                (index, found[2].strip())
            )
    raise lines.error(min(len(lines), _MOST_LINES), "expected the columns of DATOS DE ACELERACION", "fetch it again")


def _start(lines: Lines, keys: dict[str, list[tuple[int, str]]]) -> Any:
    at, clock = keys.get("HORA DE LA PRIMERA MUESTRA (GMT)", [(0, "")])[0]
    _, day = keys.get("FECHA DEL SISMO [GMT]", keys.get("FECHA DEL SISMO (GMT)", [(0, "")]))[0]
    _, quake = keys.get("HORA EPICENTRO (GMT)", [(0, "")])[0]
    first, date, origin = _CLOCK.match(clock), _DAY.match(day), _CLOCK.match(quake)
    if first is None or date is None:
        return None
    when = trace_headers.start_time(lines, at, *map(float, date.groups()), *map(float, first.groups()))
    if origin is not None:
        began = trace_headers.start_time(lines, at, *map(float, date.groups()), *map(float, origin.groups()))
        # Only the earthquake has a date: around midnight the record's may be the next, or the one before.
        when += 86400 * round((began - when) / 86400)
    return when


read_format = record_text.reader(_traces)
