"""A table with a row for each fact of an object: its number, the name of a field, its value -> a row an object."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from pydantic import BaseModel, ConfigDict, Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import Name
from pipeline.collection.sources.rows import Row, check_columns
from pipeline.collection.sources.sideways import MOST_FIELDS

_AGAIN = "; "
"""Between the values of a field that an object has several of."""


class FactRows(BaseModel):
    """Which columns tell the facts of objects."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    object: Name = Field(description="The column that says of which object a fact is; an empty cell: of the one above.")
    field: Name = Field(description="The column with the names of fields, such as title or height.")
    value: Name = Field(description="The column with their values.")


@dataclass
class _FactsOfOne:
    line: int
    cells: dict[str, str]
    faults: dict[str, tuple[str, str]] = field(default_factory=dict)


def spread(rows: Iterator[Row], facts: FactRows, file: str) -> Iterator[Row]:
    """Yield the names of all fields as the header, behind that of the objects' column, and then a row for each object.

    All objects are in memory, for the facts of one need not follow each other. What other columns hold is left out.

    Parameters
    ----------
    rows : iterator of Row
        The header first.
    facts : FactRows
        Which columns tell them.
    file : str
        The source's name in messages.

    Yields
    ------
    Row
        In the order of the objects' first facts. Rows that are broken, and facts of no field, come as they are, last.

    Raises
    ------
    CollectionError
        For a source without one of the columns, and for more fields than a museum's objects have.
    """
    header = next(rows, None)
    if header is None:
        return
    names = [name.strip() for name in header.cells]
    check_columns(facts, names, f"{file}: [source.facts]")
    of, called, said = (names.index(name) for name in (facts.object, facts.field, facts.value))
    fields: dict[str, None] = {facts.object: None}
    objects: dict[str, _FactsOfOne] = {}
    broken: list[Row] = []
    above = ""
    unnamed = (
        "a fact without the name of its field, or of no object",
        f"fill {facts.field!r} and {facts.object!r}, or leave the row out",
    )
    for row in rows:
        if row.fault[0]:
            broken.append(Row(0, row.line, [above], row.fault))
            continue
        above = number = row.cells[of].strip() or above
        fact = row.cells[called].strip()
        if not fact or not number:
            broken.append(Row(0, row.line, [number], unnamed))
            continue
        fields.setdefault(fact)
        if len(fields) > MOST_FIELDS:
            raise CollectionError(
                f"{file}: more than {MOST_FIELDS:,} names of fields in {facts.field!r}; leave [source.facts] out where "
                "each row is an object"
            )
        found = objects.setdefault(number, _FactsOfOne(row.line, {facts.object: number}))
        if said in row.faults:
            found.faults[fact] = row.faults[said]
        elif value := row.cells[said].strip():
            before = found.cells.get(fact)
            found.cells[fact] = value if before is None or fact == facts.object else f"{before}{_AGAIN}{value}"
    yield Row(0, header.line, list(fields))
    place = 0
    for place, found in enumerate(objects.values(), start=1):
        faults = {at: found.faults[name] for at, name in enumerate(fields) if name in found.faults}
        yield Row(place, found.line, [found.cells.get(name, "") for name in fields], faults=faults)
    for at, row in enumerate(broken, start=place + 1):
        yield Row(at, row.line, row.cells + [""] * (len(fields) - 1), row.fault)
