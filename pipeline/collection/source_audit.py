"""Contradictions that run through a source: what most of its rows show, what it comes to, and what settles it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import combinations
from statistics import median

from pipeline.collection.dimensions import agree
from pipeline.collection.errors import CollectionError
from pipeline.collection.mapping import WRITTEN, ColumnMap
from pipeline.collection.mapping_parts import Holds
from pipeline.collection.measured_cell import of_cell
from pipeline.collection.record import units_of
from pipeline.collection.unit_audit import Evidence, Suspicion, wrong_units
from pipeline.quantities import counted, figures

FEWEST = 20
"""Records that a contradiction of the whole source is told by: fewer may be chance."""

FEWEST_SIDES = 8
"""Records that tell one side from the other: that most of so few exchange them is no chance."""

FEWEST_UNITS = 3
"""Rows in which a column of units speaks."""

MOST = 0.5
"""Share of the records that could show it: a contradiction in more is the source's, in fewer it is each row's own."""

FEWEST_DECIMALS = 60
"""Numbers such as 1913.2 of which none ends in 0: by chance that is one source in 500."""

SIDES = ("height_m", "width_m", "depth_m")

_NEAR = 0.03
_UNIT_NAME = re.compile(
    r"\b(?:units?|uom|einheit(?:en)?|ma(?:ß|ss)einheit|unité|unite|unità|unita|unidad|unidade|eenheid|unitate|unități)\b|単位"
)
_DECIMAL = re.compile(r"\d{1,5}\.\d{1,6}", re.ASCII)

_PLACE = "place|"
_PLACES_TOLD = 5


class ContradictionError(CollectionError):
    """A source that contradicts itself in most rows, and a mapping that does not say what holds."""


@lru_cache(maxsize=1024)
def unit_named(text: str, kind: str) -> str | None:
    """Return the unit that a cell names, such as "inches" or "Zoll".

    Parameters
    ----------
    text : str
        The cell.
    kind : {"m", "kg"}
        Lengths or masses.

    Returns
    -------
    str or None
        As mappings name it; None for what is no such unit.
    """
    bare = text.strip().strip(".()[]")
    if not bare or len(bare) > 20 or any(c.isdigit() for c in bare):
        return None
    found = of_cell(f"1 {bare}", kind, ".")
    if found is None:
        return None
    units = units_of("height_m" if kind == "m" else "mass_kg")
    return min(units, key=lambda unit: abs(units[unit] - found[0])) if found[0] in units.values() else None


def unit_columns(columns: Mapping[str, ColumnMap], header: Sequence[str]) -> dict[str, list[int]]:
    """Return the columns that name the units of fields, and that the mapping does not use.

    Parameters
    ----------
    columns : mapping of str to ColumnMap
        Of the mapping, by field.
    header : sequence of str
        The names of all columns.

    Returns
    -------
    dict of str to list of int
        By field, the places of those that may speak of it: those whose names name its column, else all.
    """
    used = {name for column in columns.values() for name in (*column.sources, column.unit_column) if name}
    named = {at: _plain(name) for at, name in enumerate(header) if name not in used and _UNIT_NAME.search(_plain(name))}
    there = {f: c for f, c in columns.items() if c.column in header and not c.unit_column}
    fields = {f: c for f, c in there.items() if c.unit is not None and c.unit != WRITTEN}
    own = {
        at: [f for f, column in fields.items() if re.search(rf"\b{re.escape(_plain(str(column.column)))}\b", name)]
        for at, name in named.items()
    }
    return {
        field: found
        for field in fields
        if (found := [at for at, those in own.items() if field in those] or [at for at in own if not own[at]])
    }


def _plain(name: str) -> str:
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return re.sub(r"[\s_.:\-]+", " ", spaced).strip().casefold()


def see_number(found: Evidence, number: str) -> None:
    """Note whether an object number that looks like a decimal ends in 0, which a spreadsheet drops."""
    if _DECIMAL.fullmatch(number):
        found.tally("decimals", shown=number.endswith("0"))


def see_pairs(found: Evidence, pairs: Iterable[tuple[str, float, float]]) -> None:
    """Note what columns and texts say of the same fields, and whether two sides are exchanged."""
    said: dict[str, tuple[float, float]] = {}
    for name, column, text in pairs:
        if name not in said:
            said[name] = column, text
            alike = agree(column, text, "mass" if name == "mass_kg" else "length")
            found.ratios[name] = [1.0 if alike or not column else float(f"{text / column:.3g}")]
    for one, two in combinations([side for side in SIDES if side in said], 2):
        (a, a_text), (b, b_text) = said[one], said[two]
        crossed = agree(a, b_text, "length") and agree(b, a_text, "length")
        straight = agree(a, a_text, "length") and agree(b, b_text, "length")
        # A square, and a text that gives another part's size, tell nothing.
        if crossed != straight:
            found.tally(f"sides|{one}|{two}", shown=crossed)


def audit(
    found: Evidence, columns: Mapping[str, ColumnMap], rows: Mapping[str, Sequence[str]]
) -> tuple[Suspicion, ...]:
    """Say what runs through a source.

    Parameters
    ----------
    found : Evidence
        Of all its records.
    columns : mapping of str to ColumnMap
        Of the mapping, by field.
    rows : mapping of str to sequence of str
        Some rows in words, by what they show.

    Returns
    -------
    tuple of Suspicion
        Those with a key ``holds`` stop the import until the mapping says what holds.
    """
    units = wrong_units(found, rows)
    out = [*_sides(found, columns, rows)]
    crossed = {name for one in out for name in one.field.split(", ")}
    out += [one for name in found.ratios if name not in crossed for one in _texts(found, name, columns, rows)]
    against = any(one.holds == "texts" for one in out)
    # That columns are in another unit than mapped is shown by texts already, and better.
    out += [*_units(found, columns, rows), *(one for one in units if not (against and one.holds == "units"))]
    if not any(one.holds == "weights" for one in units):
        out += _weights(found, rows)
    return (*out, *_display(found, rows), *_decimals(found))


def _sides(found: Evidence, columns: Mapping[str, ColumnMap], rows: Mapping[str, Sequence[str]]) -> Iterable[Suspicion]:
    for key in found.tallies:
        does, could = _most(found, key, FEWEST_SIDES) if key.startswith("sides|") else (0, 0)
        if does:
            one, two = key.split("|")[1:]
            first, second = (_column(name, columns) for name in (one, two))
            yield Suspicion(
                f"{one}, {two}",
                f"{_bare(one)} and {_bare(two)} are exchanged in {does:,} of {could:,} rows, as their texts say",
                f"exchange {first} and {second} in [columns.{one}] and [columns.{two}] of the mapping; if the columns "
                'are right, say [holds] sides = "mapping"',
                "sides",
                tuple(rows.get(key, ())),
            )


def _texts(
    found: Evidence, name: str, columns: Mapping[str, ColumnMap], rows: Mapping[str, Sequence[str]]
) -> Iterable[Suspicion]:
    ratios = found.ratios[name]
    other = [ratio for ratio in ratios if ratio != 1.0]
    if len(ratios) < FEWEST or len(other) <= MOST * len(ratios):
        return
    middle = median(other)
    common = sum(abs(ratio / middle - 1.0) <= _NEAR for ratio in other if middle)
    mostly = f", mostly {figures(middle, 3)} times" if common > MOST * len(other) else ""
    unit = _unit_by(middle, columns.get(name)) if mostly else None
    remedy = 'say in the mapping which of them holds: [holds] texts = "columns" or texts = "texts"'
    if unit is not None:
        remedy = f'say unit = "{unit}" in [columns.{name}] of the mapping, which all of them fit; or {remedy}'
    yield Suspicion(
        name,
        f"{_column(name, columns)} and the texts say other things of {_bare(name)} in {len(other):,} of "
        f"{len(ratios):,} rows{mostly}",
        remedy,
        "texts",
        tuple(rows.get(f"texts|{name}", ())),
    )


def _unit_by(ratio: float, column: ColumnMap | None) -> str | None:
    """Return the unit in which a column's numbers would be what the texts say."""
    units = units_of("height_m") if column is None or column.unit not in units_of("mass_kg") else units_of("mass_kg")
    if column is None or column.unit is None or column.unit not in units:
        return None
    mapped = units[column.unit]
    fits = {unit: abs(ratio * mapped / factor - 1.0) for unit, factor in units.items()}
    best = min(fits, key=lambda unit: fits[unit])
    return best if fits[best] <= _NEAR and best != column.unit else None


def _units(found: Evidence, columns: Mapping[str, ColumnMap], rows: Mapping[str, Sequence[str]]) -> Iterable[Suspicion]:
    told: dict[tuple[str, str], dict[str, int]] = {}
    for key, (could, _) in found.tallies.items():
        if key.startswith("unit|"):
            _, name, where, unit = key.split("|", 3)
            counts = told.setdefault((name, where), {})
            counts[unit] = counts.get(unit, 0) + could
    for (name, where), counts in told.items():
        column = columns.get(name)
        mapped = "" if column is None else str(column.unit)
        total, other = sum(counts.values()), {unit: n for unit, n in counts.items() if unit != mapped}
        if total >= FEWEST_UNITS and sum(other.values()) > MOST * total:
            said = ", ".join(f"{unit} in {n:,}" for unit, n in sorted(other.items(), key=lambda one: -one[1]))
            yield Suspicion(
                name,
                f"the column {where!r} says {said} of {total:,} rows, the mapping that {_column(name, columns)} is in "
                f"{mapped}",
                f"say unit_column = {_quoted(where)} in [columns.{name}] of the mapping, which reads each row's own "
                'unit; if that column is wrong, say [holds] units = "mapping"',
                "units",
                tuple(rows.get(f"unit|{name}", ())),
            )


def _weights(found: Evidence, rows: Mapping[str, Sequence[str]]) -> Iterable[Suspicion]:
    does, could = _most(found, "weights")
    if does:
        yield Suspicion(
            "mass_kg",
            f"{does:,} of {could:,} objects that are weighed and measured are heavier than anything of their size can "
            "be, or lighter",
            'weigh one again, and mend the units in the mapping; if they are right, say [holds] weights = "mapping"',
            "weights",
            tuple(rows.get("weights", ())),
        )


def _display(found: Evidence, rows: Mapping[str, Sequence[str]]) -> Iterable[Suspicion]:
    does, could = _most(found, "display")
    if does:
        yield Suspicion(
            "on_display",
            f"{does:,} of {could:,} objects that a flag says to be on display are where nothing is, as their location "
            "says",
            'say in the mapping which of them holds: [holds] display = "flag" or display = "location"; a location that '
            "is a gallery after all is named in [display] on_display",
            "display",
            tuple(rows.get("display", ())),
        )


def _most(found: Evidence, what: str, fewest: int = FEWEST) -> tuple[int, int]:
    """Return how many records show a contradiction, 0 unless most do, and how many could."""
    could, does = found.tallies.get(what, (0, 0))
    return (does if could >= fewest and does > MOST * could else 0), could


def _decimals(found: Evidence) -> Iterable[Suspicion]:
    could, does = found.tallies.get("decimals", (0, 0))
    if could >= FEWEST_DECIMALS and not does:
        yield Suspicion(
            "object_number",
            f"of {could:,} object numbers such as 1913.2 none ends in 0, as if a spreadsheet had taken them for "
            "decimals, and 1913.20 had become 1913.2",
            "export the column as text, and compare some numbers with the objects' labels",
        )


def taken_away(found: Evidence) -> Iterable[Suspicion]:
    """Return what was settled without anybody having said it: which locations were taken for no galleries."""
    places = {key.removeprefix(_PLACE): n for key, (n, _) in found.tallies.items() if key.startswith(_PLACE)}
    if places:
        first = sorted(places.items(), key=lambda one: (-one[1], one[0]))
        told = ", ".join(f"{place[:60]!r} ({n:,})" for place, n in first[:_PLACES_TOLD])
        more = f" and {counted(len(first) - _PLACES_TOLD, 'other')}" if len(first) > _PLACES_TOLD else ""
        yield Suspicion(
            "on_display",
            f"{counted(sum(places.values()), 'object')} taken not to be on display, as the name of the location says: "
            f"{told}{more}",
            "name in the mapping, [display], those that are galleries after all in on_display, the others in "
            "not_on_display",
        )


def place_key(location: str) -> str:
    """Return the key under which a location is counted that says by its name that it is no gallery."""
    return f"{_PLACE}{location}"


def judged(all_: Iterable[Suspicion], holds: Holds) -> tuple[tuple[Suspicion, ...], tuple[Suspicion, ...]]:
    """Part what is open from what the mapping settled, which is told as a choice."""
    open_, settled = [], []
    for one in all_:
        held = getattr(holds, one.holds) if one.holds else None
        if held is None:
            open_.append(one)
        else:
            what = f'settled by the mapping, [holds] {one.holds} = "{held}"'
            settled.append(Suspicion(one.field, f"{one.message}; {what}", one.remedy, one.holds, one.examples))
    return tuple(open_), tuple(settled)


def require_settled(source: str, found: Iterable[Suspicion]) -> None:
    """Refuse a source that contradicts itself in most rows, where its mapping does not say what holds.

    Parameters
    ----------
    source : str
        Its name.
    found : iterable of Suspicion
        What runs through it.

    Raises
    ------
    ContradictionError
        Naming each contradiction with its counts, some rows, and the line of the mapping that settles it.
    """
    stops = [one for one in found if one.holds]
    if not stops:
        return
    lines = [f"{source}: it contradicts itself in most rows, and nothing was imported"]
    for one in stops:
        lines.append(f"  {one.message}")
        lines += [f"    {example}" for example in one.examples]
        lines.append(f"    to settle it: {one.remedy}")
    raise ContradictionError("\n".join(lines))


def _column(name: str, columns: Mapping[str, ColumnMap]) -> str:
    column = columns.get(name)
    return f"the column of {_bare(name)}" if column is None or not column.column else f"the column {column.column!r}"


def _bare(name: str) -> str:
    return re.sub("_(m|kg)$", "", name).replace("_", " ")


def _quoted(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
