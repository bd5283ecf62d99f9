"""The inventory gives back what was written, bit by bit, on SQLite and PostgreSQL; a shrunken source is refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import Column, Engine, MetaData, String, Table, func, insert, select
from sqlalchemy.engine.interfaces import CacheStats
from sqlalchemy.exc import IntegrityError

from pipeline.collection.database import METADATA, DamagedDatabaseError, open_database
from pipeline.collection.errors import CollectionError, ShrunkError
from pipeline.collection.inventory import (
    IMPORT_BATCH,
    ITEM,
    ChangeCounts,
    galleries,
    held,
    latest_import,
    read_inventory,
    replace_inventory,
    return_to,
    versions,
)
from pipeline.collection.reading import Reading, Rejected
from pipeline.collection.record import CHOICES, KINDS, NUMBER_LIMIT
from pipeline.records import Item, Origin, Problem, Provenance
from tests.museum import carnegie
from tests.soak import examples

# What `read_items` lets through: no NUL, no halves of surrogate pairs, no negative zero, nothing infinite.
_TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=60)
_COORDINATE = st.floats(allow_nan=False, allow_infinity=False).map(lambda x: x + 0.0)
_VALUES = {
    "text": _TEXT,
    "number": st.none() | st.floats(allow_nan=False, allow_infinity=False).map(lambda x: x + 0.0),
    "integer": st.none() | st.integers(0, 2**31 - 1),
    "flag": st.none() | st.booleans(),
    "polygon": st.lists(st.tuples(_COORDINATE, _COORDINATE), max_size=4).map(tuple),
}
_SPECIAL = {
    **{name: st.none() | st.sampled_from(kind) for name, kind in CHOICES.items()},
    "object_number": st.text(
        st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=NUMBER_LIMIT
    ),
    "on_display": st.booleans(),
    "problems": st.lists(st.builds(Problem, _TEXT, _TEXT, _TEXT), max_size=3).map(tuple),
    "provenance": st.lists(st.builds(Provenance, _TEXT, st.sampled_from(Origin), _TEXT, _TEXT), max_size=3).map(tuple),
}
ITEMS = st.lists(
    st.builds(Item, **{name: _SPECIAL[name] if name in _SPECIAL else _VALUES[kind] for name, kind in KINDS.items()}),
    min_size=1,
    max_size=4,
    unique_by=lambda item: item.object_number,
)


def made(items: list[Item], rejected: tuple[Rejected, ...] = (), sha256: str = "0" * 64) -> Reading:
    return Reading(tuple(items), len(items) + len(rejected), rejected, "a.csv", sha256, "carnegie", "M", "C")


def numbered(count: int) -> list[Item]:
    return [Item(f"{i:04d}", "Hall", height_m=0.1 * i) for i in range(1, count + 1)]


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def shared(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    if request.param == "sqlite":
        engine = open_database(tmp_path_factory.mktemp("inventory") / "kouros.db")
    else:
        engine = open_database(request.getfixturevalue("postgresql_url"))
    METADATA.create_all(engine)
    yield engine
    METADATA.drop_all(engine)
    engine.dispose()


@pytest.fixture
def engine(shared: Engine) -> Engine:
    """An inventory without objects and imports."""
    with shared.begin() as connection:
        connection.execute(ITEM.delete())
        connection.execute(IMPORT_BATCH.delete())
    return shared


@given(items=ITEMS)
@settings(max_examples=examples(60), deadline=None)
def test_items_come_back_as_they_were_written(shared: Engine, items: list[Item]) -> None:
    replace_inventory(shared, made(items), shrink_limit=1.0)
    back = read_inventory(shared)
    assert back == sorted(items, key=lambda item: item.object_number)
    for item, other in zip(back, sorted(items, key=lambda item: item.object_number), strict=True):
        for name, kind in KINDS.items():
            assert type(getattr(item, name)) is type(getattr(other, name))
            if kind == "number" and getattr(item, name) is not None:
                assert getattr(item, name).hex() == getattr(other, name).hex()


def test_carnegie_through_the_database(engine: Engine) -> None:
    reading = carnegie()
    assert replace_inventory(engine, reading).counts == ChangeCounts(
        before=0, after=2000, added=2000, removed=0, changed=0
    )
    assert read_inventory(engine) == sorted(reading.items, key=lambda item: item.object_number)
    assert len(galleries(read_inventory(engine))) == 34
    assert replace_inventory(engine, reading).counts == ChangeCounts(
        before=2000, after=2000, added=0, removed=0, changed=0
    )


def test_hostile_text_is_stored_and_not_run(engine: Engine) -> None:
    title = """<script>alert("x")</script>'; DROP TABLE item; -- %s :title \\"""
    replace_inventory(engine, made([Item("1'; --", 'Hall "A"', title=title)]))
    assert read_inventory(engine)[0].title == title


def test_the_last_import_is_told(engine: Engine) -> None:
    assert latest_import(engine) is None
    rejected = Rejected("a.csv", 3, 4, "object_number", "no number", "give it one")
    replace_inventory(engine, made(numbered(1)), when=datetime(2031, 1, 1, tzinfo=UTC))
    summer = datetime(2030, 7, 1, 2, 30, tzinfo=timezone(timedelta(hours=2)))
    replace_inventory(engine, made(numbered(2), (rejected,)), when=summer)
    last = latest_import(engine)
    # The last import counts, not the largest time: a clock may have been set back.
    assert last is not None
    assert (last.imported_at, last.rows, last.items, last.rejected) == ("2030-07-01T00:30:00+00:00", 3, 2, 1)
    assert (last.source, last.sha256, last.mapping, last.museum, last.credit) == (
        "a.csv",
        "0" * 64,
        "carnegie",
        "M",
        "C",
    )
    with engine.connect() as connection:
        kept = connection.execute(select(IMPORT_BATCH.c.rejected).order_by(IMPORT_BATCH.c.id.desc())).scalars().first()
    assert kept == [
        {
            "file": "a.csv",
            "row": 3,
            "line": 4,
            "field": "object_number",
            "message": "no number",
            "remedy": "give it one",
        }
    ]


def test_what_changed_is_counted(engine: Engine) -> None:
    old = numbered(10)
    replace_inventory(engine, made(old))
    new = [*old[1:8], replace(old[8], height_m=9.0), old[9], Item("X", "Hall")]
    assert replace_inventory(engine, made(new)).counts == ChangeCounts(
        before=10, after=10, added=1, removed=1, changed=1
    )


def test_a_difference_names_objects_fields_and_both_values(engine: Engine) -> None:
    old = numbered(4)
    replace_inventory(engine, made(old))
    new = [Item("X", "Hall"), replace(old[1], height_m=9.0, gallery="East"), *old[2:]]
    would = replace_inventory(engine, made(new), shrink_limit=1.0, dry_run=True)
    assert (would.added, would.removed) == (("X",), ("0001",))
    assert would.changed == {"0002": {"gallery": ("Hall", "East"), "height_m": (0.2, 9.0)}}
    assert read_inventory(engine) == old, "a difference writes nothing"
    assert replace_inventory(engine, made(new), shrink_limit=1.0) == would


def test_what_is_the_same_but_for_its_number_is_told(engine: Engine) -> None:
    vase = Item("A 1", "Hall", title="Vase", medium="porcelain", height_m=0.3, width_m=0.12)
    pair = [Item(number, "Hall", title="Candlestick", height_m=0.24) for number in ("B 1", "B 2")]
    nameless = Item("C 1", "Hall", height_m=0.5)
    replace_inventory(engine, made([vase, *pair, nameless]))
    new = [replace(one, object_number=f"2026.{at}") for at, one in enumerate((vase, *pair, nameless))]
    would = replace_inventory(engine, made(new), shrink_limit=1.0, dry_run=True)
    # Of a pair nobody can say which is which, and a size alone is no thing.
    assert would.renumbered == (("A 1", "2026.0"),)
    other = [replace(vase, object_number="2026.0", height_m=0.31), *pair, nameless]
    assert replace_inventory(engine, made(other), shrink_limit=1.0, dry_run=True).renumbered == ()


def test_the_same_again_makes_no_version(engine: Engine) -> None:
    replace_inventory(engine, made(numbered(3)))
    assert not replace_inventory(engine, made(numbered(3)))
    assert len(versions(engine)) == 1
    # The same objects from another file are another import: the log must say so.
    assert not replace_inventory(engine, made(numbered(3), sha256="1" * 64))
    assert [(info.added, info.changed) for info in versions(engine)] == [(0, 0), (3, 0)]


def test_every_import_can_be_had_back(engine: Engine) -> None:
    states = [
        numbered(5),
        [replace(item, title="new") for item in numbered(4)],
        [Item("0005", "Elsewhere"), Item("0009", "Hall")],
    ]
    for number, state in enumerate(states):
        replace_inventory(engine, made(state, sha256=str(number) * 64), shrink_limit=1.0)
    first = versions(engine)[-1].id
    for back, state in enumerate(states):
        return_to(engine, first + back)
        assert read_inventory(engine) == state
    # Going back is a version as well: going back to it gives the same.
    return_to(engine, first + 3)
    assert read_inventory(engine) == states[0]
    newest = versions(engine)[0]
    assert (newest.returned_to, newest.source, newest.items) == (first + 3, "a.csv", 5)
    with pytest.raises(CollectionError, match=f"no version 99: there are {first} to {newest.id}"):
        return_to(engine, 99)


def test_a_night_does_not_undo_going_back(engine: Engine) -> None:
    good, bad = made(numbered(3), sha256="a" * 64), made(numbered(2), sha256="b" * 64)
    assert held(engine, bad.sha256) is None
    replace_inventory(engine, good, shrink_limit=1.0)
    replace_inventory(engine, bad, shrink_limit=1.0)
    assert held(engine, bad.sha256) is None
    version = versions(engine)[-1].id
    return_to(engine, version)
    assert held(engine, bad.sha256) == version
    # A source that has changed is read again.
    assert held(engine, "c" * 64) is None


def test_records_of_before_digests_are_the_same_records(engine: Engine) -> None:
    replace_inventory(engine, made(numbered(3)))
    with engine.begin() as connection:
        connection.execute(ITEM.update().values(digest=""))
    assert not replace_inventory(engine, made(numbered(3), sha256="1" * 64))
    with engine.connect() as connection:
        digests = connection.execute(select(ITEM.c.digest)).scalars().all()
    assert len(set(digests)) == 3
    assert "" not in digests


@pytest.mark.parametrize(("before", "after", "limit"), [(100, 80, 0.2), (100, 71, 0.29), (10, 1, 1.0), (3, 5, 0.0)])
def test_a_loss_up_to_the_limit_is_taken(before: int, after: int, limit: float, engine: Engine) -> None:
    replace_inventory(engine, made(numbered(before)))
    assert replace_inventory(engine, made(numbered(after)), shrink_limit=limit).counts.after == after


@pytest.mark.parametrize(("before", "after", "limit"), [(100, 79, 0.2), (100, 70, 0.29), (10, 9, 0.0)])
def test_a_larger_loss_changes_nothing(before: int, after: int, limit: float, engine: Engine) -> None:
    replace_inventory(engine, made(numbered(before)))
    with pytest.raises(ShrunkError, match=f"has {after} usable objects, the inventory {before}.*Check that") as refused:
        replace_inventory(engine, made(numbered(after)), shrink_limit=limit)
    assert refused.value.exit_code == 7
    assert len(read_inventory(engine)) == before
    last = latest_import(engine)
    assert last is not None
    assert last.items == before


def test_all_or_nothing(engine: Engine) -> None:
    """A number that is given twice breaks the primary key in the middle of the writing."""
    replace_inventory(engine, made(numbered(3)))
    with pytest.raises(IntegrityError):
        replace_inventory(engine, made([*numbered(5), Item("0001", "Elsewhere")]))
    assert read_inventory(engine) == numbered(3)
    with engine.connect() as connection:
        assert connection.execute(select(func.count()).select_from(IMPORT_BATCH)).scalar_one() == 1


def test_a_reading_without_objects_changes_nothing(engine: Engine) -> None:
    rejected = Rejected("a.csv", 1, 2, "object_number", "the object has no number", "give it one")
    with pytest.raises(
        CollectionError, match=r"none of its 1 rows could be used\. The first: the object has no number"
    ):
        replace_inventory(engine, made([], (rejected,)))


def test_impossible_requests(engine: Engine) -> None:
    with pytest.raises(ValueError, match="shrink_limit must be a share from 0 to 1"):
        replace_inventory(engine, made(numbered(1)), shrink_limit=20)
    with pytest.raises(ValueError, match="needs a time zone"):
        replace_inventory(engine, made(numbered(1)), when=datetime(2030, 1, 1))
    assert read_inventory(engine) == []


def test_galleries_are_those_with_objects_on_display() -> None:
    items = [Item("1", "West"), Item("2", "East"), Item("3", "West"), Item("4", "Store", on_display=False)]
    assert list(galleries(items).items()) == [("East", 1), ("West", 2)]


def test_the_folder_of_the_database_is_made(tmp_path: Path) -> None:
    engine = open_database(tmp_path / "new" / "kouros.db")
    METADATA.create_all(engine)
    assert read_inventory(engine) == []
    engine.dispose()


def test_a_kept_connection_leaves_a_file_that_another_took_the_place_of(tmp_path: Path) -> None:
    file, backup = tmp_path / "kouros.db", tmp_path / "backup.db"
    for where, count in ((backup, 2), (file, 3)):
        made_there = open_database(where)
        METADATA.create_all(made_there)
        replace_inventory(made_there, made(numbered(count)))
    engine = open_database(file, keeping=2)
    assert len(read_inventory(engine)) == 3
    with engine.connect() as connection:
        kept = connection.connection.dbapi_connection
    with engine.connect() as connection:
        assert connection.connection.dbapi_connection is kept
    backup.replace(file)
    assert len(read_inventory(engine)) == 2
    engine.dispose()


def test_a_statement_compiled_for_one_file_serves_another_which_is_asked_itself(tmp_path: Path) -> None:
    """The errors of each name its own file, too."""
    word = Table("word", MetaData(), Column("said", String))
    hits = []
    for name in ("a", "b"):
        engine = open_database(tmp_path / name)
        word.create(engine)
        with engine.begin() as connection:
            connection.execute(insert(word), {"said": name})
            asked = connection.execute(select(word).where(word.c.said != "nothing"))
            hits.append(asked.context.cache_hit)
            assert asked.scalars().all() == [name]
        (tmp_path / name).write_bytes(b"no database, but as long as one is at least. " * 100)
        with pytest.raises(DamagedDatabaseError, match=f"/{name} is damaged"), engine.connect() as connection:
            connection.execute(select(word))
    assert hits == [CacheStats.CACHE_MISS, CacheStats.CACHE_HIT]
