"""Where a value of JSON lists objects, and how they stand there: by themselves, keyed, in groups, or as a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

_PAGES = (
    *("items", "data", "results", "records", "objects", "rows", "hits", "artworks", "artObjects", "features", "docs"),
    *("entities", "collection", "objekte", "objets", "oggetti", "objetos", "member", "content"),
)
"""Names of the list of objects on a page of an API."""

KEY = "key"
"""The column of what stands before an object, where objects are keyed."""

ANY = "*"
"""In a path: any name."""

GROUP = "group"
"""Before the facts of a group that stands at the beginning of a path."""

_SCALARS = (str, int, float, bool, type(None))
_COLUMNS = 3
"""Lists of as many cells from which on these are columns of a table (judgement)."""

_FEWEST = 2
"""Objects, and names that most of them have, from which on they are keyed (judgement)."""

_WRAPPERS = ("artObject", "_source", "attributes", "object", "record", "item", "node", "fields", "document", "objekt")
"""Names of one object on a page of its own, or of what a search engine found."""


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
        if within is None and len(inner) == 1 and (len(value) == 1 or _is_page(value[inner[0]])):
            # {"status": 200, "response": {"rows": [...]}}: what is beside it is of the answer, and of no object.
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


def in_groups(value: Any, where: str) -> Iterator[Mapping[str, Any]]:
    """Yield the objects that groups list, such as rooms, each with the facts of the groups that it is in.

    Parameters
    ----------
    value : object
        Such as `{"rooms": [{"name": "Hall", "objects": [{"number": "1922.9"}]}]}`.
    where : str
        Names joined by points, `rooms.objects`; `*` is any name, and then a fact itself, by the name `KEY`.

    Yields
    ------
    mapping
        `{"rooms.name": "Hall", "number": "1922.9"}`; what is no object as it is.
    """
    yield from _in_groups(value, where.split("."), "", {})


def _in_groups(value: Any, names: list[str], path: str, facts: Mapping[str, Any]) -> Iterator[Any]:
    if isinstance(value, list):
        for one in value:
            yield from _in_groups(one, names, path, facts)
    elif not names:
        yield {**facts, **value} if isinstance(value, dict) else value
    elif isinstance(value, dict):
        name, *rest = names
        if name == ANY:
            for key, one in value.items():
                yield from _in_groups(one, rest, path, {**facts, KEY: key})
            return
        own = {f"{path or GROUP}.{key}": one for key, one in value.items() if isinstance(one, _SCALARS)}
        if name in value:
            yield from _in_groups(value[name], rest, f"{path}.{name}" if path else name, {**facts, **own})


def rows_of(values: Iterable[tuple[int, Any]]) -> Iterator[tuple[int, Any]]:
    """Yield the objects of lists of cells, of which the first has the names; what is no such list as it is.

    Parameters
    ----------
    values : iterable of (int, object)
        Such as `["number", "name"]` and `["1922.9", "Vase"]`, each with its line.
    """
    head: list[Any] | None = None
    for line, value in values:
        if head is None and isinstance(value, list):
            head = value
        elif head is None or not isinstance(value, list) or len(value) > len(head):
            yield line, value
        else:
            yield line, dict(zip(map(str, head), value, strict=False))


def is_head(value: Any) -> bool:
    """Say whether a value names the cells of the lists that follow it: several texts, none of them twice."""
    return (
        isinstance(value, list)
        and len(value) >= _COLUMNS
        and all(isinstance(one, str) and one.strip() for one in value)
        and len(set(value)) == len(value)
    )


def table_of(value: Any) -> list[dict[str, Any]] | None:
    """Return the objects of a table, of which a value has the names and the cells; None of any other value.

    Parameters
    ----------
    value : object
        Such as `{"columns": ["number", "name"], "data": [["1922.9", "Vase"]]}`, or `{"number": ["1922.9"], "name":
        ["Vase"]}`.
    """
    if not isinstance(value, dict):
        return None
    if len(value) >= _COLUMNS and (frame := _frame_of(value)) is not None:
        return frame
    if not all(isinstance(one, list) for one in value.values()):
        tables = [one for one in value.values() if isinstance(one, list) and one and is_head(one[0])]
        others = [one for one in value.values() if not isinstance(one, _SCALARS)]
        return [one for _, one in rows_of(enumerate(tables[0]))] if len(tables) == len(others) == 1 else None
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


def _frame_of(value: Mapping[str, Any]) -> list[dict[str, Any]] | None:
    """Return the objects of columns that have a number for each of them: `{"name": {"0": "Vase"}, "room": {...}}`."""
    rows = next(iter(value.values()))
    if not isinstance(rows, dict) or len(rows) < _FEWEST or not all(map(str.isdecimal, rows)):
        return None
    if not all(isinstance(one, dict) and one.keys() == rows.keys() for one in value.values()):
        return None
    return [{name: cells[row] for name, cells in value.items()} for row in rows]


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


def _is_page(value: Mapping[str, Any]) -> bool:
    return any(name in _PAGES and _is_list_of_objects(one) for name, one in value.items())


def _is_list_of_objects(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)
