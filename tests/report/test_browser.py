"""The report in a real Chromium, from the disk, as a curator opens it."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from pipeline.mitigate.saying import IN_WARMTH
from pipeline.report import render

from . import builder

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = pytest.mark.browser

LONG = pytest.mark.long("test_it_opens_without_complaint_and_without_a_sideways_scroll")


@pytest.fixture(
    scope="session",
    params=(
        *("index", "gallery-101", "salon", "motion"),
        *(pytest.param(kind, marks=LONG) for kind in ("objects", "news", "not-on-display", "method")),
    ),
)
def page(request: pytest.FixtureRequest, report: Path) -> Path:
    return next(report.glob(f"{request.param}*.html"))


def test_it_opens_without_complaint_and_without_a_sideways_scroll(browser: Chrome, page: Path, tmp_path: Path) -> None:
    for width in (1280, 500):
        browser.set_window_size(width, 900)
        browser.get(page.as_uri())
        assert [e for e in browser.get_log("browser") if e["level"] == "SEVERE"] == []
        assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    picture = tmp_path / "page.png"
    assert browser.save_screenshot(str(picture))
    assert picture.stat().st_size > 10_000


def test_no_hostile_text_became_an_element(browser: Chrome, page: Path) -> None:
    browser.get(page.as_uri())
    assert browser.execute_script("return document.querySelectorAll('main script, img, b, iframe').length") == 0


def test_text_has_the_contrast_of_wcag_aa(browser: Chrome, page: Path) -> None:
    """4.5 to 1 for every visible text against the nearest painted background (WCAG 2.2, success criterion 1.4.3)."""
    browser.get(page.as_uri())
    worst = browser.execute_script(
        """
        const lum = c => { const v = c.map(x => { x /= 255;
          return x <= .04045 ? x / 12.92 : ((x + .055) / 1.055) ** 2.4 });
          return .2126 * v[0] + .7152 * v[1] + .0722 * v[2] };
        const rgb = s => s.match(/[\\d.]+/g).map(Number);
        let worst = 99;
        for (const e of document.querySelectorAll('body *')) {
          if (e.closest('svg') || !e.textContent.trim() || !e.offsetParent) continue;
          let b = e, back = [255, 255, 255];
          for (; b; b = b.parentElement) { const c = rgb(getComputedStyle(b).backgroundColor);
            if (c.length === 3 || c[3] === 1) { back = c; break } }
          const [p, q] = [lum(rgb(getComputedStyle(e).color)), lum(back)].sort((x, y) => y - x);
          worst = Math.min(worst, (p + .05) / (q + .05));
        }
        return worst
        """
    )
    assert worst >= 4.5


def test_it_is_whole_with_scripts_off(browser: Chrome, report: Path) -> None:
    page = next(report.glob("gallery-101*.html"))
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        browser.get(page.as_uri())
        text = browser.find_element("css selector", "main").text
    finally:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
    assert "What to do first" in text
    assert "Fasten the object to its base" in text


def test_charts_are_painted_where_they_are_used(browser: Chrome, report: Path) -> None:
    browser.get(next(report.glob("gallery-101*.html")).as_uri())
    boxes = browser.execute_script(
        "return [...document.querySelectorAll('figure use')]"
        ".map(u => u.getBoundingClientRect()).map(r => [r.width, r.height])"
    )
    assert boxes
    assert all(width > 200 and height > 120 for width, height in boxes)


def test_it_prints_on_the_printers_paper_with_its_details(browser: Chrome, report: Path) -> None:
    browser.get(next(report.glob("gallery-101*.html")).as_uri())
    browser.find_element("id", "with-entries").click()  # They are printed on demand only.
    for wide, high in ((210.0 / 25.4, 297.0 / 25.4), (8.5, 11.0)):
        paper = {"paperWidth": wide, "paperHeight": high, "preferCSSPageSize": True, "printBackground": False}
        pdf = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", paper)["data"])
        assert pdf.startswith(b"%PDF-")
        boxes = [[float(v) for v in box.split()] for box in re.findall(rb"/MediaBox \[([\d. ]+)\]", pdf)]
        # In points of 1/72 inch, of which Chromium makes whole pixels of 1/96.
        assert boxes == [pytest.approx([0.0, 0.0, 72.0 * wide, 72.0 * high], abs=0.75)] * len(boxes) != []
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        shown, split = browser.execute_script(
            "const c = [...document.querySelectorAll('.card')];"
            "return [[...document.querySelectorAll('.card details p')].every(p => p.offsetHeight > 10),"
            " c.map(e => getComputedStyle(e).breakInside)]"
        )
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    assert shown
    assert set(split) == {"avoid"}


def test_an_errand_on_paper_without_the_entries_says_what_has_to_be_minded(browser: Chrome, tmp_path: Path) -> None:
    """What only the entry said would be lost with it; on the screen, where the entry stands below, it is said there."""
    record = builder.record()
    assessments = list(record.assessments)
    at = next(i for i, one in enumerate(assessments) if one.recommendations)
    told = assessments[at].recommendations[0]
    minded = replace(told, sentence=f"{told.sentence} {IN_WARMTH}", measure="alone", title="Dots of wax")
    assessments[at] = replace(assessments[at], recommendations=(minded,))
    render(replace(record, assessments=tuple(assessments)), tmp_path / "report")
    (page,) = (one for one in (tmp_path / "report").glob("*.html") if 'class="small paper"' in one.read_text("utf-8"))
    browser.get(page.as_uri())
    errand = browser.find_element("css selector", ".first li p.paper")
    assert not errand.is_displayed()
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        assert errand.text == IN_WARMTH
        browser.execute_script("document.getElementById('with-entries').checked = true")
        assert not errand.is_displayed()
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
