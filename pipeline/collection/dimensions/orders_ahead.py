"""Orders of sizes that stand in a column of their own, before that of the numbers: "height x diameter (mm)"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pipeline.collection.dimensions.lexicon import meanings, unit_words

_ORDER = re.compile(r"\s*([^\W\d_]+\.?(?:\s*[x×*/]\s*[^\W\d_]+\.?){1,2})\s*[\s,]\(?([^\W\d_]*)\)?\s*")
"""Sides with what joins them, and their unit."""
_LETTERS = frozenset("hwdlbtpø")
_PARTED = re.compile(r"\s*(?:[×*/]|(?<!\w)x(?!\w))\s*", re.IGNORECASE)


def is_order(text: str) -> bool:
    """Say whether a text is no more than the order of sizes, with their unit or without: "height x width (cm)".

    Parameters
    ----------
    text : str
        Of a cell.
    """
    found = _ORDER.fullmatch(f"{text} ")
    if found is None or (found[2] and found[2] not in unit_words()):
        return False
    sides = [side.rstrip(".").casefold() for side in _PARTED.split(found[1])]
    return len(sides) > 1 and all(side in _LETTERS or meanings().get(side, ("",))[0] == "dimension" for side in sides)


def behind_orders(texts: Sequence[str]) -> list[str]:
    """Return texts of one object with each order put before the text that follows it, in place of a text of its own.

    Parameters
    ----------
    texts : sequence of str
        Of its columns, in their order.
    """
    out = list(texts)
    for at, text in enumerate(texts[:-1]):
        if is_order(text):
            out[at], out[at + 1] = "", f"{text.strip()}: {texts[at + 1]}" if texts[at + 1].strip() else ""
    return out
