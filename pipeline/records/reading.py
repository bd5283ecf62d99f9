"""Account of the rows behind an inventory: how many were refused or are doubted, and which."""

from __future__ import annotations

from dataclasses import dataclass

REFUSED, SOURCE, SHEET, DOUBTFUL = "refused", "source", "sheet", "doubtful"
"""What a doubt is about: a row that became no object; the whole source; a sheet of our own; a value of an object."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that reading refused or doubts.

    Attributes
    ----------
    what : str
        One of the four above.
    row, line : int or None
        Of the source, row 1 the first below the header; None where it is of no row, or not known of which.
    object_number, field : str
        What it is about.
    message, remedy : str
        What is wrong, and what mends it.
    """

    what: str
    row: int | None
    line: int | None
    object_number: str
    field: str
    message: str
    remedy: str


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
    """

    source: str
    rows: int
    refused: int
    doubtful: int
    sheets: int
    suspicions: tuple[tuple[str, str, str], ...]
    flagged: bool
