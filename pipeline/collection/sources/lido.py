"""The records of a LIDO file (1.0 and 1.1), the exchange format of museums, as rows with fixed columns.

| column | where it comes from |
|---|---|
| object_number | workID of the current repository, the inventory or accession number first; else lidoRecID |
| record_id | lidoRecID |
| title | the preferred title |
| object_name, object_name_aat | the terms of objectWorkType, and their numbers in Getty's thesaurus |
| classification, classification_aat | the same of classification (Europeana's media types left out) |
| medium | displayMaterialsTech, else the terms of termMaterialsTech: of the object, of its making, or of any event |
| medium_aat | the numbers of the materials; techniques left out |
| gallery | the name of the current repositoryLocation itself, not of what it is part of; else displayRepository |
| repository | the name of the current repository |
| image, image_credit | linkResource of the first picture in the order of the record, and its credit line or rights |
| dimensions | displayObjectMeasurements |
| height, ... weight | measurementsSet: value and unit as they were written |
| base height, frame height, ... | the same where extentMeasurements says that it is the base or the frame |
| other_measurements | all others as "part type: value unit": unknown types and parts, and second values |

Several values are joined by "; ", alternatives in other languages are not values of their own. Numbers of the thesaurus
are written as digits ("300047090"), whether the file has the number, "aat:300047090" or its address. Many museums give
the town as the location: then the gallery is that town, which only the museum can mend in its export.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from io import BufferedReader
from pathlib import Path
from typing import Any, BinaryIO, Literal
from unicodedata import normalize

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import HEAD, FileSource, Name, Request, SourceSettings
from pipeline.collection.sources.files import stream_of
from pipeline.collection.sources.lido_terms import FORMER, LANGUAGES, PRODUCTION
from pipeline.collection.sources.measurement_terms import KIND_CONCEPTS, KIND_OF, PART_OF, UNIT_CONCEPTS
from pipeline.collection.sources.measurements import MEASURED
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.xml_records import XML_FILES, XmlRecords

COLUMNS = (
    "object_number",
    "record_id",
    "title",
    "object_name",
    "object_name_aat",
    "classification",
    "classification_aat",
    "medium",
    "medium_aat",
    "gallery",
    "repository",
    "image",
    "image_credit",
    "dimensions",
    *MEASURED,
    "other_measurements",
)
"""The header."""

_LIDO = "{http://www.lido-schema.org}"
_SKOS = "{http://www.w3.org/2004/02/skos/core#}"
_RDF = "{http://www.w3.org/1999/02/22-rdf-syntax-ns#}"
_TOKEN = "{http://www.openarchives.org/OAI/2.0/}resumptionToken"  # noqa: S105  (the element's name)
_LANG = "{http://www.w3.org/XML/1998/namespace}lang"
_AAT = re.compile(r"(?:https?://vocab\.getty\.edu/(?:page/)?aat/|aat[:/])?(300[0-9]{6})(?:\.html)?/?", re.I)
_WIKIDATA = re.compile(r"https?://(?:www\.)?wikidata\.org/(?:entity|wiki)/(Q[0-9]+)/?", re.I)
_PICTURES = frozenset({"jpg", "jpeg", "png", "tif", "tiff", "gif", "webp", "jp2"})
_OWN_NUMBER = re.compile("inventor|inventar|inventaire|accession|lido00113", re.I)


def read_records(source: str | Path | BinaryIO, file: str, *, languages: Sequence[str] = ("en",)) -> Iterator[Row]:
    """Yield the header and then every lido:lido as a row, with the line where it begins.

    A record is forgotten once it is a row. Nothing outside of the file is ever fetched. A file that turns out to be
    damaged raises after the rows before the damage: take none of them for the collection.

    Parameters
    ----------
    source : str, Path or binary stream
        The file; records stand in a lidoWrap, an OAI-PMH answer or alone.
    file : str
        Its name in messages.
    languages : sequence of str
        Which to prefer where the file has several; then what has no language, then any other.

    Yields
    ------
    Row
        First the header (number 0, line 1).

    Raises
    ------
    CollectionError
        For a file that is missing, damaged, incomplete, not LIDO, or declares a document type.
    """
    with ExitStack() as stack:
        stream = stream_of(source, file, stack)
        yield Row(0, 1, list(COLUMNS))
        preferred = tuple(_language(code) for code in languages)
        for number, record in enumerate(_records(stream, file), start=1):
            cells = _Record(record, preferred).cells()
            yield Row(number, record.sourceline, [cells.get(column, "") for column in COLUMNS])


def _records(stream: BinaryIO, file: str) -> Iterator[Any]:
    found = XmlRecords(
        file,
        tag=f"{_LIDO}lido",
        what="LIDO record",
        none="holds no LIDO record (lido:lido of http://www.lido-schema.org), its root is {root}; export it as LIDO "
        "1.0 or 1.1",
        also=_TOKEN,
    )
    for element in found.read(stream):
        if element.tag == _TOKEN:
            if (element.text or "").strip():
                raise CollectionError(
                    f"{file}, line {element.sourceline}: one page of a harvest, more would follow; join all pages in "
                    "one file without resumptionToken"
                )
            continue
        yield element


class _Record:
    """One lido:lido."""

    def __init__(self, record: Any, languages: tuple[str, ...]) -> None:
        self._record = record
        self._languages = languages
        # A file may describe an object once in every language; measurements must come from one of them only.
        self._described = sorted(_all(record, "descriptiveMetadata"), key=self._rank)

    def cells(self) -> dict[str, str]:
        """Column -> text, of those that have any."""
        cells = {"record_id": next(_texts(_all(self._record, "lidoRecID")), "")}
        for described in self._described:
            found = self._describe(described)
            if any(column in cells for column in found if column in _MEASURED):
                found = {column: text for column, text in found.items() if column not in _MEASURED}
            cells = {**found, **cells}
        cells.setdefault("object_number", cells["record_id"])
        cells |= self._picture()
        return cells

    def _describe(self, described: Any) -> dict[str, str]:
        kept = "objectIdentificationWrap"
        places = self._repositories(described)
        names = "titleWrap/titleSet/appellationValue"
        cells = {
            "object_number": _first(map(_work_number, places)),
            "title": self._name(_all(described, f"{kept}/{names}")),
            "gallery": _first(map(self._place, places)),
            "repository": _first(self._name(_all(p, "repositoryName/legalBodyName/appellationValue")) for p in places),
        }
        for column, path in (("object_name", "objectWorkTypeWrap/objectWorkType"), ("classification", _CLASSES)):
            concepts = [c for c in _all(described, f"objectClassificationWrap/{path}") if "europeana" not in _type(c)]
            cells[column] = _join(map(self._term, concepts))
            cells[f"{column}_aat"] = _join(_thesaurus(concepts))
        cells["medium"], cells["medium_aat"] = self._medium(described)
        cells.update(self._measurements(_all(described, f"{kept}/objectMeasurementsWrap/objectMeasurementsSet")))
        return {column: text for column, text in cells.items() if text}

    def _picture(self) -> dict[str, str]:
        """The address of the first picture, a thumbnail only where there is nothing else, and who is credited."""
        ranked: list[tuple[bool, int, str, Any]] = []
        for each in _all(self._record, "administrativeMetadata/resourceWrap/resourceSet"):
            for shown in _all(each, "resourceRepresentation"):
                for link in _all(shown, "linkResource"):
                    kind = str(link.get(f"{_LIDO}formatResource") or link.get("formatResource") or "").casefold()
                    if _text(link) and (not kind or "image" in kind or kind.strip(".") in _PICTURES):
                        ranked.append(("thumb" in _type(shown), len(ranked), _text(link), each))
        if not ranked:
            return {}
        *_, address, each = min(ranked, key=lambda one: one[:2])
        rights = _all(each, "rightsResource")
        credit = self._pick(c for r in rights for c in _all(r, "creditLine")) or _join(
            self._term(one) for r in rights for one in _all(r, "rightsType")
        )
        return {"image": address} | ({"image_credit": credit} if credit else {})

    def _repositories(self, described: Any) -> list[Any]:
        """The repositorySets where the object is now: a current location, a current repository, one without a type."""
        ranked = []
        for place in _all(described, "objectIdentificationWrap/repositoryWrap/repositorySet"):
            kind = _type(place)
            if any(word in kind for word in FORMER):
                continue
            if "lido01018" in kind or "location" in kind:
                ranked.append((0, place))
            elif "lido00475" in kind or "current" in kind:
                ranked.append((1, place))
            elif not kind:
                ranked.append((2, place))
        return [place for _, place in sorted(ranked, key=lambda pair: pair[0])]

    def _place(self, repository: Any) -> str:
        name = self._name(_all(repository, "repositoryLocation/namePlaceSet/appellationValue"))
        return name or self._pick(_all(repository, "displayRepository"))

    def _medium(self, described: Any) -> tuple[str, str]:
        events = _all(described, "eventWrap/eventSet/event")
        made = [e for e in events if any(w in PRODUCTION for c in _all(e, "eventType") for w in _words(c))]
        object_sets = _all(described, "objectIdentificationWrap/objectMaterialsTechWrap/objectMaterialsTechSet")
        for sets in (
            object_sets,
            [s for e in made for s in _all(e, "eventMaterialsTech")],
            [s for e in events for s in _all(e, "eventMaterialsTech")],
        ):
            terms = [t for s in sets for t in _all(s, "materialsTech/termMaterialsTech")]
            text = _join(self._pick(_all(s, "displayMaterialsTech")) for s in sets) or _join(map(self._term, terms))
            numbers = _join(_thesaurus(t for t in terms if "techni" not in _type(t) and "lido00131" not in _type(t)))
            if text or numbers:
                return text, numbers
        return "", ""

    def _measurements(self, sets: Iterable[Any]) -> dict[str, str]:
        cells: dict[str, str] = {}
        shown: list[str] = []
        others: list[str] = []
        for each in sets:
            shown.append(self._pick(_all(each, "displayObjectMeasurements")))
            for measured in _all(each, "objectMeasurements"):
                extents = _all(measured, "extentMeasurements")
                part = _known(extents, PART_OF, {}) if extents else ""
                if part is None and _known(extents, KIND_OF, {}) is not None:
                    part = ""  # some programs repeat the type there
                for one in _all(measured, "measurementsSet"):
                    value = _first(_texts(_all(one, "measurementValue")))
                    if not value:
                        continue
                    text = f"{value} {self._unit(_all(one, 'measurementUnit'))}".strip()
                    types = _all(one, "measurementType")
                    kind = _known(types, KIND_OF, KIND_CONCEPTS)
                    column = f"{part} {kind}".strip()
                    if part is None or kind is None or column in cells:
                        said = f"{self._label(extents)} {self._label(types)}".strip()
                        others.append(f"{said}: {text}" if said else text)
                    else:
                        cells[column] = text
        # Where nobody wrote a text, what no column takes is read as one.
        cells["dimensions"] = _join(shown) or _join(others)
        cells["other_measurements"] = _join(others)
        return cells

    def _unit(self, units: list[Any]) -> str:
        return self._label(units) or _first(UNIT_CONCEPTS.get(concept, "") for u in units for concept in _concepts(u))

    # Words, in the language that is preferred.

    def _rank(self, element: Any) -> int:
        while element is not None and element.get(_LANG) is None:
            element = element.getparent()
        if element is None:
            return len(self._languages)
        code = _language(element.get(_LANG))
        return self._languages.index(code) if code in self._languages else len(self._languages) + 1

    def _pick(self, elements: Iterable[Any]) -> str:
        """The text of the element in the best language, the first of several."""
        return _first(_texts(sorted(elements, key=self._rank)))

    def _name(self, elements: Iterable[Any]) -> str:
        """The same of names, those that are marked as alternatives last."""
        return _first(_texts(sorted(elements, key=lambda e: (_preference(e), self._rank(e)))))

    def _term(self, concept: Any) -> str:
        """The term of a concept; a bare text counts as one."""
        added = f"{_LIDO}addedSearchTerm"
        terms = [t for t in _all(concept, "term") if t.get(added, t.get("addedSearchTerm")) != "yes"]
        labels = terms or concept.findall(f"{_SKOS}Concept/{_SKOS}prefLabel") or concept.findall(f"{_SKOS}prefLabel")
        return self._pick(labels) if labels or len(concept) else _text(concept)

    def _label(self, concepts: list[Any]) -> str:
        """The term of elements that are one concept, perhaps repeated for every language."""
        return _first(map(self._term, sorted(concepts, key=self._rank)))


_CLASSES = "classificationWrap/classification"
_MEASURED = frozenset(COLUMNS[COLUMNS.index("dimensions") :])


def _all(element: Any, path: str) -> list[Any]:
    return list(element.iterfind("/".join(_LIDO + step for step in path.split("/"))))


def _text(element: Any) -> str:
    return " ".join("".join(element.itertext()).split())


def _texts(elements: Iterable[Any]) -> Iterator[str]:
    return map(_text, elements)


def _first(texts: Iterable[str]) -> str:
    return next(filter(None, texts), "")


def _join(texts: Iterable[str]) -> str:
    """All of the texts, each once, in their order."""
    return "; ".join(dict.fromkeys(filter(None, texts)))


def _type(element: Any) -> str:
    return str(element.get(f"{_LIDO}type") or element.get("type") or "").casefold()


def _language(code: str) -> str:
    short = code.strip().casefold().replace("_", "-").partition("-")[0]
    return LANGUAGES.get(short, short)


def _preference(element: Any) -> bool:
    """False (first) for names that are preferred or say nothing, True for alternatives."""
    said = str(element.get(f"{_LIDO}pref") or element.get("pref") or "").casefold()
    return "altern" in said


def _work_number(repository: Any) -> str:
    numbers = _all(repository, "workID")
    return _first(_texts(sorted(numbers, key=lambda number: not _OWN_NUMBER.search(_type(number)))))


def _addresses(concept: Any) -> Iterator[str]:
    for identifier in _all(concept, "conceptID"):
        source = str(identifier.get(f"{_LIDO}source") or identifier.get("source") or "").casefold()
        text = _text(identifier)
        # A bare number belongs to the thesaurus that it names as its source; most leave that out.
        if not text.isdecimal() or not source or "aat" in source or "getty" in source or "art & arch" in source:
            yield text
    for found in concept.iter(f"{_SKOS}Concept"):
        yield str(found.get(f"{_RDF}about") or "")
    for match in (*concept.iter(f"{_SKOS}exactMatch"), *concept.iter(f"{_SKOS}closeMatch")):
        yield str(match.get(f"{_RDF}resource") or "")


def _concepts(concept: Any) -> Iterator[str]:
    """The numbers of a concept in Getty's thesaurus and in Wikidata."""
    for address in _addresses(concept):
        match = _AAT.fullmatch(address.strip()) or _WIKIDATA.fullmatch(address.strip())
        if match:
            yield match[1]


def _thesaurus(concepts: Iterable[Any]) -> Iterator[str]:
    return (number for concept in concepts for number in _concepts(concept) if number[0] != "Q")


def _words(concept: Any) -> list[str]:
    """Every term of a concept in every language, and the last parts of its addresses."""
    labels = [*concept.iter(f"{_LIDO}term"), *concept.iter(f"{_SKOS}prefLabel")] or [concept]
    words = [normalize("NFC", text).casefold().strip(" .:") for text in _texts(labels)]
    return words + [address.rstrip("/").rpartition("/")[2].casefold() for address in _addresses(concept)]


def _known(elements: Iterable[Any], words: dict[str, str], concepts: dict[str, str]) -> str | None:
    """What the first of the elements means whose concept or word is known."""
    for element in elements:
        for concept in _concepts(element):
            if concept in concepts:
                return concepts[concept]
        for word in _words(element):
            if word in words:
                return words[word]
    return None


class LidoSettings(SourceSettings):
    """How a LIDO file is read."""

    format: Literal["lido"] = Field(description="The kind of source.")
    language: Name | None = Field(default=None, description='The language to prefer, such as "en" or "de".')


class Lido(FileSource):
    """A file in the exchange format of museums."""

    name = "lido"
    title = "a LIDO file"
    Settings = LidoSettings
    folder = XML_FILES

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether the format's namespace is named at its beginning."""
        return b"lido-schema.org" in head[:HEAD]

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
        return read_records(binary, file, languages=(request.settings.language or "en",))
