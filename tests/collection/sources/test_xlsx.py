"""A sheet gives the texts that were typed in, and names what was not: formulas, errors, merged cells, bombs."""

from __future__ import annotations

import io
import struct
import time
import zipfile
from collections.abc import Callable
from datetime import date, datetime, timedelta
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from openpyxl.chart import BarChart
from openpyxl.worksheet.formula import ArrayFormula

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources import workbook
from pipeline.collection.sources.rows import Row, as_text
from pipeline.collection.sources.xlsx import read_sheet
from tests.soak import examples

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
SHEET = "xl/worksheets/sheet1.xml"


def book(rows: list[list[Any]], change: Callable[[Any], None] = lambda page: None) -> io.BytesIO:
    """A workbook with one sheet "Objects" of these rows."""
    made = openpyxl.Workbook()
    page = made.active
    page.title = "Objects"
    for row in rows:
        page.append(row)
    change(page)
    stream = io.BytesIO()
    made.save(stream)
    return stream


def rewritten(stream: io.BytesIO, change: Callable[[str], str], part: str = SHEET) -> io.BytesIO:
    """The workbook with one of its parts changed, as a careless or hostile program might write it."""
    out = io.BytesIO()
    with zipfile.ZipFile(stream) as old, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, change(data.decode()).encode() if name == part else data)
    return out


def sheet_xml(data: str, *, before: str = "", after: str = "") -> Callable[[str], str]:
    return lambda _: f'{before}<worksheet xmlns="{MAIN}"><sheetData>{data}</sheetData>{after}</worksheet>'


def shared(texts: str, cells: str) -> io.BytesIO:
    """A workbook whose texts stand in a part of their own, as spreadsheet programs write them."""
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml.sharedStrings+xml"
    part = f'<Override PartName="/xl/sharedStrings.xml" ContentType="{kind}"/></Types>'
    stream = rewritten(book([["a"]]), lambda xml: xml.replace("</Types>", part), "[Content_Types].xml")
    stream = rewritten(stream, sheet_xml(cells))
    with zipfile.ZipFile(stream, "a") as archive:
        archive.writestr("xl/sharedStrings.xml", texts)
    return stream


def strings(*texts: str) -> str:
    return f'<sst xmlns="{MAIN}">{"".join(f"<si>{text}</si>" for text in texts)}</sst>'


def read(stream: Any, **options: Any) -> list[Row]:
    return list(read_sheet(stream, "museum.xlsx", **options))


def outcome(stream: Any) -> list[list[str]] | str:
    """The cells of the rows, or the message of the refusal."""
    try:
        return [row.cells for row in read(stream)]
    except CollectionError as problem:
        return str(problem)


def refused(stream: Any, match: str, **options: Any) -> None:
    with pytest.raises(CollectionError, match=match) as caught:
        read(stream, **options)
    assert str(caught.value).startswith("museum.xlsx")


# ---------------------------------------------------------------------------------------------------------------------
# What was typed in


def test_typed_cells_become_texts() -> None:
    rows = read(book([["number", "height", "shown", "seen"], ["A 1", 79.0, True, date(2020, 2, 29)], [7, 0.1, False]]))
    assert rows == [
        Row(0, 1, ["number", "height", "shown", "seen"]),
        Row(1, 2, ["A 1", "79", "true", "2020-02-29"]),
        Row(2, 3, ["7", "0.1", "false", ""]),
    ]


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**15), 10**15),
    # A spreadsheet keeps 15 digits; from 1e15 on a sheet no longer tells a float from an integer.
    st.floats(-9e14, 9e14).map(lambda number: float(f"{number:.15g}")),
    # No control characters: the library that writes the test's sheet refuses them. No formula, no escaped text.
    st.text(st.characters(exclude_categories=["Cc", "Cs"], exclude_characters="=_\ufffe\uffff"), max_size=40),
    st.dates(date(1900, 3, 1), date(9999, 12, 31)),
    st.datetimes(datetime(1900, 3, 1), datetime(9999, 12, 31)).map(lambda moment: moment.replace(microsecond=0)),
)


@settings(max_examples=examples(60), deadline=None)
@given(st.lists(st.lists(VALUES, min_size=3, max_size=3), min_size=1, max_size=5))
def test_values_come_back_as_the_same_texts(table: list[list[Any]]) -> None:
    """What as_text makes of the values themselves is the truth; error texts such as "#N/A" are errors to a sheet."""
    table = [["0" if v in ("#N/A", "#REF!") else v for v in row] for row in table]
    rows = read(book([["a", "b", "c"], *[["x", *row[1:]] for row in table]]))
    assert [row.cells for row in rows[1:]] == [["x", *map(as_text, row[1:])] for row in table]
    assert not any(row.faults for row in rows)


def test_rows_are_padded_blank_ones_skipped_and_lines_kept() -> None:
    rows = read(book([["a", "b", "c", None], [], ["1"], [None, " "], ["2", "x", "y", " "]]))
    assert [(row.number, row.line, row.cells) for row in rows] == [
        (0, 1, ["a", "b", "c"]),
        (1, 3, ["1", "", ""]),
        (2, 5, ["2", "x", "y"]),
    ]


def test_a_row_longer_than_the_header_has_a_fault() -> None:
    _, good, bad = read(book([["a", "b"], ["1", "2"], ["1", "2", None, "4"]]))
    assert good.fault == ("", "")
    assert bad.fault[0] == "4 cells, the header has 2"
    assert bad.cells == ["1", "2"]


def test_the_header_may_stand_lower() -> None:
    rows = read(book([["Museum of Things"], ["as of May"], ["a", "b"], ["1", "2"]]), header_row=3)
    assert [(row.number, row.line, row.cells) for row in rows] == [(0, 3, ["a", "b"]), (1, 4, ["1", "2"])]
    refused(book([["a"], ["1"]]), "ends in row 2", header_row=5)
    refused(book([[], ["a"]]), "row 1: the header is empty")
    assert read(book([])) == []


def test_numbers_keep_the_zeros_of_their_format_and_times_are_not_lost() -> None:
    def dress(page: Any) -> None:
        page["A2"].number_format = "0000"
        page["B2"].number_format = "0%"
        page["C2"].number_format = "yyyy-mm-dd"
        page["D2"].number_format = "[h]:mm:ss"

    (_, row) = read(book([list("abcd"), [42, 0.5, datetime(2020, 1, 2, 3, 4, 5), timedelta(hours=30)]], dress))
    assert row.cells == ["0042", "0.5", "2020-01-02T03:04:05", ""]
    assert row.faults[3][0] == "cannot be read: a value of the kind timedelta"


def test_line_ends_as_the_format_escapes_them() -> None:
    (_, row) = read(book([["a"], ["one_x000D_\ntwo_x0009_three"]]))
    assert row.cells == ["one\r\ntwo\tthree"]


def test_hidden_rows_are_read() -> None:
    def hide(page: Any) -> None:
        page.row_dimensions[2].hidden = True

    assert [row.cells for row in read(book([["a"], ["1"], ["2"]], hide))] == [["a"], ["1"], ["2"]]


# ---------------------------------------------------------------------------------------------------------------------
# What was not


def test_formulas_are_never_believed() -> None:
    """The value saved beside a formula is that of another day, or of a program that computes otherwise."""
    stream = book([["a", "b"], ["1", "=1+1"]])
    stream = rewritten(stream, lambda xml: xml.replace("<v></v>", "<v>2</v>").replace("<v/>", "<v>2</v>"))
    (_, row) = read(stream)
    assert row.cells == ["1", ""]
    assert row.faults == {
        1: ("holds a formula", "copy the column and paste it as values; formulas are not computed here")
    }


def test_what_an_array_formula_fills_has_no_formula_of_its_own() -> None:
    def fill(page: Any) -> None:
        page["B2"] = ArrayFormula("B2:B3", "=C2:C3*2")
        page["B3"] = 8  # the cached value of the second cell, as a spreadsheet program writes it

    _, first, second, third = read(book([["a", "b"], ["1"], ["2"], ["3", 5]], fill))
    assert first.faults[1][0] == second.faults[1][0] == "belongs to the formula of B2:B3"
    assert (second.cells[1], third.cells[1], third.faults) == ("", "5", {})


def test_errors_are_named() -> None:
    (_, row) = read(book([["a", "b"], ["1", "#REF!"]]))
    assert row.faults == {1: ("holds the error #REF!", "mend the cell, or empty it")}


def test_cells_merged_across_columns_keep_the_first_and_name_the_others() -> None:
    _, first, second = read(
        book([["a", "b", "c"], ["1", "Hall"], ["2", "Store", "x"]], lambda page: page.merge_cells("B2:C2"))
    )
    assert first.cells == ["1", "Hall", ""]
    assert first.faults == {2: ("is one of the merged cells B2:C2", "unmerge them, and fill in every row and column")}
    assert second.faults == {}


def test_a_cell_merged_down_a_column_holds_for_each_of_its_rows() -> None:
    """A room beside all that stands in it; a blank row within, and what follows, have nothing of it."""
    rows = [["a", "b"], ["1", "Hall"], ["2"], [], ["3"], ["4", "Store"], ["5"]]
    _, *found = read(book(rows, lambda page: page.merge_cells("B2:B5")))
    assert [row.cells for row in found] == [["1", "Hall"], ["2", "Hall"], ["3", "Hall"], ["4", "Store"], ["5", ""]]
    assert not any(row.faults for row in found)


def test_a_fault_that_is_merged_down_a_column_is_that_of_each_of_its_rows() -> None:
    _, first, second = read(book([["a", "b"], ["1", "=A2"], ["2"]], lambda page: page.merge_cells("B2:B3")))
    assert first.faults == second.faults
    assert first.faults[1][0] == "holds a formula"


def test_a_merged_or_computed_header_is_refused() -> None:
    refused(book([["a", None], ["1", "2"]], lambda page: page.merge_cells("A1:B1")), "row 1: the header .* A1:B1; unm")
    refused(book([["a", "=B2"], ["1", "2"]]), "row 1: the header cannot be read: cell 2 holds a formula")


def test_a_date_that_cannot_be_is_an_error_value() -> None:
    def spoil(page: Any) -> None:
        page["B2"].number_format = "yyyy-mm-dd"

    (_, row) = read(book([["a", "b"], ["1", 1e12]], spoil))
    assert row.faults[1][0] == "holds the error #VALUE!"


# ---------------------------------------------------------------------------------------------------------------------
# Sheets


def several() -> io.BytesIO:
    made = openpyxl.Workbook()
    made.active.title = "Notes"
    made.create_sheet("Objects").append(["a"])
    made.create_sheet("Old").sheet_state = "hidden"
    made.create_chartsheet("Chart").add_chart(BarChart())
    stream = io.BytesIO()
    made.save(stream)
    return stream


def test_a_sheet_is_chosen_by_its_name() -> None:
    assert [row.cells for row in read(several(), sheet="Objects")] == [["a"]]
    refused(several(), "has no sheet 'objects'; name one of its sheets: 'Notes', 'Objects', 'Old'", sheet="objects")
    refused(several(), "2 visible sheets; say which one to read: sheet = .*Its sheets are .Notes.")


def test_a_path_is_opened_and_closed(tmp_path: Path) -> None:
    path = tmp_path / "odd name.bin"
    path.write_bytes(book([["a"], ["1"]]).getvalue())
    rows = read_sheet(path, "museum.xlsx")
    assert next(rows).cells == ["a"]
    rows.close()  # type: ignore[attr-defined]
    assert len(read(str(path))) == 2
    refused(tmp_path / "absent.xlsx", "cannot be read: No such file")
    refused(tmp_path, "cannot be read: Is a directory")


# ---------------------------------------------------------------------------------------------------------------------
# What lies


def test_the_size_a_sheet_claims_is_not_believed() -> None:
    def claim(size: str) -> Callable[[str], str]:
        cells = '<row r="1"><c r="A1" t="inlineStr"><is><t>a</t></is></c></row><row r="2"><c r="A2"><v>1</v></c></row>'
        return lambda xml: sheet_xml(cells)(xml).replace("<sheetData>", f'<dimension ref="{size}"/><sheetData>')

    for size in ("A1", "A1:A1", "A1:XFD1048576"):
        rows = read(rewritten(book([["a"]]), claim(size)))
        assert [row.cells for row in rows] == [["a"], ["1"]], size


def test_rows_that_are_formatted_but_empty_cost_little() -> None:
    """Rows and cells that carry a style and no value, as a column formatted to the end of the sheet leaves behind."""
    first = '<row r="1"><c r="A1" t="inlineStr"><is><t>a</t></is></c></row><row r="2"><c r="A2"><v>1</v></c></row>'
    empty = "".join(f'<row r="{r}"><c r="XFD{r}" s="0"/></row>' for r in range(3, 100_000))
    whole = sheet_xml(first + empty + '<row r="1048576"/>')("")
    stream = rewritten(
        book([["a"]]), lambda _: whole.replace("<sheetData>", '<dimension ref="A1:XFD1048576"/><sheetData>')
    )
    begin = time.perf_counter()
    assert len(read(stream)) == 2
    assert time.perf_counter() - begin < 20  # about 1 s; a reader that makes 16,384 cells of each row takes minutes


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ('<row r="2"><c><v>1</v></c></row><row r="1"><c><v>1</v></c></row>', "a row numbered '1' after row 2"),
        ('<row r="1"><c r="B1"><v>1</v></c><c r="A1"><v>1</v></c></row>', "a cell 'A1' out of its place in row 1"),
        ('<row r="1"><c r="A7"><v>1</v></c></row>', "a cell 'A7' out of its place"),
        ('<row r="2000000"/>', "a row numbered '2000000'"),
        ('<row r="99999999999999999999"/>', "a row numbered '99999999999999999999"),
        ('<row r="1"><c r="XFD1"><v>1</v></c></row>', "more than 1,000 columns"),
        ('<row r="1"><c r="A1"><v>1</v></c>', "damaged: mismatched tag"),
        ('<row r="1"><c r="A1" t="s"><v>12</v></c></row>', "row 1: the workbook is damaged"),
        ('<row r="1"><c r="A1"><v>one</v></c></row>', "row 1: the workbook is damaged"),
        (f'<row r="1"><c r="A1"><v>{"9" * 5000}</v></c></row>', "row 1: the workbook is damaged"),
    ],
)
def test_what_a_reader_would_lose_or_choke_on_is_refused(data: str, match: str) -> None:
    refused(rewritten(book([["a"]]), sheet_xml(data)), match)


def test_overlapping_merged_cells_are_refused() -> None:
    merged = '<mergeCells><mergeCell ref="A1:A9"/><mergeCell ref="A2:A9"/></mergeCells>'
    cells = '<row r="1"><c r="A1" t="inlineStr"><is><t>a</t></is></c></row><row r="2"><c r="A2"><v>1</v></c></row>'
    refused(rewritten(book([["a"]]), sheet_xml(cells, after=merged)), "row 2: merged cells or array formulas overlap")


def test_a_row_without_end_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workbook, "RECORD_LIMIT", 10_000)
    cells = "".join("<c><is><t>x</t></is></c>" for _ in range(1_000))
    refused(rewritten(book([["a"]]), sheet_xml(f"<row>{cells}</row>")), "more than 10,000 bytes after row 1")
    refused(rewritten(book([["a"]]), sheet_xml(f"<junk>{cells}</junk>")), "more than 10,000 bytes after row 0")


CELLS = '<row r="1"><c r="A1" t="s"><v>0</v></c></row><row r="2"><c r="A2" t="s"><v>1</v></c></row>'


def test_shared_and_formatted_texts_are_read() -> None:
    rich = "<r><t>Bust of </t></r><r><rPr><b/></rPr><t>a man</t></r>"
    assert [row.cells for row in read(shared(strings("<t>title</t>", rich), CELLS))] == [["title"], ["Bust of a man"]]
    assert read(shared(strings("<t>a</t>", "<t>x_x000D_\ny</t>"), CELLS))[1].cells == ["x\r\ny"]
    refused(shared(strings("<t>a</t>", "<t>_xD800_</t>".replace("_xD800_", "&#xFFFE;")), CELLS), "workbook is damaged")


# Ten levels of ten: ten thousand million letters where they are believed.
BOMB = '<!ENTITY e0 "0123456789">' + "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))


def test_entities_are_refused(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("secret")
    outside = f'<!ENTITY e9 SYSTEM "{(tmp_path / "secret").as_uri()}">'
    for entities in (BOMB, outside):
        texts = strings("<t>a</t>", "<t>&e9;</t>")
        refused(shared(f"<!DOCTYPE x [{entities}]>{texts}", CELLS), "the workbook is damaged: EntitiesForbidden")
        stream = shared(strings("<t>a</t>", "<t>b</t>"), CELLS)
        refused(
            rewritten(stream, lambda xml, e=entities: f"<!DOCTYPE x [{e}]>{xml}"), "EntitiesForbidden|document type"
        )
        for part in ("xl/workbook.xml", "xl/styles.xml", "[Content_Types].xml"):
            # Never resolved there: the part means what it means without them.
            stream = rewritten(
                shared(strings("<t>a</t>", "<t>b</t>"), CELLS),
                lambda xml, e=entities: f"<!DOCTYPE x [{e}]>{xml.split('?>')[-1].replace('><', '>&e9;<', 1)}",
                part,
            )
            begin = time.perf_counter()
            seen = outcome(stream)
            assert seen == [["a"], ["b"]] or ("damaged" in seen and "secret" not in seen)
            assert time.perf_counter() - begin < 5


def test_the_guard_against_entities_must_be_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(openpyxl, "DEFUSEDXML", False)
    refused(book([["a"]]), "install defusedxml and unset OPENPYXL_DEFUSEDXML")


# ---------------------------------------------------------------------------------------------------------------------
# Archives


def test_bombs_are_refused_by_what_they_claim(monkeypatch: pytest.MonkeyPatch) -> None:
    zeros = rewritten(book([["a"]]), sheet_xml(" " * (workbook.RATIO_FROM + 1)))
    refused(zeros, "would unpack to more than 200 times its size")
    monkeypatch.setattr(workbook, "ENTRY_LIMIT", 100)
    refused(book([["a"]]), "bytes unpacked, more than 100; export fewer")
    monkeypatch.undo()
    monkeypatch.setattr(workbook, "TOTAL_LIMIT", 1000)
    refused(book([["a"]]), "bytes unpacked, more than 1,000; export fewer")
    monkeypatch.undo()
    monkeypatch.setattr(workbook, "ENTRIES_LIMIT", 3)
    refused(book([["a"]]), "parts inside, more than 3")
    monkeypatch.undo()
    monkeypatch.setattr(workbook, "WHOLE_LIMIT", 300)
    refused(book([["a"]]), "more than 300; export")


def test_a_size_that_is_claimed_too_small_fails() -> None:
    """The central directory says 200 bytes for a sheet of many more: no more are given out, and the checksum tells."""
    data = bytearray(book([["a"], *[[n] for n in range(5000)]]).getvalue())
    at = data.rfind(b"PK\x01\x02", 0, data.rfind(SHEET.encode()))
    struct.pack_into("<I", data, at + 24, 200)
    refused(io.BytesIO(bytes(data)), "damaged")


def test_an_encrypted_entry_and_a_strange_packing_are_refused() -> None:
    data = bytearray(book([["a"]]).getvalue())
    at = data.rfind(b"PK\x01\x02", 0, data.rfind(SHEET.encode()))
    struct.pack_into("<H", data, at + 8, 1)
    refused(io.BytesIO(bytes(data)), "is encrypted; save the workbook without a password")
    out = io.BytesIO()
    with zipfile.ZipFile(book([["a"]])) as old, zipfile.ZipFile(out, "w", zipfile.ZIP_LZMA) as new:
        for name in old.namelist():
            new.writestr(name, old.read(name))
    refused(out, "packed in a way that no workbook is")


def test_other_kinds_of_files_are_named() -> None:
    ole = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600)
    refused(io.BytesIO(ole), "an old .xls workbook")
    refused(io.BytesIO(ole + "EncryptedPackage".encode("utf-16-le") + bytes(100)), "protected by a password")
    refused(io.BytesIO(b"\x09\x08\x10\x00\x00\x06"), "an old .xls workbook")
    refused(io.BytesIO(b"number,title\n"), "not an .xlsx workbook, whatever its name says")
    refused(io.BytesIO(b""), "not an .xlsx workbook")
    refused(io.BytesIO(b"PK\x03\x04 and then nothing"), "damaged: File is not a zip file")
    for name, match in (
        ("xl/workbook.bin", "not an .xlsx one"),
        ("content.xml", "no spreadsheet"),
        ("a", "no workbook"),
    ):
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w") as made:
            made.writestr(name, b"")
        refused(out, match)


def test_a_strict_workbook_is_refused_with_the_remedy() -> None:
    """Otherwise its rows would be passed over without a word: its elements have other names."""
    strict = "http://purl.oclc.org/ooxml/spreadsheetml/main"
    refused(rewritten(book([["a"]]), lambda xml: xml.replace(MAIN, strict)), "a strict workbook perhaps")


# Made once: a workbook holds the time at which it was made.
DAMAGED = book([["a", "b"], ["1", 2.5], ["x", "=A1"]], lambda page: page.merge_cells("A2:A3")).getvalue()


@settings(max_examples=examples(150), deadline=None)
@given(st.data())
def test_a_damaged_workbook_is_refused_or_read(data: st.DataObject) -> None:
    """Bytes changed or cut anywhere: rows, or one clear error; nothing else ever comes out."""
    whole = bytearray(DAMAGED)
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    end = data.draw(st.integers(len(whole) // 2, len(whole)))
    seen = outcome(io.BytesIO(bytes(whole[:end])))
    assert isinstance(seen, list) or seen.startswith("museum.xlsx")


@settings(max_examples=examples(150), deadline=None)
@given(st.data())
def test_a_damaged_sheet_is_refused_or_read(data: st.DataObject) -> None:
    part = data.draw(st.sampled_from([SHEET, "xl/sharedStrings.xml", "xl/workbook.xml", "xl/styles.xml"]))

    def spoil(xml: str) -> str:
        begin = data.draw(st.integers(0, len(xml)))
        end = data.draw(st.integers(begin, min(len(xml), begin + 12)))
        return xml[:begin] + data.draw(st.text('<>/"=&;#01aAr :', max_size=8)) + xml[end:]

    seen = outcome(rewritten(io.BytesIO(DAMAGED), spoil, part))
    assert isinstance(seen, list) or seen.startswith("museum.xlsx")
