"""Which tests `make test` leaves to `make test-long`: each says which shorter one shows the same, and that one is run.

A test is long if it takes more than about four seconds of a quiet core.  It may be marked so only where another test
shows the mechanism from end to end; where none does, it is made cheaper, or takes fewer samples every day (`soak.py`).
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

TESTS = Path(__file__).parent


@dataclass(frozen=True)
class Marked:
    """The tests of a file; what shows the same as those that are long, and as those of which some cases are."""

    names: frozenset[str]
    whole: dict[str, str]
    cases: dict[str, list[str]]


def marks(nodes: list[ast.expr], named: dict[str, str]) -> Iterator[str]:
    """Yield what `pytest.mark.long("...")` says wherever it stands in expressions, by itself or by a name for it."""
    for node in nodes:
        for inner in ast.walk(node):
            if isinstance(inner, ast.Call) and ast.unparse(inner.func) == "pytest.mark.long":
                (said,) = inner.args
                assert isinstance(said, ast.Constant)
                yield str(said.value)
            elif isinstance(inner, ast.Name) and inner.id in named:
                yield named[inner.id]


def marked(text: str) -> Marked:
    if "mark.long" not in text:
        # To read all files as Python takes seconds.
        return Marked(frozenset(re.findall(r"^def (test_\w+)", text, re.M)), {}, {})
    tree = ast.parse(text)
    set_to = {ast.unparse(node.targets[0]): node.value for node in tree.body if isinstance(node, ast.Assign)}
    named = {name: said for name, value in set_to.items() for said in marks([value], {})}
    of_file = named.pop("pytestmark", None)
    names, whole, cases = set(), {}, {}
    for node in tree.body:
        if not isinstance(node, ast.FunctionDef):
            continue
        inside = [
            one
            for one in node.decorator_list
            if ast.unparse(one).startswith(("pytest.mark.parametrize", "pytest.fixture"))
        ]
        outside = [one for one in node.decorator_list if one not in inside]
        # A fixture may have cases that are long too.
        cases[node.name] = list(marks(inside, named))
        if node.name.startswith("test_"):
            names.add(node.name)
            for said in (*marks(outside, named), *([of_file] if of_file else [])):
                whole[node.name] = said
    return Marked(frozenset(names), whole, cases)


@pytest.fixture(scope="module")
def files() -> dict[str, Marked]:
    """The tests of every file, by its path from `tests` without the ending."""
    return {
        file.relative_to(TESTS).with_suffix("").as_posix(): marked(file.read_text(encoding="utf-8"))
        for file in TESTS.rglob("test_*.py")
    }


def problems(files: dict[str, Marked]) -> list[str]:
    """Return what is wrong with what marks say: a test that is not there, or is long itself."""
    found = []
    for name, tests in files.items():
        said = [*tests.whole.items(), *((test, one) for test, some in tests.cases.items() for one in some)]
        for test, other in said:
            where, _, witness = other.rpartition("::")
            there = files.get(where or name)
            if there is None or witness not in there.names:
                found.append(f"{name}::{test}: there is no test {other}")
            elif witness in there.whole:
                found.append(f"{name}::{test}: {other} is long too")
    return found


def test_each_long_test_names_one_that_shows_the_same_every_day(files: dict[str, Marked]) -> None:
    assert sum(len(tests.whole) for tests in files.values()) > 10
    assert problems(files) == []


@pytest.mark.parametrize(
    ("witness", "problem"),
    [
        ("test_short", ""),
        ("room/test_a::test_short", ""),
        ("test_gone", "there is no test"),
        ("room/test_b::test_short", "there is no test"),
        ("test_other", "is long too"),
    ],
)
def test_a_mark_that_names_nothing_or_what_is_long_is_seen(witness: str, problem: str) -> None:
    code = f"""
LONG = pytest.mark.long("{witness}")
@pytest.mark.long("{witness}")
def test_one(): ...
@pytest.mark.parametrize("at", [1, pytest.param(2, marks=LONG)])
def test_cases(at): ...
@pytest.mark.long("test_short")
def test_other(): ...
def test_short(): ...
"""
    found = problems({"room/test_a": marked(code)})
    assert len(found) == (2 if problem else 0)
    assert all(problem in one for one in found)


def test_no_room_has_more_long_tests_than_others(files: dict[str, Marked]) -> None:
    for room in {name.partition("/")[0] for name in files if "/" in name}:
        own = [tests for name, tests in files.items() if name.startswith(f"{room}/")]
        assert 2 * sum(len(tests.whole) for tests in own) <= sum(len(tests.names) for tests in own), room
