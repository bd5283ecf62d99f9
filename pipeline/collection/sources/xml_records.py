"""Records of an XML file, one by one: no entities, nothing fetched, and no more in memory than one record."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.delimited import RECORD_LIMIT

XML_FILES = ("*.xml", "*.XML")
"""What counts in a folder."""

EXPORT_AGAIN = "export the file again, and see whether it was cut off on its way"
"""What mends a file that ends too early."""


class _Bounded:
    """A stream that ends in an error where RECORD_LIMIT bytes go by without a whole record: the tree stays small."""

    def __init__(self, stream: BinaryIO, file: str, what: str) -> None:
        self._stream = stream
        self._file = file
        self._what = what
        self.since_record = 0

    def read(self, size: int = -1) -> bytes:
        block = self._stream.read(size)
        self.since_record += len(block)
        if self.since_record > RECORD_LIMIT:
            raise CollectionError(
                f"{self._file}: {RECORD_LIMIT:,} bytes without a whole {self._what}; see whether this is the right file"
            )
        return block


@dataclass(frozen=True)
class XmlRecords:
    """How the records of a kind of XML file are found.

    Attributes
    ----------
    file : str
        Its name in messages.
    tag : str
        Of a record.
    what : str
        A record in words.
    none : str
        What is said of a file without any; it may name {root}.
    also : str
        Tag of another element that is given in its place, such as a mark that more would follow.
    path : tuple of str
        Names of the elements from the root to a record, without namespaces; (): a record is every element of the tag.
    """

    file: str
    tag: str
    what: str
    none: str
    also: str = ""
    path: tuple[str, ...] = ()

    def read(self, stream: BinaryIO) -> Iterator[Any]:
        """Yield the elements; each is forgotten when the next one is asked for.

        Parameters
        ----------
        stream : binary stream
            The file, at its beginning.

        Yields
        ------
        lxml element
            Of ``tag`` or ``also``.

        Raises
        ------
        CollectionError
            For a file that is damaged, incomplete, without a record, or declares a document type.
        """
        bounded = _Bounded(stream, self.file, self.what)
        events = safely_parsed(bounded, [tag for tag in (self.tag, self.also) if tag])
        seen = 0

        def reached() -> str:
            return f" after {seen} records"

        for event, element in refusing(events, self.file, self.what, reached):
            if event == "start":
                continue
            if self.also and element.tag == self.also:
                yield element
                continue
            if self.path:
                if path_of(element) != self.path:
                    continue
            elif any(above.tag == element.tag for above in element.iterancestors()):
                raise CollectionError(
                    f"{self.file}, line {element.sourceline}: a record within a record; {EXPORT_AGAIN}"
                )
            seen += 1
            yield element
            bounded.since_record = 0
            forget(element)
        if not seen:
            root = events.root.tag if events.root is not None else "nothing"
            raise CollectionError(f"{self.file}: {self.none.format(root=root[:100])}")


def safely_parsed(stream: Any, tags: Sequence[str] | None = None) -> Any:
    """Return the events of an XML file: no entities, nothing fetched.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    tags : sequence of str or None
        Of the elements that count; None: all.

    Returns
    -------
    lxml.etree.iterparse
        Of starts and ends.
    """
    from lxml import etree

    return etree.iterparse(
        stream,
        events=("start", "end"),
        tag=tags,
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )


def refusing(events: Any, file: str, what: str, reached: Callable[[], str] = lambda: "") -> Iterator[tuple[str, Any]]:
    """Yield the events of an XML file, and say of what cannot be read or would be dangerous what it is.

    Parameters
    ----------
    events : lxml.etree.iterparse
        Of starts and ends, as `safely_parsed` gives them.
    file, what : str
        Its name and what it holds, in messages.
    reached : callable
        Says how far the reading came.

    Yields
    ------
    (str, lxml element)
        "start" or "end", and whose.

    Raises
    ------
    CollectionError
        For a file that is damaged or incomplete, or declares a document type that is more than a list of elements.
    """
    from lxml import etree

    declared = None
    while True:
        try:
            event, element = next(events)
        except StopIteration:
            return
        except etree.XMLSyntaxError as problem:
            raise CollectionError(
                f"{file}, line {problem.lineno or 1}: not well-formed XML{reached()}: {str(problem)[:200]}; "
                f"{EXPORT_AGAIN}"
            ) from problem
        except OSError as problem:
            raise CollectionError(
                f"{file}: reading stopped{reached()}: {problem.strerror or problem}; see whether the disk or the "
                "network share is there and import again"
            ) from problem
        if declared is None and event == "start":
            declared = element.getroottree().docinfo
            if declared.doctype and not _is_list_of_elements(declared):
                raise CollectionError(
                    f"{file}: declares a document type or entities, which a {what} never needs and can hide harm; "
                    "remove the line that begins with <!DOCTYPE"
                )
        yield event, element


def _is_list_of_elements(declared: Any) -> bool:
    """Whether a document type names its elements and their attributes alone, as EMu's exports do: nothing to fetch."""
    within = declared.internalDTD
    return not (
        declared.public_id
        or declared.system_url
        or within is None
        or next(within.iterentities(), None) is not None
        or next(within.iterelements(), None) is None
    )


def local_name(element: Any) -> str:
    """Return the name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]


def path_of(element: Any) -> tuple[str, ...]:
    """Return the names of the elements from the root to one, without namespaces."""
    return (*(local_name(above) for above in reversed([*element.iterancestors()])), local_name(element))


def forget(element: Any) -> None:
    """Empty an element that ended, and take away all that stands before it and before those around it."""
    element.clear()
    for place in (element, *element.iterancestors()):
        while (before := place.getprevious()) is not None:
            before.getparent().remove(before)
