"""The image and the services of the examples: read every day, built and run by `make soak` with podman or docker."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tarfile
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import closing, suppress
from http.client import HTTPConnection
from pathlib import Path
from time import sleep
from typing import Any
from urllib.parse import parse_qsl, urlsplit

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


TOOL = working_tool() if "KOUROS_IMAGE" in os.environ else None

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


@pytest.mark.long("execute/test_pool::test_processes_need_no_dask_and_a_cluster_without_it_names_the_extra")
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


def run_options(volumes: Mapping[str, str], environment: Mapping[str, str]) -> list[str]:
    """Return with which options a tool runs the service of the night as the compose file has it.

    volumes     : what is mounted besides, or in place of a named volume: by its path in the container
    environment : what the compose file takes from its neighbours
    """
    service = SERVICES["services"]["night"]
    named = {path: f"kouros-test-{name}" for name, _, path in (one.partition(":") for one in service["volumes"])}
    mounted = [f"--volume={source}:{path}" for path, source in {**named, **volumes}.items()]
    told = [f"--env={name}={value}" for name, value in {**service["environment"], **environment}.items()]
    small = [f"--tmpfs={path}" for path in service["tmpfs"]]
    dropped = [f"--cap-drop={name}" for name in service["cap_drop"]]
    return [*(["--read-only"] if service["read_only"] else []), *small, *dropped, *mounted, *told]


@pytest.fixture
def tool(tmp_path: Path) -> Iterator[str]:
    """The container tool, which has built the image from a wheel of this tree."""
    assert TOOL is not None
    shutil.copy(EXAMPLES / "Containerfile", tmp_path)
    wheel = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(tmp_path), str(ROOT)]
    subprocess.run(wheel, check=True)
    try:
        subprocess.run(
            [TOOL, "build", "--tag", "kouros-test", "--file", "Containerfile", "."], cwd=tmp_path, check=True
        )
        yield TOOL
    finally:
        subprocess.run([TOOL, "volume", "rm", "--force", "kouros-test-museum", "kouros-test-cache"], check=False)
        subprocess.run([TOOL, "image", "rm", "--force", "kouros-test"], check=False)


@pytest.mark.skipif(TOOL is None, reason="no podman or docker, or not asked for: an image takes minutes (make soak)")
def test_the_image_is_built_and_does_a_night_and_serves_the_desk(
    tool: str, tmp_path: Path, postgresql_url: str
) -> None:
    """As the compose file runs it: without rights, on a root that cannot be written, on a real PostgreSQL server."""
    # The socket alone is mounted: PostgreSQL keeps the folder around it to itself.
    folder = dict(parse_qsl(urlsplit(postgresql_url).query))["host"]
    (door,) = (one for one in Path(folder).glob(".s.PGSQL.*") if one.is_socket())
    address = postgresql_url.replace(folder, "/run/database")
    options = run_options({f"/run/database/{door.name}": str(door)}, {"KOUROS_DATABASE": address})

    def run(*words: str, entry: str = "", **more: Any) -> subprocess.CompletedProcess[str]:
        entries = [f"--entrypoint={entry}"] if entry else []
        done = [tool, "run", "--rm", "--interactive", *options, *entries, "kouros-test", *words]
        return subprocess.run(done, check=False, capture_output=True, **more)

    home = words_of("VOLUME")[0]
    made = run("init", text=True)
    assert made.returncode == 0, made.stderr
    workspace(tmp_path / "museum")
    files = io.BytesIO()
    with tarfile.open(fileobj=files, mode="w") as packed:
        for name in ("export.csv", "mapping.toml", "kouros.toml", "brief"):
            packed.add(tmp_path / "museum" / name, name)
    put = run("--extract", "--no-same-owner", "--directory", home, entry="tar", input=files.getvalue())
    assert put.returncode == 0, put.stderr
    checked = run("check", text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    # The first night compiles into the volume; the second finds all of that, and nothing that changed.
    for night in ("first", "second"):
        done = run(*COMMANDS["night"], text=True)
        assert done.returncode == 0, (night, done.stderr)
        # Who collects the log of a container reads JSON alone, whatever a library would say of a root to be read only.
        assert all(line.startswith("{") and json.loads(line) for line in done.stderr.splitlines()), done.stderr
    assert run("-f", f"{home}/reports/latest/index.html", entry="test", text=True).returncode == 0
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    desk = [tool, "run", "--rm", "--name=kouros-test-desk", "--network=host", *options, "kouros-test"]
    with subprocess.Popen([*desk, "serve", "--port", str(port)], stderr=subprocess.PIPE, text=True) as serving:
        try:
            page = front_page(port, serving)
        finally:
            subprocess.run([tool, "stop", "--time=5", "kouros-test-desk"], check=False, capture_output=True)
    assert "<title>" in page
    assert "Test" in page


def front_page(port: int, serving: subprocess.Popen[str]) -> str:
    """Return the first page of a desk that is being started, within a minute."""
    for _ in range(120):
        assert serving.poll() is None, serving.stderr and serving.stderr.read()
        with suppress(OSError), closing(HTTPConnection("127.0.0.1", port, timeout=10)) as desk:
            desk.request("GET", "/")
            return desk.getresponse().read().decode("utf-8")
        sleep(0.5)
    raise AssertionError(f"nothing answers at port {port}")
