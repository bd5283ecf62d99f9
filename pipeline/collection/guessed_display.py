"""Guesses that are said aloud: which column says what is on display, which holds the numbers of objects."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import Protocol, TypeVar

from pipeline.collection.display_words import flag_of, says_away, says_flags

NAMED = 8
"""Texts that a message names."""

STORES = 50
"""Locations that are written into the mapping as stores."""

_INTERNAL = re.compile(r"\b(?:id|identifier|irn|uuid|guid|key|record|sys ?id|work ?id|object ?id)\b")


class Column(Protocol):
    """A column that is looked at: its name, and its cells that are not empty."""

    name: str

    @property
    def filled(self) -> list[str]:
        """The cells that are not empty, stripped."""


One = TypeVar("One", bound=Column)


def flag_column(named: One | None, others: Sequence[One], gallery: Column | None, doubts: list[str]) -> One | None:
    """Return the column that says what is on display, and say what was found, or that none was.

    Parameters
    ----------
    named : Column or None
        The column whose name says so.
    others : sequence of Column
        Those that nothing else is read from.
    gallery : Column or None
        That of the locations.
    doubts : list of str
        Gathers what a person should look at.

    Returns
    -------
    Column or None
        None where none does, or none that can be read.
    """
    if named is not None:
        strange = Counter(text for text in named.filled if flag_of(text, display=True) is None)
        if not strange:
            return named
        told = ", ".join(repr(text[:40]) for text, _ in strange.most_common(NAMED))
        lines = f'[columns.on_display] values = {{ "{next(iter(strange))[:40]}" = true }}'
        doubts.append(
            f"column {named.name!r} seems to say what is on display; say in the mapping what {told} "
            f"{'means' if len(strange) == 1 else 'mean'}: {lines}"
        )
        if strange.total() < 0.5 * len(named.filled):
            return named
    for column in others:
        if column.filled and says_flags(column.filled):
            doubts.append(f"what is on display is taken from {column.name!r}, whose texts say so")
            return column
    away = stores(gallery)
    if away:
        told = ", ".join(map(repr, away[:NAMED])) + (f" and {len(away) - NAMED:,} more" if len(away) > NAMED else "")
        doubts.append(
            f"no column says what is on display: objects at {told} are taken not to be, all others to be; see which "
            "other locations are stores, and name them in [display] not_on_display"
        )
    else:
        doubts.append(
            "no column says what is on display, and no location sounds like a store: all objects are taken to be on "
            "display; name stores in [display] not_on_display, or the column in [columns.on_display]"
        )
    return None


def stores(gallery: Column | None) -> list[str]:
    """Return the locations that say by their names that they are no galleries, the most frequent first."""
    if gallery is None:
        return []
    return [place for place, _ in Counter(filter(says_away, gallery.filled)).most_common(STORES)]


def is_internal(name: str) -> bool:
    """Say whether a column's name is that of an identifier of a database, which no label shows."""
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return bool(_INTERNAL.search(re.sub(r"[\s_.:\-]+", " ", plain).casefold()))


def number_column(candidates: Sequence[One], doubts: list[str]) -> One | None:
    """Return the column of the objects' numbers: the museum's own before a database's, of which it is said.

    Parameters
    ----------
    candidates : sequence of Column
        Those whose names say that they hold numbers of objects, in the order of the source.
    doubts : list of str
        Gathers what was chosen.

    Returns
    -------
    Column or None
        None where there is none.
    """
    filled = [column for column in candidates if column.filled]
    if not filled:
        return next(iter(candidates), None)
    most = max(len(column.filled) for column in filled)
    # A museum's number that hardly any object has is not the one by which its objects are known.
    own = [column for column in filled if not is_internal(column.name) and len(column.filled) >= 0.5 * most]
    best = max(own or filled, key=lambda column: len(column.filled))
    others = [repr(column.name) for column in filled if column is not best]
    if others:
        shared = len(best.filled) - len(set(best.filled))
        twice = f"; {shared:,} of the rows that were looked at repeat one, and would be refused" if shared else ""
        empty = most - len(best.filled)
        lacking = f"; {empty:,} have none, and would be refused" if empty > 0 else ""
        doubts.append(f"object numbers are taken from {best.name!r}, and not from {', '.join(others)}{twice}{lacking}")
    return best
