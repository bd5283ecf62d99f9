"""Dimensions that a cell holds as JSON or as a form of labels, as catalogues on the web publish them -> a text."""

from __future__ import annotations

import json
import re
from ast import literal_eval
from collections.abc import Iterator, Mapping
from functools import cache
from html import unescape
from typing import Any

from pipeline.collection.dimensions.lexicon import meanings, unit_words
from pipeline.tables.rows import UNSEEN

LONGEST = 20_000
"""Characters of a cell that are looked at: thirty measurements with all that a catalogue says of each."""
DEEPEST = 6
"""Levels of lists and objects in one another that are looked into."""

_ENTITY = re.compile(r"&(?:#\d{1,6}|#x[\da-f]{1,5}|[a-z]{2,8}\d{0,2});", re.IGNORECASE | re.ASCII)
_OPENS = re.compile(r"\s*[\[{]\s*[\[{\"']")
_LISTED = re.compile(r"\s*\[\s*[{\"'].*[}\"']\s*\]\s*\Z", re.DOTALL)
_FIGURE = re.compile(r"\d{1,6}(?:[.,]\d{1,6})?", re.ASCII)
_SLASHED = re.compile(r"\s*\d+(?:[.,]\d+)?(?:\s*/\s*(?:\d{1,4}(?:[.,]\d+)?|[-–—])){2}\s*", re.ASCII)
_DATED = re.compile(r"\s*[0-3]?\d\s*/\s*[0-3]?\d\s*/\s*[12]\d{3}\s*", re.ASCII)
"""All three sides and nothing else, "62/31/31" and "310/420/–", and a day, which is none."""
_TOLD = 3
_FORM = 2
"""Labels with units from which a text is a form."""
_FILLED = re.compile(r"([^\s(\[][^(\[]*)(.*)", re.DOTALL)
"""What stands behind a label: the number, and what is said of it in brackets."""
_WORDS = ("name", "title", "label", "term", "text", "content", "value", "_label", "description", "en")
"""Keys of what a thing is called, the likeliest first."""
_MOST_WORDS = 2000
_NAMES = ("dimension", "dimensiontype", "type", "measurementtype", "name", "label")
_VALUES = ("value", "amount", "dimensionvalue", "measurementvalue", "measurement", "content", "display")
_UNITS = ("unit", "units", "dimensionunit", "measurementunit", "unitname")
_PARTS = ("part", "element", "extent")
_WHOLE = ("overall", "whole", "estimate", "estimated")
"""Of a part: that there is none, or how it was measured."""
_ALL = ("dimension", "dimensions", "measurement", "measurements", "size")
_MOST = 200
"""Characters of one cell of a measurement."""


def plain_text(text: str) -> str:
    """Return a cell of dimensions as a text that can be read like any other.

    Parameters
    ----------
    text : str
        Of the cell: `[{"dimension": "Height", "value": "24.5", "unit": "cm", "part": ""}]`, the same as Python writes
        it, `{"height": 450, "width": 320, "unit": "mm"}`, `{"framed": {"height": 0.6, "width": 0.5}}`, a form such as
        `Altura (cm): 24,5 Largura (cm): Peso (g): 30`, three numbers such as `62/31/31`, or any text.

    Returns
    -------
    str
        "Height 24.5 cm, Width 12 cm"; those of a part behind its name. The text itself where it is no such cell.
    """
    if len(text) > LONGEST:
        return text
    text = UNSEEN.sub("", _ENTITY.sub(_unescaped, text))
    if _SLASHED.fullmatch(text) and not _DATED.fullmatch(text):
        return " x ".join(part for part in map(str.strip, text.split("/")) if part[0].isdigit())
    if not _OPENS.match(text):
        return _filled_in(text)
    found = _parsed(text.strip())
    parts: dict[str, list[str]] = {}
    for part, said in () if found is None else _lines(found, "", 0):
        parts.setdefault(part, []).append(said)
    return "; ".join(f"{part}: {', '.join(said)}" if part else ", ".join(said) for part, said in parts.items()) or text


@cache
def _label() -> re.Pattern[str]:
    """Return what finds a label with its unit: "Altura (cm):"."""
    units = "|".join(re.escape(word) for word in sorted(unit_words(), key=len, reverse=True) if word.isalpha())
    return re.compile(rf"([^\W\d_][^\d:;,|()\n]*?)\s*[(\[]\s*({units})\.?\s*[)\]]\s*:", re.IGNORECASE)


def _filled_in(text: str) -> str:
    """Return what is filled in of a form whose labels each name their unit; the text itself where it is none."""
    labels = list(_label().finditer(text))
    if len(labels) < _FORM or text[: labels[0].start()].strip():
        return text
    ends = [*(label.start() for label in labels[1:]), len(text)]
    said = []
    for label, end in zip(labels, ends, strict=True):
        value = _FILLED.fullmatch(text[label.end() : end].strip(" \t\r\n;,|/"))
        if value is None:
            continue
        said.append(f"{label[1]} {value[1].strip()} {label[2]} {value[2]}".strip())
    return ", ".join(said) or text


def words_of(text: str) -> str:
    """Return the words that a cell holds as JSON: `["Oil on canvas"]`, `[{"name": "painting"}, {"name": "icon"}]`.

    Parameters
    ----------
    text : str
        Of a cell that names a thing, its material or its place.

    Returns
    -------
    str
        "painting; icon", each once; the text itself where it is no such cell, or holds other things than words.
    """
    if len(text) > LONGEST:
        return text
    text = _ENTITY.sub(_unescaped, text)
    if not _LISTED.match(text):
        return text
    found = _parsed(text.strip())
    words = [] if found is None else list(_words(found))
    return text if not words or None in words else "; ".join(dict.fromkeys(filter(None, words)))


def _unescaped(found: re.Match[str]) -> str:
    """Return the sign that a web page writes so: 67&quot; is 67\"."""
    return unescape(found[0])


def _words(of: Any) -> Iterator[str | None]:
    """Yield each word; None for what is none."""
    for one in of if isinstance(of, list) else [of]:
        if isinstance(one, Mapping):
            cells = {str(key).casefold(): value for key, value in one.items()}
            one = next((cells[name] for name in _WORDS if isinstance(cells.get(name), str)), None)  # noqa: PLW2901
        yield one.strip()[:_MOST_WORDS] if isinstance(one, str) else None


def _parsed(text: str) -> Any:
    for read in (json.loads, literal_eval):
        try:
            return read(text)
        except (ValueError, SyntaxError, RecursionError, MemoryError):
            continue
    return None


def _lines(of: Any, part: str, depth: int) -> Iterator[tuple[str, str]]:
    """Yield each measurement in a value, however it is nested: the part that it is of, and what is said of it."""
    if depth > DEEPEST:
        return
    if isinstance(of, list):
        for one in of:
            yield from _lines(one, part, depth + 1)
    elif isinstance(of, Mapping):
        cells = {re.sub(r"[\W_]", "", str(key)).casefold(): value for key, value in of.items()}
        value = _first(cells, _VALUES)
        if value:
            yield _measured(cells, value, part)
            return
        unknown = _unknown(of)
        if unknown:
            yield part, unknown
            return
        unit = _first(cells, _UNITS)
        for key, one in of.items():
            if isinstance(one, Mapping | list):
                yield from _lines(one, part if str(key).casefold() in _ALL else str(key)[:_MOST], depth + 1)
            elif isinstance(one, int | float | str) and not isinstance(one, bool) and str(one) not in ("", unit):
                yield part, f"{str(key)[:_MOST]} {str(one)[:_MOST]} {unit}".strip()
    elif isinstance(of, str) and of.strip():
        yield part, of[:_MOST]


def _unknown(of: Mapping[str, Any]) -> str:
    """Return what one number, one unit and one word say under any names: `{"t": "height", "v": 12, "u": "cm"}`."""
    texts = {
        key: str(one).strip() for key, one in of.items() if isinstance(one, int | float | str) and str(one).strip()
    }
    number = [key for key, text in texts.items() if _FIGURE.fullmatch(text)]
    unit = [key for key, text in texts.items() if text.casefold() in unit_words()]
    words = [text for key, text in texts.items() if key not in (*number, *unit) and text.casefold() in meanings()]
    if len(number) != 1 or len(unit) != 1 or len(words) != 1 or len(texts) != _TOLD:
        return ""
    return f"{words[0]} {texts[number[0]]} {texts[unit[0]]}"


def _measured(cells: Mapping[str, Any], value: str, part: str) -> tuple[str, str]:
    name = _first(cells, _NAMES)
    own = [one for key in _PARTS if (one := _first(cells, (key,))) and one != name and one.casefold() not in _WHOLE]
    said = f"{'' if name.casefold() in _ALL else name} {value} {_first(cells, _UNITS)}".strip()
    return " ".join((part, *own)).strip(), said


def _first(cells: Mapping[str, Any], names: tuple[str, ...]) -> str:
    """Return the first cell of some names that says something, as text."""
    for name in names:
        value = cells.get(name)
        if isinstance(value, Mapping):
            value = next((value[key] for key in ("name", "label", "text", "value") if value.get(key)), None)
        if isinstance(value, str | int | float) and not isinstance(value, bool):
            text = str(value).strip()
            if text.casefold() not in ("", "none", "null"):
                return text[:_MOST]
    return ""
