"""Which columns say what things are, where none is called so: titles that name things, and descriptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guessing.columns import Column
from pipeline.collection.guessing.names import ARTIST, DESCRIPTION, TEXTS, plain

SAYING = ("object_name", "classification", "medium", "material")
"""Fields beside which a title may be anything."""

_CALLED = frozenset(
    {"name", "names", "nom", "nombre", "nome", "naam", "nazwa", "název", "megnevezés", "όνομα", "ad", "denumire",
     "navn", "namn", "nimi", "ime", "название", "наименование", "名称", "名前", "品名"}
)  # fmt: skip
"""Heads of columns that name a thing, where another one describes it, and else give its title."""

_SOME = 200
"""Texts from which it is told what a column measures."""

_FACE = 2
"""Sides that are measured of a picture."""


def named_by(
    able: Mapping[str, Sequence[Column]], found: Mapping[str, Column], chosen: Mapping[str, str]
) -> Column | None:
    """Return a column that names the things of a source in which none is called so.

    That is a column called "name" beside a description; the title, where no artist, material or class is told and most
    of what is measured has more sides than a picture, or one alone: a list of things gives their names for titles.
    Where there is no title either, it is a description, the first sentence of which says what a thing is.

    Parameters
    ----------
    able : mapping of str to sequence of Column
        What each column may be, `names.DESCRIPTION` and `names.ARTIST` among it.
    found : mapping of str to Column
        Field -> its column.
    chosen : mapping of str to str
        What a person has chosen, which stays.

    Returns
    -------
    Column or None
    """
    filled = {name for name, column in found.items() if column.filled}
    if filled.intersection(("object_name",)) or "object_name" in chosen:
        return None
    title = found.get("title")
    if title is None or not title.filled:
        return next((one for one in able.get(DESCRIPTION, ()) if one.filled), None)
    if ARTIST in able:
        return None
    if describing(able, title) is not None:
        return title
    if filled.intersection(SAYING):
        return None
    return title if _bodily(able.get(TEXTS) or able.get(DESCRIPTION, ()), filled) else None


def _bodily(texts: Sequence[Column], filled: set[str]) -> bool:
    """Whether most of what is measured are bodies: by three sides, a diameter, a weight, or by their height alone."""
    if filled.intersection(("depth_m", "diameter_m", "mass_kg")):
        return True
    some = [text for column in texts for text in column.filled[:_SOME]]
    sides = [{part.dimension for part in parse(plain_text(text)).parts if part.unit} for text in some]
    measured = [one for one in sides if one]
    flat = sum(len(one) == _FACE and one <= {"height", "width", "length", "unlabelled"} for one in measured)
    return bool(measured) and flat < 0.5 * len(measured)


def describing(able: Mapping[str, Sequence[Column]], title: Column) -> Column | None:
    """Return the description beside a column that is called "name", which says more of each thing than its name.

    Parameters
    ----------
    able : mapping of str to sequence of Column
        As of `named_by`.
    title : Column
        That which is taken for the title.
    """
    if plain(title.name) not in set(map(plain, _CALLED)):
        return None
    return next((one for one in able.get(DESCRIPTION, ()) if one.filled), None)
