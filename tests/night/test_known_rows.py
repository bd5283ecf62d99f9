"""A night reads of the museum's source only what is not as it was, and only where it may trust what it remembers."""

import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import select, text

from pipeline.collection.inventory import read_inventory, return_to
from pipeline.collection.inventory.source_rows import SOURCE_STATE
from pipeline.collection.reading import Reading
from pipeline.night import importing
from pipeline.night import run as nightly
from pipeline.night.importing import import_collection
from pipeline.operations.workspace import open_workspace
from pipeline.records import Silent
from pipeline.settings import Settings
from tests.museum import museum_of, vases, write_collection

OBJECTS = vases(galleries=3, each=6)


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return museum_of(tmp_path / "museum", OBJECTS)


@pytest.fixture
def refresh(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Callable[[], Reading | None]:
    """What a night does before anything else; it returns what was read, None where nothing was."""
    readings: list[Reading] = []
    true = importing.read_items

    def noted(*given: object) -> Reading:
        readings.append(true(*given))  # type: ignore[arg-type]
        return readings[-1]

    monkeypatch.setattr(importing, "read_items", noted)

    def go() -> Reading | None:
        readings.clear()
        nightly._refresh(open_workspace(settings), Silent(), dry_run=False)
        return readings[0] if readings else None

    return go


def inventory(settings: Settings) -> dict[str, float | None]:
    return {item.object_number: item.height_m for item in read_inventory(open_workspace(settings).engine)}


def higher(at: int, height: str) -> list[dict[str, str]]:
    objects = [dict(one) for one in OBJECTS]
    objects[at]["height_m"] = height
    return objects


Refresh = Callable[[], Reading | None]


def unread(reading: Reading | None) -> int:
    assert reading is not None
    return 0 if reading.unread is None else reading.unread.objects


def test_after_a_change_only_its_row_is_read(settings: Settings, refresh: Refresh) -> None:
    assert unread(refresh()) == 0
    assert refresh() is None
    write_collection(settings.home, higher(9, "0.9")[:-1])
    changed = refresh()
    assert changed is not None
    assert [item.object_number for item in changed.items] == [OBJECTS[9]["object_number"]]
    assert unread(changed) == 16
    assert inventory(settings) == {one["object_number"]: float(one["height_m"]) for one in higher(9, "0.9")[:-1]}
    (last,) = (settings.home / "imports").glob("00002-*.csv")
    log = last.read_text(encoding="utf-8")
    assert "height_m,changed,0.5 -> 0.9" in log
    assert "gone" in log


def test_a_museums_own_database_is_fetched_and_not_read_again(settings: Settings, refresh: Refresh) -> None:
    source = settings.home / "museum.sqlite"
    with sqlite3.connect(source) as theirs:
        theirs.execute("CREATE TABLE objects (nr TEXT, room TEXT, h REAL)")
        theirs.executemany("INSERT INTO objects VALUES (?, ?, ?)", [(f"A.{n:03d}", "Room", 0.2) for n in range(90)])
    (settings.home / "sql.toml").write_text(
        '[source]\nformat = "sql"\ntable = "objects"\n[museum]\nname = "M"\n[columns]\nobject_number.column = "nr"\n'
        'gallery.column = "room"\nheight_m = { column = "h", unit = "m" }\n',
        encoding="utf-8",
    )
    wanted = {"source": f"sqlite:///{source}", "mapping": "sql.toml"}
    settings.__dict__["collection"] = settings.collection.model_copy(update=wanted)
    assert unread(refresh()) == 0
    assert unread(refresh()) == 90
    with sqlite3.connect(source) as theirs:
        theirs.execute("UPDATE objects SET h = 0.7 WHERE nr = 'A.040'")
    assert unread(refresh()) == 89
    assert {number for number, height in inventory(settings).items() if height == 0.7} == {"A.040"}
    # Where its address is, nothing else must be told: it may hold a password.
    with open_workspace(settings).engine.connect() as connection:
        assert "museum.sqlite" not in connection.execute(select(SOURCE_STATE.c.source)).scalar_one()


def test_what_a_person_imported_since_is_not_what_is_remembered(settings: Settings, refresh: Refresh) -> None:
    refresh()
    (settings.home / "other").mkdir()
    write_collection(settings.home / "other", higher(0, "0.44")[:9])
    workspace = open_workspace(settings)
    import_collection(workspace, settings.home / "other" / "collection.csv", "kouros", shrink_limit=1.0)
    assert len(inventory(settings)) == 9
    again = refresh()
    assert again is not None
    assert again.unread is None
    assert inventory(settings) == {one["object_number"]: float(one["height_m"]) for one in OBJECTS}


def test_a_version_that_a_person_went_back_to_is_not_taken_for_the_sources_state(
    settings: Settings, refresh: Refresh
) -> None:
    refresh()
    write_collection(settings.home, higher(0, "0.44"))
    refresh()
    return_to(open_workspace(settings).engine, 1)
    held = refresh()
    assert held is not None
    assert inventory(settings)["0.0"] == 0.2
    assert refresh() is None
    write_collection(settings.home, higher(0, "0.44")[:-1])
    assert unread(refresh()) == 0
    assert len(inventory(settings)) == len(OBJECTS) - 1
    assert inventory(settings)["0.0"] == 0.44


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE source_row SET object_number = '0.1' WHERE object_number = '0.0'",
        "UPDATE source_row SET evidence = '[]' WHERE object_number = '0.2'",
        "UPDATE source_row SET noted = '[[]]' WHERE object_number = '0.2'",
        "UPDATE source_row SET digest = substr(digest, 2) WHERE object_number = '0.2'",
        "DELETE FROM source_row WHERE object_number = '0.2'",
        "DELETE FROM source_row",
        "DELETE FROM source_state",
        "UPDATE source_state SET rows = 3",
        "UPDATE source_state SET code = 'older'",
        "UPDATE source_state SET limits = '{}'",
    ],
)
def test_what_is_damaged_or_of_other_code_is_not_known(damage: str, settings: Settings, refresh: Refresh) -> None:
    refresh()
    with open_workspace(settings).engine.begin() as connection:
        assert connection.execute(text(damage)).rowcount > 0
    write_collection(settings.home, higher(4, "0.9")[:-2])
    again = refresh()
    assert again is not None
    assert again.unread is None
    assert len(inventory(settings)) == len(OBJECTS) - 2
    # All of it is known anew.
    write_collection(settings.home, higher(5, "0.9")[:-2])
    assert unread(refresh()) == len(OBJECTS) - 4


def test_an_import_by_hand_reads_everything_and_what_it_read_is_known(settings: Settings, refresh: Refresh) -> None:
    refresh()
    workspace = open_workspace(settings)
    done = import_collection(workspace, settings.home / "collection.csv", "kouros", shrink_limit=1.0)
    assert (done.reading.unread, len(done.reading.items)) == (None, len(OBJECTS))
    assert refresh() is None
    write_collection(settings.home, higher(5, "0.9"))
    assert unread(refresh()) == len(OBJECTS) - 1
