"""Rows of held_words.csv: how a thing is held and what it stands on, by the words that museums have for its display."""

import re
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Annotated

from pydantic import BeforeValidator

from pipeline.records import Anchorage, Furniture, Hanging, Mount, Support
from pipeline.tables import table
from pipeline.tables.rows import BUT_NOT, SOME_WORDS, Entries, TableRow, Text, checked

CASES = ("case", "cases", "Schrank", "kast", "Vit", "Vitr", "ケース")
"""Words that name a case where a number follows them, or in a field for cases: else they may be of furniture."""

_JOINED = re.compile("[\u2e80-\u30ff\u3400-\u9fff\uac00-\ud7af]")


def _nothing(cell: object) -> object:
    return None if cell == "" else cell


class HeldWords(TableRow):
    """A row of held_words.csv: what some words tell; what they leave open is empty.

    Attributes
    ----------
    words : tuple of str
        One of which stands in the text; * is up to three words, and = before one that it is the whole text.
    support, hanging, furniture, anchorage, mount
        What they tell.
    source : str
        Who says so.
    """

    words: Entries
    support: Annotated[Support | None, BeforeValidator(_nothing)]
    hanging: Annotated[Hanging | None, BeforeValidator(_nothing)]
    furniture: Annotated[Furniture | None, BeforeValidator(_nothing)]
    anchorage: Annotated[Anchorage | None, BeforeValidator(_nothing)]
    mount: Annotated[Mount | None, BeforeValidator(_nothing)]
    source: Text


@dataclass(frozen=True, slots=True)
class HeldAs:
    """What a text tells of how a thing is displayed; None for what it leaves open."""

    support: Support | None = None
    hanging: Hanging | None = None
    furniture: Furniture | None = None
    anchorage: Anchorage | None = None
    mount: Mount | None = None


@cache
def _rows() -> tuple[tuple[re.Pattern[str], HeldWords], ...]:
    rows = checked(HeldWords, table("held_words"), "held_words.csv", named="words")
    return tuple((re.compile("|".join(map(_pattern, row.words)), re.IGNORECASE), row) for row in rows)


def _pattern(word: str) -> str:
    if word.startswith("="):
        return rf"^\s*{re.escape(word[1:])}\s*$"
    # Chinese, Japanese and Korean part no words from each other.
    inner = re.escape(word).replace(r"\*", SOME_WORDS)
    return inner if _JOINED.search(word) else rf"(?<!\w){inner}(?!\w)"


def _says(pattern: re.Pattern[str], row: HeldWords, text: str) -> bool:
    holds = row.support in (Support.FASTENED, Support.HUNG, Support.SUSPENDED)
    # Where it is told what is not so, or is only meant to be, nothing holds it by these words.
    return any(not (holds and BUT_NOT.search(text[: one.start()])) for one in pattern.finditer(text))


def hangs_above(text: str) -> bool:
    """Whether a text tells that a thing hangs from above; of most titles no row need be asked, which costs 0.3 ms."""
    folded = text.casefold()
    return any(word in folded for word in _above()) and told_by(text).support is Support.SUSPENDED


@cache
def _above() -> frozenset[str]:
    """Return the longest part of each of the words for hanging from above: without it the words are not there."""
    words = (word for _, row in _rows() if row.support is Support.SUSPENDED for word in row.words)
    return frozenset(max(re.split(r"[\s*=]+", word), key=len).casefold() for word in words)


@lru_cache(maxsize=4096)
def told_by(text: str) -> HeldAs:
    """Return what a text tells of how a thing is displayed.

    Parameters
    ----------
    text : str
        In the museum's words.

    Returns
    -------
    HeldAs
        Of each thing that which the first row of the table says whose words are there.
    """
    found = [row for pattern, row in _rows() if _says(pattern, row, text)] if text.strip() else []
    names = ("support", "hanging", "furniture", "anchorage", "mount")
    return HeldAs(
        **{name: next((one for row in found if (one := getattr(row, name)) is not None), None) for name in names}
    )


def words_for(furniture: Furniture) -> tuple[str, ...]:
    """Return the words that tell of a thing what it stands in or on, and nothing else.

    Parameters
    ----------
    furniture : Furniture
        Which.
    """
    alone = [
        row
        for _, row in _rows()
        if row.furniture is furniture and (row.support, row.hanging, row.anchorage, row.mount) == (None,) * 4
    ]
    return tuple(word for row in alone for word in row.words if not word.startswith("="))
