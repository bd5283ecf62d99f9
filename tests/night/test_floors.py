"""Galleries on floors, and levels of several motions, from the settings to the stored verdicts."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.collection.database import open_database
from pipeline.motions.manifest import SiteTable
from pipeline.motions.synthesis import half_sine_pulse
from pipeline.motions.writing import write_site
from pipeline.night.run import Selection, run
from pipeline.quantities import G
from pipeline.records import Motion, RunRecord
from pipeline.settings import Settings, SettingsError, load_settings
from pipeline.store.runs import load_run
from pipeline.tools.doctor import diagnose
from tests.museum import SILENT, on_the_floor, own_site, workspace
from tests.night.changing import leave_out_pages

BASE = "".join(f'[columns.base_{side}_m]\ncolumn = "{side}_m"\nunit = "m"\n' for side in ("width", "depth"))
"""What it stands on is as wide as it is."""

SITE = SiteTable(name="Test", latitude=0.0, longitude=0.0)


@pytest.fixture(autouse=True)
def without_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out what costs most of a small night, and is looked at elsewhere."""
    leave_out_pages(monkeypatch)


def pulses(folder: Path, *peaks: float, combine: str = "max", floors: str = "") -> Path:
    """A site of one level whose motions are half-sine pulses of 0.5 s with these peaks in g."""
    motions = [half_sine_pulse(peak * G, 0.5).called(f"pulse {number}") for number, peak in enumerate(peaks)]
    file = write_site(folder, [("design", m) for m in motions], SITE, licence="none", why="a test")
    file.write_text(file.read_text().replace('combine = "max"', f'combine = "{combine}"') + floors)
    return folder


def museum(folder: Path, site: Path, floors: str = "") -> Settings:
    """Two equal blocks, 0.1 by 0.1 by 0.4 m, in galleries A and B."""
    workspace(folder, ["1,A,Block,0.4,0.1,0.1", "2,B,Block,0.4,0.1,0.1"], site=str(site))
    file = folder / "kouros.toml"
    file.write_text(file.read_text().replace("[analysis]", f"{floors}\n[analysis]").replace("[floors]\n#", "#"))
    return on_the_floor(folder)


def record_of(settings: Settings) -> RunRecord:
    run(settings, SILENT)
    return load_run(open_database(settings.database))


def demand(record: RunRecord, number: str, model: str = "standing") -> float:
    (found,) = [f for a in record.assessments for f in a.findings if (f.object_number, f.model) == (number, model)]
    assert found.demand is not None
    return found.demand


def slope(record: RunRecord) -> float:
    """The blocks' b/h, which is the acceleration in g that lifts an edge."""
    known = record.assessments[0].scene.parameters
    return known["half_width"].value / known["cg_height"].value


def test_a_gallery_upstairs_is_shaken_as_its_floor(tmp_path: Path) -> None:
    """ASCE 7-22 at z/h 0.5 with an unknown period: 2.25 times the ground."""
    site = pulses(tmp_path / "site", 0.1, floors='\n[[floor]]\nname = "2"\nheight_ratio = 0.5\n')
    record = record_of(museum(tmp_path, site, '[floors]\n"2" = ["B"]'))
    # Half a millisecond from a sample to the crest of a half-sine of 0.5 s is 1e-5 of it.
    assert demand(record, "1") == pytest.approx(0.1 / slope(record), rel=1e-4)
    assert demand(record, "2") == pytest.approx(0.225 / slope(record), rel=1e-4)
    assert [(a.scene.item.object_number, a.scene.floor) for a in record.assessments] == [("1", ""), ("2", "2")]
    assert [(m.name, m.floor) for m in record.motions] == [("pulse 0", ""), ("pulse 0, floor 2", "2")]
    said = " ".join(record.level_notes)
    assert "Floor 2 (floor factor, 0.5 of the building's height, unknown period, ASCE 7-22): B." in said
    assert "On the ground: A." in said


def test_the_rest_of_the_galleries(tmp_path: Path) -> None:
    site = pulses(tmp_path / "site", 0.1, floors='\n[[floor]]\nname = "2"\nheight_ratio = 0.5\n')
    record = record_of(museum(tmp_path, site, '[floors]\n"2" = ["*"]\n"ground" = ["A"]'))
    assert [a.scene.floor for a in record.assessments] == ["", "2"]


@pytest.mark.parametrize(
    ("floors", "said"),
    [
        ('"3" = ["B"]', "floors.'3': .* has no such floor; it has ground, 2"),
        ('"2" = ["B"]\n"ground" = ["B"]', "gallery 'B' is on two floors"),
        ('"2" = "B"', "floors"),
    ],
)
def test_floors_that_cannot_be_meant(tmp_path: Path, floors: str, said: str) -> None:
    site = pulses(tmp_path / "site", 0.1, floors='\n[[floor]]\nname = "2"\nheight_ratio = 0.5\n')
    with pytest.raises(SettingsError, match=said):
        run(museum(tmp_path, site, f"[floors]\n{floors}"), SILENT)


def test_a_gallery_that_is_not_there_is_said(tmp_path: Path) -> None:
    """A gallery that was renamed must not come down to the ground in silence; a run of a part says nothing false."""
    site = pulses(tmp_path / "site", 0.1, floors='\n[[floor]]\nname = "2"\nheight_ratio = 0.5\n')
    settings = museum(tmp_path, site, '[floors]\n"2" = ["Bb"]')
    record = record_of(settings)
    assert any("puts gallery 'Bb' on floor '2': the inventory has no such gallery" in n for n in record.level_notes)
    (inventory,) = [d for d in diagnose(tmp_path / "kouros.toml") if d.what == "inventory"]
    assert inventory.state == "warning"
    assert "no such gallery" in inventory.message
    file = tmp_path / "kouros.toml"
    file.write_text(file.read_text().replace('["Bb"]', '["B"]'))
    part = run(load_settings(file), SILENT, Selection(galleries=("A",)))
    notes = load_run(open_database(settings.database), part.run_id).level_notes
    assert not any("no such gallery" in note for note in notes)


def test_the_mean_of_a_level_decides(tmp_path: Path) -> None:
    """Seven pulses of 0.05 to 0.2 g, less than friction: the largest is 0.2 g, their mean is 0.125 g."""
    peaks = [0.05, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2]
    worst = record_of(museum(tmp_path, pulses(tmp_path / "max", *peaks)))
    assert demand(worst, "1") == pytest.approx(0.2 / slope(worst), rel=1e-4)
    mean = record_of(museum(tmp_path, pulses(tmp_path / "mean", *peaks, combine="mean")))
    assert demand(mean, "1") == pytest.approx(0.125 / slope(mean), rel=1e-4)
    # PGV: a half-sine of 0.5 s carries 2 / pi of its peak over that time, 31.2 cm/s for 0.1 g.
    (note,) = [note for note in mean.level_notes if "the mean of 7 motions" in note]
    assert "PGA 0.05 g to 0.2 g, PGV 15.6 cm/s to 62.4 cm/s" in note
    (finding,) = [f for f in mean.assessments[0].findings if f.model == "standing"]
    assert finding.motion == "pulse 6"  # the one that governs is named all the same


@pytest.mark.long("test_the_mean_of_a_level_decides")
def test_an_object_overturns_when_half_of_the_motions_overturn_it(tmp_path: Path) -> None:
    """An object for which rocking itself is no damage: three of eight pulses throw it over, then four of eight."""
    settings = museum(tmp_path, pulses(tmp_path / "few", *[0.1] * 5, *[1.5] * 3, combine="mean"))
    # The export has no such column: the museum's own sheet would.
    text = (tmp_path / "mapping.toml").read_text()
    (tmp_path / "mapping.toml").write_text(f'{text}[columns.susceptible]\ncolumn = "susceptible"\n{BASE}')
    rows = ["object_number,gallery,title,height_m,width_m,depth_m,susceptible", "1,A,Block,0.4,0.08,0.08,no"]
    (tmp_path / "export.csv").write_text("\n".join(rows) + "\n")
    few = record_of(settings)
    (found,) = [f for f in few.assessments[0].findings if f.model == "standing"]
    assert (found.demand_name, found.demand, found.verdict) == ("overturned", 3 / 8, "pass")
    half = record_of(
        load_settings(tmp_path / "kouros.toml").model_copy(
            update={"site": settings.site.model_copy(update={"folder": str(_half(tmp_path))})}
        )
    )
    (found,) = [f for f in half.assessments[0].findings if f.model == "standing"]
    assert found.demand == 4 / 8
    assert found.verdict == "fail"


def _half(folder: Path) -> Path:
    return pulses(folder / "half", *[0.1] * 4, *[1.5] * 4, combine="mean")


def test_the_doctor_reads_every_floor(tmp_path: Path) -> None:
    site = own_site(tmp_path)
    manifest = site / "manifest.toml"
    manifest.write_text(manifest.read_text() + '\n[[floor]]\nname = "2"\nheight_ratio = 0.5\n')
    workspace(tmp_path, site="site")
    (motions,) = [d for d in diagnose(tmp_path / "kouros.toml") if d.what == "motions"]
    assert "floor 2" in motions.message


def test_written_motions_come_back_bit_for_bit(tmp_path: Path) -> None:
    from pipeline.motions import read_motion

    numbers = np.random.default_rng(3).normal(size=(3, 4000)) * np.sin(np.pi * np.arange(4000) / 3999) ** 8
    motion = Motion(1 / 128, numbers, "noise", source="us; licence: free")
    (again,) = read_motion(write_site(tmp_path / "s", [("a", motion)], SITE, licence="?", why="a test"))
    assert again.hash == motion.hash
    assert again.source == "us; licence: free"
