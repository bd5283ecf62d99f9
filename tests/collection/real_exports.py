"""Rows of three museums' real exports, damage included (tests/data/collections/README.md)."""

from pathlib import Path

from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items

DATA = Path(__file__).resolve().parents[1] / "data" / "collections"
FILES = {"met_27_rows_cp1252": "met", "tms_rows_cut_off": "tms", "moma_rows": "moma"}
"""The preset that reads each."""


def read(name: str) -> Reading:
    """Read one of `FILES` through its preset."""
    return read_items(DATA / f"{name}.csv", load_mapping(FILES[name]))
