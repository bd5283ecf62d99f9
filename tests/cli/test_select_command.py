"""kouros motions select, as a seismologist types it."""

import json
import math
from pathlib import Path

import pytest

from tests.museum import kouros, own_site

pytestmark = pytest.mark.slow_file


def code_spectrum(folder: Path, level: float) -> Path:
    file = folder / "target.csv"
    rows = [f"{t},{level * (1.0 if t < 0.5 else 0.5 / t)}" for t in (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)]
    file.write_text("\n".join(["period_s,sa_g", *rows]) + "\n", encoding="utf-8")
    return file


def test_select_says_what_is_lacking_and_writes_the_best_only_when_asked(tmp_path: Path) -> None:
    code_spectrum(tmp_path, 1.5)
    words = ["motions", "select", "demo", "--target", "target.csv", "--count", "2", "--out", "chosen"]
    (tmp_path / "demo").mkdir()
    nothing = kouros(*words, folder=tmp_path)
    assert nothing.returncode == 4
    assert "none can be used (there are no files)" in nothing.stderr
    (tmp_path / "demo").rmdir()
    own_site(tmp_path, "raw")
    assert kouros("motions", "process", "raw", "--out", "demo", folder=tmp_path).returncode == 0
    refused = kouros(*words, folder=tmp_path)
    assert refused.returncode == 4
    assert "1 motion can be chosen, and 2 are asked for" in refused.stderr
    assert "--best takes the best that there is" in refused.stderr
    assert "PGV cm/s" in refused.stdout
    assert not (tmp_path / "chosen").exists()
    dry = kouros(*words, "--best", "--dry-run", folder=tmp_path)
    assert (dry.returncode, (tmp_path / "chosen").exists()) == (0, False), dry.stderr
    assert "would write chosen/manifest.toml" in dry.stdout
    done = kouros(*words, "--best", "--level", "475 years", "--return-period", "475", "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["meets_target"] is False
    (row,) = answer["motions"]
    # The geometric mean of its spectrum is the target's.
    assert math.isclose(sum(math.log(r) for r in answer["mean_ratio"]), 0.0, abs_tol=0.04)
    listed = json.loads(kouros("motions", "list", "chosen", "--json", folder=tmp_path).stdout)
    assert [(one["level"], one["name"]) for one in listed] == [("475 years", row["record"])]
    assert listed[0]["pgv"] == pytest.approx(row["pgv_cm_s"] / 100, rel=1e-3)


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ((), 2, "Missing option '--target'"),
        (("--target", "absent.csv"), 4, "absent.csv: file: cannot be read"),
        (("--target", "target.csv", "--periods", "2"), 2, "--periods '2': give two periods in s"),
        (("--target", "target.csv", "--periods", "2,1"), 2, "the shorter first"),
        (("--target", "target.csv", "--periods", "0.1,9"), 2, "spans 0.05 to 4 s, but 0.1 to 9 s are asked for"),
        (("--target", "target.csv", "--max-scale", "0.5"), 2, "max-scale: a number from 1"),
    ],
)
def test_what_cannot_be_asked(tmp_path: Path, words: tuple[str, ...], code: int, message: str) -> None:
    code_spectrum(tmp_path, 0.5)
    (tmp_path / "records").mkdir()
    done = kouros("motions", "select", "records", *words, folder=tmp_path)
    assert done.returncode == code
    assert message in done.stderr
