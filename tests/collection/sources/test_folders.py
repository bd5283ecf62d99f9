"""A folder with a file for each object is one source."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.collection.sources.folders import Folder, files_in

from .lido_files import record, wrap


def test_lido_is_read_as_from_one_file(tmp_path: Path) -> None:
    made = [record(number=str(at), title="Büste", place="Saal 3", sizes="") for at in range(3)]
    (tmp_path / "all.xml").write_bytes(wrap(*made))
    folder = tmp_path / "harvest"
    folder.mkdir()
    for at, single in enumerate(made):
        (folder / f"{at}.xml").write_bytes(wrap(single))
    told = [read_items(path, load_mapping("lido")).items for path in (tmp_path / "all.xml", folder)]
    assert [item.object_number for item in told[0]] == ["0", "1", "2"]
    assert told[0] == told[1]


def test_only_files_that_count_are_read_in_the_order_of_their_names(tmp_path: Path) -> None:
    for name in ("b.xml", "a.xml", "notes.txt", ".hidden.xml", "deep/c.xml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name, encoding="utf-8")
    assert [file.name for file in files_in(tmp_path, ("*.xml",))] == ["a.xml", "b.xml"]
    assert [file.name for file in files_in(tmp_path, ("*.xml",), deep=True)] == ["a.xml", "b.xml", "c.xml"]
    before = _digest(tmp_path)
    (tmp_path / "b.xml").write_text("other", encoding="utf-8")
    assert _digest(tmp_path) != before


def _digest(path: Path) -> str:
    folder = Folder(path, ("*.xml",), 1000)
    assert all(binary.read() for _, binary in folder.each())
    return folder.digest()


def test_folders_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    with pytest.raises(CollectionError, match=r"a folder without \*.xml"):
        Folder(tmp_path, ("*.xml",), 1000)
    (tmp_path / "a.xml").write_text("x" * 2000, encoding="utf-8")
    with pytest.raises(CollectionError, match="2,000 bytes, more than 1,000"):
        Folder(tmp_path, ("*.xml",), 1000)
