"""Fragilities and spacings through the whole night: several levels, one level, places, hostile numbers and texts."""

import csv
from dataclasses import replace
from math import exp
from pathlib import Path

import pytest

from pipeline.analysis.fragility.hazard import EXTENDED, Hazard
from pipeline.collection.database import open_database
from pipeline.motions.hazard_file import read_hazard
from pipeline.motions.manifest import SiteTable
from pipeline.motions.synthesis import half_sine_pulse
from pipeline.motions.writing import write_site
from pipeline.night.run import run
from pipeline.quantities import G
from pipeline.records import Assessment, RunRecord, Verdict
from pipeline.settings import Settings, load_settings
from pipeline.store.runs import load_run
from tests.museum import SILENT, on_the_floor, workspace

EXTRA = """
[columns.position_x_m]
column = "x"
unit = "m"
[columns.position_y_m]
column = "y"
unit = "m"
[columns.orientation_deg]
column = "turned"
[columns.friction]
column = "friction"
[columns.clearance_m]
column = "room"
unit = "m"
"""
HEADER = "object_number,gallery,title,height_m,width_m,depth_m,x,y,turned,friction,room"
ROWS = [
    "1,A,Block,0.4,0.1,0.1,0,0,0,0.1,0.5",
    "2,A,Block,0.1,0.1,0.1,0.15,0,0,0.1,0.5",
    "3,A,Block,0.1,0.1,0.1,0.30,0,0,0.02,0.5",
    "10,A,Block,0.4,0.1,0.1,9,9,0,0.9,0.5",
]
HOSTILE = [
    '"<b>4</b>",A,<script>alert(1)</script>,0.1,0.1,0.1,0.15,0,0,0.1,0.5',  # where 2 stands
    '"=5+5",A,Block,0.1,0.1,0.1,1e9,0,0,0.1,0.5',
    "6,A,Block,0.1,0.1,0.1,nan,inf,0,0.1,0.5",
    "7,A,Block,0.1,0.1,0.1,5,5,1e300,-1,0",
    "8,A,Block,,,,5.05,5,0,0.1,0.5",
    "9,A,Block,0.1,0.1,0.1,-5,-5,0,0,0",
]


def museum(folder: Path, *levels: tuple[str, float | None, tuple[float, ...]], combine: str = "max",
           rows: list[str] | None = None) -> Settings:  # fmt: skip
    """Blocks with places, and a site of half-sine pulses of 0.3 s with these peaks in g, level by level."""
    motions = [
        (name, half_sine_pulse(peak * G, 0.3).called(f"{name} {number}"))
        for name, _, peaks in levels
        for number, peak in enumerate(peaks)
    ]
    site = SiteTable(name="Test", latitude=0.0, longitude=0.0)
    manifest = write_site(folder / "site", motions, site, licence="none", why="a test")
    text = manifest.read_text().replace('combine = "max"', f'combine = "{combine}"')
    for name, years, _ in levels:
        if years is not None:
            text = text.replace(f'name = "{name}"\n', f'name = "{name}"\nreturn_period_years = {years:g}\n', 1)
    manifest.write_text(text)
    workspace(folder, [], site=str(folder / "site"), furnished=True, sampled=True)
    (folder / "export.csv").write_text("\n".join([HEADER, *(rows or ROWS)]) + "\n", encoding="utf-8")
    mapping = folder / "mapping.toml"
    mapping.write_text(mapping.read_text() + EXTRA, encoding="utf-8")
    return on_the_floor(folder)


def record_of(settings: Settings) -> RunRecord:
    run(settings, SILENT)
    return load_run(open_database(settings.database))


def of(record: RunRecord, number: str) -> Assessment:
    return next(a for a in record.assessments if a.scene.item.object_number == number)


def onset(record: RunRecord, number: str) -> float:
    """What lifts an edge of a block, m/s2: g b/h."""
    known = of(record, number).scene.parameters
    return G * known["half_width"].value / known["cg_height"].value


def page(settings: Settings) -> str:
    return "".join(p.read_text(encoding="utf-8") for p in settings.path("reports/latest").glob("*.html"))


def test_two_levels_make_curves_rates_and_spacings(tmp_path: Path) -> None:
    settings = museum(tmp_path, ("often", 100.0, (0.2,)), ("rare", 1000.0, (0.4,)))
    record = record_of(settings)
    first = of(record, "10").fragilities[0]
    assert (first.state, first.bound) == ("harm", "")
    # It is harmed where an edge lifts, on an axis that is known, or a little later: by chance within three errors.
    assert first.error is not None
    assert first.median == pytest.approx(onset(record, "10"), rel=3.0 * first.error)
    assert first.motions == 2
    # The hazard falls by 10 where the shaking doubles: a slope of 3.3, and a rate of failure above that of the median.
    assert first.annual_rate is not None
    assert first.annual_rate > 1.0 / 100.0 * (first.median / (0.2 * G)) ** -3.32
    assert first.median < EXTENDED * 0.4 * G
    chances = first.chances
    assert chances is not None
    assert chances[0] == pytest.approx(1.0 - exp(-50.0 * first.annual_rate))
    pairs = {(s.level, s.first, s.second): s for s in record.spacings}
    assert set(pairs) >= {("often", "1", "2"), ("rare", "1", "2"), ("rare", "2", "3")}
    same = pairs["rare", "1", "2"]
    assert (same.verdict, same.needed) == (Verdict.PASS, 0.0)
    assert same.together > same.gap
    # 3 slides further than 2 under each level, to the west, where 2 stands.
    assert pairs["rare", "2", "3"].needed == pytest.approx(pairs["rare", "2", "3"].radial)
    text = page(settings)
    assert "as likely as not it comes to harm at about" in text
    assert "Within 50 years it comes to harm with a chance of" in text
    assert "The curves of the classes" in text
    assert "Between neighbours" in text
    assert "both moving together" in text
    assert "Room to keep" in text
    assert "objects on a slippery shelf" in text
    with (tmp_path / "reports/latest/objects.csv").open(encoding="utf-8", newline="") as stream:
        row = next(r for r in csv.DictReader(stream) if r["object_number"] == "10")
    assert float(row["median_g"]) == pytest.approx(first.median / G)
    assert float(row["dispersion"]) == pytest.approx(first.dispersion)
    assert float(row["annual_rate"]) == pytest.approx(first.annual_rate)
    assert float(row["chance_50_years"]) == pytest.approx(chances[0])
    assert row["median_is"] == ""
    with (tmp_path / "reports/latest/fragility_classes.csv").open(encoding="utf-8", newline="") as stream:
        classes = {r["object_class"]: r for r in csv.DictReader(stream)}
    told = [a.fragilities[0] for a in record.assessments if a.fragilities]
    assert int(classes[""]["objects"]) == len(told)
    expected = sum(f.chances[0] for f in told if f.chances is not None)
    assert float(classes[""]["expected_harmed_50_years"]) == pytest.approx(expected, abs=1e-5)


@pytest.mark.long("test_two_levels_make_curves_rates_and_spacings")
def test_a_hazard_curve_in_a_file_takes_the_place_of_the_levels(tmp_path: Path) -> None:
    """One level without a return period tells no rate; with a curve beside the manifest the next night has one."""
    settings = museum(tmp_path, ("design", None, (0.3,)))
    before = of(record_of(settings), "10").fragilities[0]
    assert before.annual_rate is None
    manifest = tmp_path / "site" / "manifest.toml"
    manifest.write_text(manifest.read_text().replace("[site]\n", '[site]\nhazard = "hazard.csv"\n', 1))
    rows = "# made up\npga_g,return_period_years\n0.05,20\n0.1,100\n0.5,2000\n1.5,50000\n"
    (tmp_path / "site" / "hazard.csv").write_text(rows)
    after = of(record_of(settings), "10").fragilities[0]
    told = read_hazard(tmp_path / "site" / "hazard.csv")
    assert replace(after, annual_rate=None, rate_low=None, rate_high=None, note=before.note) == before
    assert after.annual_rate == pytest.approx(Hazard.told(told).failures(after.median, after.dispersion))
    # Other rates are another night's work, although the motions are the same.
    (tmp_path / "site" / "hazard.csv").write_text(rows.replace("2000", "1000"))
    assert (of(record_of(settings), "10").fragilities[0].annual_rate or 0.0) > after.annual_rate


def test_without_samples_curves_are_those_of_corners(tmp_path: Path) -> None:
    """Truth: an edge lifts at g b/h, which is interpolated exactly."""
    museum(tmp_path, ("often", 100.0, (0.2,)), ("rare", 1000.0, (0.4,)))
    file = tmp_path / "kouros.toml"
    text = file.read_text()
    assert "samples = 64" in text
    file.write_text(text.replace("samples = 64", "samples = 0"))
    settings = load_settings(file)
    record = record_of(settings)
    first = of(record, "10").fragilities[0]
    assert (first.title, first.state, first.samples) == ("Tipping", "", 0)
    assert first.median == pytest.approx(onset(record, "10"), rel=1e-3)
    text = page(settings)
    assert "fails from about" in text
    assert "From what shaking of its floor on:" in text
    assert "about once in" in text


@pytest.mark.long("test_two_levels_make_curves_rates_and_spacings")
def test_how_a_level_combines_its_motions_leaves_the_curves_alone(tmp_path: Path) -> None:
    """Seven motions: the verdicts of max and mean differ, what single earthquakes do does not."""
    peaks = (0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4)
    most = record_of(museum(tmp_path / "max", ("design", None, peaks)))
    mean = record_of(museum(tmp_path / "mean", ("design", None, peaks), combine="mean"))
    for number in ("1", "2", "3", "10"):
        assert of(most, number).fragilities == of(mean, number).fragilities
    assert of(most, "1").findings != of(mean, "1").findings
    assert [s.together for s in most.spacings] > [s.together for s in mean.spacings]
    assert not of(most, "10").fragilities[0].stated


def test_one_level_without_a_period_says_what_is_missing(tmp_path: Path) -> None:
    settings = museum(tmp_path, ("design", None, (0.3,)))
    record = record_of(settings)
    first = of(record, "1").fragilities[0]
    assert first.annual_rate is None
    assert first.stated
    assert "return periods of two levels or more" in page(settings)
    assert "once in" not in page(settings)


def test_hostile_numbers_and_texts_end_in_a_report(tmp_path: Path) -> None:
    settings = museum(tmp_path, ("often", 100.0, (0.2,)), ("rare", 1000.0, (0.4,)), rows=ROWS + HOSTILE)
    record = record_of(settings)
    notes = {(s.first, s.second): s.note for s in record.spacings if s.level == "rare"}
    assert "mend their places" in notes["2", "<b>4</b>"]
    known = {n for pair in notes for n in pair}
    assert not known & {"=5+5", "6", "8"}  # no place, or nothing to run
    assert of(record, "8").fragilities == ()
    # No room at all, and a friction of 0 that is refused: it fails when it begins to slide, at mu g.
    friction = of(record, "9").scene.parameters["friction_static"].value
    sliding = next(one for one in of(record, "9").fragilities if one.state == "leaves")
    assert sliding.median == pytest.approx(friction * G, rel=3.0 * (sliding.error or 0.0))
    text = page(settings)
    assert "<script>alert" not in text
    assert "<b>4</b>" not in text
    assert "&lt;b&gt;4&lt;/b&gt;" in text
    with (tmp_path / "reports/latest/objects.csv").open(encoding="utf-8", newline="") as stream:
        rows = {r["object_number"]: r for r in csv.DictReader(stream)}
    assert rows["8"]["median_g"] == ""
    assert rows["9"]["median_g"] != ""
    assert "'=5+5" in rows


def test_fragilities_can_be_left_out(tmp_path: Path) -> None:
    settings = museum(tmp_path, ("design", None, (0.3,)))
    file = tmp_path / "kouros.toml"
    file.write_text(file.read_text().replace('fragility = "auto"', "fragility = false"))
    record = record_of(load_settings(file))
    assert all(a.fragilities == () for a in record.assessments)
    assert record.spacings
    assert "From what shaking on" not in page(settings)
