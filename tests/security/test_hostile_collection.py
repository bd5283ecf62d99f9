"""Rows that mean harm, from import to report: nothing runs, leaves, escapes or is lost."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import openpyxl
import pyarrow.parquet as pq
import pytest
from pypdf import PdfReader

from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.operations.report_status import RESERVE
from pipeline.settings import template
from pipeline.tools.synthetic import synthesise
from tests.museum import in_common, small
from tests.operations.conftest import within
from tests.operations.servers import Web, web
from tests.report.conftest import browser as browser  # noqa: PLC0414 - a fixture

from . import payloads

pytestmark = pytest.mark.slow_file

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")
"""What may reach no terminal: control characters but tabs and line ends, and marks of direction."""

PAGE = re.compile(r"(index|motion|method|objects|news|reading-[0-9]+)\.html|[a-z0-9-]{1,60}-[0-9a-f]{8}\.html")
SHEET = re.compile(r"[a-z0-9-]{1,60}-[0-9a-f]{8}(-[0-9]+)?-sheet\.pdf")
PART = re.compile(
    r"parts|parts/[a-z0-9-]{1,60}-[0-9a-f]{8}\.((findings|recommendations|objects)\.(csv|jsonl|arrow)|(keys|listed)\.arrow)"
)
EXPORTS = {
    *("findings.csv", "findings.jsonl", "findings.parquet", "findings.xlsx", "objects.csv", "objects.parquet"),
    "objects.jsonl",
    *(
        "recommendations.csv",
        "recommendations.parquet",
        ".pages.json",
        "summary.json",
        "reading.csv",
        "reading.html",
        "plan.csv",
        "fragility_classes.csv",
        "plan.html",
    ),
}
OUTSIDE = "owned-by-a-title"

SAME = pytest.mark.long("test_the_same_from_a_workbook_and_from_a_database")


@dataclass
class Night:
    """A museum after its hostile nights.

    said    : all that the runs printed
    summary : of the second run
    outside : what lay around the museum's folder before
    """

    folder: Path
    table: list[dict[str, str]]
    said: str
    summary: dict[str, Any]
    canary: Web
    outside: list[str]

    @property
    def report(self) -> Path:
        return self.folder / "reports" / "latest"


def tree(folder: Path, but: Path) -> list[str]:
    """List all below a folder, leaving out what is below another one."""
    return sorted(str(path) for path in folder.rglob("*") if but not in (path, *path.parents))


@pytest.fixture(scope="module")
def night(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Night]:
    """Import from CSV and run; then flatten some objects and run again, so that much has changed."""
    around = tmp_path_factory.mktemp("around")
    folder = around / "a" / "museum"
    synthesise("sine", ["amplitude=3", "frequency=2", "cycles=2"], folder / "site")
    in_common(folder)
    with web(204) as canary:
        payload = payloads.payloads(canary.url + "/", around / OUTSIDE)
        table = list(payloads.rows(payload))
        text = small(template(museum=payload[0], source="export.csv", mapping="kouros", site="site"))
        (folder / "kouros.toml").write_text(text.replace('fragility = "auto"', "fragility = false"), encoding="utf-8")
        payloads.write_csv(folder / "export.csv", table)
        outside = tree(around, folder)
        first = within(folder, "-v", "run")
        assert first.returncode == 0, first.stderr
        flat = [
            dict(row, height_m="0.05") if row["height_m"] == "0.6" and n % 5 == 1 else row
            for n, row in enumerate(table)
        ]
        payloads.write_csv(folder / "export.csv", flat)
        second = within(folder, "run", "--json")
        assert second.returncode == 0, second.stderr
        said = "".join([first.stdout, first.stderr, second.stdout, second.stderr])
        yield Night(folder, flat, said, json.loads(second.stdout), canary, outside)


def imported(folder: Path) -> tuple[int, int]:
    """Return how many rows of the first import became objects, and how many its log says were refused."""
    log = min((folder / "imports").iterdir())
    with log.open(encoding="utf-8", newline="") as file:
        kinds = [row["what"] for row in csv.DictReader(file)]
    return kinds.count("new"), kinds.count("rejected")


def test_every_row_is_accounted_for(night: Night) -> None:
    """Some numbers of objects are refused besides the broken ones, because they read like dimensions: 0)+1">."""
    new, refused = imported(night.folder)
    assert new + refused == len(night.table) == payloads.ROWS
    assert payloads.BROKEN <= refused < payloads.ROWS // 8
    s = night.summary
    assert s["objects"] == new == s["assessed"] + s["cannot"]
    assert s["assessed"] > payloads.ROWS // 2  # the hostile texts were judged, not turned away
    assert s["changes"]["counts"]["inputs"] > payloads.ROWS // 10


@pytest.mark.parametrize("kind", [pytest.param("xlsx", marks=SAME), "sql"])
def test_the_same_from_a_workbook_and_from_a_database(night: Night, tmp_path: Path, kind: str) -> None:
    """Both give what CSV gives, but for characters that no workbook can hold."""
    if kind == "xlsx":
        source = tmp_path / "export.xlsx"
        payloads.write_xlsx(source, night.table)
        where, said = str(source), 'format = "xlsx"\nsheet = "objects"'
    else:
        source = tmp_path / "export.sqlite"
        payloads.write_sqlite(source, night.table)
        # Not a table: that would be read in the order of its numbers.
        where, said = f"sqlite:///{source}", 'format = "sql"\nquery = "SELECT * FROM objects ORDER BY place"'
    before = source.read_bytes()
    mapping = tmp_path / "mapping.toml"
    mapping.write_text(payloads.mapping(said), encoding="utf-8")
    reading = read_items(where, load_mapping(mapping))
    assert (len(reading.items), len(reading.rejected)) == imported(night.folder)
    assert source.read_bytes() == before  # the payloads hold DROP TABLE and DELETE
    plain = read_items(night.folder / "export.csv", load_mapping("kouros"))
    for here, there in zip(reading.items, plain.items, strict=True):
        assert (here.height_m, here.clearance_m, here.on_display) == (
            there.height_m,
            there.clearance_m,
            there.on_display,
        )
        if there.title.isprintable():
            assert (here.title, here.gallery, here.medium) == (
                there.title,
                there.gallery,
                there.medium,
            ) or kind == "xlsx"


def test_nothing_was_written_elsewhere(night: Night) -> None:
    around = night.folder.parents[1]
    assert tree(around, night.folder) == night.outside
    assert {path.name for path in night.folder.iterdir()} == {
        *("kouros.toml", "kouros.sqlite", "export.csv", "site", "imports", "reports", ".kouros-kept", ".kouros.lock")
    }
    for folder in (night.folder / "reports").iterdir():
        if folder.is_dir() and not folder.is_symlink():
            names = {path.relative_to(folder).as_posix() for path in folder.rglob("*")} - EXPORTS
            assert [
                name for name in names if not (PAGE.fullmatch(name) or PART.fullmatch(name) or SHEET.fullmatch(name))
            ] == []


def test_what_is_left_holds_no_objects_of_python(night: Night) -> None:
    """Texts, tables, JSON, SQL and plain arrays: nothing that runs when it is read."""
    kept = [path for path in night.folder.rglob("*") if path.is_file()]
    kinds = {
        *(
            ".toml",
            ".sqlite",
            ".lock",
            ".html",
            ".csv",
            ".jsonl",
            ".json",
            ".parquet",
            ".arrow",
            ".xlsx",
            ".kept",
            ".pdf",
        )
    }
    assert {path.suffix or path.name for path in kept} - {".kouros.lock", RESERVE} <= kinds
    sheets = [path for path in kept if path.suffix == ".pdf"]
    assert sheets
    for path in sheets:
        read = PdfReader(path)
        assert not {"/OpenAction", "/AA", "/Names", "/AcroForm"} & set(read.root_object)
        assert not [key for page in read.pages for key in ("/Annots", "/AA") if key in page]
    sealed = [
        path for path in [*kept, *(night.folder / ".kouros-kept" / "charts").rglob("*")] if path.suffix == ".kept"
    ]
    assert sealed
    for path in sealed:
        body = path.read_bytes()[len(b"kouros kept 1\n") + 32 :]
        length = int.from_bytes(body[:8], "little")
        arrays = json.loads(body[8 : 8 + length])["arrays"]
        # JSON, then nothing but numbers and truth values.
        assert {np.dtype(kind).kind for _, kind, _ in arrays} <= set("biuf")
        sizes = [np.dtype(kind).itemsize * math.prod(shape) for _, kind, shape in arrays]
        assert len(body) == 8 + length + sum(sizes)


def test_no_text_steers_a_terminal(night: Night) -> None:
    """The run, the second one as JSON, what changed, one object explained, the doctor, an error with a hostile name."""
    number = night.table[40]["object_number"].strip()
    assert number
    said = [night.said]
    for words in (["diff"], ["check"], ["run", "--explain", number], ["import", "export.csv", "--dry-run"], ["prune"]):
        done = within(night.folder, *words)
        assert done.returncode == 0, (words, done.stderr)
        said += [done.stdout, done.stderr]
    wrong = within(night.folder, "run", "--object", "\x1b[2J\u202e")
    assert wrong.returncode == 2
    said.append(wrong.stderr)
    assert [sorted(set(STEERING.findall(text))) for text in said] == [[]] * len(said)
    # There was something to hold back.
    assert any(STEERING.search(row["title"]) for row in night.table)


@pytest.mark.long("report/test_browser::test_no_hostile_text_became_an_element")
def test_nothing_runs_in_a_browser_and_nothing_leaves_it(night: Night, browser: Chrome) -> None:
    """Every page in Chromium; the control shows that the same payloads do run where they are not escaped."""
    pages = [*sorted(night.report.glob("*.html")), night.folder / "reports" / "index.html"]
    assert len(pages) > 15
    for page in pages:
        browser.get(page.as_uri())
        # The page's own script looks through all texts, and sorts by each column.
        browser.execute_script(
            "const box = document.querySelector('#tools input');"
            "if (box) { box.value = 'script'; box.dispatchEvent(new Event('input')) }"
            "document.querySelectorAll('table.list thead button').forEach(button => button.click())"
        )
        ran, address, elements = browser.execute_script(
            "return [window.pwned || 0, location.href.split('#')[0],"
            " document.querySelectorAll('img, iframe, form, base, link, object, embed, [onerror], [onload]').length]"
        )
        assert (ran, address, elements) == (0, page.as_uri(), 0), page.name
        assert not [e for e in browser.get_log("browser") if e["level"] == "SEVERE"], page.name
    assert night.canary.heard == []


def test_the_payloads_are_alive(night: Night, browser: Chrome, tmp_path: Path) -> None:
    """The control of the test above: unescaped and without a policy, the titles run and ask the canary."""
    control = tmp_path / "control.html"
    # Others open comments or styles, which would swallow the rest of this one page.
    titles = sorted({row["title"] for row in night.table})
    body = "<p>".join(title for title in titles if "<img" in title or title.startswith("<script>"))
    control.write_text(f"<!DOCTYPE html><meta charset=utf-8><body>{body}", encoding="utf-8")
    with web(204) as other:
        live = control.read_text(encoding="utf-8").replace(night.canary.url, other.url)
        control.write_text(live, encoding="utf-8")
        browser.get(control.as_uri())
        assert browser.execute_script("return window.pwned || 0") > 0
        assert other.heard
    browser.get("about:blank")
    browser.get_log("browser")


def test_no_template_was_evaluated(night: Night) -> None:
    texts = [path.read_text(encoding="utf-8") for path in night.report.glob("*.html")]
    assert any("{{1234567*7}}" in text for text in texts)
    assert not any(payloads.PRODUCT in text for text in [*texts, night.said])


def test_no_export_holds_a_formula_and_none_loses_an_object(night: Night) -> None:
    objects, _ = imported(night.folder)
    for path in night.report.glob("*.csv"):
        with path.open(encoding="utf-8", newline="") as file:
            table = list(csv.DictReader(file))
        if path.name == "objects.csv":
            assert len(table) == objects
        for row in table:
            assert None not in row  # as many cells as the header has
            for name, value in row.items():
                number = re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?", value)
                assert number or not value.startswith(("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d")), (path, name)
    lines = (night.report / "findings.jsonl").read_text(encoding="utf-8").split("\n")
    findings = [json.loads(line) for line in lines if line]
    assert len(findings) == night.summary["findings"] == pq.read_table(night.report / "findings.parquet").num_rows
    # Without the signs that steer a terminal, which are nobody's number.
    titles = {item.object_number for item in read_items(night.folder / "export.csv", load_mapping("kouros")).items}
    book = openpyxl.load_workbook(night.report / "findings.xlsx", read_only=True)
    for sheet in book.worksheets:
        rows = list(sheet.iter_rows())
        assert "f" not in {cell.data_type for row in rows for cell in row}
        assert sheet.title != "objects" or len(rows) == objects + 1
    book.close()
    assert {f["object_number"] for f in findings} <= titles


def test_the_log_of_the_import_is_a_safe_table_too(night: Night) -> None:
    for log in (night.folder / "imports").iterdir():
        with log.open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                assert not [v for v in row.values() if v.startswith(("=", "+", "-", "@", "\t", "\r", "\n"))]
