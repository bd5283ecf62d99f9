"""After an earthquake at the desk: what is found is tapped, told to others, and counted."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from selenium.webdriver.common.by import By

from pipeline.operations.workspace import open_workspace
from pipeline.settings import load_settings
from pipeline.store.event_reports import event_reports
from pipeline.tools.event import TypedShaking, answer_event
from pipeline.tools.event_folders import EVENTS, kept_events
from tests.report.test_accessible import violations_here
from tests.soak import soaked

from .conftest import HOSTILE
from .test_paths import complaints, press, see
from .visiting import Visitor, served

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

ROOM = "Room 1"


@pytest.fixture
def shaken(museum: Path) -> Path:
    """The museum after an earthquake, that was answered by its curves."""
    workspace = open_workspace(load_settings(museum / "kouros.toml"))
    now = datetime(2026, 11, 25, 3, 0, tzinfo=UTC)
    answer_event(workspace, [], at=(37.77, -122.47), typed=TypedShaking(0.4, 40.0, 0.6), now=now)
    return museum


@pytest.fixture
def running(shaken: Path, browser: Chrome) -> Iterator[str]:
    browser.set_window_size(1300, 900)
    with served(shaken) as address:
        yield address


def event_of(folder: Path) -> str:
    (event,) = kept_events(folder / EVENTS)
    return event.name


def answer_of(folder: Path) -> dict[str, object]:
    said: dict[str, object] = json.loads((folder / EVENTS / event_of(folder) / "latest" / "answer.json").read_text())
    return said


def reports_of(folder: Path) -> dict[str, list[tuple[str, float | None, str, str]]]:
    engine = open_workspace(load_settings(folder / "kouros.toml")).engine
    kept = event_reports(engine, event_of(folder))
    return {name: [(one.state, one.moved_m, one.note, one.who) for one in some] for name, some in kept.items()}


def in_room(visitor: Visitor, folder: Path, gallery: str = ROOM):  # type: ignore[no-untyped-def]
    return visitor.get("/event/gallery", event=event_of(folder), gallery=gallery)


def tap(visitor: Visitor, page, number: str, state: str, **more: str):  # type: ignore[no-untyped-def]
    """Send the form of an object as it was when the page was seen."""
    (form,) = [
        one for one in page.page.xpath("//form[@action='/event/found']")
        if one.xpath(".//input[@name='number']/@value") == [number]
    ]  # fmt: skip
    hidden = {one.get("name"): one.get("value") for one in form.xpath(".//input[@type='hidden']")}
    return visitor.post("/event/found", **{**hidden, "state": state, **more})


def test_there_is_no_page_before_an_earthquake(visitor: Visitor) -> None:
    assert "/event" not in visitor.get("/").text
    assert visitor.get("/event").status == 404
    assert "kouros event" in visitor.get("/event").alert


@pytest.mark.long("test_the_second_of_two_is_told_and_nothing_of_either_is_lost")
@pytest.mark.browser
def test_a_conservator_taps_what_is_found_and_the_list_is_sorted_anew(
    running: str, browser: Chrome, shaken: Path
) -> None:
    before = answer_of(shaken)
    browser.get(running)
    press(browser, browser.find_element(By.LINK_TEXT, "After the earthquake"))
    assert "fallen" in see(browser, ".lede").text
    places = [one.text for one in browser.find_elements(By.CSS_SELECTOR, ".hits .t")]
    assert places == [one["gallery"] for one in before["galleries"]]
    press(browser, next(one for one in browser.find_elements(By.CSS_SELECTOR, ".hits a") if ROOM in one.text))
    name = see(browser, "form[action='/event/gallery'] input[name=who]")
    name.clear()
    name.send_keys("A. Smith")
    press(browser, see(browser, "form[action='/event/gallery'] button"))
    count = len(browser.find_elements(By.CSS_SELECTOR, ".found > li"))
    assert count > 2
    for at in range(count):
        row = see(browser, f"#o{at}")
        if at == 0:
            row.find_element(By.CSS_SELECTOR, "summary").click()
            row.find_element(By.NAME, "moved").send_keys("2 cm")
            row.find_element(By.NAME, "note").send_keys("to the east")
            press(browser, row.find_element(By.CSS_SELECTOR, "button[value=moved]"))
            assert "moved 0.787\u202fin" in see(browser, "#o0 .by").text, "in the museum's own unit"
            assert "A. Smith" in see(browser, "#o0 .by").text
            assert see(browser, "#o0 button.chosen").text == "✓ moved"
            continue
        press(browser, row.find_element(By.CSS_SELECTOR, "button[value=standing]"))
    assert f"What was found of {count} objects" in see(browser, ".waiting").text
    press(browser, see(browser, ".waiting button"))
    assert browser.find_elements(By.CSS_SELECTOR, ".waiting") == []
    kept = reports_of(shaken)
    assert sorted(one[-1][0] for one in kept.values()) == ["moved", *["standing"] * (count - 1)]
    (moved,) = [one[-1] for one in kept.values() if one[-1][0] == "moved"]
    assert moved == ("moved", pytest.approx(0.02), "to the east", "A. Smith")
    after = answer_of(shaken)
    # Bayes: where nothing fell, less has fallen elsewhere too.
    rest = [sum(one["states"].get("falls", 0.0) for one in said["objects"] if one["gallery"] != ROOM)
            for said in (before, after)]  # fmt: skip
    assert rest[1] < rest[0]
    assert f"{count} reports from the galleries" in after["shaking"]["from"]
    assert complaints(browser) == []


def test_the_second_of_two_is_told_and_nothing_of_either_is_lost(shaken: Path) -> None:
    with served(shaken) as address:
        first, second = Visitor(address), Visitor(address)
        seen = in_room(first, shaken), in_room(second, shaken)
        assert tap(first, seen[0], "1.1", "fallen", who="A. Smith").status == 303
        got = tap(second, seen[1], "1.1", "standing", who="B. Jones", note="leans a little")
        assert got.status == 409
        assert got.alert.startswith("A. Smith has said since of 1.1: fallen")
        assert got.page.xpath("//input[@name='note'][@value='leans a little']")
        assert reports_of(shaken) == {"1.1": [("fallen", None, "", "A. Smith")]}
        # What was seen by then is theirs to say.
        assert tap(second, got, "1.1", "standing", who="B. Jones").status == 303
        assert [one[0] for one in reports_of(shaken)["1.1"]] == ["fallen", "standing"]


def test_what_cannot_be_is_refused_with_the_remedy(shaken: Path) -> None:
    with served(shaken) as address:
        visitor = Visitor(address)
        page = in_room(visitor, shaken)
        for state, more, words in (
            ("", {}, "say what you found"),
            ("asleep", {}, "say what you found"),
            ("fallen", {"moved": "2 cm"}, "a distance goes with moved"),
            ("moved", {"moved": "far"}, "such as 2 cm"),
            ("moved", {"moved": "900 m"}, "more than 100 m"),
            ("moved", {"note": "x" * 2001}, "at most 2000 characters"),
        ):
            got = tap(visitor, page, "1.1", state, **{"who": "A. Smith", **more})
            assert (got.status, words in got.alert) == (422, True), got.alert
        token = page.hidden("/event/found", "token")
        told = {
            "token": token,
            "event": event_of(shaken),
            "gallery": ROOM,
            "state": "fallen",
            "version": "0",
            "who": "A",
        }
        assert visitor.post("/event/found", number="nobody", **told).status == 404
        assert in_room(visitor, shaken, "Nowhere").status == 404
        assert visitor.get("/event", event="../../etc").status == 404
        assert visitor.post("/event/again", event=event_of(shaken), token="wrong").status == 403
        assert reports_of(shaken) == {}


def test_hostile_numbers_are_text_and_can_be_reported(shaken: Path) -> None:
    with served(shaken) as address:
        visitor = Visitor(address)
        page = in_room(visitor, shaken, "Room 0")
        assert "<script>document.title" not in page.text
        note = "<img src=x onerror=alert(1)>"
        got = visitor.follow(tap(visitor, page, HOSTILE, "broken", who="A. Smith", note=note))
        assert not got.page.xpath("//main//img|//main//script")
        assert reports_of(shaken)[HOSTILE] == [("broken", None, note, "A. Smith")]


@pytest.mark.browser
@pytest.mark.parametrize("width", [pytest.param(1300, marks=soaked), 390])
def test_pages_fit_and_break_no_rule_of_wcag(running: str, browser: Chrome, shaken: Path, width: int) -> None:
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": False}
    )
    name = event_of(shaken)
    try:
        for path in (f"/event?event={name}", f"/event/gallery?event={name}&gallery=Room+1"):
            browser.get(running + path)
            assert browser.execute_script("return innerWidth") == width
            if "gallery" in path:
                press(browser, see(browser, "#o0 button[value=fallen]"))
                see(browser, "#o1 summary").click()
            assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth"), path
            small = browser.execute_script(
                "return [...document.querySelectorAll('button,input:not([type=hidden]),summary,.hits a,nav a,h2 a')]"
                ".filter(e => e.offsetParent && e.getBoundingClientRect().height < 24).map(e => e.outerHTML)"
            )
            assert small == [], path
            if os.environ.get("KOUROS_SCREENSHOTS"):
                file = Path(os.environ["KOUROS_SCREENSHOTS"]) / f"{re.sub('[^a-z]+', '-', path)[:20]}{width}.png"
                browser.save_screenshot(str(file))
            browser.execute_cdp_cmd("Page.setBypassCSP", {"enabled": True})
            assert violations_here(browser) == [], path
    finally:
        browser.execute_cdp_cmd("Page.setBypassCSP", {"enabled": False})
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
