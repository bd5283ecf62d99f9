"""Blocks whose bytes are as they were are passed over, and what is found is what a whole reading finds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

import pytest

from pipeline.collection import blocks
from pipeline.collection.blocks import Block
from pipeline.collection.mapping import Mapping, load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.collection.sources import delimited
from pipeline.collection.sources.rows import Row

MAPPING = """
[source]
format = "csv"
encoding = "{encoding}"
delimiter = ";"
[museum]
name = "M"
[columns]
object_number.column = "nr"
title.column = "title"
gallery.column = "room"
height_m = {{ column = "h", unit = "m" }}
"""
HEADER = "nr;title;room;h"


def mapping(folder: Path, encoding: str = "utf-8") -> Mapping:
    path = folder / "mapping.toml"
    path.write_text(MAPPING.format(encoding=encoding), encoding="utf-8")
    return load_mapping(path)


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of some eight rows, of which not many are read ahead."""
    monkeypatch.setattr(blocks, "_ENDS", 8)
    monkeypatch.setattr(delimited, "_ROWS", 20)


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The numbers of all rows that were taken apart into cells."""
    numbers: list[int] = []
    true = Row.__new__

    def noted(kind: type[Row], number: int, *given: object) -> Row:
        numbers.append(number)
        return true(kind, number, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(Row, "__new__", noted)
    return numbers


def row(at: int, random: Random) -> str:
    title = random.choice(
        ["Vase", "Krug aus Köln", '"a title\nof two lines"', '"said ""so"""', '"a;b"', "", "Ïß", "dish\x00", "\r\r"]
        if at % 9 == 0
        else ["Vase", "Dish"]
    )
    return f"A.{at};{title};Room {at % 3};{random.choice(['0.5', '1.25', '-2', 'tall'])}"


def export(random: Random, count: int = 300) -> list[str]:
    ends = random.choice(["\n", "\r\n", "\r"])
    rows = [row(at, random) + ends for at in range(count)]
    for _ in range(5):
        rows.insert(random.randrange(count), ends)
    return [HEADER + ends, *rows]


def kept(reading: Reading) -> list[Block]:
    return [Block.of_line(block.line()) for block in reading.blocks]


def told(reading: Reading) -> object:
    """All that a reading says of every row, but for what it says of the objects that it did not read."""
    return reading.rows, reading.objects, reading.rejected, reading.suspicions, [b.numbers for b in reading.blocks]


def problems(whole: Reading, again: Reading) -> tuple[set[object], set[object]]:
    def of(reading: Reading) -> set[object]:
        return {
            (*place, item.object_number, p.field, p.message, p.remedy)
            for item, place in zip(reading.items, reading.places, strict=True)
            for p in item.problems
        }

    assert again.unread is not None
    return of(whole), of(again) | set(again.unread.noted)


def flip(content: bytearray, random: Random) -> None:
    content[random.randrange(len(HEADER) + 2, len(content))] = random.choice(b'";\n\r\x00\xff\xc3a7')


def cut_out(content: bytearray, random: Random) -> None:
    at = random.randrange(len(HEADER) + 2, len(content))
    del content[at : at + random.choice([1, 2, 30, 900])]


def put_in(content: bytearray, random: Random) -> None:
    at = random.randrange(len(HEADER) + 2, len(content))
    content[at:at] = random.choice([b'"', b"\n", b"\r\n", b"\nB.1;new;Room 1;1\n", b"x" * 700, b";", b"\n" * 9])


def end(content: bytearray, random: Random) -> None:
    """The end: cut in its last row, or gone on with."""
    if random.random() < 0.5:
        del content[-random.randrange(1, 9) :]
    else:
        content += random.choice([b"7", b"\nC.1;at the end;Room 1;1", b"C.2;then;Room 2;2\n", b'"'])


EDITS: Sequence[Callable[[bytearray, Random], None]] = (flip, cut_out, put_in, end)


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "ascii"])
@pytest.mark.parametrize("seed", range(6))
def test_whatever_happens_to_the_bytes(encoding: str, seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    content = bytearray("".join(export(random)).encode(encoding, "replace"))
    if encoding == "utf-8" and seed % 2:
        content[:0] = b"\xef\xbb\xbf"
    mine, path = mapping(tmp_path, encoding), tmp_path / "export.csv"
    path.write_bytes(content)
    last = read_items(path, mine)
    saved = 0
    for _ in range(25):
        for _ in range(random.randrange(3)):
            random.choice(EDITS)(content, random)
        path.write_bytes(content)
        whole, again = read_items(path, mine), read_items(path, mine, before=kept(last))
        assert told(again) == told(whole)
        assert again.sha256 == whole.sha256
        assert again.unread is not None
        saved += again.unread.objects
        read = {item.object_number: item for item in whole.items}
        assert all(read[item.object_number] == item for item in again.items)
        found, same = problems(whole, again)
        assert same == found
        last = again
    assert saved > 25 * 100


def test_only_what_is_not_the_same_bytes_is_taken_apart(tmp_path: Path, parsed: list[int]) -> None:
    mine, path = mapping(tmp_path), tmp_path / "export.csv"
    lines = [f"A.{at};Vase;Room;0.5\n" for at in range(2_000)]
    path.write_text("".join([HEADER + "\n", *lines]), encoding="utf-8")
    last = read_items(path, mine)
    assert len(set(parsed)) == 2_001
    parsed.clear()
    lines[1_000] = "A.1000;Vase;Room;0.75\n"
    path.write_text("".join([HEADER + "\n", *lines]), encoding="utf-8")
    again = read_items(path, mine, before=kept(last))
    assert again.rows == 2_000
    assert "A.1000" in {item.object_number for item in again.items}
    # The header with what is read ahead, the block with what is read ahead, and the last block.
    assert len(set(parsed)) < 120
    assert 1_001 in parsed


def test_the_same_bytes_below_another_header_are_other_rows(tmp_path: Path) -> None:
    mine, path = mapping(tmp_path), tmp_path / "export.csv"
    rows = "".join(f"A.{at};Vase {at};Room {at};0.5\n" for at in range(100))
    path.write_text(f"{HEADER}\n{rows}", encoding="utf-8")
    last = read_items(path, mine)
    path.write_text(f"nr;room;title;h\n{rows}", encoding="utf-8")
    again = read_items(path, mine, before=kept(last))
    assert again.unread is not None
    assert again.unread.objects == 0
    assert {item.gallery for item in again.items} == {f"Vase {at}" for at in range(100)}


def test_a_number_given_twice_is_refused_though_its_bytes_are_known(tmp_path: Path) -> None:
    mine, path = mapping(tmp_path), tmp_path / "export.csv"
    rows = [f"A.{at};Vase;Room;0.5\n" for at in range(100)]
    path.write_text("".join([HEADER + "\n", *rows]), encoding="utf-8")
    last = read_items(path, mine)
    rows.insert(0, "A.70;Another;Room;0.5\n")
    path.write_text("".join([HEADER + "\n", *rows]), encoding="utf-8")
    whole, again = read_items(path, mine), read_items(path, mine, before=kept(last))
    assert [out.row for out in again.rejected] == [72]
    assert told(again) == told(whole)


def test_utf_16_is_read_row_by_row(tmp_path: Path) -> None:
    """Its bytes do not say where a row begins; the cells of its blocks tell all the same."""
    mine, path = mapping(tmp_path, "utf-16"), tmp_path / "export.csv"
    rows = [f"A.{at};Krug aus Köln;Room;0.5\n" for at in range(100)]
    path.write_text("".join([HEADER + "\n", *rows]), encoding="utf-16")
    last = read_items(path, mine)
    assert all(block.span.size == 0 for block in last.blocks)
    again = read_items(path, mine, before=kept(last))
    assert again.unread is not None
    assert again.unread.objects == 100
