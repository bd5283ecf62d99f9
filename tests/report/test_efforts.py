"""What decided the verdicts of a run, on the method page."""

from dataclasses import replace
from pathlib import Path

from lxml import html

from pipeline.climb import Effort
from pipeline.report import render

from . import builder


def rows(folder: Path, efforts: list[dict[str, object]] | None) -> list[list[str]]:
    """Return the rows of the table on the method page of a run that stored these efforts; none without the table."""
    record = builder.record()
    settings = {**record.settings} if efforts is None else {**record.settings, "efforts": efforts}
    page = render(replace(record, settings=settings), folder / "report").parent / "method.html"
    table = html.parse(str(page)).xpath("//h3[@id='effort']/following-sibling::table[1]/tbody/tr")
    return [["".join(cell.itertext()).strip() for cell in row] for row in table]


def test_the_method_page_says_what_decided(tmp_path: Path) -> None:
    effort = Effort(analyses=1234, decided=[1000, 200, 34], sets=50, verdicts=9, numbers=3, needing=617)
    found = rows(tmp_path, [{"title": "Sliding <b>", **effort.plain()}])
    assert [" ".join(cell.split()) for cell in found[0]] == ["Sliding <b>", "1,234", "1,000", "200", "34", "50 %"]


def test_a_run_that_did_not_count_has_no_table(tmp_path: Path) -> None:
    """Runs stored before there was `auto` are rendered again, too."""
    assert rows(tmp_path, None) == []
