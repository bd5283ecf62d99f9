"""One cell that holds a number with its unit."""

import re

from pipeline.collection.dimensions import DimensionPart, Dimensions, parse

_SLIPPED = re.compile(r"(\s*\d+,)\s(\d\s*[^\W\d_]+\.?\s*)")
"""A number in whose decimal comma a blank has slipped, all that there is in the cell: 38, 6 cm."""


def written(part: DimensionPart, read: Dimensions) -> str:
    """Return the number of a part as it was written, with the unit that it is in.

    Parameters
    ----------
    part : Part
        Of the text.
    read : Dimensions
        The text that it is of, as it was read.

    Returns
    -------
    str
        The characters, and the unit where they do not hold it.
    """
    characters = read.written(part)
    named = part.unit_text and part.unit_text.casefold() in characters.casefold()
    return characters if named else f"{characters} {part.unit}".strip()


_TONNES = re.compile(r"(?<=\d)\s*(?:t|to|(?<!\A1)(?<!\A1 )ton|тонн[аы]?|т|톤|吨|噸|トン)\.?(?=\s*\Z)", re.IGNORECASE)
"""How tonnes are written in a cell of weights."""


def of_cell(text: str, kind: str, decimal: str) -> tuple[float, str] | None:
    """Return the value and the characters of a cell that holds one number with its unit.

    Parameters
    ----------
    text : str
        The cell.
    kind : {"m", "kg"}
        A length or a mass.
    decimal : {".", ","}
        The source's decimal mark.

    Returns
    -------
    (float, str) or None
        In SI, and as written; None where it does not hold one number with its unit.
    """
    slipped = _SLIPPED.fullmatch(text)
    plain = text if slipped is None else "".join(slipped.groups())
    # In a text of sizes a T is a label: a depth, or Tiefe.
    read = parse(_TONNES.sub(" tonnes", plain) if kind == "kg" else plain, decimal=decimal)
    parts = [part for part in read.parts if part.value is not None]
    if len(parts) != 1 or (parts[0].dimension == "weight") != (kind == "kg") or read.having("remainder"):
        return None
    value = parts[0].value
    return None if value is None else (value, written(parts[0], read))
