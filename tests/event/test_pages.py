"""The page of an earthquake and its sheets in a real Chromium: on a desk, on a telephone and on paper."""

from __future__ import annotations

import base64
import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pypdf import PdfReader

from tests.event.messages import DATA
from tests.event.test_command import ask, museum, night
from tests.report.conftest import browser
from tests.report.test_accessible import violations
from tests.soak import soaked

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

__all__ = ["browser", "museum", "night"]

pytestmark = pytest.mark.browser


@pytest.fixture
def answer(museum: Path) -> Path:
    return ask(museum, DATA / "loma_prieta_grid.xml").folder


@pytest.mark.parametrize("width", [pytest.param(1300, marks=soaked), 390])
def test_page_and_sheets_fit_and_break_no_rule_of_wcag(answer: Path, browser: Chrome, width: int) -> None:
    size = {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        for file in ("index.html", sorted(answer.glob("sheet-*.html"))[0].name):
            found = violations(browser, answer / file)
            assert browser.execute_script("return innerWidth") == width
            assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth"), file
            if os.environ.get("KOUROS_SCREENSHOTS"):
                browser.save_screenshot(f"{os.environ['KOUROS_SCREENSHOTS']}/{file[:5]}-{width}.png")
            assert found == [], file
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_a_sheet_is_printed_whole(answer: Path, browser: Chrome) -> None:
    """Every object, every state to tick, on one page of A4 upright: nothing is cut at the edge of the paper."""
    for file in sorted(answer.glob("sheet-*.html")):
        browser.get(file.as_uri())
        told = {"preferCSSPageSize": True, "printBackground": True}
        data = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", told)["data"])
        if os.environ.get("KOUROS_SCREENSHOTS"):
            Path(os.environ["KOUROS_SCREENSHOTS"], f"{file.stem}.pdf").write_bytes(data)
        pages = PdfReader(io.BytesIO(data)).pages
        assert len(pages) == 1
        text = " ".join(pages[0].extract_text().split())
        rows = len(browser.find_elements("css selector", ".walk tbody tr"))
        for word in ("standing", "moved", "fallen", "broken"):
            assert text.count(word) >= rows > 0
        wide = browser.execute_script(
            "return [...document.querySelectorAll('.walk')].some(e => e.scrollWidth > e.clientWidth + 1)"
        )
        assert not wide
