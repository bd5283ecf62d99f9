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
    """Return the columns of one size with and without the frame, which counts first: "Framed H", and "Image H".

    Parameters
    ----------
    column : Column
        Of a size.
    columns : sequence of Column
        Of the source.

    Returns
    -------
    tuple of Column
        Two, which tell the same unit; () where there are no such two.
    """
    what, unit = named(column.name), unit_in(column.name)[1]
    if what is None:
        return ()
    framed: list[tuple[int, int, Column]] = []
    others: list[tuple[int, int, Column]] = []
    for place, one in enumerate(columns):
        meant, (name, its) = named(one.name), unit_in(one.name)
        if one.filled and its == unit and meant is not None and meant.field == what.field:
            told = without_frame(name)
            (framed if told is not None and told[1] else others).append((meant.rank, place, one))
    return (min(framed)[2], min(others)[2]) if framed and others else ()
