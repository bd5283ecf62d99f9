"""A night whose PostgreSQL server stops in the middle: last night's report stays, and the night is finished later."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pipeline.collection.database import open_database
from pipeline.store.runs import list_runs
from tests.conftest import postgresql_server

from .conftest import command, environment, within
from .disturbed import Nights, last, objects, rows, whole

DATABASE = "KOUROS_DATABASE"


@pytest.fixture
def server() -> Iterator[Any]:
    """A PostgreSQL server of this test's own, which it may stop."""
    with postgresql_server() as made:
        made.psql("CREATE DATABASE kouros;")
        yield made


def stop_at_once(server: Any) -> None:
    """Stop the server as a machine that loses its power does: nothing is finished, every connection is cut."""
    os.kill(server.get_pid(), signal.SIGQUIT)
    deadline = time.monotonic() + 30.0
    while (Path(server.pgdata) / "postmaster.pid").exists() and time.monotonic() < deadline:
        time.sleep(0.05)


@pytest.mark.long("operations/test_interruptions::test_a_locked_database_is_named_and_the_report_stays")
def test_a_server_that_stops_in_the_middle(nights: Nights, tmp_path: Path, server: Any) -> None:
    url = server.get_uri(database="kouros")
    folder = Path(shutil.copytree(nights.folder, tmp_path / "museum", symlinks=True))
    (folder / "kouros.sqlite").unlink()
    shutil.rmtree(folder / "reports")
    tonight = (folder / "export.csv").read_text(encoding="utf-8")
    (folder / "export.csv").write_text("\n".join([tonight.splitlines()[0], *rows(0.4)]) + "\n", encoding="utf-8")
    assert within(folder, "run", **{DATABASE: url}).returncode == 0
    assert objects(folder / "reports" / "latest") == nights.before
    (folder / "export.csv").write_text(tonight, encoding="utf-8")

    night = subprocess.Popen(
        command("run"), cwd=folder, env=environment({DATABASE: url}), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    assert night.stderr is not None
    said = []
    for line in night.stderr:
        said.append(line)
        if "objects" in line:
            # Tonight's records are in the inventory, and what is found about them is about to be stored.
            stop_at_once(server)
            break
    said.append(night.stderr.read())
    assert night.wait() not in (0, 3)
    told = "".join(said)
    assert "Traceback" not in told
    assert "connection" in told or "server" in told, told
    assert objects(folder / "reports" / "latest") == nights.before

    server.ensure_postgres_running()
    assert within(folder, "run", "--resume", **{DATABASE: url}).returncode == 0
    assert whole(folder, nights)
    assert last(url) == nights.record
    assert [run.status for run in list_runs(open_database(url))] == ["finished", "finished"]
