"""Sizes that stand in one column for some objects, and in another of the same name for others."""

from __future__ import annotations

from collections.abc import Sequence

from pipeline.collection.guessing.columns import BOTH, Column, tells
from pipeline.collection.guessing.names import path_of


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
