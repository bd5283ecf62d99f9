"""Objects as plain JSON, in the words of the museum's own program: an array, one a line, a page, or a file each.

What columns they have, `nested` says. Numbers keep their characters.
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
from pipeline.collection.sources.json_shapes import KEY, at_path, in_groups, rows_of, table_of
from pipeline.collection.sources.measurements import MeasuredSettings
from pipeline.collection.sources.nested import object_rows
from pipeline.collection.sources.rows import Row

_HEAD = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:(?:\[\s*)*\{\s*[\"}]|\[\s*\[\s*\")")


class JsonSettings(MeasuredSettings):
    """How plain JSON is read."""

    format: Literal["json"] = Field(description="The kind of source.")
    records: str = Field(
        default="",
        description='Where a file lists its objects: names joined by points, such as items or hits.hits; "" where '
        "each value of the file is an object.",
    )
    layout: Literal["objects", "keyed", "grouped", "columns", "rows"] = Field(
        default="objects",
        description='How objects stand there: each by itself; "keyed" behind its number, {"1922.9": {...}, ...}, which '
        'the column "key" has; "grouped" in lists within lists, as objects in rooms, whose facts each of them has as '
        'well, and * in records is any name; "columns", one list of names and one of lists, or a list for each name; '
        'or "rows", lists of cells, of which the first has the names.',
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
    for line, value in rows_of(values()) if layout == "rows" else values():
        found = list(in_groups(value, where)) if layout == "grouped" else at_path(value, where)
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
