"""Words by which a museum says that something is on display, or lies in a store."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Literal
from unicodedata import normalize

from pipeline.tables import table
from pipeline.tables.rows import Entries, Text, checked

_VISIBLE = re.compile(r"(?:open|visible|visitable|study|schau)[\s-]*$")


@dataclass(frozen=True, slots=True)
class _Words:
    meaning: Literal["shown", "not shown", "store"]
    words: Entries
    source: Text


@cache
def _words() -> dict[str, frozenset[str]]:
    rows = checked(_Words, table("display_words"), "display_words.csv", named="meaning")
    return {row.meaning: frozenset(map(_folded, row.words)) for row in rows}


@cache
def _stores() -> re.Pattern[str]:
    words = sorted(_words()["store"], key=len, reverse=True)
    # Japanese parts no words.
    return re.compile("|".join(rf"(?<!\w){re.escape(w)}(?!\w)" if w.isascii() or w[0] < "\u3000" else w for w in words))


def _folded(text: str) -> str:
    return " ".join(normalize("NFC", text).casefold().split())


def shown(text: str) -> bool | None:
    """Return whether a cell of a flag says yes; None for words that no table has.

    Parameters
    ----------
    text : str
        Such as "ja", "1", "en réserve".

    Returns
    -------
    bool or None
    """
    word = _folded(text).strip(" .")
    return True if word in _words()["shown"] else False if word in _words()["not shown"] else None


def stores_among(places: Iterable[str]) -> list[str]:
    """Return the places whose names say that they are stores: "Depot A, rek 3", but not "Schaudepot".

    Parameters
    ----------
    places : iterable of str
        Names of places.

    Returns
    -------
    list of str
        In the same order.
    """
    return [place for place in places if is_store(place)]


def is_store(place: str) -> bool:
    """Whether the name of a place says that it is a store."""
    text = _folded(place)
    return any(not _VISIBLE.search(text[: found.start()]) for found in _stores().finditer(text))
