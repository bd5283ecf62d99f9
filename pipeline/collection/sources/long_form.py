"""Rows of one measurement each -> rows of one object each."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from pipeline.collection.sources.base import LongForm
from pipeline.collection.sources.measurement_terms import kind_of
from pipeline.collection.sources.measurements import OF_MEASUREMENTS, OTHER, Measurements
from pipeline.collection.sources.rows import Row, check_columns

COLUMNS = OF_MEASUREMENTS
"""What takes the place of the columns of type, value, unit and part."""

_WORDS = re.compile(r"\w+")
_NUMBERED = re.compile(r"_\d+$")
"""Behind a part of which there are several: overall_1."""

_Fault = tuple[str, str]
_MOST = 200
"""Measurements of one cell."""


class _LongCell(NamedTuple):
    """A measurement in the words of its row."""

    kind: str
    value: str
    unit: str
    part: str
    fault: _Fault | None


@dataclass
class _Gathered:
    """An object whose rows are gathered: the first of them, and the measurements of all."""

    number: int
    line: int
    cells: list[str]
    faults: dict[int, _Fault]
    measured: Measurements


def gathered(rows: Iterator[Row], long: LongForm, file: str) -> Iterator[Row]:
    """Yield the header and then one row for each object, in the order of their first rows.

    All objects are in memory, for rows of one object need not follow each other. A cell that is empty in an object's
    first row is taken from the next one that fills it.

    Parameters
    ----------
    rows : iterator of Row
        The header first.
    long : LongForm
        Which columns tell the measurements.
    file : str
        The source's name in messages.

    Yields
    ------
    Row
        With COLUMNS behind the source's own columns. Rows that are broken come as they are.

    Raises
    ------
    CollectionError
        For a source without one of the columns.
    """
    header = next(rows, None)
    if header is None:
        return
    names = [name.strip() for name in header.cells]
    keyed = (
        ("object", long.object),
        ("type", long.type),
        ("value", long.value),
        ("unit", long.unit),
        ("part", long.part),
        ("called", long.called),
        *(("sides", side.column) for side in long.sides),
        *(("again", name) for one in long.again for name in (one.type, one.value, one.unit, one.part)),
    )
    check_columns(keyed, names, f"{file}: [source.long]")
    told = {names.index(name) for key, name in keyed if name is not None and key not in ("object", "called")}
    kept = [at for at in range(len(names)) if at not in told]
    yield Row(0, header.line, [header.cells[at] for at in kept] + list(COLUMNS))
    number_at = names.index(long.object)

    def place_of(name: str | None) -> int | None:
        return None if name is None else names.index(name)

    part_at = place_of(long.part)
    first = (place_of(long.type), place_of(long.value), place_of(long.unit), part_at)
    again = [
        (
            first[0] if one.type is None else place_of(one.type),
            place_of(one.value),
            place_of(one.unit),
            part_at if one.type is None else place_of(one.part),
        )
        for one in long.again
    ]
    called_at = None if long.called is None else names.index(long.called)
    sides = [(names.index(side.column), side) for side in long.sides]
    objects: dict[str, _Gathered] = {}
    broken: list[Row] = []
    above = ""
    for row in rows:
        if row.fault[0]:
            broken.append(Row(0, row.line, [*row.cells][: len(kept)], row.fault))
            continue
        above = number = row.cells[number_at].strip() or above
        found = objects.get(number)
        if found is None:
            faults = {
                kept.index(at): why for at, why in row.faults.items() if at in kept and row.cells[number_at].strip()
            }
            found = _Gathered(len(objects) + 1, row.line, [row.cells[at] for at in kept], faults, Measurements())
            objects[number] = found
        for place, at in enumerate(kept):
            if not found.cells[place] and row.cells[at]:
                found.cells[place] = row.cells[at]
                found.faults.pop(place, None)
        if sides:
            called = "" if called_at is None else row.cells[called_at]
            part = _own_part("" if part_at is None else row.cells[part_at], called)
            for at, side in sides:
                _measure(found, _LongCell(side.kind, row.cells[at], side.unit, part, row.faults.get(at)))
        else:
            for places in (first, *(those for those in again if those[1] is not None and row.cells[those[1]].strip())):
                for said in _apart(row, places, long.separator):
                    _measure(found, said)
    width = len(kept)
    last = 0
    for found in objects.values():
        measured = found.measured.cells()
        faults = {**found.faults, **{width + at: why for at, why in found.measured.faults(COLUMNS).items()}}
        last = found.number
        yield Row(last, found.line, found.cells + [measured.get(column, "") for column in COLUMNS], faults=faults or {})
    for place, row in enumerate(broken, start=last + 1):
        yield Row(place, row.line, row.cells + [""] * (width + len(COLUMNS) - len(row.cells)), row.fault)


def _own_part(part: str, called: str) -> str:
    """Return "" for a part that is the object itself, for the object is called so: the microscope of a microscope."""
    words = [word.casefold() for word in _WORDS.findall(part)]
    return (
        ""
        if words and words == [w.casefold() for w in _WORDS.findall(called)][: len(words)]
        else _NUMBERED.sub("", part)
    )


def _apart(row: Row, places: tuple[int | None, ...], separator: str) -> Iterator[_LongCell]:
    """Yield each measurement of a row; one cell says several in the order of the others, its last for all behind it."""
    fault = next((row.faults[at] for at in places[:2] if at is not None and at in row.faults), None)
    cells = ["" if at is None else row.cells[at] for at in places]
    if not separator or fault is not None:
        kind, value, unit, part = cells
        yield _LongCell(kind, value, unit, part, fault)
        return
    pieces = [[piece.strip() for piece in cell.split(separator, _MOST)] for cell in cells]
    uneven = len(pieces[0]) != len(pieces[1])
    why = (
        f"{len(pieces[0])} kinds of measurement stand beside {len(pieces[1])} values",
        "give each kind its value, or leave the mapping's [source.long] separator out",
    )
    for at, kind in enumerate(pieces[0]):
        value, unit, part = (one[min(at, len(one) - 1)] for one in pieces[1:])
        yield _LongCell(kind, value, unit, part, why if uneven else None)


def _measure(found: _Gathered, said: _LongCell) -> None:
    if said.fault is not None:
        found.measured.refuse(kind_of(said.kind) or OTHER, *said.fault)
        return
    found.measured.add(said.kind.strip(), said.value, said.unit, said.part)
