"""Names of columns that stand in several rows, one above the other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from pipeline.collection.sources.measurement_terms import unit_of

BETWEEN = " / "
"""What stands between an upper and a lower name."""


def is_of_units(row: Sequence[str]) -> bool:
    """Whether all that a row of a head says is units."""
    said = [cell for cell in row if cell.strip()]
    return bool(said) and all(unit_of(cell) for cell in said)


def numbered_heads(many: int) -> list[str]:
    """Return names for the columns of a table that has none: "column 1", "column 2" and so on."""
    return [f"column {place}" for place in range(1, many + 1)]


def joined_heads(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the names that rows of a head give together: "Size (cm)" above "H" is "Size (cm) / H".

    An upper name holds for the empty cells to its right, as long as a lower name stands below each.

    Parameters
    ----------
    rows : sequence of sequences of str
        From the uppermost down.

    Returns
    -------
    list of str
        As many as the widest row has cells.

    Examples
    --------
    >>> joined_heads([["No.", "Size (cm)", "", "Place"], ["", "H", "W", ""]])
    ['No.', 'Size (cm) / H', 'Size (cm) / W', 'Place']
    >>> joined_heads([["No.", "Height", "Weight"], ["", "cm", "kg"]])
    ['No.', 'Height (cm)', 'Weight (kg)']
    """
    *others, last = rows
    if others and is_of_units(last):
        named = joined_heads(others)
        units = [*last, *[""] * (len(named) - len(last))]
        return [f"{name} ({unit.strip()})" if unit.strip() else name for name, unit in zip(named, units, strict=False)]
    width = max(map(len, rows))
    cells = [[*(" ".join(cell.split()) for cell in row), *[""] * (width - len(row))] for row in rows]
    for upper, lower in pairwise(cells):
        group = ""
        for at in range(width):
            if upper[at]:
                group = upper[at] if lower[at] else ""
            elif group and lower[at]:
                upper[at] = group
            else:
                group = ""
    return [BETWEEN.join(dict.fromkeys(filter(None, (row[at] for row in cells)))) for at in range(width)]
