"""Sizes that stand in one column for some objects, and in another of the same name for others."""

from __future__ import annotations

from collections.abc import Sequence

from pipeline.collection.guessing.columns import BOTH, Column, tells
from pipeline.collection.guessing.frames import without_frame
from pipeline.collection.guessing.names import named, path_of, unit_in


def goes_on_in(column: Column, columns: Sequence[Column]) -> Column | None:
    """Return the column that tells of other objects what one tells: the same name, within another list of records.

    "measurements.height" and "component.measurements.height", of which hardly an object has both.

    Parameters
    ----------
    column : Column
        Of a size.
    columns : sequence of Column
        Of the source.
    """
    last = path_of(column.name)[-1]
    for other in columns:
        if other is column or other.name == last or path_of(other.name)[-1] != last or column.name == last:
            continue
        pairs = [(bool(tells(one)), bool(tells(two))) for one, two in zip(column.values, other.values, strict=False)]
        alone, both = pairs.count((False, True)), pairs.count((True, True))
        if alone and both <= BOTH * alone:
            return other
    return None


def framed_first(column: Column, columns: Sequence[Column]) -> tuple[Column, ...]:
    """Return the columns of one size, that with the frame first, that without it last: "Framed H", and "Image H".

    Parameters
    ----------
    column : Column
        Of a size.
    columns : sequence of Column
        Of the source.

    Returns
    -------
    tuple of Column
        Two or three, which tell the same unit; () where there are no such columns.
    """
    what, unit = named(column.name), unit_in(column.name)[1]
    levels: dict[int, tuple[int, int, Column]] = {}
    for place, one in enumerate(columns):
        meant, (name, its) = named(one.name), unit_in(one.name)
        if one.filled and its == unit and meant is not None and what is not None and meant.field == what.field:
            told = without_frame(name)
            level = 1 if told is None else 0 if told[1] else 2
            levels[level] = min(levels.get(level, (meant.rank, place, one)), (meant.rank, place, one))
    return tuple(levels[level][2] for level in sorted(levels)) if len(levels) > 1 else ()
