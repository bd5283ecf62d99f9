"""Cells of one side that hold more than that: the whole size, 36 x 29 in, or a diameter."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from pipeline.collection.cells import Cells
from pipeline.collection.dimensions import parse
from pipeline.collection.mapping import DIAMETER, ColumnMap
from pipeline.collection.mapping_parts import Texts
from pipeline.collection.measured import fill
from pipeline.quantities import LENGTHS
from pipeline.records import Origin, Problem, Provenance

_SIDES = ("height_m", "width_m", "depth_m")
_MORE = re.compile(r"[^\W\d_]{3,}|\d\s?\S{0,6}\s?[x×]\s?\d|[øØ]", re.IGNORECASE)
"""What a cell that holds more than a number and its unit has."""


Side = tuple[str, ColumnMap, int]
"""A field that is a side of a thing, what the mapping says of it, and where its cell is."""


def sides_among(columns: Sequence[tuple[str, ColumnMap, Sequence[int]]]) -> tuple[Side, ...]:
    """Return the columns of sides that are read from one cell each.

    Parameters
    ----------
    columns : sequence of (str, ColumnMap, sequence of int)
        Fields, what the mapping says of them, and where their cells are.
    """
    return tuple((name, column, at[0]) for name, column, at in columns if name in _SIDES and len(at) == 1)


def read_whole_sizes(
    values: dict[str, Any], cells: Cells, sides: Sequence[Side], row: Sequence[str], mapped: Texts | None
) -> None:
    """Read the cells of one side that tell the whole size, or that the side is a diameter, and say so.

    Parameters
    ----------
    values : dict
        Of the record so far, in SI; changed in place, as are the cells' provenance and problems.
    cells : Cells
        Of the row.
    sides : sequence of Side
        The columns that are looked at.
    row : sequence of str
        The cells.
    mapped : Texts or None
        What the mapping says of texts of dimensions.
    """
    for field, column, at in sides:
        if not _MORE.search(text := row[at]):
            continue
        unit = column.unit if column.unit in LENGTHS else None
        told = {
            part.dimension
            for part in parse(text, default_unit=unit, decimal=cells.decimal).parts
            if part.value is not None
        }
        if values.get(field) is None and (len(told - {"weight"}) > 1 or told == {"diameter"}):
            _fill(values, cells, field, column, text, mapped, unit)
        elif field == "width_m" and told == {"diameter"} and values.get(field) and values.get("depth_m") is None:
            written = next((of.written for of in cells.provenance if of.field == field), "")
            values["depth_m"] = values[field]
            cells.provenance.append(Provenance("depth_m", Origin.DERIVED, written, "its diameter"))


def spread_diameter(values: dict[str, Any], cells: Cells) -> None:
    """Make width and depth of a diameter that a column gives, where it gives neither."""
    diameter = values.pop(DIAMETER, None)
    written = next((of.written for of in cells.provenance if of.field == DIAMETER), "")
    cells.provenance = [of for of in cells.provenance if of.field != DIAMETER]
    for field in ("width_m", "depth_m"):
        if values.get(field) is None:
            values[field] = diameter
            if diameter is not None:
                cells.provenance.append(Provenance(field, Origin.DERIVED, written, "its diameter"))


def _fill(
    values: dict[str, Any],
    cells: Cells,
    field: str,
    column: ColumnMap,
    text: str,
    mapped: Texts | None,
    unit: str | None,
) -> None:
    said = {"unit": unit} if mapped is None else {"unit": unit or mapped.unit, "order": mapped.order}
    name = column.sources[0]
    cells.problems[:] = [one for one in cells.problems if one.field != field]
    fill(values, cells, Texts(columns=(name,), **said), [text], cells.decimal)
    message = f"column {name!r}: {text.strip()[:80]!r} is read as a text of sizes"
    cells.problems.append(
        Problem(field, message, "see that each side is right, and put each number into its own column")
    )
