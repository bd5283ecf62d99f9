"""What is read again after a change is what a whole reading would have found, and only what changed is read."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
from sqlalchemy import Engine, select

from pipeline.collection.database import METADATA, open_database
from pipeline.collection.inventory import Difference, read_inventory, replace_inventory
from pipeline.collection.inventory.reading_report import READING, _told, account, doubts
from pipeline.collection.inventory.source_rows import SOURCE_ROW, SourceKey, known_rows
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import KnownRow, Reading, read_items, row_digest
from pipeline.collection.unit_audit import Evidence, wrong_units
from pipeline.night.importing import bundled_collection, log_rows
from pipeline.records import ITEM_FIELDS

CARNEGIE = load_mapping("carnegie")
KEY = SourceKey("export.csv", "mapping", "code", "limits")
Table = list[list[str]]
SEEDS = int(os.environ.get("KOUROS_SEEDS", "1"))
NIGHTS = 10 if SEEDS > 1 else 6
"""Histories of that many nights each; `make soak` makes 24 of ten."""


class Export:
    """A museum's export on its way through random edits: its rows, and how they are written."""

    def __init__(self, rows: Table, random: Random) -> None:
        self.rows, self.random = [list(row) for row in rows], random
        self.ends, self.mark, self.quoting = "\r\n", False, csv.QUOTE_MINIMAL

    def write(self, path: Path) -> Path:
        text = io.StringIO(newline="")
        csv.writer(text, lineterminator=self.ends, quoting=self.quoting).writerows(self.rows)
        path.write_bytes(text.getvalue().encode("utf-8-sig" if self.mark else "utf-8"))
        return path

    def at(self) -> int:
        return self.random.randrange(1, len(self.rows))

    def column(self, name: str) -> int:
        return self.rows[0].index(name)


def change_cell(export: Export) -> None:
    row = export.rows[export.at()]
    row[export.column("item_height")] = export.random.choice(["7.25", "", "-3", "seven", "12.1"])


def remove(export: Export) -> None:
    at = export.at()
    del export.rows[at : at + export.random.choice([1, 1, 40])]


def add(export: Export) -> None:
    row = list(export.rows[export.at()])
    row[export.column("accession_number")] = f"new {export.random.random()}"
    export.rows.insert(export.at(), row)


def repeat(export: Export) -> None:
    """The very same row again, before or after itself."""
    export.rows.insert(export.at(), list(export.rows[export.at()]))


def give_number_twice(export: Export) -> None:
    """The same number for another object, before or after it."""
    row = list(export.rows[export.at()])
    row[export.column("title")] = "The same once more"
    export.rows.insert(export.at(), row)


def swap(export: Export) -> None:
    one, other = export.at(), export.at()
    export.rows[one], export.rows[other] = export.rows[other], export.rows[one]


def move(export: Export) -> None:
    at = export.at()
    taken = export.rows[at : at + 30]
    if len(taken) < len(export.rows) - 1:
        del export.rows[at : at + 30]
        to = export.at()
        export.rows[to:to] = taken


def reorder_columns(export: Export) -> None:
    order = export.random.sample(range(len(export.rows[0])), len(export.rows[0]))
    export.rows = [[row[at] for at in order] if len(row) == len(order) else row for row in export.rows]


def rename_columns(export: Export) -> None:
    """Two columns take each other's name: every cell is the same, and none means what it did."""
    header = export.rows[0]
    height, width = export.column("item_height"), export.column("item_width")
    header[height], header[width] = header[width], header[height]


def write_otherwise(export: Export) -> None:
    export.ends = export.random.choice(["\n", "\r\n", "\r"])
    export.mark = export.random.random() < 0.5
    export.quoting = export.random.choice([csv.QUOTE_MINIMAL, csv.QUOTE_ALL])


def leave_blank_lines(export: Export) -> None:
    export.rows.insert(export.at(), [])


def shift(export: Export) -> None:
    export.rows[export.at()].append("a cell too many")


def lose_number(export: Export) -> None:
    row = export.rows[export.at()]
    if row:
        row[export.column("accession_number")] = ""


EDITS: tuple[Callable[[Export], None], ...] = (
    *(change_cell, remove, add, repeat, give_number_twice, swap, move),
    *(reorder_columns, rename_columns, write_otherwise, leave_blank_lines, shift, lose_number),
)


def edit(export: Export) -> None:
    for _ in range(20):
        try:
            export.random.choice(EDITS)(export)
            return
        except IndexError:  # The row at hand is blank.
            continue


def inventory(folder: Path, name: str) -> Engine:
    made = open_database(folder / f"{name}.db")
    METADATA.create_all(made)
    return made


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Engine]:
    made = inventory(tmp_path, "museum")
    yield made
    made.dispose()


@pytest.fixture(scope="module")
def real() -> Table:
    """The header and 250 rows of Carnegie's own export; some of their records have problems."""
    with bundled_collection().open(encoding="utf-8", newline="") as stream:
        return list(csv.reader(stream))[:251]


def told(engine: Engine) -> dict[str, Any]:
    """What the newest version keeps of its reading, but for the number of the import, which counts the nights."""
    with engine.connect() as connection:
        version = connection.execute(select(READING.c.version).order_by(READING.c.version.desc())).scalars().first()
        found = _told(connection, version or 0)
    assert found is not None
    return {name: value for name, value in found.items() if name != "base"}


def noted(reading: Reading) -> list[tuple[object, ...]]:
    """Row, line and words of every problem."""
    before = [] if reading.unread is None else list(reading.unread.noted)
    now = [
        (row, line, item.object_number, one.field, one.message, one.remedy)
        for item, (row, line) in zip(reading.items, reading.places, strict=True)
        for one in item.problems
    ]
    return sorted([*before, *now])


def rows_of(engine: Engine) -> set[tuple[object, ...]]:
    with engine.connect() as connection:
        return {tuple(row) for row in connection.execute(select(SOURCE_ROW))}


@pytest.mark.long("night/test_incremental::test_a_night_that_finds_only_what_changed_equals_one_from_nothing")
@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_reading_of_what_changed_finds_what_one_from_nothing_finds(
    seed: int, real: Table, engine: Engine, tmp_path: Path
) -> None:
    export, path = Export(real, Random(seed)), tmp_path / "export.csv"
    saved = 0
    for night in range(NIGHTS):
        for _ in range(export.random.randrange(4) if night else 0):
            edit(export)
        export.write(path)
        whole = read_items(path, CARNEGIE)
        again = read_items(path, CARNEGIE, known=known_rows(engine, KEY))
        saved += 0 if again.unread is None else again.unread.objects
        assert (again.rows, again.objects, again.rejected) == (whole.rows, whole.objects, whole.rejected)
        assert (again.suspicions, again.flagged, again.sha256) == (whole.suspicions, whole.flagged, whole.sha256)
        assert again.choices == whole.choices
        assert noted(again) == noted(whole)
        changes = replace_inventory(engine, whole, shrink_limit=1.0, dry_run=True)
        found = replace_inventory(engine, again, shrink_limit=1.0, key=KEY)
        assert (found.counts, found.changed, found.removed) == (changes.counts, changes.changed, changes.removed)
        assert set(log_rows(again, found)) == set(log_rows(whole, changes))
        anew = inventory(tmp_path, f"anew{night}")
        replace_inventory(anew, whole, key=KEY)
        assert read_inventory(engine) == read_inventory(anew)
        assert told(engine) == told(anew)
        assert account(engine) == account(anew)
        assert rows_of(engine) == rows_of(anew)
        anew.dispose()
    assert saved > 0.2 * NIGHTS * len(real)


def test_only_the_row_that_changed_is_read(real: Table, engine: Engine, tmp_path: Path) -> None:
    export, path = Export(real, Random(1)), tmp_path / "export.csv"
    last = read_items(export.write(path), CARNEGIE)
    replace_inventory(engine, last, key=KEY)
    row = export.rows[200]
    row[export.column("item_height")] = "7.25"
    again = read_items(export.write(path), CARNEGIE, known=known_rows(engine, KEY))
    assert [item.object_number for item in again.items] == [row[export.column("accession_number")]]
    assert again.unread is not None
    assert again.unread.objects == len(last.items) - 1
    assert again.unread.numbers == {again.items[0].object_number}


def test_another_key_knows_nothing(real: Table, engine: Engine, tmp_path: Path) -> None:
    replace_inventory(engine, read_items(Export(real, Random(1)).write(tmp_path / "a.csv"), CARNEGIE), key=KEY)
    assert known_rows(engine, KEY)
    for name in ("source", "mapping", "code", "limits"):
        values = {"source": "export.csv", "mapping": "mapping", "code": "code", "limits": "limits"}
        assert known_rows(engine, SourceKey(**(values | {name: "other"}))) is None


def test_what_cannot_be_written_leaves_what_is_known_of_the_rows(real: Table, engine: Engine, tmp_path: Path) -> None:
    """Rows and inventory are one transaction: a reading that is refused changes neither."""
    path = tmp_path / "a.csv"
    replace_inventory(engine, read_items(Export(real, Random(1)).write(path), CARNEGIE), key=KEY)
    before = rows_of(engine)
    Export(real[:20], Random(1)).write(path)
    with pytest.raises(ValueError, match="usable objects"):
        replace_inventory(engine, read_items(path, CARNEGIE, known=known_rows(engine, KEY)), key=KEY)
    assert rows_of(engine) == before
    assert known_rows(engine, KEY)


def test_where_cells_end_counts() -> None:
    assert row_digest(b"h", ["x\0y", "z"]) != row_digest(b"h", ["x", "y\0z"])
    assert row_digest(b"h", ["x", "y"]) == row_digest(b"h", ["x", "y"]) != row_digest(b"i", ["x", "y"])
    assert row_digest(b"h", ["\ud800", "y"]) != row_digest(b"h", ["", "y"])
    assert row_digest(b"h", ["x", "", "y"]) != row_digest(b"h", ["x", "y", ""])


def test_evidence_of_rows_adds_up(real: Table, tmp_path: Path) -> None:
    items = read_items(Export(real, Random(1)).write(tmp_path / "export.csv"), CARNEGIE).items
    whole, halves = Evidence(), [Evidence(), Evidence()]
    for at, item in enumerate(items):
        one = Evidence.of({name: getattr(item, name) for name in ITEM_FIELDS}, item.provenance)
        one.ratios["height_m"], one.tallies["display"] = [1.0, 2.54], [1, at % 2]
        assert Evidence.of_plain(json.loads(json.dumps(one.plain()))) == one
        whole.add(one)
        halves[at >= len(items) // 2].add(one)
    parts = halves[0]
    parts.add(halves[1])
    twice = Evidence()
    twice.add(whole, 2)
    assert parts == whole
    assert whole.steps["in"][1] > 50
    assert twice.tallies["display"] == [2 * len(items), 2 * (len(items) // 2)]
    assert len(twice.ratios["height_m"]) == 4 * len(items)
    assert wrong_units(parts, {}) == wrong_units(whole, {}) == ()


def test_a_suspicion_is_found_from_rows_that_are_not_read_again(tmp_path: Path, engine: Engine) -> None:
    """A whole export in inches that says centimetres: the rows that say so were read last night."""
    rows = [["accession_number", "item_height"], *([f"N.{n}", f"{n % 9 + 1}.0625"] for n in range(60))]
    path = tmp_path / "mapping.toml"
    path.write_text(
        '[source]\nformat = "csv"\nencoding = "utf-8"\ndelimiter = ","\n[museum]\nname = "M"\n[columns]\n'
        'object_number.column = "accession_number"\ngallery.constant = "Hall"\n'
        'height_m = { column = "item_height", unit = "cm" }\n',
        encoding="utf-8",
    )
    mapping, export = load_mapping(path), Export(rows, Random(1))
    first = read_items(export.write(tmp_path / "a.csv"), mapping)
    assert len(first.suspicions) == 1
    replace_inventory(engine, first, key=KEY)
    export.rows.append(["N.new", "3"])
    again = read_items(export.write(tmp_path / "a.csv"), mapping, known=known_rows(engine, KEY))
    assert (len(again.items), again.suspicions) == (1, first.suspicions)
    replace_inventory(engine, again, key=KEY)
    assert [one.message for one in doubts(engine, 2)] == [first.suspicions[0].message]


def test_a_difference_of_nothing_is_none(real: Table, engine: Engine, tmp_path: Path) -> None:
    path = Export(real, Random(1)).write(tmp_path / "a.csv")
    replace_inventory(engine, read_items(path, CARNEGIE), key=KEY)
    known = known_rows(engine, KEY)
    assert known is not None
    assert all(isinstance(one, KnownRow) for one in known.values())
    count = len(known)
    found = replace_inventory(engine, read_items(path, CARNEGIE, known=known), key=KEY)
    assert found == Difference(count, count, (), (), {})
