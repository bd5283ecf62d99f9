"""A museum with a survey that was written, of which each test has its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from .surveyed import copied, museum_with_survey


@pytest.fixture(scope="module")
def surveyed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("survey") / "museum"
    museum_with_survey(folder)
    return folder


@pytest.fixture
def museum(surveyed: Path, tmp_path: Path) -> Path:
    return copied(surveyed, tmp_path)
