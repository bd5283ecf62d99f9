"""Measurements made for Kouros's own sheets: kept apart, and laid over the museum's records at every import."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from sqlalchemy import JSON, Column, Connection, Index, Integer, Table, Text, insert, select, update

from pipeline.collection.database import METADATA
from pipeline.collection.record import KINDS, to_items, to_records
from pipeline.collection.sealing import require_sound, seal_column, write_seals
from pipeline.records import ITEM_FIELDS, Item, Problem
from pipeline.records import phrases as say
from pipeline.records.phrase import Clause

SUPPLEMENT = Table(
    "supplement",
    METADATA,
    Column("object_number", Text(), primary_key=True),
    Column("since", Integer(), primary_key=True, autoincrement=False),
    Column("until", Integer(), nullable=True),
    Column("source", Text(), nullable=False),
    Column("record", JSON(), nullable=False),
    seal_column(),
    Index(None, "until"),
)
"""One row for each state of an object's own sheet; since and until are versions, as in the table item.

record : the fields that were filled in, JSON-ready, with their provenance; what an earlier sheet than the source says
         has the key "sheet" there, with the source of that
"""

_MUSEUMS = frozenset(
    {
        *("object_number", "gallery", "title", "object_name", "classification", "medium", "dimensions", "on_display"),
        *("image", "image_credit"),
    }
)
"""Fields that a sheet shows and does not change: the museum's database is where they are mended."""

_SHEET = "sheet "
"""How the provenance of a number from a sheet begins."""

_NOTHING: tuple[Any, ...] = (None, "", [])
"""What a field holds where nothing is recorded."""

FILLED = tuple(name for name in ITEM_FIELDS if name not in _MUSEUMS and KINDS[name] != "list")
"""Fields that a sheet may fill in."""


def filled_in(item: Item) -> dict[str, Any]:
    """Return what a row of a sheet fills in, JSON-ready, with its provenance; empty where it fills in nothing."""
    (record,) = to_records([item])
    fields = {name: record[name] for name in FILLED if record[name] not in _NOTHING}
    if not fields:
        return {}
    return fields | {"provenance": [of for of in record["provenance"] if of["field"] in fields]}


def current(connection: Connection, version: int | None = None) -> dict[str, tuple[str, dict[str, Any]]]:
    """Return the sheets by object number.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    version : int or None
        Of the inventory; None: now.

    Returns
    -------
    dict of str to (str, dict)
        The source of each, and the fields that it fills in.

    Raises
    ------
    DamagedRowsError
        Where any of them, whatever version it is of, is not what was written.
    """
    require_sound(connection, SUPPLEMENT)
    wanted = select(SUPPLEMENT)
    if version is None:
        wanted = wanted.where(SUPPLEMENT.c.until.is_(None))
    else:
        lasts = SUPPLEMENT.c.until.is_(None) | (SUPPLEMENT.c.until > version)
        wanted = wanted.where(SUPPLEMENT.c.since <= version, lasts)
    return {row.object_number: (row.source, row.record) for row in connection.execute(wanted)}


def store(connection: Connection, sheets: Mapping[str, tuple[str, dict[str, Any]]], version: int) -> None:
    """Make the sheets of now what they are given as.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    sheets : mapping of str to (str, dict)
        As `current` returns them.
    version : int
        Of the inventory, from which they hold.
    """
    before = current(connection)
    ended = [number for number in before if before[number] != sheets.get(number)]
    for number in ended:
        mine = (SUPPLEMENT.c.object_number == number) & SUPPLEMENT.c.until.is_(None)
        connection.execute(update(SUPPLEMENT).where(mine).values(until=version))
    fresh = [
        {"object_number": number, "since": version, "until": None, "source": source, "record": record}
        for number, (source, record) in sheets.items()
        if before.get(number) != (source, record)
    ]
    if fresh:
        connection.execute(insert(SUPPLEMENT), fresh)
    if fresh or ended:
        write_seals(connection, SUPPLEMENT, (SUPPLEMENT.c.since == version) | (SUPPLEMENT.c.until == version))


def laid_over(items: Sequence[Item], sheets: Mapping[str, tuple[str, dict[str, Any]]]) -> list[Item]:
    """Return items with what their sheets fill in; where the museum says something else, a problem says so.

    Parameters
    ----------
    items : sequence of Item
        As the museum's records say.
    sheets : mapping of str to (str, dict)
        As `current` returns them.

    Returns
    -------
    list of Item
        In the same order.
    """
    return [_laid_over(item, *sheets[item.object_number]) if item.object_number in sheets else item for item in items]


def _otherwise(name: str) -> Clause:
    """Return the phrase for a field of which record and sheet say different things."""
    return say.SHEET_LENGTH if name.endswith("_m") else say.SHEET_MASS if name.endswith("_kg") else say.SHEET_OTHER


def _said(name: str, value: Any) -> float | str:
    return float(value) if name.endswith(("_m", "_kg")) else str(value)


def _laid_over(item: Item, source: str, record: Mapping[str, Any]) -> Item:
    (before,) = to_records([item])
    fields = {name: value for name, value in record.items() if name in KINDS and name != "provenance"}
    problems = [problem for problem in item.problems if problem.field not in fields]
    ours = {of.field for of in item.provenance if of.note.startswith(_SHEET)}
    sources = {of["field"]: of.get("sheet", source) for of in record["provenance"]}
    for name, value in fields.items():
        theirs = before[name]
        if theirs not in (*_NOTHING, value) and name not in ours:
            sheet = sources.get(name, source)
            problems.append(
                Problem(
                    name,
                    _otherwise(name)(recorded=_said(name, theirs), sheet=sheet, filled=_said(name, value)),
                    say.SEE_WHICH(),
                )
            )
    kept = [of for of in before["provenance"] if of["field"] not in fields]
    noted = [
        {name: value for name, value in of.items() if name != "sheet"}
        | {"note": f"{_SHEET}{sources[of['field']]}{'; ' if of['note'] else ''}{of['note']}"}
        for of in record["provenance"]
    ]
    provenance = sorted([*kept, *noted], key=lambda of: of["field"])
    (merged,) = to_items([before | fields | {"provenance": provenance, "problems": []}])
    return replace(merged, problems=tuple(problems))
