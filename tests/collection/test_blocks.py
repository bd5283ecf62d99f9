"""What is read again after a change is what a whole reading would have found, and only what changed is read."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest
from sqlalchemy import Engine

from pipeline.collection import blocks
from pipeline.collection.blocks import Block, Piece
from pipeline.collection.database import METADATA, open_database
from pipeline.collection.inventory import Difference, read_inventory, replace_inventory
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.collection.sources.opening import Opened
from pipeline.collection.sources.rows import Row
from pipeline.collection.suspicion import Evidence, suspicions
from pipeline.night.importing import bundled_collection, log_rows

CARNEGIE = load_mapping("carnegie")
Table = list[list[str]]


@pytest.fixture(scope="module")
def real() -> Table:
    """The header and 400 rows of Carnegie's own export; some of their records have problems."""
    with bundled_collection().open(encoding="utf-8", newline="") as stream:
        return list(csv.reader(stream))[:401]


def would(engine: Engine, reading: Reading) -> Difference:
    """What importing a reading would change."""
    return replace_inventory(engine, reading, shrink_limit=1.0, dry_run=True)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of sixteen rows or so."""
    monkeypatch.setattr(blocks, "_ENDS", 16)


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Engine]:
    made = open_database(f"sqlite:///{tmp_path / 'inventory.sqlite'}")
    METADATA.create_all(made)
    yield made
    made.dispose()


def write(path: Path, rows: Table) -> Path:
    with path.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream).writerows(rows)
    return path


def at_random(rows: Table, random: Random) -> int:
    return random.randrange(1, len(rows))


def change(rows: Table, random: Random) -> None:
    height = rows[0].index("item_height")
    rows[at_random(rows, random)][height] = random.choice(["7.25", "", "-3", "seven"])


def remove(rows: Table, random: Random) -> None:
    at = at_random(rows, random)
    del rows[at : at + random.choice([1, 1, 40])]


def insert(rows: Table, random: Random) -> None:
    row = list(rows[at_random(rows, random)])
    row[rows[0].index("accession_number")] = f"new {random.random()}"
    rows.insert(at_random(rows, random), row)


def give_twice(rows: Table, random: Random) -> None:
    """The same object again, before or after itself, with another title."""
    row = list(rows[at_random(rows, random)])
    row[rows[0].index("title")] = "The same once more"
    rows.insert(at_random(rows, random), row)


def move(rows: Table, random: Random) -> None:
    at = at_random(rows, random)
    taken = rows[at : at + 30]
    del rows[at : at + 30]
    to = at_random(rows, random)
    rows[to:to] = taken


def shift(rows: Table, random: Random) -> None:
    rows[at_random(rows, random)].append("a cell too many")


def lose_number(rows: Table, random: Random) -> None:
    rows[at_random(rows, random)][rows[0].index("accession_number")] = ""


CHANGES: tuple[Callable[[Table, Random], None], ...] = (change, remove, insert, give_twice, move, shift, lose_number)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("seed", range(3))
def test_a_partial_reading_finds_what_a_whole_one_finds(seed: int, real: Table, engine: Engine, tmp_path: Path) -> None:
    random = Random(seed)
    rows = [list(row) for row in real]
    path = write(tmp_path / "export.csv", rows)
    last = read_items(path, CARNEGIE)
    replace_inventory(engine, last, shrink_limit=1.0)
    saved = 0
    for _ in range(12):
        for _ in range(random.randrange(4)):
            random.choice(CHANGES)(rows, random)
        write(path, rows)
        whole = read_items(path, CARNEGIE)
        again = read_items(path, CARNEGIE, before=kept(last))
        assert again.unread is not None
        saved += again.unread.objects
        assert (again.rows, again.objects, again.rejected) == (whole.rows, whole.objects, whole.rejected)
        assert again.suspicions == whole.suspicions
        assert [block.numbers for block in again.blocks] == [block.numbers for block in whole.blocks]
        changes = would(engine, whole)
        assert (would(engine, again).counts, would(engine, again).changed) == (
            changes.counts,
            changes.changed,
        )
        assert set(log_rows(again, would(engine, again))) == set(log_rows(whole, changes))
        replace_inventory(engine, again, shrink_limit=1.0)
        assert read_inventory(engine) == sorted(whole.items, key=lambda item: item.object_number)
        last = again
    assert saved > 0.5 * 12 * 400


def kept(reading: Reading) -> list[Block]:
    """Return the blocks of a reading as the next night has them from their file."""
    return [Block.of_line(block.line()) for block in reading.blocks]


@pytest.mark.usefixtures("small")
def test_only_the_block_that_changed_is_read(real: Table, tmp_path: Path) -> None:
    path = write(tmp_path / "export.csv", real)
    last = read_items(path, CARNEGIE)
    changed = [list(row) for row in real]
    changed[200][changed[0].index("item_height")] = "7.25"
    again = read_items(write(path, changed), CARNEGIE, before=last.blocks)
    assert len(again.items) <= max(len(block.numbers) for block in last.blocks)
    assert again.unread is not None
    assert again.unread.objects == len(last.items) - len(again.items)
    assert again.unread.gone == {item.object_number for item in again.items}


@pytest.mark.usefixtures("small")
def test_other_columns_are_another_file(real: Table, tmp_path: Path) -> None:
    """Two columns that change their names: every cell is the same, and none means what it did."""
    path = write(tmp_path / "export.csv", real)
    last = read_items(path, CARNEGIE)
    header = list(real[0])
    height, width = header.index("item_height"), header.index("item_width")
    header[height], header[width] = header[width], header[height]
    again = read_items(write(path, [header, *real[1:]]), CARNEGIE, before=last.blocks)
    assert again.unread is not None
    assert again.unread.objects == 0
    assert again.items == read_items(path, CARNEGIE).items != last.items


def cut(rows: list[Row], header: list[str]) -> list[Piece]:
    return list(blocks.cut(Opened("a source", iter(rows), str), header, (), lambda _: False))


def test_where_cells_end_counts() -> None:
    def digest(*cells: str) -> str:
        (piece,) = cut([Row(1, 2, list(cells))], ["a", "b"])
        return piece.digest

    assert digest("x\0y", "z") != digest("x", "y\0z")
    assert digest("x", "y") == digest("x", "y")
    assert digest("\ud800", "y") != digest("", "y")


def test_a_block_is_bounded_whatever_its_rows_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows that are all the same end a block at all, or at none, by their digest."""
    row = next(Row(n, n, [str(n)]) for n in range(999) if len(cut([Row(1, 1, [str(n)])] * 9, ["a"])) == 1)
    sizes = [len(piece.rows) for piece in cut([row] * 5_000, ["a"])]
    assert sum(sizes) == 5_000
    assert max(sizes) == blocks.MOST
    monkeypatch.setattr(blocks, "_CHARACTERS", 10_000)
    assert max(len(piece.rows) for piece in cut([Row(1, 1, ["x" * 1_000])] * 100, ["a"])) <= 10


@pytest.mark.parametrize(
    "line",
    [
        "[]",
        "{}",
        '["",[],[[0,1,"a","b","c","d"]],[[],[]],[0,0,""]]',
        '["",["a"],[],[[["cm"]],[]],[0,0,""]]',
        '["",["a"],[],[[],[]],[-1,0,""]]',
        "[",
    ],
)
def test_a_damaged_line_is_no_block(line: str) -> None:
    with pytest.raises((ValueError, TypeError)):
        Block.of_line(line)


def test_evidence_of_parts_adds_up(real: Table, tmp_path: Path) -> None:
    items = read_items(write(tmp_path / "export.csv", real), CARNEGIE).items
    whole, parts = Evidence.of(items), Evidence.of(items[:150])
    parts.add(Evidence.of_plain(Evidence.of(items[150:]).plain()))
    assert parts == whole
    assert whole.steps["in"][1] > 100
    assert suspicions(parts) == suspicions(whole) == ()
