"""A file that was packed by gzip is read as what it holds, whatever its name; bombs and damage are refused by name."""

from __future__ import annotations

import gzip
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.limits import STANDARD
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.night.importing import bundled_collection
from tests.collection.sources.lido_files import record, wrap
from tests.museum import carnegie


@pytest.mark.parametrize("name", ["export.csv.gz", "export.csv"])
def test_packed_rows_are_the_rows(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(gzip.compress(bundled_collection().read_bytes()))
    packed = read_items(tmp_path / name, load_mapping("carnegie"))
    plain = carnegie()
    assert (packed.items, packed.places, packed.rejected) == (plain.items, plain.places, plain.rejected)
    assert packed.source == name


@pytest.mark.long("test_packed_rows_are_the_rows")
def test_a_packed_file_is_recognised_and_guessed_from(tmp_path: Path) -> None:
    (tmp_path / "a.xml.gz").write_bytes(gzip.compress(wrap(record(number="L 1"))))
    assert guess(tmp_path / "a.xml.gz").mapping.source.format == "lido"
    with pytest.raises(CollectionError, match=r'a\.xml\.gz: a LIDO file.*format = "lido"'):
        read_items(tmp_path / "a.xml.gz", load_mapping("carnegie"))
    with bundled_collection().open("rb") as stream:
        (tmp_path / "c.csv.gz").write_bytes(gzip.compress(b"".join(islice(stream, 100))))
    assert guess(tmp_path / "c.csv.gz").mapping.columns["gallery"].column == "physical_location"


def _refused(folder: Path, content: bytes, most: int = STANDARD.bytes) -> str:
    (folder / "x.csv.gz").write_bytes(content)
    with pytest.raises(CollectionError) as caught:
        read_items(folder / "x.csv.gz", load_mapping("carnegie"), replace(STANDARD, bytes=most))
    return str(caught.value)


def test_what_is_cut_off_or_damaged_is_refused(tmp_path: Path) -> None:
    whole = gzip.compress(bundled_collection().read_bytes())
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 0xFF
    for content in (whole[: len(whole) // 2], bytes(damaged), whole[:-4] + b"\0\0\0\0", whole[:12]):
        assert "x.csv.gz: packed by gzip, and damaged or cut off" in _refused(tmp_path, content)
    (tmp_path / "x.csv.gz").write_bytes(whole[:3] + b"\xff" * 40)
    with pytest.raises(CollectionError, match="damaged"):
        guess(tmp_path / "x.csv.gz")


def test_a_bomb_is_refused_before_it_fills_the_disk(tmp_path: Path) -> None:
    """Zeros pack 1,000 to 1: 64 MB in 64 kB. More than the limit of bytes is refused however well it packs."""
    assert "as no table of objects does" in _refused(tmp_path, gzip.compress(bytes(64 << 20)))
    told = _refused(tmp_path, gzip.compress(bundled_collection().read_bytes()), 600_000)
    assert "unpacked more than 600,000 bytes" in told
    assert "[limits] megabytes" in told
