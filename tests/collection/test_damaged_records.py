"""A record that changed in the database since it was written is never taken for the museum's: it is told and mended."""

from __future__ import annotations

import pickle
import sqlite3
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
from sqlalchemy import Engine, text
from sqlalchemy.exc import OperationalError

from pipeline.collection.database import METADATA, open_database
from pipeline.collection.inventory import (
    DamagedRecord,
    DamagedRecordError,
    items_named,
    latest_import,
    read_inventory,
    repair,
    replace_inventory,
    return_to,
    verify_inventory,
)
from pipeline.collection.inventory.reading_report import doubts
from pipeline.collection.inventory.records import LostRecordsError
from pipeline.collection.inventory.source_rows import SourceKey, known_rows
from pipeline.collection.object_index import object_index, read_packed
from pipeline.collection.reading import Reading
from pipeline.records import Item, Origin, Problem, Provenance, Support
from tests.museum import carnegie

OTHERS = ("object_number", "since", "until", "assessment_digest")
KEY = SourceKey("a.csv", "mapping", "code", "limits")
VASE = Item(
    "A.1", "Hall", title="Vase", height_m=0.5, support=Support.FREESTANDING, section_count=2, susceptible=True,
    provenance=(Provenance("height_m", Origin.MEASURED, "50 cm"),), problems=(Problem("mass_kg", "none", "weigh it"),),
)  # fmt: skip
ITEMS = (VASE, replace(VASE, object_number="A.2"), replace(VASE, object_number="A.3", gallery="Store"))
READING = Reading(ITEMS, 3, (), "a.csv", "0" * 64, "m", "M")

DAMAGE = {
    "a digit": "height_m = 0.25",
    "a letter": "title = 'Vasf'",
    "another gallery": "gallery = 'Hell'",
    "a flag": "on_display = 0",
    "a number that is a text": "height_m = 'x'",
    "bytes that are no text": "title = CAST(X'ff41' AS TEXT)",
    "a word that is no support": "support = 'freestandinh'",
    "a list cut off": "provenance = substr(provenance, 1, 9)",
    "a list of something else": "provenance = '[1]'",
    "a letter in a list": "problems = replace(problems, 'weigh', 'wfigh')",
    "nothing": "section_count = NULL",
    "the digest": "digest = '0' || substr(digest, 2) || 'x'",
    "a number": "object_number = 'B.2'",
}

LISTED = ("another gallery", "a flag", "the digest", "a number")
"""Damage to what objects are told apart by without their records being read."""


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Engine]:
    made = open_database(tmp_path / "kouros.db")
    METADATA.create_all(made)
    replace_inventory(made, READING, key=KEY)
    yield made
    made.dispose()


def damage(engine: Engine, what: str, number: str = "A.2") -> None:
    with engine.begin() as connection:
        done = connection.execute(text(f"UPDATE item SET {what} WHERE object_number = '{number}'"))  # noqa: S608
        assert done.rowcount == 1


@pytest.mark.parametrize("what", DAMAGE)
def test_a_damaged_record_is_not_read_and_the_next_import_writes_it_anew(what: str, engine: Engine) -> None:
    index = object_index(engine)
    damage(engine, DAMAGE[what])
    number = "B.2" if what == "a number" else "A.2"
    if what in LISTED:
        with pytest.raises(DamagedRecordError, match=number):
            object_index(engine)
    with pytest.raises(DamagedRecordError, match=number) as raised:
        read_packed(index.packed(["A.1", number, "A.3"]))
    assert raised.value.numbers == (number,)
    assert "kouros.db" in str(raised.value)
    with pytest.raises(DamagedRecordError):
        index.items([number])
    with pytest.raises(DamagedRecordError):
        items_named(engine, [number])
    with pytest.raises(DamagedRecordError):
        read_inventory(engine)
    assert index.items(["A.1", "A.3"]) == {"A.1": ITEMS[0], "A.3": ITEMS[2]}
    assert list(verify_inventory(engine)) == [DamagedRecord(number, 1, True)]
    repair(engine, raised.value.numbers)
    # Marked, it is no more readable, and all rows of the source are to be read.
    assert known_rows(engine, KEY) is None
    assert [one.object_number for one in verify_inventory(engine)] == [number]
    replace_inventory(engine, READING, key=KEY, shrink_limit=1.0)
    assert read_inventory(engine) == list(ITEMS)
    assert not [one for one in verify_inventory(engine) if one.is_current]


@pytest.mark.parametrize("what", DAMAGE)
def test_a_whole_reading_mends_what_nobody_found(what: str, engine: Engine) -> None:
    damage(engine, DAMAGE[what])
    replace_inventory(engine, READING, shrink_limit=1.0)
    assert read_inventory(engine) == list(ITEMS)


def test_what_mends_a_record_says_what_it_was(engine: Engine) -> None:
    damage(engine, "height_m = 0.25")
    found = replace_inventory(engine, READING)
    assert found.changed == {"A.2": {"height_m": (0.25, 0.5)}}
    last = latest_import(engine)
    assert last is not None
    assert (last.id, last.changed) == (2, 1)
    # The state that ended stays damaged, and is not gone back to.
    assert list(verify_inventory(engine)) == [DamagedRecord("A.2", 1, False)]
    with pytest.raises(DamagedRecordError):
        return_to(engine, 1)


def test_a_damaged_second_digest_is_found_and_mended_in_place(engine: Engine) -> None:
    damage(engine, "assessment_digest = 'abc'")
    assert [one.object_number for one in verify_inventory(engine)] == ["A.2"]
    assert not replace_inventory(engine, READING)
    assert list(verify_inventory(engine)) == []
    last = latest_import(engine)
    assert last is not None
    assert last.id == 1


def test_doubts_are_not_told_of_a_damaged_record(engine: Engine) -> None:
    assert len(list(doubts(engine, 1))) == 3
    damage(engine, DAMAGE["a letter in a list"])
    with pytest.raises(DamagedRecordError):
        list(doubts(engine, 1))


def test_the_error_survives_its_way_from_another_process() -> None:
    problem = DamagedRecordError(["A.1", "A.2"], "sqlite:///k.db")
    again = pickle.loads(pickle.dumps(problem))  # noqa: S301
    assert (again.numbers, again.database, str(again)) == (problem.numbers, problem.database, str(problem))
    assert again.exit_code == 5


@pytest.mark.parametrize("seed", range(4))
def test_no_flipped_bit_of_a_record_goes_unnoticed(seed: int, tmp_path: Path) -> None:
    """Bits of texts and numbers of real records, one at a time: the record is refused, or it is still the same."""
    random, file = Random(seed), tmp_path / "kouros.db"
    engine = open_database(file)
    METADATA.create_all(engine)
    reading = carnegie()
    few = replace(reading, items=reading.items[:40], places=(), known={}, rows=40, rejected=())
    replace_inventory(engine, few)
    sound = {item.object_number: item for item in few.items}
    noticed = 0
    for _ in range(120):
        number = random.choice(list(sound))
        with sqlite3.connect(file) as raw:
            columns = [row[1] for row in raw.execute("PRAGMA table_info(item)")]
            column = random.choice([c for c in columns if c not in OTHERS])
            was = raw.execute(f'SELECT CAST("{column}" AS BLOB) FROM item WHERE object_number = ?', [number])  # noqa: S608
            value = bytearray(was.fetchone()[0] or b"")
            kept = raw.execute(f'SELECT "{column}" FROM item WHERE object_number = ?', [number]).fetchone()[0]  # noqa: S608
            if not value:
                continue
            value[random.randrange(len(value))] ^= 1 << random.randrange(8)
            put = f'UPDATE item SET "{column}" = CAST(? AS TEXT) WHERE object_number = ?'  # noqa: S608
            raw.execute(put, [bytes(value), number])
        raw.close()
        found: dict[str, Item] | None = None
        # What the database itself refuses to give back in the index is noticed too.
        with suppress(DamagedRecordError, OperationalError):
            found = object_index(engine).items([number])
        assert found in (None, {number: sound[number]})
        noticed += found is None
        with sqlite3.connect(file) as raw:
            raw.execute(f'UPDATE item SET "{column}" = ? WHERE object_number = ?', [kept, number])  # noqa: S608
        raw.close()
    assert noticed > 15
    engine.dispose()


@pytest.mark.parametrize("what", ["until = 1", "until = 7", "since = 7"])
def test_an_object_that_is_lost_is_missed(what: str, engine: Engine) -> None:
    damage(engine, what)
    with pytest.raises(LostRecordsError, match="2 objects where 3 were imported"):
        object_index(engine)
    repair(engine, ())
    replace_inventory(engine, READING, key=KEY, shrink_limit=1.0)
    assert len(object_index(engine).objects) == len(ITEMS)
