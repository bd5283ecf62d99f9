"""The night: it adds up, it never loses the last report, and it says what changed."""

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.analysis.response import respond
from pipeline.cache import MOTIONS, CacheWarning
from pipeline.collection.database import open_database
from pipeline.collection.errors import ShrunkError
from pipeline.motions import read_site
from pipeline.motions.errors import MotionError
from pipeline.night.run import Selection, run, summarise
from pipeline.operations.workspace import LockedError, UsageError, locked
from pipeline.records import RunRecord
from pipeline.report.pages.tallies import tally, total
from pipeline.resources import resource
from pipeline.settings import SettingsError, load_settings
from pipeline.store.pages import load_page
from pipeline.store.runs import list_runs, load_head, load_run
from pipeline.tools.rerender import compare, render_again
from tests.museum import ROWS, SILENT, own_site, workspace

pytestmark = pytest.mark.slow_file


def test_the_demonstration_accounts_for_every_object(demo_folder: Path) -> None:
    """2,000 rows: 1,374 on display in 34 galleries, 626 not; each in exactly one state."""
    engine = open_database(demo_folder / "kouros.sqlite")
    head, pages = load_head(engine)
    record = load_run(engine)
    summary = summarise(head, pages, total(tally(load_page(engine, page.key)) for page in pages))
    assert head.assessments == ()
    assert len(pages) == len({page.key for page in pages}) == 37  # what is not on display has three pages of its own
    assert (summary.objects, summary.on_display, summary.galleries) == (2000, 1374, 34)
    assert summary.act + summary.watch + summary.fine + summary.cannot == 1374
    assert summary.assessed + summary.cannot == 1374
    assert sum(summary.missing.values()) >= summary.cannot > 0
    assert summary.act > 0
    for assessment in record.assessments:
        assert assessment.aside is not assessment.scene.item.on_display
        if not assessment.aside:
            assert bool(assessment.findings) is not bool(assessment.scene.missing)


def test_the_exports_say_what_the_store_says(demo_folder: Path, demo_record: RunRecord) -> None:
    folder = demo_folder / "reports" / "latest"
    with (folder / "findings.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    findings = [f for a in demo_record.assessments for f in a.findings]
    assert len(rows) == len(findings)
    assert {r["verdict"] for r in rows} <= {"pass", "fail", "undetermined"}
    lines = (folder / "findings.jsonl").read_text(encoding="utf-8").splitlines()
    assert len(lines) == len(findings)
    assert sum(1 for line in lines if json.loads(line)["verdict"] == "fail") == sum(
        1 for f in findings if f.verdict == "fail"
    )


def test_a_night_with_bad_input_ends_and_names_it(tmp_path: Path) -> None:
    """Negative, absurd (9,600 inches) and missing dimensions, a hostile title: findings, never a crash."""
    absurd = ["4,B,Vase,-1.2,,", "5,B,Vase,243.84,,", "6,B,Vase,much,,", "7,,Vase,1.2,0.2,0.2"]
    summary = run(workspace(tmp_path, ROWS + absurd), SILENT)
    assert (summary.objects, summary.cannot) == (7, 4)
    assert summary.missing["height"] == 4
    record = load_run(open_database(tmp_path / "kouros.sqlite"))
    problems = {a.scene.item.object_number: a.scene.item.problems for a in record.assessments}
    assert "-1.2" in problems["4"][0].message
    assert "243.84" in problems["5"][0].message
    assert "much" in problems["6"][0].message
    assert summary.latest is not None
    pages = [p.read_text(encoding="utf-8") for p in summary.latest.resolve().glob("*.html")]
    # The page's own script is allowed by its hash; the title's is text.
    assert all(page.count("<script") == page.count("script-src 'sha256-") for page in pages)
    assert any("&lt;script&gt;alert(1)&lt;/script&gt;" in page for page in pages)


def test_an_unchanged_night_changes_nothing_and_keeps_the_old_report(tmp_path: Path) -> None:
    settings = workspace(tmp_path)
    first = run(settings, SILENT)
    second = run(settings, SILENT)
    assert second.changes is not None
    assert not second.changes
    assert first.report is not None
    assert first.report.exists()
    assert second.latest is not None
    assert second.report is not None
    assert second.latest.resolve() == second.report.parent.resolve()
    assert not compare(settings, None, None)
    assert [r.run_id for r in list_runs(open_database(settings.database))] == [second.run_id, first.run_id]


def test_a_changed_object_is_named(tmp_path: Path) -> None:
    settings = workspace(tmp_path)
    run(settings, SILENT)
    workspace(tmp_path, [ROWS[0], "2,B,Plate,0.03,0.1,0.1", ROWS[2], "9,B,Vase,1.2,0.2,0.2"])
    changes = run(settings, SILENT).changes
    assert changes is not None
    assert [p.object_number for p in changes.added] == ["9"]
    assert [i.object_number for i in changes.inputs] == ["2"]


def test_a_refused_motion_keeps_the_last_report(tmp_path: Path) -> None:
    site = own_site(tmp_path)
    settings = workspace(tmp_path, site="site")
    first = run(settings, SILENT)
    record = site / "CI.CLC..HNN.mseed"
    record.write_bytes(record.read_bytes()[:30_001])
    with pytest.raises(MotionError, match=r"sha256|hash"):
        run(settings, SILENT)
    assert first.report is not None
    assert (tmp_path / "reports" / "latest").resolve() == first.report.parent.resolve()
    assert len(list_runs(open_database(settings.database))) == 1


def test_a_shrunken_source_publishes_nothing(tmp_path: Path) -> None:
    settings = workspace(tmp_path)
    first = run(settings, SILENT)
    workspace(tmp_path, ROWS[:1])
    with pytest.raises(ShrunkError, match="67% fewer"):
        run(settings, SILENT)
    assert first.report is not None
    assert (tmp_path / "reports" / "latest").resolve() == first.report.parent.resolve()


def test_a_part_of_the_collection_does_not_become_the_latest_report(tmp_path: Path) -> None:
    settings = workspace(tmp_path)
    whole = run(settings, SILENT)
    part = run(settings, SILENT, Selection(galleries=("B",)))
    assert part.objects == 2
    assert part.latest is None
    assert whole.report is not None
    assert (tmp_path / "reports" / "latest").resolve() == whole.report.parent.resolve()
    one = run(settings, SILENT, Selection(objects=("2",)), dry_run=True)
    assert (one.objects, one.report) == (1, None)
    again = run(settings, SILENT)
    assert again.changes is not None
    assert not again.changes  # compared with the last whole run, not with the part


def test_an_unknown_gallery_is_an_error_that_helps(tmp_path: Path) -> None:
    settings = workspace(tmp_path, ["1,Hall of Sculpture,Vase,1.2,0.2,0.2"])
    with pytest.raises(UsageError, match=r"no gallery 'Hall of Skulpture' .* did you mean 'Hall of Sculpture'"):
        run(settings, SILENT, Selection(galleries=("Hall of Skulpture",)))


def test_a_second_run_waits_for_nobody(tmp_path: Path) -> None:
    settings = workspace(tmp_path)
    with locked(settings), pytest.raises(LockedError, match="another run holds"):
        run(settings, SILENT)


def test_a_report_is_rendered_again_from_the_store_byte_for_byte(tmp_path: Path) -> None:
    settings = workspace(tmp_path, site="site")
    site = own_site(tmp_path)
    first = run(settings, SILENT)
    shutil.rmtree(site)  # nothing is computed again
    index = render_again(settings, None)
    assert first.report is not None
    folder = first.report.parent
    files = [path.relative_to(folder) for path in folder.rglob("*") if path.is_file()]
    assert len(files) > 10
    for name in files:
        assert (index.parent / name).read_bytes() == (folder / name).read_bytes(), name


def test_a_swapped_motion_moves_verdicts_and_is_named(tmp_path: Path) -> None:
    site = own_site(tmp_path)
    settings = workspace(tmp_path, site="site")
    run(settings, SILENT)
    manifest = site / "manifest.toml"
    manifest.write_text(manifest.read_text(encoding="utf-8").replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.004"))
    changes = run(settings, SILENT).changes
    assert changes is not None
    assert len(changes.motions) == 1
    assert {(v.object_number, v.model, v.before, v.after) for v in changes.verdicts if v.model == "standing"} == {
        ("1", "standing", "fail", "pass")
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[museum]\nnam = 'x'\n", "museum.nam: Extra inputs are not permitted"),
        ("[analysis]\nazimuth_step = 0\n", "analysis.azimuth_step: Input should be greater than 0"),
        ("[museum\n", "is not valid TOML"),
        ("home = '/tmp'\n", "'home' is not a setting"),
    ],
)
def test_bad_settings_name_the_key(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "kouros.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(SettingsError, match=message):
        load_settings(file)


def test_secrets_come_from_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = workspace(tmp_path)
    monkeypatch.setenv("KOUROS_DATABASE", "postgresql://user:s3cr3t@localhost/kouros")
    assert settings.database == "postgresql://user:s3cr3t@localhost/kouros"
    assert "s3cr3t" not in repr(settings)


def test_the_night_on_a_postgresql_server(tmp_path: Path, postgresql_url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same museum gives the same findings through SQLite and through PostgreSQL."""
    embedded = run(workspace(tmp_path), SILENT)
    monkeypatch.setenv("KOUROS_DATABASE", postgresql_url)
    served = run(workspace(tmp_path), SILENT)
    other = load_run(open_database(postgresql_url), served.run_id)
    monkeypatch.delenv("KOUROS_DATABASE")
    one = load_run(open_database(tmp_path / "kouros.sqlite"), embedded.run_id)
    assert other.assessments == one.assessments
    assert other.charts == one.charts


def test_findings_do_not_depend_on_the_rest_of_the_collection(demo_folder: Path, tmp_path: Path) -> None:
    """One gallery alone gives bit for bit what it gave among all 2,000 objects."""
    copy = shutil.copytree(demo_folder, tmp_path / "copy", symlinks=True)
    settings = load_settings(copy / "kouros.toml")
    engine = open_database(settings.database)
    whole = load_run(engine)
    part = run(settings, SILENT, Selection(galleries=("Hall of Sculpture Balcony",)))
    alone = load_run(engine, part.run_id)
    wanted = [a for a in whole.assessments if a.scene.item.gallery == "Hall of Sculpture Balcony"]
    assert [a.findings for a in alone.assessments] == [a.findings for a in wanted]
    assert [a.recommendations for a in alone.assessments] == [a.recommendations for a in wanted]


def test_the_motions_of_the_demonstration(demo_record: RunRecord) -> None:
    """Eleven of one level: at a friction of 0.05 they slide centimetres to nearly a metre (PGV 28 to 96 cm/s)."""
    assert len(demo_record.motions) == 11
    paths = [chart for key, chart in demo_record.charts.items() if key.startswith("path:")]
    assert len(paths) == 11
    for path in paths:
        (curve,) = path.curves
        assert 0.02 < np.hypot(curve.x, curve.y).max() < 1.0
        assert replace(path, curves=()).equal


def test_the_one_record_that_comes_along_is_as_strong_as_the_papers() -> None:
    """Scaled to the peak of the Getty's Representative Earthquake; a friction of 0.05 slides 5 to 30 cm (paper: 12)."""
    (level,) = read_site(resource("site_motions", "demo")).levels
    (one,) = level.motions
    assert one.measures["pga"] / 9.80665 == pytest.approx(0.7, rel=1e-12)
    (slid,) = respond("sliding", one.motion, friction_static=0.05)["displacement"]
    assert 0.05 < slid < 0.30


def test_a_kept_motion_is_the_motion_and_a_changed_manifest_is_another(tmp_path: Path) -> None:
    """Read twice from what was kept: the same to the last bit; another corner, or a damaged file: processed again."""
    site, kept = own_site(tmp_path), tmp_path / "kept"
    first = read_site(site, kept=kept).levels[0].motions[0]
    (file,) = (kept / MOTIONS).iterdir()
    again = read_site(site, kept=kept).levels[0].motions[0]
    assert again.motion.hash == first.motion.hash
    assert (again.motion.steps, again.measures) == (first.motion.steps, first.measures)
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.warns(CacheWarning, match="it is made again"):
        assert read_site(site, kept=kept).levels[0].motions[0].motion.hash == first.motion.hash
    manifest = site / "manifest.toml"
    manifest.write_text(manifest.read_text(encoding="utf-8").replace("highpass_hz = 0.1", "highpass_hz = 0.2"))
    assert read_site(site, kept=kept).levels[0].motions[0].motion.hash != first.motion.hash
