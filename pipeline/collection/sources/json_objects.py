"""Objects as plain JSON, in the words of the museum's own program: an array, one a line, a page, or a file each.

What columns they have, `nested` says. Numbers keep their characters.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import Request, SourceSettings
from pipeline.collection.sources.json_records import JsonSource, Values, files_of
from pipeline.collection.sources.measurements import MeasuredSettings
from pipeline.collection.sources.nested import object_rows
from pipeline.collection.sources.rows import Row

_HEAD = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:\[\s*)*\{\s*[\"}]")
_PAGES = (
    *("items", "data", "results", "records", "objects", "rows", "hits", "artworks", "artObjects", "features", "docs"),
    *("entities", "collection", "objekte", "objets", "oggetti", "objetos", "member", "content"),
)
"""Names of the list of objects on a page of an API."""

KEY = "key"
"""The column of what stands before an object, where objects are keyed."""

_COLUMNS = 3
"""Lists of as many cells from which on these are columns of a table (judgement)."""

_FEWEST = 2
"""Objects, and names that most of them have, from which on they are keyed (judgement)."""

_WRAPPERS = ("artObject", "_source", "attributes", "object", "record", "item", "node", "fields", "document", "objekt")
"""Names of one object on a page of its own, or of what a search engine found."""


class JsonSettings(MeasuredSettings):
    """How plain JSON is read."""

    format: Literal["json"] = Field(description="The kind of source.")
    records: str = Field(
        default="",
        description='Where a file lists its objects: names joined by points, such as items or hits.hits; "" where '
        "each value of the file is an object.",
    )
    layout: Literal["objects", "keyed", "columns"] = Field(
        default="objects",
        description='How objects stand there: each by itself; "keyed" behind its number, {"1922.9": {...}, ...}, which '
        'the column "key" has; or "columns", one list of names and one of lists, or a list for each name.',
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
        remedy = "say in the mapping where the objects are listed, [source] records, or export one object a line"
        yield from object_rows(
            lambda: _objects(values, file, settings.records, settings.layout), file, settings.unit, remedy
        )


def _objects(values: Values, file: str, where: str, layout: str) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the objects, with the line where the value begins in which each stands."""
    for line, value in values():
        found = at_path(value, where)
        if layout == "keyed" and isinstance(found, dict) and all(isinstance(one, dict) for one in found.values()):
            found = [{KEY: key, **one} for key, one in found.items()]
        elif layout == "columns":
            found = table_of(found)
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


def list_in(value: Any, *, alone: bool = True) -> str:
    """Return where a value lists objects, as [source] records says it; "" where it is an object itself, or a list.

    A page of an API has a list by a name that such lists have, or nothing but it and a few facts about it; a page of
    one object names it so.

    Parameters
    ----------
    value : object
        The first of a file.
    alone : bool
        Whether it is the only one: of several each is an object, however few facts it has, or a page that is named so.

    Returns
    -------
    str
        Names joined by points.
    """
    path: list[str] = []
    while isinstance(value, dict):
        lists = [name for name, one in value.items() if _is_list_of_objects(one)]
        named = [name for name in lists if name in _PAGES]
        if named or (alone and len(lists) == 1 and len(value) <= 4):
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


def at_path(value: Any, where: str) -> Any:
    """Return what stands at a path of names within a value; None where nothing does."""
    for name in filter(None, where.split(".")):
        value = value.get(name) if isinstance(value, dict) else None
    return value


def table_of(value: Any) -> list[dict[str, Any]] | None:
    """Return the objects of a table, of which a value has the names and the cells; None of any other value.

    Parameters
    ----------
    value : object
        Such as `{"columns": ["number", "name"], "data": [["1922.9", "Vase"]]}`, or `{"number": ["1922.9"], "name":
        ["Vase"]}`.
    """
    if not isinstance(value, dict) or not all(isinstance(one, list) for one in value.values()):
        return None
    if len(value) >= _COLUMNS and len({len(one) for one in value.values()}) == 1:
        scalar = all(not isinstance(cell, dict | list) for one in value.values() for cell in one)
        if scalar and len(next(iter(value.values()))) >= _FEWEST:
            return [dict(zip(value, cells, strict=True)) for cells in zip(*value.values(), strict=True)]
    heads = [one for one in value.values() if one and all(isinstance(name, str) for name in one)]
    tables = [one for one in value.values() if one and all(isinstance(row, list) for row in one)]
    if len(heads) != 1 or len(tables) != 1 or len(set(heads[0])) < len(heads[0]):
        return None
    if any(len(row) != len(heads[0]) for row in tables[0]):
        return None
    return [dict(zip(heads[0], row, strict=True)) for row in tables[0]]


def is_keyed(value: Any) -> bool:
    """Say whether a value has objects behind their numbers: several that have names in common, and nothing else.

    Parameters
    ----------
    value : object
        Such as `{"1922.9": {"title": "Vase", "height": 12}, "1922.10": {"title": "Cup", "height": 7}}`.
    """
    if not isinstance(value, dict) or len(value) < _FEWEST or not all(isinstance(one, dict) for one in value.values()):
        return False
    often = Counter(name for one in value.values() for name in one)
    return sum(2 * times >= len(value) for times in often.values()) >= _FEWEST


def _is_list_of_objects(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)
