"""The list of all objects: complete, in the order in which people count, searched by typing, plain without a script."""

from __future__ import annotations

import csv
from collections import Counter
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from selenium.webdriver.common.by import By

from pipeline.quantities import sorting_key
from pipeline.report.files.object_list import LISTED, listed_pages, listed_part
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.report_writer import ReportWriter
from pipeline.report.language import Language
from pipeline.report.render import draw_all, pages_of
from pipeline.report.units import Units

from . import builder

if TYPE_CHECKING:
    from selenium.webdriver import Chrome


@given(
    st.lists(st.integers(0, 10**12), min_size=1, max_size=4), st.lists(st.integers(0, 10**12), min_size=4, max_size=4)
)
def test_numbers_are_sorted_as_people_count(one: list[int], other: list[int]) -> None:
    """1913.3 comes before 1913.20: as tuples of whole numbers do."""
    keys = [sorting_key(".".join(map(str, parts))) for parts in (one, other)]
    assert (keys[0] < keys[1]) == (tuple(one) < tuple(other))


@pytest.mark.parametrize("shown", [1, 7, 5_000])
def test_every_row_is_on_one_page_and_pages_follow_each_other(shown: int, tmp_path: Path) -> None:
    numbers = [f"{year}.{at}" for year in (99, 1913, 2016) for at in range(1, 41)]
    mixed = Random(3).sample(numbers, len(numbers))
    parts = []
    for begin in range(0, len(mixed), 25):
        parts.append(tmp_path / f"{begin}.{LISTED}")
        parts[-1].write_bytes(listed_part(mixed[begin : begin + 25], [f"<{n}>" for n in mixed[begin : begin + 25]]))
    pages, rows = listed_pages(parts, shown)
    told = list(rows)
    assert len(pages) == len(told) == -(-len(numbers) // shown)
    assert "".join(told) == "".join(f"<{number}>" for number in numbers)
    assert all(
        told[at].startswith(f"<{page.first}>") and told[at].endswith(f"<{page.last}>") for at, page in enumerate(pages)
    )


def test_a_museum_without_objects_has_an_empty_list() -> None:
    pages, rows = listed_pages([])
    assert ([page.file for page in pages], list(rows)) == (["objects.html"], [""])


def test_the_list_has_what_the_exports_have(report: Path) -> None:
    """Each object once, with the page, the gallery and the state of objects.csv."""
    listed = Counter(
        (row[0][0].get("href"), row[2].findtext("bdi"), row.get("data-s"))
        for row in etree.parse(str(report / "objects.html")).iterfind(".//table/tbody/tr")
    )
    with (report / "objects.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    state = {"not on display": "aside"}
    exported = Counter((row["page"], row["gallery"], state.get(row["state"], row["state"])) for row in rows)
    assert len(rows) == len(builder.record().assessments)
    assert {(page, one) for page, _, one in listed} == {(page, one) for page, _, one in exported}
    assert sum(listed.values()) == len(rows)


def _shown(browser: Chrome) -> list[str]:
    rows = browser.find_elements(By.CSS_SELECTOR, "table.objects tbody tr")
    return [row.find_element(By.TAG_NAME, "th").text for row in rows if row.is_displayed()]


@pytest.mark.browser
def test_an_object_is_found_by_typing_and_the_address_keeps_it(browser: Chrome, report: Path) -> None:
    page = (report / "objects.html").as_uri()
    browser.get(page)
    every = _shown(browser)
    assert len(every) == len(builder.record().assessments)
    field = browser.find_element(By.CSS_SELECTOR, "input[type=search]")
    assert field.is_displayed()
    field.send_keys("H.1")
    assert "H.1" in _shown(browser)
    assert len(_shown(browser)) < len(every)
    address = browser.current_url
    assert address.endswith("#find=H.1")
    browser.get("about:blank")
    browser.get(address)
    assert browser.find_element(By.CSS_SELECTOR, "input[type=search]").get_attribute("value") == "H.1"
    assert len(_shown(browser)) < len(every)
    browser.get("about:blank")
    browser.get(f"{page}#state=act;gallery=nowhere;find=%;constructor=x")
    states = {
        row.get_attribute("data-s") for row in browser.find_elements(By.CSS_SELECTOR, "tbody tr") if row.is_displayed()
    }
    assert states == {"act"}


@pytest.mark.browser
def test_it_is_a_plain_list_with_scripts_off(browser: Chrome, report: Path) -> None:
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        browser.get((report / "objects.html").as_uri())
        assert len(_shown(browser)) == len(builder.record().assessments)
        assert not browser.find_element(By.CSS_SELECTOR, "input[type=search]").is_displayed()
    finally:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


@pytest.mark.browser
def test_a_number_of_another_page_of_the_list_is_pointed_to(browser: Chrome, tmp_path: Path) -> None:
    record = builder.crowd(30)
    with ReportWriter(tmp_path / "r", PageRenderer(record, Units(), Language()), listed=8) as writer:
        index = draw_all(writer, record, pages_of(record), None)
    assert sorted(file.name for file in index.parent.glob("objects*.html")) == [
        "objects-2.html", "objects-3.html", "objects-4.html", "objects.html",
    ]  # fmt: skip
    browser.get((index.parent / "objects-4.html").as_uri())
    last = _shown(browser)[-1]
    browser.get((index.parent / "objects.html").as_uri())
    browser.find_element(By.CSS_SELECTOR, "input[type=search]").send_keys(last)
    browser.find_element(By.CSS_SELECTOR, "output a").click()
    assert browser.current_url.endswith(f"objects-4.html#find={last}")
    assert _shown(browser) == [last]
