"""What a status keeps of the last nights, whatever ended them and whatever is pruned; and that what is new is told."""

from __future__ import annotations

import email
import email.policy
import json
from collections.abc import Callable
from datetime import UTC
from pathlib import Path
from typing import Any

import pytest

from pipeline.operations.report_status import NIGHTS, mark_failed, mark_running, status
from pipeline.report.pages.landing import days
from pipeline.settings import SettingsError, load_settings
from tests.museum import ROWS, edit

from .conftest import validate, within
from .servers import Mail, mail, web

SLENDER = "{},B,Amphora,0.8,0.1,0.1"


def standing(folder: Path) -> dict[str, Any]:
    said: dict[str, Any] = json.loads((folder / "reports" / "status.json").read_text(encoding="utf-8"))
    validate(said, "status")
    return said


def test_what_ended_each_night_is_kept_in_order(museum: Callable[..., Path]) -> None:
    """Good, failed, stopped by hand, killed, good: and retention that keeps one run and one report leaves all five."""
    folder = museum(more="[retention]\nruns = 1\nreports = 1\n")
    settings = load_settings(folder / "kouros.toml")
    assert within(folder, "run").returncode == 0
    first = standing(folder)["nights"]
    mark_running(settings)
    mark_failed(settings, OSError("x"), "x")
    mark_running(settings)
    mark_failed(settings, KeyboardInterrupt(), "x")
    mark_running(settings)  # and killed: it says nothing more
    assert within(folder, "run").returncode == 0
    said = standing(folder)
    assert [one["state"] for one in said["nights"]] == ["good", "failed", "interrupted", "interrupted", "good"]
    assert said["nights"][:1] == first
    assert [bool(one["ended"]) for one in said["nights"]] == [True, True, True, False, True]
    assert [bool(one["run_id"]) for one in said["nights"]] == [True, False, False, False, True]
    began = [one["began"] for one in said["nights"]]
    assert began == sorted(began)
    assert [path.name for path in (folder / "reports").iterdir() if path.name[0] == "2"] == [
        said["last_good"]["run_id"]
    ]
    page = (folder / "reports" / "index.html").read_text(encoding="utf-8")
    assert "good, tried again" in page
    # A part of the collection, and a rehearsal, are no nights; a report drawn again is none either.
    for words in (["run", "--object", "2"], ["run", "--dry-run"], ["report"]):
        assert within(folder, *words).returncode == 0
    assert standing(folder)["nights"] == said["nights"]


def test_a_night_of_a_clock_that_was_ahead_hides_no_later_one() -> None:
    """The row ends with the day of the last run, and not a year later, where nothing but one run would stand."""
    nights = [
        {"began": f"{day}T02:00:00+00:00", "ended": "", "state": state, "run_id": ""}
        for day, state in (("2026-11-25", "good"), ("2027-11-26", "good"), ("2026-11-27", "failed"))
    ]
    assert [(one.day, one.state) for one in days(nights, UTC)] == [
        ("2026-11-25", "good"), ("2026-11-26", ""), ("2026-11-27", "failed"),
    ]  # fmt: skip


def test_no_more_are_kept_than_are_shown_of_a_fortnight(museum: Callable[..., Path]) -> None:
    settings = load_settings(museum() / "kouros.toml")
    for at in range(NIGHTS + 3):
        mark_failed(settings, ValueError(str(at)), str(at))
    now = status(settings)
    assert now is not None
    assert len(now.nights) == NIGHTS


@pytest.mark.parametrize("nights", [7, "x", [7], [{"state": "good"}], [{"a": 1}], {"a": 1}, None])
def test_nights_that_were_damaged_are_dropped(museum: Callable[..., Path], nights: Any) -> None:
    folder = museum()
    settings = load_settings(folder / "kouros.toml")
    mark_failed(settings, ValueError("x"), "x")
    file = folder / "reports" / "status.json"
    file.write_text(json.dumps(json.loads(file.read_text("utf-8")) | {"nights": nights}), encoding="utf-8")
    mark_failed(settings, ValueError("x"), "x")
    assert [one["state"] for one in standing(folder)["nights"]] == ["failed"]


def test_a_time_zone_that_is_none_is_refused_with_close_ones(museum: Callable[..., Path]) -> None:
    folder = museum()
    edit(folder / "kouros.toml", 'time_zone = "UTC"', 'time_zone = "Europe/Atens"')
    with pytest.raises(SettingsError, match=r"museum\.time_zone: .*no time zone 'Europe/Atens'.*Europe/Athens"):
        load_settings(folder / "kouros.toml")
    for wrong in ("", "../../etc/passwd", "/etc/localtime", "x" * 5000, "Europe"):
        edit(folder / "kouros.toml", "time_zone = ", f'time_zone = "{wrong}" #')
        with pytest.raises(SettingsError, match=r"museum\.time_zone"):
            load_settings(folder / "kouros.toml")
    edit(folder / "kouros.toml", "time_zone = ", 'time_zone = "America/Los_Angeles" #')
    assert load_settings(folder / "kouros.toml").museum.time_zone == "America/Los_Angeles"


@pytest.fixture
def server() -> Any:
    with mail() as running:
        yield running


def test_a_new_object_in_danger_is_told_though_no_verdict_changed(
    museum: Callable[..., Path], server: Mail, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    with web(204) as hooked:
        more = f"""
[[hooks.webhook]]
url = "{hooked.url}"
[[hooks.email]]
host = "127.0.0.1"
port = {server.port}
security = "none"
sender = "k@museum.example"
to = ["a@museum.example"]
"""
        folder = museum(ROWS, more)
        assert within(folder, "run").returncode == 0
        assert hooked.heard == []
        museum([*ROWS, SLENDER.format("2026.1"), SLENDER.format("2026.2")], more)
        done = within(folder, "run")
        assert done.returncode == 0, done.stderr
        [(_headers, body)] = hooked.heard
    event = json.loads(body)
    validate(event, "event")
    assert event["summary"]["changes"]["verdicts"] == []
    told = [one["text"] for one in event["summary"]["changes"]["objects"]]
    assert [text.partition(": 2026")[0] for text in told] == ["New and in danger"] * 2
    assert event["message"] == " ".join(told)
    [(_sender, _to, raw)] = server.mails

    message = email.message_from_bytes(raw, policy=email.policy.default)
    assert message["Subject"] == "Kouros: what changed, Test"
    text = next(iter(message.iter_parts())).get_content()
    assert text.splitlines()[: len(told)] == [f"- {line}" for line in told]
    assert [line for line in done.stdout.splitlines() if line.strip() in told]
