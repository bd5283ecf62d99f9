"""The sheet of decisions, and the folder that a night reads: what is taken, what comes back; no file ends a night."""

from __future__ import annotations

import os
import time
from datetime import date, datetime, timedelta
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from pipeline.collection.database import open_database
from pipeline.records import DecisionKind
from pipeline.report.files.survey_sheet import DECISIONS_SHEET
from pipeline.settings import load_settings
from pipeline.store.decisions import read_decisions
from pipeline.tools.inbox import OPEN, InboxFile, take_inbox
from tests.museum import edit, kouros

from .surveyed import OBJECTS, fill, inventory, write_rows

pytestmark = pytest.mark.slow_file

TODAY = datetime.now().date()
GOOD = {
    "object_number": OBJECTS[0],
    "decision": "accept",
    "why": "The case is rebuilt",
    "who": "Ann",
    "date": "2025-05-01",
}

REFUSED: list[tuple[dict[str, Any], str, str]] = [
    ({"object_number": "9999"}, "object_number", "no object"),
    ({"decision": "forget it"}, "decision", "is no decision"),
    ({"decision": None}, "decision", "is no decision"),
    ({"why": None}, "why", "is empty"),
    ({"why": "   "}, "why", "is empty"),
    ({"who": None}, "who", "is empty"),
    ({"date": None}, "date", "is empty"),
    ({"date": "next May"}, "date", "next May"),
    ({"date": "01/05/2025"}, "date", "01/05/2025"),
    ({"date": (TODAY + timedelta(days=40)).isoformat()}, "date", "future"),
    ({"date": "=TODAY()"}, "date", "formula"),
    ({"object_number": None}, "object_number", "is empty"),
    ({"decision": "verdict pass"}, "model", "in the column model which verdict"),
    ({"until": "some day"}, "until", "some day"),
    ({"model": "no such model"}, "model", "no such model"),
    ({"what": 'a="b'}, "what", "quotation mark"),
    ({"decision": "withdraw", "what": "77"}, "what", "77"),
]
"""What differs from a good row, the column that is marked, and words of the reason."""


def decided(museum: Path) -> list[tuple[str, DecisionKind, str, str, str]]:
    return [
        (one.object_number, one.kind, one.why, one.who, one.date)
        for one in read_decisions(open_database(museum / "kouros.sqlite"))
    ]


def test_what_came_of_each_decision(museum: Path) -> None:
    real_date = GOOD | {"object_number": OBJECTS[1], "decision": " Accept ", "date": date(2025, 5, 2)}
    rows = [GOOD, real_date, GOOD, *(GOOD | change for change, _, _ in REFUSED)]
    write_rows(museum / "s.xlsx", DECISIONS_SHEET, *rows)
    dry = kouros("import", "s.xlsx", "--sheet", "--dry-run", folder=museum)
    assert dry.returncode == 0, dry.stderr
    assert decided(museum) == []
    done = kouros("import", "s.xlsx", "--sheet", folder=museum)
    assert done.returncode == 0, done.stderr
    told = [
        (OBJECTS[0], DecisionKind.ACCEPT, "The case is rebuilt", "Ann", "2025-05-01"),
        (OBJECTS[1], DecisionKind.ACCEPT, "The case is rebuilt", "Ann", "2025-05-02"),
    ]
    assert sorted(decided(museum)) == sorted(told)
    assert "1 decision had been written down before" in done.stdout
    sheet = openpyxl.load_workbook(museum / "s-refused.xlsx")[DECISIONS_SHEET]
    names = [cell.value for cell in sheet[2]]
    marked = {
        (cell.row, names[cell.column - 1]): cell.comment.text
        for row in sheet.iter_rows(min_row=3)
        for cell in row
        if cell.comment is not None
    }
    first = 3 + len(rows) - len(REFUSED)
    assert list(marked) == [(first + n, column) for n, (_, column, _) in enumerate(REFUSED)]
    for (change, _, why), text in zip(REFUSED, marked.values(), strict=True):
        assert why in text, change
    # Once more: nothing is written down twice.
    again = kouros("import", "s.xlsx", "--sheet", folder=museum)
    assert "3 decisions had been written down before" in again.stdout
    assert sorted(decided(museum)) == sorted(told)
    # The copy is mended and given back.
    book = openpyxl.load_workbook(museum / "s-refused.xlsx")
    for at in range(first, first + len(REFUSED)):
        for name in names:
            book[DECISIONS_SHEET].cell(at, names.index(name) + 1).value = None
    for name, value in (GOOD | {"object_number": OBJECTS[3]}).items():
        book[DECISIONS_SHEET].cell(first, names.index(name) + 1).value = value
    book.save(museum / "s-refused.xlsx")
    last = kouros("import", "s-refused.xlsx", "--sheet", folder=museum)
    assert last.returncode == 0, last.stderr
    assert OBJECTS[3] in {one[0] for one in decided(museum)}


# ----------------------------------------------------------------------------------------------------------------------
# The folder that a night reads


@pytest.fixture
def inbox(museum: Path) -> Path:
    folder = museum / "inbox"
    folder.mkdir()
    edit(museum / "kouros.toml", 'inbox = ""', 'inbox = "inbox"')
    return folder


def look(museum: Path, **more: Any) -> dict[str, InboxFile]:
    config = museum / "kouros.toml"
    return {one.name: one for one in take_inbox(load_settings(config), config, **more)}


def aged(file: Path, seconds: float = 3600.0) -> Path:
    """Let a file be as if it had been put there a while ago."""
    os.utime(file, (time.time() - seconds, time.time() - seconds))
    return file


@pytest.mark.long("test_a_night_takes_the_folder_up_and_goes_on")
def test_files_are_taken_the_oldest_first_and_put_away(museum: Path, inbox: Path) -> None:
    fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "30"}, into=inbox / "b.xlsx")
    fill(
        museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "40", (OBJECTS[1], "height [cm]"): "x"}, into=inbox / "a.xlsx"
    )
    aged(inbox / "b.xlsx", 7200)
    aged(inbox / "a.xlsx", 3600)
    dry = look(museum, dry_run=True)
    assert [one.ok for one in dry.values()] == [True, True]
    assert sorted(one.name for one in inbox.iterdir()) == ["a.xlsx", "b.xlsx"]
    assert inventory(museum)[OBJECTS[0]].height_m is None
    took = look(museum)
    assert list(took) == ["b.xlsx", "a.xlsx"]
    assert took["b.xlsx"].words == "taken up: 1 object given measurements"
    assert "1 refused cell (see " in took["a.xlsx"].words
    # The later of two files on one object holds.
    assert inventory(museum)[OBJECTS[0]].height_m == 0.4
    assert sorted(one.name for one in inbox.iterdir()) == ["refused", "taken"]
    assert len(list((inbox / "taken").iterdir())) == 2
    assert [one.name for one in (inbox / "refused").iterdir()] == ["a-refused.xlsx"]
    # The same file once more changes nothing.
    fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "40"}, into=inbox / "a.xlsx")
    assert look(museum)["a.xlsx"].ok
    assert inventory(museum)[OBJECTS[0]].height_m == 0.4
    assert len(list((inbox / "taken").iterdir())) == 3
    assert look(museum) == {}


def test_what_is_no_survey_is_refused_with_its_reason_and_ends_nothing(museum: Path, inbox: Path) -> None:
    good = fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "30"}, into=inbox / "good.xlsx")
    content = good.read_bytes()
    (inbox / "half.xlsx").write_bytes(content[: len(content) // 2])
    (inbox / "empty.xlsx").write_bytes(b"")
    (inbox / "text.xlsx").write_text("no workbook", encoding="utf-8")
    (inbox / "other.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    (inbox / "libre.ods").write_bytes(content)
    openpyxl.Workbook().save(inbox / "blank.xlsx")
    (inbox / "line\nbreak.xlsx").write_bytes(b"PK")
    (inbox / "..xlsx").write_bytes(b"PK")
    (inbox / ("n" * 240 + ".xlsx")).write_bytes(b"PK")
    (inbox / "~$good.xlsx").write_bytes(b"lock")
    (inbox / ".hidden.xlsx").write_bytes(b"x")
    (inbox / "notes.txt").write_text("hello", encoding="utf-8")
    (inbox / "folder.xlsx").mkdir()
    (inbox / "link.xlsx").symlink_to(museum / "s.xlsx")
    (inbox / "nowhere.xlsx").symlink_to(museum / "nowhere")
    os.mkfifo(inbox / "pipe.xlsx")
    (inbox / "mailed.zip").write_bytes(content)
    for file in inbox.iterdir():
        if file.is_file() and not file.is_symlink():
            aged(file)
    # A lock that old was left by a crash.
    aged(inbox / "~$good.xlsx", 2.0 * OPEN)
    took = look(museum)
    assert took["mailed.zip"].words.endswith("take the workbook out of it")
    bad = {"half.xlsx", "empty.xlsx", "text.xlsx", "other.csv", "blank.xlsx", "line?break.xlsx", "n" * 240 + ".xlsx"}
    bad |= {"libre.ods", "mailed.zip"}
    assert {name for name, one in took.items() if not one.ok} == bad
    assert {name for name, one in took.items() if one.ok} == {"good.xlsx"}
    assert inventory(museum)[OBJECTS[0]].height_m == 0.3
    left = {
        "~$good.xlsx",
        ".hidden.xlsx",
        "..xlsx",
        "notes.txt",
        "folder.xlsx",
        "link.xlsx",
        "nowhere.xlsx",
        "pipe.xlsx",
    }
    assert {one.name for one in inbox.iterdir()} == {*left, "taken", "refused"}
    put = sorted(one.name for one in (inbox / "refused").iterdir())
    assert len(put) == 2 * len(bad)
    assert all("\n" not in one.words for one in took.values())
    (why,) = [one for one in (inbox / "refused").iterdir() if one.name.endswith("other.csv.txt")]
    assert "other.csv" in why.read_text(encoding="utf-8")
    assert look(museum) == {}


def test_a_file_that_is_still_on_its_way_waits(museum: Path, inbox: Path) -> None:
    content = fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "30"}, into=museum / "t.xlsx").read_bytes()
    (inbox / "t.xlsx").write_bytes(content[:2000])
    assert "is left there until the next night, as it is new" in look(museum)["t.xlsx"].words
    assert [one.name for one in inbox.iterdir()] == ["t.xlsx"]
    (inbox / "t.xlsx").write_bytes(content)
    assert look(museum)["t.xlsx"].ok


@pytest.mark.parametrize("lock", ["~$t.xlsx", ".~lock.t.xlsx#"])
def test_a_workbook_that_somebody_has_open_waits(museum: Path, inbox: Path, lock: str) -> None:
    """Excel and LibreOffice put a lock beside it, which goes when it is closed."""
    fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "30"}, into=inbox / "t.xlsx")
    aged(inbox / "t.xlsx")
    (inbox / lock).write_bytes(b"Ann")
    assert look(museum)["t.xlsx"].words == "is left there until the next night: somebody has it open"
    assert sorted(one.name for one in inbox.iterdir()) == sorted(["t.xlsx", lock])
    (inbox / lock).unlink()
    assert look(museum)["t.xlsx"].ok


def test_a_folder_that_is_no_place_to_write_ends_nothing(museum: Path, inbox: Path) -> None:
    fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "30"}, into=inbox / "a.xlsx")
    (inbox / "taken").write_text("a file of that name", encoding="utf-8")
    told = look(museum)["a.xlsx"]
    assert "taken" in told.words
    assert inventory(museum)[OBJECTS[0]].height_m == 0.3
    inbox.rename(museum / "elsewhere")
    (said,) = look(museum).values()
    assert not said.ok


def test_a_night_takes_the_folder_up_and_goes_on(museum: Path, inbox: Path) -> None:
    cells = {(OBJECTS[n], f"{side} [cm]"): "30" for n in range(2) for side in ("height", "width")}
    aged(fill(museum / "s.xlsx", cells, into=inbox / "a.xlsx"))
    aged(inbox / "a.xlsx")
    (inbox / "b.xlsx").write_bytes(b"PK\x03\x04 broken")
    aged(inbox / "b.xlsx")
    done = kouros("-q", "run", folder=museum)
    assert done.returncode == 0, done.stderr
    assert "a.xlsx: taken up: 2 objects given measurements" in done.stdout
    assert "b.xlsx: refused: " in done.stdout
    assert inventory(museum)[OBJECTS[1]].width_m == 0.3
