"""The log: one JSON object a line, in a file that is rotated, with nothing secret in it and nothing that steers."""

from __future__ import annotations

import json
import logging
import math
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import settings as trying
from hypothesis import strategies as st

from pipeline.operations.event_log import journal, note
from pipeline.operations.secrets import hider
from pipeline.settings import Logs, Settings
from tests.soak import examples

HOSTILE = '\x1b[2J\u202e"\n{"event": "forged"}\r\u2028\ud800'


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").split("\n") if line]


def test_a_line_says_when_what_and_how_grave(tmp_path: Path) -> None:
    settings = Settings(home=tmp_path, logs=Logs(file="logs/k.jsonl"))
    with journal(settings, str):
        note("run.started", museum=HOSTILE, counts={"objects": 3}, share=math.inf, whole=True, of=[1, None])
        note("hook.failed", level=logging.ERROR, time="forged", event="forged", pid="forged")
    note("after", lost=True)
    raw = (tmp_path / "logs" / "k.jsonl").read_bytes()
    assert raw.isascii()
    assert raw.count(b"\n") == 2
    first, second = lines(tmp_path / "logs" / "k.jsonl")
    when = datetime.fromisoformat(first.pop("time"))
    assert abs((datetime.now(UTC) - when).total_seconds()) < 60.0
    assert first.pop("pid") > 0
    assert first == {
        "level": "info",
        "event": "run.started",
        "museum": HOSTILE,
        "counts": {"objects": 3},
        "share": "inf",
        "whole": True,
        "of": [1, None],
    }
    # A field cannot take the place of what the log itself says.
    assert (second["level"], second["event"]) == ("error", "hook.failed")


@trying(deadline=None, max_examples=examples(100))
@given(st.dictionaries(st.text(), st.text() | st.floats() | st.integers() | st.lists(st.text()), max_size=4))
def test_whatever_is_noted_is_one_line_that_reads_back(fields: dict[str, Any]) -> None:
    from pipeline.operations.event_log import _FIELDS, _LineFormatter

    record = logging.LogRecord("kouros", logging.INFO, "", 0, "event", None, None)
    setattr(record, _FIELDS, fields)
    line = _LineFormatter(str).format(record)
    assert line.isascii()
    assert line.isprintable()
    read = json.loads(line)
    assert {"time", "level", "event", "pid"} <= set(read)
    for name, value in fields.items():
        if isinstance(value, str) and name not in ("time", "level", "event", "pid"):
            assert read[name] == value


def test_full_files_are_put_aside_and_the_oldest_removed(tmp_path: Path) -> None:
    """Each file stays below its size: 2,000 bytes hold no more than a dozen of these lines."""
    settings = Settings(home=tmp_path, logs=Logs(file="k.jsonl", megabytes=0.002, keep=2))
    with journal(settings, str):
        for number in range(100):
            note("step", number=number, what="x" * 50)
    found = sorted(tmp_path.iterdir())
    assert [path.name for path in found] == ["k.jsonl", "k.jsonl.1", "k.jsonl.2"]
    assert all(path.stat().st_size <= 2000 for path in found)
    assert lines(tmp_path / "k.jsonl")[-1]["number"] == 99


def test_secrets_are_taken_out_wherever_they_stand(tmp_path: Path) -> None:
    environment = {
        "KOUROS_DATABASE": "postgresql://kouros:p%40ss-one@h/db",
        "KOUROS_SMTP_PASSWORD": "pass-two",
        "MUSEUM_PW": "pass three/+",
        "PATH": "/bin",
    }
    settings = Settings.model_validate(
        {
            "home": tmp_path,
            "logs": {"file": "k.jsonl"},
            "collection": {"source": "postgresql://reader:${MUSEUM_PW}@tms/db"},
            "hooks": {"webhook": [{"url_from": "KOUROS_HOOK"}]},
        }
    )
    environment["KOUROS_HOOK"] = "https://h.example/S3CRET"
    with journal(settings, hider(settings, environment)):
        note(
            "run.failed",
            message="p@ss-one and p%40ss-one and pass-two, /bin, password=unknown postgresql://a:b@h",
            nested=[{"pass-two": "pass three/+", "quoted": "pass%20three%2F%2B pass+three%2F%2B"}],
            hook="https://h.example/S3CRET refused",
        )
    text = (tmp_path / "k.jsonl").read_text(encoding="utf-8")
    for secret in ("ss-one", "pass-two", "pass three", "pass%20three", "pass+three", "S3CRET", "unknown", "a:b@"):
        assert secret not in text
    assert "/bin" in text
    assert lines(tmp_path / "k.jsonl")[0]["hook"] == "*** refused"


def test_a_database_that_is_a_plain_file_is_no_secret() -> None:
    hide = hider(None, {"KOUROS_DATABASE": "kouros.sqlite"})
    assert hide("kouros.sqlite is locked") == "kouros.sqlite is locked"
    # What cannot be read as an address is hidden whole: which part is the password cannot be told.
    assert "geheim" not in hider(None, {"KOUROS_DATABASE": "postgresql://u:geheim@h:port/x"})(
        "at postgresql://u:geheim@h:port/x"
    )


def test_a_short_password_is_hidden_as_a_word_and_not_inside_words() -> None:
    hide = hider(None, {"KOUROS_DATABASE": "postgresql://kouros:pi@server/museum"})
    assert hide("compiled code, the API, spinning, pi3, 4pi") == "compiled code, the API, spinning, pi3, 4pi"
    # Wherever it may stand for itself: an address, a field, quoted, escaped, a line of its own, beside other letters.
    for said in (
        "postgresql://kouros:pi@server", "(pi)", "user=kouros,pwd:pi;", "'pi'", "pi", "a pi.", "kouros_pi", "pi/museum",
        "kouros%3Api%40server", r"refused\npi", r"\x1bpi", r"\u2028pi", "\npi\n", "\u00abpi\u00bb", "pi\u3002",
    ):  # fmt: skip
        assert "pi" not in hide(said), said
    odd = hider(None, {"KOUROS_TOKEN": "-x@"})
    assert odd("a-x@b") == "a***b"
    whole = hider(None, {"KOUROS_TOKEN": "piccolo"})
    assert whole("xpiccolox") == "x***x"


def test_a_log_that_cannot_be_written_is_said_and_the_night_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "logs").write_text("a file where the folder should be", encoding="utf-8")
    with journal(Settings(home=tmp_path, logs=Logs(file="logs/k.jsonl")), str, to_stderr=True):
        note("run.started")
    said = capsys.readouterr().err.splitlines()
    assert "the log cannot be written" in said[0]
    assert [json.loads(line)["event"] for line in said[1:]] == ["log.refused", "run.started"]
