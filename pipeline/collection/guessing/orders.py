"""What the texts of a column say of each other: their order, the language of their labels, the unit that some omit.

A source writes alike: what nothing labels is as the head of its column, or its other texts, have it.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from pipeline.collection.dimensions import labels, languages, parse
from pipeline.collection.dimensions.choice import USUAL
from pipeline.collection.dimensions.orders_ahead import is_order
from pipeline.collection.dimensions.result import DimensionPart
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guessing.columns import Column
from pipeline.collection.guessing.names import LEGEND, STROKES, unit_in
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.guessing.questions import asked_unit
from pipeline.collection.record import units_of
from pipeline.collection.sources.measurements import IN_WORDS
from pipeline.quantities import counted

FEWEST = 3
"""Texts that must label their numbers before the others are read in their order (judgement)."""

MOST = 0.9
"""Share of those texts that must have one order."""

FEWEST_UNITS = 3
"""Texts that must name a unit before others are read in it (judgement)."""

ALIKE = 0.95
"""Share of those texts that must name the same, and of texts whose labels a language must know."""

FARTHEST = 8.0
"""How many times larger or smaller the median of what names no unit may be (judgement)."""

_SOME = 1000
"""Texts of a column that are asked."""

_SIDES = frozenset({"height", "width", "depth", "length", "diameter"})
_JOINED = re.compile(r"[x×]", re.IGNORECASE)
_NUMBER = re.compile(r"(?:\d+\s+)?\d+/\d+|\d+(?:[.,]\d+)?[½¼¾⅛⅜⅝⅞]?", re.ASCII)


def tells_orders(column: Column) -> bool:
    """Say whether a column tells in which order another one has its sizes: "height x diameter (mm)".

    Parameters
    ----------
    column : Column
        Any.
    """
    some = column.distinct[:_SOME]
    return bool(some) and sum(map(is_order, some)) >= MOST * len(some)


def with_orders(texts: list[Column], orders: Sequence[Column]) -> list[Column]:
    """Return the column of dimension texts behind that of their orders, where there is one of each.

    Parameters
    ----------
    texts : list of Column
        Those that are read.
    orders : sequence of Column
        Those of the source of which `tells_orders` holds.
    """
    rest = [one for one in texts if one not in orders]
    return [*orders, *rest] if len(orders) == len(rest) == 1 else texts


def section_of(texts: Sequence[Column], prose: Sequence[Column], told: GuessNotes) -> dict[str, Any]:
    """Return how the texts of dimensions are read, the section [dimensions] of a mapping; say what is taken, and ask.

    Parameters
    ----------
    texts : sequence of Column
        Those that are read.
    prose : sequence of Column
        Those of them that were taken for their sentences.
    told : GuessNotes
        What a person chose; what is said and asked goes there.

    Returns
    -------
    dict
        By its keys.
    """
    section: dict[str, Any] = {"columns": [column.name for column in texts]}
    prose = [*prose, *(one for one in texts if one.prose and one not in prose and IN_WORDS not in one.name)]
    if prose:
        section["prose"] = [column.name for column in prose]
    language, said = language_of(texts)
    if language:
        section["language"] = language
        told.doubts.append(said)
    units = {unit_in(column.name)[1] for column in texts} & units_of("height_m").keys()
    unit = told.choices.get("unit") or (units.pop() if len(units) == 1 else _untold(texts, language, prose, told))
    if unit:
        section["unit"] = unit
    order, said = order_of(texts)
    if order:
        section["order"] = list(order)
    told.doubts += [said] * bool(said)
    return section


def _untold(texts: Sequence[Column], language: str, prose: Sequence[Column], told: GuessNotes) -> str:
    """Return the unit of dimension texts that name none, and say so; "" for none."""
    untold = unit_of_texts(texts, language, prose)
    told.doubts += [untold.said] * bool(untold.said)
    if not untold.numbers:
        return untold.unit
    named = [column.name for column in texts if column not in prose]
    return asked_unit(named, untold.numbers, told.doubts, told.questions)


def order_of(columns: Sequence[Column]) -> tuple[tuple[str, ...], str]:
    """Return the order of the numbers that columns of dimension texts leave without labels, and what to say of it.

    Parameters
    ----------
    columns : sequence of Column
        Of dimension texts.

    Returns
    -------
    (tuple of str, str)
        () for height, width, depth; "" where there is nothing to say.
    """
    for column in columns:
        legend = LEGEND.search(column.name) or STROKES.search(column.name)
        order = () if legend is None else _labelled(f"{legend[0]}: {' x '.join('123'[: _many(legend[0])])} cm")
        if len(order) > 1:
            said = f"sizes without labels are {' x '.join(order)}, as the head of {column.name!r} says"
            return ((), "") if order == USUAL[: len(order)] else (order, said)
    texts = [plain_text(text) for column in columns for text in column.distinct[:_SOME] if _JOINED.search(text)]
    told = Counter(order for order in map(_labelled, texts) if len(order) == len(USUAL))
    bare = sum(_is_bare(text) for text in texts)
    if not bare or sum(told.values()) < FEWEST:
        return (), ""
    order, often = told.most_common(1)[0]
    if order[0] == "height":
        return (), ""
    if often < MOST * sum(told.values()):
        return (), (
            f"{bare} texts give sizes without labels, read as {' x '.join(USUAL)}, and those with labels are in "
            f"several orders, {' x '.join(order)} most often: look at them"
        )
    return order, (
        f"{bare} texts give sizes without labels: read as {' x '.join(order)}, as {often} of the column's texts with "
        "labels have it; take order out of [dimensions] where that is wrong"
    )


def language_of(columns: Sequence[Column]) -> tuple[str, str]:
    """Return the language of the labels that texts of dimensions have, and what to say of it.

    "H. 30 cm" alone is a height in English and a length in Hungarian: what most of the column's other texts can only
    be tells.

    Parameters
    ----------
    columns : sequence of Column
        Of dimension texts.

    Returns
    -------
    (str, str)
        "" where each text is read by itself.
    """
    read = [labels(plain_text(text)) for column in columns for text in column.distinct[:_SOME]]
    read = [(those, able) for those, able in read if those]
    sure = Counter(able[0] for those, able in read if len(able) == 1 and len(those) > 1)
    name, often = sure.most_common(1)[0] if sure else ("en", 0)
    meaning = languages()[name].meaning
    known = sum(all(map(meaning, those)) for those, _ in read)
    if name == "en" or often < max(FEWEST, MOST * sum(sure.values())) or known < ALIKE * len(read):
        headed = _headed_in(columns, [those for those, _ in read])
        if not headed or sure.keys() - {headed}:
            return "", ""
        return headed, (
            f"short labels of sizes are read as the language {headed} has them, in which the column is called "
            f"{columns[0].name!r}; take language out of [dimensions] where that is wrong"
        )
    return name, (
        f"short labels of sizes are read as the language {name} has them, which those of {often} of {len(read)} texts "
        "can only be; take language out of [dimensions] where that is wrong"
    )


def _headed_in(columns: Sequence[Column], read: Sequence[frozenset[str]]) -> str:
    """Return the language of a column's own name, where height is no H in it and it knows nearly all of the labels."""
    for name, language in languages().items():
        called = all(_words_of(column).intersection(language.words) for column in columns)
        if not called or language.meaning("H") == "height":
            continue
        known = sum(all(map(language.meaning, those)) for those in read)
        if len(read) >= FEWEST and known >= ALIKE * len(read):
            return name
    return ""


def _words_of(column: Column) -> set[str]:
    plain = column.name.casefold()
    return {plain, *re.findall(r"[^\W\d_]+", plain)}


@dataclass(frozen=True, slots=True)
class UntoldUnits:
    """The texts of columns that name no unit.

    Attributes
    ----------
    unit : str
        That of the others, where they are alike, and it would not make the texts of quite another size; else "".
    numbers : tuple of str
        What stands in the texts, where no other text names a unit either; else ().
    said : str
        What to say of it; "" for nothing.
    """

    unit: str = ""
    numbers: tuple[str, ...] = ()
    said: str = ""


def unit_of_texts(columns: Sequence[Column], language: str, prose: Sequence[Column] = ()) -> UntoldUnits:
    """Return what becomes of the lengths that name no unit, by the columns' other texts.

    Parameters
    ----------
    columns : sequence of Column
        Of dimension texts.
    language : str
        Of their labels; "" where each text is read by itself.
    prose : sequence of Column
        Those of the columns that hold sentences: numbers in them may be anything.

    Returns
    -------
    UntoldUnits
        Empty where all name one.
    """
    held = {id(column) for column in prose}
    texts = [(plain_text(text), id(column) in held) for column in columns for text in column.distinct[:_SOME]]
    read = [_lengths(parse(text, language=language, prose=sentences).parts) for text, sentences in texts]
    bare = [one for one, parts in zip(texts, read, strict=True) if parts and not any(part.unit for part in parts)]
    told = [parts for parts in read if parts and parts[0].unit]
    if not bare:
        return UntoldUnits()
    # A few that name one stray from how the house writes.
    if len(told) < FEWEST_UNITS and len(told) < len(bare):
        numbers = [number for text, sentences in bare if not sentences for number in _NUMBER.findall(text)]
        return UntoldUnits(numbers=tuple(numbers))
    unit, often = Counter(parts[0].unit for parts in told).most_common(1)[0]
    theirs = median(_largest(parts) for parts in told)
    others = median(
        _largest(_lengths(parse(text, language=language, default_unit=unit, prose=sentences).parts))
        for text, sentences in bare
    )
    if len(told) < FEWEST_UNITS or often < ALIKE * len(told) or not theirs / FARTHEST < others < theirs * FARTHEST:
        return UntoldUnits(
            said=f"{counted(len(bare), 'text')} of sizes without a unit: not read; --choose unit=cm (mm, in, ...) "
            "takes one for all of these",
        )
    return UntoldUnits(
        unit,
        said=f"{len(bare)} texts name no unit: read in {unit}, as {often} of {len(told)} others have it; take unit out "
        "of [dimensions] where that is wrong",
    )


def _lengths(parts: Sequence[DimensionPart]) -> list[DimensionPart]:
    return [part for part in parts if part.dimension != "weight"]


def _largest(parts: Sequence[DimensionPart]) -> float:
    return max((part.value or 0.0 for part in parts), default=0.0)


def _many(legend: str) -> int:
    return len(_JOINED.findall(legend)) + 1


def _labelled(text: str) -> tuple[str, ...]:
    """Return the sides of a text in their order, where it labels each; () where it leaves one open."""
    parts = _lengths(parse(text).parts)
    first = [part for part in parts if part.group == parts[0].group]
    sides = tuple(part.dimension for part in sorted(first, key=lambda part: part.start))
    labelled = _SIDES.issuperset(sides) and len(set(sides)) == len(sides) and not any(part.assumed for part in first)
    return sides if labelled else ()


def _is_bare(text: str) -> bool:
    """Whether a text has three sizes of the object itself by their order alone."""
    assumed = Counter(part.group for part in parse(text).parts if part.assumed)
    return any(many == len(USUAL) for many in assumed.values())
