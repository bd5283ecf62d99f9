"""Rows of mounts.csv: how a thing is held that lies in a case, or cannot stand by itself."""

from functools import cache
from typing import Any

from pydantic import ValidationInfo, field_validator

from pipeline.errors import InputError
from pipeline.records import Mount
from pipeline.tables import Range, table
from pipeline.tables.rows import Entries, Optional, TableRow, Text, checked, in_order, one_each

_RANGES = ("grip", "room", "lean")


class MountRow(TableRow):
    """A row of mounts.csv: one way to be held.

    Attributes
    ----------
    mount, title : Mount, str
        Which way, and in words that follow "it".
    kind : str
        The class of objects that are taken to be held so where nobody says it; "" for none.
    models, measures : tuple of str
        Those that are tried on what is held so.
    grip, room, lean : float or None, with _low and _high
        What the mount holds sideways, in weights of what it holds [-]; how far that moves before it comes off [m]; how
        far from upright it leans [degrees].  None where they do not come into it, or are as of all that stands.
    source : str
        Who says so.
    """

    mount: Mount
    title: Text
    kind: str
    models: Entries
    measures: Entries
    grip: Optional
    grip_low: Optional
    grip_high: Optional
    room: Optional
    room_low: Optional
    room_high: Optional
    lean: Optional
    lean_low: Optional
    lean_high: Optional
    source: Text

    @field_validator(*(f"{stem}_high" for stem in _RANGES))
    @classmethod
    def _in_order(cls, high: float | None, info: ValidationInfo) -> float | None:
        stem = str(info.field_name).removesuffix("_high")
        three = (info.data.get(f"{stem}_low"), info.data.get(stem), high)
        if None in three and any(one is not None for one in three):
            raise InputError(f"{stem}, {stem}_low and {stem}_high go together: fill all three, or none")
        return in_order(high, info, f"{stem}_low", stem)

    def range(self, column: str) -> Range | None:
        """Return value, low and high of a column; None where it is left empty."""
        given: dict[str, Any] = self.model_dump()
        if given[column] is None:
            return None
        return Range(given[column], given[f"{column}_low"], given[f"{column}_high"], f"mounts.csv ({self.source})")


@cache
def mount_rows() -> dict[Mount, MountRow]:
    """Return the ways to be held.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it, and for a way without a row.
    """
    rows = checked(MountRow, table("mounts"), "mounts.csv", named="mount")
    return one_each(rows, Mount, "mount", "mounts.csv", "way to be held")
