"""The command in a process of its own that is forked from one that has imported all of it: a start costs no seconds.

What it prints, writes and exits with is that of a process started by a shell.  That a cold one starts at all, and how
fast, is for `tests/test_package.py` and for the tests that start the interpreter themselves.
"""

import atexit
import gc
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from tempfile import TemporaryDirectory, TemporaryFile
from threading import Lock
from typing import IO, Any, NoReturn

ROOT = Path(__file__).resolve().parents[1]

_ONE_AT_A_TIME = Lock()


def kouros_process(
    words: tuple[str, ...], folder: Path, environment: Mapping[str, str] | None = None, terminal: int | None = None
) -> subprocess.CompletedProcess[str]:
    """Run the command with words, in a folder, with the environment of now or another one.

    terminal : descriptor of a terminal at which it may ask; None for nobody who could be asked
    """
    chosen = dict(os.environ if environment is None else environment)
    with TemporaryFile() as out, TemporaryFile() as err, _ONE_AT_A_TIME:
        server = _server()
        asked = {"words": words, "folder": str(folder), "environment": chosen, "out": out.fileno(), "err": err.fileno()}
        asked |= {"process": os.getpid(), "terminal": terminal}
        print(json.dumps(asked), file=server.stdin, flush=True)
        assert server.stdout is not None
        code = int(server.stdout.readline())
        return subprocess.CompletedProcess(["kouros", *words], code, _text(out), _text(err))


def _text(stream: IO[bytes]) -> str:
    stream.seek(0)
    return stream.read().decode().replace("\r\n", "\n")


@cache
def _server() -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "tests.warm"]
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    server = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": path},
    )
    atexit.register(_end, server)
    return server


def _end(server: "subprocess.Popen[str]") -> None:
    assert server.stdin is not None
    server.stdin.close()
    server.wait()


def serve() -> dict[str, Any]:
    """Fork a process for each line that is asked, and answer with its exit code; return in each of these."""
    for line in iter(sys.stdin.readline, ""):
        asked: dict[str, Any] = json.loads(line)
        out, err = (os.open(f"/proc/{asked['process']}/fd/{asked[name]}", os.O_RDWR) for name in ("out", "err"))
        child = os.fork()
        if not child:
            os.dup2(out, 1)
            os.dup2(err, 2)
            return asked
        os.close(out)
        os.close(err)
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)
    sys.exit()


def become(asked: dict[str, Any]) -> None:
    """Make this process what a shell would have started."""
    where = os.devnull if asked["terminal"] is None else f"/proc/{asked['process']}/fd/{asked['terminal']}"
    os.dup2(os.open(where, os.O_RDONLY | os.O_NOCTTY), 0)
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 - the process's own
    os.environ.clear()
    os.environ.update(asked["environment"])
    os.chdir(asked["folder"])
    # A package that is installed for this process only.
    paths = filter(None, asked["environment"].get("PYTHONPATH", "").split(os.pathsep))
    packages = [path for path in paths if path not in sys.path]
    if packages:
        sys.path[:0] = packages
        forget_packages()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.argv = ["kouros", *asked["words"]]


def forget_packages() -> None:
    """Forget what was found where there were no other packages, but for patterns and kernels, which none changes."""
    from pipeline.collection.sources.registry import SOURCES
    from pipeline.mitigate.measures import MEASURES
    from pipeline.models import MODELS
    from pipeline.report.pages.further import PAGES

    for registry in (MODELS, MEASURES, SOURCES, PAGES):
        registry._parts, registry._problems = None, ()
    for name, module in list(sys.modules.items()):
        if name.startswith("pipeline.") and name not in PATTERNS:
            for found in vars(module).values():
                if callable(getattr(found, "cache_clear", None)):
                    found.cache_clear()


PATTERNS = (
    *("pipeline.analysis.evidence", "pipeline.analysis.footing", "pipeline.analysis.rule_table"),
    *("pipeline.kernels", "pipeline.records.phrase"),
    *("pipeline.report.files.sheet_fonts", "pipeline.report.pages.environment"),
)
"""Whose caches hold nothing of other packages: of words, of Kouros's own rules and templates, and of fonts."""

NIGHTLY = ("alembic.command", "obspy.signal", "openpyxl", "pandas", "psycopg", "pyarrow.parquet", "pywt")
"""What a night imports when it comes to it."""

OWN_TIME = ("pipeline.execute.cluster", "pipeline.verification.self_measurement")
"""Left to each process: the latter asks at once which models other packages have installed, maybe for that one only."""


def prepare() -> None:
    """Do what every process of the command would do for itself: import, read tables, compile patterns, load kernels.

    The most by a night, of which nothing stays but what it found of motions: two seconds of each, of each import one.
    """
    import pipeline
    from pipeline.report.pages.environment import environment
    from pipeline.report.plots.svg import thin
    from tests.museum import ROWS, night, workspace

    for module in walk_packages(pipeline.__path__, "pipeline."):
        if module.name not in OWN_TIME:
            import_module(module.name)
    for name in NIGHTLY:
        import_module(name)
    # The first kernel brings numba's own tables.
    thin([(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])
    with TemporaryDirectory() as folder:
        night(workspace(Path(folder), [*ROWS, "4,B,Painting,0.6,0.5,0.03"], furnished=True, sampled=True))
    templates = environment()
    for name in templates.list_templates():
        templates.get_template(name)
    # A night looks for garbage: not among what was here before it, all of which it would copy by that.
    gc.collect()
    gc.freeze()


def end(code: int) -> NoReturn:
    """End this process as Python does, but for taking every module apart: that took longer than most commands."""
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(code)


if __name__ == "__main__":
    from pipeline.cli import main

    prepare()
    become(serve())
    try:
        main()
    except SystemExit as left:
        # Anything but a number is said by Python itself.
        if isinstance(left.code, int):
            end(left.code)
        raise
