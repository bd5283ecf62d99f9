"""A kill and a full disk at every call that writes, renames, links, removes, cuts or syncs a file of the museum.

What each must leave is said in `calls.py`: a whole report, a status that speaks of it, an equal next night, nothing
else.  `make test-long` tries a sample, and `make soak` every call.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from .conftest import environment

pytestmark = pytest.mark.slow_file

STRIDE = int(os.environ.get("KOUROS_CALLS", "0"))
"""One call of so many is disturbed, from the first on; `make soak` disturbs each; 0: the sample."""

SAMPLE = {
    "run": {"kill": [29, 720], "full disk": [647, 1200]},
    "import": {"kill": [17, 240], "full disk": [24, 240]},
    "decide": {"kill": [20, 240], "full disk": [13, 240]},
    "prune": {"kill": [150, 1600]},
    "report": {"kill": [90, 1600], "full disk": [60, 1600]},
}
"""Where the first is disturbed, and after how many the next: some thousand calls in all, of which about a dozen."""

NIGHT = 600
"""Calls that the night has at least, for it does have an import, a report and a database, and tidies up."""


@pytest.fixture(scope="session")
def disturbing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program that counts the calls, compiled."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or not sys.platform.startswith("linux"):
        pytest.skip("calls are counted by a C program that Linux loads before all others: install a C compiler")
    library = tmp_path_factory.mktemp("disturb") / "disturb.so"
    source = Path(__file__).parent / "c" / "disturb.c"
    subprocess.run([compiler, "-O1", "-Wall", "-shared", "-fPIC", "-o", str(library), str(source), "-ldl"], check=True)
    return library


@pytest.mark.long("operations/test_interruptions::test_a_kill_at_any_moment")
def test_a_kill_and_a_full_disk_at_any_call(disturbing: Path, shaking: Path, tmp_path: Path) -> None:
    ways = {"kill": [1, STRIDE], "full disk": [1, STRIDE]}
    attacks: dict[str, Any] = dict.fromkeys(SAMPLE, ways) if STRIDE else SAMPLE
    plan = {"folder": str(tmp_path), "site": str(shaking), "attacks": attacks}
    done = subprocess.run(
        [sys.executable, "-m", "tests.operations.calls", json.dumps(plan)],
        cwd=Path(__file__).parents[2],
        env=environment({"LD_PRELOAD": str(disturbing)}),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    calls = {line["verb"]: len(line["calls"]) for line in lines if "calls" in line}
    outcomes = [line for line in lines if "way" in line]
    wrong = [outcome for outcome in outcomes if outcome["wrong"]]
    print(f"{calls} calls, {len(outcomes)} disturbed, {len(wrong)} wrong")
    assert not wrong, json.dumps(wrong, indent=1)
    assert calls["run"] > NIGHT
    assert {(o["verb"], o["way"]) for o in outcomes} >= {(verb, way) for verb in attacks for way in attacks[verb]}
    assert all(o["code"] == -9 for o in outcomes if o["way"] == "kill")
