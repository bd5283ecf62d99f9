"""The report of the real demonstration in a real Chromium: every page whole, light and quiet."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from lxml import etree

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = [pytest.mark.browser, pytest.mark.slow_file]

STORED = "not-on-display.html"
OTHERS = {"index.html", "motion.html", "method.html"}
PAGE_WIDTH, PAGE_HEIGHT = 178 / 25.4 * 96, 261 / 25.4 * 96  # A4 less the margins of the style sheet, in CSS pixels
MOTIONS = 11
NAMES = ("index", "largest", "stored", "motion", "method")


def _galleries(folder: Path) -> list[Path]:
    return sorted(p for p in folder.glob("*.html") if p.name not in OTHERS)


@pytest.fixture(scope="session")
def sizes(demo_report: Path) -> dict[Path, int]:
    """Objects on each gallery's page, counted in its table."""
    return {
        p: len(etree.parse(str(p)).findall(".//table[@class='list rows']/tbody/tr")) for p in _galleries(demo_report)
    }


@pytest.fixture(scope="session")
def pages(demo_report: Path, sizes: dict[Path, int]) -> dict[str, Path]:
    shown = {p: n for p, n in sizes.items() if p.name != STORED}
    named = {name: demo_report / f"{name}.html" for name in ("index", "motion", "method")}
    return named | {"largest": max(shown, key=lambda p: shown[p]), "stored": demo_report / STORED}


@contextmanager
def _emulated(browser: Chrome, command: str, on: dict[str, object], off: dict[str, object]) -> Iterator[None]:
    browser.execute_cdp_cmd(f"Emulation.{command}", on)
    try:
        yield
    finally:
        browser.execute_cdp_cmd(f"Emulation.{command}", off)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("width", [1280, 500])
def test_it_opens_quietly_and_without_a_sideways_scroll(
    browser: Chrome, pages: dict[str, Path], name: str, width: int
) -> None:
    browser.set_window_size(width, 900)
    browser.get(pages[name].as_uri())
    assert browser.get_log("browser") == []
    assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")


def test_the_first_gallery_is_reached_from_the_index_and_photographed(
    browser: Chrome, pages: dict[str, Path], tmp_path: Path
) -> None:
    browser.set_window_size(1280, 900)
    browser.get(pages["index"].as_uri())
    browser.find_elements("css selector", "section[aria-labelledby=galleries] tbody a")[0].click()
    assert browser.find_element("css selector", "h1").text
    picture = tmp_path / "gallery.png"
    assert browser.save_screenshot(str(picture))
    written = picture.read_bytes()
    assert written.startswith(b"\x89PNG\r\n\x1a\n")
    assert len(written) > 20_000  # a blank page of this size has some 5,000 bytes


@pytest.mark.parametrize("name", NAMES)
def test_it_is_whole_with_scripts_off(browser: Chrome, pages: dict[str, Path], name: str) -> None:
    """What the browser shows with scripts off is what the file holds: as many headings, entries and drawings."""
    parsed = etree.parse(str(pages[name]))
    held = {tag: len(list(parsed.iter(tag))) for tag in ("h2", "h3", "article", "figure", "tr", "use")}
    with _emulated(browser, "setScriptExecutionDisabled", {"value": True}, {"value": False}):
        browser.get(pages[name].as_uri())
        shown = {tag: len(browser.find_elements("css selector", tag)) for tag in held}
        heading = browser.find_element("css selector", "h1").text
    assert shown == held
    assert heading


def test_the_list_of_objects_tells_how_many_it_shows(browser: Chrome, demo_report: Path) -> None:
    """The inventory has 2,000 rows, and only one of the number 2016.7."""
    for sought, told in (("", "2,000 shown"), ("#find=2016.7", "1 shown")):
        browser.get("about:blank")
        browser.get((demo_report / "objects.html").as_uri() + sought)
        assert browser.find_element("css selector", "output").text == told


def test_no_gallery_is_heavy(sizes: dict[Path, int]) -> None:
    assert sum(sizes.values()) == 1374  # the demonstration's inventory, what is on display of it
    heavy = {p.name: p.stat().st_size for p, n in sizes.items() if p.stat().st_size >= 1.75e6 * max(1.0, n / 300)}
    assert heavy == {}


def test_the_motion_page_shows_the_papers_figures(browser: Chrome, pages: dict[str, Path]) -> None:
    browser.get(pages["motion"].as_uri())
    told = [e.text for e in browser.find_elements("css selector", ".pair figcaption")]
    for figure in range(2, 7):
        assert sum(f"Figure {figure}" in text for text in told) == MOTIONS
    boxes = browser.execute_script(
        "return [...document.querySelectorAll('.pair use')].map(u => u.getBoundingClientRect().width)"
    )
    assert len(boxes) == len(told) >= 6 * MOTIONS
    assert min(boxes) > 200


@pytest.mark.parametrize("name", ["largest"])
def test_every_entry_fits_a_printed_page_so_that_none_is_cut(
    browser: Chrome, pages: dict[str, Path], name: str
) -> None:
    """An entry that may not be broken and is shorter than A4 keeps its heading and its charts on one sheet."""
    metrics = {"width": round(PAGE_WIDTH), "height": round(PAGE_HEIGHT), "deviceScaleFactor": 1, "mobile": False}
    browser.get(pages[name].as_uri())
    browser.find_element("id", "with-entries").click()  # They are printed on demand only.
    try:
        with _emulated(browser, "setEmulatedMedia", {"media": "print"}, {"media": ""}):
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
            rules, tallest = browser.execute_script(
                "const c = [...document.querySelectorAll('.card')], f = [...document.querySelectorAll('figure')];"
                "return [[...new Set([...c, ...f].map(e => getComputedStyle(e).breakInside))],"
                " Math.max(...c.map(e => e.getBoundingClientRect().height))]"
            )
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert rules == ["avoid"]
    assert 100 < tallest < PAGE_HEIGHT
