"""A first mapping, guessed from a database, or from a workbook of several sheets; databases are only read."""

from __future__ import annotations

import hashlib
from pathlib import Path

import openpyxl
import pytest
from sqlalchemy import create_engine, text

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.night.importing import presets, proposed

COLUMNS = '"ObjectNumber" TEXT, "Location" TEXT, "Title" TEXT, "Height (cm)" DOUBLE PRECISION, "Provenance" TEXT'
ROWS = "('19.1', 'Hall 1', 'Vase', 20.5, 'bought'), ('19.2', 'Hall 2', 'Bowl', 8, 'given')"


def fill(url: str, *names: str) -> None:
    engine = create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    with engine.begin() as connection:
        for name in names:
            connection.execute(text(f"CREATE TABLE {name} ({COLUMNS})"))
            connection.execute(text(f"INSERT INTO {name} VALUES {ROWS}"))  # noqa: S608 - names of this test
    engine.dispose()


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database of either kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'tms.sqlite'}"
    where: str = request.getfixturevalue("postgresql_url")
    engine = create_engine(where.replace("postgresql://", "postgresql+psycopg://"))
    with engine.begin() as connection:
        connection.execute(text("DROP SCHEMA public CASCADE"))
        connection.execute(text("DROP SCHEMA IF EXISTS tms CASCADE"))
        connection.execute(text("CREATE SCHEMA public"))
    engine.dispose()
    return where


def test_the_only_table_of_a_database_is_guessed_from(url: str) -> None:
    fill(url, "objects")
    found = proposed(url)
    assert (found.rows, found.items, found.guess.mapping.source.table) == (2, 2, "objects")
    assert {name: m.column for name, m in found.guess.mapping.columns.items()} == {
        "object_number": "ObjectNumber",
        "gallery": "Location",
        "title": "Title",
        "height_m": "Height (cm)",
    }
    # What it proposes reads the database as it stands.
    assert [item.height_m for item in read_items(url, found.guess.mapping).items] == [0.205, 0.08]


def test_of_several_tables_one_must_be_named(url: str) -> None:
    fill(url, "objects", "loans")
    schema = url.startswith("postgresql")
    if schema:
        engine = create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
        with engine.begin() as connection:
            connection.execute(text("CREATE SCHEMA tms"))
        engine.dispose()
        fill(url, "tms.things")
    with pytest.raises(CollectionError) as asked:
        guess(url)
    assert "say by --table which of its tables holds the objects" in str(asked.value)
    assert str(asked.value).endswith("it has 'loans', 'objects'" + (", 'tms.things'" if schema else ""))
    with pytest.raises(CollectionError, match="has no table or view 'object'"):
        guess(url, "object")
    assert guess(url, "loans").mapping.source.table == "loans"
    if schema:
        assert guess(url, "tms.things").mapping.source.table == "tms.things"
    query = 'SELECT "ObjectNumber" AS object_number, "Title" FROM objects'
    found = guess(url, query)
    assert (found.mapping.source.query, found.mapping.source.table) == (query, None)
    assert len(read_items(url, found.mapping).items) == 2


def test_a_guess_writes_nothing_to_a_database(tmp_path: Path) -> None:
    where = f"sqlite:///{tmp_path / 'tms.sqlite'}"
    fill(where, "objects")
    before = hashlib.sha256((tmp_path / "tms.sqlite").read_bytes()).hexdigest()
    proposed(where)
    with pytest.raises(CollectionError, match="it would write"):
        guess(where, "WITH gone AS (SELECT 1) DELETE FROM objects RETURNING *")
    assert hashlib.sha256((tmp_path / "tms.sqlite").read_bytes()).hexdigest() == before
    assert [path.name for path in tmp_path.iterdir()] == ["tms.sqlite"]


@pytest.fixture
def workbook(tmp_path: Path) -> Path:
    """A workbook whose objects are on its second sheet."""
    book = openpyxl.Workbook()
    first = book.worksheets[0]
    first.title = "Read me"
    first.append(["This workbook", "is ours"])
    objects = book.create_sheet("Objects")
    objects.append(["Object Number", "Location", "Title", "Height (cm)"])
    for number in range(20):
        first.append(["text", number])
        objects.append([f"19.{number}", "Hall", "Vase", 20 + number])
    book.create_sheet("Empty")
    book.create_sheet("Old").sheet_state = "hidden"
    path = tmp_path / "museum.xlsx"
    book.save(path)
    return path


def test_of_several_sheets_the_one_like_an_inventory_is_taken_and_named(workbook: Path) -> None:
    found = guess(workbook)
    assert found.mapping.source.sheet == "Objects"
    (said,) = (doubt for doubt in found.doubts if "sheets" in doubt)
    assert said.startswith("of 3 sheets 'Objects' looks most like the inventory and is read; --table takes another:")
    assert len(read_items(workbook, found.mapping).items) == 20
    with pytest.raises(CollectionError, match="has no sheet 'Things'; name one of its sheets: 'Read me', 'Objects'"):
        guess(workbook, "Things")
    with pytest.raises(CollectionError, match="3 visible sheets; say which one to read: sheet = "):
        read_items(
            workbook,
            found.mapping.model_copy(update={"source": found.mapping.source.model_copy(update={"sheet": None})}),
        )


def test_a_workbook_read_as_text_says_so(workbook: Path) -> None:
    with pytest.raises(
        CollectionError, match=r'an Excel workbook, and the mapping carnegie reads csv; say format = "xlsx"'
    ):
        read_items(workbook, load_mapping("carnegie"))


def test_a_table_of_a_text_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("object_number,title\n1,a\n", encoding="utf-8")
    with pytest.raises(CollectionError, match=r"a.csv: has neither sheets nor tables"):
        guess(tmp_path / "a.csv", "objects")


def test_a_preset_names_its_file_which_can_be_copied_and_used(tmp_path: Path) -> None:
    for name, preset in presets().items():
        copy = tmp_path / "ours.toml"
        copy.write_bytes(preset.file.read_bytes())
        ours = load_mapping(copy)
        assert ours.columns == load_mapping(name).columns
        assert ours.museum.name == preset.about
        assert len(preset.expects) > 20
