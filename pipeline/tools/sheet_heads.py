"""Heads of a survey's sheet that came back: rows that were moved, and columns and units that were written over."""

import re
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.measurement_terms import unit_of
from pipeline.collection.sources.xlsx import first_rows
from pipeline.report.files.marked_copy import CellFault
from pipeline.report.files.sheet_cells import HEADER_ROW

NUMBER = "object_number"

OTHER_BOOKS = (".ods", ".xls", ".xlsm", ".xlsb", ".numbers", ".zip")
"""Files of spreadsheet programs in which no sheet comes back, and what is packed to be mailed."""

_OF_NAME = re.compile(r"(?P<what>.+?) ?\[(?P<unit>[^\[\]]*)\]")
"""The name of a column with its unit: height [cm]."""

_OF_WORDS = re.compile(r".*[(\[](?P<unit>[^()\[\]]*)[)\]]\s*")
"""The words above it, which name the unit last: Height (cm)."""


@dataclass(frozen=True)
class SheetHeads:
    """What is wrong with the heads of a sheet.

    Attributes
    ----------
    faults : tuple of CellFault
        A column each, of which nothing is read.
    lost : frozenset of str
        The names of those that would be read otherwise.
    """

    faults: tuple[CellFault, ...] = ()
    lost: frozenset[str] = frozenset()


def heads_of(path: Path, sheet: str, known: frozenset[str]) -> SheetHeads:
    """Compare the heads of a survey's sheet with what was written there; a column that somebody added is no fault.

    Parameters
    ----------
    path : Path
        The workbook.
    sheet : str
        Name of the sheet.
    known : frozenset of str
        The names that its columns may have.

    Returns
    -------
    SheetHeads
        Columns of which nobody can say in which unit they are, or what they are of.

    Raises
    ------
    CollectionError
        Where the row with the names of the columns is not in its place.
    """
    words, raw = (*first_rows(path, sheet, HEADER_ROW), [], [])[:HEADER_ROW]
    names = [name.strip() for name in raw]
    if NUMBER not in names:
        raise CollectionError(
            f"{path.name}, sheet {sheet!r}: row {HEADER_ROW} does not have the names of the columns, {NUMBER!r} and so "
            "on: it was moved, as when all rows are sorted, or taken out; put it back below the words of row 1"
        )
    faults, lost = [], set()
    for at, name in enumerate(names):
        wanted, unit = _nearest(name, known), "kg" if name.endswith("_kg") else _unit(_OF_NAME, name)
        above = _unit(_OF_WORDS, words[at]) if at < len(words) else ""
        if name and name not in known and wanted:
            remedy = f"call it {wanted!r} again: a cell in another unit says so itself, as 30 cm"
            faults.append(
                CellFault(sheet, HEADER_ROW, name, "is no name of a column, and nothing in it is read", remedy)
            )
        elif name in known and unit and above and unit != above:
            message = f"the words above it say {above}, its name says {unit}, and nothing in it is read"
            lost.add(name)
            faults.append(CellFault(sheet, HEADER_ROW, name, message, f"let both say {unit}"))
    return SheetHeads(tuple(faults), frozenset(lost))


def _unit(pattern: re.Pattern[str], head: str) -> str:
    """Return the length or mass that a head names, "" for none."""
    found = pattern.fullmatch(head.strip())
    return (None if found is None else unit_of(found["unit"])) or ""


def _nearest(name: str, known: frozenset[str]) -> str:
    """Return the column that a name was likely meant for, "" for one that somebody added."""
    found = _OF_NAME.fullmatch(name)
    what = (found["what"] if found else name).casefold().removesuffix("_m").removesuffix("_kg")
    bare = {one.partition(" [")[0].removesuffix("_kg"): one for one in sorted(known)}
    return next((bare[one] for one in get_close_matches(what, bare, 1, 0.8)), "")
