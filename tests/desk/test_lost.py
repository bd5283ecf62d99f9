"""A desk that does not answer, and a session that has ended, while somebody is at work in a real Chromium."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from pipeline.desk.serving import add_user
from pipeline.settings import load_settings
from pipeline.store.decisions import read_decisions
from tests.report.test_accessible import violations_here

from .test_guard import serve
from .test_paths import engine_of, press, see, sign
from .visiting import address_of, served

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytestmark = pytest.mark.browser

WHY = "The case is rebuilt in May"


@pytest.fixture(autouse=True)
def _drained(browser: Chrome) -> Iterator[None]:
    """Leave to the tests that follow no complaint about what was cut off here."""
    yield
    browser.get_log("browser")


def told(browser: Chrome, words: str) -> None:
    WebDriverWait(browser, 10, 0.05).until(lambda b: words in b.find_element(By.ID, "lost").text)


def cut(browser: Chrome, *, off: bool) -> None:
    browser.execute_cdp_cmd("Network.enable", {})
    throughput = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
    browser.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": off, **throughput})


def test_a_lost_connection_is_told_and_what_was_typed_is_sent_later(museum: Path, browser: Chrome) -> None:
    with served(museum) as there:
        browser.get(there)
        browser.delete_all_cookies()
        cut(browser, off=True)
        try:
            see(browser, "input[type=search]").send_keys("vase")
            told(browser, "does not answer")
            assert not violations_here(browser)
            cut(browser, off=False)
            see(browser, "input[type=search]").send_keys(" 3")
            told(browser, "")
            WebDriverWait(browser, 10, 0.05).until(lambda b: b.find_element(By.ID, "lost").text == "")
            browser.get(there + address_of("2.3"))
            see(browser, "#accept summary").click()
            sign(browser, "#accept", "A. Smith")
            see(browser, "#accept textarea").send_keys(WHY)
            cut(browser, off=True)
            see(browser, "#accept button").click()
            told(browser, "does not answer")
        finally:
            cut(browser, off=False)
        assert see(browser, "#accept textarea").get_attribute("value") == WHY
        # A cookie that is gone meanwhile makes no form too old.
        browser.delete_all_cookies()
        press(browser, see(browser, "#accept button"))
        assert "The next night" in see(browser, "[role=status]").text
    assert [made.why for made in read_decisions(engine_of(museum))] == [WHY]


@pytest.mark.long("test_a_lost_connection_is_told_and_what_was_typed_is_sent_later")
def test_a_session_that_ended_loses_nothing(museum: Path, browser: Chrome) -> None:
    serve(museum, 'identity = "accounts"')
    settings = load_settings(museum / "kouros.toml")
    add_user(settings, "Ed", "editor", "correct horse battery")

    def enter(password: str) -> None:
        see(browser, "input[name=name]").send_keys("Ed")
        see(browser, "input[name=password]").send_keys(password)
        press(browser, see(browser, "form.narrow button"))

    with served(museum) as there:
        browser.get(there)
        browser.delete_all_cookies()
        browser.get(there)
        enter("correct horse battery")
        browser.get(there + address_of("2.3"))
        see(browser, "#accept summary").click()
        see(browser, "#accept textarea").send_keys(WHY)
        add_user(settings, "Ed", "editor", "another under the sun")
        see(browser, "#accept button").click()
        told(browser, "no longer signed in")
        assert not read_decisions(engine_of(museum))
        first = browser.current_window_handle
        see(browser, "#lost a").click()
        WebDriverWait(browser, 10, 0.05).until(lambda b: len(b.window_handles) == 2)
        browser.switch_to.window(next(one for one in browser.window_handles if one != first))
        enter("another under the sun")
        browser.close()
        browser.switch_to.window(first)
        assert see(browser, "#accept textarea").get_attribute("value") == WHY
        press(browser, see(browser, "#accept button"))
        assert "The next night" in see(browser, "[role=status]").text
    assert [made.who for made in read_decisions(engine_of(museum))] == ["Ed"]
