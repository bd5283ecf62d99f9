"""Objects as XML of any program's own: an element each, whatever the elements are called.

Which element is an object is found by itself (`record_path`), or said by [source] records.  What stands within it
becomes columns as names within names of JSON do (`nested`):

- an element is named by its tag, or, where that says nothing (`<field name="Title">`, `<atom name="irn">`,
  `<str name="title">`), by what its attribute says;
- an element with a text is that text, its attributes columns beside it (`title@lang`), but a unit, which goes behind
  its number; one that says a kind of measurement and a number is a measurement;
- what the elements around an object say of themselves, such as the room of all that follow, is said of each.

The grammar of FileMaker (FMPXMLRESULT), which names its columns once, is read with these names.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from io import BufferedReader
from typing import Any, BinaryIO, ClassVar, Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Request, SourceSettings
from pipeline.collection.sources.folders import Folder, line_of
from pipeline.collection.sources.measurement_terms import unit_of
from pipeline.collection.sources.measurements import NUMBER, MeasuredSettings
from pipeline.collection.sources.nested import is_measurement, object_rows
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.xml_records import (
    EXPORT_AGAIN,
    XML_FILES,
    XmlRecords,
    forget,
    local_name,
    refusing,
    safely_parsed,
)

LOOKED_AT = 200_000
"""Elements from which it is told which of them are the objects."""

MOST_PATHS = 5_000
"""Different places of elements in a file of one museum's objects."""

COVERED = 0.5
"""Share of all that a file says which its objects say, at least."""

PASSED_ON = 0.85
"""Share of what an element says which the elements within it say, from which on it is a group of objects, and none."""

FEWEST_SAID = 3
"""Things that an object says of itself: its number, what it is, and one more."""

_HEAD = re.compile(
    r"\ufeff?(?:\s|<\?.*?\?>|<!--.*?-->|<!DOCTYPE\s+(?!html)[^>\[]*(?:\[.*?\]\s*)?>)*<([\w.-]+:)?([\w.-]+)", re.DOTALL
)
_NO_DATA = frozenset(("html", "svg", "rss", "feed", "Workbook", "office", "document-content"))
"""Roots of pages, drawings, news and workbooks."""

# Elements of these tags are called something by an attribute.
_UNTOLD = frozenset(
    (
        *("field", "atom", "tuple", "table", "column", "col", "cell", "property", "prop", "attribute", "attr", "data"),
        *("value", "entry", "item", "element", "node", "param", "variable", "var", "feld", "champ", "campo", "veld"),
        *("str", "int", "long", "float", "double", "date", "bool", "arr", "lst"),
    )
)
_NAMED_BY = ("name", "fieldname", "field", "column", "key", "label")
_NAME_LENGTH = 100
_OF_THE_EXPORT = frozenset({
    *("numfound", "start", "found", "count", "total", "rows", "size", "limit", "offset", "page", "pages", "version"),
    *("maxscore", "generated", "schema"),
})  # fmt: skip
"""What an element around objects says of the export, and of no object."""

_SCHEMA = "{http://www.w3.org/2001/XMLSchema}"
_INSTANCE = "{http://www.w3.org/2001/XMLSchema-instance}"
_FILEMAKER = "FMPXMLRESULT"

Path = tuple[str, ...]

Files = Callable[[], Iterable[tuple[str, BinaryIO]]]
"""Gives the names of files, and the files, as often as it is asked."""


class XmlSettings(MeasuredSettings):
    """How XML of a program's own is read."""

    format: Literal["xml"] = Field(description="The kind of source.")
    records: str = Field(
        default="",
        description="Which elements are the objects: names from the root on, joined by slashes, such as table/tuple; "
        '"" where they are to be found.',
    )


class Xml(FileSource):
    """An XML file of objects that is no format of its own."""

    name = "xml"
    title = "an XML file"
    Settings: ClassVar[type[SourceSettings]] = XmlSettings
    folder = XML_FILES

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether it begins as XML does that may hold objects: no web page, no drawing, no workbook."""
        begins = _HEAD.match(_decoded(head))
        return begins is not None and not {begins[2], begins[2].casefold()} & _NO_DATA

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the objects.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.

        Raises
        ------
        CollectionError
            For a file that is damaged, declares a document type, or holds no objects.
        """

        def files() -> Iterator[tuple[str, BinaryIO]]:
            binary.seek(0)
            yield file, binary

        return _rows(files, file, request.settings)

    def rows_of(self, folder: Folder, request: Request) -> Iterator[Row]:
        """Yield the header and the objects of all files of a folder.

        Parameters
        ----------
        folder, request : Folder, Request
            As of `FileSource.rows_of`.

        Yields
        ------
        Row
            First the header.
        """
        return _rows(folder.each, folder.path.name, request.settings)


def _rows(files: Files, name: str, settings: XmlSettings) -> Iterator[Row]:
    path = tuple(filter(None, settings.records.split("/"))) or record_path(files, name)[0]
    remedy = "say in the mapping which elements are the objects, [source] records, or export fewer fields"

    def objects() -> Iterator[tuple[int, Mapping[str, Any]]]:
        for file, binary in files():
            for line, one in _objects(binary, file, path):
                yield line_of(file, line), one

    return object_rows(objects, name, settings.unit, remedy)


def record_path(files: Files, name: str) -> tuple[Path, list[str]]:
    """Return which elements of files are the objects: those that come again and again and say nearly all of it.

    Parameters
    ----------
    files : callable
        Gives their names and the files, each at its beginning.
    name : str
        What they are called together, in messages.

    Returns
    -------
    path : tuple of str
        Names of the elements from the root to an object.
    others : list of str
        Paths of other elements that come again and again beside them, joined by slashes.

    Raises
    ------
    CollectionError
        For a file that is damaged, declares a document type, or in which none is found.
    """
    found = _Tally()
    for file, binary in files():
        _tally(found, binary, file)
        if found.enough:
            break
    path = (_FILEMAKER, "RESULTSET", "ROW") if found.root == _FILEMAKER else _likeliest(found, name)
    others = [
        one
        for one in found.several()
        if one[: len(path)] != path and path[: len(one)] != one and one[:1] != (_FILEMAKER,)
    ]
    outer = [one for one in others if not any(one[: len(o)] == o for o in others if o != one)]
    return path, ["/".join(one) for one in outer]


def _likeliest(found: _Tally, file: str) -> Path:
    """Return where the objects of a file are, by what is known of its elements."""
    whole = sum(said for path, said in found.said.items() if len(path) == 1)
    able = [path for path in found.several() if found.said[path] >= COVERED * whole]
    best = min(able, key=lambda path: (len(path), -found.said[path]), default=None)
    if best is not None and found.said[best] >= PASSED_ON * whole:
        return _innermost(best, found)
    # One object alone has several sizes, say, but says more different things than one of these does.
    single = [
        path
        for path, count in found.count.items()
        if count == found.files and len(found.names[path]) >= FEWEST_SAID and found.said[path] >= COVERED * whole
    ]
    alone = max(single, key=lambda path: (len(found.names[path]), -len(path)), default=None)
    if best is not None and (alone is None or len(found.names[best]) >= len(found.names[alone])):
        return _innermost(best, found)
    if alone is None:
        raise CollectionError(
            f"{file}: no element is there that could be an object, its root is {found.root[:100]}; say in the mapping "
            "which elements are the objects, [source] records, such as collection/object, or export CSV or Excel"
        )
    return alone


class _Tally:
    """What is known of the elements of a file by their places.

    files, seen : how many there are, and how many elements of them were looked at
    root : name of the first element of the last;  count : how many there are
    said : texts and attributes within them;  names : of what is right within them
    """

    def __init__(self) -> None:
        self.files = self.seen = 0
        self.root = ""
        self.count: Counter[Path] = Counter()
        self.said: Counter[Path] = Counter()
        self.names: defaultdict[Path, set[str]] = defaultdict(set)

    def take(self, path: Path, element: Any) -> None:
        self.count[path] += 1
        naming = _naming(element)
        mine = [name for name in element.attrib if name != naming and not name.startswith(_INSTANCE)]
        leaf = len(element) == 0 and bool((element.text or "").strip())
        said = len(mine) + leaf
        self.names[path].update(mine)
        self.names[path[:-1]].add(_called(element))
        for depth in range(1, len(path) + 1) if said else ():
            self.said[path[:depth]] += said

    @property
    def enough(self) -> bool:
        return self.seen >= LOOKED_AT or len(self.count) > MOST_PATHS

    def several(self) -> list[Path]:
        """Return the places of which there are several elements, each of which says more than one thing."""
        # The outermost element of a file is an object where each file has one.
        least = 1 if self.files > 1 else 2
        return [
            path for path, count in self.count.items() if count > 1 and len(path) >= least and len(self.names[path]) > 1
        ]


def _tally(found: _Tally, binary: BinaryIO, file: str) -> None:
    path = list[str]()
    found.files += 1
    for event, element in refusing(safely_parsed(binary), file, "record"):
        if event == "start":
            path.append(local_name(element))
            found.root = path[0]
            continue
        found.seen += 1
        if not str(element.tag).startswith(_SCHEMA):
            found.take(tuple(path), element)
        path.pop()
        # The last of each level stays, emptied, so that its parent is known to have had some.
        forget(element)
        if found.enough:
            break


def _innermost(path: Path, found: _Tally) -> Path:
    """Return the objects within groups of them, such as rooms: what says nearly all of a group, several of it each."""
    while True:
        within = [
            one
            for one, count in found.count.items()
            if len(one) == len(path) + 1
            and one[:-1] == path
            and count > found.count[path]
            and len(found.names[one]) > 1
            and found.said[one] >= PASSED_ON * found.said[path]
        ]
        if not within:
            return path
        path = within[0]


def _objects(binary: BinaryIO, file: str, path: Path) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the objects, with their lines, as names and values within each other."""
    shown = "/".join(path)
    found = XmlRecords(
        file,
        tag="{*}" + path[-1],
        what=f"element {shown}",
        none=f"holds no element {shown}, its root is {{root}}; say in the mapping which elements are the objects, "
        "[source] records",
        path=path,
    )
    around: list[tuple[Any, dict[str, Any]]] = []
    columns: list[str] | None = None
    for element in found.read(binary):
        if path[0] == _FILEMAKER:
            columns = columns or _filemaker_columns(element, file)
            yield element.sourceline, _filemaker_row(element, columns, file)
            continue
        above = [*element.iterancestors()][:-1][::-1]
        kept = {id(one): told for one, told in around}
        around = [(one, kept.get(id(one)) or _attributes(one)) for one in above]
        out: dict[str, Any] = {}
        for one, told in around:
            for child in one:
                if child is element or any(child is other for other in above):
                    break
                # An object that was given before is still there, emptied.
                if len(child) == 0 and child.tag != element.tag:
                    _put(told, _called(child), _value(child), child)
            out |= {
                f"{_called(one)}.{name}": value for name, value in told.items() if name.casefold() not in _OF_THE_EXPORT
            }
        value = _value(element)
        yield element.sourceline, out | (value if isinstance(value, dict) else {_called(element): value})


def _value(element: Any) -> Any:
    """Return the text of an element, or names and values of what it says."""
    children = [child for child in element if isinstance(child.tag, str)]
    # Line ends stay: a line of a text of dimensions may be a part of its own.
    text = "".join(element.itertext()).strip() if not children or _is_prose(element, children) else ""
    told = _attributes(element)
    if text or not (children or told):
        return _texted(text, told)
    listed = not told
    said = [(_called(child), _value(child), child) for child in children]
    sized = {name for name, value, _ in said if is_measurement(value)}
    for name, value, child in said:
        _put(told, name, _entry(value, child) if name in sized else value, child)
    # <arr name="materials"><str>wood</str><str>gold</str></arr>: a list, whose entries have no name.
    (only,) = told if listed and len(told) == 1 else ("",)
    return told[only] if only.casefold() in _UNTOLD else told


def _texted(text: str, told: dict[str, Any]) -> Any:
    """Return a text, with the unit of a number, or as an entry that tells a measurement."""
    entry = told | {"value": text}
    if told and is_measurement(entry):
        return entry
    if NUMBER.fullmatch(text):
        unit = next((one for one in told.values() if unit_of(one)), "")
        return f"{text} {unit}".strip()
    return text


def _entry(value: Any, element: Any) -> Any:
    """Return a number beside measurements of the same name as an entry like theirs, whatever kind it says."""
    attributes = _attributes(element)
    return (
        attributes | {"value": "".join(element.itertext()).strip()} if attributes and isinstance(value, str) else value
    )


def _put(into: dict[str, Any], name: str, value: Any, element: Any) -> None:
    """Add what an element says to what its parent says, and beside a text what its attributes say."""
    _add(into, name, value)
    if isinstance(value, str) and value:
        for attribute, said in _attributes(element).items():
            if said != name and not value.endswith(f" {said}"):
                _add(into, f"{name}@{attribute}", said)


def _add(into: dict[str, Any], name: str, value: Any) -> None:
    """Add a value by its name; measurements, and what comes twice, become a list."""
    if name in into:
        before = into[name] if isinstance(into[name], list) else [into[name]]
        into[name] = [*before, value]
    else:
        into[name] = [value] if is_measurement(value) else value


def _attributes(element: Any) -> dict[str, Any]:
    """Return what the attributes of an element say, but for one that names it and for remarks on the schema."""
    if not element.attrib:
        return {}
    naming = _naming(element)
    return {
        name.rpartition("}")[2]: " ".join(value.split())
        for name, value in element.attrib.items()
        if name != naming and not name.startswith(_INSTANCE) and value.strip()
    }


def _called(element: Any) -> str:
    naming = _naming(element)
    return local_name(element) if naming is None else " ".join(element.get(naming).split())


def _naming(element: Any) -> str | None:
    """Return the attribute that names an element; None where its tag does."""
    if not element.attrib:
        return None
    able = _able_to_name(local_name(element), tuple(element.attrib))
    return next((name for name in able if 0 < len(element.get(name).strip()) <= _NAME_LENGTH), None)


@lru_cache(maxsize=4096)
def _able_to_name(tag: str, attributes: tuple[str, ...]) -> tuple[str, ...]:
    if tag.casefold() not in _UNTOLD:
        return ()
    return tuple(name for wanted in _NAMED_BY for name in attributes if name.casefold() == wanted)


def _is_prose(element: Any, children: list[Any]) -> bool:
    """Whether it is a text with marks in it, such as <i>: text stands beside what is marked."""
    return any((text or "").strip() for text in (element.text, *(child.tail for child in children)))


def _filemaker_columns(row: Any, file: str) -> list[str]:
    named = [one.get("NAME", "") for one in row.getroottree().getroot().iter("{*}FIELD")]
    if not named:
        raise CollectionError(
            f"{file}: its METADATA names no FIELD; export it from FileMaker again, or as CSV or Excel"
        )
    return named


def _filemaker_row(row: Any, columns: list[str], file: str) -> dict[str, Any]:
    cells = [child for child in row if local_name(child) == "COL"]
    if len(cells) != len(columns):
        raise CollectionError(
            f"{file}, line {row.sourceline}: {len(cells)} values where METADATA names {len(columns)} fields; "
            f"{EXPORT_AGAIN}"
        )
    return {name: [(one.text or "").strip() for one in cell] for name, cell in zip(columns, cells, strict=True)}


def _decoded(head: bytes) -> str:
    for mark, encoding in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"", "utf-8")):
        if head.startswith(mark):
            return head.decode(encoding, "ignore")
    return ""
