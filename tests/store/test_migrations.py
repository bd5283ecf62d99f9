"""The migrations make exactly the tables that the code uses, once, whoever starts first."""

import os
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import URL, Engine, insert, inspect, text

import pipeline
from pipeline.collection.database import DatabaseFileError, open_database
from pipeline.collection.inventory import latest_import, read_inventory, replace_inventory, versions
from pipeline.collection.reading import Reading
from pipeline.collection.record import digest_of, to_records
from pipeline.collection.sealing import write_seals
from pipeline.records import Item, Problem, Support
from pipeline.resources import resource
from pipeline.store.codec import StoreError
from pipeline.store.migrate import current, revisions, upgrade
from pipeline.store.runs import load_run
from pipeline.store.tables import IMPORT_BATCH, ITEM, METADATA
from pipeline.store.verifying import verify_columns
from tests.store.run_samples import assessment, finding, run, save_run

UPGRADE = """
import sys
from pipeline.collection.database import DatabaseFileError, open_database
from pipeline.store.migrate import upgrade
upgrade(open_database(sys.argv[1]))
print("alembic" in sys.modules)
"""


def _start(url: URL) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", UPGRADE, url.render_as_string(hide_password=False)]
    found_here = os.environ | {"PYTHONPATH": str(Path(pipeline.__file__).parent.parent)}
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=found_here)


def test_migrated_tables_equal_the_metadata(engine: Engine) -> None:
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), METADATA) == []
    assert [*verify_columns(engine)] == []
    found = inspect(engine)
    assert set(found.get_table_names()) == {*METADATA.tables, "alembic_version"}
    for name, table in METADATA.tables.items():  # which alembic does not compare
        assert found.get_pk_constraint(name)["constrained_columns"] == [column.name for column in table.primary_key]


def test_the_inventory_works_on_migrated_tables(engine: Engine) -> None:
    items = [
        Item("1", "G1", support=Support.HUNG, section_count=4, height_m=0.1 + 0.2, susceptible=False),
        Item("2", "G1", problems=(Problem("mass_kg", "no number", "weigh it"),)),
        Item("3", "G1", value=1e12 / 3.0, irreplaceable=True, on_loan=False),
    ]
    batch = {"sha256": "", "mapping": "", "museum": "", "credit": "", "rows": 3, "items": 3, "rejected": []}
    with engine.begin() as connection:
        version = {"since": 1, "until": None}
        records = zip(items, to_records(items), strict=True)
        connection.execute(insert(ITEM), [record | version | {"digest": digest_of(item)} for item, record in records])
        for source in ("first.csv", "second.csv"):  # the database numbers them
            connection.execute(insert(IMPORT_BATCH), batch | {"imported_at": "2031-05-01", "source": source})
        write_seals(connection, IMPORT_BATCH)
    assert read_inventory(engine) == items
    latest = latest_import(engine)
    assert latest is not None
    assert latest.source == "second.csv"


def test_an_inventory_of_before_versions_is_the_version_of_its_last_import(empty: Engine) -> None:
    _upgrade_to(empty, "0002")
    old = {"gallery": "G1", "on_display": True, "problems": "[]"}
    texts = ("title", "object_name", "classification", "medium", "case", "isolator", "material", "base_material")
    texts += ("surface_material", "wall_surface", "back_surface", "section_shape", "value_class")
    record = old | dict.fromkeys(texts, "") | {"height_m": 0.1 + 0.2}
    columns = ", ".join(f'"{name}"' for name in ("object_number", *record))
    with empty.begin() as connection:
        for number in ("A", "B"):
            values = ", ".join(f":{name}" for name in ("object_number", *record))
            command = text(f"INSERT INTO item ({columns}) VALUES ({values})")  # noqa: S608 - our own names
            connection.execute(command, {"object_number": number} | record)
        batch = "imported_at, source, sha256, mapping, museum, credit, rows, items, rejected"
        for _ in range(2):
            connection.execute(
                text(f"INSERT INTO import_batch ({batch}) VALUES ('2031-05-01', 'a', '', '', '', '', 2, 2, '[]')")  # noqa: S608
            )
    upgrade(empty)
    items = [Item("A", "G1", height_m=0.1 + 0.2), Item("B", "G1", height_m=0.1 + 0.2)]
    assert read_inventory(empty) == items
    with empty.connect() as connection:
        assert connection.execute(text("SELECT DISTINCT since FROM item")).scalars().all() == [2]
    changes = replace_inventory(empty, Reading(tuple(items), 2, (), "a", "", "", ""))
    assert not changes
    assert [info.id for info in versions(empty)] == [2, 1]


def test_runs_of_before_units_are_dropped_and_decisions_and_the_inventory_stay(empty: Engine) -> None:
    _upgrade_to(empty, "0011")
    for table in ("run", "decision", "item"):
        _any_row(empty, table)
    upgrade(empty)
    with empty.connect() as connection:
        left = {name: connection.execute(text(f"SELECT count(*) FROM {name}")).scalar() for name in  # noqa: S608
                ("run", "decision", "item", "result", "page", "run_page")}  # fmt: skip
    assert left == {"run": 0, "decision": 1, "item": 1, "result": 0, "page": 0, "run_page": 0}


def _any_row(engine: Engine, table: str) -> None:
    """Write a row of a table as it then was: empty texts and lists, zeros."""
    columns = [column for column in inspect(engine).get_columns(table) if not column["nullable"]]
    kinds = {column["name"]: column["type"].python_type for column in columns}
    values = {name: kind() if kind in (str, int, bool, float) else "[]" for name, kind in kinds.items()}
    names, marks = (", ".join(f"{mark}{name}{end}" for name in values) for mark, end in (('"', '"'), (":", "")))
    with engine.begin() as connection:
        connection.execute(text(f"INSERT INTO {table} ({names}) VALUES ({marks})"), values)  # noqa: S608 - our own names


def _upgrade_to(engine: Engine, revision: str) -> None:
    config = Config()
    config.set_main_option("script_location", str(resource("schemas", "migrations")))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)


def test_the_last_file_is_the_only_head() -> None:
    config = Config()
    config.set_main_option("script_location", str(resource("schemas", "migrations")))
    script = ScriptDirectory.from_config(config)
    assert tuple(script.get_heads()) == (revisions()[-1],)
    assert tuple(step.revision for step in script.walk_revisions())[::-1] == revisions()


def test_upgrade_again_keeps_the_results_and_imports_no_alembic(engine: Engine, empty_url: URL) -> None:
    record = run("a", assessment("1", finding("1")))
    save_run(engine, record)
    process = _start(empty_url)
    assert process.communicate(timeout=30)[0].strip() == "False"
    assert process.returncode == 0
    assert load_run(engine, "a") == record


def test_two_processes_may_start_at_once(empty_url: URL, empty: Engine) -> None:
    processes = [_start(empty_url) for _ in range(2)]
    for process in processes:
        process.communicate(timeout=60)
    assert [process.returncode for process in processes] == [0, 0]
    assert current(empty) == revisions()[-1]


def test_a_newer_database_is_refused(engine: Engine) -> None:
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(StoreError, match=r"'9999'.*newer Kouros made it; upgrade kouros"):
        upgrade(engine)
    assert current(engine) == "9999"


def test_a_failed_migration_leaves_the_database_as_it_was(empty: Engine) -> None:
    """A table of the museum's own that is called as one of ours, met after others were made."""
    with empty.begin() as connection:
        connection.execute(text("CREATE TABLE recommendation (words TEXT)"))
    with pytest.raises(StoreError, match=r"stays as it was.*recommendation"):
        upgrade(empty)
    assert inspect(empty).get_table_names() == ["recommendation"]
    assert current(empty) is None


def test_a_password_is_not_shown() -> None:
    closed = open_database("postgresql://keeper:sesame@127.0.0.1:1/kouros")
    with pytest.raises(StoreError, match="cannot be read") as refused:
        upgrade(closed)
    assert "sesame" not in str(refused.value)
    # Nothing of the library's own: who reads it on the landing page keeps a collection.
    assert "SQL:" not in str(refused.value)
    assert "sqlalche.me" not in str(refused.value)


def test_what_another_program_holds_is_told_as_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pipeline.collection.database.PATIENCE_S", 0.1)
    engine = open_database(tmp_path / "kouros.sqlite")
    upgrade(engine)
    with closing(sqlite3.connect(tmp_path / "kouros.sqlite")) as other:
        other.execute("PRAGMA locking_mode = EXCLUSIVE")
        other.execute("BEGIN EXCLUSIVE")
        with pytest.raises(DatabaseFileError, match=r"held by another program.*close what has it open") as refused:
            current(engine)
    assert "PRAGMA" not in str(refused.value)
