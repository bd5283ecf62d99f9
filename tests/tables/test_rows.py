"""Rows checked by models: what a row says, and what an editor of a table is told."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from pipeline.analysis.rule_table import with_own
from pipeline.resources import SMALL
from pipeline.tables import TableError, read_table
from pipeline.tables.rows import Entries, Number, Optional, checked, once

HEADER = "rule,class,aat,classification,words,medium,shape,why\n"


@dataclass(frozen=True)
class Thing:
    name: str
    size: Number
    room: Optional
    words: Entries


ROW = {"name": "vase", "size": "0.25", "room": "", "words": " a | |b", "note": "not of the model"}


def test_cells_become_values_and_other_columns_are_left_aside() -> None:
    assert checked(Thing, [ROW, {**ROW, "room": "2"}], "things.csv") == (
        Thing("vase", 0.25, None, ("a", "b")),
        Thing("vase", 0.25, 2.0, ("a", "b")),
    )


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ({"size": "wide"}, r"^things.csv, line 3, name 'vase': column 'size': .* valid number.*, not 'wide'$"),
        ({"size": ""}, r"column 'size': .* valid number.*, not ''$"),
        ({"size": "nan"}, r"column 'size': .* finite number, not 'nan'$"),
        ({"room": "inf"}, r"column 'room': .* finite number, not 'inf'$"),
        ({"size": "9" * 100_000}, r"column 'size': .{1,200}$"),
        ({"name": "v" * 100_000, "size": "x"}, r"^.{1,300}$"),
    ],
)
def test_what_a_row_does_not_hold_is_named(cells: dict[str, str], message: str) -> None:
    with pytest.raises(TableError, match=message):
        checked(Thing, [ROW, {**ROW, **cells}], "things.csv", named="name")


def test_a_column_that_is_missing_is_named() -> None:
    row = {key: cell for key, cell in ROW.items() if key != "size"}
    with pytest.raises(TableError, match=r"^things.csv, line 2: column 'size': there is no such column$"):
        checked(Thing, [row], "things.csv")


def test_a_name_that_stands_twice_is_named_with_both_lines() -> None:
    with pytest.raises(TableError, match=r"things.csv, line 4, name 'a': column 'name': line 2 has this name"):
        once(["a", "b", "a"], "name", "things.csv")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b,a\n1,2,3\n", "t.csv, line 1: column 'a' is there twice"),
        ('a,b\n"1,2\n', "t.csv: no CSV file in UTF-8"),
        ("a,b\n1,2,3\n", "t.csv, line 2: not as many cells"),
        (f"a,b\n1,{'x' * 200_000}\n", "t.csv: no CSV file in UTF-8: field larger"),
    ],
)
def test_what_is_no_table_is_named(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(text, encoding="utf-8")
    with pytest.raises(TableError, match=message):
        read_table(tmp_path / "t.csv")


def test_a_table_is_no_larger_than_what_a_person_writes(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_bytes(b"a\n" + b"1\n" * (SMALL // 2))
    with pytest.raises(TableError, match=r"t.csv: more than 8,388,608 bytes"):
        read_table(tmp_path / "t.csv")


@pytest.mark.parametrize(
    ("cells", "column"),
    [
        ("x,{long},,,beacon,,,y", "class"),
        ("x,vessel,{long},,,,,y", "aat"),
        ("x,vessel,,,***{long},,,y", "words"),
        ("x,vessel,,,beacon,,{long},y", "shape"),
        ("{long}:,vessel,,,beacon,,,y", "rule"),
        ("\x00,vessel\x1b[2J,,,,,,y", "class"),
    ],
)
def test_hostile_rules_of_a_museum_are_refused_in_a_sentence(cells: str, column: str, tmp_path: Path) -> None:
    own = tmp_path / "ours.csv"
    own.write_text(HEADER + cells.format(long="x" * 50_000) + "\n", encoding="utf-8")
    with pytest.raises(TableError, match=f"^ours.csv, line 2, rule .*: column '{column}': ") as refused:
        with_own(own)
    assert len(str(refused.value)) < 1_500
    assert "\x1b" not in str(refused.value)
