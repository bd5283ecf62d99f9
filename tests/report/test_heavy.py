"""A gallery of 300 real objects: its weight, how soon it can be used, and that paper cuts none of its pictures."""

from __future__ import annotations

import base64
import re
import zlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from lxml import etree
from selenium.webdriver.support.ui import WebDriverWait

from pipeline.records import RunRecord
from pipeline.report import render

from .crowded import COUNT, resampled

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = pytest.mark.browser

MOST_BYTES = 1_515_000
"""The aim is about 1.5 MB; what a page says of the body that its numbers are of takes 1 % of it.

62 % of these objects are to be acted on, and each of them has a card: sizes are assumed where a record has none.
"""
SLOW = 5.0
"""Seconds.  The aim is 1 s on a desk; a build machine that runs other tests beside it may take some times that."""


@pytest.fixture(scope="module")
def record(demo_record: RunRecord) -> RunRecord:
    return demo_record


@pytest.fixture(scope="module")
def page(record: RunRecord, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _gallery(render(resampled(record), tmp_path_factory.mktemp("heavy") / "one"))


def _gallery(index: Path) -> Path:
    (page,) = index.parent.glob("sample-*.html")
    return page


def test_it_holds_three_hundred_objects_and_is_light(page: Path) -> None:
    parsed = etree.parse(str(page))
    assert len(parsed.findall(".//table[@class='list rows']/tbody/tr")) == COUNT
    assert len([e for e in parsed.iter("svg") if e.get("class") == "plan"]) == 1
    assert page.stat().st_size < MOST_BYTES


def test_it_can_be_used_soon(browser: Chrome, page: Path, record_property: pytest.RecordProperty) -> None:
    """From the start of the load until the script has made the table sortable and two frames were painted."""
    browser.set_window_size(1280, 900)
    took = []
    for _ in range(3):
        browser.get("about:blank")
        browser.get(page.as_uri())
        took.append(
            browser.execute_async_script(
                "const done = arguments[0]; const look = () => document.querySelector('.list thead button')"
                "? requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() / 1000)))"
                ": setTimeout(look, 10); look()"
            )
        )
    record_property("seconds_to_interactive", took)
    print(f"interactive after {min(took):.2f} s, {page.stat().st_size / 1e6:.2f} MB")
    assert min(took) < SLOW


def test_sorting_and_filtering(browser: Chrome, page: Path) -> None:
    browser.get(page.as_uri())
    # On a machine that is busy the page is there before its script has run.
    WebDriverWait(browser, 20.0, 0.05).until(lambda b: len(b.find_elements("css selector", ".list thead button")) == 5)
    buttons = browser.find_elements("css selector", ".list thead button")
    before = browser.execute_script("return [...document.querySelectorAll('.list tbody tr')].map(r => r.dataset.p)")
    buttons[2].click()
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('.list tbody tr')].map(r => Number(r.dataset.u || -1))"
    )
    assert sizes == sorted(sizes, reverse=True)
    buttons[4].click()
    after = browser.execute_script("return [...document.querySelectorAll('.list tbody tr')].map(r => r.dataset.p)")
    assert after == before == [str(i) for i in range(COUNT)]
    browser.execute_script(
        "const s = document.querySelector('#tools select'); s.value = 'watch'; s.dispatchEvent(new Event('change'))"
    )
    states = browser.execute_script(
        "return [...document.querySelectorAll('.list tbody tr')].filter(r => !r.hidden).map(r => r.dataset.s)"
    )
    assert set(states) == {"watch"}
    assert browser.find_element("css selector", "#tools output").text.startswith(f"{len(states)} ")


@pytest.mark.long("report/test_demo::test_every_entry_fits_a_printed_page_so_that_none_is_cut")
def test_paper_cuts_no_picture_in_two(browser: Chrome, record: RunRecord, tmp_path: Path) -> None:
    """Each chart is painted on a ground of a colour that nothing else has: the PDF then fills one rectangle a chart.

    A chart that the end of a sheet had cut would be filled twice, once on either sheet.
    """
    # What stands in furniture is on no chart of the motion of the floor.
    marked = [a for a in record.assessments if any(finding.mark for finding in a.findings)]
    few = resampled(replace(record, assessments=tuple(marked)), 40)
    browser.get(_gallery(render(few, tmp_path / "few")).as_uri())
    charts, kept = browser.execute_script(
        "const s = document.createElement('style');"
        "s.textContent = 'svg.chart, svg.plan { background: #0f0 !important; print-color-adjust: exact !important }';"
        "document.head.append(s);"
        # All that paper may show: the entries too, unfolded.
        "for (const d of document.querySelectorAll('details')) d.open = true;"
        "for (const c of document.querySelectorAll('input[type=checkbox]')) if (!c.checked) c.click();"
        "return ['svg.chart, svg.plan', 'figure, .card'].map(s => document.querySelectorAll(s).length)"
    )
    answer = browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True, "printBackground": True})
    assert kept > charts > 0
    assert _filled(base64.b64decode(answer["data"]), b"0 1 0") == charts


def _filled(pdf: bytes, colour: bytes) -> int:
    """Return how many rectangles the PDF's contents fill with a colour (operators rg, re and f)."""
    found = 0
    for packed in re.findall(rb"stream\r?\n(.*?)endstream", pdf, re.DOTALL):
        try:
            content = zlib.decompress(packed)
        except zlib.error:
            continue  # A font or a table of references.
        parts = re.split(rb"(?:^|\s)([\d.]+ [\d.]+ [\d.]+) rg\s", content)
        found += sum(
            len(re.findall(rb" re\s+f\s", did))
            for now, did in zip(parts[1::2], parts[2::2], strict=True)
            if now == colour
        )
    return found
