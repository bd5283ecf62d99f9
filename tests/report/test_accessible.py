"""Every kind of page against axe-core in a real Chromium: no violation of WCAG 2.2, levels A and AA."""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from pipeline.records import Verdict
from pipeline.report import render
from tests.soak import SOAK

from . import builder

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = pytest.mark.browser

AXE = Path(__file__).parent.parent / "data" / "axe" / "axe.min.js"
TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
KINDS = ("index", "news", "gallery-101", "salon", "not-on-display", "motion", "method")
LONG = pytest.mark.long("test_no_page_violates_wcag")
SHORT = {(1280, "gallery-101"), (500, "news")}
"""What `make test` looks at, a page at each width."""


def violations(browser: Chrome, page: Path) -> list[str]:
    """Return what axe finds in a page of a report."""
    browser.get(page.as_uri())
    return violations_here(browser)


def violations_here(browser: Chrome, rule: str = "") -> list[str]:
    """Return what axe finds in the page that is shown: the rule and the element, one line each.

    rule : the only one that is looked at; "" for all
    """
    # The pages' own policy lets no other script run in them; the driver puts it in past that policy.
    browser.execute_script(AXE.read_text(encoding="utf-8"))
    found = browser.execute_async_script(
        "const done = arguments[2]; axe.run(document, {runOnly: {type: arguments[0], values: arguments[1]}})"
        ".then(r => done({passes: r.passes.length, violations: r.violations.flatMap(v => v.nodes.map("
        "n => v.id + ': ' + n.target + ': ' + n.failureSummary))})).catch(e => done({error: String(e)}))",
        *(("rule", [rule]) if rule else ("tag", TAGS)),
    )
    assert found.get("passes", 0) > (0 if rule else 10), found
    listed: list[str] = found["violations"]
    return listed


def test_the_checker_is_the_one_that_is_described() -> None:
    described = (AXE.parent / "README.md").read_text(encoding="utf-8")
    assert sha256(AXE.read_bytes()).hexdigest() in described


def test_it_sees_a_violation(browser: Chrome, tmp_path: Path) -> None:
    """A check that cannot fail is none: a picture without words, and grey on grey."""
    page = tmp_path / "bad.html"
    page.write_text(
        '<!DOCTYPE html><html lang="en"><head><title>t</title></head><body><main><h1>h</h1>'
        '<svg role="img" width="9" height="9"></svg><p style="color:#aaa;background:#bbb">grey</p></main>'
        "</body></html>",
        encoding="utf-8",
    )
    rules = {line.partition(":")[0] for line in violations(browser, page)}
    assert rules == {"svg-img-alt", "color-contrast"}


@pytest.mark.parametrize(
    ("width", "kind"),
    # Each page in one of both widths, in turn; in both by `make soak`.
    [
        pair if pair in SHORT else pytest.param(*pair, marks=LONG)
        for at, pair in enumerate(product((1280, 500), KINDS))
        if SOAK or at % 2 == 0
    ],
)
def test_no_page_violates_wcag(browser: Chrome, report: Path, kind: str, width: int) -> None:
    browser.set_window_size(width, 900)
    assert violations(browser, next(report.glob(f"{kind}*.html"))) == []


def test_opened_details_violate_nothing_either(browser: Chrome, report: Path) -> None:
    page = next(report.glob("gallery-101*.html"))
    opened = page.with_name("opened.html")
    opened.write_text(page.read_text(encoding="utf-8").replace("<details>", '<details open="open">'), encoding="utf-8")
    try:
        assert violations(browser, opened) == []
    finally:
        opened.unlink()


def test_lines_between_neighbours_violate_nothing(browser: Chrome, tmp_path: Path) -> None:
    """The plan with a line of either kind, and the table of gaps below it."""
    pairs = (
        builder.gap("79.AA.143", "82.AB.7", Verdict.FAIL),
        builder.gap("83.AC.10", "82.AB.7", Verdict.UNDETERMINED),
    )
    index = render(replace(builder.record(), spacings=pairs), tmp_path / "r")
    page = next(index.parent.glob("gallery-101*.html"))
    assert page.read_text(encoding="utf-8").count('role="img" d="M') == 2
    assert violations(browser, page) == []
