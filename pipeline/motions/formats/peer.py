"""PEER AT2: one component of acceleration in g, as the NGA databases and the older PEER database give it.

Programs that write the same form say other units in its third line.

Four lines of text, the last with the number of samples and the step ("NPTS=  7818, DT= .0050 SEC", with or without its
comma, or "7818 .0050 NPTS, DT"), then numbers.  The orientation is the last item of the second line.  A header that
names the corners of its filter ("FILTER POINTS: HP=0.06 Hz LP=40.0 Hz") is of a processed record; the others do not say
it: the manifest must.

source : header of the files of the PEER NGA-West2 database
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import blocks, record_text, trace_headers, unit_words
from pipeline.motions.formats.record_text import Lines, Source

_UNIT = re.compile(r"ACCELERATION TIME (SERIES|HISTORY) IN UNITS OF\s+(\S+)", re.IGNORECASE)
_NEW = re.compile(r"NPTS\s*=\s*(\d{1,9})\s*[,\s]\s*DT\s*=\s*(\d{0,4}\.\d{1,9}(?:E-?\d)?)", re.IGNORECASE)
_SEED = re.compile(r"([BEHLS][HNLG][A-Z0-9])(?:\d\d|--)?")
_NAME = re.compile(r"_(\w{1,4})\.AT2$", re.IGNORECASE)
_REMARK = re.compile(r"\([^()]*\)\s*$")
_FILTERED = re.compile(r"\bFILTER POINTS?\s*:\s*HP\s*=\s*0*\.?0*[1-9]", re.IGNORECASE)
_OLD = re.compile(r"^\s*(\d{1,9})\s+(\d{0,4}\.\d{1,9})\s+NPTS\s*,\s*DT", re.IGNORECASE)


def is_format(source: Source) -> bool:
    """Whether a source is a PEER AT2 file, from its first four lines."""
    lines = record_text.parted(record_text.head(source))[:4]
    return len(lines) == 4 and bool(_UNIT.search(lines[2])) and bool(_NEW.search(lines[3]) or _OLD.search(lines[3]))


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the trace of a PEER AT2 file."""
    unit = lines.match(2, _UNIT, "'ACCELERATION TIME SERIES IN UNITS OF G'")
    kind, units = unit_words.unit_of(unit[2].rstrip(",;"))
    if kind != "acceleration":
        wrong = f"the unit is {record_text.shown(unit[2])}, which is none of an acceleration that is known"
        raise lines.error(2, wrong, "give the file as CSV with its unit declared")
    text = lines.text(3, "the number of samples and the step")
    found = _NEW.search(text) or _OLD.search(text)
    if found is None:
        raise lines.error(3, f"expected 'NPTS= 7818, DT= .0050 SEC', found {record_text.shown(text)}")
    count = blocks.samples(lines, 3, int(found[1]))
    dt = blocks.step(lines, 3, float(found[2]))
    data = blocks.free(lines, 4, count, "acceleration")
    title = lines.text(1)
    direction, assumed = _direction(title.rpartition(",")[2]) if "," in title else (None, "")
    trace = trace_headers.make_trace(
        lines,
        data=data,
        dt=dt,
        form="PEER AT2",
        units=units,
        si_factor=trace_headers.FACTORS[units],
        direction=direction,
        processed=True if _FILTERED.search(lines.text(2)) else None,
        channel=trace_headers.channel_code(1.0 / dt, direction, 1),
        headonly=headonly,
        more={"title": title} | ({"notes": assumed} if assumed else {}),
    )
    return [trace]


def _direction(word: str) -> tuple[trace_headers.Orientation, str]:
    """What the last item of a title says; in NGA-East it is a channel of SEED, such as BHZ00, with the location."""
    # "164 (CDMG STATION 279)" names the station; "-UP" and "--V" are filled up to three characters.
    word = _REMARK.sub("", word).strip().lstrip("-")
    # In New Zealand's it is the name of the file, which ends in the component.
    word = named[1] if (named := _NAME.search(word)) else word
    code = _SEED.fullmatch(word.upper())
    coded = trace_headers.seed_orientation(code[1]) if code else None
    return trace_headers.component(word) if coded is None else (coded, "")


read_format = record_text.reader(_traces)
