"""The examples for cron, systemd and Airflow, run as those would run them, with the paths of this machine put in."""

from __future__ import annotations

import ast
import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Callable
from configparser import ConfigParser
from pathlib import Path

import pytest

from pipeline.kernels import cache_folder
from tests.warm import kouros_process

from .conftest import command, environment

pytestmark = pytest.mark.slow_file

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"

ANALYZE = shutil.which("systemd-analyze")
AIRFLOW = os.environ.get("KOUROS_AIRFLOW", "")
"""A Python with Airflow, which needs an environment of its own: `make airflow` makes one."""

Museum = Callable[..., Path]


@pytest.fixture
def placed(museum: Museum, tmp_path: Path) -> Callable[[str], str]:
    """Put the museum's folder and a program `kouros` into an example, and a secret into the file of secrets."""
    home = museum(more='[logs]\nfile = "logs/kouros.jsonl"\n', folder=tmp_path)
    program = tmp_path / "bin" / "kouros"
    program.parent.mkdir()
    told = {name: environment({})[name] for name in ("PYTHONPATH", "NUMBA_NUM_THREADS") if name in os.environ}
    # In another home folder nothing is compiled yet: that takes half a minute, and is no matter of the example.
    told["NUMBA_CACHE_DIR"] = cache_folder()
    words = " ".join([*(f"{name}={shlex.quote(value)}" for name, value in told.items()), *map(shlex.quote, command())])
    program.write_text(f'#!/bin/sh\nexec env {words} "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    (tmp_path / "kouros.env").write_text("KOUROS_DATABASE=night.sqlite\n", encoding="utf-8")

    def place(name: str) -> str:
        text = (EXAMPLES / name).read_text(encoding="utf-8")
        for there, here in (
            ("/opt/kouros/bin/kouros", str(program)),
            ("/etc/kouros.env", str(tmp_path / "kouros.env")),
            ("/srv/kouros", str(home)),
        ):
            text = text.replace(there, here)
        return text

    return place


@pytest.fixture
def started(placed: Callable[[str], str], tmp_path: Path) -> Callable[[], subprocess.CompletedProcess[str]]:
    """Let the program only note how it is started, and return what then does that: the line of cron starts it cold."""
    program, notes = tmp_path / "bin" / "kouros", tmp_path / "bin" / "noted"
    there = shlex.quote(str(notes))
    lines = ["#!/bin/sh", f'{{ pwd; printf "%s\\0" "$@"; }} > {there}', f"env -0 > {there}.env", ""]
    program.write_text("\n".join(lines), encoding="utf-8")

    def start() -> subprocess.CompletedProcess[str]:
        folder, _, words = notes.read_text(encoding="utf-8").partition("\n")
        known = dict(pair.split("=", 1) for pair in notes.with_name("noted.env").read_text("utf-8").split("\0") if pair)
        notes.unlink()
        return kouros_process(tuple(words.split("\0")[:-1]), Path(folder), known)

    return start


def a_night_was_made(folder: Path) -> bool:
    # The database is that of the file of secrets.
    return (folder / "reports" / "latest" / "index.html").is_file() and (folder / "night.sqlite").is_file()


@pytest.mark.long("test_what_systemd_would_start")
def test_cron(placed: Callable[[str], str], tmp_path: Path) -> None:
    """Its line is run as cron runs it: by /bin/sh, from the home folder, with four variables and nothing else."""
    lines = [line for line in placed("kouros.cron").splitlines() if line and not line.startswith("#")]
    assignments = [line for line in lines if re.fullmatch(r"[A-Z]+=\S+", line)]
    [entry] = [line for line in lines if line not in assignments]
    fields = entry.split(maxsplit=5)
    for field, most in zip(fields[:5], (59, 23, 31, 12, 7), strict=True):
        assert field == "*" or int(field) <= most
    assert "%" not in fields[5]  # cron takes it for the end of the command
    done = subprocess.run(
        ["/bin/sh", "-c", fields[5]],
        cwd=tmp_path.parent,
        env={"HOME": str(tmp_path), "LOGNAME": "kouros", "SHELL": "/bin/sh", "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")  # nothing to mail
    assert a_night_was_made(tmp_path)


@pytest.mark.skipif(ANALYZE is None, reason="systemd-analyze is not on this machine: apt-get install systemd")
def test_systemd_accepts_the_units(placed: Callable[[str], str], tmp_path: Path) -> None:
    """Both units by systemd's own check; the service's exposure by its own measure, 0 the best and 10 the worst."""
    assert ANALYZE is not None
    units = []
    for name in ("kouros.service", "kouros.timer"):
        units.append(tmp_path / name)
        units[-1].write_text(placed(name), encoding="utf-8")
    checked = subprocess.run([ANALYZE, "verify", "--man=no", *units], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr
    assert all(name not in checked.stderr for name in ("kouros.service", "kouros.timer"))
    told = subprocess.run(
        [ANALYZE, "security", "--offline=true", "--no-pager", units[0]], capture_output=True, text=True, check=False
    )
    level = re.search(r"Overall exposure level for kouros.service: ([\d.]+)", told.stdout)
    assert level is not None, told.stderr
    assert float(level[1]) < 4.0


@pytest.mark.parametrize("name", ["museum", "a 100% 'museum' \\"])
def test_the_units_of_a_workspace_name_this_machines_places(tmp_path: Path, name: str) -> None:
    """Whatever its folder is called, systemd reads that very folder from them; nothing is written over."""
    folder = tmp_path / name
    done = kouros_process(("init", name, "--systemd"), tmp_path)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in folder.iterdir()} >= {"kouros.toml", "kouros.service", "kouros.timer"}
    again = kouros_process(("init", name, "--systemd"), tmp_path)
    assert (again.returncode, "there already" in again.stderr) == (2, True)
    text = (folder / "kouros.service").read_text(encoding="utf-8")
    assert "/srv/kouros" not in text
    assert "/opt/kouros" not in text
    (folder / "kouros.service").unlink()
    (folder / "kouros.timer").unlink()
    alone = kouros_process(("init", name, "--systemd"), tmp_path)
    assert alone.returncode == 0, alone.stderr
    assert text == (folder / "kouros.service").read_text(encoding="utf-8")
    if ANALYZE is None:
        pytest.skip("systemd-analyze is not on this machine: apt-get install systemd")
    units = [str(folder / unit) for unit in ("kouros.service", "kouros.timer")]
    checked = subprocess.run([ANALYZE, "verify", "--man=no", *units], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr
    assert "kouros.service" not in checked.stderr


def test_what_systemd_would_start(
    placed: Callable[[str], str], started: Callable[[], subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    unit = ConfigParser(interpolation=None, strict=False)
    unit.optionxform = str  # type: ignore[assignment,method-assign]
    unit.read_string(placed("kouros.service"))
    service = unit["Service"]
    secrets = Path(service["EnvironmentFile"].removeprefix("-")).read_text(encoding="utf-8").split()
    subprocess.run(
        shlex.split(service["ExecStart"]),
        cwd=service["WorkingDirectory"],
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), **dict(pair.split("=", 1) for pair in secrets)},
        check=True,
    )
    done = started()
    assert done.returncode == 0, done.stderr
    assert all(line.startswith('{"time": ') for line in done.stderr.splitlines())
    assert a_night_was_made(tmp_path)


def test_what_airflow_would_start(
    placed: Callable[[str], str], started: Callable[[], subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    """Without Airflow: the file is Python, and the commands of its tasks do what they say, by bash."""
    calls = [node for node in ast.walk(ast.parse(placed("kouros_airflow.py"))) if isinstance(node, ast.Call)]
    tasks = [
        {word.arg: word.value.value for word in call.keywords if isinstance(word.value, ast.Constant)}
        for call in calls
        if getattr(call.func, "id", "") == "BashOperator"
    ]
    assert [task["task_id"] for task in tasks] == ["check", "run"]
    for task in tasks:
        subprocess.run(
            ["bash", "-c", task["bash_command"]],
            cwd=task["cwd"],
            env=environment({"KOUROS_DATABASE": "night.sqlite"}),
            check=True,
        )
        done = started()
        assert done.returncode == 0, done.stderr
    assert a_night_was_made(tmp_path)


@pytest.mark.skipif(not AIRFLOW, reason="needs Airflow in an environment of its own: make airflow")
def test_the_dag_in_airflow_itself(placed: Callable[[str], str], tmp_path: Path) -> None:
    folder = tmp_path / "dags"
    folder.mkdir()
    (folder / "kouros_airflow.py").write_text(placed("kouros_airflow.py"), encoding="utf-8")
    known = environment(
        {
            "AIRFLOW_HOME": str(tmp_path / "airflow"),
            "AIRFLOW__CORE__DAGS_FOLDER": str(folder),
            "AIRFLOW__CORE__LOAD_EXAMPLES": "false",
            "KOUROS_DATABASE": "night.sqlite",
        }
    )
    known.pop("PYTHONPATH", None)  # Airflow is no part of this environment
    program = str(Path(AIRFLOW).with_name("airflow"))
    for words in (["db", "migrate"], ["dags", "test", "kouros_nightly", "2031-05-01"]):
        done = subprocess.run([program, *words], env=known, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "state=success" in done.stdout + done.stderr
    assert a_night_was_made(tmp_path)


def test_the_documentation_names_every_example() -> None:
    page = "".join(
        (ROOT / "docs" / "how-to" / f"{name}.md").read_text(encoding="utf-8") for name in ("schedule", "server")
    )
    for example in EXAMPLES.iterdir():
        if not example.name.startswith("__"):
            assert f"examples/{example.name}" in page
