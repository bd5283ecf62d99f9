"""Parts of other packages: found, checked, said and left out where they cannot be used, and part of every key."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from pipeline.errors import InputError
from pipeline.extensions import ExtensionWarning, Registry, extension_versions
from pipeline.resources import code_version
from tests.packages import install

GROUP = "kouros.tried"


@dataclass(frozen=True)
class Part:
    name: str


def part(value: object) -> Part:
    if not isinstance(value, str):
        raise InputError(f"{value!r} is no text: name one")
    return Part(value)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder that packages are found in; what they import is forgotten afterwards."""
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)
    extension_versions.cache_clear()
    yield tmp_path
    extension_versions.cache_clear()
    code_version.cache_clear()
    for name in set(sys.modules) - before:
        if name.startswith("tried"):
            del sys.modules[name]


def test_parts_of_other_packages_follow_the_own_ones_by_name(site: Path) -> None:
    install(site, "tried_b", "X = 'x'", f"[{GROUP}]\nb = tried_b:X\n")
    install(site, "tried_a", "Y = 'y'", f"[{GROUP}]\na = tried_a:Y\n")
    registry = Registry(GROUP, (Part("own"),), part)
    assert [one.name for one in registry] == ["own", "y", "x"]
    assert Part("x") in registry
    assert registry[0] == Part("own")
    assert registry[1:] == (Part("y"), Part("x"))
    assert len(registry) == 3
    assert registry.problems == ()


def test_nothing_is_loaded_before_somebody_asks(site: Path) -> None:
    install(site, "tried_late", "X = 'x'", f"[{GROUP}]\nlate = tried_late:X\n")
    registry = Registry(GROUP, (), part)
    assert "tried_late" not in sys.modules
    assert len(registry) == 1
    assert "tried_late" in sys.modules


@pytest.mark.parametrize(
    ("source", "wrong"),
    [
        ("X = 5", "5 is no text: name one"),
        ("X = 'own'", "there is a part called 'own' already; give it another name"),
        ("", "AttributeError: module 'tried_bad' has no attribute 'X'"),
        ("raise RuntimeError('no licence')", "RuntimeError: no licence"),
        ("raise SystemExit('usage')", "SystemExit: usage"),
        ("import absent_from_here", "ModuleNotFoundError: No module named 'absent_from_here'"),
    ],
)
def test_what_cannot_be_used_is_said_and_left_out(site: Path, source: str, wrong: str) -> None:
    install(site, "tried_bad", source, f"[{GROUP}]\nbad = tried_bad:X\n", "2.1")
    install(site, "tried_good", "X = 'good'", f"[{GROUP}]\ngood = tried_good:X\n")
    registry = Registry(GROUP, (Part("own"),), part)
    with pytest.warns(ExtensionWarning) as said:
        names = [one.name for one in registry]
    assert names == ["own", "good"]
    (problem,) = registry.problems
    assert problem == (
        f"tried_bad 2.1 offers 'bad' ({GROUP}: tried_bad:X), which cannot be used and is left out: {wrong}. "
        "Mend it, or uninstall tried_bad"
    )
    assert [str(one.message) for one in said] == [problem]


@pytest.mark.parametrize("value", ["", "two words", ":X", "5:X", "absent.module:X"])
def test_an_entry_point_that_names_nothing_is_left_out(site: Path, value: str) -> None:
    install(site, "tried_damaged", "", f"[{GROUP}]\ndamaged = {value}\n")
    (site / "tried_damaged-1.0.dist-info" / "METADATA").write_text("")
    registry = Registry(GROUP, (Part("own"),), part)
    with pytest.warns(ExtensionWarning, match="a package without a name . offers 'damaged'"):
        assert len(registry) == 1
    (one,) = extension_versions()
    assert one[:4] == (GROUP, "damaged", "a package without a name", "?")


def test_a_module_that_reads_the_registry_while_it_is_loaded_sees_the_own_parts(
    site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    registry = Registry(GROUP, (Part("own"),), part)
    monkeypatch.setattr(sys.modules[__name__], "REGISTRY", registry, raising=False)
    source = f"from {__name__} import REGISTRY\nX = 'with ' + ', '.join(one.name for one in REGISTRY)"
    install(site, "tried_reader", source, f"[{GROUP}]\nreader = tried_reader:X\n")
    assert [one.name for one in registry] == ["own", "with own"]


def test_versions_are_told_without_loading_and_follow_the_source(site: Path) -> None:
    install(site, "tried_kept", "X = 'x'", f"[{GROUP}]\nkept = tried_kept:X\n[another]\nkept = tried_kept:X\n")
    (one,) = extension_versions()
    assert one[:4] == (GROUP, "kept", "tried_kept", "1.0")
    assert "tried_kept" not in sys.modules
    (site / "tried_kept.py").write_text("X = 'y'")
    # As in another process.
    extension_versions.cache_clear()
    sys.modules["pipeline.extensions"]._source_digest.cache_clear()
    (other,) = extension_versions()
    assert other.code != one.code


def test_the_version_of_the_code_takes_them_in(site: Path) -> None:
    """Every key of what is kept depends on it."""
    code_version.cache_clear()
    before = code_version()
    install(site, "tried_key", "X = 'x'", f"[{GROUP}]\nkey = tried_key:X\n")
    code_version.cache_clear()
    assert code_version() == before
    extension_versions.cache_clear()
    code_version.cache_clear()
    assert code_version() != before
