"""A site begun from nothing, and records without a vertical: what is said of them, and that they are used."""

import json
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from pipeline.motions import MotionError, load_manifest, manifest_schema, read_motion, read_site
from pipeline.motions.entries import entries
from pipeline.motions.inspection import inspect
from pipeline.motions.manifest import manifest_file
from pipeline.motions.record import NO_VERTICAL
from pipeline.motions.summary import summaries
from pipeline.night.prepare import _level_note
from pipeline.report.pages.ground import motion_view
from pipeline.report.pages.record_words import processing
from pipeline.report.units import Units
from pipeline.resources import resource
from pipeline.tools.doctor import diagnose
from pipeline.tools.initialise import initialise
from pipeline.tools.strong_motion import process

DEMO = resource("site_motions", "demo")
HORIZONTAL = """
[site]
name = "Two"
latitude = 35.8
longitude = -117.6
[[level]]
name = "design"
combine = "max"
[[level.record]]
name = "two"
files = ["CI.CLC..HNE.mseed", "CI.CLC..HNN.mseed"]
response = "CI.CLC.xml"
processed = false
highpass_hz = 0.1
window_s = [30.0, 60.0]
vertical = "absent"
source = "a test"
licence = "none"
[level.record.components]
HNE = { axis = "x", orientation = 90 }
HNN = { axis = "y", orientation = 0 }
[level.record.sha256]
"""


@pytest.fixture
def begun(tmp_path: Path) -> Path:
    """The site's folder of a museum that was made by `kouros init`."""
    initialise(tmp_path)
    return tmp_path / "site_motions" / "site"


def test_the_manifest_of_a_new_site_is_valid_and_says_what_comes_next(begun: Path) -> None:
    plain = tomllib.loads((begun / "manifest.toml").read_text(encoding="utf-8"))
    Draft202012Validator(manifest_schema()).validate(plain)
    assert load_manifest(begun, begun=True).level == ()
    assert entries(begun) == []
    for use in (load_manifest, read_site, read_motion, inspect):
        with pytest.raises(
            MotionError, match="it names no records yet; add a record's files with `kouros motions add`"
        ):
            use(begun)
    # A site that is copied into the folder and not over it: which one is meant is said.
    shutil.copytree(DEMO, begun / "copied")
    with pytest.raises(MotionError, match="'copied' in it is a site of its own: name that folder"):
        load_manifest(begun)
    shutil.rmtree(begun / "copied")
    shutil.copy(DEMO / "CI.CLC..HNE.mseed", begun)
    (motions,) = (d for d in diagnose(begun.parents[1] / "kouros.toml") if d.what == "motions")
    assert motions.state == "warning"
    assert "beside it lies CI.CLC..HNE.mseed" in motions.message
    assert "`kouros motions add`; no night can run before" in motions.message


def test_what_entries_prints_is_a_manifest_once_its_questions_are_answered(begun: Path) -> None:
    for file in DEMO.glob("CI.*"):
        shutil.copy(file, begun)
    manifest = begun / "manifest.toml"
    printed = "\n".join(entries(begun))
    assert '# "CI.CLC.xml" = "' in printed
    printed = printed.replace('# units = "m/s2"', 'response = "CI.CLC.xml" #').replace(
        "# processed = false", "processed = false #"
    )
    printed = printed.replace('# "CI.CLC.xml"', '"CI.CLC.xml"')
    manifest.write_text(manifest.read_text(encoding="utf-8") + printed, encoding="utf-8")
    (record,) = load_manifest(begun).level[0].record
    demo = load_manifest(DEMO).level[0].record[0]
    assert record.components == demo.components
    assert record.sha256 == demo.sha256
    assert len(read_motion(begun)) == 1
    assert entries(begun) == []
    shutil.copy(DEMO / "CI.CLC..HNE.mseed", begun / "more.mseed")
    settings = begun.parents[1] / "kouros.toml"
    (found,) = (d for d in diagnose(settings) if d.what == "motions")
    digest = load_manifest(begun).level[0].record[0].sha256["CI.CLC..HNE.mseed"]
    assert f"not in the manifest: more.mseed (sha256 {digest}); `kouros motions entries`" in found.message


def two(folder: Path, text: str = HORIZONTAL) -> Path:
    """Write a site of the demonstration's two horizontal channels."""
    folder.mkdir(exist_ok=True)
    known = load_manifest(DEMO).level[0].record[0].sha256
    for name in ("CI.CLC..HNE.mseed", "CI.CLC..HNN.mseed", "CI.CLC.xml"):
        shutil.copy(DEMO / name, folder)
        text += f"{json.dumps(name)} = {json.dumps(known[name])}\n"
    (folder / "manifest.toml").write_text(text, encoding="utf-8")
    return folder


def test_a_record_without_a_vertical_shakes_horizontally_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 2)
    folder = two(tmp_path / "two")
    Draft202012Validator(manifest_schema()).validate(tomllib.loads((folder / "manifest.toml").read_text()))
    site = read_site(folder)
    (motion,) = read_motion(folder)
    assert not motion.acceleration[2].any()
    whole = two(tmp_path / "three", HORIZONTAL.replace('vertical = "absent"\n', ""))
    assert NO_VERTICAL in motion.steps
    assert "no vertical shaking was recorded, and none is assumed: two" in _level_note(site.levels[0])
    assert "No vertical component was recorded" in processing(inspect(folder)[0])
    (summary,) = summaries(site.levels)
    table = dict(motion_view(summary, {}, Units()).table)
    assert table["PGA"][2] == "–"
    assert table["PGA"][0] != "–"
    initialise(tmp_path)
    settings = tmp_path / "kouros.toml"
    settings.write_text(settings.read_text("utf-8").replace('folder = "site_motions/site"', 'folder = "two"'), "utf-8")
    (found,) = (d for d in diagnose(settings) if d.what == "motions")
    assert "no vertical was recorded, and none shakes anything: two" in found.message
    again = read_motion(manifest_file(process(folder, tmp_path / "out", "")))
    assert NO_VERTICAL in again[0].steps
    np.testing.assert_array_equal(again[0].acceleration, motion.acceleration)
    # Without the word it is a mistake, which the message and the schema both name.
    with pytest.raises(MotionError, match='or say vertical = "absent" where no vertical was recorded'):
        load_manifest(whole)
    plain = tomllib.loads((whole / "manifest.toml").read_text(encoding="utf-8"))
    assert list(Draft202012Validator(manifest_schema()).iter_errors(plain))


def test_horizontals_are_what_they_are_with_a_vertical(tmp_path: Path) -> None:
    folder = two(tmp_path / "two")
    with_z = HORIZONTAL.replace('vertical = "absent"\n', "").replace(
        '"CI.CLC..HNN.mseed"]', '"CI.CLC..HNN.mseed", "CI.CLC..HNZ.mseed"]'
    )
    with_z = with_z.replace("[level.record.sha256]", 'HNZ = { axis = "z", orientation = "up" }\n[level.record.sha256]')
    three = two(tmp_path / "three", with_z)
    shutil.copy(DEMO / "CI.CLC..HNZ.mseed", three)
    digest = load_manifest(DEMO).level[0].record[0].sha256["CI.CLC..HNZ.mseed"]
    with (three / "manifest.toml").open("a", encoding="utf-8") as stream:
        stream.write(f'"CI.CLC..HNZ.mseed" = "{digest}"\n')
    (flat,), (whole,) = read_motion(folder), read_motion(three)
    np.testing.assert_array_equal(flat.acceleration[:2], whole.acceleration[:2])
    assert whole.acceleration[2].any()
