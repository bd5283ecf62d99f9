"""The records of an Adlib XML file (Axiell Collections, Adlib Museum), grouped or unstructured, as rows.

Grouped, each repeated group is an element of its own (``<Dimension><dimension.type>``); unstructured, the n-th
``dimension.type`` goes with the n-th ``dimension.value``. Texts may stand in ``<value lang="...">`` or, where a field
links to another record, in an element of its own within. Names of fields: the export formats of Axiell's own API
documentation (``wwwopac.ashx``, xmltype grouped and unstructured) and of its standard model application.

| column | where it comes from |
|---|---|
| object_number, record_id | object_number; priref |
| title, object_name | title; object_name |
| classification | object_category, else classification, else collection |
| medium | material and technique |
| gallery | current_location.context, .name, current_location, or location |
| dimensions | dimension.free and its like |
| height, ... other_measurements | dimension.part, .type, .value, .unit (`measurements.Measurements`) |
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import BufferedReader
from itertools import zip_longest
from typing import Any, BinaryIO, ClassVar, Literal

from pydantic import Field

from pipeline.collection.sources.base import HEAD, FileSource, Name, Request, SourceSettings
from pipeline.collection.sources.measurements import COLUMNS, MeasuredSettings, Measurements, joined, row_of
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.xml_records import XML_FILES, XmlRecords

_LANG = "{http://www.w3.org/XML/1998/namespace}lang"
_FIELDS: dict[str, tuple[str, ...]] = {
    "object_number": ("object_number", "objectnumber", "object.object_number"),
    "title": ("title",),
    "object_name": ("object_name", "object.object_name"),
    "classification": ("object_category", "classification.scheme", "collection"),
    "gallery": (
        *("current_location.context", "current_location.name", "current_location", "location.context"),
        *("location.name", "location"),
    ),
    "dimensions": ("dimension.free", "dimension_free", "dimension.summary", "dimensions"),
}
_MEDIUM = ("material", "technique")
_MEASURED = ("dimension.part", "dimension.type", "dimension.value", "dimension.unit")


def read_adlib(stream: BinaryIO, file: str, *, language: str | None = None, unit: str | None = None) -> Iterator[Row]:
    """Yield the header and then every record as a row, with the line where it begins.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : str
        Its name in messages.
    language : str or None
        Which to prefer where a field has several, such as "nl".
    unit : str or None
        The unit of lengths that name none.

    Yields
    ------
    Row
        First the header.

    Raises
    ------
    CollectionError
        For a file that is damaged, no Adlib XML, or declares a document type.
    """
    yield Row(0, 1, list(COLUMNS))
    found = XmlRecords(
        file,
        tag="record",
        what="record",
        none="holds no <record>, its root is {root}; export it as Adlib XML, grouped or unstructured",
    )
    for number, record in enumerate(found.read(stream), start=1):
        fields = _fields(record, language)
        cells = {
            column: next((text for name in names for text in fields.get(name, ()) if text), "")
            for column, names in _FIELDS.items()
        }
        cells["record_id"] = str(record.get("priref") or next(iter(fields.get("priref", ())), ""))
        cells["medium"] = joined(text for name in _MEDIUM for text in fields.get(name, ()))
        yield row_of(number, record.sourceline, cells, _measured(record, language, unit))


def _fields(record: Any, language: str | None) -> dict[str, list[str]]:
    """Return the texts of a record by the names of their fields, in their order."""
    out: dict[str, list[str]] = {}
    for element in record.iter():
        if isinstance(element.tag, str) and element is not record:
            text = _text(element, language)
            if text:
                out.setdefault(element.tag.casefold(), []).append(text)
    return out


def _text(element: Any, language: str | None) -> str:
    """Return an element's own text, or that of the value within it that is in the language."""
    own = " ".join((element.text or "").split())
    if own or not len(element):
        return own
    values = [child for child in element if child.tag == "value"]
    if values:
        wanted = (language or "").casefold()
        # Without a wish the first one counts, but not the bare code that stands for a word of a list.
        values.sort(key=lambda v: (not wanted or not _language(v).startswith(wanted), _language(v) == "neutral"))
        return " ".join((values[0].text or "").split())
    if len(element) == 1 or element[0].tag in ("term", "name"):
        return " ".join((element[0].text or "").split())
    return ""


def _language(value: Any) -> str:
    return str(value.get("lang") or value.get(_LANG) or "").casefold()


def _measured(record: Any, language: str | None, unit: str | None) -> Measurements:
    out = Measurements(unit)
    groups = [e for e in record.iter() if isinstance(e.tag, str) and _names_within(e)]
    for group in groups:
        columns = [[_text(e, language) for e in group.findall(name)] for name in _names_within(group)]
        for part, kind, value, of in _side_by_side(columns):
            out.add(kind, value, of, part)
    return out


def _names_within(group: Any) -> tuple[str, ...]:
    """Return the names of what a group of measurements has: dimension.value, or value alone; () for no group."""
    if group.find(_MEASURED[2]) is not None:
        return _MEASURED
    short = tuple(name.removeprefix("dimension.") for name in _MEASURED)
    within = group.tag.casefold() == "dimension" and all(group.find(name) is not None for name in short[1:3])
    return short if within else ()


def _side_by_side(columns: Sequence[list[str]]) -> Iterator[tuple[str, str, str, str]]:
    """Yield the n-th of each; a part or a unit that is given once holds for all."""
    part, kind, value, unit = columns
    many = len(value)
    columns = [column * many if len(column) == 1 < many else column for column in (part, kind, value, unit)]
    for row in zip_longest(*columns, fillvalue=""):
        yield row[0], row[1], row[2], row[3]


class AdlibSettings(MeasuredSettings):
    """How an Adlib XML file is read."""

    format: Literal["adlib"] = Field(description="The kind of source.")
    language: Name | None = Field(default=None, description='The language to prefer, such as "en" or "nl".')


class Adlib(FileSource):
    """An export of Axiell Collections or Adlib Museum."""

    name = "adlib"
    title = "an Adlib XML file"
    Settings: ClassVar[type[SourceSettings]] = AdlibSettings
    folder = XML_FILES

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether its root, or a record with its number, is named at its beginning."""
        start = head[:HEAD].replace(b"\x00", b"")  # as UTF-16 it has a nought beside each letter
        return b"<adlibXML" in start or (b"<record" in start and b"priref" in start)

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the records.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.
        """
        return read_adlib(binary, file, language=request.settings.language, unit=request.settings.unit)
