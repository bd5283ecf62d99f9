"""What columns are by what their cells hold, where their names say nothing: names of things, materials, numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from itertools import pairwise

from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.columns import Column, internal, untaken
from pipeline.collection.guessing.names import DESCRIPTION, TEXTS, called, named
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.guessing.within import placed
from pipeline.collection.naming import names_thing
from pipeline.tables.held_rows import HeldAs, told_by
from pipeline.tables.material_words import folded, material_words

_SOME = 200
"""Different texts from which it is told what a column holds."""

_MOSTLY = 0.5
"""Share of the texts of a column that must be what it is taken for (judgement)."""

_FEWEST = 3
"""Different texts that a column must have (judgement)."""

_WORD = re.compile(r"[^\W\d_]+")
_YEARS = re.compile(r"(?:c(?:a|irca)?\.? ?)?(?:1[0-9]|20)\d\d(?:\s?[-\u2013/]\s?(?:1[0-9]|20)\d\d|-\d\d-\d\d.*)?s?")
_DATE = re.compile(r"\d{1,4}[./-]\d{1,2}[./-]\d{1,4}(?:[ T].*)?|(?:1[4-9]|20)\d\d")
_ACCESSION = re.compile(
    # A year and what follows it, three numbers and more, or letters before numbers.
    r"(?:1[6-9]|20)\d\d\s?[./:-]\s?\w.*|[a-z]{0,6}[\s.]{0,2}\d+(?:[./:-][\da-z]+){2,}.*|[a-z]{1,6}[\s./:-]{0,2}\d[\w./:-]*",
    re.IGNORECASE,
)


def by_values(
    columns: Sequence[Column], found: Mapping[str, Column], chosen: Mapping[str, str]
) -> dict[str, tuple[Column, str]]:
    """Return the columns of things and of materials where no name of a column says which they are, and why.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : mapping of str to Column
        Field -> its column.
    chosen : mapping of str to str
        What a person has chosen, which stays.

    Returns
    -------
    dict of str to (Column, str)
        Field -> its column, and what its cells are in words.
    """
    out: dict[str, tuple[Column, str]] = {}
    naming = {name for name in ("title", "object_name", "classification") if name in found and found[name].filled}
    if not naming and not {"object_name", "title"} & chosen.keys():
        able = _likeliest(columns, found.values(), things)
        if able is not None:
            out["object_name"] = able, "most of its cells name things"
    if not ("medium" in found and found["medium"].filled) and "medium" not in chosen:
        used = [*found.values(), *(one for one, _ in out.values())]
        if not naming and not out:
            # What describes things where nothing else names them says first what they are.
            used += [one for one in columns if called(one.name, DESCRIPTION)]
        able = _likeliest(columns, used, materials)
        if able is not None:
            out["medium"] = able, "most of its cells name materials"
    return out


def _likeliest(columns: Sequence[Column], used: Iterable[Column], share: Callable[[Column], float]) -> Column | None:
    able = [
        (share(one), -one.length, one)
        for one in untaken(columns, used)
        if (named(one.name) is None or (share is materials and called(one.name, DESCRIPTION)))
        and len(one.distinct) >= _FEWEST
        and not (one.measured or one.of_machine or one.prose or one.pictured > _MOSTLY or one.dimensional > _MOSTLY)
        and placed(one) < _MOSTLY
        and not (share is things and _of_holding(one))
    ]
    best = max(able, key=lambda one: one[:2], default=None)
    return best[2] if best is not None and best[0] >= _MOSTLY else None


def _share(column: Column, says: Callable[[str], bool]) -> float:
    """Share of a column's different texts, of some at most, that say something."""
    some = column.distinct[:_SOME]
    return sum(map(says, some)) / len(some) if some else 0.0


def things(column: Column) -> float:
    """Share of a column's different texts that are short names of things: "Amphora", "armchair, walnut"."""
    return _share(column, names_thing)


def materials(column: Column) -> float:
    """Share of a column's different texts that name a material."""
    return _share(column, _is_material)


def _is_material(text: str) -> bool:
    words, signs = _materials()
    return not words.isdisjoint(_WORD.findall(folded(text))) or any(one in text for one in signs)


@cache
def _materials() -> tuple[frozenset[str], tuple[str, ...]]:
    """Return the words of materials, and those in signs, between which there are no blanks."""
    signs = tuple(one for one in material_words() if "\u3040" <= one[0] <= "\ud7af")
    return frozenset(material_words()) - frozenset(signs), signs


def accessions(column: Column) -> float:
    """Share of a column's texts that are written as museums number their objects: 1922.9, M 12/3, 83.AQ.377.542.

    Whole numbers alone may be those of a database, and dates are none.
    """
    return _share(column, _is_accession)


def _is_accession(text: str) -> bool:
    return _ACCESSION.fullmatch(text) is not None and (_DATE.fullmatch(text) is None)


def _dated(column: Column) -> float:
    """Share of a column's texts that are years or dates, and so number no object."""
    return _share(column, lambda text: _YEARS.fullmatch(text) is not None)


def repeated_in(column: Column) -> float:
    """Share of a column's cells that repeat another, or are empty.

    Parameters
    ----------
    column : Column
        Any.

    Returns
    -------
    float
    """
    return 1.0 - len(column.distinct) / len(column.values) if column.values else 1.0


def second_number(columns: Sequence[Column], found: Mapping[str, Column]) -> Column | None:
    """Return a column of other numbers, where that of the objects' numbers says of several that they have none.

    Whole numbers are rather those of a database than codes of another kind.
    """
    fields = {id(column) for column in found.values()}
    able = [column for column in columns if id(column) not in fields and column.numbering]
    alone = [column for column in able if len(column.distinct) == len(column.values)]
    whole = [column for column in alone if all(map(str.isdecimal, column.filled))]
    return next(iter(whole or alone), None) if found["object_number"].blanks else None


def unique_in(name: str, columns: Sequence[Column], found: Mapping[str, Column]) -> Column:
    """Return the column that tells rows apart: what may be a number first, prose and what is another field last."""
    able = [column for column in columns if column.filled and len(set(column.filled)) == len(column.values)]
    if able:
        fields = {id(column) for column in found.values()}

        def unlike(one: Column) -> tuple[bool, bool, bool, bool, bool, float, float]:
            sentences = one.prose and sum(" " in text for text in one.filled) > _MOSTLY * len(one.filled)
            dated = _dated(one) >= _MOSTLY
            number = one.numbering and not dated
            return (
                one.dimensional > _MOSTLY or (called(one.name, TEXTS) and one.sized > _MOSTLY),
                sentences or dated,
                not is_coded(one),
                id(one) in fields,
                not number,
                -round(accessions(one), 1),
                0 if number else one.length,
            )

        return min(able, key=unlike)
    there = ", ".join(repr(column.name) for column in columns[:30])
    raise CollectionError(
        f"{name}: no column looks like object numbers. Its columns are {there}. Say which has them: --choose "
        "object_number=COLUMN; or where the names of the columns stand: --choose header_row=NUMBER"
    )


_CODE = re.compile(r"[^\W\d_]{1,4}[ .-]?\d{1,6}[a-z]?")


def is_coded(column: Column) -> bool:
    """Say whether all that a column of names of objects holds is letters and a number: A1, A2, A3 under "Object".

    Parameters
    ----------
    column : Column
        Of the source.

    Returns
    -------
    bool
    """
    return called(column.name, "object_name") and all(_CODE.fullmatch(text.strip()) for text in column.filled)


def perhaps_sizes(columns: Sequence[Column]) -> str:
    """Return in words which columns hold numbers as sizes are, where no name of theirs says so; "" for none.

    Parameters
    ----------
    columns : sequence of Column
        Those that no field takes.

    Returns
    -------
    str
    """
    able = [one.name for one in columns if one.numeric and _varied(one) and not internal(one)]
    return f"; {', '.join(map(repr, able[:10]))} may hold sizes, for they are of different numbers" if able else ""


def _varied(column: Column) -> bool:
    """Whether numbers are neither years nor such as count the rows, and several of them come again or have decimals."""
    numbers = [float(text.replace(",", ".")) for text in column.numbers[:_SOME]]
    years = sum(_FIRST_YEAR <= number <= _LAST_YEAR and number.is_integer() for number in numbers)
    counted = all(after - before == 1 for before, after in pairwise(numbers))
    return len(set(numbers)) >= _FEWEST and not counted and years < _MOSTLY * len(numbers) and min(numbers) >= 0


_FIRST_YEAR, _LAST_YEAR = 1400, 2100


MOST_REPEATED = 0.1
"""Share of object numbers that may be repeated or missing before another column of numbers is looked for."""


def settle_number(
    able: Sequence[Column], columns: Sequence[Column], found: dict[str, Column], told: GuessNotes
) -> None:
    """Take another column of numbers where the likeliest repeats them or is empty, as of accessions of many objects.

    That is the next one by its name, or else one that has another number in each row.

    Parameters
    ----------
    able : sequence of Column
        Columns that may be of numbers by their names.
    columns : sequence of Column
        Of the source.
    found, told
        As of `guess`; they grow.
    """
    if "object_number" in told.choices or not able or repeated_in(able[0]) <= MOST_REPEATED or able[0].blanks:
        return
    fields = {id(column) for column in found.values()}
    others = [column for column in columns if id(column) not in fields and column.numbering]
    others.sort(key=repeated_in)
    other = next((column for column in (*able, *others) if repeated_in(column) <= MOST_REPEATED), None)
    if other is not None:
        found["object_number"] = other
        empty = len(able[0].distinct) == len(able[0].filled)
        told.doubts.append(
            f"{able[0].name!r} {'is empty in many rows' if empty else 'gives many objects one number'}: "
            f"{other.name!r} is taken for theirs"
        )


def _of_holding(column: Column) -> bool:
    """Whether most of a column's texts tell how a thing is held, or on what it stands: "plinth, bolted"."""
    some = column.distinct[:_SOME]
    return sum(told_by(text) != HeldAs() for text in some) > _MOSTLY * len(some)
