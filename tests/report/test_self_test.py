"""The numerical self-test on the method page: what was found, whether it still holds, how to run it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from lxml import html

from pipeline.report import render

from . import builder

if TYPE_CHECKING:
    from selenium.webdriver import Chrome


def said(folder: Path, numerics: object) -> str:
    """Return the words of the section on the method page of a run that found this self-test."""
    record = builder.record()
    settings = {key: value for key, value in record.settings.items() if key != "numerics"}
    if numerics != "absent":
        settings["numerics"] = numerics
    page = render(replace(record, settings=settings), folder / "report").parent / "method.html"
    (heading,) = html.parse(str(page)).xpath("//h2[@id='selftest']")
    words = []
    for part in heading.itersiblings():
        if part.tag == "h2":
            break
        words += part.itertext()
    # A space that does not break is one all the same.
    return " ".join(" ".join(words).split())


@pytest.mark.parametrize("numerics", [None, "absent"])
def test_one_that_was_never_run_says_how(tmp_path: Path, numerics: object) -> None:
    """Also a run that was stored before there were self-tests, and is rendered again."""
    text = said(tmp_path, numerics)
    assert "It was not run before this report. Run kouros check --numerics beside kouros.toml" in text
    assert "cases" not in text


def test_one_that_passed(tmp_path: Path) -> None:
    text = said(tmp_path, builder.self_test())
    assert "All 3 cases passed on 2026-02-28 12:00:00 UTC (Linux x86_64, 2 cores, Python 3.11.2, version" in text
    assert "friction 0 it stays in space 2.4e-16 1e-09 ✓ passes" in text
    assert "outdated" not in text
    assert "Do not rely" not in text


def test_one_of_other_kernels_is_outdated(tmp_path: Path) -> None:
    text = said(tmp_path, builder.self_test(kernels="fedcba987654"))
    assert "This test is outdated: the numbers of this report were computed by other kernels." in text


def test_a_failure_is_named_before_the_table(tmp_path: Path) -> None:
    """A number beyond its limit, and none at all with what stopped it; the text is hostile, and stays text."""
    wrong = {"ok": False, "result": None, "problem": "ValueError: <b>no kernel</b>"}
    text = said(tmp_path, builder.self_test(**wrong))
    assert "1 of 3 cases failed" in text
    named = text.partition("All 3 cases")[0]
    assert "<script>alert(1)</script>): no number: ValueError: <b>no kernel</b>, limit 1e-09" in named
    assert "fails" in text


@pytest.mark.browser
def test_the_table_is_folded_and_opens(browser: Chrome, report: Path) -> None:
    browser.get((report / "method.html").as_uri())
    browser.set_window_size(500, 900)
    table = browser.find_element("css selector", "#selftest ~ details table")
    assert not table.is_displayed()
    browser.find_element("css selector", "#selftest ~ details summary").click()
    assert table.is_displayed()
    assert len(table.find_elements("css selector", "tbody tr")) == 3
    assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
