"""What columns hold whose names say nothing: places, flags in unknown words, and fields with labels in one text."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence

from pipeline.collection.display_words import says_away
from pipeline.collection.guessing.columns import Column, untaken
from pipeline.collection.guessing.names import DESCRIPTION, named
from pipeline.collection.guessing.questions import Question
from pipeline.collection.places import LONGEST, names_room, parted

_PLACED = 0.5
"""Share of a column's texts that must begin as places do (judgement)."""
_SURELY = 0.75
"""The same of a column of sentences (judgement)."""
_REPEATED = 0.9
"""Share of its texts that may be different: objects share rooms."""
_MOST_WORDS, _FEWEST = 3, 6
"""Different words of a flag, and cells from which one is told (judgement)."""
_LABEL = re.compile(r"(?<!\w)([^\W\d_]{4,24})\s*:\s")
_OFTEN = 0.2
"""Share of the texts in which a label stands (judgement)."""
_SIGNS_OF_ROOMS = (2, 3)
_SAYING = ("title", "object_name", DESCRIPTION)


def place_among(columns: Sequence[Column], used: Iterable[Column]) -> Column | None:
    """Return the column whose texts begin as the names of rooms, cases and stores do, whatever it is called.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.

    Returns
    -------
    Column or None
    """
    able = [one for one in untaken(columns, used) if one.filled and named(one.name) is None]
    # Notes of a survey may begin with the place, and say then how a thing stands there.
    able = [one for one in able if not one.prose or (one.length < LONGEST and placed(one) >= _SURELY)]
    # "Salle 4, mur est" and "Salle 4, cheminée" are one room.
    able = [one for one in able if 1 < len({parted(text).room for text in one.distinct}) <= _REPEATED * len(one.filled)]
    best = max(able, key=placed, default=None)
    return best if best is not None and placed(best) >= _PLACED else None


def placed(column: Column) -> float:
    """Share of a column's texts that begin as the names of rooms, cases and stores do.

    Parameters
    ----------
    column : Column
        Any.

    Returns
    -------
    float
    """
    return sum(map(_is_place, column.filled)) / len(column.filled) if column.filled else 0.0


def _is_place(text: str) -> bool:
    first = named(text.split(maxsplit=1)[0]) if text.split() else None
    # "Utstilt: Salen" tells where a thing is shown.
    shown = first is not None and first.field == "on_display" and ":" in text
    # 展厅一, 库房二: a word for a room, with its number behind it and no blank.
    room = any((what := named(text[:long])) is not None and what.field == "gallery" for long in _SIGNS_OF_ROOMS)
    called = first is not None and first.field == "gallery"
    spoken = len(text) <= LONGEST and names_room(text)
    return room or shown or called or spoken or bool(parted(text).case) or says_away(text)


def parting(columns: Sequence[Column], used: Iterable[Column], place: Column | None) -> Question | None:
    """Return a question after a column that may be a flag of being on display in words that are not known.

    It has two or three words, and at each place one of them alone.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.
    place : Column or None
        Of the objects' places.

    Returns
    -------
    Question or None
    """
    if place is None or len(place.filled) < _FEWEST or len(place.distinct) == len(place.filled):
        return None
    for column in untaken(columns, used):
        words = column.distinct
        if not 1 < len(words) <= _MOST_WORDS or len(column.filled) < len(column.values):
            continue
        if column.units:
            continue
        said: dict[str, set[str]] = {}
        for where, word in zip(place.values, column.values, strict=True):
            said.setdefault(where, set()).add(word)
        if all(len(one) == 1 for one in said.values()) and len(said) > len(words):
            text = (
                f"does {column.name!r} ({', '.join(map(repr, words))}) say what is on display? It says one thing at "
                "each place; nothing is taken from it"
            )
            return Question("on_display", text, ("-", column.name), "-")
    return None


def labels_within(column: Column) -> list[str]:
    """Return the labels in a column's texts behind which the thing is named: titles before descriptions.

    Parameters
    ----------
    column : Column
        Of texts such as "Titel: Vase Beschreibung: Vase aus Porzellan Wann: 1790".

    Returns
    -------
    list of str
    """
    often = Counter(label for text in column.filled for label in set(_LABEL.findall(text)))
    known = [
        (_SAYING.index(what.field), label)
        for label, times in often.items()
        if times >= _OFTEN * len(column.filled) and (what := named(label)) is not None and what.field in _SAYING
    ]
    return [label for _, label in sorted(known)]
