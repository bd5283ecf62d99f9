"""In which order a source writes sizes that nothing labels: as the head of its column, or its other texts, have it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.choice import USUAL
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guessing.columns import Column
from pipeline.collection.guessing.names import LEGEND

FEWEST = 3
"""Texts that must label their numbers before the others are read in their order (judgement)."""

MOST = 0.9
"""Share of those texts that must have one order."""

_SOME = 1000
"""Texts of a column that are asked."""

_SIDES = frozenset({"height", "width", "depth", "length", "diameter"})
_JOINED = re.compile(r"[x×]", re.IGNORECASE)


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
        legend = LEGEND.search(column.name)
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


def _many(legend: str) -> int:
    return len(_JOINED.findall(legend)) + 1


def _labelled(text: str) -> tuple[str, ...]:
    """Return the sides of a text in their order, where it labels each; () where it leaves one open."""
    parts = [part for part in parse(text).parts if part.dimension != "weight"]
    first = [part for part in parts if part.group == parts[0].group]
    sides = tuple(part.dimension for part in sorted(first, key=lambda part: part.start))
    labelled = _SIDES.issuperset(sides) and len(set(sides)) == len(sides) and not any(part.assumed for part in first)
    return sides if labelled else ()


def _is_bare(text: str) -> bool:
    """Whether a text has three sizes of the object itself by their order alone."""
    assumed = Counter(part.group for part in parse(text).parts if part.assumed)
    return any(many == len(USUAL) for many in assumed.values())
