"""Words of a record in the table of rules: as they stand, or by those that they are kin to.

Kin are plurals, what is small, and compounds by their head.  How far such kinship is to be believed is counted in the
table itself: of the words that it knows, how many are of the class that their own kin would have given them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache, lru_cache
from typing import Annotated

from pydantic import BaseModel, Field

from pipeline.analysis.rule_table import IDEOGRAPH, WORD, RuleTable, fold
from pipeline.tables import table
from pipeline.tables.rows import UNSPACED, Text, checked, once

_ENDINGS = (
    *(("chi", "co"), ("ghi", "go"), ("i", "o"), ("i", "e"), ("e", "a")),
    *(("ina", "a"), ("ino", "o"), ("ino", "e"), ("etta", "a"), ("etto", "o"), ("ello", "o"), ("ella", "a")),
    *(("illa", "a"), ("illo", "o"), ("ita", "a"), ("ito", "o"), ("inha", "a"), ("inho", "o"), ("ette", "e")),
    *(("chen", ""), ("chen", "e"), ("lein", ""), ("lein", "e"), ("etje", ""), ("tje", ""), ("pje", ""), ("je", "")),
    *(("orna", "a"), ("or", "a"), ("ar", ""), ("er", ""), ("ek", ""), ("ki", "ka"), ("y", "a"), ("y", "")),
    *(("lari", ""), ("leri", ""), ("lar", ""), ("ler", ""), ("si", ""), ("su", ""), ("i", ""), ("u", "")),
    *(("ки", "ка"), ("ы", "а"), ("ы", ""), ("и", "а"), ("и", "я"), ("и", "ь"), ("и", ""), ("ик", ""), ("а", "")),
    *(("ов", ""), ("εσ", "α"), ("εσ", "η"), ("οι", "οσ"), ("α", "ο"), ("ια", "ι"), ("ακι", "ι"), ("ακι", "α")),
    *(("ου", "οσ"), ("ασ", "α")),
)
"""Endings of plurals and of what is small, folded, and what stands in their place in the word that a table knows."""
_STEM = 2
"""Letters that must precede an ending such as *statuette."""
_PLURAL = 6
"""Letters from which an e at the end may be that of a plural (Handschuhe): plane is no plan, and cane no can."""
_NO_PLURALS = frozenset({"hermes", "fates", "cannes", "raden"})
"""Names, folded, that look like plurals of the table's words: the god is no herm."""
_RELATED = 4
"""Letters from which a word may be a plural or a small kind of another."""
_HEAD = 5
"""Letters that the head of a compound has at least: natuurtrompet is a trompet."""
_SHORT, _BORNE_OUT = (4, 3), 4
"""Letters of a shorter head, brushpot is a pot, and words of the table that must end so for it to be believed."""
_BEFORE = 3
"""Letters that stand before a head at least."""
_SYLLABLE = re.compile(r"[\u1100-\u1112]")
"""How a syllable of Korean begins, folded."""
_PRIOR, _WEIGHT = 0.75, 2.0
"""How far an ending or a head is believed that no other word tells of, and for how many words that counts.

Three of four words of the table that end as another does are of its class, by endings; by heads two of three, but
those that are listed on their own are rather the exceptions (judgement).
"""
_MOST = 0.9
"""How far kinship is believed at most: no class is sure by it."""


@lru_cache(maxsize=65536)
def known(of: RuleTable, word: str) -> tuple[tuple[tuple[str, ...], str], ...]:
    """Return the known words that a word may end: what must stand before it and the whole, the longest phrase first."""
    able = forms(word)
    whole = [(tuple(phrase.split(" ")[:-1]), phrase) for form in able for phrase in of.by_last.get(form, ())]
    ends = [
        ((), f"*{ending}")
        for form in able
        for ending in of.endings.get(form[-1], ())
        if form.endswith(ending) and len(form) >= len(ending) + (0 if IDEOGRAPH.match(ending) else _STEM)
    ]
    if IDEOGRAPH.search(word):
        # Chinese and Japanese put what a thing is last: of its known endings the longest says it.
        ends += [((), head) for head in heads_of(word) if head in of.by_word]
        ends.sort(key=lambda pair: -len(pair[1].removeprefix("*")))
    if UNSPACED.search(word):
        ends += [((), word[:end]) for end in range(len(word) - 1, 1, -1) if word[:end] in of.by_word]
    return (*sorted(whole, key=lambda pair: -len(pair[0])), *ends)


def forms(word: str) -> tuple[str, ...]:
    """Return a word as it stands, then as the singulars that its ending allows in the languages of the table."""
    if word in _NO_PLURALS:
        return (word,)
    able = [word]
    if len(word) > 3:
        if word.endswith("ies"):
            able.append(word[:-3] + "y")
        bases = [word[: -len(end)] for end in ("s", "es", "n", "en", "x") if word.endswith(end)]
        # tubes are no tubs, but boxes are boxes
        able.extend(base for base in bases if len(base) >= _STEM + 2 or word != f"{base}es" or base[-1:] in "sxzho")
    if len(word) >= _PLURAL and word.endswith("e"):
        able.append(word[:-1])
    return tuple(able)


class _Homograph(BaseModel):
    word: Text
    share: Annotated[float, Field(gt=0.0, lt=1.0)]
    means: Text
    source: Text


@cache
def homographs() -> dict[str, float]:
    """Return the words that name other things in another language, folded, and how far their class is believed."""
    rows = checked(_Homograph, table("homographs"), "homographs.csv", named="word")
    once((row.word for row in rows), "word", "homographs.csv")
    return {fold(row.word): row.share for row in rows}


@lru_cache(maxsize=4096)
def akin(text: str, of: RuleTable) -> tuple[str, float]:
    """Return a name with the words that the table knows for those that it does not, and how far that is to be believed.

    Only of the names of things: in titles too many words end like these.

    Parameters
    ----------
    text : str
        The name of a thing: "alabardina", "vasi", "Krüglein", "natuurtrompet".
    of : RuleTable
        The table.

    Returns
    -------
    (str, float)
        "" where it has none; between 0 and 1.
    """
    shares: list[float] = []

    def base(found: re.Match[str]) -> str:
        own = any(not before for before, _ in known(of, found.group())) or found.group() in _materials()
        kin = None if own else _kin(found.group(), of)
        if kin is None:
            return found.group()
        word, way = kin
        shares.append(_believed(of).get(way, _PRIOR))
        return word

    folded = fold(text)
    other = WORD.sub(base, folded)
    return ("", 0.0) if other == folded else (other, min(shares))


@cache
def _materials() -> frozenset[str]:
    """Return the words for materials, folded: plaster is no small plášť, which is a cloak."""
    return frozenset(fold(word) for row in table("materials") for word in row["words"].split("|"))


@lru_cache(maxsize=65536)
def _kin(word: str, of: RuleTable) -> tuple[str, str] | None:
    """Return the other word of the table that a word is kin to, and by which ending or head; None where it has none."""
    for end, other in _ENDINGS if len(word) >= _RELATED else ():
        base = word.removesuffix(end) + other
        if word.endswith(end) and base != word and base in of.by_word:
            return base, f"-{end}"
    if IDEOGRAPH.search(word):
        return None
    head = next((one for form in forms(word) for one in heads_of(form) if one in of.by_word), None)
    if head is None:
        short = (form[-letters:] for form in forms(word) for letters in _SHORT if len(form) >= letters + _BEFORE)
        head = next((one for one in short if one in _short_heads(of)), None)
    return None if head is None else (head, head)


def heads_of(word: str) -> Iterator[str]:
    """Yield what may be the head of a compound, the longest first; of Korean whole syllables, of signs two at least."""
    if IDEOGRAPH.search(word):
        yield from (word[at:] for at in range(1, len(word) - 1))
        return
    syllables = [found.start() for found in _SYLLABLE.finditer(word)]
    starts = syllables[1:-1] if syllables else range(_BEFORE, len(word) - _HEAD + 1)
    yield from (word[at:] for at in starts)


@lru_cache(maxsize=8)
def _short_heads(of: RuleTable) -> frozenset[str]:
    """Return the short words that the table bears out as heads: three of four words that end so are of their class."""
    counts: dict[str, list[int]] = {}
    for word in of.by_word:
        for head in (word[-letters:] for letters in _SHORT if len(word) >= letters + _BEFORE):
            if " " not in word and head in of.by_word and not IDEOGRAPH.search(word):
                many = counts.setdefault(head, [0, 0])
                many[0] += _classes(word, of) == _classes(head, of)
                many[1] += 1
    return frozenset(
        head for head, (same, many) in counts.items() if many >= _BORNE_OUT and _share(same, many) >= _PRIOR
    )


def _share(same: int, many: int) -> float:
    return (same + _PRIOR * _WEIGHT) / (many + _WEIGHT)


@lru_cache(maxsize=8)
def _believed(of: RuleTable) -> dict[str, float]:
    """Return by ending and head how far each is to be believed, by the words of the table that have it."""
    counts: dict[str, list[int]] = {}
    for word in of.by_word:
        kin = None if " " in word else _kin(word, of)
        if kin is not None:
            many = counts.setdefault(kin[1], [0, 0])
            many[0] += _classes(word, of) == _classes(kin[0], of)
            many[1] += 1
    return {way: min(_MOST, _share(same, many)) for way, (same, many) in counts.items()}


def _classes(word: str, of: RuleTable) -> str:
    return of.by_word[word][0].object_class
