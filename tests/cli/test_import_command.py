"""`kouros import` and `kouros survey` as processes, on real rows: sources, versions, guesses, bad inputs."""

from __future__ import annotations

import csv
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from shutil import copy

import openpyxl
import pytest
from sqlalchemy import create_engine, text

from pipeline.collection.database import open_database
from pipeline.collection.inventory import read_inventory
from pipeline.collection.mapping import preset_names
from tests.collection.sources.lido_files import measured, measurements, record, wrap
from tests.museum import kouros, workspace

pytestmark = pytest.mark.slow_file

DATA = Path(__file__).parents[1] / "data" / "collections"

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run the command beside a kouros.toml of its own."""
    workspace(tmp_path)
    return lambda *words: kouros(*words, folder=tmp_path)


def numbers(folder: Path) -> list[str]:
    return [item.object_number for item in read_inventory(open_database(folder / "kouros.sqlite"))]


def test_a_dry_run_shows_what_would_change_and_writes_nothing(run: Run, tmp_path: Path) -> None:
    copy(DATA / "moma_rows.csv", tmp_path / "moma.csv")
    done = run("import", "moma.csv", "--mapping", "moma")
    assert "inventory: 25 objects (25 new, 0 gone, 0 changed)" in done.stdout
    (log,) = (tmp_path / "imports").iterdir()
    rows = list(csv.DictReader(log.open(encoding="utf-8")))
    assert next(row["object_number"] for row in rows if row["what"] == "new") == "177.1958.a-f"
    assert {(row["row"], row["what"], row["field"]) for row in rows} >= {("1", "problem", "mass_kg")}
    content = (tmp_path / "moma.csv").read_bytes()
    (tmp_path / "moma.csv").write_bytes(content.replace(b'14 x 18"" (35.6 x 45.7 cm)', b"14 x 19 in.", 1))
    dry = json.loads(run("import", "moma.csv", "--mapping", "moma", "--dry-run", "--json").stdout)
    ((number, fields),) = dry["changes"]["changed"].items()
    assert number == "3.1995.1"
    assert fields["width_m"] == [0.4572, 0.4826]
    assert fields["dimensions"][1] == "14 x 19 in."
    assert json.loads(run("import", "--versions", "--json").stdout)[0]["id"] == 1
    again = run("import", "moma.csv", "--mapping", "moma")
    assert "changed: 3.1995.1: width_m: 0.4572 -> 0.4826" in again.stdout
    same = run("import", "moma.csv", "--mapping", "moma")
    assert "nothing has changed since the last import" in same.stdout
    back = run("import", "--return-to", "1")
    assert "25 objects, as after import 1 (0 new, 0 gone, 1 changed)" in back.stdout


def test_a_guess_is_shown_and_written_where_told(run: Run, tmp_path: Path) -> None:
    copy(DATA / "tms_rows_cut_off.csv", tmp_path / "tms.csv")
    shown = run("import", "tms.csv", "--guess")
    assert shown.returncode == 0
    assert "26 rows, 25 objects, 1 refused, 5 doubtful; 10 of them as understood:" in shown.stdout
    assert "refused: tms.csv, row 26 (line 27): not a row of a CSV file" in shown.stdout
    assert "76.37.5.K | Location not recorded | bracelet, 'Single-coil Bracelet', bronze" in shown.stdout
    # Sheet, from its own columns of the file: 19 7/8 x 13 11/16 in.
    assert "81.12.1.E | Location not recorded | print" in shown.stdout
    assert "H 50.5 x W 34.7 cm" in shown.stdout
    assert "nothing was written" in shown.stdout
    assert run("import", "tms.csv", "--guess", "--write", "ours.toml").returncode == 0
    done = run("import", "tms.csv", "--mapping", "ours.toml")
    assert "26 rows, 25 objects, 1 rejected" in done.stdout
    assert "row 26 (line 27): not a row of a CSV file" in done.stdout
    twice = run("import", "tms.csv", "--guess", "--write", "ours.toml")
    assert twice.returncode != 0


def test_lido_and_a_database_by_their_mappings(run: Run, tmp_path: Path) -> None:
    sizes = measurements(measured("Höhe", "32,5"), measured("Breite", "12"))
    (tmp_path / "museum.xml").write_bytes(wrap(record(number="L 1", sizes=sizes, language="de")))
    assert "1 row, 1 object" in run("import", "museum.xml", "--mapping", "lido").stdout
    engine = create_engine(f"sqlite:///{tmp_path / 'museum.sqlite'}")
    with engine.begin() as connection:
        connection.execute(text('CREATE TABLE "o; DROP" (nr TEXT, room TEXT, size TEXT)'))
        connection.execute(text("INSERT INTO \"o; DROP\" VALUES ('S 1', 'Hall', 'H 10 x W 5 cm'), ('S 2', NULL, '')"))
    engine.dispose()
    (tmp_path / "sql.toml").write_text(
        '[source]\nformat = "sql"\ntable = "o; DROP"\n[museum]\nname = "M"\n[columns]\nobject_number.column = "nr"\n'
        'gallery.column = "room"\n[dimensions]\ncolumns = ["size"]\n',
        encoding="utf-8",
    )
    before = (tmp_path / "museum.sqlite").read_bytes()
    done = run("import", f"sqlite:///{tmp_path / 'museum.sqlite'}", "--mapping", "sql.toml", "--shrink-limit", "1")
    assert "2 rows, 2 objects, 0 rejected" in done.stdout
    assert numbers(tmp_path) == ["S 1", "S 2"]
    assert (tmp_path / "museum.sqlite").read_bytes() == before
    wrong = run("import", f"sqlite:///{tmp_path / 'museum.sqlite'}", "--mapping", "moma")
    assert wrong.returncode == 5
    assert 'say format = "sql"' in wrong.stderr


ENTITIES = b"""<?xml version="1.0"?><!DOCTYPE l [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<lido:lido xmlns:lido="http://www.lido-schema.org"><lido:lidoRecID>&b;</lido:lidoRecID></lido:lido>"""


def test_what_cannot_be_read_changes_nothing(run: Run, tmp_path: Path) -> None:
    copy(DATA / "moma_rows.csv", tmp_path / "moma.csv")
    run("import", "moma.csv", "--mapping", "moma")
    kept = numbers(tmp_path)
    (tmp_path / "bomb.xml").write_bytes(ENTITIES)
    (tmp_path / "cut.xml").write_bytes(wrap(record(), record(number="A 2"))[:-40])
    (tmp_path / "not.xlsx").write_bytes(b"PK\x03\x04 and no more")
    for source, mapping in (("bomb.xml", "lido"), ("cut.xml", "lido"), ("not.xlsx", "collectiveaccess")):
        done = run("import", source, "--mapping", mapping)
        assert done.returncode == 5, done.stderr
        assert done.stderr.startswith(f"kouros: {source}")
        assert "Traceback" not in done.stderr
    hidden = run("import", "postgresql://keeper:sesame@127.0.0.1:1/tms", "--mapping", "moma")
    assert hidden.returncode == 5
    assert "sesame" not in hidden.stderr + hidden.stdout
    assert numbers(tmp_path) == kept


def test_one_thing_at_a_time(run: Run) -> None:
    for words in (["import"], ["import", "a.csv", "--versions"], ["import", "--presets", "--return-to", "1"]):
        done = run(*words)
        assert done.returncode == 2
        assert "give a SOURCE, or one of" in done.stderr
    listed = run("import", "--presets").stdout
    told, files, copying = listed.split("\n\n")
    assert [line.split()[0] for line in told.splitlines() if not line.startswith(" ")] == preset_names()
    assert [Path(line.split()[1]).stem for line in files.splitlines()[1:]] == preset_names()
    assert all(Path(line.split()[1]).is_file() for line in files.splitlines()[1:])
    assert copying.startswith("copy one (")
    absent = run("import", "--return-to", "7")
    assert absent.returncode == 5
    assert "nothing was imported yet" in absent.stderr


def test_a_survey_is_printed_filled_in_and_read_back(run: Run, tmp_path: Path) -> None:
    run("import", "export.csv")
    done = run("-q", "survey", "--out", "s.xlsx", "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    first = found["wishes"][0]
    assert (first["object_number"], first["field"], first["unlocks"] > 0) == ("3", "height_m", True)
    book = openpyxl.load_workbook(tmp_path / "s.xlsx")
    sheet = book["survey in cm"]
    keys = [cell.value for cell in sheet[2]]
    row = next(r for r in range(3, sheet.max_row + 1) if sheet.cell(r, 1).value == "3")
    sheet.cell(row, keys.index("height [cm]") + 1).value = 41
    rule = {
        "number": "*",
        "states": "clearance_m",
        "value": 12,
        "unit": "cm",
        "said_by": "Ann",
        "said_on": "2031-05-01",
    }
    keys = [cell.value for cell in book["Rules"][2]]
    row = next(r for r in range(3, 100) if not book["Rules"].cell(r, keys.index("states") + 1).value)
    for name, value in rule.items():
        book["Rules"].cell(row, keys.index(name) + 1).value = value
    book.save(tmp_path / "s.xlsx")
    read = run("import", "s.xlsx", "--sheet")
    assert "changed: 3: height_m: null -> 0.41" in read.stdout
    assert 'added to kouros.toml:\n\n[[house]]\nnumber = "*"\nclearance_m = 0.12\nsaid_by = "Ann"' in read.stdout
    told = run("run", "--explain", "3")
    assert "0.12 m, stated: clearance: by the house rule for number * [Ann, 2031-05-01]" in told.stdout
    # The night reads the museum's file again: what was measured stays.
    night = run("-q", "run")
    assert night.returncode == 0, night.stderr
    items = {item.object_number: item for item in read_inventory(open_database(tmp_path / "kouros.sqlite"))}
    assert items["3"].height_m == 0.41


def test_doubts_are_told_by_what_mends_them_and_a_longitude_is_none(run: Run, tmp_path: Path) -> None:
    """Truth by hand: of five rows three have no place, and where on the earth they are is nobody's length."""
    rows = ["1,A,Room 1,41.9,8.7,10 cm", "2,A,,41.9,8.7,10 cm", "3,A,,41.9,8.7,10 cm", "4,A,,41.9,8.7,no size here"]
    mapping = """[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Ours"
[columns.object_number]
column = "number"
[columns.title]
column = "title"
[columns.gallery]
column = "place"
[dimensions]
columns = ["size"]
"""
    (tmp_path / "m.toml").write_text(mapping, encoding="utf-8")
    (tmp_path / "e.csv").write_text("\n".join(["number,title,place,lat,long,size", *rows, ""]), encoding="utf-8")
    told = run("import", "e.csv", "--mapping", "m.toml", "--dry-run").stdout
    assert told.count("the location is empty") == 1
    assert "row 2, 2: gallery: the location is empty" in told
    assert "(3 such)" in told
    assert "'long'" not in told
    assert "new: 1" not in told
    # Without a latitude beside it, it may be a length.
    (tmp_path / "e.csv").write_text("\n".join(["number,title,place,up,long,size", *rows, ""]), encoding="utf-8")
    assert (
        "column 'long': its '8.7' is in no field" in run("import", "e.csv", "--mapping", "m.toml", "--dry-run").stdout
    )


def test_a_museum_without_places_is_told_that_nothing_is_on_display(run: Run, tmp_path: Path) -> None:
    (tmp_path / "e.csv").write_text("object_number,gallery,title\n1,,A\n2,,B\n", encoding="utf-8")
    told = run("import", "e.csv", "--mapping", "kouros", "--dry-run").stdout
    assert "nothing is on display, and a night would have nothing to assess" in told
    assert 'constant = "Gallery 1" in place of column' in told
