"""The package as others meet it: lazy names, floors, and a wheel that carries its files."""

import ast
import itertools
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from collections import Counter
from pathlib import Path

import pytest

import pipeline
from pipeline.analysis.classify import NO_MODEL, WHEN_HELD, models_of
from pipeline.kernels import cache_folder
from pipeline.mitigate.measures import MEASURES
from pipeline.models import MODELS
from pipeline.records import Support
from pipeline.resources import resource
from pipeline.tables import table

ROOT = Path(__file__).resolve().parents[1]


def python(code: str, folder: Path, **places: str) -> str:
    environment = {**os.environ, **places}
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_the_public_names_are_handed_on() -> None:
    from pipeline import Motion, read_motion, respond, trace, transmit

    assert all(callable(name) for name in (Motion, read_motion, respond, trace, transmit))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = pipeline.nothing


def test_every_model_but_the_building_block_is_tried_on_some_object() -> None:
    """By its class, or by how it is held; `rocking` where a pad lets it slide, `unanchored` what objects stand in."""
    given = {name for row in table("classes") for name in row["models"].split("|")}
    given |= {name for support in Support for name in models_of(support)}
    assert given - {NO_MODEL, WHEN_HELD, ""} == {model.name for model in MODELS} - {
        "oscillator",
        "rocking",
        "unanchored",
    }


def test_every_measure_has_a_row_of_the_table() -> None:
    assert {row["measure"] for row in table("measures")} == {measure.name for measure in MEASURES.own}


def test_a_name_of_a_class_means_one_thing() -> None:
    sources = sorted((ROOT / "pipeline").rglob("*.py"))
    nodes = (node for f in sources for node in ast.walk(ast.parse(f.read_text())))
    named = Counter(node.name for node in nodes if isinstance(node, ast.ClassDef))
    assert len(named) > 200
    assert [name for name, times in named.items() if times > 1] == []


def test_importing_the_package_is_free_and_the_names_survive_any_order() -> None:
    """`pipeline` itself must load nothing heavy; a submodule imported first must not hide a function."""
    heavy = "numpy", "pandas", "numba", "obspy", "sqlalchemy", "scipy"
    loaded = python(f"import sys, pipeline; print([m for m in {heavy} if m in sys.modules])", ROOT)
    assert loaded == "[]"
    assert python("import pipeline.analysis.response, pipeline; print(pipeline.respond.__name__)", ROOT) == "respond"


def test_help_does_not_wait_for_compilers() -> None:
    heavy = "pandas", "numba", "obspy", "sqlalchemy", "scipy"
    code = f"import sys, pipeline.cli; print([m for m in {heavy} if m in sys.modules])"
    assert python(code, ROOT) == "[]"


def test_a_warm_response_loads_the_compiler_and_nothing_else_that_is_heavy(tmp_path: Path) -> None:
    """With its motion kept: loading these takes longer than what is computed.  A first time needs some of them."""
    heavy = "pandas", "pyarrow", "obspy", "scipy.signal", "sqlalchemy", "jinja2", "rich", "pipeline.settings"
    code = (
        "import sys; from pipeline.cli import kouros; "
        "kouros.main(['respond', 'sliding', 'friction_static=0.1', '--json'], standalone_mode=False); "
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    # Motions are kept in a folder of this test, machine code where it always is.
    places = {"KOUROS_CACHE": str(tmp_path), "NUMBA_CACHE_DIR": cache_folder()}
    first, again = (python(code, ROOT, **places).splitlines()[-1] for _ in range(2))
    assert "obspy" in first
    assert again == "[]"


OTHER_NAME = """
import kouros.motions
from kouros.records import Motion
import kouros, pipeline, sys
import pipeline.analysis.response, pipeline.motions, pipeline.records
assert kouros is pipeline and kouros.respond is pipeline.analysis.response.respond
assert kouros.motions is pipeline.motions and Motion is pipeline.records.Motion
assert sys.modules["kouros.motions"].__spec__.name == "pipeline.motions"
try:
    import kouros.nothing
except ModuleNotFoundError as problem:
    assert "kouros.nothing" in str(problem)
else:
    raise AssertionError
from pathlib import Path
print(Path(pipeline.__file__).parents[1])
"""


def test_it_is_imported_as_kouros_too_and_nothing_is_there_twice(tmp_path: Path) -> None:
    """By the two folders that an editable install puts on the path."""
    both = f"{ROOT}{os.pathsep}{ROOT / 'pipeline' / '_alias'}"
    assert python(OTHER_NAME, tmp_path, PYTHONPATH=both) == str(ROOT)
    loaded = python(
        "import sys, kouros; print([m for m in ('numpy', 'numba') if m in sys.modules])", tmp_path, PYTHONPATH=both
    )
    assert loaded == "[]"


def test_the_command_runs_as_a_module_too(tmp_path: Path) -> None:
    """Where the folder of the command is not on the path, as in a notebook or under Windows."""
    both = f"{ROOT}{os.pathsep}{ROOT / 'pipeline' / '_alias'}"
    told = subprocess.run(
        [sys.executable, "-m", "kouros", "--version"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": both}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert told.stdout.startswith("kouros, version ")


def test_the_wheel_carries_schemas_templates_and_the_demo_site(tmp_path: Path) -> None:
    """Built by the real back end, unpacked, and asked for its files from outside of the checkout."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    unpacked = tmp_path / "unpacked"
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        archive.extractall(unpacked)
    assert not [n for n in names if n.endswith(".pyc") or "__pycache__" in n]
    code = (
        f"import sys; sys.path.insert(0, {str(unpacked)!r})\n"
        "from pipeline.resources import resource\n"
        "print(resource('templates', 'gallery.html'), resource('schemas', 'migrations', 'env.py'),"
        " resource('site_motions', 'demo', 'manifest.toml'))"
    )
    found = python(code, tmp_path)
    assert found.count(str(unpacked)) == 3
    assert "pipeline/collection/data/carnegie_2000.csv" in names
    assert "pipeline/tables/friction.csv" in names
    # With types for those who call it, under both of its names, and of the version that it says itself.
    assert {"pipeline/py.typed", "kouros/py.typed"} < set(names)
    assert not [n for n in names if "_alias" in n]
    assert wheel.name.startswith(f"kouros-{pipeline.__version__}-")
    assert python(f"import sys; sys.path.insert(0, {str(unpacked)!r})\n{OTHER_NAME}", tmp_path) == str(unpacked)


def test_a_resource_that_is_not_there_is_named() -> None:
    with pytest.raises(FileNotFoundError, match=r"templates/absent\.html is neither in"):
        resource("templates", "absent.html")


def test_every_dependency_has_its_reason() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    project = tomllib.loads(text)["project"]
    for requirement in [*project["dependencies"], *itertools.chain(*project["optional-dependencies"].values())]:
        assert re.search(rf'"{re.escape(requirement)}",?\]? +# \S+', text), requirement


def test_constraints_pin_versions_and_name_no_index() -> None:
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Za-z0-9_.-]+==[^ ;]+", pin) for pin in pins)
    names = {pin.partition("==")[0].lower().replace("_", "-") for pin in pins} | {"kouros"}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for requirement in [*project["dependencies"], *itertools.chain(*project["optional-dependencies"].values())]:
        assert re.match(r"[A-Za-z0-9_.-]+", requirement)[0].lower().replace("_", "-") in names, requirement  # type: ignore[index]


def test_no_file_ties_the_project_to_a_machine() -> None:
    """Text files name no folder of a build machine and no user."""
    tied = re.compile(r"(?:^|[\s\"'(=])/(?:work|farm|root|home)/")
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False).stdout.split()
    for name in files:
        path = ROOT / name
        if path.suffix in {".py", ".toml", ".md", ".html", ".txt", ".yml"} and path.name != Path(__file__).name:
            assert not tied.search(path.read_text(encoding="utf-8", errors="replace")), name
