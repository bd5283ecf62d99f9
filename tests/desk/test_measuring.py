"""Measuring beside an object, on a telephone of 390 pixels in a real Chromium, with numbers as people write them."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from selenium.webdriver.common.by import By

from pipeline.collection.inventory import items_named
from pipeline.records import Item
from pipeline.settings import load_settings
from tests.museum import museum_of, night, short_site

from .test_paths import complaints, engine_of, press, see, sign
from .visiting import Visitor, address_of, served

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = pytest.mark.browser

WIDTH = 390
SAVE = "//button[text()='Save the measurements']"


@pytest.fixture
def running(museum: Path, browser: Chrome) -> Iterator[str]:
    browser.set_window_size(1300, 900)
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": WIDTH, "height": 844, "deviceScaleFactor": 2, "mobile": True},
    )
    with served(museum) as address:
        yield address
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def item(museum: Path, number: str) -> Item:
    return items_named(engine_of(museum), [number])[number]


def open_cells(browser: Chrome, address: str, number: str) -> None:
    browser.get(address + address_of(number) + "&open=measure")
    if not see(browser, "#m-clearance_m").is_displayed():
        see(browser, "section[aria-labelledby=measure] details.wide > summary").click()
    sign(browser, "section[aria-labelledby=measure]", "A. Smith")


@pytest.mark.long("desk/test_saying::test_a_cell_that_is_no_measure_is_marked_and_nothing_is_saved")
def test_cells_are_taken_or_come_back_with_what_was_typed(running: str, browser: Chrome, museum: Path) -> None:
    """Lengths in inches and masses in pounds, unless the cell names its unit; refused, nothing of the form is saved."""
    before = item(museum, "1.2")
    open_cells(browser, running, "1.2")
    assert browser.execute_script("return innerWidth") == WIDTH
    wrong = {"clearance_m": "1,234", "mass_kg": "10-12", "friction": "0,3"}
    for field, text in wrong.items():
        see(browser, f"#m-{field}").send_keys(text)
    press(browser, browser.find_element(By.XPATH, SAVE))
    said = see(browser, "[role=alert]").text
    assert "may be thousands or decimals" in said
    assert "'10-12'" in said
    assert {field: see(browser, f"#m-{field}").get_attribute("value") for field in wrong} == wrong
    assert item(museum, "1.2") == before
    for field, text in {"clearance_m": '8 1/2"', "mass_kg": "about 3 kg", "friction": "0,3"}.items():
        cell = see(browser, f"#m-{field}")
        cell.clear()
        cell.send_keys(text)
    press(browser, browser.find_element(By.XPATH, SAVE))
    now = item(museum, "1.2")
    assert (now.clearance_m, now.mass_kg, now.friction) == (0.2159, 3.0, 0.3)
    told = {of.field: of.written for of in now.provenance}
    assert (told["clearance_m"], told["mass_kg"]) == ('8 1/2"', "about 3 kg")
    open_cells(browser, running, "1.3")
    see(browser, "#m-clearance_m").send_keys("30 cm")
    see(browser, "#m-mass_kg").send_keys("5 1/2")
    press(browser, browser.find_element(By.XPATH, SAVE))
    now = item(museum, "1.3")
    assert now.clearance_m == 0.3
    assert now.mass_kg == pytest.approx(5.5 * 0.45359237, rel=1e-12)
    # Refused forms are answered as such (422), which a browser writes down.
    assert [one for one in complaints(browser) if "422" not in one] == []


@pytest.mark.long("desk/test_paths::test_every_page_fits_and_breaks_no_rule_of_wcag")
def test_the_cells_fit_and_can_be_touched(running: str, browser: Chrome) -> None:
    for path in (address_of("1.2") + "&open=measure", "/house", "/survey"):
        browser.get(running + path)
        assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth"), path
        small = browser.execute_script(
            "return [...document.querySelectorAll('main input:not([type=hidden]),main select,main button')]"
            ".filter(e => e.offsetParent && e.getBoundingClientRect().height < 24).map(e => e.outerHTML.slice(0, 80))"
        )
        assert small == [], path


def test_the_rules_that_answer_most_come_first(tmp_path: Path) -> None:
    """What stands twelve times as high as it is deep is held somehow: one rule says how for all six, not for four."""
    tall = [
        {"object_number": f"{kind}{n}", "title": kind, "object_name": kind, "gallery": "East", "height_m": "1.2",
         "width_m": "0.1", "depth_m": "0.1", "medium": medium}
        for kind, medium, count in (("vase", "earthenware", 6), ("chair", "wood", 4))
        for n in range(count)
    ]  # fmt: skip
    folder = tmp_path / "tall"
    museum_of(folder, tall, furnished=True)
    shutil.rmtree(folder / "site")
    short_site(folder)
    night(load_settings(folder / "kouros.toml"))
    with served(folder) as address:
        visitor = Visitor(address)
        page = visitor.get("/house").page
        shown = [" ".join(one.text_content().split()) for one in page.xpath("//section[@aria-labelledby='asked']//li")]
        assert shown == ["Vessel: how they are held 6 objects"]
        (there,) = page.xpath("//section[@aria-labelledby='asked']//a/@href")
        chosen = visitor.get(str(there)).page
        assert chosen.xpath("//select[@name='class']/option[@selected]/@value") == ["vessel"]
        assert chosen.xpath("//select[@name='states']/option[@selected]/@value") == ["held"]
