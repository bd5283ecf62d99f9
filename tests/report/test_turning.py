"""From page to page in the order of the catalogue, also where pages are taken over from the night before."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from lxml import html

from pipeline.records import Page, RunRecord
from pipeline.report.files.manifest import PreviousReport, verify_report
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.report_writer import ReportWriter, page_key
from pipeline.report.language import Language
from pipeline.report.pages.compose import page_name
from pipeline.report.pages.tallies import total
from pipeline.report.render import pages_of
from pipeline.report.units import Units

from . import builder

GALLERIES = ("Gallery 1", "Salon <b>East</b>", "<!--turn-->", "Hall 7", "日本の間")


def in_galleries() -> RunRecord:
    """The builder's run, its objects on display again in each of some galleries."""
    shown = [one for one in builder.record().assessments if one.scene.item.on_display]
    parts = []
    for at, name in enumerate(GALLERIES):
        for one in shown:
            number = f"{at}-{one.scene.item.object_number}"
            item = replace(one.scene.item, gallery=name, object_number=number)
            scene = replace(one.scene, item=item)
            found = tuple(replace(finding, object_number=number) for finding in one.findings)
            advised = tuple(replace(each, object_number=number) for each in one.recommendations)
            parts.append(replace(one, scene=scene, findings=found, recommendations=advised))
    return replace(builder.record(), assessments=tuple(parts), decisions=(), wishes=None, spacings=())


RECORD = in_galleries()
HEAD = replace(RECORD, assessments=(), wishes=None, spacings=())


def night(folder: Path, previous: Path | None = None, without: str = "") -> int:
    """Make the report of the same run, perhaps without a gallery; return how many of its pages were drawn."""
    drawn, tallies = 0, []
    before = None if previous is None else PreviousReport.read(previous)
    with ReportWriter(folder, PageRenderer(HEAD, Units(), Language()), before) as writer:
        for page, found in pages_of(RECORD):
            if page.gallery == without:
                continue
            key = page_key(writer.renderer, page, ())
            drawn += not writer.has(key)
            drawing = writer.renderer.draw
            tallies.append(writer.reuse(key) if writer.has(key) else writer.add(key, drawing(page, found, ())))
        writer.finish(HEAD, total(tallies), None, {})
    return drawn


def file_of(page: Page) -> str:
    return page_name(page.gallery, page.number, on_display=page.on_display)


def links(file: Path) -> list[tuple[str, str, str]]:
    """Return the links to pages before and behind, above and below, as (which, file, name)."""
    found = html.fromstring(file.read_bytes().decode()).xpath("//p[contains(@class, 'turn')]//a")
    return [(a.get("rel"), a.get("href"), a.text_content()) for a in found]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("turning") / "one"
    night(folder)
    return folder


def test_one_can_turn_the_pages_of_all_galleries_and_back(report: Path) -> None:
    galleries = [page for page, _ in pages_of(RECORD) if page.on_display]
    assert len(galleries) > 3
    for at, page in enumerate(galleries):
        near = [("prev", galleries[at - 1])] if at else []
        near += [("next", galleries[at + 1])] if at + 1 < len(galleries) else []
        told = links(report / file_of(page))
        # Above and below.
        assert [(which, file) for which, file, _name in told] == [(which, file_of(one)) for which, one in near] * 2
        assert all((report / file).is_file() for _which, file, _name in told)
    # A name is a text, whatever it says.
    names = {name for page in galleries for _which, _file, name in links(report / file_of(page))}
    assert names == set(GALLERIES)


def test_pages_are_taken_over_and_only_their_neighbours_say_another(report: Path, tmp_path: Path) -> None:
    before = {path.name: path.read_bytes() for path in report.glob("*.html")}
    assert night(tmp_path / "same", report) == 0
    pages = [page for page, _ in pages_of(RECORD)]
    assert all((tmp_path / "same" / file_of(page)).samefile(report / file_of(page)) for page in pages)
    gone = [page for page in pages if page.on_display][2]
    assert night(tmp_path / "less", report, without=gone.gallery) == 0
    night(tmp_path / "fresh", without=gone.gallery)
    written = []
    for page in pages:
        if page != gone:
            file = tmp_path / "less" / file_of(page)
            assert file.read_bytes() == (tmp_path / "fresh" / file.name).read_bytes()
            written += [] if file.samefile(report / file.name) else [page]
    shown = [page for page in pages if page.on_display]
    assert written == [shown[1], shown[3]]
    # The earlier report is as it was, and both are as their manifests say.
    assert {path.name: path.read_bytes() for path in report.glob("*.html")} == before
    assert not [*verify_report(tmp_path / "less"), *verify_report(report)]
