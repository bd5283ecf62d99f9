"""Every key covers what its result depends on: imports are followed from what computes, and what is reached counts."""

import ast
import shutil
import sys
from collections.abc import Iterator
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from pipeline import resources
from pipeline.resources import LIBRARIES, PRINTERS, code_files, code_version, page_files, page_version

PACKAGE = Path(resources.__file__).parent

COMPUTES = (
    "pipeline.night.assessment",
    "pipeline.night.unit_tasks",
    "pipeline.store.results",
    "pipeline.motions.site",
    "pipeline.analysis.figures",
    "pipeline.collection.reading",
    "pipeline.collection.object_index",
)
"""What makes the results that are kept: findings, motions, charts, histories, figures, items."""

DRAWS = ("pipeline.report.files.report_writer", "pipeline.report.files.page_renderer", "pipeline.report.files.exports")

LIBRARY = pytest.mark.long("test_another_version_of_a_library_makes_another_version")

GROUPS, OURS = ("obspy.plugin.waveform",), "pipeline."

MODULES = {"pywt": "pywavelets", "bidi": "python-bidi", "arabic_reshaper": "arabic-reshaper", "yaml": "pyyaml"}
"""Libraries that are imported by another name than they are installed by."""

HARMLESS = {
    "pandas": "the table of `respond` for a person; no result is taken from it",
    "psycopg": "hands over what a database holds",
    "pydantic": "checks what is given",
    "pydantic_core": "checks what is given",
    "sqlalchemy": "hands over what a database holds",
    "threadpoolctl": "how many threads, which changes no digit",
    "defusedxml": "refuses entities",
    "filelock": "one run at a time",
    "tomlkit": "writes settings for a person",
}
"""Libraries that are imported and that neither a number nor a page depends on, and why."""

HOLDS = {
    "matplotlib": "draws a motion in a notebook; pages that it draws on have it among `PRINTERS`",
    "pyarrow": "holds the columns of the listing",
}
"""The same of what computes only."""


def file_of(module: str) -> Path | None:
    path = PACKAGE.parent.joinpath(*module.split("."))
    return next((file for file in (path / "__init__.py", path.with_suffix(".py")) if file.is_file()), None)


class Imports(ast.NodeVisitor):
    """All that a file imports when it runs, at its top or in a function; not what only a type checker sees."""

    def __init__(self, module: str, file: Path) -> None:
        self._package = module if file.name == "__init__.py" else module.rpartition(".")[0]
        self.names: set[str] = set()
        self.visit(ast.parse(file.read_text(encoding="utf-8")))

    def visit_If(self, node: ast.If) -> None:
        checking = isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        for part in node.orelse if checking else [*node.body, *node.orelse]:
            self.visit(part)

    def visit_Import(self, node: ast.Import) -> None:
        self.names |= {one.name for one in node.names}

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        start = self._package.split(".")[: len(self._package.split(".")) - node.level + 1] if node.level else []
        base = ".".join([*start, *([node.module] if node.module else [])])
        self.names |= {base, *(f"{base}.{one.name}" for one in node.names)}

    def visit_Dict(self, node: ast.Dict) -> None:
        # Modules that a package imports by name when they are asked for (`_HOMES`).
        texts = [value.value for value in node.values if isinstance(value, ast.Constant)]
        for text in texts:
            if isinstance(text, str) and text.isidentifier() and file_of(f"{self._package}.{text}"):
                self.names.add(f"{self._package}.{text}")
        self.generic_visit(node)


@cache
def imports(module: str, file: Path) -> tuple[str, ...]:
    """Return what a module imports, which several walks ask for."""
    return tuple(sorted(Imports(module, file).names))


def reached(roots: tuple[str, ...]) -> tuple[dict[Path, str], dict[str, str]]:
    """Return the files of the package and the libraries that are imported from some modules, and from where."""
    files: dict[Path, str] = {}
    libraries: dict[str, str] = {}
    todo = [(root, "") for root in roots]
    while todo:
        name, by = todo.pop()
        parts = name.split(".")
        if parts[0] != "pipeline":
            if parts[0] not in sys.stdlib_module_names:
                libraries.setdefault(parts[0], by)
            continue
        for end in range(1, len(parts) + 1):
            module = ".".join(parts[:end])
            file = file_of(module)
            if file is not None and file not in files:
                files[file] = by
                todo += [(one, module) for one in imports(module, file)]
    return files, libraries


@pytest.mark.parametrize("root", COMPUTES)
def test_everything_that_computes_is_under_the_code_version(root: str) -> None:
    """A module that is reached and left out would leave what is kept as it was when that module changes."""
    files, libraries = reached((root,))
    covered = set(code_files())
    left_out = {file.relative_to(PACKAGE).as_posix(): by for file, by in files.items() if file not in covered}
    assert left_out == {}
    names = {MODULES.get(name, name): by for name, by in libraries.items() if name not in HARMLESS | HOLDS}
    assert {name: by for name, by in names.items() if name not in LIBRARIES} == {}


def test_imports_are_followed() -> None:
    """Else the test above could not fail: through functions, lazy names and packages, but not for types alone."""
    files, libraries = reached(COMPUTES)
    names = {file.relative_to(PACKAGE).as_posix() for file in files}
    assert {
        "__init__.py",
        "kernels/__init__.py",  # by importing anything of it
        "kernels/rocking.py",  # from a model, three imports away
        "motions/processing.py",
        "quantities.py",  # by everybody
        "tables/__init__.py",
        "collection/sources/xlsx.py",  # in a function, when such a file is opened
        "supports/floor.py",
    } <= names
    assert {"numpy", "numba", "scipy", "obspy", "pywt", "openpyxl", "lxml"} <= set(libraries)
    # What only a type checker imports is no dependency.
    assert "night/context.py" not in names
    drawing = {file.relative_to(PACKAGE).as_posix() for file in reached(DRAWS)[0]}
    assert {"report/pages/compose.py", "report/plots/svg.py", "records/result.py"} <= drawing
    # The rooms that are left out hold what such a follower would find, were it imported.
    assert not drawing <= {file.relative_to(PACKAGE).as_posix() for file in code_files()}


def test_everything_that_draws_is_under_the_page_version() -> None:
    files, libraries = reached(DRAWS)
    assert set(files) <= set(page_files())
    names = {MODULES.get(name, name) for name in libraries if name not in HARMLESS}
    assert names <= {*LIBRARIES, *PRINTERS}
    templates = resources.resource("templates")
    assert {file for file in templates.rglob("*") if file.is_file()} <= set(page_files())
    assert list(templates.rglob("*.html"))


def test_readers_that_are_found_by_their_entry_points_are_under_the_code_version() -> None:
    """No import leads to them: obspy asks for them by name."""
    readers = {entry.module for group in GROUPS for entry in entry_points(group=group) if entry.module.startswith(OURS)}
    assert len(readers) >= 7
    assert {file_of(module) for module in readers} <= set(code_files())


def test_every_table_that_code_reads_counts() -> None:
    """All that lies beside the code is code, a table, or for people only."""
    beside = {file for file in PACKAGE.rglob("*") if file.is_file() and "__pycache__" not in file.parts}
    beside = {file for file in beside if file.relative_to(PACKAGE).parts[0] != "_resources"}
    # A dictionary of compression changes the bytes that are kept, and nothing of what is read from them.
    assert {file.suffix for file in beside - set(page_files()) if file.parent.name != "dictionaries"} <= {
        ".md",
        ".typed",
    }
    assert PACKAGE / "tables" / "friction.csv" in code_files()
    assert PACKAGE / "collection" / "presets" / "tms.toml" in code_files()


@pytest.fixture
def copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the package and the templates, of which versions are told."""
    package = tmp_path / "pipeline"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__", "_resources"))
    shutil.copytree(resources.resource("templates"), tmp_path / "templates")
    monkeypatch.setattr(resources, "_PACKAGE", package)
    return tmp_path


def told() -> tuple[str, str]:
    return code_version.__wrapped__(), page_version.__wrapped__()


def changed(file: Path) -> Iterator[bytes]:
    """Change one byte of a file, and then change it back."""
    good = file.read_bytes()
    file.write_bytes(good[:-1] + bytes([good[-1] ^ 1]) if good else b"\n")
    yield good
    file.write_bytes(good)


@pytest.mark.long("test_a_name_a_new_file_and_a_moved_byte_count")
def test_one_byte_of_any_file_makes_another_version(copied: Path) -> None:
    """Code, tables and templates of every room, one after the other; each makes a version of its own."""
    before = told()
    assert before == told()
    assert before == (code_version(), page_version())
    seen_code, seen_page = {before[0]}, {before[1]}
    code, page = set(code_files()), page_files()
    assert len(page) > 250
    # Of each folder and ending one: they are read alike.
    tried = [*{(file.parent, file.suffix): file for file in page}.values()]
    for file in tried:
        for _ in changed(file):
            now = told()
            assert (now[0] not in seen_code) is (file in code), file
            assert now[1] not in seen_page, file
            seen_code.add(now[0])
            seen_page.add(now[1])
    assert told() == before
    assert len(seen_page) == len(tried) + 1 > 50


def test_a_name_a_new_file_and_a_moved_byte_count(copied: Path) -> None:
    before = told()
    file = copied / "pipeline" / "tables" / "friction.csv"
    moved = file.rename(file.with_name("friction_2.csv"))
    assert told()[0] != before[0]
    moved.rename(file)
    new = copied / "pipeline" / "models" / "new.py"
    new.write_bytes(b"")
    assert told()[0] != before[0]
    new.unlink()
    # The last byte of one file as the first of the next.
    first, second = sorted((copied / "pipeline" / "models").glob("*.py"))[:2]
    one, two = first.read_bytes(), second.read_bytes()
    first.write_bytes(one[:-1])
    second.write_bytes(one[-1:] + two)
    assert told()[0] != before[0]


@pytest.mark.parametrize(
    "name",
    [
        name if name in (LIBRARIES[0], PRINTERS[0]) else pytest.param(name, marks=LIBRARY)
        for name in (*LIBRARIES, *PRINTERS)
    ],
)
def test_another_version_of_a_library_makes_another_version(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before, real = told(), resources._installed
    monkeypatch.setattr(resources, "_installed", lambda one: "0.0" if one == name else real(one))
    after = told()
    assert (after[0] != before[0]) is (name in LIBRARIES)
    assert after[1] != before[1]
