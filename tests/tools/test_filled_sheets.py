"""A survey's workbook as the command writes it, as a registrar fills it in, and as the command takes it up."""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from collections.abc import Callable
from datetime import date, time
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tests.museum import kouros

from .surveyed import OBJECTS, SHEET, fill, inventory, row_of

pytestmark = pytest.mark.slow_file

TAKEN: list[tuple[Any, float, str]] = [
    ("8 1/2", 0.085, "8 1/2 cm"),
    ("8½", 0.085, "8½ cm"),
    ('8"', 0.2032, '8"'),
    ('8 1/2"', 0.2159, '8 1/2"'),
    ("8-1/2 in", 0.2159, "8-1/2 in"),
    ("3' 2\"", 0.9652, "3' 2\""),
    ("30 cm", 0.3, "30 cm"),
    ("300 mm", 0.3, "300 mm"),
    ("0,3", 0.003, "0,3 cm"),
    ("about 3", 0.03, "3 cm"),
    ("ca. 5", 0.05, "5 cm"),
    ("5 ?", 0.05, "5 cm"),
    (8.5, 0.085, "8.5 cm"),
    (30, 0.3, "30 cm"),
    ("  40\n", 0.4, "40 cm"),
]
"""Cells of the height, in cm where they name no unit; what each is in m, worked out by hand; and how it was written."""

REFUSED: list[tuple[Any, str]] = [
    ("1,234", "may be thousands or decimals"),
    ("1'200", "may be thousands, or feet and inches"),
    ("30, 20", "is more than one number"),
    ("8 9", "is more than one number"),
    ("-3", "is negative"),
    (-3, "is negative"),
    ("10-12", "is no number with a unit that is known"),
    ("1e3", "is no number with a unit that is known"),
    (date(2031, 5, 1), "is a date or a time"),
    (time(8, 30), "is a date or a time"),
    ("=2*4", "holds a formula"),
    (True, "is no number"),
    ("9" * 10_000, "is longer than a number is"),
    ("5 kg", "is no length"),
    ("0", "is zero"),
    ("500 m", "500 m"),
    ("<b>8</b>", "is no number"),
    ('=HYPERLINK("http://x","y")', "holds a formula"),
    ("nan", "is no number"),
    ("#VALUE!", "error"),
]
"""Cells that are no such number, and words of the reason."""


def taken_up(museum: Path, name: str = "s.xlsx", *more: str) -> dict[str, Any]:
    done = kouros("import", name, "--sheet", "--json", *more, folder=museum)
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def test_what_came_of_each_cell(museum: Path) -> None:
    cells = [*((cell, "") for cell, _, _ in TAKEN), *REFUSED]
    filled = {(number, "height [cm]"): cell for number, (cell, _) in zip(OBJECTS, cells, strict=False)}
    assert len(filled) == len(cells)
    fill(museum / "s.xlsx", filled)
    before = inventory(museum)

    dry = taken_up(museum, "s.xlsx", "--dry-run")
    assert inventory(museum) == before
    assert not (museum / "s-refused.xlsx").exists()

    real = taken_up(museum)
    assert {**dry, "marked": ""} == {**real, "marked": ""}
    assert Path(real["marked"]).name == "s-refused.xlsx"
    now = inventory(museum)
    for number, (cell, metres, written) in zip(OBJECTS, TAKEN, strict=False):
        assert now[number].height_m == metres, cell
        (origin,) = now[number].provenance
        assert (origin.field, origin.written) == ("height_m", written)
        assert ("about so" in origin.note) == (cell in ("about 3", "ca. 5", "5 ?"))
    for number in OBJECTS[len(TAKEN) :]:
        assert now[number] == before[number]

    refused = dict(zip(OBJECTS[len(TAKEN) :], REFUSED, strict=False))
    sheet = openpyxl.load_workbook(museum / "s-refused.xlsx")[SHEET]
    at = [cell.value for cell in sheet[2]].index("height [cm]") + 1
    marked = {
        sheet.cell(cell.row, 1).value: (cell.column, cell.comment.text)
        for row in sheet.iter_rows(min_row=3)
        for cell in row
        if cell.comment is not None
    }
    assert marked.keys() == refused.keys()
    for number, (cell, why) in refused.items():
        column, text = marked[number]
        assert column == at
        assert why in text, cell
        # What is wrong, and then what mends it.
        assert len(text.strip().splitlines()[0].split(". ")) >= 2

    # The copy is mended and laid over: what was taken stays, what was refused is there, and no mark is left.
    mended = {(number, "height [cm]"): "12" for number in refused}
    fill(museum / "s-refused.xlsx", {**mended, (OBJECTS[39], "height [cm]"): "x"})
    again = taken_up(museum, "s-refused.xlsx")
    assert set(again["changes"]["changed"]) == set(refused)
    assert [fault["row"] for fault in again["refused"]] == [row_of(sheet, OBJECTS[39])]
    last = inventory(museum)
    assert {last[number].height_m for number in refused} == {0.12}
    assert [last[number].height_m for number in OBJECTS[: len(TAKEN)]] == [metres for _, metres, _ in TAKEN]
    sheet = openpyxl.load_workbook(museum / "s-refused.xlsx")[SHEET]
    assert [c.coordinate for row in sheet for c in row if c.comment] == [
        sheet.cell(row_of(sheet, OBJECTS[39]), at).coordinate
    ]
    assert not (museum / "s-refused-refused.xlsx").exists()


def test_a_sheet_as_people_change_it(museum: Path) -> None:
    """Merged cells, another sheet, a column less, hidden rows, an object twice and one that nobody knows."""
    fill(museum / "s.xlsx", {(OBJECTS[n], "height [cm]"): f"{n + 10}" for n in range(8)})
    book = openpyxl.load_workbook(museum / "s.xlsx")
    sheet = book[SHEET]
    names = [cell.value for cell in sheet[2]]
    height = names.index("height [cm]") + 1
    row = {number: row_of(sheet, number) for number in OBJECTS[:12]}
    sheet.row_dimensions[row[OBJECTS[1]]].hidden = True
    sheet.cell(row[OBJECTS[2]], 1).value = "nobody knows it"
    # 1922.10 to 1922.12 follow 1922.1 in the sheet's order of texts.
    merged = [sheet.cell(r, 1).value for r in (row[OBJECTS[9]], row[OBJECTS[9]] + 1)]
    sheet.cell(row[OBJECTS[9]], height).value = "77"
    sheet.merge_cells(start_row=row[OBJECTS[9]], end_row=row[OBJECTS[9]] + 1, start_column=height, end_column=height)
    sheet.append([OBJECTS[4], "East", "Vase", "99"])
    sheet.delete_cols(names.index("width [cm]") + 1)
    book.create_sheet("my notes", 0)["A1"] = "what a day"
    book.save(museum / "s.xlsx")
    told = taken_up(museum)
    now = inventory(museum)
    assert [now[OBJECTS[n]].height_m for n in (0, 1, 3, 5, 6, 7)] == [0.10, 0.11, 0.13, 0.15, 0.16, 0.17]
    assert told["unknown"] == ["nobody knows it"]
    assert now[OBJECTS[2]].height_m is None
    # Of one object two rows say two things: the first is taken, and the other refused.
    assert now[OBJECTS[4]].height_m == 0.14
    assert now[merged[0]].height_m == 0.77
    assert now[merged[1]].height_m is None
    words = " ".join(f"{fault['row']}: {fault['message']}" for fault in told["refused"])
    assert "merged cells" in words
    assert "nobody knows it" in words
    assert f"{sheet.max_row}: " in words


def test_a_sheet_of_another_name_is_refused_with_its_remedy(museum: Path) -> None:
    fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): "10"})
    book = openpyxl.load_workbook(museum / "s.xlsx")
    book[SHEET].title = "our measurements"
    book.save(museum / "s.xlsx")
    done = kouros("import", "s.xlsx", "--sheet", folder=museum)
    assert done.returncode != 0
    assert "no sheet of a survey, such as 'survey in cm'" in done.stderr
    assert "'our measurements'" in done.stderr
    assert inventory(museum)[OBJECTS[0]].height_m is None


@pytest.mark.long("test_what_came_of_each_cell")
def test_a_later_sheet_speaks_for_its_own_cells_alone(museum: Path) -> None:
    """Who measured what stays with it, and what says the same again changes nothing."""
    number = OBJECTS[0]
    fill(museum / "s.xlsx", {(number, "height [cm]"): "30"})
    taken_up(museum)
    fill(museum / "s.xlsx", {(number, "height [cm]"): None, (number, "width [cm]"): "about 9"}, into=museum / "t.xlsx")
    assert set(taken_up(museum, "t.xlsx")["changes"]["changed"][number]) == {"width_m", "provenance"}
    told = {of.field: of.note for of in inventory(museum)[number].provenance}
    assert told == {"height_m": "sheet s.xlsx", "width_m": "sheet t.xlsx; said to be about so"}
    for name in ("s.xlsx", "t.xlsx"):
        assert taken_up(museum, name)["changes"]["changed"] == {}
    assert {of.field: of.note for of in inventory(museum)[number].provenance} == told
    # The museum's own file comes again: all stays.
    assert kouros("-q", "import", "export.csv", "--mapping", "mapping.toml", folder=museum).returncode == 0
    assert {of.field: of.note for of in inventory(museum)[number].provenance} == told


def test_refused_cells_of_a_csv_are_listed_beside_it(museum: Path) -> None:
    rows = f"object_number,gallery,height_m\n{OBJECTS[0]},East,1.5\n{OBJECTS[1]},East,tall\n"
    (museum / "ours.csv").write_text(rows, encoding="utf-8")
    assert Path(taken_up(museum, "ours.csv")["marked"]).name == "ours-refused.txt"
    (line,) = (museum / "ours-refused.txt").read_text(encoding="utf-8").splitlines()
    assert "row 3, height_m" in line
    assert "'tall' is no number" in line
    assert inventory(museum)[OBJECTS[0]].height_m == 1.5


def test_a_workbook_in_the_style_of_libreoffice(museum: Path) -> None:
    """It names the kind of every number, gives every row its height, and says that the sheet is 1,024 columns wide."""
    made = fill(museum / "s.xlsx", {(OBJECTS[0], "height [cm]"): 8.5, (OBJECTS[1], "height [cm]"): "8 1/2"})
    other = museum / "libre.xlsx"
    with zipfile.ZipFile(made) as before, zipfile.ZipFile(other, "w", zipfile.ZIP_DEFLATED) as after:
        for name in before.namelist():
            content = before.read(name)
            if name == "xl/worksheets/sheet1.xml":
                text = content.decode()
                text, numbers = re.subn(r'(<c r="[A-Z]+\d+"(?: s="\d+")?)(?: t="n")?><v>', r'\1 t="n"><v>', text)
                assert numbers >= 1
                text, sizes = re.subn(r'<dimension ref="[^"]*"', '<dimension ref="A1:AMJ42"', text)
                assert sizes == 1
                rows = ' customFormat="false" ht="12.8" hidden="false" customHeight="false" outlineLevel="0"'
                text = re.sub(r'<row r="(\d+)"[^>]*>', rf'<row r="\1"{rows}>', text)
                empty = f'<row r="1048576"{rows}></row></sheetData>'
                content = text.replace("</sheetData>", empty).encode()
            after.writestr(name, content)
    assert set(taken_up(museum, "libre.xlsx")["changes"]["changed"]) == set(OBJECTS[:2])
    now = inventory(museum)
    assert [now[number].height_m for number in OBJECTS[:2]] == [0.085, 0.085]


def changed_heads(museum: Path, name: str, change: Callable[[Any, dict[Any, int]], object]) -> Any:
    """A sheet with two heights and a width, whose heads somebody changed."""
    cells = {(OBJECTS[0], "height [cm]"): "30", (OBJECTS[1], "height [cm]"): "40", (OBJECTS[0], "width [cm]"): "12"}
    book = openpyxl.load_workbook(fill(museum / "s.xlsx", cells))
    sheet = book[SHEET]
    change(sheet, {cell.value: cell.column for cell in sheet[2]})
    book.save(museum / name)
    return sheet


def test_what_is_filled_in_below_another_head_is_never_lost_unsaid(museum: Path) -> None:
    """Somebody who measures in inches writes so into a head: the name below it, or the words above."""

    def named(sheet: Any, at: dict[Any, int]) -> None:
        sheet.cell(2, at["height [cm]"]).value = "height [in]"

    def worded(sheet: Any, at: dict[Any, int]) -> None:
        sheet.cell(1, at["height [cm]"]).value = "Height (inches)"

    def noted(sheet: Any, at: dict[Any, int]) -> None:
        sheet.insert_cols(4)
        sheet.cell(1, 4).value = sheet.cell(2, 4).value = "Remarks (in pencil)"

    for change, told in ((named, "call it 'height [cm]' again"), (worded, "say in, its name says cm")):
        changed_heads(museum, "t.xlsx", change)
        answer = taken_up(museum, "t.xlsx", "--dry-run")
        assert {number: list(what) for number, what in answer["changes"]["changed"].items()} == {
            OBJECTS[0]: ["width_m", "provenance"]
        }
        (fault,) = answer["refused"]
        assert fault["row"] == 2
        assert told in f"{fault['message']}; {fault['remedy']}"
    changed_heads(museum, "t.xlsx", noted)
    answer = taken_up(museum, "t.xlsx")
    assert answer["refused"] == []
    assert [inventory(museum)[number].height_m for number in OBJECTS[:2]] == [0.3, 0.4]


def test_heads_that_were_sorted_in_are_asked_back_and_sorting_by_the_arrows_leaves_them(museum: Path) -> None:
    def sort(sheet: Any, _at: dict[Any, int]) -> None:
        rows = sorted(([cell.value for cell in row] for row in sheet.iter_rows(min_row=2)), key=lambda row: str(row[0]))
        for line, row in enumerate(rows, 2):
            for column, value in enumerate(row, 1):
                sheet.cell(line, column).value = value

    sheet = changed_heads(museum, "t.xlsx", sort)
    assert re.fullmatch(rf"A2:[A-Z]+{sheet.max_row}", sheet.auto_filter.ref)
    done = kouros("import", "t.xlsx", "--sheet", folder=museum)
    assert done.returncode != 0
    assert "row 2 does not have the names of the columns" in done.stderr
    assert "mapping" not in done.stderr
    assert inventory(museum)[OBJECTS[0]].height_m is None


def test_a_sheet_comes_back_from_other_programs(museum: Path) -> None:
    """Semicolons where numbers have a decimal comma; and of a kind that is not read nothing but how to save it."""
    for mark in (";", "\t"):
        rows = [["object_number", "gallery", "height_m"], [OBJECTS[0], "East", "1,5"]]
        (museum / "ours.csv").write_text("\n".join(map(mark.join, rows)), encoding="utf-8-sig")
        assert set(taken_up(museum, "ours.csv", "--dry-run")["changes"]["changed"]) == {OBJECTS[0]}
    shutil.copy(museum / "s.xlsx", museum / "s.ods")
    done = kouros("import", "s.ods", "--sheet", folder=museum)
    assert done.returncode != 0
    assert "save it as an .xlsx workbook" in done.stderr


def test_a_word_that_is_none_of_those_and_a_second_row_are_told_as_the_sheet_shows_them(museum: Path) -> None:
    def twice(sheet: Any, at: dict[Any, int]) -> None:
        sheet.append([OBJECTS[0], "East", "Vase"])
        sheet.cell(2, len(at) + 1).value = "support"
        sheet.cell(row_of(sheet, OBJECTS[1]), len(at) + 1).value = "levitating"

    sheet = changed_heads(museum, "t.xlsx", twice)
    told = {fault["row"]: f"{fault['message']}; {fault['remedy']}" for fault in taken_up(museum, "t.xlsx")["refused"]}
    first = row_of(sheet, OBJECTS[0])
    assert f"was given in row {first} already" in told[sheet.max_row]
    assert told[row_of(sheet, OBJECTS[1])].endswith("write one of these words")
