"""A museum with a night behind it, of which each test has its own, and a desk that runs over it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from argon2 import PasswordHasher

from pipeline.desk import accounts
from pipeline.settings import load_settings
from tests.conftest import made_once
from tests.museum import edit, museum_of, night, vases
from tests.report.conftest import browser

from .visiting import Visitor, served

__all__ = ["browser"]

HOSTILE = '"><img src=x onerror=alert(1)>../%2e é'
"""The number of an object, as bad as a museum's record lets it be; its title is worse."""

PAINTINGS = [
    {"object_number": f"P{n}", "title": f"Landscape with a café {n}", "object_name": "painting", "gallery": "Room 0",
     "height_m": "1.0", "width_m": "1.2", "depth_m": "0.04", "medium": "oil on canvas"}
    for n in range(6)
]  # fmt: skip


@pytest.fixture(autouse=True)
def quick_passwords(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a password cost a millisecond in place of a fifth of a second of both cores."""
    # What is put aside here is what the library advises.
    assert (accounts._HASHER.time_cost, accounts._HASHER.memory_cost) >= (3, 65_536)
    quick = PasswordHasher(time_cost=1, memory_cost=64, parallelism=1)
    monkeypatch.setattr(accounts, "_HASHER", quick)
    monkeypatch.setattr(accounts, "_NOBODY", quick.hash("of nobody"))


@pytest.fixture(scope="session")
def night_behind() -> Path:
    """The folder of a museum after its first night, only to be copied."""

    def make(around: Path) -> None:
        folder = around / "museum"
        hostile = {**vases(1, 1)[0], "object_number": HOSTILE, "title": "<script>document.title='pwned'</script>"}
        stored = {**vases(1, 1)[0], "object_number": "S.1", "title": "Jug in the store", "gallery": "Storage"}
        museum_of(folder, [*vases(), *PAINTINGS, hostile, stored], furnished=True, sampled=True)
        edit(folder / "kouros.toml", 'length = "cm"', 'length = "in"')
        night(load_settings(folder / "kouros.toml"))

    return made_once("desk", make) / "museum"


@pytest.fixture
def museum(night_behind: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(night_behind, tmp_path / "museum", symlinks=True))


@pytest.fixture
def address(museum: Path) -> Iterator[str]:
    with served(museum) as there:
        yield there


@pytest.fixture
def visitor(address: str) -> Visitor:
    return Visitor(address)
