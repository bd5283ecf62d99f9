"""Columns of height and width that a museum's own texts show to be exchanged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guessing.columns import Column, texts_of_dimensions
from pipeline.collection.source_audit import FEWEST_SIDES

MOST = 0.9
"""Share of the rows that tell one side from the other."""

_LOOKED_AT = 500
_NEAR = 0.02


def exchange_sides(columns: Sequence[Column], found: dict[str, Column], doubts: list[str]) -> None:
    """Exchange the columns of height and width, where nearly all texts show that each holds the other.

    Only the proportion is compared, for the unit of a column is not known yet.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : dict of str to Column
        Field -> column; changes.
    doubts : list of str
        What is to be looked at; grows.
    """
    height, width = found.get("height_m"), found.get("width_m")
    texts = texts_of_dimensions(columns, found.values())
    if height is None or width is None or len(texts) != 1:
        return
    straight = crossed = 0
    for text, high, wide in list(zip(texts[0].values, height.values, width.values, strict=True))[:_LOOKED_AT]:
        said = _proportion(high, wide)
        if said is None or abs(said - 1.0) <= _NEAR:
            continue
        told = list(_proportions(text))
        does = any(abs(one * said - 1.0) <= _NEAR for one in told)
        is_so = any(abs(one / said - 1.0) <= _NEAR for one in told)
        straight, crossed = straight + (is_so and not does), crossed + (does and not is_so)
    if crossed >= FEWEST_SIDES and crossed >= MOST * (straight + crossed):
        found["height_m"], found["width_m"] = width, height
        doubts.append(
            f"columns {height.name!r} and {width.name!r} are exchanged, as the texts of {texts[0].name!r} show in "
            f"{crossed} of {straight + crossed} rows: {width.name!r} is taken for the height; --choose "
            f"height_m={height.name} takes them as they are called"
        )


def _proportions(text: str) -> Iterator[float]:
    """Yield height over width of each part that a text gives both of."""
    sides: dict[int, dict[str, float]] = {}
    for part in parse(plain_text(text)).parts:
        if part.value:
            sides.setdefault(part.group, {}).setdefault(part.dimension, part.value)
    for side in sides.values():
        if "height" in side and "width" in side:
            yield side["height"] / side["width"]


def _proportion(height: str, width: str) -> float | None:
    try:
        high, wide = (float(text.strip().replace(",", ".")) for text in (height, width))
    except ValueError:
        return None
    return high / wide if high > 0.0 and wide > 0.0 else None
