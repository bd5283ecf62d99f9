"""Which of the lists within a file of JSON is that of the objects, where its name does not say it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pipeline.collection.guessing.name_words import ELSEWHERE
from pipeline.collection.guessing.names import named, plain
from pipeline.collection.sources.json_shapes import ANY, at_path, is_head, is_keyed, list_in, table_of
from pipeline.collection.sources.nested import flat, measurements_in
from pipeline.collection.sources.pairs import pairs_in

_SEEN = 20
"""Entries of a list from which it is told what they are."""
_DEEPEST = 6
MOST_NAMED = 0.2
"""Share of the names before objects that may be those of fields (judgement)."""

_MOST = 2000
"""Values that are looked through."""
_FEWEST = 3
"""Fields that entries must name where they name no number of their own (judgement)."""


def objects_in(found: Sequence[Any], chosen: str | None, sure: list[str]) -> dict[str, Any]:
    """Return where the first values of a file list objects, and how these stand there, as [source] says it.

    Parameters
    ----------
    found : sequence of object
        The values.
    chosen : str or None
        Where a person says that they are listed.
    sure : list of str
        What the file says by itself; grows.

    Returns
    -------
    dict
    """
    if found and is_head(found[0]) and all(isinstance(one, list) for one in found):
        sure.append("the first list of cells names the columns")
        return {"layout": "rows"}
    where = list_in(found[0] if found else None, alone=len(found) < 2) if chosen is None else chosen
    held: Any = at_path(found[0], where) if len(found) == 1 else {}
    if chosen is None and not is_keyed(held) and table_of(held) is None:
        other = better_list(found, held if isinstance(held, list) else found)
        if other is not None:
            where = other[0]
            if not where:
                return {}
            sure.append(f"objects are listed as {where!r}{', in groups whose facts they have too' * other[1]}")
            return {"records": where} | ({"layout": "grouped"} if other[1] else {})
    if where:
        sure.append(f"objects are listed as {where!r}")
    source: dict[str, Any] = {"records": where} if where else {}
    # Names of fields are no numbers of objects: {"height": {"value": 12, "unit": "cm"}, "width": ...}.
    if is_keyed(held) and sum(named(key) is not None for key in held) < MOST_NAMED * len(held):
        sure.append(f"each object stands behind its number, such as {next(iter(held))[:80]!r}")
        source["layout"] = "keyed"
    elif table_of(held) is not None:
        sure.append("the names of the columns and their cells stand in lists")
        source["layout"] = "columns"
    return source


def better_list(values: Sequence[Any], taken: Sequence[Any]) -> tuple[str, bool] | None:
    """Return where objects are listed rather than where they are looked for, and whether in groups, as in rooms.

    The entries that name the most fields are the objects, those with numbers of their own above all; what an object has
    several of, pictures or parts, is none.

    Parameters
    ----------
    values : sequence of object
        The first of the file.
    taken : sequence of object
        What would be taken for the objects.

    Returns
    -------
    (str, bool) or None
        None where those that would be taken have numbers of their own, or nothing else looks more like objects.
    """
    now = _likeness([one for one in taken if isinstance(one, dict)])
    if now[0]:
        return None
    whole = [one for one in values if isinstance(one, dict)]
    found: dict[str, tuple[bool, list[dict[str, Any]]]] = {"": (False, whole)} if whole else {}
    budget = [_MOST]
    for value in values:
        for path, grouped, entries in _lists(value, "", len(values) > 1, budget):
            before = found.get(path, (False, []))
            found[path] = (before[0] or grouped, [*before[1], *entries][:_SEEN])
    able = {path: _likeness(entries) for path, (_, entries) in found.items()}
    best = max(able, key=lambda path: able[path], default=None)
    if best is None or able[best] <= now or not (able[best][0] or able[best][1] >= max(_FEWEST, now[1] + 1)):
        return None
    return best, found[best][0]


def _lists(
    value: Any, path: str, grouped: bool, budget: list[int], depth: int = 0
) -> Iterator[tuple[str, bool, list[dict[str, Any]]]]:
    """Yield each list of entries within a value: where it is, whether there are several such, and its first entries."""
    budget[0] -= 1
    if depth > _DEEPEST or budget[0] < 0 or not isinstance(value, dict):
        return
    lists = {name: one for name, one in value.items() if _listed(one)}
    if len(lists) == len(value) > 1:
        # A list for each room: {"Hall": [...], "Store": [...]}.
        whole = [entry for one in lists.values() for entry in one[:_SEEN]]
        yield _under(path, ANY), True, whole
    for name, one in value.items():
        if not name or "." in name or name == ANY or ELSEWHERE.intersection(plain(name).split()):
            continue
        if name in lists:
            yield _under(path, name), grouped, one[:_SEEN]
            for entry in one[:_SEEN]:
                yield from _lists(entry, _under(path, name), True, budget, depth + 1)
        else:
            yield from _lists(one, _under(path, name), grouped, budget, depth + 1)
    inner = [one for one in value.values() if isinstance(one, dict)]
    if len(inner) == len(value) > 1:
        for one in inner[:_SEEN]:
            yield from _lists(one, _under(path, ANY), True, budget, depth + 1)


def _listed(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)


def _under(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _likeness(entries: Sequence[dict[str, Any]]) -> tuple[bool, int, int]:
    """Return whether entries name numbers of objects, how many fields they name, and how many entries there are."""
    said = [what for name in {name for one in entries[:_SEEN] for name in flat(_own(one))[0]} if (what := named(name))]
    own = any(what.field == "object_number" and not what.internal for what in said)
    return own, len({what.field for what in said}), min(len(entries), _SEEN)


def _own(entry: dict[str, Any]) -> dict[str, Any]:
    """Return what an entry says of itself: not what it lists, but for its sizes and its pairs of names and values."""
    return {
        name: one
        for name, one in entry.items()
        if not _listed(one) or measurements_in(one) is not None or pairs_in(one) is not None
    }
