"""Nights by the real command: what is said of good ones and of failed ones, to programs, to people, and in the log."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from pipeline.operations.report_status import mark_failed, status
from pipeline.operations.workspace import locked
from pipeline.settings import load_settings
from tests.museum import ROWS

from .conftest import Kouros, command, environment, validate, within
from .servers import Web, web

LOW = ROWS[0].replace("1.2,0.2,0.2", "0.1,0.3,0.3")
TIPPING = ROWS[0].replace("1.2,0.2,0.2", "0.8,0.1,0.1")
"""The first object, so slender that the shaking lifts its edge: b/h below 1/8 against 0.12 g."""

STANDS = {"fine": "fine", "watch": "to be watched", "act": "in danger"}

TOKEN = "t0ken-that-nobody-may-read"


def settings_for(server: Web) -> str:
    return f"""
[logs]
file = "logs/kouros.jsonl"
[[hooks.webhook]]
url = "{server.url}"
token_from = "KOUROS_TOKEN"
[[hooks.command]]
run = ["no-such-program"]
[retention]
runs = 2
reports = 2
"""


@pytest.fixture
def server() -> Iterator[Web]:
    with web(204) as running:
        yield running


def log(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "logs" / "kouros.jsonl").read_text(encoding="utf-8").splitlines()]


def standing(folder: Path) -> dict[str, Any]:
    said: dict[str, Any] = json.loads((folder / "reports" / "status.json").read_text(encoding="utf-8"))
    validate(said, "status")
    return said


def landing(folder: Path) -> str:
    return (folder / "reports" / "index.html").read_text(encoding="utf-8")


def test_a_week_of_nights(museum: Callable[..., Path], server: Web, monkeypatch: pytest.MonkeyPatch) -> None:
    """A first night, a changed object, an unchanged night, a lost export, a shrunken one, a part; then tidy again."""
    folder = museum([LOW, *ROWS[1:]], settings_for(server), sampled=True)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")

    def kouros(*words: str) -> subprocess.CompletedProcess[str]:
        return within(folder, *words, KOUROS_TOKEN=TOKEN)

    first = kouros("run", "--json")
    assert first.returncode == 0, first.stderr
    printed = json.loads(first.stdout)
    validate(printed, "run-summary")
    assert (printed["exit_code"], printed["objects"], printed["changes"]) == (0, 3, None)
    kept = json.loads((folder / "reports" / "latest" / "summary.json").read_text(encoding="utf-8"))
    validate(kept, "run-summary")
    # Beside the report, paths are told from there, so that no place of the machine is published.
    assert kept == printed | {"report": "index.html", "latest": "../latest"}
    assert standing(folder)["state"] == "good"
    assert f'href="{printed["run_id"]}/index.html"' in landing(folder)
    # Whether a night was due and never began, this page cannot know: it says when the last one ended.
    assert "failed since" not in landing(folder)
    ended = datetime.fromisoformat(standing(folder)["since"])
    assert f"The last run ended at {ended:%Y-%m-%d %H:%M} UTC" in landing(folder)
    assert kouros("report").returncode == 0
    # Rendered again: the same run, in another folder, with the time that is known of it.
    again = standing(folder)["last_good"]
    same = {name: printed[name] for name in ("run_id", "finished", "reading")}
    numbers = {"act": "act", "watch": "watch", "unknown": "cannot", "fine": "fine"}
    same |= {"counts": {name: printed[of] for name, of in numbers.items()}, "news": None}
    assert again == same | {"report": again["report"]}
    assert (again["reading"]["rows"], again["reading"]["refused"]) == (3, 0)
    assert again["report"] == f"{printed['run_id']}-2/index.html"
    assert f'href="{again["report"]}"' in landing(folder)
    assert server.heard == []  # nothing changed: there was nothing before

    museum([TIPPING, *ROWS[1:]], settings_for(server), sampled=True)
    second = kouros("run", "--json")
    assert second.returncode == 0, second.stderr
    validate(json.loads(second.stdout), "run-summary")
    [(headers, body)] = server.heard
    event = json.loads(body)
    validate(event, "event")
    assert headers["Authorization"] == f"Bearer {TOKEN}"
    assert (event["event"], event["error"]) == ("changed", None)
    counts = event["summary"]["changes"]["counts"]
    changed = "1 verdict" if counts["verdicts"] == 1 else f"{counts['verdicts']} verdicts"
    # The news first, in plain words, then the verdicts behind it.
    [news] = event["summary"]["changes"]["objects"]
    assert (news["object_number"], news["kind"], news["after"]["state"]) == ("1", "worse", "act")
    assert event["message"].startswith(
        f"Worse: 1 <script>alert(1)</script>: was {STANDS[news['before']['state']]}, is in danger ("
    )
    assert f" {changed} of 1 object changed: {counts['worsened']} passed and no longer" in event["message"]
    assert counts["worsened"] > 0
    assert event["last_good"]["news"]["objects"] == [news]
    assert event["summary"]["report"] == event["last_good"]["report"] == f"{event['summary']['run_id']}/index.html"
    # The other hook failed: it is said and logged, and the night's own code is that of a good one.
    assert "command no-such-program was not told: cannot be started" in second.stderr

    quiet = kouros("run")
    assert (quiet.returncode, len(server.heard)) == (0, 1)
    good = standing(folder)["last_good"]
    # Two of three reports stay.
    reports = sorted(path.name for path in (folder / "reports").iterdir() if path.name[0] == "2")
    assert reports == [event["summary"]["run_id"], good["run_id"]]
    before = {p.name: p.read_bytes() for p in (folder / "reports" / "latest").rglob("*.*") if p.is_file()}

    (folder / "export.csv").unlink()
    lost = kouros("run")
    assert lost.returncode == 5
    failed = json.loads(server.heard[1][1])
    validate(failed, "event")
    assert (failed["event"], failed["exit_code"], failed["error"]["kind"]) == ("failed", 5, "CollectionError")
    assert (failed["summary"], failed["last_good"]) == (None, good)
    said = standing(folder)
    assert (said["state"], said["last_good"], said["exit_code"]) == ("failed", good, 5)
    page = landing(folder)
    assert "failed; what follows is older" in page
    assert "export.csv" in page
    assert f'href="{good["report"]}"' in page
    assert before == {p.name: p.read_bytes() for p in (folder / "reports" / "latest").rglob("*.*") if p.is_file()}

    museum(ROWS[:1], settings_for(server), sampled=True)
    shrunk = kouros("run")
    assert shrunk.returncode == 7
    told = json.loads(server.heard[2][1])
    validate(told, "event")
    assert (told["event"], told["exit_code"]) == ("shrunk", 7)
    assert told["message"].startswith("The run published nothing: ")

    museum([TIPPING, *ROWS[1:]], settings_for(server), sampled=True)
    for words in (["--object", "2"], ["--dry-run"]):
        kouros("run", *words)
    assert standing(folder)["state"] == "failed"  # none of these is the night
    assert kouros("run").returncode == 0
    assert standing(folder)["state"] == "good"
    assert "what follows is older" not in landing(folder)
    assert len(server.heard) == 3

    events = [(line["event"], line["level"]) for line in log(folder)]
    assert [event for event, _ in events].count("run.finished") == 5  # a dry run writes no log
    assert {("run.failed", "error"), ("run.shrunk", "error"), ("hook.told", "info"), ("hook.failed", "error")} <= set(
        events
    )
    assert ("pruned", "info") in events
    text = "".join(
        [(folder / "logs" / "kouros.jsonl").read_text(encoding="utf-8"), lost.stderr, second.stderr, landing(folder)]
    )
    assert TOKEN not in text
    assert all(TOKEN.encode() not in body for _, body in server.heard)


def test_a_second_run_disturbs_nothing(museum: Callable[..., Path], kouros: Kouros, server: Web) -> None:
    folder = museum(more=settings_for(server))
    settings = load_settings(folder / "kouros.toml")
    mark_failed(settings, ValueError("before"), "before")
    with locked(settings):
        done = kouros("--log-json", "run", KOUROS_TOKEN=TOKEN)
    assert done.returncode == 6
    lines = [json.loads(line) for line in done.stderr.splitlines()]
    assert [line["event"] for line in lines] == ["run.started", "run.locked", "error"]
    assert standing(folder)["message"] == "before"
    assert server.heard == []


def test_a_run_that_is_killed_has_said_that_it_was_at_work(museum: Callable[..., Path]) -> None:
    folder = museum()
    process = subprocess.Popen(
        command("run"), cwd=folder, env=environment({}), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        end = time.monotonic() + 60.0
        while not (folder / "reports" / "status.json").exists():
            assert time.monotonic() < end
            assert process.poll() is None
            time.sleep(0.02)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    said = status(load_settings(folder / "kouros.toml"))
    assert said is not None
    assert (said.state, said.pid, said.last_good, said.stale) == ("running", process.pid, None, True)
    assert "has not ended" in landing(folder)
    assert "There is no good report yet" in landing(folder)


def test_a_failure_speaks_no_markup_and_no_secret(museum: Callable[..., Path], kouros: Kouros) -> None:
    """The name of a file that is not there comes back in the error, and from there into page, status and log."""
    folder = museum(more='[logs]\nfile = "logs/kouros.jsonl"\n')
    file = folder / "kouros.toml"
    hostile = "<img src=x onerror=alert(1)>\\u001b[2J\\u202e{{7*7}}.csv"
    file.write_text(file.read_text("utf-8").replace('source = "export.csv"', f'source = "{hostile}"'), encoding="utf-8")
    done = kouros("run")
    assert done.returncode == 5
    assert "\x1b" not in done.stderr
    assert "\u202e" not in done.stderr
    page = landing(folder)
    assert "<img" not in page
    assert "&lt;img src=x onerror=alert(1)&gt;" in page
    assert "{{7*7}}" in page
    assert "default-src 'none'" in page
    assert not set(page) & {"\x1b", "\u202e"}
    assert standing(folder)["kind"] == "CollectionError"
    # An error without a code of its own: page, log and command say the same one.
    odd = kouros("run", KOUROS_DATABASE="nonsense://u:geheim@host/x")
    assert odd.returncode == standing(folder)["exit_code"] == 2
    assert "geheim" not in odd.stderr + landing(folder)


def test_somebody_elses_index_is_not_replaced(museum: Callable[..., Path]) -> None:
    folder = museum()
    (folder / "reports").mkdir()
    (folder / "reports" / "index.html").write_text("the museum's own", encoding="utf-8")
    mark_failed(load_settings(folder / "kouros.toml"), ValueError("x"), "x")
    assert landing(folder) == "the museum's own"
    assert standing(folder)["state"] == "failed"


def test_a_status_that_was_damaged_is_none_and_is_written_anew(museum: Callable[..., Path]) -> None:
    folder = museum()
    settings = load_settings(folder / "kouros.toml")
    assert status(settings) is None
    for text in ("", "[]", "{", '{"last_good": 1}', '{"last_good": {"report": "../../x"}}', "null"):
        (folder / "reports").mkdir(exist_ok=True)
        (folder / "reports" / "status.json").write_text(text, encoding="utf-8")
        assert status(settings) is None
        mark_failed(settings, ValueError("x"), "x")
        assert standing(folder)["last_good"] is None


def test_a_log_on_standard_error_is_json_from_end_to_end(museum: Callable[..., Path], kouros: Kouros) -> None:
    museum([])
    done = kouros("--log-json", "run")
    lines = [json.loads(line) for line in done.stderr.splitlines()]
    assert done.returncode == 5
    assert [line["event"] for line in lines if line["event"] != "step"] == ["run.started", "run.failed", "error"]
    assert lines[-1]["exit_code"] == 5
