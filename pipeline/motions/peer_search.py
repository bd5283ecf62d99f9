"""The table of a PEER ground motion search: what it says of each file of acceleration that came with it.

Some lines of words, then a table with a line of names that begins "Record Sequence Number", then more lines of words.
The database holds processed records alone.

source : _SearchResults.csv of a download from the PEER NGA-West2 database
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pipeline.errors import InputError
from pipeline.motions.errors import refusal
from pipeline.resources import small_text

_FIRST = "record sequence number"

_FILES = ("horizontal-1 acc. filename", "horizontal-2 acc. filename", "vertical acc. filename")


@dataclass(frozen=True, slots=True)
class SearchRow:
    """A record of the search.

    Attributes
    ----------
    number : str
        The record sequence number (RSN).
    event : str
        The earthquake, with its year.
    station : str
        Its name.
    magnitude, rupture_km : float or None
        Moment magnitude; distance to the rupture (Rrup) in km.
    scale : float or None
        The factor that the search asks for, where it is not 1.
    """

    number: str
    event: str
    station: str
    magnitude: float | None
    rupture_km: float | None
    scale: float | None


def read_search(file: Path) -> Mapping[str, SearchRow] | None:
    """Return the rows of a search by the names of their files of acceleration, in capitals.

    Parameters
    ----------
    file : Path
        Any file.

    Returns
    -------
    mapping of str to SearchRow, or None
        None for a file that is no such table.

    Raises
    ------
    MotionError
        Naming the line, where a number is none.
    """
    if file.suffix.lower() != ".csv":
        return None
    with file.open("rb") as stream:
        if _FIRST.encode() not in stream.read(65_536).lower():
            return None
    try:
        lines = small_text(file).splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise refusal(file, "file", f"cannot be read ({error})", "fetch the search's table again") from error
    begin = next((i for i, line in enumerate(lines) if line.strip(' "\ufeff').lower().startswith(_FIRST)), None)
    if begin is None:
        return None
    names = [name.strip().lower() for name in next(csv.reader([lines[begin]]))]
    if not set(_FILES[:2]) <= set(names):
        wrong = f"names no {' and no '.join(sorted(set(_FILES[:2]) - set(names)))}"
        raise refusal(file, f"line {begin + 1}", wrong, "fetch the search's table again")
    found: dict[str, SearchRow] = {}
    for at, line in enumerate(lines[begin + 1 :], start=begin + 2):
        cells = [cell.strip() for cell in next(csv.reader([line]), [])]
        said = dict(zip(names, cells, strict=False))
        if not said.get(_FIRST, "").isdigit():
            break
        try:
            row = _row(said)
        except InputError as error:
            raise refusal(file, f"line {at}", str(error), "mend the line, or fetch the table again") from error
        for name in _FILES:
            if said.get(name, "").lower().endswith(".at2"):
                found[said[name].upper()] = row
    return found


def _row(said: Mapping[str, str]) -> SearchRow:
    year = said.get("year", "")
    scale = _number(said, "scale factor", 0.0)
    return SearchRow(
        number=said[_FIRST],
        event=f"{said.get('earthquake name', '').strip(chr(34) + ' ')} {year}".strip(),
        station=said.get("station name", "").strip('" '),
        magnitude=_number(said, "magnitude", -5.0, 10.0),
        rupture_km=_number(said, "rrup (km)", 0.0, 20_040.0),
        scale=None if scale in {None, 0.0, 1.0} else scale,
    )


def _number(said: Mapping[str, str], name: str, least: float, most: float = 1e6) -> float | None:
    """A number of a row; None where the table has none, which it writes as -, -999 or nothing."""
    text = said.get(name, "")
    if text in {"", "-", "--"}:
        return None
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{name}: expected a number, found {text[:40]!r}") from None
    if value <= -999.0:
        return None
    if not least <= value <= most:
        raise InputError(f"{name}: {text[:40]} is not between {least:g} and {most:g}")
    return value
