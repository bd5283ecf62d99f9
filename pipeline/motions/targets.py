"""Target spectra from files: a design web service's answer as saved, a uniform hazard spectrum, a conditional one."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.errors import MotionError, refusal
from pipeline.quantities import Array
from pipeline.resources import small_text

Horizontal = Literal["rotd50", "rotd100"]
Choice = Literal["design", "mcer"]

LARGEST = 20.0
"""g, above which a spectral acceleration is in another unit."""

NO_SPREAD = 0.01
"""Standard deviation of ln sa up to which it is none: programs print 0 with rounding."""

_SERVICE: Mapping[Choice, tuple[str, ...]] = {
    "design": ("multiPeriodDesignSpectrum", "twoPeriodDesignSpectrum", "sdSpectrum"),
    "mcer": ("multiPeriodMCErSpectrum", "twoPeriodMCErSpectrum", "smSpectrum"),
}
"""Fields of the service's answer, the best first: editions from 7-22 on have the first, older ones the others."""

_ORDINATES = ("sa_g", "median_sa_g")
_COLUMNS = "period_s,sa_g for a spectrum, period_s,sa_g,ln_sd for a median with its standard deviation"


@dataclass(frozen=True, eq=False)
class TargetSpectrum:
    """A horizontal response spectrum at 5 % damping that motions are chosen for.

    Attributes
    ----------
    name : str
        What it is, in words.
    level : str
        What its level of shaking may be called.
    periods : array, shape (k,)
        In s, increasing.
    psa_g : array, shape (k,)
        Pseudo-acceleration in g; the median where `ln_sd` is given.
    ln_sd : array, shape (k,), or None
        Standard deviation of its natural logarithm; None for a spectrum that only the mean is to match.
    component : str
        The horizontal measure that it is of: "rotd50" or "rotd100".
    why_component : str
        Who says so.
    place : (float, float) or None
        Degrees north and east, where the file says them.
    """

    name: str
    level: str
    periods: Array
    psa_g: Array
    ln_sd: Array | None
    component: Horizontal
    why_component: str
    place: tuple[float, float] | None = None

    @property
    def conditioned_at(self) -> float | None:
        """The period [s] that a conditional spectrum is conditioned on: where it has next to no spread; else None."""
        if self.ln_sd is None or self.ln_sd.min() > NO_SPREAD:
            return None
        return float(self.periods[int(np.argmin(self.ln_sd))])

    def at(self, periods: Array) -> tuple[Array, Array | None]:
        """Return ln of the ordinates [g], and their standard deviation, at other periods.

        Parameters
        ----------
        periods : array, shape (m,)
            In s.

        Returns
        -------
        array, shape (m,)
            By straight lines in log-log.
        array, shape (m,), or None
            By straight lines over the logarithm of the period.

        Raises
        ------
        InputError
            For periods outside of the target.
        """
        low, high = float(self.periods[0]), float(self.periods[-1])
        if periods.min() < low * (1.0 - 1e-9) or periods.max() > high * (1.0 + 1e-9):
            raise InputError(
                f"{self.name} spans {low:g} to {high:g} s, but {periods.min():g} to {periods.max():g} s are asked for; "
                f"narrow --periods, or extend the target"
            )
        known, wanted = np.log(self.periods), np.log(periods)
        mean = np.interp(wanted, known, np.log(self.psa_g))
        return mean, None if self.ln_sd is None else np.interp(wanted, known, self.ln_sd)


def read_target(file: Path, choice: Choice = "design", component: Horizontal | None = None) -> TargetSpectrum:
    """Read a target spectrum; nothing is fetched.

    Parameters
    ----------
    file : Path
        The JSON that the web service of the USGS answers for ASCE 7 (earthquake.usgs.gov/ws/designmaps), as saved; or a
        CSV with the columns period_s and sa_g, or period_s, sa_g and ln_sd, whose lines beginning with # are words.
    choice : {"design", "mcer"}
        Which spectrum of the service's answer.
    component : {"rotd50", "rotd100"} or None
        The horizontal measure that the ordinates are of; None takes ASCE 7's maximum direction (RotD100) for the
        service's answer, and RotD50 for a CSV.

    Returns
    -------
    TargetSpectrum

    Raises
    ------
    MotionError
        Naming the file, the row or field, what is wrong and the remedy.
    """
    try:
        text = small_text(file).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        raise refusal(file, "file", "is no text in UTF-8", "give the JSON or CSV as it was saved") from error
    except OSError as error:
        raise refusal(file, "file", f"cannot be read: {error.strerror or error}", "name a target spectrum") from error
    if file.suffix.lower() == ".json" or text.lstrip().startswith("{"):
        return _service(file, text, choice, component)
    return _table(file, text, component)


def _service(file: Path, text: str, choice: Choice, component: Horizontal | None) -> TargetSpectrum:
    try:
        answer = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        raise refusal(file, "JSON", str(error), "save the service's answer again, whole") from error
    request = _within(answer, "request")
    if request.get("status") == "error":
        told = str(answer.get("response", ""))[:200]
        raise refusal(file, "request.status", f"the service answered with an error: {told}", "ask it again")
    data = _within(answer, "response", "data")
    field = next((name for name in _SERVICE[choice] if data.get(name)), None)
    if field is None:
        there = ", ".join(name for names in _SERVICE.values() for name in names if data.get(name)) or "none"
        wrong = f"has none of {', '.join(_SERVICE[choice])}; of spectra it has {there}"
        raise refusal(file, "response.data", wrong, "save the answer of asce7-22.json, or choose another --spectrum")
    key = f"response.data.{field}"
    periods, ordinates = _service_columns(file, key, data[field])
    edition = str(request.get("referenceDocument") or "ASCE 7 design map service")
    asked = _within(request, "parameters")
    of = [f"{asked[name]}" for name in ("siteClass", "riskCategory") if name in asked]
    where = [float(v) for name in ("latitude", "longitude") if isinstance(v := asked.get(name), (int, float))]
    place = (where[0], where[1]) if len(where) == 2 else None
    told = f", site class and risk category {' and '.join(of)}" if of else ""
    if place is not None:
        told += f", at {place[0]:g}, {place[1]:g}"
    if component is None:
        # ASCE 7 has been in the maximum direction since 2010; 7-05 is a geometric mean, which RotD50 is closest to.
        component = "rotd50" if "05" in edition else "rotd100"
        why = f"{edition} is of the {'geometric mean' if component == 'rotd50' else 'maximum direction'}"
    else:
        why = "as asked"
    return TargetSpectrum(
        name=f"{edition}, {field}{told}",
        level=f"{edition} {'design' if choice == 'design' else 'MCER'}",
        **_checked(file, key, periods, ordinates, None),
        component=component,
        why_component=why,
        place=place,
    )


def _within(value: Any, *keys: str) -> dict[str, Any]:
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value if isinstance(value, dict) else {}


def _service_columns(file: Path, place: str, found: Any) -> tuple[Sequence[Any], Sequence[Any]]:
    if isinstance(found, dict) and isinstance(found.get("periods"), list) and isinstance(found.get("ordinates"), list):
        if len(found["periods"]) != len(found["ordinates"]):
            wrong = f"has {len(found['periods'])} periods and {len(found['ordinates'])} ordinates"
            raise refusal(file, place, wrong, "save the service's answer again")
        return found["periods"], found["ordinates"]
    if isinstance(found, list) and all(isinstance(pair, list) and len(pair) == 2 for pair in found):
        return [pair[0] for pair in found], [pair[1] for pair in found]
    wrong = "is neither {periods, ordinates} nor a list of pairs"
    raise refusal(file, place, wrong, "save the service's answer as it came")


def _table(file: Path, text: str, component: Horizontal | None) -> TargetSpectrum:
    lines = [(at, line) for at, line in enumerate(text.splitlines(), start=1) if line.strip()]
    words = [line.lstrip("# ").strip() for _, line in lines if line.lstrip().startswith("#")]
    rows = [(at, next(csv.reader(io.StringIO(line)))) for at, line in lines if not line.lstrip().startswith("#")]
    head = [cell.strip().lower() for cell in rows[0][1]] if rows else []
    ordinate = next((name for name in _ORDINATES if name in head), None)
    if "period_s" not in head or ordinate is None:
        row = f"row {rows[0][0]}" if rows else "file"
        raise refusal(file, row, f"the columns are {', '.join(head) or 'none'}", f"name them: {_COLUMNS}")
    names = ["period_s", ordinate, *(["ln_sd"] if "ln_sd" in head else [])]
    columns: dict[str, list[float]] = {name: [] for name in names}
    for at, cells in rows[1:]:
        for name in names:
            cell = cells[head.index(name)].strip() if head.index(name) < len(cells) else ""
            try:
                columns[name].append(float(cell))
            except ValueError as error:
                wrong = f"{cell!r} is no number" if cell else "is empty"
                raise refusal(file, f"row {at}, {name}", wrong, "write a number with a decimal point") from error
    numbers = [at for at, _ in rows[1:]]
    sd = columns.get("ln_sd")
    kind = "conditional median and standard deviation" if sd else "spectrum"
    return TargetSpectrum(
        name=f"{kind} of {file.name}" + (f" ({words[0][:200]})" if words else ""),
        level="design",
        **_checked(file, "", columns["period_s"], columns[ordinate], sd, rows=numbers, ordinate=ordinate),
        component=component or "rotd50",
        why_component="as asked" if component else "a CSV is taken to be of RotD50; --component says otherwise",
    )


def _checked(
    file: Path,
    place: str,
    periods: Sequence[Any],
    ordinates: Sequence[Any],
    ln_sd: Sequence[float] | None,
    *,
    rows: Sequence[int] = (),
    ordinate: str = "ordinates",
) -> dict[str, Any]:
    """The columns as arrays, from the first period above 0: at 0 s stands the peak ground acceleration."""

    def refused(at: int, column: str, wrong: str, remedy: str) -> MotionError:
        named = f"row {rows[at]}, {column}" if rows else f"{place}, {column}, entry {at + 1}"
        return refusal(file, named, wrong, remedy)

    short = "period_s" if rows else "periods"
    for at, (period, value) in enumerate(zip(periods, ordinates, strict=True)):
        for column, number in ((short, period), (ordinate, value)):
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not math.isfinite(number):
                raise refused(at, column, f"{number!r} is no number", "correct it")
        if period < 0.0:
            raise refused(at, short, f"{period:g} is below 0", "give periods in s")
        if value <= 0.0:
            raise refused(at, ordinate, f"{value:g} is not above 0", "give accelerations in g")
        if value > LARGEST:
            raise refused(at, ordinate, f"{value:g} g is no spectral acceleration", "give it in g, not in % or cm/s2")
    for at, (before, after) in enumerate(pairwise(periods), start=1):
        if after <= before:
            raise refused(at, short, f"{after:g} s follows {before:g} s", "sort the periods, each once")
    for at, sd in enumerate(ln_sd or ()):
        if not (math.isfinite(sd) and 0.0 <= sd <= 3.0):
            raise refused(at, "ln_sd", f"{sd:g} is none", "give the standard deviation of ln sa, 0 to 3")
    first = 1 if len(periods) and periods[0] == 0.0 else 0
    if len(periods) - first < 2:
        wrong = f"has {len(periods) - first} periods above 0 s"
        raise refusal(file, place or "rows", wrong, "give at least two")
    return {
        "periods": np.array(periods[first:], dtype=np.float64),
        "psa_g": np.array(ordinates[first:], dtype=np.float64),
        "ln_sd": None if ln_sd is None else np.array(ln_sd[first:], dtype=np.float64),
    }
