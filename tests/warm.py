"""The command in a process of its own that is forked from one that has imported all of it: a start costs no seconds.

What it prints, writes and exits with is that of a process started by a shell.  That a cold one starts at all, and how
fast, is for `tests/test_package.py` and for the tests that start the interpreter themselves.
"""

import atexit
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from tempfile import TemporaryFile
from threading import Lock
from typing import IO, Any

ROOT = Path(__file__).resolve().parents[1]

_ONE_AT_A_TIME = Lock()


def kouros_process(
    words: tuple[str, ...], folder: Path, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run the command with words, in a folder, with the environment of now or another one."""
    chosen = dict(os.environ if environment is None else environment)
    with TemporaryFile() as out, TemporaryFile() as err, _ONE_AT_A_TIME:
        server = _server()
        asked = {"words": words, "folder": str(folder), "environment": chosen, "out": out.fileno(), "err": err.fileno()}
        asked |= {"process": os.getpid()}
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
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 - the process's own
    os.environ.clear()
    os.environ.update(asked["environment"])
    os.chdir(asked["folder"])
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.argv = ["kouros", *asked["words"]]


if __name__ == "__main__":
    import pipeline
    from pipeline.cli import main

    for module in walk_packages(pipeline.__path__, "pipeline."):
        if module.name != "pipeline.execute.cluster":
            import_module(module.name)
    import_module("obspy.signal")
    become(serve())
    main()
