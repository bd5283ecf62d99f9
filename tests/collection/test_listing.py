"""The listing that a night brings up to date is the one that it would read anew, whatever became of the inventory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
from sqlalchemy import Engine, update

from pipeline.collection import catalogue as module
from pipeline.collection.catalogue import Catalogue, catalogue
from pipeline.collection.database import METADATA, open_database
from pipeline.collection.inventory import ITEM, replace_inventory, return_to
from pipeline.collection.listing import Listed, Listing, Run, order, read_listing, write_listing
from pipeline.collection.reading import Reading
from pipeline.records import Item


def listed(number: str, gallery: str = "Hall", case: str = "", *, shown: bool = True) -> Listed:
    return Listed(number, gallery, case, shown, f"digest of {number}", 7)


def some(random: Random, count: int) -> list[Listed]:
    """Objects in galleries and cases, with names that sort differently as bytes, letters and code points."""
    galleries = ["Hall", "hall", "Äußerer Saal", "Zimmer", "\U0001f3fa", "\uffee", ""]
    numbers = random.sample([f"{head}{n}" for head in ("A.", "é", "\U0001f3fa", "") for n in range(count)], count)
    return [
        Listed(
            number,
            random.choice(galleries),
            random.choice(["", "", "case", "Case 2"]),
            random.random() < 0.7,
            f"{random.random()}",
            random.choice([None, -(2**63), 2**63 - 1]),
        )
        for number in numbers
    ]


@pytest.mark.parametrize("seed", range(5))
def test_columns_hold_what_rows_held(seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    objects = sorted(some(random, random.choice([1, 2, 400])), key=order)
    listing = Listing.of(objects)
    assert list(listing) == objects
    assert [listing[at] for at in range(-len(objects), len(objects))] == objects * 2
    assert list(listing[1:-1]) == objects[1:-1]
    assert list(listing[::7]) == objects[::7]
    assert listing.galleries == {one.gallery for one in objects}
    assert listing.shown == sum(one.on_display for one in objects)
    wanted = {one.object_number for one in objects[::3]}
    assert listing.places(wanted | {"none"}) == {
        one.object_number: at for at, one in enumerate(objects) if one.object_number in wanted
    }
    runs: list[Run] = []
    for at, one in enumerate(objects):
        if not runs or runs[-1][:2] != (one.on_display, one.gallery):
            runs.append(Run(one.on_display, one.gallery, at, at))
        runs[-1] = runs[-1]._replace(end=at + 1)
    assert list(listing.runs) == runs
    some_runs = random.sample(runs, max(1, len(runs) // 2))
    assert list(listing.joined(some_runs)) == [one for run in some_runs for one in objects[run.start : run.end]]
    begins = [
        at
        for at, one in enumerate(objects)
        if at == 0 or not one.case or (one.gallery, one.case) != (objects[at - 1].gallery, objects[at - 1].case)
    ]
    assert listing.companies().tolist() == begins
    write_listing(tmp_path / "kept", listing, {"of": seed})
    kept = read_listing(tmp_path / "kept")
    assert kept is not None
    assert (list(kept[0]), kept[1]) == (objects, {"of": seed})
    gone, left = objects[::5], [one for at, one in enumerate(objects) if at % 5]
    new = [one._replace(object_number=f"new {one.object_number}") for one in some(random, 30)]
    assert list(kept[0].changed([one.object_number for one in gone], new)) == sorted([*left, *new], key=order)


def test_an_empty_listing() -> None:
    none = Listing.of([])
    assert (len(none), none.runs, none.galleries, none.shown, none.places({"a"}), list(none)) == (
        0,
        (),
        set(),
        0,
        {},
        [],
    )
    assert list(none.changed([], [listed("1")])) == [listed("1")]
    with pytest.raises(IndexError):
        none[0]


def test_a_digest_is_of_numbers_and_records_and_of_where_they_end() -> None:
    def digest(*pairs: tuple[str, str]) -> bytes:
        return Listing.of(Listed(number, "Hall", "", True, told, 1) for number, told in pairs).digest()

    one = digest(("ab", "x"), ("c", "y"))
    assert one == digest(("ab", "x"), ("c", "y"))
    assert one not in {
        digest(("a", "x"), ("bc", "y")),
        digest(("ab", "xy"), ("c", "")),
        digest(("c", "y"), ("ab", "x")),
    }
    # Where it lies in a larger one does not matter.
    whole = Listing.of([listed("0"), listed("1"), listed("2"), listed("3")])
    assert whole[1:3].digest() == Listing.of([listed("1"), listed("2")]).digest() != whole[2:4].digest()


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "other", "gone"])
def test_a_damaged_listing_is_none(damage: str, tmp_path: Path) -> None:
    path = tmp_path / "kept"
    write_listing(path, Listing.of([listed(str(n)) for n in range(50)]), {})
    content = bytearray(path.read_bytes())
    if damage == "cut":
        path.write_bytes(content[:-9])
    elif damage == "flipped":
        content[-300] ^= 1
        path.write_bytes(content)
    elif damage == "empty":
        path.write_bytes(b"")
    elif damage == "other":
        path.write_bytes(b"[1, 2, 3]\n")
    else:
        path.unlink()
    assert read_listing(path) is None


def test_where_no_listing_can_be_kept_nothing_is_lost(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    write_listing(tmp_path / "file" / "kept", Listing.of([listed("1")]), {})
    assert read_listing(tmp_path / "file" / "kept") is None


@pytest.fixture(params=["sqlite", "postgresql"])
def engine(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Engine]:
    where = tmp_path / "kouros.db" if request.param == "sqlite" else request.getfixturevalue("postgresql_url")
    made = open_database(where)
    METADATA.drop_all(made)
    METADATA.create_all(made)
    yield made
    METADATA.drop_all(made)
    made.dispose()


def items(count: int, start: int = 0) -> list[Item]:
    return [Item(f"{n:04d}", f"Hall {n % 5}", height_m=0.5, on_display=n % 3 > 0) for n in range(start, start + count)]


def take_in(engine: Engine, of: list[Item]) -> None:
    replace_inventory(
        engine, Reading(tuple(of), len(of), (), "a.csv", str(hash(tuple(of))), "m", "M"), shrink_limit=1.0
    )


def same(engine: Engine, kept: Path) -> Catalogue:
    """Return the catalogue as a night has it, which is the one that is read anew."""
    brought, anew = catalogue(engine, kept), catalogue(engine)
    assert (brought.version, list(brought.objects)) == (anew.version, list(anew.objects))
    return brought


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many objects were listed each time that all were asked for."""
    found: list[int] = []
    true = module.write_listing

    def noted(file: Path, listing: Listing, told: dict[str, object]) -> None:
        found.append(len(listing))
        true(file, listing, told)

    monkeypatch.setattr(module, "write_listing", noted)
    return found


def test_a_listing_follows_the_inventory(engine: Engine, tmp_path: Path, reads: list[int]) -> None:
    random, kept = Random(3), tmp_path / "kept"
    now, number = items(60), 1_000
    for version in range(1, 20):
        for _ in range(random.randrange(1, 4)):
            at = random.randrange(len(now))
            what = random.randrange(5)
            if what == 0:
                now[at] = replace(now[at], height_m=random.random())
            elif what == 1:
                now[at] = replace(now[at], gallery=f"Hall {random.randrange(9)}", case=random.choice(["", "A"]))
            elif what == 2:
                now[at] = replace(now[at], on_display=not now[at].on_display)
            elif what == 3:
                del now[at]
            else:
                number += 2
                now += items(2, start=number)
        take_in(engine, now)
        if version % 3:
            same(engine, kept)
        if version == 11:
            return_to(engine, 4)
            same(engine, kept)
            return_to(engine, 11)
    same(engine, kept)
    # The first time, and never again.
    assert reads == [reads[0]]


def test_a_listing_of_another_inventory_is_none(tmp_path: Path, reads: list[int]) -> None:
    """As many imports, in a database of its own: the kept listing is of an import that this one does not have."""
    for name in ("one", "other"):
        made = open_database(tmp_path / f"{name}.db")
        METADATA.create_all(made)
        take_in(made, items(20 if name == "one" else 30))
        same(made, tmp_path / "kept")
        made.dispose()
    assert reads == [20, 30]


def test_after_many_changes_all_is_listed_anew(
    tmp_path: Path, reads: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "FEW", 10)
    made = open_database(tmp_path / "kouros.db")
    METADATA.create_all(made)
    take_in(made, items(40))
    same(made, tmp_path / "kept")
    take_in(made, [*items(30), *items(20, start=100)])
    same(made, tmp_path / "kept")
    assert reads == [40, 50]
    made.dispose()


def test_what_an_older_version_wrote_is_not_kept(tmp_path: Path, reads: list[int]) -> None:
    """Digest and kind of such a record are filled in later in its place, which no version says."""
    made = open_database(tmp_path / "kouros.db")
    METADATA.create_all(made)
    take_in(made, items(10))
    with made.begin() as connection:
        connection.execute(update(ITEM).where(ITEM.c.object_number == "0003").values(kind=None))
    same(made, tmp_path / "kept")
    assert reads == []
    take_in(made, items(11))
    same(made, tmp_path / "kept")
    assert reads == [11]
    made.dispose()


def test_a_digest_that_newer_code_wrote_in_place_is_had_from_the_inventory(tmp_path: Path) -> None:
    """No version says that it was written anew; the one in the listing stands for the same record."""
    made = open_database(tmp_path / "kouros.db")
    METADATA.create_all(made)
    take_in(made, items(10))
    same(made, tmp_path / "kept")
    with made.begin() as connection:
        connection.execute(update(ITEM).where(ITEM.c.object_number == "0003").values(digest="newer"))
    brought = catalogue(made, tmp_path / "kept")
    assert brought.digests(["0003", "none"]) == {"0003": "newer"}
    made.dispose()


def test_what_does_not_add_up_is_listed_anew(tmp_path: Path, reads: list[int]) -> None:
    """A state that somebody took out of the database by hand, behind every version's back."""
    made = open_database(tmp_path / "kouros.db")
    METADATA.create_all(made)
    take_in(made, items(10))
    same(made, tmp_path / "kept")
    take_in(made, [replace(one, height_m=0.25) if n < 2 else one for n, one in enumerate(items(10))])
    with made.begin() as connection:
        connection.execute(ITEM.delete().where(ITEM.c.object_number == "0001", ITEM.c.since == 2))
    same(made, tmp_path / "kept")
    assert reads == [10, 9]
    made.dispose()
