"""What the package's modules say to their loggers, and who hears it."""

import logging
import subprocess
from pathlib import Path

import pytest

from pipeline.motions import read_motion
from pipeline.resources import resource
from tests.warm import kouros_process

RESPOND = ("respond", "sliding", "friction_static=0.1", "--json")


def kouros(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    done = kouros_process(words, folder)
    done.check_returncode()
    return done


def test_a_motion_that_is_processed_is_told_and_nobody_hears_who_does_not_ask(
    caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    read_motion(resource("site_motions", "demo"))
    assert capfd.readouterr().err == ""
    with caplog.at_level(logging.DEBUG, "pipeline"):
        read_motion(resource("site_motions", "demo"))
    told = [(record.name, record.levelname) for record in caplog.records]
    assert ("pipeline.motions.site", "INFO") in told
    assert told.count(("pipeline.motions.reading", "DEBUG")) == 3


def test_they_are_shown_by_verbose_and_all_by_debug_and_not_else(tmp_path: Path) -> None:
    plain, verbose, debug = (kouros(tmp_path, *RESPOND, *more) for more in ((), ("-v",), ("--debug",)))
    assert plain.stdout == verbose.stdout == debug.stdout
    assert "pipeline." not in plain.stderr
    assert "DEBUG" not in verbose.stderr
    assert "DEBUG pipeline.motions" in debug.stderr


def test_beside_a_log_of_json_they_are_silent(tmp_path: Path) -> None:
    """What is on standard error then is read by programs, line by line."""
    assert "pipeline.motions" not in kouros(tmp_path, *RESPOND, "--debug", "--log-json").stderr
