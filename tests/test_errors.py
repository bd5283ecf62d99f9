"""What people can mend ends as the error says; every other exception is a fault of Kouros, told with its place."""

import ast
import importlib
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import pipeline
from pipeline.collection.database import database_url
from pipeline.errors import InputError, KourosError, fault_words
from tests.museum import workspace

INSIDE = {
    # Caught where it is raised, or can only be reached by a mistake in Kouros.
    "cache.py",
    "collection/dimensions/pairing.py",
    "collection/dimensions/quantities.py",
    "collection/inventory/writing.py",
    "collection/sources/rows.py",
    "images/decoder.py",
    "images/decoding.py",
    "mitigate/rows.py",
    "motions/formats/blocks.py",
    "motions/site.py",
    "night/publication.py",
    "operations/report_status.py",
    "planning/efforts.py",
    "report/files/manifest.py",
    "report/pages/news.py",
    "store/news.py",
    "supports/__init__.py",
    "supports/refining.py",
    "verification/tradeoff.py",
}

PROGRAM = """
import numpy as np
from pipeline.night import run as nightly
from pipeline.cli import main
def broken(*_given):
    return np.ones(2) + np.ones(3)
nightly._read_site = broken
main()
"""


@pytest.mark.parametrize(
    ("more", "shown"),
    [
        ((), False),
        pytest.param(("--debug",), True, marks=pytest.mark.long("test_a_fault_of_ours_is_not_called_the_users")),
    ],
)
def test_a_fault_of_ours_is_not_called_the_users(tmp_path: Path, more: tuple[str, ...], shown: bool) -> None:
    """Before: exit code 2, "operands could not be broadcast together with shapes (2,) (3,)", and no hint."""
    workspace(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *more, "run"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "operands could not be broadcast together" in done.stderr
    assert ("Traceback" in done.stderr) is shown
    if not shown:
        said = done.stderr.strip().splitlines()[-1]
        assert said.startswith("kouros: a fault of Kouros, not of yours: ValueError: ")
        assert "night/run.py, line " in said
        assert said.endswith("--debug for the traceback")
    assert '"exit_code": 1' in (tmp_path / "reports" / "status.json").read_text(encoding="utf-8")


def test_every_error_that_kouros_names_can_be_mended_and_says_how_the_command_ends() -> None:
    """A new error that stands outside of the tree would be told as a fault of Kouros."""
    errors = set()
    for module in pkgutil.walk_packages(pipeline.__path__, "pipeline."):
        if ".migrations" in module.name:
            continue
        for _, thing in inspect.getmembers(importlib.import_module(module.name), inspect.isclass):
            own = thing.__module__.startswith("pipeline.") and not thing.__name__.startswith("_")
            if own and issubclass(thing, Exception) and not issubclass(thing, Warning):
                errors.add(thing)
    assert len(errors) > 10
    assert {e.__name__ for e in errors if not issubclass(e, KourosError)} == set()
    assert {e.exit_code for e in errors} == {1, 2, 4, 5, 6, 7}


def test_what_is_given_wrongly_is_never_refused_with_a_bare_error() -> None:
    """A bare ValueError is told as a fault of Kouros: only what users cannot cause may raise one."""
    root = Path(pipeline.__file__).parent
    bare = set()
    for file in root.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            raised = node.exc if isinstance(node, ast.Raise) else None
            name = raised.func if isinstance(raised, ast.Call) else raised
            if isinstance(name, ast.Name) and name.id == "ValueError":
                bare.add(file.relative_to(root).as_posix())
    assert bare == INSIDE


@pytest.mark.parametrize("address", ["://", "postgresql://u:p@host:port/db", "mysql://h/d"])
def test_an_address_of_a_database_that_cannot_be_read_is_refused_without_its_password(address: str) -> None:
    with pytest.raises(InputError) as refused:
        database_url(address)
    assert ":p@" not in str(refused.value)


def test_the_place_of_a_fault_is_the_innermost_of_ours() -> None:
    with pytest.raises(AttributeError) as met:
        pipeline.respond("sliding", object(), friction_static=0.2)  # type: ignore[arg-type]
    assert fault_words(met.value).startswith("AttributeError: 'object' object has no attribute")
    assert "(analysis/model_runs.py, line " in fault_words(met.value)
