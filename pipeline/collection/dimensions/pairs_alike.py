"""Sizes of both pieces of a pair behind one label: "像高(阿形)82.0 (吽形)84.0", "H. (left) 82 cm, (right) 84 cm"."""

from __future__ import annotations

import re

from pipeline.collection.dimensions.lexicon import label_words, meanings, unit_words

_ONE = r"(?:[(（]\s*([^\W\d_]{1,12})\s*[)）]|([左右]|阿形?|吽形?))\s*[:：]?\s*"
_NUMBER = r"(\d{1,4}(?:[.,]\d{1,3})?)"
_UNIT = r"(\s?(?:mm|cm|m|in)\b\.?|㎝|㎜|センチ|厘米|公分)?"
_PAIR = re.compile(rf"(?<=[^\W\d_]|[.:：]|\s){_ONE}{_NUMBER}{_UNIT}[\s,;、・/]*{_ONE}{_NUMBER}{_UNIT}")
"""A piece of a pair with its size, and the other one with its own."""
_EACH = re.compile(r"各(?=[縦横高長幅径総像全])")
"""Of each of them, right before a label."""


def larger_of_pair(text: str) -> str:
    """Return a text with the larger size alone where both pieces of a pair have one behind a label; as long as before.

    Parameters
    ----------
    text : str
        Of dimensions.
    """
    if text.isascii() and "(" not in text:
        return text
    return _PAIR.sub(_larger, _EACH.sub(" ", text))


def _larger(found: re.Match[str]) -> str:
    names = {(found[at] or found[at + 1]).casefold() for at in (1, 5)}
    if len(names) < 2 or any(name in meanings() or name in label_words() or name in unit_words() for name in names):
        return found[0]  # of a part, or of one side
    one, two = (float(number.replace(",", ".")) for number in (found[3], found[7]))
    keep = 3 if one >= two else 7
    if not found[4] and found[8]:  # the unit of both
        return f"{found[keep]}{found[8]}".rjust(len(found[0]))
    start, end = found.start(keep) - found.start(), (found.end(keep + 1) if found[keep + 1] else found.end(keep))
    return f"{' ' * start}{found[0][start : end - found.start()]}".ljust(len(found[0]))
