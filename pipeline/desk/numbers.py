"""Numbers as people write them in a cell, in the museum's own units: "8 1/2", "0,3", "30 cm"."""

from pipeline.collection.hand_cell import of_hand
from pipeline.errors import InputError
from pipeline.report.units import Units, significant


def cell_unit(unit: str, units: Units) -> str:
    """Return the unit in which a cell is filled in, for one of Kouros: pounds where lengths are in inches or feet.

    Parameters
    ----------
    unit : str
        SI, or "-".

    Returns
    -------
    str
    """
    return units.symbol(unit)


def _per(unit: str, units: Units) -> float:
    """Return how much of the unit of Kouros is in one of the cell's."""
    return 1.0 / units.factor(unit)


def read_number(text: str, unit: str, units: Units) -> tuple[float, str]:
    """Return what stands in a cell: the number in SI, and the words with their unit.

    Parameters
    ----------
    text : str
        As somebody typed it; it may name a unit of its own.
    unit : str
        Of the number, SI.
    units : Units
        The reader's: those of a number that names none.

    Raises
    ------
    InputError
        For what is no number, or might be two: it says how to write it.
    """
    mine = cell_unit(unit, units)
    try:
        cell = of_hand(text, mine if unit in ("m", "kg") else unit)
    except InputError as problem:
        raise InputError(f"{problem}: write one number, such as 8 1/2 or 0.3") from None
    value, written = cell.value, cell.written
    if not cell.named and unit not in ("m", "kg"):
        # Rounded, so that 30 of a hundredth are 0.3.
        value = float(f"{value * _per(unit, units):.12g}")
        written = f"{written.removesuffix(unit).strip()} {mine}".strip()
    return value, f"about {written}" if cell.about else written


def shown_number(value: float, unit: str, units: Units) -> str:
    """Return a number in SI as a cell shows it, without its unit."""
    return significant(value / _per(unit, units), 6).replace("−", "-")
