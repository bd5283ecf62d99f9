"""Units that a whole source may have wrong: no row shows it, all of them together do.

Two witnesses.  Steps: who measures in inches writes eighths and sixteenths, who measures in centimetres writes tenths.
Density: an object's mass over the box around it, against the density of what it is made of; a box is never fuller than
full, and the median object of a collection fills more than a hundredth of its box.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as member
from itertools import product
from math import log
from statistics import median
from typing import Any

from pipeline.quantities import LENGTHS, MASSES
from pipeline.records import Origin, Provenance
from pipeline.tables.assumed import assumed

FEWEST_STEPS = 40
"""Numbers with a fraction that steps are judged by: fewer may be chance."""

FEWEST_DENSITIES = 20
"""Objects with mass and box that densities are judged by."""

MOST = 0.8
"""Share of the telling numbers that must be written in the other unit's steps."""

FILL = (0.015, 1.0)
"""What share of its box the median object may fill with its own material: from bowls and frames to solid blocks."""

USUAL = 0.25
"""What share of its box an object fills with its own material as a rule: between hollow and solid; judgement."""

SOLID = 1.3
"""What share of its box an object surely cannot fill: a solid block of the densest of its material, and a slip of the
rule."""

MOST_SOLID = 0.2
"""Share of objects beyond SOLID from which it is the units: what is of several materials, and said by one, is rarer."""

_SIXTEENTHS = frozenset(str(n / 16)[2:] for n in (1, 2, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15))
_WRITTEN = re.compile(r"(\d+)\.(\d+) (\w+)")
_SIDES = ("height_m", "width_m", "depth_m")


@dataclass(frozen=True, slots=True)
class Suspicion:
    """Something that a whole source seems to have wrong: nothing is changed, a person decides.

    Attributes
    ----------
    field, message, remedy : str
        What it is about, what was found with counts, and the line of the mapping that settles it.
    holds : str
        The key of the mapping's section [holds] without which it stops the import; "" where it does not stop it.
    examples : tuple of str
        Some of the rows, in words: of those that are read now, so that they are no part of what it says.
    """

    field: str
    message: str
    remedy: str
    holds: str = ""
    examples: tuple[str, ...] = member(default=(), compare=False)


@dataclass
class Evidence:
    """What records say about their source as a whole; that of several parts of it adds up.

    Attributes
    ----------
    steps : dict of str to list of int
        By unit of length, how many numbers with a telling fraction are written in tenths, and in sixteenths.
    fills : dict of (str, str) to list of float
        By units of length and mass, what share of its box each object would fill with its own material.
    ratios : dict of str to list of float
        By field, what a text says over what the field's own column says; 1 where they agree.
    tallies : dict of str to list of int
        By what was looked at, how many records could have shown it, and how many do.
    """

    steps: dict[str, list[int]] = member(default_factory=dict)
    fills: dict[tuple[str, str], list[float]] = member(default_factory=dict)
    ratios: dict[str, list[float]] = member(default_factory=dict)
    tallies: dict[str, list[int]] = member(default_factory=dict)

    @classmethod
    def of(cls, values: Mapping[str, Any], provenance: Iterable[Provenance]) -> Evidence:
        """Gather what a record says of units, with its numbers as they were written.

        Parameters
        ----------
        values : mapping
            The fields of the record in SI, before any is refused.
        provenance : iterable of Provenance
            Where its numbers come from.

        Returns
        -------
        Evidence
            Of that record.
        """
        found = cls()
        found._see_steps(provenance)
        weighed = _weighed(values, provenance)
        if weighed is not None:
            length, mass, fill = weighed
            found.fills[length, mass] = [fill]
        return found

    def _see_steps(self, provenance: Iterable[Provenance]) -> None:
        for origin in provenance:
            found = _WRITTEN.fullmatch(origin.written)
            if found and origin.field in _SIDES and origin.origin is Origin.MEASURED:
                digits = found[2]
                # Halves and quarters are written in both.
                tenths, sixteenths = len(digits) == 1 and digits != "5", digits in _SIXTEENTHS
                if tenths or sixteenths:
                    counts = self.steps.setdefault(found[3], [0, 0])
                    counts[0] += tenths
                    counts[1] += sixteenths

    def tally(self, what: str, *, shown: bool = False) -> None:
        """Count a record that could have shown something, and whether it does."""
        counts = self.tallies.setdefault(what, [0, 0])
        counts[0] += 1
        counts[1] += shown

    def add(self, other: Evidence, times: int = 1) -> None:
        """Add what another part of the source says.

        Parameters
        ----------
        other : Evidence
            Of that part.
        times : int
            How often it is added.
        """
        for mine, others in ((self.steps, other.steps), (self.tallies, other.tallies)):
            for name, more in others.items():
                counts = mine.setdefault(name, [0, 0])
                counts[0] += times * more[0]
                counts[1] += times * more[1]
        for units, fills in other.fills.items():
            self.fills.setdefault(units, []).extend(fills * times)
        for name, ratios in other.ratios.items():
            self.ratios.setdefault(name, []).extend(ratios * times)

    def plain(self) -> list[list[object]]:
        """Return it as JSON can hold it."""
        return [
            [[unit, *counts] for unit, counts in self.steps.items()],
            [[*units, *fills] for units, fills in self.fills.items()],
            [[name, *ratios] for name, ratios in self.ratios.items()],
            [[name, *counts] for name, counts in self.tallies.items()],
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
        steps, fills, ratios, tallies = plain
        return cls(
            {str(unit): [int(tenths), int(sixteenths)] for unit, tenths, sixteenths in steps},
            {(str(length), str(mass)): [float(one) for one in those] for length, mass, *those in fills},
            {str(name): [float(one) for one in those] for name, *those in ratios},
            {str(name): [int(could), int(does)] for name, could, does in tallies},
        )


def wrong_units(found: Evidence, rows: Mapping[str, Sequence[str]]) -> tuple[Suspicion, ...]:
    """Say which units look wrong by what all records of a source say together.

    Parameters
    ----------
    found : Evidence
        Of all records.
    rows : mapping of str to sequence of str
        Some rows in words, by what they show.

    Returns
    -------
    tuple of Suspicion
    """
    return (*_steps(found, rows), *_densities(found, rows))


def _steps(found: Evidence, rows: Mapping[str, Sequence[str]]) -> list[Suspicion]:
    out = []
    for unit, (tenths, sixteenths) in sorted(found.steps.items()):
        telling = tenths + sixteenths
        if telling < FEWEST_STEPS or unit not in ("in", "cm", "mm"):
            continue
        if unit == "in" and tenths > MOST * telling:
            out.append(_wrong_steps(tenths, telling, "in", "tenths, as centimetres are", "cm", rows))
        elif unit != "in" and sixteenths > MOST * telling:
            out.append(_wrong_steps(sixteenths, telling, unit, "eighths and sixteenths, as inches are", "in", rows))
    return out


def _wrong_steps(
    count: int, telling: int, unit: str, steps: str, other: str, rows: Mapping[str, Sequence[str]]
) -> Suspicion:
    return Suspicion(
        "height_m",
        f"{count:,} of {telling:,} lengths with a telling fraction are taken as {unit} and are written in {steps}",
        f'measure one object again; if it was {other}, say unit = "{other}" in the mapping, if not [holds] units = '
        '"mapping"',
        "units",
        tuple(rows.get(f"steps|{unit}|{'tenths' if unit == 'in' else 'sixteenths'}", ())),
    )


def _densities(found: Evidence, rows: Mapping[str, Sequence[str]]) -> list[Suspicion]:
    out = []
    for (length, mass), group in sorted(found.fills.items()):
        if len(group) < FEWEST_DENSITIES:
            continue
        fill = median(group)
        if FILL[0] <= fill <= FILL[1] and not _too_full(group, 1.0):
            continue
        fits = []
        for other_length, other_mass in product(LENGTHS, MASSES):
            factor = (MASSES[other_mass] / MASSES[mass]) / (LENGTHS[other_length] / LENGTHS[length]) ** 3
            if FILL[0] <= fill * factor <= FILL[1] and not _too_full(group, factor):
                changed = (other_length != length) + (other_mass != mass)
                fits.append((changed, abs(log(fill * factor / USUAL)), other_length, other_mass, fill * factor))
        # Both labels wrong alike (pounds for kilograms and inches for centimetres) is one slip of one export.
        metric = {"m", "cm", "mm", "kg", "g"}
        fits.sort(key=lambda fit: ((fit[2] in metric) != (fit[3] in metric), fit[0], fit[1]))
        full = sum(one > SOLID for one in group)
        more = f", and {full:,} would be heavier than a solid block of it" if full else ""
        better = f"; read as {fits[0][2]} and {fits[0][3]}, {fits[0][4]:.0%}" if fits else ""
        out.append(
            Suspicion(
                "mass_kg",
                f"{len(group):,} objects with sizes in {length} and masses in {mass}: the median would fill {fill:.2%} "
                f"of its box with its own material{more}{better}",
                "weigh and measure one object again, and mend the units in the mapping; if they are right, say [holds] "
                'weights = "mapping"',
                "weights",
                tuple(rows.get(f"fills|{length}|{mass}", ())),
            )
        )
    return out


def _too_full(group: Sequence[float], factor: float) -> bool:
    return sum(one * factor > SOLID for one in group) > MOST_SOLID * len(group)


def _weighed(values: Mapping[str, Any], provenance: Iterable[Provenance]) -> tuple[str, str, float] | None:
    """Return the units of length and mass of an object, and what share of its box it would fill."""
    sides = [float(values.get(side) or 0.0) for side in _SIDES]
    mass = values.get("mass_kg")
    if mass is None or not all(sides):
        return None
    units = {of.field: of.written.rpartition(" ")[2] for of in provenance}
    lengths = {units.get(side, "") for side in _SIDES}
    material = assumed().material_in(values.get("material") or values.get("medium") or "")
    if material is None or len(lengths) != 1 or not lengths <= LENGTHS.keys() or units.get("mass_kg") not in MASSES:
        return None
    volume = sides[0] * sides[1] * sides[2]
    return lengths.pop(), units["mass_kg"], mass / volume / material.density
