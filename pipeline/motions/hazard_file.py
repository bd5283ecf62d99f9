"""Hazard curve of a site, from a CSV file: an intensity in one column, how often it is exceeded in another."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from math import expm1, isfinite, log1p
from pathlib import Path

from pipeline.motions.errors import refusal
from pipeline.quantities import G
from pipeline.records.fragility import HazardCurve, Measure
from pipeline.resources import small_text

INTENSITIES: dict[str, tuple[Measure, float, float]] = {
    "pga_g": ("pga", G, 10.0),
    "pga_m_s2": ("pga", 1.0, 100.0),
    "pgv_cm_s": ("pgv", 0.01, 1000.0),
    "pgv_m_s": ("pgv", 1.0, 10.0),
}
"""By column: what it measures, how much of SI its unit is, and the most that is believed to be in that unit."""

RATES = ("annual_rate", "return_period_years", "probability_in_50_years")
"""Columns that tell how often."""

YEARS = 50.0
"""Of `probability_in_50_years`."""

LEAST, MOST = 1e-9, 1e3
"""Annual rates that are believed."""


def read_hazard(file: Path) -> HazardCurve:
    """Read a hazard curve.

    Parameters
    ----------
    file : Path
        CSV in UTF-8 with a header row; lines that begin with # are comments.  One column is of `INTENSITIES`, one of
        `RATES`; others are passed over.

    Returns
    -------
    HazardCurve
        In SI, with annual rates.

    Raises
    ------
    MotionError
        Naming the file, the row (line of the file) and the column, with the remedy.
    """
    try:
        lines = small_text(file).lstrip("\ufeff").splitlines()
    except UnicodeDecodeError as error:
        raise refusal(file, "text", str(error), "save it as CSV in UTF-8") from error
    except OSError as error:
        why = f"cannot be read: {error.strerror or error}"
        raise refusal(
            file, "file", why, "put it into the site's folder, and check its permissions and its size"
        ) from error
    told = [(at, line) for at, line in enumerate(lines, start=1) if line.strip() and not line.lstrip().startswith("#")]
    try:
        rows = [(at, [cell.strip() for cell in next(csv.reader([line], strict=True))]) for at, line in told]
    except csv.Error as error:
        raise refusal(file, "CSV", str(error), "mend the line; cells are divided by commas") from error
    if not rows:
        raise refusal(file, "header", "the file says nothing", f"begin with a header such as pga_g,{RATES[0]}")
    header = rows[0][1]
    what, often = (_column(file, header, names) for names in (tuple(INTENSITIES), RATES))
    measure, unit, most = INTENSITIES[what]
    intensities, rates = [], []
    for at, cells in rows[1:]:
        if len(cells) != len(header):
            wrong = f"{len(cells)} cells, and the header has {len(header)}"
            raise refusal(file, f"row {at}", wrong, "give each column one cell")
        given = dict(zip(header, cells, strict=True))
        intensities.append(_number(file, at, what, given[what], most) * unit)
        rates.append(_rate(file, at, often, given[often]))
        if len(rates) > 1 and not intensities[-1] > intensities[-2]:
            wrong = f"{given[what]} is no more than in the row before"
            raise refusal(file, f"row {at}, {what}", wrong, "list the rows by rising intensity, each once")
        if len(rates) > 1 and not rates[-1] < rates[-2]:
            wrong = f"{given[often]}: a stronger shaking cannot come as often as a weaker one, or oftener"
            raise refusal(file, f"row {at}, {often}", wrong, "check both rows, and which column is which")
    if len(rates) < 2:
        raise refusal(file, "rows", f"a curve needs two rows or more, and there is {len(rates)}", "add rows")
    return HazardCurve(measure, tuple(intensities), tuple(rates), file.name)


def _column(file: Path, header: Sequence[str], names: Sequence[str]) -> str:
    there = [name for name in header if name in names]
    if len(there) == 1:
        return there[0]
    wrong = f"{', '.join(there)} are there at once" if there else f"none of {', '.join(names)} is there"
    raise refusal(file, "header", wrong, f"have exactly one of the columns {', '.join(names)}")


def _number(file: Path, row: int, column: str, cell: str, most: float) -> float:
    try:
        value = float(cell)
    except ValueError:
        raise refusal(file, f"row {row}, {column}", f"{cell[:80]!r} is no number", "give a number, as 0.25") from None
    if not (isfinite(value) and 0.0 < value <= most):
        wrong = f"{cell[:80]} is not above 0 and up to {most:g}"
        raise refusal(file, f"row {row}, {column}", wrong, "give a number in the unit that the column's name ends with")
    return value


def _rate(file: Path, row: int, column: str, cell: str) -> float:
    if column == "annual_rate":
        return _believed(file, row, column, cell, _number(file, row, column, cell, MOST))
    if column == "return_period_years":
        return _believed(file, row, column, cell, 1.0 / _number(file, row, column, cell, 1.0 / LEAST))
    chance = _number(file, row, column, cell, 1.0)
    if chance == 1.0:
        wrong = "what is certain within 50 years has no rate"
        raise refusal(file, f"row {row}, {column}", wrong, "give a probability below 1, not in percent")
    return _believed(file, row, column, cell, -log1p(-chance) / YEARS)


def _believed(file: Path, row: int, column: str, cell: str, rate: float) -> float:
    if not LEAST * (1.0 - 1e-9) <= rate <= MOST:
        least, most = -expm1(-YEARS * LEAST), f"{MOST:g}"
        wrong = (
            f"{cell[:80]} is a rate of {rate:.3g} a year; believed are {LEAST:g} (in 50 years {least:.1g}) to {most}"
        )
        raise refusal(file, f"row {row}, {column}", wrong, "check the number and the column's name")
    return rate
