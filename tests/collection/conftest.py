"""Small files of a museum, written by hand, and the mapping that reads them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.collection.mapping import Mapping, load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.records import Item

MAPPING = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Test museum"
credit = "Nobody"
[columns]
object_number = { column = "number" }
gallery = { column = "location" }
title = { column = "title" }
height_m = { column = "height", unit = "in" }
mass_kg = { column = "mass", unit = "g", missing = [0.0, "unknown"] }
[display]
not_on_display = ["Store"]
"""

HEADER = "number,location,title,height,mass\n"

Write = Callable[..., Path]
Read = Callable[..., Reading]


def one(reading: Reading) -> Item:
    """Return the only object of a reading."""
    (item,) = reading.items
    return item


@pytest.fixture
def make_mapping(tmp_path: Path) -> Callable[[str], Mapping]:
    """Write a mapping's text to mapping.toml and load it."""

    def make(text: str) -> Mapping:
        path = tmp_path / "mapping.toml"
        path.write_text(text, encoding="utf-8")
        return load_mapping(path)

    return make


@pytest.fixture
def read(tmp_path: Path, make_mapping: Callable[[str], Mapping]) -> Read:
    """Write the bytes or the text of a museum's file to museum.csv and read it by a mapping's text."""

    def go(content: str | bytes, mapping: str = MAPPING) -> Reading:
        path = tmp_path / "museum.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        reading = read_items(path, make_mapping(mapping))
        assert reading.rows == len(reading.items) + len(reading.rejected)
        return reading

    return go
