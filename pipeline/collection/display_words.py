"""Words by which museums say what is on display, in flags and names of places (tables/display_words.csv)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal
from unicodedata import normalize

from pipeline.tables import table
from pipeline.tables.ideographs import shortened_signs
from pipeline.tables.rows import Entries, checked

_SEGMENTS = re.compile(r"[,;>/|:()\[\]\u2013\u2014]|\s-\s")
_EACH = re.compile(r"\s*[/|]\s*")
_BETWEEN = re.compile(r"[\s_.\-\u2010\u2011]+")
_CODE = re.compile(r"(?:no|nr|n°|nº)?[\w°º]{0,2}\d*[\w]?|\d[\w]*", re.IGNORECASE)
_COMPOUND = re.compile(r"\w{3,}(?:depot|magazin|magasin|varasto|förråd)s?")
_MOST_BESIDE = 3
_MOST_FLAGS, _LONGEST_FLAG = 40, 80
_CJK = re.compile("[\u0e00-\u0eff\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7af]")
_DENYING = "非未不沒没無无비미"
"""Signs that deny the word that follows: 비전시 is what 전시 is not."""


@dataclass(frozen=True, slots=True)
class _Words:
    words: Entries
    meaning: Literal["yes", "no", "shown", "away", "store", "workroom", "code", "gallery", "lender", "none"]


@cache
def _meant() -> Mapping[str, frozenset[str]]:
    """Return the words of each meaning."""
    found: dict[str, set[str]] = {}
    for row in checked(_Words, table("display_words"), "display_words.csv", named="meaning"):
        found.setdefault(row.meaning, set()).update(_folded(word) for word in row.words)
    return {meaning: frozenset(words) for meaning, words in found.items()}


def _folded(text: str) -> str:
    return _BETWEEN.sub(" ", shortened_signs(normalize("NFKC", text)).casefold()).strip()


def flag_of(text: str, *, display: bool = False) -> bool | None:
    """Return what the text of a flag says.

    Parameters
    ----------
    text : str
        Of a cell.
    display : bool
        Whether the flag is that of being on display, which may also be said by "on view" or by a place.

    Returns
    -------
    bool or None
        None for words that are not known.
    """
    short = len(text) <= _LONGEST_FLAG and _EACH.search(text) is not None
    both = [flag_of(part, display=display) for part in _EACH.split(text)] if short else []
    if both and both[0] is not None and set(both) == {both[0]}:
        # "Oui / Yes": the same in each of a museum's languages.
        return both[0]
    folded, meant = _folded(text), _meant()
    if folded in meant["yes"] or folded in meant["no"]:
        return folded in meant["yes"]
    if not display:
        return None
    if folded in meant["shown"]:
        return True
    if says_away(text):
        return False
    said = [word for word in meant["shown"] if _CJK.search(word) and word in folded]
    return not any(sign + word in folded for sign in _DENYING for word in said) if said else None


def says_shown(text: str) -> bool:
    """Say whether a text says that something is on display, and where it is not: "On view", "Teşhir"."""
    return _folded(text) in _meant()["shown"]


def tells_nothing(text: str) -> bool:
    """Say whether a text tells that there is nothing, or that nobody knows: a dash, "none", "n/a", "keine".

    Parameters
    ----------
    text : str
        Of a cell that is not empty.
    """
    return not any(map(str.isalnum, text)) or _folded(text) in _meant()["none"]


def says_flags(texts: Sequence[str]) -> bool:
    """Say whether texts of a column are those of a flag of being on display, and not only numbers or yes and no.

    Parameters
    ----------
    texts : sequence of str
        Of its cells that are not empty.

    Returns
    -------
    bool
    """
    each = set(texts)
    if len(each) > _MOST_FLAGS or max(map(len, each), default=0) > _LONGEST_FLAG:
        return False
    known = {flag_of(text, display=True) for text in each}
    words = {_folded(text) for text in each} - _meant()["yes"] - _meant()["no"]
    return bool(words) and None not in known and True in known


_LONG = 7
"""Letters from which a word that another begins with is no chance."""
_NAMES = re.compile(r"\w+")
_STUDY = "study"
"""A word of what is open ("study collection") that print rooms have too ("study room")."""


@lru_cache(maxsize=65536)
def says_away(location: str) -> bool:
    """Say whether the name of a place, or what stands in its stead, says that what is there is not on display.

    Parameters
    ----------
    location : str
        As the museum writes it, such as "Not on View", "Depot 3", "Réserve sculptures" or "On loan to the Tate".

    Returns
    -------
    bool
        False for "Open Storage", "General Store" and "On loan from a private collection".
    """
    meant = _meant()
    whole = _folded(location)
    if not whole:
        return False
    if _CJK.search(whole):
        return any(word in whole for word in (*meant["away"], *meant["store"]) if _CJK.search(word))
    named = meant["gallery"].intersection(whole.split())
    # Most are not there at all, which is seen at once.
    away = [phrase for phrase in meant["away"] if phrase in whole and (" " in phrase or not named)]
    if any(_says(whole, phrase, meant["lender"]) for phrase in away):
        return True
    segments = [segment for segment in map(_folded, _SEGMENTS.split(location)) if segment]
    # Ausstellungsraum begins as Ausstellung does.
    rooms = tuple(word for word in meant["gallery"] if len(word) >= _LONG)
    shown = any(word in meant["gallery"] - {_STUDY} or word.startswith(rooms) for word in _NAMES.findall(whole))
    work = [(segment, phrase) for segment in segments for phrase in meant["workroom"] if phrase in segment]
    kept = any(_says(segment, phrase, frozenset()) for segment, phrase in work)
    return (kept and not shown) or any(map(_is_store, segments))


def _says(whole: str, phrase: str, lenders: frozenset[str]) -> bool:
    at = whole.find(phrase)
    if at < 0 or (at and whole[at - 1].isalnum()):
        return False
    rest = whole[at + len(phrase) :]
    return not rest[:1].isalnum() and (rest.split() or [""])[0] not in lenders


def _is_store(segment: str) -> bool:
    meant = _meant()
    words = segment.split()
    if meant["gallery"].intersection(words):
        return False
    for length in (2, 1):
        for at in range(len(words) - length + 1):
            word = " ".join(words[at : at + length])
            others = words[:at] + words[at + length :]
            if word in meant["store"] or _COMPOUND.fullmatch(word):
                return len(others) <= _MOST_BESIDE
            if word in meant["code"] and at == 0 and all(_CODE.fullmatch(other) for other in others):
                return True
    return False
