"""Units that a whole source may have wrong: no row shows it, all of them together do.

Two witnesses.  Steps: who measures in inches writes eighths and sixteenths, who measures in centimetres writes tenths.
Density: an object's mass over the box around it, against the density of what it is made of; a box is never fuller than
full, and the median object of a collection fills more than a hundredth of its box.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import product
from statistics import median
from typing import Any

from pipeline.quantities import LENGTHS, MASSES
from pipeline.records import Item, Origin
from pipeline.tables.assumed import assumed

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


@dataclass
class Evidence:
    """What records say about the units of their source; that of several parts of it adds up.

    Attributes
    ----------
    steps : dict of str to list of int
        By unit of length, how many numbers with a telling fraction are written in tenths, and in sixteenths.
    fills : dict of (str, str) to list of float
        By units of length and mass, what share of its box each object would fill with its own material.
    """

    steps: dict[str, list[int]] = field(default_factory=dict)
    fills: dict[tuple[str, str], list[float]] = field(default_factory=dict)

    @classmethod
    def of(cls, items: Iterable[Item]) -> Evidence:
        """Gather what some records say.

        Parameters
        ----------
        items : iterable of Item
            With provenance, which holds the numbers as they were written.

        Returns
        -------
        Evidence
            Of all of them.
        """
        found = cls()
        for item in items:
            found._see_steps(item)
            weighed = _weighed(item)
            if weighed is not None:
                length, mass, fill = weighed
                found.fills.setdefault((length, mass), []).append(fill)
        return found

    def _see_steps(self, item: Item) -> None:
        for origin in item.provenance:
            found = _WRITTEN.fullmatch(origin.written)
            if found and origin.field in _SIDES and origin.origin is Origin.MEASURED:
                digits = found[2]
                # Halves and quarters are written in both.
                tenths, sixteenths = len(digits) == 1 and digits != "5", digits in _SIXTEENTHS
                if tenths or sixteenths:
                    counts = self.steps.setdefault(found[3], [0, 0])
                    counts[0] += tenths
                    counts[1] += sixteenths

    def add(self, other: Evidence, times: int = 1) -> None:
        """Add what another part of the source says.

        Parameters
        ----------
        other : Evidence
            Of that part.
        times : int
            How often it is added.
        """
        for unit, (tenths, sixteenths) in other.steps.items():
            counts = self.steps.setdefault(unit, [0, 0])
            counts[0] += times * tenths
            counts[1] += times * sixteenths
        for units, fills in other.fills.items():
            self.fills.setdefault(units, []).extend(fills * times)

    def plain(self) -> list[list[object]]:
        """Return it as JSON can hold it."""
        return [
            [[unit, *counts] for unit, counts in self.steps.items()],
            [[*units, *fills] for units, fills in self.fills.items()],
        ]

    @classmethod
    def of_plain(cls, plain: Sequence[Sequence[Sequence[Any]]]) -> Evidence:
        """Read what `plain` gave.

        Parameters
        ----------
        plain : sequence
            JSON-ready.

        Returns
        -------
        Evidence
            The same.

        Raises
        ------
        ValueError, TypeError
            For anything else.
        """
        steps, fills = plain
        return cls(
            {str(unit): [int(tenths), int(sixteenths)] for unit, tenths, sixteenths in steps},
            {(str(length), str(mass)): [float(one) for one in those] for length, mass, *those in fills},
        )


def suspicions(found: Evidence) -> tuple[Suspicion, ...]:
    """Say which units look wrong by what all records of a source say together."""
    return (*_steps(found), *_densities(found))


def _steps(found: Evidence) -> list[Suspicion]:
    out = []
    for unit, (tenths, sixteenths) in sorted(found.steps.items()):
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


def _densities(found: Evidence) -> list[Suspicion]:
    out = []
    for (length, mass), group in sorted(found.fills.items()):
        if len(group) < FEWEST_DENSITIES:
            continue
        fill = median(group)
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


def _weighed(item: Item) -> tuple[str, str, float] | None:
    """Return the units of length and mass of an object, and what share of its box it would fill."""
    sides = [getattr(item, side) for side in _SIDES]
    if item.mass_kg is None or not all(sides):
        return None
    units = {of.field: of.written.rpartition(" ")[2] for of in item.provenance}
    lengths = {units.get(side, "") for side in _SIDES}
    material = assumed().material_in(item.material or item.medium)
    if material is None or len(lengths) != 1 or not lengths <= LENGTHS.keys() or units.get("mass_kg") not in MASSES:
        return None
    volume = sides[0] * sides[1] * sides[2]
    return lengths.pop(), units["mass_kg"], item.mass_kg / volume / material.density
