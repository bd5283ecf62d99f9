"""Objects in columns are those that the rows held, in the order that Python sorts them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
from sqlalchemy import Engine

from pipeline.collection.database import METADATA, open_database
from pipeline.collection.inventory import replace_inventory, return_to
from pipeline.collection.listing import Listed, Listing, Run, order
from pipeline.collection.object_index import object_index
from pipeline.collection.reading import Reading
from pipeline.collection.record import assessment_digest_of, digest_of
from pipeline.records import Item


def listed(number: str, gallery: str = "Hall", case: str = "", *, shown: bool = True) -> Listed:
    return Listed(number, gallery, case, shown, f"digest of {number}", "7")


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
            f"{random.random()}",
        )
        for number in numbers
    ]


@pytest.mark.parametrize("seed", range(5))
def test_columns_hold_what_rows_held(seed: int) -> None:
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
    shuffled = random.sample(objects, len(objects))
    assert list(Listing.of(shuffled).sorted()) == objects


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
    assert list(none.sorted()) == []
    with pytest.raises(IndexError):
        none[0]


def test_a_digest_is_of_numbers_and_records_and_of_where_they_end() -> None:
    def digest(*pairs: tuple[str, str]) -> bytes:
        return Listing.of(Listed(number, "Hall", "", True, told, "1") for number, told in pairs).digest()

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


def test_the_index_follows_the_inventory(engine: Engine) -> None:
    random, now, number = Random(3), items(60), 1_000
    for version in range(1, 12):
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
        found = object_index(engine)
        wanted = [
            Listed(i.object_number, i.gallery, i.case, i.on_display, digest_of(i), assessment_digest_of(i)) for i in now
        ]
        assert (found.version, list(found.objects)) == (version, sorted(wanted, key=order))
        some_numbers = [one.object_number for one in random.sample(now, 5)]
        assert found.items(some_numbers) == {one.object_number: one for one in now if one.object_number in some_numbers}
    assert found.digests([now[0].object_number, "none"]) == {now[0].object_number: digest_of(now[0])}
    return_to(engine, 4)
    with pytest.raises(KeyError):
        object_index(engine).packed(["none"])
