"""Whether a table has one row for each measurement, told from what its columns hold."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from pipeline.collection.guessing.columns import NUMBER, Column, candidates
from pipeline.collection.guessing.names import named, path_of, plain, unit_in
from pipeline.collection.sources.base import LongAgain, LongForm, LongSide
from pipeline.collection.sources.measurement_terms import kind_of, kind_within, part_of, plain_word, unit_of
from pipeline.collection.sources.measurements import FRACTION

_LETTERS = frozenset(("h", "b", "l", "t", "d", "w", "p", "a", "dm", "dia", "diam", "ø", "g", "gew", "wt", "kg"))
"""Letters by which kinds are told, in any language; the words beside them say which is which."""

_MOST_LETTERS = 12

_SEPARATORS = ("$", "|", ";", "\n")
"""What exports put between several values of one field in a cell."""

_SIDES = ("height_m", "width_m", "depth_m", "diameter_m", "mass_kg")
_KIND = {"mass": "weight"}
FEWEST_SIDES, FEWEST_SEVERAL = 2, 2
"""Columns of sides, and objects with several rows, from which rows are taken for those of parts (judgement)."""
APART = 0.8
"""Share of these objects whose rows each must name another part (judgement)."""

_FIGURES = re.compile(r"(?<!\d)\d{1,3}(?!\d)")

_MOSTLY = 0.6
"""Share of the texts of a column that must be kinds, units or numbers, and of cells that must say as many things as
those beside them (judgement)."""

VALUES = frozenset(
    {
        *("value", "dimension value", "measurement value", "measurement", "measure", "dimension", "amount"),
        *("wert", "maß", "masswert", "valeur", "mesure", "valore", "misura", "valor", "medida", "waarde", "maat"),
        *("valoare", "値", "数値"),
    }
)
"""Names of columns with the numbers of measurements."""


def long_form_of(columns: Sequence[Column]) -> LongForm | None:
    """Return how a table in long form is read; None for one with a row for each object.

    It is one where a column names kinds of measurements, at least two of them, beside a column of numbers, while object
    numbers repeat or are left empty; or where one cell names several kinds, and the next their values; or where rows of
    one object differ by the part that they measure, each with several sides.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.

    Returns
    -------
    LongForm or None
    """
    within = _numbered(columns) or _within(columns) or _of_parts(columns)
    if within is not None:
        return within
    types = [c for c in columns if (c.kinds >= 0.6 or _lettered(c)) and len(c.distinct) > 1]
    numbers = [c for c in candidates(columns).get("object_number", ()) if c.filled] or [
        c for c in columns if c.filled and c not in types and not c.units
    ][:1]
    if not types or not numbers:
        return None
    object_column, type_column = numbers[0], max(types, key=lambda c: c.kinds)
    # One row an object would name the kind of measurement once for each.
    if len(object_column.distinct) > 0.8 * len(object_column.values):
        return None
    at = list(columns).index(type_column)
    numeric = [c for c in columns if c.numeric and c is not object_column]
    values = [c for c in numeric if _is_value(c)] or sorted(numeric, key=lambda c: abs(list(columns).index(c) - at))
    if not values:
        return None
    unit = next((c for c in columns if c.units >= 0.6 and c is not type_column), None)
    used = (object_column, type_column, values[0], unit)
    part = next((c for c in columns if not any(c is u for u in used) and _parts(c) >= 0.5), None)
    return LongForm(
        object=object_column.name,
        type=type_column.name,
        value=values[0].name,
        unit=None if unit is None else unit.name,
        part=None if part is None else part.name,
    )


def _lettered(column: Column) -> bool:
    """Whether a column names kinds by letters, of which one is known by itself: B and T beside H."""
    said = {plain_word(text) for text in column.distinct[:_MOST_LETTERS]}
    return len(column.distinct) <= _MOST_LETTERS and said <= _LETTERS and any(map(kind_of, said))


def _within(columns: Sequence[Column]) -> LongForm | None:
    """Return how cells of several measurements are read: height$width in one column, 120$97.5 in another."""
    for separator in _SEPARATORS:
        apart = [(c, [text.split(separator) for text in c.values[:200]]) for c in columns]
        apart = [(c, pieces) for c, pieces in apart if any(len(one) > 1 for one in pieces)]
        found: dict[str, list[tuple[Column, list[list[str]]]]] = {"type": [], "unit": [], "value": []}
        for column, pieces in apart:
            some = [piece.strip() for one in pieces for piece in one if piece.strip()]
            for name, tells in (("type", _kind_alone), ("unit", unit_of), ("value", _number)):
                # Blanks between separators name nothing: " | ".
                if some and sum(tells(text) is not None for text in some) >= _MOSTLY * len(some):
                    found[name].append((column, pieces))
                    break
        objects = [c for c in candidates(columns).get("object_number", ()) if c.filled]
        for kind, kinds in found["type"] if objects else ():
            values = [column for column, pieces in found["value"] if _even(kinds, pieces)]
            # What is called a value before the ranks of measurements, decimals before fractions.
            values.sort(key=lambda one: (not _is_value(one), sum("/" in text for text in one.filled)))
            units = [column for column, _ in found["unit"]]
            pairs = [(value, _unit_beside(value, units, columns)) for value in values]
            if pairs:
                told = [(value.name, None if unit is None else unit.name) for value, unit in pairs]
                return LongForm(
                    object=objects[0].name,
                    type=kind.name,
                    value=told[0][0],
                    unit=told[0][1],
                    separator=separator,
                    again=tuple(LongAgain(value=value, unit=unit) for value, unit in told[1:] if unit != told[0][1]),
                )
    return None


def _is_value(column: Column) -> bool:
    return plain(path_of(column.name)[-1]) in VALUES


def _kind_alone(text: str) -> object:
    """Return the kind of measurement that a text names, and nothing where it tells a number besides: "H: 2.5 cm"."""
    return None if any(map(str.isdigit, text)) else kind_within(text)


def _numbered(columns: Sequence[Column]) -> LongForm | None:
    """Return how several measurements of a row are read, each in columns of its number: "Measurement 2 type"."""
    found: dict[int, dict[str, Column]] = {}
    for column in columns:
        for place in _FIGURES.finditer(column.name):
            role = f"{column.name[: place.start()]}#{column.name[place.end() :]}"
            found.setdefault(int(place[0]), {})[role] = column
    pooled: dict[str, list[str]] = {}
    for of in found.values():
        for role, column in of.items():
            pooled.setdefault(role, []).extend(column.filled)
    whole = {
        role: Column(role, texts) for role, texts in pooled.items() if sum(role in of for of in found.values()) > 1
    }
    kinds = [role for role, one in whole.items() if one.kinds >= _MOSTLY and len(one.distinct) > 1]
    numbers = [role for role, one in whole.items() if one.numeric or _share_of(one, _number) >= _MOSTLY]
    objects = [c for c in candidates(columns).get("object_number", ()) if c.filled]
    if not (kinds and numbers and objects):
        return None
    units = [role for role, one in whole.items() if one.units >= _MOSTLY and role not in kinds]
    parts = [role for role, one in whole.items() if role not in (*kinds, *numbers, *units) and _parts(one) >= 0.5]
    kind, number = kinds[0], min(numbers, key=lambda role: len(set(plain(role).split()) ^ set(plain(kinds[0]).split())))

    def called(of: dict[str, Column], roles: list[str]) -> str | None:
        return next((of[role].name for role in roles if role in of), None)

    rows = [of for _, of in sorted(found.items()) if kind in of and number in of]
    if len(rows) < FEWEST_SEVERAL:
        return None
    first, *others = (
        {"type": of[kind].name, "value": of[number].name, "unit": called(of, units), "part": called(of, parts)}
        for of in rows
    )
    return LongForm(object=objects[0].name, again=tuple(LongAgain(**one) for one in others), **first)


def _share_of(column: Column, known: Callable[[str], object]) -> float:
    return sum(known(text) is not None for text in column.filled) / len(column.filled) if column.filled else 0.0


def _even(kinds: Sequence[Sequence[str]], values: Sequence[Sequence[str]]) -> bool:
    """Whether nearly all cells of two columns that say anything say as many things."""
    both = [(one, other) for one, other in zip(kinds, values, strict=True) if any(one) or any(other)]
    return sum(len(one) == len(other) for one, other in both) >= _MOSTLY * len(both)


def _unit_beside(value: Column, units: Sequence[Column], columns: Sequence[Column]) -> Column | None:
    """Return the column with the units of one of numbers: the one whose name is most like its own, or the nearest."""
    places = {id(column): at for at, column in enumerate(columns)}
    words = set(plain(value.name).split())
    return min(
        units,
        key=lambda unit: (len(words ^ set(plain(unit.name).split())), abs(places[id(unit)] - places[id(value)])),
        default=None,
    )


def _of_parts(columns: Sequence[Column]) -> LongForm | None:
    """Return how rows are read of which each measures a part, the sides in columns of their own, as EMu and TMS do."""
    able = candidates(columns)
    number = next((one for one in able.get("object_number", ()) if one.filled), None)
    sides = [(name.removesuffix("_m").removesuffix("_kg"), found) for name, found in able.items() if name in _SIDES]
    if number is None or len(sides) < FEWEST_SIDES:
        return None
    several = [texts for texts in _groups(number.values, range(len(number.values))) if len(texts) > 1]
    if len(several) < FEWEST_SEVERAL:
        return None
    measured = {id(column) for _, those in sides for column in those} | {id(number)}
    parts = [
        (sum(_differ(column, rows) for rows in several), column)
        for column in columns
        if id(column) not in measured and named(column.name) is None and column.filled and not column.numeric
    ]
    most, part = max(parts, key=lambda pair: pair[0], default=(0, number))
    if most < APART * len(several) or len(part.distinct) == len(part.filled):
        return None
    called = next((able[name][0] for name in ("object_name", "title") if able.get(name)), None)
    return LongForm(
        object=number.name,
        part=part.name,
        called=None if called is None or called is part else called.name,
        sides=tuple(
            LongSide(column=one.name, kind=_KIND.get(kind, kind), unit=unit_in(one.name)[1] or "")
            for kind, those in sides
            for one in those
        ),
    )


def _groups(numbers: Sequence[str], rows: Iterable[int]) -> Iterable[list[int]]:
    found: dict[str, list[int]] = {}
    for at in rows:
        if numbers[at].strip():
            found.setdefault(numbers[at].strip(), []).append(at)
    return found.values()


def _differ(column: Column, rows: Sequence[int]) -> bool:
    """Whether the rows of one object each say something else."""
    said = [column.values[at].strip() for at in rows]
    return all(said) and len(set(said)) == len(said)


def _number(text: str) -> str | None:
    return text if NUMBER.fullmatch(text) or FRACTION.fullmatch(text) else None


def _parts(column: Column) -> float:
    """Share of a column's texts that name a part that may be measured."""
    some = column.filled[:200]
    return sum(part_of(text) is not None for text in some) / len(some) if some else 0.0
