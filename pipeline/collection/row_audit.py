"""What one row shows of its whole source, its units by a column of them, and whether its object is on display."""

from __future__ import annotations

from collections.abc import Mapping as Mapped
from collections.abc import Sequence
from typing import Any

from pipeline.collection.cells import Cells
from pipeline.collection.display_words import says_away
from pipeline.collection.guessing.columns import is_longitude
from pipeline.collection.guessing.names import is_length, named
from pipeline.collection.mapping import ColumnMap, Mapping
from pipeline.collection.record import plausible
from pipeline.collection.source_audit import SIDES, place_key, see_number, see_pairs, unit_columns, unit_named
from pipeline.collection.sources.measurement_terms import kind_of
from pipeline.collection.sources.rows import Row
from pipeline.collection.unit_audit import FILL, SOLID, Evidence
from pipeline.quantities import figures
from pipeline.records import Problem

EXAMPLES = 3
"""Rows that are named of each kind."""


def _has_no_field(name: str) -> bool:
    """Whether a column is of lengths or thicknesses, of which the record has none of its own."""
    return is_length(name) or kind_of(name.rpartition(".")[2]) in ("length", "thickness")


def _is_left(name: str, mapping: Mapping) -> bool:
    """Whether a column is of a side that the mapping takes from nowhere, as its cells were not understood: "H. 6.3"."""
    what = named(name)
    return what is not None and what.field in SIDES and what.field not in mapping.columns and not mapping.dimensions


class RowAudit:
    """Looks at the rows of one source, one after the other.

    Parameters
    ----------
    mapping : Mapping
        Which column is which field, and what holds.
    header : sequence of str
        The names of the columns.
    """

    def __init__(self, mapping: Mapping, header: Sequence[str]) -> None:
        self._mapping = mapping
        self._header = header
        self._spoken = unit_columns(mapping.columns, header)
        self._places = {f: header.index(c.column) for f, c in mapping.columns.items() if c.column in header}
        self._own = {f: header.index(c.unit_column) for f, c in mapping.columns.items() if c.unit_column in header}
        self._in_unit: dict[tuple[str, str], ColumnMap] = {}
        self._galleries = {name.strip().casefold() for name in mapping.display.on_display}
        self._stores = {name.strip().casefold() for name in mapping.display.not_on_display}
        self.rows: dict[str, list[str]] = {}
        taken = {name for column in mapping.columns.values() for name in (*column.sources, column.unit_column)}
        taken.update(() if mapping.dimensions is None else mapping.dimensions.columns)
        self._lengths = [
            (at, name)
            for at, name in enumerate(header)
            if name not in taken and (_has_no_field(name) or _is_left(name, mapping)) and not is_longitude(name, header)
        ]

    def column_of(self, field: str, column: ColumnMap, row: Row, cells: Cells) -> ColumnMap:
        """Return the column of a field with the unit that this row's own column of units names."""
        place = self._own.get(field)
        if place is None or not row.cells[place].strip():
            return column
        unit = unit_named(row.cells[place], plausible()[field].unit)
        if unit is None:
            message = f"{row.cells[place].strip()[:40]!r} is no unit that is known; {column.unit} is taken"
            cells.refuse(field, column, message, "write a unit such as cm or in")
            return column
        if (field, unit) not in self._in_unit:
            self._in_unit[field, unit] = column.model_copy(update={"unit": unit})
        return self._in_unit[field, unit]

    def lost(self, row: Row, cells: Cells) -> None:
        """Note a length for which the mapping has no field, where no size of the row is the same number."""
        sizes = {row.cells[at].strip() for at in self._places.values()}
        for at, name in self._lengths:
            text = row.cells[at].strip()
            if text and text not in sizes and any(c in "123456789" for c in text):
                message = f"column {name!r}: its {text[:40]!r} is in no field"
                remedy = (
                    "see whether it is the height, width or depth of this object, and name the column in the mapping"
                )
                cells.problems.append(Problem("dimensions", message, remedy))

    def look(self, row: Row, values: Mapped[str, Any], cells: Cells) -> Evidence:
        """Return what a row shows of its source, before any of its values is refused."""
        found = Evidence.of(values, cells.provenance)
        number = values["object_number"]
        see_number(found, number)
        see_pairs(found, cells.pairs)
        for name, column, text in cells.pairs:
            unit = plausible()[name].unit
            told = f"its column says {figures(column, 4)} {unit}, the text {figures(text, 4)} {unit}"
            if found.ratios[name] != [1.0]:
                self._keep(f"texts|{name}", row, number, told)
            for key, (_, does) in found.tallies.items():
                if does and key.startswith("sides|") and name in key:
                    self._keep(key, row, number, f"{name.removesuffix('_m')}: {told}")
        for field, places in self._spoken.items():
            self._see_units(found, field, places, row, number)
        for unit, (tenths, sixteenths) in found.steps.items():
            written = ", ".join(of.written for of in cells.provenance if of.field in SIDES)
            self._keep(f"steps|{unit}|{'tenths' if tenths > sixteenths else 'sixteenths'}", row, number, written)
        for (length, mass), (fill,) in found.fills.items():
            if not FILL[0] <= fill <= SOLID:
                box = " x ".join(figures(values[side], 3) for side in SIDES)
                self._keep(
                    f"fills|{length}|{mass}", row, number, f"{figures(values['mass_kg'], 4)} kg in a box of {box} m"
                )
        return found

    def _see_units(self, found: Evidence, field: str, places: Sequence[int], row: Row, number: str) -> None:
        at = self._places.get(field)
        if at is None or not row.cells[at].strip():
            return
        for place in places:
            unit = unit_named(row.cells[place], plausible()[field].unit)
            if unit is not None:
                found.tally(f"unit|{field}|{self._header[place]}|{unit}")
                if unit != self._mapping.columns[field].unit:
                    self._keep(f"unit|{field}", row, number, f"{row.cells[at].strip()[:40]} {unit}")

    def weigh(self, found: Evidence, row: Row, values: Mapped[str, Any], wrong: Sequence[Problem]) -> None:
        """Note whether a mass fits the size that is recorded with it."""
        if values.get("mass_kg") is not None and all(values.get(side) for side in SIDES):
            odd = next((one for one in wrong if one.field == "mass_kg"), None)
            found.tally("weights", shown=odd is not None)
            if odd is not None:
                self._keep("weights", row, values["object_number"], odd.message)

    def display(self, found: Evidence, row: Row, number: str, gallery: str, said: bool | None, cells: Cells) -> bool:
        """Say whether an object is on display by its flag and its location; where they contradict, note it.

        The flag holds where it is set and only the name of the location speaks against it; a location that the mapping
        lists holds over a flag, and [holds] display over both.
        """
        folded = gallery.casefold()
        listed = folded in self._stores
        away = listed or (folded not in self._galleries and says_away(gallery))
        if said is None:
            if away and not listed:
                found.tally(place_key(gallery))
            return not away
        if not said:
            return False
        found.tally("display", shown=away)
        if not away:
            return True
        holds = self._mapping.holds.display or ("location" if listed else "flag")
        message = (
            f"the flag says that it is on display, the location {gallery[:80]!r} that it is not; the {holds} is used"
        )
        remedy = "see where it is, and correct the other; or say in the mapping which of them holds, [holds] display"
        cells.problems.append(Problem("on_display", message, remedy))
        self._keep("display", row, number, f"flag yes, location {gallery[:80]!r}")
        return holds == "flag"

    def _keep(self, key: str, row: Row, number: str, words: str) -> None:
        kept = self.rows.setdefault(key, [])
        if len(kept) < EXAMPLES:
            kept.append(f"row {row.number}, {number[:80]}: {words}")
