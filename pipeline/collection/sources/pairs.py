"""Facts of an object that are told as pairs, each with the name of a field and its value, in a list of such."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

_NAMES = (
    *("name", "label", "key", "field", "fieldName", "field_name", "attribute", "attributeName", "property", "slug"),
    *("caption", "heading", "bezeichnung", "feld", "nom", "champ", "nome", "campo", "etichetta", "nombre"),
)
_VALUES = ("value", "values", "val", "content", "text", "data", "wert", "valeur", "valore", "valor")
_WITHIN = ("element", "term", "type", "definition")
"""Names of what has the name of the field within it."""
_LONGEST = 60
"""Characters of the name of a field."""
_FEWEST = 2
_LABELS = frozenset(("label", "key", "field", "fieldName", "field_name", "attribute", "attributeName", "property"))
"""Names of what can be nothing but the name of a field, where a value alone is beside it."""


def listed(value: Mapping[str, Any]) -> list[Any] | None:
    """Return the entries of what has numbers for names, `{"1": {...}, "2": {...}}`; None of anything else."""
    if value and all(key.isdecimal() and isinstance(one, dict) for key, one in value.items()):
        return list(value.values())
    return None


def pairs_in(entries: Sequence[Any]) -> list[tuple[str, Any]] | None:
    """Return name and value of each entry, where all entries are such pairs and no name comes twice.

    Labels with nothing but a value beside them are pairs in any case: "Dimensions" of the picture and of its frame.

    Parameters
    ----------
    entries : sequence of object
        Such as `[{"label": "Inv. no.", "value": "1922.9"}, {"label": "Room", "value": "Hall"}]`.

    Returns
    -------
    list of (str, object) or None
        None where they are anything else: what an object has several of, persons or titles.
    """
    if not entries or not all(isinstance(one, dict) for one in entries):
        return None
    labelled = all(len(one) == _FEWEST and not _LABELS.isdisjoint(one) for one in entries)
    if len(entries) < _FEWEST and not labelled:
        return None
    value = next((key for key in _VALUES if all(key in one for one in entries)), None)
    able = ([_said(_name(one.get(key))) for one in entries] for key in (*_NAMES, *_WITHIN))
    names = next(filter(all, able), [])
    if value is None or not names or (not labelled and len({name.casefold() for name in names}) < len(entries)):
        return None
    return [(name, _plain(one[value])) for name, one in zip(names, entries, strict=True)]


def _name(value: Any) -> Any:
    """Return the name that what stands for a field has: "Title" of `{"id": 50, "name": "Title"}`."""
    return next((value[key] for key in _NAMES if key in value), value) if isinstance(value, dict) else value


def _said(value: Any) -> str:
    """Return the name of a field; "" for what is none: a number, a sentence, several words in one language."""
    value = _plain(value)
    if not isinstance(value, str) or not 0 < len(value.strip()) <= _LONGEST or not any(map(str.isalpha, value)):
        return ""
    return value.strip()


def _plain(value: Any) -> Any:
    """Return what one language, or a list of one, says: "Title" of `{"en": ["Title"]}`."""
    while isinstance(value, dict | list) and len(value) == 1:
        one = next(iter(value.values() if isinstance(value, dict) else value))
        if not isinstance(one, dict | list | str):
            break
        value = one
    return value
