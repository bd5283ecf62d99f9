"""The units, words and labels that the parser knows, from the tables dimension_units, _words and _labels."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import Annotated

from pydantic import Field

from pipeline.tables import table
from pipeline.tables.rows import Entries, Text, checked

_COMPOUND = "compound"
_SPOKEN = "language"
ALIKE = str.maketrans("şţŞŢİıάέήίόύώϊϋΐΰΆΈΉΊΌΎΏ", "șțȘȚIiαεηιουωιυιυΑΕΗΙΟΥΩ")
"""Letters that people write for one another, and in capitals cannot tell apart: the cedillas that stood for the commas
of Romanian and are letters of Turkish, its two i, the accents of Greek.  Texts and tables are read with them replaced.
"""


@dataclass(frozen=True, slots=True)
class LexiconUnit:
    """A unit of the table: one of it is num / den in SI, exactly."""

    name: str
    kind: str
    num: int
    den: int
    smaller: str
    system: str


@dataclass(frozen=True, slots=True)
class LabelLanguage:
    """What short labels mean in a language, and the words that tell that a text is written in it.

    Attributes
    ----------
    name : str
        Of two letters.
    labels : mapping of str to str
        Meanings; the case counts where a language uses it (L longueur, l largeur).
    folded : mapping of str to str
        The same in small letters, for labels in another case than the table's.
    words : frozenset of str
        In small letters.
    """

    name: str
    labels: Mapping[str, str]
    folded: Mapping[str, str]
    words: frozenset[str]

    def meaning(self, label: str) -> str:
        """Return what a label means, "" where the language does not know it."""
        label = label.translate(ALIKE)
        return self.labels.get(label) or self.folded.get(label.lower(), "")


@dataclass(frozen=True, slots=True)
class _Row:
    unit: str
    kind: str
    si: Annotated[Fraction, Field(gt=0)]
    smaller: str
    system: str
    words: Entries


@dataclass(frozen=True, slots=True)
class _Word:
    kind: Text
    meaning: str
    words: Entries


@dataclass(frozen=True, slots=True)
class _Label:
    language: Text
    meaning: Text
    labels: Entries


@cache
def _unit_rows() -> tuple[_Row, ...]:
    return checked(_Row, table("dimension_units"), "dimension_units.csv", named="unit")


@cache
def units() -> dict[str, LexiconUnit]:
    """Return the units by name.

    Returns
    -------
    dict of str to Unit
        Of the table.

    Raises
    ------
    TableError
        Where a unit's value is no decimal number above zero.
    """
    return {
        r.unit: LexiconUnit(r.unit, r.kind, r.si.numerator, r.si.denominator, r.smaller, r.system) for r in _unit_rows()
    }


@cache
def unit_words() -> dict[str, LexiconUnit]:
    """Return the units by every word and mark that stands for one, in small letters."""
    by_name = units()
    return {word.translate(ALIKE): by_name[row.unit] for row in _unit_rows() for word in row.words}


@cache
def meanings() -> dict[str, tuple[str, str]]:
    """Return kind and meaning of every word that is not a unit, in small letters."""
    rows = checked(_Word, table("dimension_words"), "dimension_words.csv", named="words")
    return {
        word.translate(ALIKE): (row.kind, row.meaning) for row in rows if row.kind != _COMPOUND for word in row.words
    }


_WHOLE = re.compile(r"[^\W\d_]+")
"""What the reader of texts takes for one word."""


@cache
def spelled() -> tuple[re.Pattern[str], Mapping[str, str]]:
    """Return words that have marks or blanks in them (ס"מ, đường kính, สูง), and a plain word as long for each.

    Returns
    -------
    pattern : re.Pattern
        Finds them, behind letters too; a text in ASCII has none.
    plain : mapping of str to str
        By the word in small letters, another of the same meaning, filled up with blanks.
    """
    said: dict[tuple[str, str], list[str]] = {}
    for word, (kind, meaning) in meanings().items():
        if kind in ("dimension", "part", "qualifier"):
            said.setdefault((kind, meaning), []).append(word)
    for word, unit in unit_words().items():
        said.setdefault(("unit", unit.name), []).append(word)
    plain = {}
    for words in said.values():
        whole = [word for word in words if len(word) > 1 and word.isascii() and word.isalpha()]
        for word in words:
            fits = next((one for one in whole if len(one) <= len(word)), None)
            if fits and not word.isascii() and not _WHOLE.fullmatch(word) and any(map(str.isalpha, word)):
                plain[word] = fits.ljust(len(word))
    # No assertion before the words: the pattern is searched by their first letters.
    return re.compile("|".join(map(re.escape, sorted(plain, key=len, reverse=True))), re.IGNORECASE), plain


_SHORTENED = 3
"""Letters from which the beginning of a word stands for it (judgement)."""


@lru_cache(maxsize=4096)
def shortened(word: str) -> tuple[str, str] | None:
    """Return what a word cut short says, of which all words of dimensions that begin so say one thing: "lev", leveys.

    Parameters
    ----------
    word : str
        In small letters.

    Returns
    -------
    (str, str) or None
    """
    if len(word) < _SHORTENED or not word.isalpha():
        return None
    told = {said for name, said in meanings().items() if said[0] == "dimension" and name.startswith(word)}
    return told.pop() if len(told) == 1 else None


@cache
def compounds() -> dict[str, tuple[str, ...]]:
    """Return the words that say several things at once, such as Gesamthöhe, with the plain words for them."""
    rows = checked(_Word, table("dimension_words"), "dimension_words.csv", named="words")
    return {
        word.translate(ALIKE): tuple(row.meaning.split()) for row in rows if row.kind == _COMPOUND for word in row.words
    }


@cache
def words_for(*wanted: str) -> frozenset[str]:
    """Return the words for some meanings, those that join a part with the word for size among them."""
    rows = checked(_Word, table("dimension_words"), "dimension_words.csv", named="words")
    return frozenset(word for row in rows if row.meaning in wanted for word in row.words)


@cache
def label_words() -> frozenset[str]:
    """Return the labels of all languages in small letters."""
    return frozenset(label for one in languages().values() for label in one.folded)


@cache
def languages() -> dict[str, LabelLanguage]:
    """Return the languages by name, in the order of the table, which is that of preference."""
    rows = checked(_Label, table("dimension_labels"), "dimension_labels.csv", named="labels")
    out = {}
    for name in dict.fromkeys(row.language for row in rows):
        own = [row for row in rows if row.language == name]
        labels = {label: row.meaning for row in own if row.meaning != _SPOKEN for label in row.labels}
        labels = {label.translate(ALIKE): meaning for label, meaning in labels.items()}
        folded: dict[str, str] = {}
        for label, meaning in labels.items():
            folded.setdefault(label.lower(), meaning)
        words = frozenset(word.translate(ALIKE) for row in own if row.meaning == _SPOKEN for word in row.labels)
        out[name] = LabelLanguage(name, labels, folded, words)
    return out
