"""An audit that could not ask anybody is no good audit."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import pytest

AUDIT = runpy.run_path(str(Path(__file__).parents[2] / ".ci" / "audit.py"))

CLEAN = {"name": "a", "version": "1", "vulns": []}
SKIPPED = {"name": "b", "skip_reason": "Dependency not found on PyPI and could not be audited"}
BAD = {"name": "c", "version": "2", "vulns": [{"id": "PYSEC-2031-1"}]}


@pytest.mark.parametrize(
    ("packages", "code", "said"),
    [
        ([CLEAN, CLEAN], 0, "2 versions looked up"),
        ([SKIPPED, SKIPPED], 75, "NOT AUDITED: 2 of 2"),
        ([CLEAN, SKIPPED], 75, "NOT AUDITED: 1 of 2"),
        ([CLEAN], 75, "NOT AUDITED: 1 of 2"),
        ([], 75, "NOT AUDITED"),
        ([SKIPPED, BAD], 1, "c 2: PYSEC-2031-1"),
    ],
)
def test_only_a_whole_and_clean_audit_is_good(packages: list[dict[str, Any]], code: int, said: str) -> None:
    found, lines = AUDIT["verdict"]({"dependencies": packages}, 2)
    assert found == code
    assert said in " ".join(lines)
