"""A small museum whose nights are short, and the command as a process."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from referencing import Registry, Resource

from pipeline.resources import resource
from pipeline.tools.synthetic import synthesise
from tests.conftest import made_once
from tests.museum import COLUMNS, workspace
from tests.warm import kouros_process

from .disturbed import Nights, last, objects, rows

SCHEMAS = ("run-summary", "status", "event")

Kouros = Callable[..., "subprocess.CompletedProcess[str]"]


def validate(document: Any, schema: str) -> None:
    """Hold a document against a published schema; the schemas may name each other."""
    known = {
        f"{n}.schema.json": json.loads(resource("schemas", f"{n}.schema.json").read_text("utf-8")) for n in SCHEMAS
    }
    registry = Registry().with_resources((name, Resource.from_contents(text)) for name, text in known.items())
    wanted = known[f"{schema}.schema.json"]
    Draft202012Validator.check_schema(wanted)
    Draft202012Validator(wanted, registry=registry).validate(document)


@pytest.fixture(scope="session")
def shaking() -> Path:
    """A site of one short motion: what is tested here is not what it does to objects."""

    def make(folder: Path) -> None:
        synthesise("sine", ["amplitude=1.2", "frequency=2", "cycles=2"], folder / "shaking")

    return made_once("shaken", make) / "shaking"


@pytest.fixture
def museum(tmp_path: Path, shaking: Path) -> Callable[..., Path]:
    """Write a museum of three objects, or of other rows, with more settings."""

    def make(rows: list[str] | None = None, more: str = "", folder: Path = tmp_path, *, sampled: bool = False) -> Path:
        workspace(folder, rows, site=str(shaking), sampled=sampled)
        file = folder / "kouros.toml"
        text = file.read_text(encoding="utf-8").split("\n[logs]")[0]
        file.write_text(text + "\n" + more, encoding="utf-8")
        return folder

    return make


@pytest.fixture
def kouros(tmp_path: Path) -> Kouros:
    """Run the command in the museum's folder, with more variables of the environment."""

    def call(*words: str, folder: Path = tmp_path, **more: str) -> subprocess.CompletedProcess[str]:
        return kouros_process(words, folder, environment(more))

    return call


def command(*words: str) -> list[str]:
    return [sys.executable, "-c", "from pipeline.cli import main; main()", *words]


def environment(more: Mapping[str, str]) -> dict[str, str]:
    return {**os.environ, "NO_PROXY": "127.0.0.1,localhost", **more}


def within(folder: Path, *words: str, **more: str) -> subprocess.CompletedProcess[str]:
    """Run the command in this process, which saves the seconds of its start: same answer, same streams, same code."""
    from pipeline.cli import main

    out, err = StringIO(), StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.chdir(folder)
        patch.setattr(sys, "argv", ["kouros", *words])
        patch.setattr(warnings, "formatwarning", warnings.formatwarning)
        for name, value in more.items():
            patch.setenv(name, value)
        with pytest.raises(SystemExit) as left:
            main()
    return subprocess.CompletedProcess(words, int(str(left.value.code)), out.getvalue(), err.getvalue())


@pytest.fixture(scope="session")
def nights(shaking: Path) -> Nights:
    def make(around: Path) -> None:
        folder = around / "museum"
        folder.mkdir()
        workspace(folder, rows(0.4), site=str(shaking))
        assert within(folder, "run").returncode == 0
        (folder / "export.csv").write_text("\n".join([COLUMNS, *rows(0.9)]) + "\n", encoding="utf-8")
        undisturbed = Path(shutil.copytree(folder, around / "undisturbed", symlinks=True))
        start = time.monotonic()
        ran = subprocess.run(
            command("run"), cwd=undisturbed, env=environment({}), capture_output=True, text=True, check=False
        )
        (around / "seconds").write_text(str(time.monotonic() - start), encoding="utf-8")
        assert ran.returncode == 0, ran.stderr

    around = made_once("nights", make)
    folder, undisturbed = around / "museum", around / "undisturbed"
    before, after = (objects(one / "reports" / "latest") for one in (folder, undisturbed))
    assert before != after
    seconds = float((around / "seconds").read_text(encoding="utf-8"))
    return Nights(folder, before, after, last(str(undisturbed / "kouros.sqlite")), seconds)
