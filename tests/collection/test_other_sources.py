"""A kind of source that another package brings is imported and looked at every night like Kouros's own."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from pipeline.collection.errors import CollectionError, MappingError
from pipeline.collection.mapping import load_mapping
from pipeline.collection.opening import open_source
from pipeline.collection.sources.base import Source
from pipeline.collection.sources.registry import SOURCES, _source
from pipeline.errors import InputError
from tests.museum import in_common
from tests.warm import kouros_process

PLUGIN = '''
"""Records as JSON lines: one object of JSON a line, the keys of the first are the columns."""

import json
from collections.abc import Iterator
from io import BufferedReader
from typing import Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Request, SourceSettings
from pipeline.collection.sources.rows import Row, as_text


class JsonLinesSettings(SourceSettings):
    format: Literal["jsonl"]
    below: str = Field(default="", description="The key below which the record stands.")


class JsonLines(FileSource):
    name = "jsonl"
    title = "a file of JSON lines"
    Settings = JsonLinesSettings

    def recognises(self, where: str, head: bytes) -> bool:
        return where.endswith(".jsonl") and head.startswith(b"{")

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        names: list[str] = []
        for number, line in enumerate(binary, start=1):
            try:
                record = json.loads(line)
            except ValueError as problem:
                raise CollectionError(f"{file}, line {number}: not JSON: {problem}; export it again") from problem
            record = record[request.settings.below] if request.settings.below else record
            if not names:
                names = list(record)
                yield Row(0, number, names)
            yield Row(number, number, [as_text(record.get(name)) for name in names])
'''

MAPPING = """
[source]
format = "jsonl"
below = "object"
[museum]
name = "M"
[columns]
object_number.column = "nr"
gallery.column = "room"
object_name.column = "what"
height_m = { column = "h", unit = "cm" }
width_m = { column = "w", unit = "cm" }
depth_m = { column = "w", unit = "cm" }
"""

SETTINGS = """
[museum]
name = "M"
[collection]
source = "objects.jsonl"
mapping = "mapping.toml"
[site]
folder = "demo"
[report]
survey = false
[analysis]
fragility = false
workers = 1
"""

LINE = '{{"object": {{"nr": "{number}", "room": "Hall", "what": "vase", "h": {height}, "w": 9.5}}}}\n'


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A folder as pip leaves it: a module, and the metadata of its distribution."""
    site = tmp_path / "site"
    info = site / "kouros_jsonl-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "kouros_jsonl.py").write_text(PLUGIN, encoding="utf-8")
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: kouros-jsonl\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text("[kouros.sources]\njsonl = kouros_jsonl:JsonLines\n", encoding="utf-8")
    return site


def kouros(outside: Path, folder: Path, *words: str) -> str:
    paths = os.pathsep.join([str(outside), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = kouros_process(words, folder, os.environ | {"PYTHONPATH": paths})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.long("report/test_further_pages::test_a_page_of_another_package_is_in_the_report_and_in_its_navigation")
def test_a_source_of_another_package_is_imported_and_a_night_is_run_with_it(outside: Path, tmp_path: Path) -> None:
    museum = tmp_path / "museum"
    museum.mkdir()
    in_common(museum)
    (museum / "mapping.toml").write_text(MAPPING, encoding="utf-8")
    (museum / "kouros.toml").write_text(SETTINGS, encoding="utf-8")
    export = museum / "objects.jsonl"
    export.write_text("".join(LINE.format(number=f"A.{n}", height=20 + n) for n in range(3)), encoding="utf-8")
    assert "3" in kouros(outside, museum, "import", "objects.jsonl", "--mapping", "mapping.toml")
    with export.open("a", encoding="utf-8") as stream:
        stream.write(LINE.format(number="A.new", height=30))
    kouros(outside, museum, "run")
    found = (museum / "reports" / "latest" / "findings.csv").read_text(encoding="utf-8")
    assert {*(f"A.{n}" for n in range(3)), "A.new"} <= {cell for line in found.splitlines() for cell in line.split(",")}
    # Of its row alone anything was read: the import log of the night names no other.
    (log,) = (museum / "imports").glob("00002-*.csv")
    assert [line.split(",")[2] for line in log.read_text(encoding="utf-8").splitlines()[1:]] == ["A.new"]


def test_without_the_package_its_mapping_says_what_there_is(tmp_path: Path) -> None:
    (tmp_path / "mapping.toml").write_text(MAPPING, encoding="utf-8")
    with pytest.raises(
        MappingError,
        match=r"source: there is no format 'jsonl'.*Known are csv, tsv, .*, sql, tables, dump, json, yaml, html, xml",
    ):
        load_mapping(tmp_path / "mapping.toml")


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (object(), "it is no .*Source"),
        (type("Nameless", (Source,), {"recognises": None, "open": None}), "it has no name"),
        (type("Plain", (Source,), {"recognises": None, "open": None, "name": "p", "title": "a p"}), "its Settings"),
    ],
)
def test_what_is_no_source_is_told(value: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _source(value)


def test_each_kind_has_its_own_name_and_settings() -> None:
    assert [one.name for one in SOURCES.own] == [
        "csv",
        "tsv",
        "fixed",
        "cards",
        "xlsx",
        "lido",
        "adlib",
        "museumplus",
        "linked_art",
        "sql",
        "tables",
        "dump",
        "json",
        "yaml",
        "html",
        "xml",
    ]
    for one in SOURCES.own:
        assert one.Settings.model_fields["format"].annotation.__args__ == (one.name,)  # type: ignore[union-attr]


def test_a_file_that_is_surely_of_another_kind_is_refused_with_the_remedy(tmp_path: Path) -> None:
    path = tmp_path / "export.csv"
    path.write_text('<?xml version="1.0"?><lido:lidoWrap xmlns:lido="http://www.lido-schema.org"/>', encoding="utf-8")
    with (
        pytest.raises(CollectionError, match=r'a LIDO file, and the mapping carnegie reads csv; say format = "lido"'),
        open_source(path, load_mapping("carnegie")),
    ):
        pass
