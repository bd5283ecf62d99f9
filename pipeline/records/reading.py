"""Account of the rows behind an inventory: how many were refused or are doubted, and which."""

from __future__ import annotations

from dataclasses import dataclass

REFUSED, SOURCE, CHOICE, SHEET, DOUBTFUL = "refused", "source", "choice", "sheet", "doubtful"
"""What a doubt is about: a row that became no object; the whole source; what was settled by choice for all of it; a
sheet of our own; a value of an object."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that reading refused, doubts, or settled by choice.

    Attributes
    ----------
    what : str
        One of the five above.
    row, line : int or None
        Of the source, row 1 the first below the header; None where it is of no row, or not known of which.
    object_number, field : str
        What it is about.
    message, remedy : str
        What is wrong, and what mends it.
    characters : str
        What stands in the museum's record, where that is kept.
    used : str
        What is used of it; "" for nothing.
    """

    what: str
    row: int | None
    line: int | None
    object_number: str
    field: str
    message: str
    remedy: str
    characters: str = ""
    used: str = ""


@dataclass(frozen=True, slots=True)
class Account:
    """Account of the rows behind a version of the inventory.

    Attributes
    ----------
    source : str
        Where they come from.
    rows : int
        How many there are.
    refused : int
        Rows that became no object.
    doubtful : int
        Objects of which a value was refused or is doubted.
    sheets : int
        Rows and cells of sheets of our own that were not used.
    suspicions : tuple of (str, str, str)
        What the whole source seems to have wrong, with what mends it.
    flagged : bool
        Whether a column of the source says what is on display.
    choices : tuple of (str, str, str)
        What was settled for the whole source by choice, with what settles it otherwise.
    """

    source: str
    rows: int
    refused: int
    doubtful: int
    sheets: int
    suspicions: tuple[tuple[str, str, str], ...]
    flagged: bool
    choices: tuple[tuple[str, str, str], ...] = ()
