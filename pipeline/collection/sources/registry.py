"""The kinds of sources that there are: Kouros's own, and those that other packages offer as ``kouros.sources``."""

from __future__ import annotations

from pathlib import Path

from pipeline.collection.sources.adlib import Adlib
from pipeline.collection.sources.base import HEAD, FileSource, Source, SourceSettings
from pipeline.collection.sources.cards import Cards
from pipeline.collection.sources.database import Database
from pipeline.collection.sources.delimited import Csv, Fixed, Tsv
from pipeline.collection.sources.dumps import Dump
from pipeline.collection.sources.files import head_of
from pipeline.collection.sources.folders import files_in
from pipeline.collection.sources.json_objects import Json
from pipeline.collection.sources.lido import Lido
from pipeline.collection.sources.linked_art import LinkedArt
from pipeline.collection.sources.museumplus import MuseumPlus
from pipeline.collection.sources.tables import Tables
from pipeline.collection.sources.web_pages import WebPage
from pipeline.collection.sources.xlsx import Xlsx
from pipeline.collection.sources.xml_objects import Xml
from pipeline.collection.sources.xml_records import XML_FILES
from pipeline.collection.sources.yaml_objects import Yaml
from pipeline.errors import InputError
from pipeline.extensions import Registry


def _source(value: object) -> Source:
    """Return what an entry point names as a source.

    Raises
    ------
    InputError
        For what is none, or an incomplete one.
    """
    found = value() if isinstance(value, type) else value
    if not isinstance(found, Source):
        raise InputError("it is no pipeline.collection.sources.base.Source; make it a subclass of that, or an instance")
    for name in ("name", "title"):
        if not isinstance(getattr(found, name, None), str) or not getattr(found, name):
            raise InputError(f"it has no {name}; give it one, a text")
    settings = getattr(found, "Settings", None)
    if not (isinstance(settings, type) and issubclass(settings, SourceSettings)):
        raise InputError("its Settings are no subclass of pipeline.collection.sources.base.SourceSettings")
    return found


SOURCES: Registry[Source] = Registry(
    "kouros.sources",
    (
        Csv(),
        Tsv(),
        Fixed(),
        Cards(),
        Xlsx(),
        Lido(),
        Adlib(),
        MuseumPlus(),
        LinkedArt(),
        Database(),
        Tables(),
        Dump(),
        Json(),
        Yaml(),
        WebPage(),
        Xml(),
    ),
    _source,
)
"""All kinds of sources, in the order in which they are asked whether they recognise one."""


def source_named(name: str) -> Source | None:
    """Return a kind of source by what a mapping says as [source] format; None where there is none."""
    return next((source for source in SOURCES if source.name == name), None)


def recognised(where: str, head: bytes) -> Source | None:
    """Return the kind of source that something surely is, by its path and how it begins.

    Parameters
    ----------
    where : str
        Path of a file, or an address.
    head : bytes
        How the file begins; empty for an address.

    Returns
    -------
    Source or None
        None where none is sure.
    """
    found = next((source for source in SOURCES if source.recognises(where, head)), None)
    if found is None and not is_address(where) and Path(where).is_dir():
        # What a folder of XML is, its first file says.
        first = next(iter(files_in(Path(where), XML_FILES)), None)
        found = None if first is None else recognised(str(first), head_of(first, HEAD))
        return found if isinstance(found, FileSource) and found.folder else None
    return found


def is_address(where: str | Path) -> bool:
    """Whether a source is an address, such as that of a database, and not the path of a file."""
    return "://" in str(where)
