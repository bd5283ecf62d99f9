"""One lasting name for the newest whole report; earlier ones are kept."""

import os
from pathlib import Path

import pytest

from pipeline.report import ReportError, publish


def _report(root: Path, name: str) -> Path:
    folder = root / name
    folder.mkdir()
    (folder / "index.html").write_text(name, encoding="utf-8")
    return folder


def test_latest_moves_and_earlier_reports_stay(tmp_path: Path) -> None:
    first, second = _report(tmp_path, "first"), _report(tmp_path, "second")
    assert publish(first, tmp_path) == tmp_path / "latest"
    assert (tmp_path / "latest" / "index.html").read_text(encoding="utf-8") == "first"
    publish(second, tmp_path)
    assert (tmp_path / "latest" / "index.html").read_text(encoding="utf-8") == "second"
    assert (first / "index.html").exists()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["first", "latest", "second"]


def test_the_link_is_relative_so_that_the_reports_can_be_moved(tmp_path: Path) -> None:
    root = tmp_path / "a"
    root.mkdir()
    publish(_report(root, "one"), root)
    root.rename(tmp_path / "b")
    assert (tmp_path / "b" / "latest" / "index.html").read_text(encoding="utf-8") == "one"


def test_where_links_are_refused_a_page_leads_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError("a required privilege is not held by the client")

    monkeypatch.setattr(os, "symlink", refuse)
    page = publish(_report(tmp_path, "a & b"), tmp_path)
    assert page == tmp_path / "latest.html"
    assert 'url=a%20%26%20b/index.html"' in page.read_text(encoding="utf-8")


def test_a_page_left_by_another_system_does_not_go_stale(tmp_path: Path) -> None:
    (tmp_path / "latest.html").write_text("old", encoding="utf-8")
    publish(_report(tmp_path, "new"), tmp_path)
    assert "new/index.html" in (tmp_path / "latest.html").read_text(encoding="utf-8")


def test_what_is_no_report_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileNotFoundError, match=r"index\.html"):
        publish(tmp_path / "empty", tmp_path)
    inner = tmp_path / "root"
    inner.mkdir()
    with pytest.raises(ReportError, match="not inside"):
        publish(_report(tmp_path, "outside"), inner)
    (inner / "latest").mkdir()
    with pytest.raises(ReportError, match="move it away"):
        publish(_report(inner, "one"), inner)
