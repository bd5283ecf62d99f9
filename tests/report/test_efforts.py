"""What decided the verdicts of a run, on the method page."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from lxml import html

from pipeline.analysis.cases import Effort
from pipeline.report import Language, Units
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.report_writer import ReportWriter
from pipeline.report.pages.tallies import total

from . import builder


def rows(folder: Path, efforts: Mapping[str, Mapping[str, int]]) -> list[list[str]]:
    """Return the rows of the table on the method page of a run with these efforts; none without the table."""
    head = replace(builder.record(), assessments=(), wishes=None, spacings=())
    with ReportWriter(folder / "report", PageRenderer(head, Units(), Language())) as writer:
        page = writer.finish(head, replace(total(()), efforts=efforts), None, {}).parent / "method.html"
    table = html.parse(str(page)).xpath("//*[@aria-labelledby='effort']/table/tbody/tr")
    return [["".join(cell.itertext()).strip() for cell in row] for row in table]


def test_the_method_page_says_what_decided(tmp_path: Path) -> None:
    effort = Effort(analyses=1234, decided=[1000, 200, 34], sets=50, verdicts=9, numbers=3, needing=617)
    found = rows(tmp_path, {"Sliding <b>": effort.plain()})
    assert [" ".join(cell.split()) for cell in found[0]] == ["Sliding <b>", "1,234", "1,000", "200", "34", "50 %"]


def test_a_run_that_did_not_count_has_no_table(tmp_path: Path) -> None:
    assert rows(tmp_path, {}) == []
