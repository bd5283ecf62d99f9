"""Names of columns that are letters or words cut short: what they mean beside each other."""

from __future__ import annotations

import re
from collections.abc import Mapping

from pipeline.collection.dimensions import parse
from pipeline.collection.guessing.names import LENGTH, TEXTS, ColumnMeaning, bare, named

_WHOLE = re.compile(r"(?:max|maximum|overall|total|gesamt|totale|totales|tot)\.?\s+(?=\S)", re.IGNORECASE)
"""What is said ahead of a side: "Max W"."""
_LABEL = re.compile(r"[^\W\d_]{1,5}\.?")
"""What may be a label of texts of sizes."""
_LETTERS = {"h": "height_m", "w": "width_m", "b": "width_m", "t": "depth_m", "p": "depth_m", "ø": "diameter_m"}
_SIDES = {"height": "height_m", "width": "width_m", "depth": "depth_m", "diameter": "diameter_m", "length": LENGTH}
_RANK = 99


def short_heads(names: Mapping[int, str], told: set[str]) -> dict[int, ColumnMeaning]:
    """Return what names mean that say nothing by themselves.

    Parameters
    ----------
    names : mapping of int to str
        Of columns of numbers, by what stands for each of them: "H", "Max W", "v. cm", "En".
    told : set of str
        Fields that other columns are called by.

    Returns
    -------
    dict of int to ColumnMeaning
        Of those that mean anything.
    """
    labels = {_WHOLE.sub("", bare(name).strip(" :")): key for key, name in names.items()}
    short = {_last(label.strip(" .")): key for label, key in labels.items()}
    said = {label: key for label, key in labels.items() if _LABEL.fullmatch(label)}
    return max(_turkish(short, told), _letters(short, told), _labels(said, told), key=len)


def _letters(short: Mapping[str, int], told: set[str]) -> dict[int, ColumnMeaning]:
    """Return what single letters mean beside each other: L is a width beside H and P, a length beside H and B."""
    short = {letter: key for letter, key in short.items() if (len(letter) == 1 and letter.isalpha()) or letter == "Ø"}
    folded = {letter.casefold() for letter in short}
    if not folded & {"h", "l", "b", "w"} or not (len(folded) > 1 or told & {"height_m", "width_m"}):
        return {}
    out = {}
    for letter, key in short.items():
        name = _LETTERS.get(letter.casefold())
        if letter.casefold() == "l":
            both = "l" in short and "L" in short
            name = LENGTH if folded & {"b", "w"} or (both and letter == "L") else "width_m"
        elif letter.casefold() == "d":
            name = "depth_m" if folded & {"b", "w"} and not folded & {"t", "p"} else "diameter_m"
        if name is not None:
            out[key] = ColumnMeaning(name, _RANK)
    return out


def _turkish(short: Mapping[str, int], told: set[str]) -> dict[int, ColumnMeaning]:
    """Return what "En" and "Boy" mean beside each other: width, and the height, or else the length."""
    folded = {name.casefold(): key for name, key in short.items()}
    if "en" in folded and told >= {"height_m", "depth_m"} and "width_m" not in told:
        return {folded["en"]: ColumnMeaning("width_m", _RANK)}
    if not {"en", "boy"} <= folded.keys():
        return {}
    upright = LENGTH if "height_m" in told else "height_m"
    return {folded["en"]: ColumnMeaning("width_m", _RANK), folded["boy"]: ColumnMeaning(upright, _RANK)}


def _labels(short: Mapping[str, int], told: set[str]) -> dict[int, ColumnMeaning]:
    """Return what labels mean that a text of sizes tells by each other: v, š and hl are height, width and depth."""
    parts = parse("; ".join(f"{label} {place} cm" for place, label in enumerate(short, 2))).parts
    keys = dict(enumerate(short.values(), 2))
    out: dict[int, ColumnMeaning] = {}
    for part in parts:
        key = keys.get(round(100.0 * part.value)) if part.value is not None else None
        if key is not None and part.dimension in _SIDES:
            out[key] = ColumnMeaning(_SIDES[part.dimension], _RANK)
    fields = {what.field for what in out.values()}
    upright = "height_m" in (fields | told) and len(fields | told) > 1
    return out if upright and len(fields) == len(out) and not fields & told else {}


def _last(name: str) -> str:
    """Return the letter below a word for sizes, "h" of "size.h"; else the name itself."""
    above, point, last = name.rpartition(".")
    sizes = named(above) if point and len(last) == 1 else None
    return last if sizes is not None and sizes.field == TEXTS else name
