"""Remarks of few objects that say how these are made fast to the building: "screwed to the floor"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pipeline.collection.guessing.columns import Column
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.records import Hanging, Support
from pipeline.tables.held_rows import HeldAs, told_by

_LONGEST = 70
"""Characters of a remark that says little besides (judgement)."""
_BUILDING = re.compile(
    r"wall|floor|ceiling|wand\b|wänd|decke\b|boden|\bmur|paret|pared|sol\b|plafond|paviment|suelo|piso|techo|chão|teto|vloer"
    r"|zolder|muur|perete|podea|τοίχ|δάπεδο|οροφή|壁|床|天井|벽|바닥|천장|墙|牆|地面|duvar|zemin|tavan|vegg|vägg|væg|gulv|golv"
    r"|ścian|podłog|stěn|podlah|стен|пол[уе]?\b|потол|\bfal[ao]|padló",
    re.IGNORECASE,
)
"""Parts of a building that a thing is fixed to."""
_PAST = re.compile(
    r"\d{4}|former|previous|until|früher|ehemals|autrefois|ancien|già|antes|antigu|vroeger", re.IGNORECASE
)
"""What says that a remark may be of another time."""


def remarks_of_holding(columns: Sequence[Column], told: GuessNotes) -> Column | None:
    """Return the column whose few texts on how things are held are all of what is fixed to the building.

    Where others are not, which may be about a part of a thing or about its making, that is said.

    Parameters
    ----------
    columns : sequence of Column
        Those that no field takes, and whose names say nothing else.
    told : GuessNotes
        What is said of it; grows.
    """
    for column in columns:
        telling = [text for text in column.distinct if told_by(text) != HeldAs()]
        fixed = [text for text in telling if _fixed(text)]
        if not fixed:
            continue
        if len(fixed) == len(telling):
            return column
        told.doubts.append(
            f"column {column.name!r} may say of some objects how they are held, such as {fixed[0]!r}: it is not read "
            f"for {next(text for text in telling if text not in fixed)[:80]!r}; --choose displayed={column.name} does"
        )
    return None


def _fixed(text: str) -> bool:
    if len(text) > _LONGEST or _BUILDING.search(text) is None or _PAST.search(text) is not None:
        return False
    told = told_by(text)
    # To name a wall is not enough: painters are called Wall, William C., and LeWitt, Sol.
    return told.support is Support.FASTENED or told.hanging is Hanging.FIXED
