"""`kouros import --guess` asks a person at a terminal what the file does not tell, and lists it to anything else."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

import pytest

from pipeline.quantities import LENGTHS
from tests.warm import kouros_process

EXPORT = "Inventarnummer;Objekt-ID;Titel;Standort;Höhe\n" + "".join(
    f"V {at}.1;{900 + at};Krug;Saal {1 + at % 3};{12 + at},5\n" for at in range(20)
)
COMMAND = ("-q", "import", "krug.csv", "--guess")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "krug.csv").write_text(EXPORT, encoding="utf-8")
    return tmp_path


@pytest.mark.skipif(os.name == "nt", reason="Windows has no pseudo-terminals in Python's library")
@pytest.mark.parametrize(
    ("answers", "number", "unit"),
    [("2\n1\ny\n", "Objekt-ID", next(iter(LENGTHS))), ("\n\ny\n", "Inventarnummer", "cm")],
)
def test_a_terminal_is_asked(answers: str, number: str, unit: str, folder: Path) -> None:
    """Open are the column of the numbers and the unit of a height; an empty answer keeps what was guessed."""
    ours, theirs = os.openpty()
    try:
        os.write(ours, answers.encode())
        done = kouros_process(COMMAND, folder, terminal=theirs)
    finally:
        os.close(ours)
        os.close(theirs)
    assert done.returncode == 0, done.stderr
    assert "which column has the object numbers?" in done.stdout
    assert "in which unit" in done.stdout
    with (folder / "krug.toml").open("rb") as stream:
        mapping = tomllib.load(stream)
    assert mapping["columns"]["object_number"]["column"] == number
    assert mapping["columns"]["height_m"]["unit"] == unit


def test_without_a_terminal_it_is_listed(folder: Path) -> None:
    done = kouros_process(COMMAND, folder)
    assert done.returncode == 0, done.stderr
    assert "to choose: which column has the object numbers? 'Inventarnummer' is taken; --choose" in done.stdout
    assert "to choose: in which unit" in done.stdout
    assert "nothing was written; --write FILE writes it" in done.stdout
    assert [path.name for path in folder.iterdir()] == ["krug.csv"]
