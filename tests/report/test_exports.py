"""Exports: read back by independent readers and compared with the record."""

import csv
import json
import re
from dataclasses import replace
from math import inf
from pathlib import Path

import openpyxl
import pyarrow.parquet as pq
import pytest

from pipeline.report.files.exports import FindingRows, page_exports
from pipeline.report.render import pages_of
from pipeline.report.text import safe_cell
from pipeline.report.units import Units

from . import builder

CONTRACT = {
    *("run", "object_number", "gallery", "level", "model", "demand", "unit", "low", "high", "capacity", "utilisation"),
    *("verdict", "fidelity", "error", "decided_by", "motion", "motion_hash", "assumptions", "version"),
}
FINDINGS = [f for _sheet, found in pages_of(builder.record()) for a in found.assessments for f in a.findings]
"""In the order of the sheets, which is that of the files."""


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _jsonl(path: Path) -> list[dict[str, object]]:
    def refuse(constant: str) -> object:
        raise AssertionError(f"{constant} is not JSON")

    return [json.loads(line, parse_constant=refuse) for line in path.read_text(encoding="utf-8").splitlines()]


def test_three_formats_have_the_contracts_names_and_one_row_a_finding(report: Path) -> None:
    table = pq.read_table(report / "findings.parquet")
    text, lines = _rows(report / "findings.csv"), _jsonl(report / "findings.jsonl")
    assert set(text[0]) >= CONTRACT
    assert list(text[0]) == list(lines[0]) == table.column_names
    assert len(text) == len(lines) == table.num_rows == len(FINDINGS)


def test_numbers_survive_exactly(report: Path) -> None:
    table = pq.read_table(report / "findings.parquet").to_pylist()
    text, lines = _rows(report / "findings.csv"), _jsonl(report / "findings.jsonl")
    for finding, a, b, c in zip(FINDINGS, table, text, lines, strict=True):
        for name in ("demand", "low", "high", "capacity", "utilisation", "error"):
            value = getattr(finding, name)
            assert a[name] == value
            assert (float(b[name]) if b[name] else None) == value
            assert (None if c[name] is None else float(str(c[name]))) == value
        assert a["assumptions"] == list(finding.assumptions) == c["assumptions"]
    assert inf in [f.utilisation for f in FINDINGS]


def test_the_workbook_has_the_same_names_and_numbers(report: Path) -> None:
    book = openpyxl.load_workbook(report / "findings.xlsx")
    assert book.sheetnames == ["findings", "recommendations", "objects"]
    for name in book.sheetnames:
        rows = list(book[name].iter_rows(values_only=True))
        text = _rows(report / f"{name}.csv")
        assert list(rows[0]) == list(text[0])
        assert len(rows) == len(text) + 1
    columns = [cell.value for cell in book["findings"][1]]
    for finding, row in zip(FINDINGS, book["findings"].iter_rows(min_row=2, values_only=True), strict=True):
        found = dict(zip(columns, row, strict=True))
        assert found["demand"] == finding.demand
        capacity = finding.capacity
        assert found["capacity"] == ("inf" if capacity == inf else capacity)


def test_no_cell_of_the_workbook_is_a_formula(report: Path) -> None:
    book = openpyxl.load_workbook(report / "findings.xlsx")
    cells = [cell for sheet in book for row in sheet.iter_rows() for cell in row]
    assert {cell.data_type for cell in cells} <= {"s", "n", "b", "inlineStr"}
    assert builder.HOSTILE["H.3"] in {cell.value for cell in cells}


def test_every_object_is_exported_even_where_nothing_was_found(report: Path) -> None:
    rows = _rows(report / "objects.csv")
    assert len(rows) == len(builder.record().assessments)
    unknown = next(r for r in rows if r["object_number"] == "96.AC.77")
    assert (unknown["state"], unknown["missing"]) == ("unknown", "base_width_m; base_depth_m")
    for row in rows:
        page, _, anchor = row["page"].partition("#")
        assert f'id="{anchor}"' in (report / page).read_text(encoding="utf-8")


def test_what_has_no_title_is_called_what_it_is() -> None:
    """As on the pages: the desk and the plan read it from here."""
    record = builder.record()
    first = record.assessments[0]
    scene = replace(first.scene, item=replace(first.scene.item, title="", object_name="figurine"))
    alone = replace(record, assessments=(replace(first, scene=scene),))
    parts = page_exports(alone, "r", "p.html", lambda _: "a", lambda _: None, Units("cm"), FindingRows())
    assert json.loads(parts["objects.jsonl"])["title"] == "figurine"


def test_recommendations_carry_their_evidence(report: Path) -> None:
    row = next(r for r in _rows(report / "recommendations.csv") if r["object_number"] == "70.AA.2")
    assert row["sentence"] == "Keep 14\u202fcm clear on all sides."
    assert row["parameters"] == "clearance_m=0.14 m"
    assert row["checks"] == "sliding: 0.131 of 0.14 m, passes"


def test_the_unit_of_a_ratio_is_1_in_every_format(report: Path) -> None:
    """A "-" would be the beginning of a formula, and have an apostrophe put before it in one format alone."""
    ratios = [i for i, finding in enumerate(FINDINGS) if finding.unit == "-"]
    assert ratios
    book = openpyxl.load_workbook(report / "findings.xlsx")["findings"]
    column = [cell.value for cell in book[1]].index("unit")
    formats = {
        "csv": [row["unit"] for row in _rows(report / "findings.csv")],
        "jsonl": [row["unit"] for row in _jsonl(report / "findings.jsonl")],
        "parquet": pq.read_table(report / "findings.parquet")["unit"].to_pylist(),
        "xlsx": [row[column] for row in book.iter_rows(min_row=2, values_only=True)],
    }
    for name, units in formats.items():
        assert units == ["1" if finding.unit == "-" else finding.unit for finding in FINDINGS], name
    for row in _rows(report / "recommendations.csv"):
        assert not re.search(r" -(;|,|$)", row["parameters"] + ";" + row["checks"])


@pytest.mark.parametrize("start", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1"])
def test_no_cell_is_taken_for_a_formula(start: str) -> None:
    assert safe_cell(start).startswith("'" + start[0])


@pytest.mark.parametrize("text", ["jar;=1+1", 'a "b";@SUM(A1)', "two\n=1", "a\t+1", "\t=1", "\uff1d1+1", "a;\uff0b1"])
def test_no_part_of_a_cell_is_a_formula_where_a_program_cuts_at_other_separators(text: str) -> None:
    """Where numbers have decimal commas, spreadsheets cut at semicolons and believe quotation marks at a start only."""
    for part in re.split("[;\t\r\n]", safe_cell(text)):
        assert not part.startswith(("=", "+", "-", "@", "\uff1d", "\uff0b"))


@pytest.mark.parametrize("text", ["Kouros", "", "1=1", " =1", "'=1"])
def test_other_cells_are_left_alone(text: str) -> None:
    assert safe_cell(text) == text


def test_formulas_in_the_collection_are_defused_and_negative_numbers_are_not(report: Path, tmp_path: Path) -> None:
    titles = {r["object_number"]: r["title"] for r in _rows(report / "objects.csv")}
    assert titles["H.3"] == "'" + builder.HOSTILE["H.3"]
    for path in report.glob("*.csv"):
        for row in _rows(path):
            assert not [v for v in row.values() if v.startswith(("=", "+", "@", "\t", "\r"))]
