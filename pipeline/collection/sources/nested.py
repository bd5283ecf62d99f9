"""Objects as names and values within each other, from JSON or XML: their cells by the paths of their names.

A name within a name is a column by its path, `MuseumLocation.DisplayCurrentLocation`; a list of texts is one text, with
"; " between; a list of pairs, `{"label": "Room", "value": "Hall"}`, is a column for each label. A list whose entries
each say a kind of measurement and a number, such as `{"type": "hoogte", "value": "115", "unit": "cm"}`, becomes columns
`dimensions.height`, `dimensions.frame width`, ... with their units as written.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from pipeline.collection.errors import CollectionError
from pipeline.collection.hand_cell import LONGEST, of_hand
from pipeline.collection.sources.measurement_terms import kind_of, kind_within, unit_of
from pipeline.collection.sources.measurements import FRACTION, NUMBER, OF_MEASUREMENTS, Measurements, joined
from pipeline.collection.sources.pairs import listed, pairs_in
from pipeline.collection.sources.rows import Row, as_text
from pipeline.errors import InputError
from pipeline.quantities import MASSES

MOST_COLUMNS = 2000
"""Names of one museum's objects."""

Objects = Callable[[], Iterator[tuple[int, Mapping[str, Any]]]]
"""Gives the lines and the objects of a source from its beginning, as often as it is asked."""

_KINDS = ("type", "kind", "dimension_type", "dimensionType", "dimensiontype", "name", "label", "dimension")
_VALUES = ("value", "dimension", "amount", "number", "size", "val", "reading", "measurement")
_UNITS = ("unit", "units", "unit_name", "unitName", "unitname", "uom")
_PARTS = ("part", "element", "element_name", "elementName", "extent", "aspect")
# Words that a longer name ends in, PhyType beside PhyValue and PhyUnit: "name" and "number" end too many.
_TEXTS = ("value", "number", "text", "content")
_KIND_LENGTH = 40
_LAST = {
    _KINDS: frozenset(("type", "kind", "dimension")),
    _VALUES: frozenset(("value", "amount", "size", "val", "reading")),
    _UNITS: frozenset(("unit", "units", "uom")),
    _PARTS: frozenset(("part", "element", "extent", "aspect")),
}
_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_WITH_UNIT = re.compile(rf"({NUMBER.pattern})\s*([^\W\d]+\.?|\")", re.ASCII)
_DELETED = (
    "its source says that it was deleted",
    "nothing, if the object is gone; else harvest it again",
)
_PART_NAMES = ("part", "element", "component", "name", "label", "title", "type", "elementName", "element_name")
_IN_PLAN = frozenset(("length", "width", "depth"))
_SHOWN = frozenset(("label", "value", "order", "isLink"))
_LITERAL = frozenset(("type", "value", "xml:lang", "datatype"))
_LITERALS = ("literal", "typed-literal", "uri", "bnode")
_ADDRESS = re.compile(r"https?://\S+", re.ASCII)
ADDRESS = "url"
"""Below a name with several texts, of which some are addresses: these."""

_PAIR = 2
_SPOKEN = ("lang", "language", "id")
"""Names of what may look like a unit, and is none."""

_SCALARS = (str, int, float, bool)


def object_rows(objects: Objects, file: str, unit: str | None, remedy: str) -> Iterator[Row]:
    """Yield the header and the objects: they are read once for their names, and once for the rows.

    Parameters
    ----------
    objects : callable
        Gives them.
    file : str
        The name of the source, for messages.
    unit : str or None
        The unit of lengths that name none.
    remedy : str
        What mends a source of which too many names are told.

    Yields
    ------
    Row
        First the header.

    Raises
    ------
    CollectionError
        For more names than a table of objects has, for none, and for a source that changes while it is read.
    """
    names: dict[str, int] = {}
    for line, one in objects():
        for name in flat(one, unit)[0]:
            names.setdefault(name, len(names))
        if len(names) > MOST_COLUMNS:
            raise CollectionError(f"{file}, line {line}: more than {MOST_COLUMNS:,} names; {remedy}")
    if not names:
        raise CollectionError(f"{file}: holds no object with a name and a value; see whether this is the right file")
    yield Row(0, 1, list(names))
    for number, (line, one) in enumerate(objects(), start=1):
        cells, faults = flat(one, unit)
        if not cells.keys() <= names.keys():
            raise CollectionError(f"{file}, line {line}: was changed while it was read; import it again")
        yield Row(
            number,
            line,
            [cells.get(name, "") for name in names],
            _DELETED if _is_deleted(one) else ("", ""),
            {names[name]: fault for name, fault in faults.items()},
        )


def _is_deleted(record: Mapping[str, Any]) -> bool:
    """Whether a record says that it is none any more, as those of a harvest (OAI-PMH) do."""
    head = record.get("header")
    return isinstance(head, dict) and head.get("status") == "deleted"


def flat(record: Mapping[str, Any], unit: str | None = None) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """Return an object as cells by the paths of their names, and the faults of those that cannot be used.

    Parameters
    ----------
    record : mapping
        An object.
    unit : str or None
        The unit of lengths that name none.

    Returns
    -------
    (dict of str to str, dict of str to (str, str))
        Empty texts where a name has no value, so that the name is known.
    """
    cells: dict[str, str] = {}
    faults: dict[str, tuple[str, str]] = {}

    def put(path: str, text: str) -> None:
        cells[path] = joined([cells[path], text]) if cells.get(path) else text

    def take(path: str, value: Any, part: str = "") -> None:
        if isinstance(value, dict):
            literal = _literal(value)
            if literal is not None:
                put(path, as_text(literal))
                return
            if path and _is_labelled(value):
                take(path, value["value"], part)
                return
            amount = _amount_alone(value) if path else ""
            if amount:
                put(path, amount)
                return
            entries = listed(value)
            if entries is not None:
                take(path, entries, part)
                return
            for name, one in value.items():
                take(f"{path}.{name}" if path else name, one, part)
        elif isinstance(value, list) and not all(isinstance(one, _SCALARS) or one is None for one in value):
            if _measured(path, value, part):
                return
            pairs = pairs_in(value)
            if pairs is not None:
                for name, one in pairs:
                    take(f"{path}.{name}" if path else name, one, part)
            else:
                for one in value:
                    take(path, one, _part_of(one) or part)
                for kind, text in _of_kinds(value):
                    put(f"{path}.{kind}", text)
        elif isinstance(value, list):
            texts = [as_text(one) for one in value]
            addresses = [text for text in texts if _ADDRESS.match(text)]
            if 0 < len(addresses) < len(texts):
                # A number and the page of the object are two things: "NF.1942-0121; https://museum.no/id/10400".
                put(f"{path}.{ADDRESS}", joined(addresses))
                texts = [text for text in texts if text not in addresses]
            put(path, joined(texts))
        else:
            put(path, as_text(value))

    def _measured(path: str, value: list[Any], part: str) -> bool:
        said = measurements_in(value)
        if said is None:
            return False
        measured = Measurements(unit)
        for kind, number, of, own in said:
            measured.add(*_in_part(kind, number, of, own, part))
        for name, text in measured.cells().items():
            put(f"{path}.{name}", text)
        for at, fault in measured.faults(OF_MEASUREMENTS).items():
            faults[f"{path}.{OF_MEASUREMENTS[at]}"] = fault
            cells.setdefault(f"{path}.{OF_MEASUREMENTS[at]}", "")
        return True

    take("", record)
    return cells, faults


def measurements_in(entries: Sequence[Any]) -> list[tuple[str, str, str, str]] | None:
    """Return kind, number, unit and part of each entry of a list; None where they are not all measurements.

    What says the kind of one says it of all: "H" is known by itself, "B" and "T" are beside it.

    Parameters
    ----------
    entries : sequence of object
        Such as `[{"art": "H", "value": "58", "unit": "cm"}, {"art": "B", "value": "40", "unit": "cm"}]`.

    Returns
    -------
    list of (str, str, str, str) or None
    """
    known = next((one for one in map(_kind_within, entries) if one), None)
    if known is None and not all(map(_is_mass, entries)):
        return None
    said = [one for one in (_measurement(one, known) for one in entries) if one is not None]
    return said if said and len(said) == len(entries) else None


def is_measurement(value: Any) -> bool:
    """Say whether an entry tells one measurement of a kind that is known.

    Parameters
    ----------
    value : object
        Such as `{"type": "hoogte", "value": "115", "unit": "cm"}`.

    Returns
    -------
    bool
    """
    return _kind_within(value) is not None


def _kind_within(value: Any) -> str | None:
    """Return the name under which an entry that has a number says a kind of measurement that is known."""
    if not isinstance(value, dict) or (number := _number_within(value)) is None:
        return None
    able = [name for name in value if name != number and _text(value[name])]
    # In any language: what is a kind of measurement by what it says.
    return next(
        (name for name in [*_named(value, _KINDS), *able] if name in able and kind_of(_text(value[name]))), None
    )


def _number_within(value: Mapping[str, Any]) -> str | None:
    """Return the name under which an entry says a number; in words that are not known, the only one beside a unit."""
    named = next((name for name in _named(value, _VALUES) if _amount(_text(value[name]))), None)
    if named is not None:
        return named
    able = [name for name in value if name not in _SPOKEN and _amount(_text(value[name]))]
    told = any(unit_of(_text(one)) for name, one in value.items() if name not in _SPOKEN)
    return able[0] if len(able) == 1 and (told or (_amount(_text(value[able[0]])) or ("", ""))[1]) else None


def _amount_alone(value: Mapping[str, Any]) -> str:
    """Return number and unit of what holds these two and nothing else, in words that are not known: 12 cm; "" else."""
    number = _number_within(value) if len(value) == _PAIR and not _named(value, _VALUES) else None
    unit = next((_text(one).strip() for name, one in value.items() if name != number), "")
    return f"{_text(value[number]).strip()} {unit}" if number is not None and unit_of(unit) else ""


def _is_mass(value: Any) -> bool:
    """Whether an entry is a number with a unit of masses, which needs no word for what it is."""
    if not isinstance(value, dict) or (number := _number_within(value)) is None:
        return False
    units = {unit_of(_text(one)) for name, one in value.items() if name != number and name not in _SPOKEN}
    return bool(units & MASSES.keys())


def _measurement(value: Any, known: str | None) -> tuple[str, str, str, str] | None:
    """Return kind, number, unit and part of what one entry of a list says; None where it says no measurement.

    known : the name under which another entry says its kind
    """
    if not isinstance(value, dict) or (number := _number_within(value)) is None:
        return None
    able = [name for name in value if name != number and _text(value[name])]
    kind = _kind_within(value) or (known if known in able else None)
    kind = kind or next((name for name in _named(value, _KINDS) if name in able), None)
    if kind is None and not _is_mass(value):
        return None
    amount, within = _amount(_text(value[number])) or ("", "")
    units = [*_named(value, _UNITS), *(name for name in able if name not in _SPOKEN and unit_of(_text(value[name])))]
    unit, part = (
        next((_text(value[name]) for name in those if name in able and name != kind), "")
        for those in (units, _named(value, _PARTS))
    )
    return "weight" if kind is None else _text(value[kind]), amount, unit or within, part


def _part_of(value: Any) -> str:
    """Return the name of an entry with measurements within it, of which they all are: a part of the object."""
    if not isinstance(value, dict) or not any(_has_measurements(one) for one in value.values()):
        return ""
    return next((_text(value[name]).strip() for name in _PART_NAMES if _text(value.get(name, "")).strip()), "")


def _has_measurements(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(_has_measurements, value.values()))
    return isinstance(value, list) and measurements_in(value) is not None


def _in_part(kind: str, number: str, unit: str, own: str, part: str) -> tuple[str, str, str, str]:
    """Return a measurement of a part as `Measurements.add` takes it; the part's name may say which it is itself."""
    if own or not part:
        return kind, number, unit, own
    within, known = kind_within(part), kind_of(kind)
    # Lengths in plan have several names.
    if within is not None and known is not None and (within[0] == known or {within[0], known} <= _IN_PLAN):
        return part, number, unit, ""
    return kind, number, unit, part


def _is_labelled(value: Mapping[str, Any]) -> bool:
    """Whether a value stands beside the label that a page has for it: {"label": "Location", "value": "Hall"}."""
    label = value.get("label")
    return "value" in value and isinstance(label, str) and value.keys() <= _SHOWN and unit_of(label) is None


def _literal(value: Mapping[str, Any]) -> Any:
    """Return the value of a literal or an address of a graph, as answers to SPARQL have it; None for anything else."""
    if "value" in value and value.keys() <= _LITERAL and value.get("type") in _LITERALS:
        return value["value"] if isinstance(value["value"], _SCALARS) else None
    return None


def _of_kinds(entries: Sequence[Any]) -> Iterator[tuple[str, str]]:
    """Yield kind and text of each entry of a list, all of which say both: numbers, old and new, say."""
    told = []
    for one in entries:
        kind, text = (next((name for name in names if isinstance(one, dict) and _text(one.get(name, ""))), None)
                      for names in (_KINDS[:2], _TEXTS))  # fmt: skip
        if kind is None or text is None or not 0 < len(said := _text(one[kind]).strip()) <= _KIND_LENGTH:
            return
        told.append((said, _text(one[text])))
    yield from told


def _named(value: Mapping[str, Any], names: tuple[str, ...]) -> list[str]:
    """Return the names of an entry that are some words, or that end in one."""
    last = _LAST[names]
    return [*(name for name in names if name in value),
            *(name for name in value if name not in names and _last_word(name) in last)]  # fmt: skip


def _last_word(name: str) -> str:
    words = _WORDS.findall(name)
    return words[-1].casefold() if words else ""


def _amount(text: str) -> tuple[str, str] | None:
    """Return a number and the unit behind it, "" where there is none; None where it is no number."""
    if NUMBER.fullmatch(text.strip()):
        return text.strip(), ""
    told = _WITH_UNIT.fullmatch(text.strip())
    if told:
        return (told[1], told[2]) if unit_of(told[2]) else None
    return (text.strip(), "") if FRACTION.fullmatch(text.strip()) or _is_written(text) else None


def _is_written(text: str) -> bool:
    """Whether a text is one length or mass as people write it, with its unit: 7 ft 2 in, 19 1/2 in."""
    for unit in ("m", "kg") if len(text) <= LONGEST and any(map(str.isdigit, text)) else ():
        with suppress(InputError):
            return of_hand(text, unit).named
    return False


def _text(value: Any) -> str:
    return as_text(value) if isinstance(value, _SCALARS) else ""
