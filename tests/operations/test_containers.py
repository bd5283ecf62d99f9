"""The image and the services of the examples: read in any case, built and run where podman or docker is there."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from contextlib import suppress
from pathlib import Path

import pytest
import yaml

from pipeline.kernels import cache_folder
from tests.museum import workspace
from tests.warm import kouros_process

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
IMAGE = (EXAMPLES / "Containerfile").read_text(encoding="utf-8")
SERVICES = yaml.safe_load((EXAMPLES / "compose.yaml").read_text(encoding="utf-8"))
DOCS = (ROOT / "docs" / "how-to" / "server.md").read_text(encoding="utf-8")


def working_tool() -> str | None:
    """Return podman or docker, where it works: a client without its server builds nothing."""
    for tool in filter(None, map(shutil.which, ("podman", "docker"))):
        with suppress(subprocess.TimeoutExpired):
            if subprocess.run([tool, "info"], check=False, capture_output=True, timeout=20).returncode == 0:
                return tool
    return None


TOOL = working_tool()

EXTRAS = ("argon2", "dask", "distributed", "psycopg", "python_multipart", "starlette", "uvicorn")

BASE_ONLY = """
import sys
from importlib.machinery import PathFinder
class Base(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name.partition(".")[0] in {names!r} else super().find_spec(name, path, target)
sys.meta_path[sys.meta_path.index(PathFinder)] = Base
sys.argv = ["kouros", *sys.argv[1:]]
from pipeline.cli import main
main()
"""


def words_of(instruction: str) -> list[str]:
    """Return the words of an instruction of the Containerfile in its JSON form."""
    (found,) = re.findall(rf"^{instruction} (\[.*\])$", IMAGE, re.MULTILINE)
    words: list[str] = json.loads(found)
    return words


COMMANDS = {
    "Containerfile": words_of("CMD"),
    **{name: one["command"] for name, one in SERVICES["services"].items() if one["image"] == "kouros"},
    **{f"comment: {words}": words.split() for words in re.findall(r"compose run --rm night (\w+)", IMAGE + DOCS)},
}


@pytest.mark.parametrize("where", COMMANDS)
def test_kouros_has_every_command_of_the_examples(where: str, tmp_path: Path) -> None:
    """Options that there are not are refused before help is shown."""
    done = kouros_process((*COMMANDS[where], "--help"), tmp_path)
    assert done.returncode == 0, done.stderr
    wrong = kouros_process((*COMMANDS[where], "--no-such-option", "--help"), tmp_path)
    assert wrong.returncode == 2


def test_image_and_services_are_of_one_piece() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    (named,) = re.findall(r"whl\)\[([a-z,]+)\]", IMAGE)
    assert set(named.split(",")) == {"serve", "postgresql"} <= set(extras)
    assert words_of("ENTRYPOINT") == ["kouros"]
    kept = words_of("VOLUME")
    (home,) = re.findall(r"^WORKDIR (\S+)$", IMAGE, re.MULTILINE)
    (cache,) = re.findall(r"^ENV KOUROS_CACHE=(\S+)$", IMAGE, re.MULTILINE)
    assert kept == [home, cache]
    services = SERVICES["services"]
    for name in ("night", "desk"):
        one = services[name]
        assert [where.partition(":")[2] for where in one["volumes"]] == kept
        assert one["read_only"] is True
        assert one["environment"]["KOUROS_DATABASE"].startswith("postgresql://kouros:${POSTGRES_PASSWORD}@database/")
        assert one["depends_on"]["database"]["condition"] == "service_healthy"
    # Only the web server is reached from outside, and it speaks to the port at which the desk listens.
    assert [name for name, one in services.items() if "ports" in one] == ["web"]
    assert f"desk:{services['desk']['command'][-1]}" in services["web"]["command"]
    used = {where.partition(":")[0] for one in services.values() for where in one["volumes"]}
    assert used == set(SERVICES["volumes"])
    # No password is written down.
    assert services["database"]["environment"]["POSTGRES_PASSWORD"].startswith("${POSTGRES_PASSWORD:?")


def test_a_night_needs_none_of_the_extras(tmp_path: Path) -> None:
    """In a process that finds nothing of what only a desk, a cluster or a database server needs."""
    workspace(tmp_path)

    def base_install(*words: str) -> subprocess.CompletedProcess[str]:
        code = BASE_ONLY.format(names=set(EXTRAS))
        folders = os.pathsep.join([str(ROOT), *filter(None, sys.path)])
        environment = {**os.environ, "PYTHONPATH": folders, "NUMBA_CACHE_DIR": cache_folder()}
        done = [sys.executable, "-c", code, *words]
        return subprocess.run(done, check=False, cwd=tmp_path, env=environment, capture_output=True, text=True)

    done = base_install("--quiet", "run")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "reports" / "latest" / "index.html").is_file()
    asked = base_install("serve")
    assert asked.returncode == 2
    assert (
        "the desk needs starlette, uvicorn, argon2-cffi, python-multipart: pip install 'kouros[serve]'" in asked.stderr
    )


@pytest.mark.skipif(TOOL is None, reason="neither podman nor docker works here: the image is read, not built")
def test_the_image_is_built_and_runs(tmp_path: Path) -> None:
    assert TOOL is not None
    shutil.copy(EXAMPLES / "Containerfile", tmp_path)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(tmp_path), str(ROOT)],
        check=True,
    )
    subprocess.run([TOOL, "build", "--tag", "kouros-test", "--file", "Containerfile", "."], cwd=tmp_path, check=True)
    try:
        for words in (["--version"], ["init"], ["check", "--help"], ["serve", "--help"]):
            subprocess.run([TOOL, "run", "--rm", "kouros-test", *words], check=True)
    finally:
        subprocess.run([TOOL, "image", "rm", "kouros-test"], check=False)
