"""The page in front of all reports, in a real Chromium too: local time, the last nights, red where no night is good."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo

import pytest

from pipeline.errors import FAULT
from pipeline.operations.run_summary import plain_changes
from pipeline.records import ObjectChange, RunChanges
from pipeline.report import Language
from pipeline.report.pages.landing import days, landing_page, told

from .news_samples import ACT
from .test_accessible import violations

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

BAD = "<img src=x onerror=alert(1)>{{7*7}}"
LA = ZoneInfo("America/Los_Angeles")


def night(began: str, state: str = "good") -> dict[str, str]:
    return {"began": began, "ended": "", "state": state, "run_id": ""}


def status(state: str = "good", hours: float = 1.0, **more: Any) -> dict[str, Any]:
    """A status whose last good night ended so many hours ago."""
    ended = (datetime.now(UTC) - timedelta(hours=hours)).isoformat(timespec="seconds")
    good = {"run_id": "r", "finished": ended, "report": "r/index.html", "counts": None, "news": None} | more
    nights = [night("2031-05-01T09:00:00+00:00"), night("2031-05-02T09:00:00+00:00", "failed")]
    return {"state": state, "since": ended, "message": BAD, "last_good": good, "nights": nights}


def page(folder: Path, said: dict[str, Any], zone: str = "UTC") -> Path:
    file = folder / "index.html"
    file.write_text(landing_page(said, f"Museum {BAD}", Language(), zone), encoding="utf-8")
    return file


def test_times_are_those_of_the_museum_in_summer_and_in_winter() -> None:
    """Los Angeles is 8 hours behind UTC, and 7 from 2026-03-08 on; in Kathmandu it is 5:45 later."""
    assert told(datetime(2026, 3, 8, 9, 59, tzinfo=UTC), LA) == "2026-03-08 01:59 PST"
    assert told(datetime(2026, 3, 8, 10, 0, tzinfo=UTC), LA) == "2026-03-08 03:00 PDT"
    assert told(datetime(2026, 3, 8, tzinfo=UTC), ZoneInfo("Asia/Kathmandu")) == "2026-03-08 05:45 UTC+0545"
    assert told(datetime(2026, 3, 8, tzinfo=UTC), UTC) == "2026-03-08 00:00 UTC"


def test_the_row_of_nights_is_that_of_fourteen_days_where_the_museum_is() -> None:
    # 06:30 UTC is the evening before in Los Angeles.
    nights = [night(f"2026-11-{day:02d}T06:30:00+00:00") for day in range(1, 25) if day != 22]
    nights[-1]["state"] = "failed"
    nights.append(night("2026-11-24T17:00:00+00:00", "interrupted"))
    nights.append(night("2026-11-24T20:00:00+00:00"))
    row = days(nights, LA)
    assert [view.day for view in row] == [f"2026-11-{day:02d}" for day in range(11, 25)]
    told_of = {view.day[-2:]: (view.state, view.again) for view in row}
    assert told_of.pop("24") == ("good", True)
    assert told_of.pop("23") == ("failed", False)
    assert told_of.pop("21") == ("", False)
    assert set(told_of.values()) == {("good", False)}
    assert days(nights, UTC)[-1].day == "2026-11-24"
    assert [view.state for view in days(nights, UTC)][-3:] == ["", "good", "good"]
    assert days([], LA) == ()
    for damaged in (night("yesterday"), night("2026-11-24T20:00:00+00:00", BAD), {}):
        assert days([damaged], LA) == ()


def test_a_damaged_status_still_makes_a_page(tmp_path: Path) -> None:
    for news, counts in (({"objects": 7}, {"act": "x"}), ({}, {}), ({"since": BAD, "counts": {BAD: 1}}, {"act": 1})):
        text = page(tmp_path, status(news=news, counts=counts)).read_text(encoding="utf-8")
        assert "The last good report" in text
        assert "<img" not in text


@pytest.mark.browser
@pytest.mark.parametrize("width", [1280, 390])
def test_it_is_red_after_thirty_six_hours_and_not_before(browser: Chrome, tmp_path: Path, width: int) -> None:
    screen = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    try:
        _see(browser, tmp_path)
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def _see(browser: Chrome, tmp_path: Path) -> None:
    seen = {}
    for hours in (35.9, 36.1):
        browser.get(page(tmp_path, status(hours=hours)).as_uri())
        assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
        late = browser.find_element("id", "late")
        color = browser.execute_script("return getComputedStyle(document.querySelector('h1')).color")
        red, green, blue = (int(part) for part in color[4:-1].split(","))
        seen[hours] = (late.is_displayed(), red > 2 * max(green, blue) + 50)
        assert "(36 hours ago)" in browser.find_element("css selector", ".lede").text
        assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    assert seen == {35.9: (False, False), 36.1: (True, True)}
    assert "No good night for more than 36 hours" in browser.find_element("id", "late").text
    assert violations(browser, tmp_path / "index.html") == []


@pytest.mark.browser
def test_a_wrong_clock_and_a_night_that_was_killed_are_red(browser: Chrome, tmp_path: Path) -> None:
    """A good night of next year is never too old by itself; a run that never ended says nothing more."""
    seen = {}
    for hours, state in ((-40, "good"), (-1, "good"), (11.9, "running"), (12.1, "running")):
        browser.get(page(tmp_path, status(hours=hours, state=state)).as_uri())
        assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
        alarms = browser.find_elements("css selector", ".alarm")
        told = [one.text for one in alarms if one.is_displayed()]
        seen[hours] = (len(told), "late" in (browser.find_element("css selector", "body").get_attribute("class") or ""))
        if hours in (-40, 12.1):
            said = "dated later than now" if hours < 0 else "has not ended"
            assert said in told[0]
            assert violations(browser, tmp_path / "index.html") == []
    assert seen == {-40: (1, True), -1: (0, False), 11.9: (0, False), 12.1: (1, True)}


@pytest.mark.browser
def test_ages_are_in_words_of_the_page(browser: Chrome, tmp_path: Path) -> None:
    for hours, words in ((0.5, "30 minutes ago"), (5, "5 hours ago"), (30, "30 hours ago"), (24 * 5, "5 days ago")):
        browser.get(page(tmp_path, status(hours=hours)).as_uri())
        assert words in browser.find_element("css selector", ".lede").text
    text = landing_page(status(hours=5), "Museo", Language("it"))
    (tmp_path / "it.html").write_text(text, encoding="utf-8")
    browser.get((tmp_path / "it.html").as_uri())
    assert "5 ore fa" in browser.find_element("css selector", ".lede").text
    # A clock that is behind tells no age, and a language that no browser knows is no harm.
    (tmp_path / "odd.html").write_text(landing_page(status(hours=-5), "M", Language("x-klingon")), encoding="utf-8")
    browser.get((tmp_path / "odd.html").as_uri())
    assert "ago" not in browser.find_element("css selector", ".lede").text
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


@pytest.mark.browser
def test_a_fault_of_kouros_is_told_in_a_sentence_and_its_error_is_folded(browser: Chrome, tmp_path: Path) -> None:
    error = f"{FAULT}: KeyError: 'percent' (report/pages/environment.py, line 89, fill)"
    browser.get(page(tmp_path, {**status("failed"), "message": error, "fault": True}).as_uri())
    text = browser.find_element("css selector", ".alarm").text
    assert "It is a fault of Kouros and not of yours." in text
    assert "KeyError" not in text
    browser.find_element("css selector", ".alarm summary").click()
    assert error in browser.find_element("css selector", ".alarm").text


@pytest.mark.browser
def test_a_failed_night_is_unmistakable_in_words(browser: Chrome, tmp_path: Path) -> None:
    vase = ObjectChange("2026.1", BAD, "Gallery 2", None, ACT)
    rows = plain_changes(RunChanges("a", "b", objects=(vase,)))["objects"]
    news = {"since": "2031-05-01T09:00:00+00:00", "counts": {"danger": 1}, "because": [], "shared": {}, "objects": rows}
    counts = {"act": 1234, "watch": 2, "unknown": 3, "fine": 4}
    file = page(tmp_path, status("failed", news=news, counts=counts), "America/Los_Angeles")
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        browser.get(file.as_uri())
        text, title = browser.find_element("tag name", "main").text, browser.title
    finally:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
    # All of it without a script: only ages, and the alarm after 36 hours, are the script's.
    assert text.startswith("The last night failed")
    assert "failed" in title
    assert f"Because: {BAD}" in text
    for words in ("1,234", "New and in danger: 2026.1 " + BAD, "Since 2031-05-01 02:00 PDT", "✗ failed", "✓ good"):
        assert words in text, words
    assert "No good night" not in text
    assert violations(browser, file) == []
    assert browser.execute_script("return document.querySelectorAll('main script, img').length") == 0
