"""kouros check --numerics beside kouros.toml: its result is kept, and the next night shows it."""

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline import cache
from pipeline.cache import SELF_TESTS, Cache, CacheEntry
from pipeline.cli.console import Console
from pipeline.kernels import KERNEL_VERSION
from pipeline.night.run import run
from pipeline.settings import load_settings
from pipeline.tools.rerender import render_again
from pipeline.verification import self_measurement as numerics
from pipeline.verification import selftest
from tests.museum import workspace

QUICK = tuple(case for case in numerics.CASES if case.what.startswith(("friction", "one sample")))


def test_it_is_kept_and_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The quick cases of the real self-test: kept as they came out, on the next night's page, and rendered again."""
    monkeypatch.setattr(numerics, "CASES", QUICK)
    settings = workspace(tmp_path)
    assert selftest.kept(settings.kept) is None
    done = list(selftest.self_test(settings))
    test = selftest.kept(settings.kept)
    assert test is not None
    assert list(test.cases) == done
    assert all(outcome.ok for outcome in done)
    assert test.kernels == KERNEL_VERSION
    report = run(settings, Console(quiet=True)).report
    assert report is not None
    page = (report.parent / "method.html").read_text(encoding="utf-8")
    assert f"All {len(done)} cases passed" in page
    assert "outdated" not in page
    again = render_again(load_settings(tmp_path / "kouros.toml"), None)
    assert (again.parent / "method.html").read_text(encoding="utf-8") == page


def test_without_a_workspace_nothing_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(numerics, "CASES", QUICK[:1])
    assert len(list(selftest.self_test(None))) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("other", [{}, {"when": 1}, {"cases": [{"what": 5}]}])
def test_one_of_another_form_counts_as_none(tmp_path: Path, other: dict[str, object]) -> None:
    """As another version of Kouros may have put it."""
    Cache(tmp_path).put(SELF_TESTS, selftest.LAST, CacheEntry(other), lasting=True)
    assert selftest.kept(tmp_path) is None


def test_a_case_of_the_wrong_type_is_refused(tmp_path: Path) -> None:
    """Text where a number stands would stop the report; a result that is no number is kept as none."""
    outcome = selftest.Outcome("a", "b", None, 0.0, False, 0.1, "ValueError: no")
    test = selftest.SelfTest("2026-01-01T00:00:00+00:00", "0.1.0", KERNEL_VERSION, "a machine", [outcome])
    selftest.keep(test, tmp_path)
    assert selftest.kept(tmp_path) == replace(test, cases=[outcome])
    wrong = test.plain()
    wrong["cases"][0]["limit"] = "large"
    Cache(tmp_path).put(SELF_TESTS, selftest.LAST, CacheEntry(wrong), lasting=True)
    assert selftest.kept(tmp_path) is None


def test_it_outlives_a_change_of_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The report says itself that it is outdated."""
    test = selftest.SelfTest("2026-01-01T00:00:00+00:00", "0.1.0", "other kernels", "a machine", [])
    selftest.keep(test, tmp_path)
    monkeypatch.setattr(cache, "code_version", lambda: 64 * "0")
    Cache(tmp_path).prune(days=1.0, most_bytes=0)
    assert selftest.kept(tmp_path) == test
