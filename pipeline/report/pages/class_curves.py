"""Fragility of classes of objects: the mean of the curves of their objects on display, fitted again.

What is added up are whole millionths, so that no sum hangs on the order of pages.
"""

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import inf

import numpy as np

from pipeline.analysis.fragility.counts import fit_counts
from pipeline.quantities import G
from pipeline.records import Assessment, Fragility, Tally
from pipeline.records.fragility import ABOVE, BELOW, HARM
from pipeline.report.language import _, local
from pipeline.report.pages.judging import in_g
from pipeline.report.text import clean, count, safe_cell, words
from pipeline.report.units import percent

GRID = tuple(float(f"{a:.4g}") for a in np.geomspace(0.02, 4.0, 24))
"""Peak accelerations of the floor at which curves are added up [g]."""

MUSEUM = ""
"""In place of a class: all that is on display."""

UNIT = 1_000_000
"""Of a probability that is added up."""

FLATTEST = 5.0
"""The largest dispersion [-] that is looked for: objects of a class may differ in much."""

OBJECTS, CURVES, TOLD, HARMED = "objects", "curves", "told", "harmed"

COLUMNS = (
    "object_class", "objects", "curves", "median_g", "median_is", "dispersion", "largest_difference",
    "objects_with_rate", "expected_harmed_50_years", *(f"p_{a:g}_g" for a in GRID),
)  # fmt: skip
FILE = "fragility_classes.csv"


@dataclass(frozen=True, slots=True)
class ClassCurve:
    """The mean fragility of a class.

    Attributes
    ----------
    object_class : str
        "" for the whole museum.
    objects, curves : int
        How many objects it is of, and how many of these have a curve of their own.
    mean : tuple of float or None
        At `GRID`, the probability that one of them comes to harm; None where that is not known of all.
    median, dispersion : float or None
        Of the lognormal through it [g], [-]; None where it does not pass a half within what is known.
    bound : str
        Where the median is not known, ABOVE or BELOW what is known; "" where nothing is.
    limit : float or None
        That up to which, or from which on, it is known [g].
    difference : float or None
        By how much mean and lognormal differ at most [-].
    told : int
        Of how many objects it is known how often they come to harm.
    harmed : float or None
        How many of these are expected to come to harm within 50 years; None where that is known of none.
    """

    object_class: str
    objects: int
    curves: int
    mean: tuple[float | None, ...]
    median: float | None
    dispersion: float | None
    bound: str
    limit: float | None
    difference: float | None
    told: int
    harmed: float | None


@dataclass(frozen=True, slots=True)
class ClassCurveView:
    """A class in words: from what shaking on its objects come to harm, and the numbers behind that."""

    name: str
    objects: str
    median: str
    dispersion: str
    difference: str
    harmed: str


def curve_sums(shown: Iterable[Assessment]) -> dict[str, dict[str, int]]:
    """Add up the fragilities of objects on display, by class and of the whole museum.

    Returns
    -------
    dict
        By class: objects, curves, rates that are told, chances within 50 years, and for each of `GRID` by its place the
        probabilities, and by "n" and its place of how many objects these are known; all in whole numbers.
    """
    out: dict[str, dict[str, int]] = {}
    for one in shown:
        if not one.fragilities:
            continue
        first = one.fragilities[0]
        mine = _shares(first)
        for name in (MUSEUM, one.scene.object_class):
            sums = out.setdefault(name, {})
            for key, value in mine.items():
                sums[key] = sums.get(key, 0) + value
    return out


def _sound(f: Fragility) -> bool:
    """Say whether its numbers are those of a curve: of what was stored by whatever version nothing else is added up."""
    rates = (one for one in (f.annual_rate, f.rate_low, f.rate_high) if one is not None)
    counted = all(0.0 < at < inf and 0 <= hurt <= there and there > 0 for at, there, hurt in f.stripes)
    return 0.0 < f.median < inf and 0.0 < f.dispersion < inf and all(0.0 <= one < inf for one in rates) and counted


def _shares(f: Fragility) -> dict[str, int]:
    if not _sound(f):
        return {OBJECTS: 1, CURVES: 0, TOLD: 0, HARMED: 0} | {
            key: 0 for at in range(len(GRID)) for key in (str(at), f"n{at}")
        }
    chances = f.chances
    out = {OBJECTS: 1, CURVES: int(not f.bound), TOLD: int(chances is not None)}
    out[HARMED] = 0 if chances is None else round(chances[0] * UNIT)
    for at, a in enumerate(GRID):
        p = f.probability(a * G) if not f.bound else _bounded(f, a * G)
        out[str(at)] = 0 if p is None else round(p * UNIT)
        out[f"n{at}"] = int(p is not None)
    return out


def _bounded(f: Fragility, intensity: float) -> float | None:
    if f.state == HARM:
        return f.seen(intensity)
    # Of what is only known not to fail up to a shaking, or to fail from one on.
    if f.bound == ABOVE and intensity <= f.median:
        return 0.0
    return 1.0 if f.bound == BELOW and intensity >= f.median else None


def class_curves(tally: Tally) -> tuple[ClassCurve, ...]:
    """Return the mean fragility of the museum, then those of its classes by their names.

    Parameters
    ----------
    tally : Tally
        Of all pages together.

    Returns
    -------
    tuple of ClassCurve
        Empty where no fragilities were asked for.
    """
    return tuple(_curve(name, tally.curves[name]) for name in sorted(tally.curves))


def _curve(name: str, sums: Mapping[str, int]) -> ClassCurve:
    objects = sums[OBJECTS]
    mean = [sums[str(at)] / UNIT / objects if sums[f"n{at}"] == objects else None for at in range(len(GRID))]
    known = [(a, p) for a, p in zip(GRID, mean, strict=True) if p is not None]
    median = dispersion = difference = limit = None
    bound = ""
    if known and known[0][1] <= 0.5 <= known[-1][1]:
        x, p = (np.array(column) for column in zip(*known, strict=True))
        taken = np.full((x.size, 1), float(objects))
        fit = fit_counts(x, taken, np.clip(objects * p, 0.0, objects)[:, None], most=FLATTEST)
        if np.isfinite(fit.median[0]):
            from scipy.special import ndtr

            median, dispersion = float(fit.median[0]), float(fit.dispersion[0])
            difference = float(np.max(np.abs(ndtr(np.log(x / median) / dispersion) - p)))
    elif known:
        bound, limit = (BELOW, known[0][0]) if known[0][1] > 0.5 else (ABOVE, known[-1][0])
    told = sums[TOLD]
    harmed = sums[HARMED] / UNIT if told else None
    return ClassCurve(
        name, objects, sums[CURVES], tuple(mean), median, dispersion, bound, limit, difference, told, harmed
    )


def curves_csv(curves: Iterable[ClassCurve]) -> str:
    """Return the export: a row for the museum, whose class is empty, and one for each class; unknown cells empty."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for one in curves:
        at = one.median if one.median is not None else one.limit
        cells = [at, one.bound, one.dispersion, one.difference, one.told, one.harmed, *one.mean]
        row = [safe_cell(one.object_class), one.objects, one.curves]
        writer.writerow([*row, *("" if cell is None else cell for cell in cells)])
    return stream.getvalue()


def class_curve_views(curves: Iterable[ClassCurve]) -> tuple[ClassCurveView, ...]:
    """Return the classes in words, the museum first."""
    return tuple(_view(one) for one in curves)


def _view(one: ClassCurve) -> ClassCurveView:
    if one.median is not None:
        median = in_g(one.median * G)
    elif one.limit is not None:
        phrase = _("above %(at)s") if one.bound == ABOVE else _("below %(at)s")
        median = phrase % {"at": in_g(one.limit * G)}
    else:
        median = "–"
    harmed = "–"
    if one.harmed is not None:
        harmed = _("%(harmed)s of %(told)s") % {"harmed": local(f"{one.harmed:.1f}"), "told": count(one.told)}
    return ClassCurveView(
        words(clean(one.object_class)) if one.object_class else _("All on display"),
        count(one.objects),
        median,
        "–" if one.dispersion is None else f"{one.dispersion:.2f}",
        "–" if one.difference is None else percent(one.difference),
        harmed,
    )
