"""The objects of Linked Art records (JSON-LD, https://linked.art), of a file or of all files of a folder, as rows.

A file holds one record, an array, one record a line, or a page that lists them (orderedItems, items, @graph, member).
What is no HumanMadeObject (pictures, places, pages) is passed over. Names of earlier versions are read as well
(ManMadeObject, label, value). The model: https://linked.art/model/object/physical/ for dimensions and materials,
https://linked.art/model/base/ for names, numbers and statements.

| column | where it comes from |
|---|---|
| object_number | the identifier classed as accession number, else the first that is not internal; record_id: id |
| title | the preferred name, else the first, else _label |
| object_name, object_name_aat | classified_as whose own class is "type of work", else all but "artwork" |
| classification | classified_as, all |
| medium, medium_aat | the statement of materials, else the labels of made_of and of the technique |
| gallery, on_display | current_location, and whether it is classed as a gallery or a store |
| image, image_credit | representation, or the IIIF manifest of subject_of; the credit line |
| dimensions | the statements of dimensions |
| height, ... other_measurements | dimension: value or limits, unit, class, and the technique of its measuring |
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import HEAD, Request, SourceSettings
from pipeline.collection.sources.files import head_of
from pipeline.collection.sources.json_records import JsonSource, Values, files_of
from pipeline.collection.sources.measurement_terms import (
    KIND_CONCEPTS,
    UNIT_CONCEPTS,
    kind_of,
    part_of,
    plain_word,
)
from pipeline.collection.sources.measurements import COLUMNS, MeasuredSettings, Measurements, joined, row_of
from pipeline.collection.sources.rows import Row, as_text

_LOOKED_AT = 100
"""Files of a folder in one of which the model must be named."""

NARROW = 0.05
"""Relative width up to which the middle of two limits stands for the value."""

_OBJECTS = frozenset({"HumanMadeObject", "ManMadeObject"})
_PAGES = ("orderedItems", "items", "@graph", "member", "hydra:member", "data", "results")
_AAT = re.compile(r"(?:https?://vocab\.getty\.edu/(?:page/)?aat/|aat:)(300[0-9]{6})")

# Numbers of Getty's thesaurus, as the Linked Art model uses them.
_ACCESSION = "300312355"
_OF_A_DATABASE = "300404621"
_PREFERRED = "300404670"
_ALTERNATE = "300417227"
_TYPE_OF_WORK = "300435443"
_ARTWORK = "300133025"
_MATERIALS = frozenset({"300435429", "300010358", "300163343"})
_DIMENSIONS = frozenset({"300435430", "300266036"})
_CAPTION = "300191074"
_CREDITS = frozenset({"300026687", "300435418", "300435434"})
_GALLERY = "300240057"
_STORE = "300004465"


def read_linked_art(values: Iterator[tuple[int, Any]], file: str, *, unit: str | None = None) -> Iterator[Row]:
    """Yield the header and then every object as a row.

    Parameters
    ----------
    values : iterator of (int, object)
        Lines and JSON values.
    file : str
        The source's name in messages.
    unit : str or None
        The unit of lengths that name none.

    Yields
    ------
    Row
        First the header.

    Raises
    ------
    CollectionError
        For values among which is no object.
    """
    yield Row(0, 1, list(COLUMNS))
    number = 0
    for line, value in values:
        for record in _objects(value):
            number += 1
            cells, measured = _read(record, unit)
            yield row_of(number, line, cells, measured)
    if not number:
        raise CollectionError(
            f"{file}: holds no HumanMadeObject; export objects as Linked Art (JSON-LD), one record a line or a file"
        )


def _objects(value: Any) -> Iterator[dict[str, Any]]:
    if isinstance(value, list):
        for one in value:
            yield from _objects(one)
    elif isinstance(value, dict):
        kinds = value.get("type", value.get("@type"))
        if _OBJECTS & set(kinds if isinstance(kinds, list) else [kinds]):
            yield value
            return
        for key in _PAGES:
            if isinstance(value.get(key), list):
                yield from _objects(value[key])
        if isinstance(value.get("object"), dict):
            yield from _objects(value["object"])


def _read(record: dict[str, Any], unit: str | None) -> tuple[dict[str, str], Measurements]:
    names = [one for one in _all(record, "identified_by") if one.get("type") in ("Name", "Title")]
    numbers = [one for one in _all(record, "identified_by") if one.get("type") == "Identifier"]
    classes = _all(record, "classified_as")
    works = [c for c in classes if _TYPE_OF_WORK in _classes(c)] or [c for c in classes if _concept(c) != _ARTWORK]
    made_of = _all(record, "made_of")
    techniques = [t for made in _all(record, "produced_by") for t in _all(made, "technique")]
    stated = _statements(record, _MATERIALS, "material")
    on_display, gallery = _place(record)
    cells = {
        "object_number": _first(sorted(numbers, key=_rank_of_number)),
        "record_id": str(record.get("id") or record.get("@id") or ""),
        "title": _first(sorted(names, key=_rank_of_name)) or _label(record),
        "object_name": joined(map(_label, works)),
        "object_name_aat": joined(map(_concept, works)),
        "classification": joined(map(_label, classes)),
        "classification_aat": joined(map(_concept, classes)),
        "medium": stated or joined(map(_label, (*made_of, *techniques))),
        "medium_aat": joined(map(_concept, made_of)),
        "gallery": gallery,
        "on_display": on_display,
        "image": _image(record),
        "image_credit": _statements(record, _CREDITS, "credit line"),
        "dimensions": _statements(record, _DIMENSIONS, "dimension"),
    }
    measured = Measurements(unit)
    for one in _all(record, "dimension"):
        _measure(one, measured)
    return cells, measured


def _measure(one: dict[str, Any], measured: Measurements) -> None:
    classes = _all(one, "classified_as")
    labels = [_label(c) for c in classes]
    kind = next(filter(None, (KIND_CONCEPTS.get(_concept(c)) for c in classes)), None) or next(
        filter(None, map(kind_of, labels)), None
    )
    units = _all(one, "unit")
    unit = next((UNIT_CONCEPTS[_concept(u)] for u in units if _concept(u) in UNIT_CONCEPTS), "") or joined(
        map(_label, units)
    )
    techniques = [
        _label(t) for made in (*_all(one, "assigned_by"), *_all(one, "attributed_by")) for t in _all(made, "technique")
    ]
    part = _part([*techniques, *(label for label in labels if kind_of(label) is None), _label(one)])
    said = joined([*techniques, *labels])
    value, problem = _value(one)
    if value:
        measured.take(kind, value, unit, part, said)
    elif problem and kind is not None and part is not None:
        measured.refuse(f"{part} {kind}".strip(), problem, "give the value that was measured, beside the limits")


def _part(words: Sequence[str]) -> str | None:
    """Return the part that words name ("measuring the base", "framed height"); "" where they name none."""
    for text in words:
        for word in map(plain_word, re.split(r"[\s,;:()/]+", text)):
            named = {"framed": "frame", "plinth": "base"}.get(word) or part_of(word) if word else ""
            if named:
                return named
            if word in ("image", "sheet", "mount", "mat", "plate", "lid", "cover", "handle", "detail"):
                return None
    return ""


def _value(one: dict[str, Any]) -> tuple[str, str]:
    """Return the value as text, and why there is none."""
    value = _number(one.get("value"))
    if value:
        return value, ""
    keys = (("lower_value", "upper_value"), ("lower_value_limit", "upper_value_limit"), ("lower_limit", "upper_limit"))
    for lower, upper in keys:
        ends = [_number(one.get(lower)), _number(one.get(upper))]
        try:
            low, high = (float(end) for end in ends)
        except ValueError:
            continue
        if not (isfinite(low) and isfinite(high)) or high < low:
            continue
        middle = 0.5 * (low + high)
        if high - low <= NARROW * middle:
            return as_text(round(middle, 6)), ""
        return "", f"the record gives limits only, {ends[0]} to {ends[1]}"
    return "", ""


def _number(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return ""
    if isinstance(value, str):
        return value.strip()
    try:
        return as_text(value)
    except (TypeError, ValueError):
        return ""


def _place(record: dict[str, Any]) -> tuple[str, str]:
    """Return whether it is on display ("" where nothing says it), and where it is."""
    for place in _all(record, "current_location"):
        name = _label(place) or _first(one for one in _all(place, "identified_by"))
        if not name:
            continue
        concepts = {_concept(c) for c in _all(place, "classified_as")}
        flag = "true" if _GALLERY in concepts else "false" if _STORE in concepts else ""
        return flag, name
    return "", ""


def _image(record: dict[str, Any]) -> str:
    """Return the address of the first picture of an object, or else of its IIIF manifest; "" for none."""
    for shown in _all(record, "representation"):
        points = [p for d in _all(shown, "digitally_shown_by") for p in (*_all(d, "access_point"), d)]
        for one in (*points, shown):
            address = _web(one)
            if address and not address.endswith((".json", ".html")):
                return address
    for page in _all(record, "subject_of"):
        carried = [page, *_all(page, "digitally_carried_by")]
        for one in carried:
            if any("iiif.io/api/presentation" in str(said.get("id")) for said in _all(one, "conforms_to")):
                return next(filter(None, map(_web, (*_all(one, "access_point"), one))), "")
    return ""


def _web(one: dict[str, Any]) -> str:
    address = one.get("id", one.get("@id"))
    return address if isinstance(address, str) and address.startswith(("https://", "http://")) else ""


def _statements(record: dict[str, Any], concepts: frozenset[str], word: str) -> str:
    """Return the texts of a record that are classed as statements of something, captions of everything left out."""
    found = []
    for one in _all(record, "referred_to_by"):
        classes = _classes(one)
        labels = [label.casefold() for label in map(_label, _all(one, "classified_as"))]
        if _CAPTION not in classes and (concepts & classes or any(word in label for label in labels)):
            found.append(_content(one))
    return joined(found)


def _rank_of_number(one: dict[str, Any]) -> int:
    concepts = {_concept(c) for c in _all(one, "classified_as")}
    words = " ".join([_label(one), *map(_label, _all(one, "classified_as"))]).casefold()
    if _ACCESSION in concepts or "accession" in words or "inventory" in words:
        return 0
    internal = ("database", "internal", "local number", "slug", "system", "uuid", "repository number", " id")
    return 2 if _OF_A_DATABASE in concepts or any(word in words for word in internal) else 1


def _rank_of_name(one: dict[str, Any]) -> int:
    concepts = {_concept(c) for c in _all(one, "classified_as")}
    return 0 if _PREFERRED in concepts else 2 if _ALTERNATE in concepts else 1


def _all(record: dict[str, Any], key: str) -> list[dict[str, Any]]:
    """Return what stands under a key as a list of records; a bare address is one with nothing but its id."""
    found = record.get(key)
    found = found if isinstance(found, list) else [found]
    return [{"id": one} if isinstance(one, str) else one for one in found if isinstance(one, str | dict)]


def _content(one: dict[str, Any]) -> str:
    said = one.get("content", one.get("value"))
    return " ".join(str(said).split()) if isinstance(said, str | int | float) else ""


def _first(ones: Any) -> str:
    return next(filter(None, map(_content, ones)), "")


def _label(one: dict[str, Any]) -> str:
    said = one.get("_label", one.get("label"))
    if isinstance(said, list):
        said = next(iter(said), "")
    return " ".join(said.split()) if isinstance(said, str) else ""


def _concept(one: dict[str, Any]) -> str:
    addresses = [one.get("id"), one.get("@id"), *(match.get("id") for match in _all(one, "equivalent"))]
    for address in addresses:
        match = _AAT.match(address) if isinstance(address, str) else None
        if match:
            return match[1]
    return ""


def _classes(one: dict[str, Any]) -> set[str]:
    return {_concept(c) for c in _all(one, "classified_as")}


class LinkedArtSettings(MeasuredSettings):
    """How Linked Art records are read."""

    format: Literal["linked_art"] = Field(description="The kind of source.")


class LinkedArt(JsonSource):
    """A file of Linked Art records, or a folder of such files."""

    name = "linked_art"
    title = "a Linked Art file"
    Settings: ClassVar[type[SourceSettings]] = LinkedArtSettings

    def recognises(self, where: str, head: bytes) -> bool:
        """Say whether the model or its words are named at its beginning; of a folder, in one of its first files."""
        if _speaks(head[:HEAD]):
            return True
        path = Path(where)
        if "://" in where or not path.is_dir():
            return False
        # What cannot be read is told by who reads it.
        with suppress(OSError, CollectionError, zlib.error):
            return any(_speaks(head_of(file, HEAD)) for file in islice(files_of(path), _LOOKED_AT))
        return False

    def records(self, values: Values, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the objects.

        Parameters
        ----------
        values, file, request : callable, str, Request
            As of `JsonSource.records`.

        Yields
        ------
        Row
            First the header.
        """
        return read_linked_art(values(), file, unit=request.settings.unit)


def _speaks(head: bytes) -> bool:
    return any(word in head for word in (b"linked.art", b"HumanMadeObject", b"ManMadeObject"))
