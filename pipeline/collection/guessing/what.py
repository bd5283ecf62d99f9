"""Which columns say what things are, where none is called so: titles that name things, and descriptions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guessing.by_values import things
from pipeline.collection.guessing.columns import Column, untaken
from pipeline.collection.guessing.name_words import OWNERS
from pipeline.collection.guessing.names import ARTIST, CALLED, DESCRIPTION, TEXTS, named, path_of, plain
from pipeline.collection.guessing.within import placed
from pipeline.collection.naming import names_thing
from pipeline.collection.places import case_in
from pipeline.tables.held_rows import HeldAs, told_by

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

_MORE = 1.25
"""How many times more words titles have than names (judgement)."""

_FEWEST, _MOST = 2, 0.5
"""How many titles and what share of them must name things (judgement)."""


def name_and_title(
    able: Mapping[str, Sequence[Column]], found: Mapping[str, Column], chosen: Mapping[str, str]
) -> tuple[Column, Column] | None:
    """Return which of two columns of names says what a thing is, "byrå", and which is its title, "Gustaviansk byrå".

    Parameters
    ----------
    able, found, chosen
        As of `named_by`.

    Returns
    -------
    (Column, Column) or None
        None where one column alone is of names, where there is a title, or where both are as long.
    """
    names = [one for one in able.get("object_name", ()) if one.filled][:2]
    title = found.get("title")
    if not names and title is not None and title.filled and not {"title", "object_name"} & chosen.keys():
        # "name" beside "title".
        called = next((one for one in able["title"] if one.filled and plain(path_of(one.name)[-1]) in CALLED), title)
        if called is title:
            # Two columns that are both called names: of kinds of things there are fewer, in fewer letters.
            kinds = (one for one in able["title"] if one.filled and len(one.distinct) < len(title.distinct))
            called = next((one for one in kinds if _letters(title) >= _MORE * _letters(one)), title)
            return (called, title) if called is not title else None
        return (called, title) if _words(title) >= _MORE * _words(called) else None
    if len(names) < 2 or "title" in found or {"title", "object_name"} & chosen.keys():
        return None
    short, long = sorted(names, key=_words)
    return (short, long) if _words(long) >= _MORE * _words(short) else None


def _letters(column: Column) -> float:
    some = column.distinct[:_SOME]
    return sum(map(len, some)) / len(some)


def _words(column: Column) -> float:
    some = column.distinct[:_SOME]
    return sum(len(text.split()) for text in some) / len(some)


def named_by(
    able: Mapping[str, Sequence[Column]], found: Mapping[str, Column], chosen: Mapping[str, str]
) -> Column | None:
    """Return a column that names the things of a source in which none is called so.

    That is a column called "name" beside a description; the title, where no artist, material or class is told and most
    of what is measured has more sides than a picture, or one alone: a list of things gives their names for titles.
    Where nothing is measured, or height and width alone in columns of their own, most titles must be short names of
    things.
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
    if "object_name" in filled or "object_name" in chosen:
        return None
    title = found.get("title")
    if title is None or not title.filled:
        return next((one for one in able.get(DESCRIPTION, ()) if one.filled), None)
    if ARTIST in able:
        return None
    if describing(able, title) is not None:
        return title
    said = filled.intersection(SAYING)
    if said:
        # Beside a material alone most titles may name things: "Glava cara; mramor".
        return title if said <= {"medium", "material"} and _names_things(title.filled[:_SOME]) else None
    return title if _bodily(able.get(TEXTS) or able.get(DESCRIPTION, ()), filled, title) else None


def _bodily(texts: Sequence[Column], filled: set[str], title: Column) -> bool:
    """Whether most of what is measured are bodies: by three sides, a diameter, a weight, or by their height alone."""
    if filled.intersection(("depth_m", "diameter_m", "mass_kg")):
        return True
    some = [text for column in texts for text in column.filled[:_SOME]]
    sides = [{part.dimension for part in parse(plain_text(text)).parts if part.unit} for text in some]
    measured = [one for one in sides if one]
    flat = sum(len(one) == _FACE and one <= {"height", "width", "length", "unlabelled"} for one in measured)
    if not measured:
        return _names_things(title.filled[:_SOME])
    return bool(measured) and flat < 0.5 * len(measured)


def _names_things(titles: Sequence[str]) -> bool:
    """Whether most titles are short names of things that are no pictures: their first or their last word is one."""
    named = sum(map(names_thing, titles))
    return named >= _FEWEST and named >= _MOST * len(titles)


def in_place_of_title(able: Mapping[str, Sequence[Column]], found: Mapping[str, Column]) -> Column | None:
    """Return the shortest description of things that have a name and no title: it says more of each than its name.

    Parameters
    ----------
    able, found : mapping
        As of `named_by`.
    """
    name, title = found.get("object_name"), found.get("title")
    if name is None or not name.filled or (title is not None and title.filled):
        return None
    return min((one for one in able.get(DESCRIPTION, ()) if one.filled and one is not name), key=_words, default=None)


def naming_the_rest(found: Mapping[str, Column], chosen: Mapping[str, str]) -> bool:
    """Say whether titles name things where the column of their names is empty.

    Parameters
    ----------
    found, chosen : mapping
        As of `named_by`.
    """
    name, title = found.get("object_name"), found.get("title")
    if name is None or title is None or name is title or "object_name" in chosen:
        return False
    rest = [text for called, text in zip(name.values, title.values, strict=True) if text.strip() and not called.strip()]
    return _names_things(rest[:_SOME])


def naming_among(columns: Sequence[Column], used: Iterable[Column], *, words_enough: bool) -> Column | None:
    """Return the column of words that are different for nearly all objects, whatever it is called: their names.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.
    words_enough : bool
        Whether any words will do; else some of them must name things, for materials tell what things are too.
    """
    able = [
        one
        for one in untaken(columns, used)
        if named(one.name) is None
        and OWNERS.isdisjoint(plain(one.name).split())
        and len(one.distinct) >= _DIFFERENT * len(one.values)
        and not (one.measured or one.of_machine or one.numbering or one.pictured > _MOST or one.dimensional > _MOST)
        and placed(one) < _MOST
        and sum(map(_of_holding, one.distinct)) < _MOST * len(one.distinct)
        and sum(len(text.split()) > 1 for text in one.filled) >= _MOST * len(one.filled)
        and (words_enough or things(one) >= _SOME_NAME)
    ]
    return max(able, key=lambda one: len(one.distinct), default=None)


def _of_holding(text: str) -> bool:
    """Whether a text tells how a thing is held, or in which case it is, and so is no name: "Bolted to oak frame"."""
    return told_by(text) != HeldAs() or bool(case_in(text))


_SOME_NAME = 0.3
"""Share of the texts of a column that must name things where it is not called for names (judgement)."""


_DIFFERENT = 0.8
"""Share of the objects that have names of their own (judgement)."""


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
