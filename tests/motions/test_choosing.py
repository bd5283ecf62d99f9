"""A suite from a folder of real records: what is read, what is left out, and the site that is written of it."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path

import numpy as np
import pytest

from pipeline.motions import load_manifest, read_motion, read_site
from pipeline.motions.candidates import read_candidates
from pipeline.motions.choosing import ACCEPTED, SuiteWish, choose_suite
from pipeline.motions.errors import MotionError
from pipeline.motions.matching import spectrum_compatible_record
from pipeline.motions.spectra import psa
from pipeline.motions.targets import read_target
from pipeline.motions.writing import write_site
from pipeline.quantities import G
from pipeline.records import Motion
from pipeline.resources import resource
from pipeline.tools.selecting import SitePlace, select, write
from pipeline.tools.synthetic import synthesise_from
from tests.motions.conftest import tone

RECORDS = Path(__file__).parents[1] / "data" / "motions"
SHAFTER, MELOLAND, COALINGA = ("0111?.smc.gz", "CHAN??.V2.gz", "ce36456p*.gz")
REDWOOD_RAW, REDWOOD = ("np01002r*.gz", "np01002p*.gz")
WAIPAWA = "2018*.gz"


def unpacked(folder: Path, *patterns: str) -> Path:
    folder.mkdir(exist_ok=True)
    for pattern in patterns:
        found = sorted(RECORDS.glob(pattern))
        assert found
        for file in found:
            (folder / file.stem).write_bytes(gzip.decompress(file.read_bytes()))
    return folder


def target(folder: Path, of: list[Motion] | None = None, level: float = 1.0) -> Path:
    """A target: the geometric mean of motions that are scaled to one level, or a smooth one."""
    periods = np.geomspace(0.05, 4.0, 400)
    if of is None:
        values = level * np.where(periods < 0.5, 0.75, 0.375 / periods)
    else:
        logs = np.log([psa(motion, periods, 0.05, "rotd50") / G for motion in of])
        values = level * np.exp(logs.mean(axis=0))
    file = folder / "uhs.csv"
    lines = [f"{t:.10g},{v:.10g}" for t, v in zip(periods, values, strict=True)]
    file.write_text("\n".join(["period_s,sa_g", *lines]) + "\n", encoding="utf-8")
    return file


def test_a_folder_of_files_is_grouped_and_nothing_stops_the_rest(tmp_path: Path) -> None:
    folder = unpacked(tmp_path / "pool", SHAFTER, MELOLAND, COALINGA, REDWOOD, REDWOOD_RAW)
    (folder / "notes.txt").write_text("no record", encoding="utf-8")
    (folder / "README.md").write_text("words", encoding="utf-8")
    (folder / "0111c.smc").write_bytes((folder / "0111c.smc").read_bytes()[:9000])
    below = folder / "counts"
    below.mkdir()
    for name in ("CI.CLC..HNE.mseed", "CI.CLC..HNN.mseed", "CI.CLC..HNZ.mseed", "CI.CLC.xml"):
        shutil.copy(resource("site_motions", "demo", name), below)
    found = read_candidates([folder], 2.0)
    assert {one.record.name: len(one.record.files) for one in found.candidates} == {
        "1336 1979-10-15 23:17": 3,  # Imperial Valley at Meloland: its channels have numbers of their own
        "4225..HN 1989-10-18 00:04": 3,
        "4225..HN 1989-10-18 00:04 (2)": 3,
        "CI.CLC..HN 2019-07-06 03:19": 3,
        "ce36456p_CE36456.V2": 1,
    }
    clc = next(one for one in found.candidates if one.station == "CI.CLC")
    assert (clc.record.response, clc.record.processed) == ("counts/CI.CLC.xml", False)
    # As recorded: the agency's peak of the larger component is 0.53 g.
    assert clc.pga / G == pytest.approx(0.53, abs=0.01)
    told = {one.name: one.reason for one in found.unusable}
    assert "is of no format that is known" in told["notes.txt"]
    assert "0111c.smc" in told
    assert "has 2 channels" in told["111..HN 1989-10-18 00:04"]
    raw, processed = (one for one in found.candidates if one.station == ".4225")
    assert raw.recording == processed.recording is not None


def test_the_suite_has_the_mean_and_its_spectra_are_those_of_every_direction(tmp_path: Path) -> None:
    folder = unpacked(tmp_path / "pool", SHAFTER, MELOLAND, COALINGA, REDWOOD, REDWOOD_RAW, WAIPAWA)
    pool = {one.record.name: one for one in read_candidates([folder], 1.0).candidates}
    names = ["111..HN 1989-10-18 00:04", "ce36456p_CE36456.V2", "1336 1979-10-15 23:17"]
    meant = [pool[name].motion for name in names]
    periods = np.geomspace(0.1, 1.0, 40)
    level = [np.exp(np.log(psa(m, periods, 0.05, "rotd50")).mean()) for m in meant]
    # The mean of three of them, scaled alike: a suite that is known to meet it.
    scaled = [m.scaled(level[0] / own, "a test") for m, own in zip(meant, level, strict=True)]
    wish = SuiteWish(periods=(0.1, 1.0), count=3)
    suite = choose_suite([folder], read_target(target(tmp_path, scaled)), wish)
    assert sorted(one.candidate.record.name for one in suite.motions) == sorted(names)
    assert suite.lacking == ()
    # The target is read between its own periods, 1 % apart: that is what is left.
    assert np.abs(suite.ratio - 1.0).max() < 5e-3
    for one in suite.motions:
        own = level[names.index(one.candidate.record.name)]
        assert one.scale == pytest.approx(level[0] / own, rel=5e-3)
    one = suite.motions[0]
    at = 20
    a = one.scale * one.candidate.motion.acceleration
    turned = [
        psa(
            Motion(one.candidate.motion.dt, [np.cos(r) * a[0] + np.sin(r) * a[1], a[0], a[2]]), periods[[at]], 0.05, "x"
        )
        for r in np.radians(np.arange(180))
    ]
    # RotD50 is good to 1e-4, and the single directions to rounding.
    assert suite.spectra_g[0, at] * G == pytest.approx(float(np.median(turned)), rel=2e-4)


def test_one_recording_counts_once_and_what_is_lacking_is_said(tmp_path: Path) -> None:
    folder = unpacked(tmp_path / "pool", REDWOOD, REDWOOD_RAW, WAIPAWA, COALINGA)
    suite = choose_suite([folder], read_target(target(tmp_path)), SuiteWish(count=3))
    # Two versions of one recording, and one of 0.02 g that no allowed scale brings to 0.3 g.
    assert len(suite.motions) == 2
    assert len({one.candidate.recording for one in suite.motions}) == 2
    told = "\n".join(suite.lacking)
    assert "2 motions can be chosen, and 3 are asked for; 1 more would be scaled beyond 4" in told
    off = suite.ratio - 1.0
    assert (np.abs(off) > ACCEPTED).any()
    assert f"the mean is up to {np.abs(off[off < -0.1]).max():.0%} below the target" in told
    with pytest.raises(MotionError, match="there is no such folder"):
        choose_suite([tmp_path / "absent"], read_target(target(tmp_path)))
    (tmp_path / "empty").mkdir()
    with pytest.raises(MotionError, match="none can be used"):
        choose_suite([tmp_path / "empty"], read_target(target(tmp_path)))


def test_the_site_that_is_written_shakes_as_was_said(tmp_path: Path) -> None:
    folder = unpacked(tmp_path / "pool", SHAFTER, MELOLAND, COALINGA)
    demo = resource("site_motions", "demo")
    file = target(tmp_path)
    suite = select([folder, demo], file, SuiteWish(count=4, largest_scale=8.0))
    # A site's own scale is left out: what the demonstration scales to 0.7 g is chosen from as recorded.
    clc = next(one for one in suite.motions if "CLC" in one.candidate.record.name)
    assert clc.pga == pytest.approx(clc.scale * 0.53 * G, rel=0.01)
    out = tmp_path / "site"
    would = write(suite, file, out, SitePlace(name="Two folders", level="475 years"), dry_run=True)
    assert not out.exists()
    assert write(suite, file, out, SitePlace(name="Two folders", level="475 years")) == would
    site = read_site(out)
    (level,) = site.levels
    assert (site.name, level.name, level.combine) == ("Two folders", "475 years", "max")
    for motion, one in zip(level.motions, suite.motions, strict=True):
        assert motion.measures["pga"] == pytest.approx(one.pga, rel=1e-9)
        assert motion.measures["pgv"] == pytest.approx(one.pgv, rel=1e-9)
        found = psa(motion.motion, suite.periods, 0.05, "rotd50") / G
        np.testing.assert_allclose(found, suite.spectra_g[suite.motions.index(one)], rtol=1e-9)
    record = load_manifest(out).level[0].record[0]
    assert record.scale == suite.motions[0].scale
    text = (out / "manifest.toml").read_text(encoding="utf-8")
    assert text.count("# chosen: ") == 4
    assert (out / "selection.csv").read_text(encoding="utf-8").count("\n") == 5
    with pytest.raises(MotionError, match="nothing is overwritten"):
        write(suite, file, out, SitePlace(name="Two folders"))


def test_a_velocity_of_the_manifest_goes_with_the_scale(tmp_path: Path) -> None:
    site = tmp_path / "pool"
    shutil.copytree(resource("site_motions", "demo"), site)
    manifest = site / "manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("scale_to_pga_g = 0.7 ", "scale = 2.0\nv_max_cm_s = 90.0 "), encoding="utf-8")
    file = target(tmp_path)
    suite = select([site], file, SuiteWish(count=1))
    write(suite, file, tmp_path / "site", SitePlace())
    (record,) = load_manifest(tmp_path / "site").level[0].record
    assert record.scale == suite.motions[0].scale
    assert record.v_max_cm_s == pytest.approx(45.0 * suite.motions[0].scale, rel=1e-12)
    manifest.write_text(
        text.replace("scale_to_pga_g = 0.7 ", "scale_to_pga_g = 0.7\nv_max_cm_s = 90.0 "), encoding="utf-8"
    )
    with pytest.raises(MotionError, match="v_max_cm_s: belongs to a scale that is not a number"):
        select([site], file, SuiteWish(count=1))


def test_compact_files_hold_whole_mm_per_s2_and_do_not_drift(tmp_path: Path) -> None:
    numbers = np.random.default_rng(1)
    data = np.vstack([tone(amplitude=3.0), tone(amplitude=2.0, frequency=2.0), 0.01 * numbers.standard_normal(4000)])
    motion = Motion(0.01, data, "small", (), "a test; licence: none")
    site = load_manifest(resource("site_motions", "demo")).site
    write_site(tmp_path / "site", [("design", motion)], site, licence="", why="a test", compact=True)
    (again,) = read_motion(tmp_path / "site")
    # To one unit each, and half a unit of what they add up to.
    assert np.abs(again.acceleration - data).max() <= 1.0e-3 + 1e-12
    assert np.abs(np.cumsum(again.acceleration - data, axis=1)).max() <= 0.5e-3 + 1e-9
    assert (tmp_path / "site" / "motion-1.mseed").stat().st_size < 0.1 * len(str(data.tolist()))


def test_a_record_is_changed_until_it_matches_and_is_named_so(tmp_path: Path) -> None:
    folder = unpacked(tmp_path / "pool", SHAFTER)
    (one,) = read_candidates([folder], 0.0).candidates
    periods = np.geomspace(0.03, 4.0, 40)
    wanted = G * np.where(periods < 0.5, 0.75, 0.375 / periods)
    made = spectrum_compatible_record(one.motion, periods, wanted, band=(0.5, 10.0), tolerance=ACCEPTED)
    # Between the frequencies that were controlled, checked by an oscillator of each component.
    check = np.geomspace(0.101, 1.99, 57)
    for axis in "xy":
        found = psa(made, check, 0.05, axis) / np.exp(np.interp(np.log(check), np.log(periods), np.log(wanted)))
        assert np.abs(found - 1.0).max() <= ACCEPTED + 0.01
    factor = np.abs(made.acceleration[2]).max() / np.abs(one.motion.acceleration[2]).max()
    np.testing.assert_allclose(made.acceleration[2], factor * one.motion.acceleration[2], rtol=1e-12)
    # It comes to rest, and it shakes when the record did: the strong parts overlap by most of the record's.
    assert np.abs(made.dt * made.acceleration[:2].sum(axis=1)).max() < 1e-9
    assert made.name.endswith("spectrum-compatible")
    assert "not a recorded motion" in made.steps[-1]
    assert "no recorded motion" in made.source

    def loudest(motion: Motion) -> float:
        energy = np.cumsum((motion.acceleration[:2] ** 2).sum(axis=0))
        return motion.dt * float(np.searchsorted(energy, 0.5 * energy[-1]))

    assert loudest(made) == pytest.approx(loudest(one.motion), abs=3.0)
    words = ["band=0.5,10", "tolerance=0.1"]
    file, motions, left = synthesise_from(folder, target(tmp_path), words, tmp_path / "out", dry_run=True)
    assert (file, len(motions), left) == (tmp_path / "out" / "manifest.toml", 1, [])
    assert not (tmp_path / "out").exists()
