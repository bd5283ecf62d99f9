"""Objects as plain JSON, in the words of the museum's own program: an array, one a line, a page, or a file each.

A name within a name is a column by its path, `MuseumLocation.DisplayCurrentLocation`; a list of texts is one text, with
"; " between. A list whose entries each say a kind of measurement and a number, such as
`{"type": "hoogte", "value": "115", "unit": "cm", "part": "doekmaat"}`, becomes columns `dimensions.height`,
`dimensions.frame width`, ... with their units as written. Numbers keep their characters.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import Request, SourceSettings
from pipeline.collection.sources.json_records import JsonSource, Values, files_of
from pipeline.collection.sources.measurement_terms import kind_of
from pipeline.collection.sources.measurements import NUMBER, OF_MEASUREMENTS, MeasuredSettings, Measurements, joined
from pipeline.collection.sources.rows import Row, as_text

MOST_COLUMNS = 2000
"""Names of one museum's objects."""

_HEAD = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:\[\s*)*\{\s*[\"}]")
_KINDS = ("type", "kind", "dimension_type", "dimensionType", "dimensiontype", "name", "label", "dimension")
_VALUES = ("value", "dimension", "amount", "number", "size", "val")
_UNITS = ("unit", "units", "unit_name", "unitName", "unitname", "uom")
_PARTS = ("part", "element", "element_name", "elementName", "extent", "aspect")
_PAGES = (
    *("items", "data", "results", "records", "objects", "rows", "hits", "artworks", "artObjects", "features", "docs"),
    *("entities", "collection", "objekte", "objets", "oggetti", "objetos", "member", "content"),
)
"""Names of the list of objects on a page of an API."""

_WRAPPERS = ("artObject", "_source", "attributes", "object", "record", "item", "node", "fields", "document", "objekt")
"""Names of one object on a page of its own, or of what a search engine found."""

_SCALARS = (str, int, float, bool)


class JsonSettings(MeasuredSettings):
    """How plain JSON is read."""

    format: Literal["json"] = Field(description="The kind of source.")
    records: str = Field(
        default="",
        description='Where a file lists its objects: names joined by points, such as items or hits.hits; "" where '
        "each value of the file is an object.",
    )


class Json(JsonSource):
    """A JSON file of objects, or a folder of such files and of its folders."""

    name = "json"
    title = "a JSON file"
    Settings: ClassVar[type[SourceSettings]] = JsonSettings
    exact = True
    deep = True

    def recognises(self, where: str, head: bytes) -> bool:
        """Say whether it begins as objects do; of a folder, whether it holds JSON files."""
        if _HEAD.match(head):
            return True
        return "://" not in where and Path(where).is_dir() and bool(files_of(Path(where), deep=True))

    def records(self, values: Values, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the objects: once for their names, and once for the rows.

        Parameters
        ----------
        values, file, request : callable, str, Request
            As of `JsonSource.records`.

        Yields
        ------
        Row
            First the header.

        Raises
        ------
        CollectionError
            For a value that is no object, and for more names than a table of objects has.
        """
        settings = request.settings
        names: dict[str, int] = {}
        for line, one in _objects(values, file, settings.records):
            cells, _ = flat(one, settings.unit)
            for name in cells:
                names.setdefault(name, len(names))
            if len(names) > MOST_COLUMNS:
                raise CollectionError(
                    f"{file}, line {line}: more than {MOST_COLUMNS:,} names; say in the mapping where the objects are "
                    "listed, [source] records, or export one object a line"
                )
        if not names:
            raise CollectionError(
                f"{file}: holds no object with a name and a value; see whether this is the right file"
            )
        yield Row(0, 1, list(names))
        for number, (line, one) in enumerate(_objects(values, file, settings.records), start=1):
            cells, faults = flat(one, settings.unit)
            if not cells.keys() <= names.keys():
                raise CollectionError(f"{file}, line {line}: was changed while it was read; import it again")
            yield Row(
                number,
                line,
                [cells.get(name, "") for name in names],
                faults={names[name]: fault for name, fault in faults.items()},
            )


def _objects(values: Values, file: str, where: str) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the objects, with the line where the value begins in which each stands."""
    for line, value in values():
        found = value
        for name in filter(None, where.split(".")):
            found = found.get(name) if isinstance(found, dict) else None
        listed = list(_unnested(found)) if found is not None else []
        if found is None or any(not isinstance(one, dict) for one in listed):
            what = f"no list {where!r} of objects is there" if where else "no object, which has names and values"
            raise CollectionError(
                f"{getattr(line, 'file', '') or file}, line {line}: {what}; say in the mapping where the objects are "
                "listed, [source] records, or leave out the files that hold none"
            )
        for one in listed:
            yield line, one


def _unnested(value: Any) -> Iterator[Any]:
    if isinstance(value, list):
        for one in value:
            yield from _unnested(one)
    else:
        yield value


def list_in(value: Any) -> str:
    """Return where a value lists objects, as [source] records says it; "" where it is an object itself, or a list.

    A page of an API has a list by a name that such lists have, or nothing but it and a few facts about it; a page of
    one object names it so.

    Parameters
    ----------
    value : object
        The first of a file.

    Returns
    -------
    str
        Names joined by points.
    """
    path: list[str] = []
    while isinstance(value, dict):
        lists = [name for name, one in value.items() if _is_list_of_objects(one)]
        named = [name for name in lists if name in _PAGES]
        if named or (len(lists) == 1 and len(value) <= 4):
            return ".".join([*path, (named or lists)[0]])
        inner = [name for name, one in value.items() if isinstance(one, dict)]
        within = next((name for name in inner if name in (*_PAGES, *_WRAPPERS)), None)
        if within is None and len(inner) == len(value) == 1:
            within = inner[0]
        if lists or within is None:
            break
        path.append(within)
        value = value[within]
    return ".".join(path)


def _is_list_of_objects(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)


def flat(record: Mapping[str, Any], unit: str | None = None) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """Return an object as cells by the paths of their names, and the faults of those that cannot be used.

    Parameters
    ----------
    record : mapping
        A JSON object.
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

    def take(path: str, value: Any) -> None:
        if isinstance(value, dict):
            for name, one in value.items():
                take(f"{path}.{name}" if path else name, one)
        elif isinstance(value, list) and not all(isinstance(one, _SCALARS) or one is None for one in value):
            if not _measured(path, value):
                for one in value:
                    take(path, one)
        elif isinstance(value, list):
            put(path, joined(as_text(one) for one in value))
        else:
            put(path, as_text(value))

    def _measured(path: str, value: list[Any]) -> bool:
        said = [one for one in map(_measurement, value) if one is not None]
        if len(said) < len(value) or not any(kind_of(one[0]) for one in said):
            return False
        measured = Measurements(unit)
        for one in said:
            measured.add(*one)
        for name, text in measured.cells().items():
            put(f"{path}.{name}", text)
        for at, fault in measured.faults(OF_MEASUREMENTS).items():
            faults[f"{path}.{OF_MEASUREMENTS[at]}"] = fault
            cells.setdefault(f"{path}.{OF_MEASUREMENTS[at]}", "")
        return True

    take("", record)
    return cells, faults


def _measurement(value: Any) -> tuple[str, str, str, str] | None:
    """Return kind, number, unit and part of what one entry of a list says; None where it says no measurement."""
    if not isinstance(value, dict):
        return None
    number = next((name for name in _VALUES if NUMBER.fullmatch(_text(value.get(name)).strip())), None)
    kind = next((name for name in _KINDS if name != number and kind_of(_text(value.get(name)))), None)
    if kind is None:
        kind = next((name for name in _KINDS if name != number and _text(value.get(name))), None)
    if number is None or kind is None:
        return None
    unit, part = (next((_text(value[name]) for name in those if value.get(name)), "") for those in (_UNITS, _PARTS))
    return _text(value[kind]), _text(value[number]), unit, part


def _text(value: Any) -> str:
    return as_text(value) if isinstance(value, _SCALARS) else ""
