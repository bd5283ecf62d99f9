"""`kouros check`: each trouble of a night is found before the night, and told with its remedy."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from pipeline.errors import DamageWarning
from pipeline.kernels import user_cache
from pipeline.operations.report_status import mark_failed, mark_running
from pipeline.operations.run_summary import SUMMARY, words_of
from pipeline.operations.workspace import locked
from pipeline.report import publish
from pipeline.settings import Settings, load_settings
from pipeline.tools.doctor import Diagnosis, diagnose
from pipeline.tools.doctor_checks import OVERDUE_H
from pipeline.tools.initialise import initialise
from tests.museum import edit
from tests.night.changing import FRICTION

from .conftest import within

Museum = Callable[..., Path]


def found(folder: Path) -> dict[str, Diagnosis]:
    return {diagnosis.what: diagnosis for diagnosis in diagnose(folder / "kouros.toml")}


def report(settings: Settings, age_h: float) -> Path:
    """Publish the files of a report of a while ago."""
    when = datetime.now(UTC) - timedelta(hours=age_h)
    folder = settings.path("reports") / f"{when:%Y%m%dT%H%M%S}.000-1"
    folder.mkdir(parents=True)
    (folder / "index.html").write_text("report", encoding="utf-8")
    (folder / SUMMARY).write_text(f'{{"finished": "{when.isoformat()}"}}', encoding="utf-8")
    publish(folder, folder.parent)
    return folder


def test_a_new_museum_is_well_but_for_its_first_night(museum: Museum) -> None:
    looked = found(museum(more="[retention]\nruns = 3\n"))
    assert {what for what, d in looked.items() if d.state == "wrong"} == set()
    assert "no good report yet" in looked["last report"].message
    assert looked["retention"].message.startswith("3 runs kept at most")
    assert looked["lock"].state == looked["disk"].state == looked["permissions"].state == "ok"


def test_an_export_that_is_no_longer_made_is_told(museum: Museum) -> None:
    """Every night is good then, and tells of a collection that is long another one."""
    folder = museum()
    (source,) = folder.glob("*.csv")
    assert found(folder)["collection"].state == "ok"
    old = (datetime.now(UTC) - timedelta(days=40)).timestamp()
    os.utime(source, (old, old))
    told = found(folder)["collection"]
    assert (told.state, "written 40 days ago: see whether the export is still made" in told.message) == (
        "warning",
        True,
    )


def test_a_site_without_records_is_what_comes_next_until_a_night_has_run(tmp_path: Path) -> None:
    initialise(tmp_path)
    looked = found(tmp_path)
    assert {what for what, d in looked.items() if d.state == "wrong"} == set()
    assert "add a record's files with `kouros motions add`; no night can run before" in looked["motions"].message
    report(load_settings(tmp_path / "kouros.toml"), 1.0)
    assert found(tmp_path)["motions"].state == "wrong"
    (tmp_path / "site_motions" / "site" / "manifest.toml").write_text("[site]\nname = 3\n", encoding="utf-8")
    assert found(tmp_path)["motions"].state == "wrong"


def test_a_night_that_is_overdue_stale_or_interrupted(museum: Museum) -> None:
    folder = museum()
    settings = load_settings(folder / "kouros.toml")
    report(settings, OVERDUE_H + 12.0)
    assert "2.0 days ago; see whether the nightly run is still started" in found(folder)["last report"].message
    report(settings, 1.0)
    assert found(folder)["last report"].state == "ok"
    mark_failed(settings, ValueError("the share is gone"), "the share is gone")
    stale = found(folder)["last report"]
    assert (stale.state, stale.message.startswith("stale: ")) == ("warning", True)
    assert "the share is gone" in stale.message
    mark_running(settings)
    assert "was interrupted" in found(folder)["last report"].message
    with locked(settings):
        looked = found(folder)
    assert "a run is at work" in looked["last report"].message
    assert (looked["lock"].state, f"process {os.getpid()}" in looked["lock"].message) == ("warning", True)


def test_a_night_that_is_dated_later_than_now(museum: Museum) -> None:
    folder = museum()
    report(load_settings(folder / "kouros.toml"), -48.0)
    told = found(folder)["last report"]
    assert (told.state, "later than now: a clock was wrong then" in told.message) == ("warning", True)


def test_tables_of_the_museums_own(museum: Museum) -> None:
    folder = museum()
    edit(folder / "kouros.toml", 'friction = ""', 'friction = "tilt.csv"')
    looked = found(folder)["tables"]
    assert (looked.state, "[tables] friction names the file" in looked.message) == ("wrong", True)
    (folder / "tilt.csv").write_text(FRICTION.format(0.2), encoding="utf-8")
    looked = found(folder)["tables"]
    assert (looked.state, looked.message) == ("ok", "your own: 1 row of friction.csv")
    (folder / "tilt.csv").write_text(FRICTION.format("steep"), encoding="utf-8")
    assert "tilt.csv, line 2, object_material 'Marble': column 'value'" in found(folder)["tables"].message


def test_hooks_that_cannot_be_told(museum: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("KOUROS_TOKEN", raising=False)
    hook = '[[hooks.webhook]]\nurl = "http://localhost/"\ntoken_from = "KOUROS_TOKEN"\n'
    folder = museum(more=hook + '[[hooks.command]]\nrun = ["no-such-program"]\n')
    looked = found(folder)["hooks"]
    assert looked.state == "wrong"
    assert "the environment lacks KOUROS_TOKEN" in looked.message
    assert "no program 'no-such-program'" in looked.message
    monkeypatch.setenv("KOUROS_TOKEN", "t0ken")
    museum(more=hook)
    told = found(folder)["hooks"]
    assert (told.state, told.message) == ("ok", "1 found and not tried: webhook localhost")


def test_everything_kept_for_ever_and_a_log_in_the_way(museum: Museum) -> None:
    folder = museum(more='[logs]\nfile = "logs"\n')
    (folder / "logs").mkdir()
    looked = found(folder)
    assert looked["retention"].state == "warning"
    assert looked["log"].state == "wrong"


def test_settings_that_everybody_may_change_are_told(museum: Museum) -> None:
    folder = museum()
    (folder / "kouros.toml").chmod(0o666)
    assert "everybody may change" in found(folder)["permissions"].message


def test_a_disk_too_small_for_the_next_report(museum: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    """A report that seems to weigh ten thousand gigabytes (a sparse file) cannot be followed by another."""
    folder = museum()
    last = report(load_settings(folder / "kouros.toml"), 1.0)
    with (last / "findings.csv").open("wb") as file:
        file.truncate(10**13)
    disk = found(folder)["disk"]
    assert (disk.state, "make room" in disk.message) == ("warning", True)


def test_a_password_in_an_error_of_the_database_is_not_told(museum: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = museum()
    for address in (
        "postgresql://kouros:geheim@127.0.0.1:1/x",
        "postgresql://kouros:geheim@h:port/x",
        "mysql://u:geheim@h/x",
    ):
        monkeypatch.setenv("KOUROS_DATABASE", address)
        looked = found(folder)
        assert looked["database"].state == "wrong"
        assert all("geheim" not in diagnosis.message for diagnosis in looked.values())


@pytest.mark.skipif(os.name != "posix", reason="owners and modes are those of POSIX")
def test_compiled_code_is_not_loaded_from_a_folder_that_others_may_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In /tmp anybody may make the folder first, and put code there that numba would run."""
    home, temporary = tmp_path / "home", tmp_path / "tmp"
    temporary.mkdir()
    monkeypatch.setenv("KOUROS_CACHE", str(home))
    monkeypatch.setattr("tempfile.tempdir", str(temporary))
    safe = user_cache("kernels")
    assert safe == home / "kouros" / "kernels"
    safe.chmod(0o777)
    fallback = user_cache("kernels")
    assert fallback == temporary / f"kouros-{os.getuid()}" / "kernels"
    fallback.parent.chmod(0o777)
    last = user_cache("kernels")
    assert last.parent == temporary
    assert last.name.startswith("kouros-kernels-")
    assert last.stat().st_mode & 0o077 == 0


def test_a_folder_of_reports_that_is_empty_after_good_nights_is_told(museum: Museum) -> None:
    """As the place of a drive is where the drive is not mounted."""
    folder = museum()
    assert within(folder, "run").returncode == 0
    (folder / "reports").rename(folder / "elsewhere")
    assert "holds no report, though 1 night" in within(folder, "check").stdout
    with pytest.warns(DamageWarning, match="holds no report, though 1 night"):
        assert within(folder, "run").returncode == 0
    assert "holds no report" not in within(folder, "check").stdout


@pytest.mark.parametrize("number", [errno.EROFS, errno.EACCES, errno.ESTALE, errno.EIO])
def test_what_a_disk_does_is_told_with_what_mends_it(number: int) -> None:
    said = words_of(OSError(number, os.strerror(number), "/srv/reports/index.html"))
    assert "/srv/reports/index.html" in said
    assert "then run again" in said
    assert "--debug" not in said
