"""Units that a whole source may have wrong: no row shows it, all of them together do.

Two witnesses.  Steps: who measures in inches writes eighths and sixteenths, who measures in centimetres writes tenths.
Density: an object's mass over the box around it, against the density of what it is made of; a box is never fuller than
full, and the median object of a collection fills more than a hundredth of its box.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from statistics import median

from pipeline.quantities import LENGTHS, MASSES
from pipeline.records import Item, Origin
from pipeline.tables import material_in, number

FEWEST_STEPS = 40
"""Numbers with a fraction that steps are judged by: fewer may be chance."""

FEWEST_DENSITIES = 20
"""Objects with mass and box that densities are judged by."""

MOST = 0.8
"""Share of the telling numbers that must be written in the other unit's steps."""

FILL = (0.015, 1.0)
"""What share of its box the median object may fill with its own material: from bowls and frames to solid blocks."""

_SIXTEENTHS = frozenset(str(n / 16)[2:] for n in (1, 2, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15))
_WRITTEN = re.compile(r"(\d+)\.(\d+) (\w+)")
_SIDES = ("height_m", "width_m", "depth_m")


@dataclass(frozen=True, slots=True)
class Suspicion:
    """Something that a whole source seems to have wrong: nothing is changed, a person decides."""

    field: str
    message: str
    remedy: str


def suspicions(items: Sequence[Item]) -> tuple[Suspicion, ...]:
    """Look at all records of a source together, and say which units look wrong.

    items : with provenance, which holds the numbers as they were written
    """
    return (*_steps(items), *_densities(items))


def _steps(items: Iterable[Item]) -> list[Suspicion]:
    fractions: dict[str, list[str]] = {}
    for item in items:
        for origin in item.provenance:
            found = _WRITTEN.fullmatch(origin.written)
            if found and origin.field in _SIDES and origin.origin is Origin.MEASURED:
                fractions.setdefault(found[3], []).append(found[2])
    out = []
    for unit, digits in sorted(fractions.items()):
        # Halves and quarters are written in both.
        tenths = sum(len(d) == 1 and d != "5" for d in digits)
        sixteenths = sum(d in _SIXTEENTHS for d in digits)
        telling = tenths + sixteenths
        if telling < FEWEST_STEPS or unit not in ("in", "cm", "mm"):
            continue
        if unit == "in" and tenths > MOST * telling:
            out.append(_wrong_steps(tenths, telling, "in", "tenths, as centimetres are", "cm"))
        elif unit != "in" and sixteenths > MOST * telling:
            out.append(_wrong_steps(sixteenths, telling, unit, "eighths and sixteenths, as inches are", "in"))
    return out


def _wrong_steps(count: int, telling: int, unit: str, steps: str, other: str) -> Suspicion:
    return Suspicion(
        "height_m",
        f"{count:,} of {telling:,} lengths with a telling fraction are taken as {unit} and are written in {steps}",
        f'measure one object again; if it was {other}, say unit = "{other}" in the mapping',
    )


@dataclass(frozen=True, slots=True)
class _Weighed:
    volume: float
    mass: float
    density: float
    length_unit: str
    mass_unit: str


def _densities(items: Iterable[Item]) -> list[Suspicion]:
    weighed = [found for item in items if (found := _weighed(item)) is not None]
    groups: dict[tuple[str, str], list[_Weighed]] = {}
    for one in weighed:
        groups.setdefault((one.length_unit, one.mass_unit), []).append(one)
    out = []
    for (length, mass), group in sorted(groups.items()):
        if len(group) < FEWEST_DENSITIES:
            continue
        fill = median(one.mass / one.volume / one.density for one in group)
        if FILL[0] <= fill <= FILL[1]:
            continue
        fits = []
        for other_length, other_mass in product(LENGTHS, MASSES):
            factor = (MASSES[other_mass] / MASSES[mass]) / (LENGTHS[other_length] / LENGTHS[length]) ** 3
            if FILL[0] <= fill * factor <= FILL[1]:
                changed = (other_length != length) + (other_mass != mass)
                fits.append((changed, abs(fill * factor - 0.25), other_length, other_mass, fill * factor))
        # Both labels wrong alike (pounds for kilograms and inches for centimetres) is one slip of one export.
        metric = {"m", "cm", "mm", "kg", "g"}
        fits.sort(key=lambda fit: ((fit[2] in metric) != (fit[3] in metric), fit[0], fit[1]))
        better = f"; read as {fits[0][2]} and {fits[0][3]}, {fits[0][4]:.0%}" if fits else ""
        out.append(
            Suspicion(
                "mass_kg",
                f"{len(group):,} objects with sizes in {length} and masses in {mass}: the median would fill {fill:.2%} "
                f"of its box with its own material{better}",
                "weigh and measure one object again, and mend the units in the mapping",
            )
        )
    return out


def _weighed(item: Item) -> _Weighed | None:
    sides = [getattr(item, side) for side in _SIDES]
    if item.mass_kg is None or not all(sides):
        return None
    units = {of.field: of.written.rpartition(" ")[2] for of in item.provenance}
    lengths = {units.get(side, "") for side in _SIDES}
    material = material_in(item.material or item.medium)
    if material is None or len(lengths) != 1 or not lengths <= LENGTHS.keys() or units.get("mass_kg") not in MASSES:
        return None
    density = number(material, "density", f"materials.csv, {material['material']}")
    return _Weighed(sides[0] * sides[1] * sides[2], item.mass_kg, density, lengths.pop(), units["mass_kg"])
