"""Whether a table has one row for each measurement, told from what its columns hold."""

from __future__ import annotations

from collections.abc import Sequence

from pipeline.collection.guessing.columns import Column, candidates
from pipeline.collection.guessing.names import plain
from pipeline.collection.sources.base import LongForm
from pipeline.collection.sources.measurement_terms import part_of

VALUES = frozenset(
    {
        *("value", "dimension value", "measurement value", "measurement", "measure", "dimension", "amount"),
        *("wert", "maß", "masswert", "valeur", "mesure", "valore", "misura", "valor", "medida", "waarde", "maat"),
        *("valoare", "値", "数値"),
    }
)
"""Names of columns with the numbers of measurements."""


def long_form_of(columns: Sequence[Column]) -> LongForm | None:
    """Return how a table in long form is read; None for one with a row for each object.

    It is one where a column names kinds of measurements, at least two of them, beside a column of numbers, while object
    numbers repeat or are left empty.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.

    Returns
    -------
    LongForm or None
    """
    types = [c for c in columns if c.kinds >= 0.6 and len(c.distinct) > 1]
    numbers = [c for c in candidates(columns).get("object_number", ()) if c.filled] or [
        c for c in columns if c.filled and c not in types and not c.units
    ][:1]
    if not types or not numbers:
        return None
    object_column, type_column = numbers[0], max(types, key=lambda c: c.kinds)
    # One row an object would name the kind of measurement once for each.
    if len(object_column.distinct) > 0.8 * len(object_column.values):
        return None
    at = list(columns).index(type_column)
    numeric = [c for c in columns if c.numeric and c is not object_column]
    values = [c for c in numeric if plain(c.name) in VALUES] or sorted(
        numeric, key=lambda c: abs(list(columns).index(c) - at)
    )
    if not values:
        return None
    unit = next((c for c in columns if c.units >= 0.6 and c is not type_column), None)
    used = (object_column, type_column, values[0], unit)
    part = next((c for c in columns if not any(c is u for u in used) and _parts(c) >= 0.5), None)
    return LongForm(
        object=object_column.name,
        type=type_column.name,
        value=values[0].name,
        unit=None if unit is None else unit.name,
        part=None if part is None else part.name,
    )


def _parts(column: Column) -> float:
    """Share of a column's texts that name a part that may be measured."""
    some = column.filled[:200]
    return sum(part_of(text) is not None for text in some) / len(some) if some else 0.0
