"""One cell that holds a number with its unit."""

from pipeline.collection.dimensions import Dimensions, Part, parse


def written(part: Part, read: Dimensions) -> str:
    """Return the number of a part as it was written, with the unit that it is in."""
    characters = read.written(part)
    named = part.unit_text and part.unit_text.casefold() in characters.casefold()
    return characters if named else f"{characters} {part.unit}".strip()


def of_cell(text: str, kind: str, decimal: str) -> tuple[float, str] | None:
    """Return the value (SI) and the characters of a cell that holds one number with its unit; None where it does not.

    kind : "m" for a length, "kg" for a mass
    """
    read = parse(text, decimal=decimal)
    parts = [part for part in read.parts if part.value is not None]
    if len(parts) != 1 or (parts[0].dimension == "weight") != (kind == "kg") or read.having("remainder"):
        return None
    value = parts[0].value
    return None if value is None else (value, written(parts[0], read))
