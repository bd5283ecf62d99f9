"""Presets with a query: whether a database has the tables that one reads."""

from __future__ import annotations

from collections.abc import Sequence

from pipeline.collection.sources.schema import DatabaseTable

_SIGNS = {"tms_database": {"objects", "objcomponents", "objlocations", "locations", "dimitemelemxrefs", "dimensions"}}
"""Preset -> names of tables that no other system has together."""


def preset_for(tables: Sequence[DatabaseTable]) -> str | None:
    """Return the preset whose query a database can answer; None for a system that is not known.

    Parameters
    ----------
    tables : sequence of DatabaseTable
        Of the database.

    Returns
    -------
    str or None
    """
    there = {table.name.casefold() for table in tables if table.schema in (None, "dbo")}
    return next((preset for preset, names in _SIGNS.items() if names <= there), None)
