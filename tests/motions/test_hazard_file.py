"""Hazard curves from CSV files: units, the three ways to say how often, and damaged files."""

from math import exp, log
from pathlib import Path

import pytest

from pipeline.errors import InputError
from pipeline.motions import read_site
from pipeline.motions.hazard_file import read_hazard
from pipeline.motions.manifest import SiteTable, load_manifest, unlisted
from pipeline.motions.synthesis import half_sine_pulse
from pipeline.motions.writing import write_site
from pipeline.quantities import G


def written(folder: Path, text: str) -> Path:
    file = folder / "hazard.csv"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("header", "rows", "measure", "intensity"),
    [
        ("pga_g,annual_rate", ((0.1, 0.01), (0.4, 0.001)), "pga", (0.1 * G, 0.4 * G)),
        ("pga_m_s2,annual_rate", ((1.0, 0.01), (4.0, 0.001)), "pga", (1.0, 4.0)),
        ("pgv_cm_s,return_period_years", ((5.0, 100.0), (40.0, 1000.0)), "pgv", (0.05, 0.4)),
        (
            "pgv_m_s,probability_in_50_years",
            ((0.05, 1 - exp(-50 * 0.01)), (0.4, 1 - exp(-50 * 0.001))),
            "pgv",
            (0.05, 0.4),
        ),
    ],
)
def test_all_ways_to_say_it_mean_the_same(
    tmp_path: Path, header: str, rows: tuple[tuple[float, float], ...], measure: str, intensity: tuple[float, ...]
) -> None:
    lines = ["# a comment, with commas", header, *(f"{x!r} , {y!r}" for x, y in rows), "", " # the end"]
    found = read_hazard(written(tmp_path, "\ufeff" + "\r\n".join(lines)))
    assert found.measure == measure
    assert found.intensity == pytest.approx(intensity)
    assert found.rate == pytest.approx((0.01, 0.001))
    assert found.file == "hazard.csv"


def test_475_years_are_ten_percent_in_fifty(tmp_path: Path) -> None:
    """The codes' own pairs: 10 % and 2 % in 50 years are 475 and 2,475 years (ASCE/SEI 7; Eurocode 8)."""
    found = read_hazard(written(tmp_path, "name,pga_g,probability_in_50_years\na,0.2,0.1\nb,0.4,0.02\n"))
    assert [round(1.0 / rate) for rate in found.rate] == [475, 2475]
    assert found.rate[0] == pytest.approx(-log(0.9) / 50.0)


GOOD = "pga_g,annual_rate\n0.1,0.01\n"


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("", "header"),
        ("# nothing\n", "header"),
        ("a,b\n1,2\n", "header: none of pga_g"),
        ("pga_g,pgv_m_s,annual_rate\n", "header: pga_g, pgv_m_s are there at once"),
        ("pga_g,pga_g,annual_rate\n", "header"),
        ("pga_g,sometimes\n0.1,0.01\n", "header: none of annual_rate"),
        ("pga_g,annual_rate\n", "a curve needs two rows or more, and there is 0"),
        (GOOD, "a curve needs two rows or more, and there is 1"),
        (GOOD + "0.2\n", "row 3: 1 cells"),
        (GOOD + "x,0.001\n", "row 3, pga_g: 'x' is no number"),
        (GOOD + "0.2,often\n", "row 3, annual_rate: 'often' is no number"),
        (GOOD + "nan,0.001\n", "row 3, pga_g"),
        (GOOD + "inf,0.001\n", "row 3, pga_g"),
        (GOOD + "-0.2,0.001\n", "row 3, pga_g"),
        (GOOD + "196,0.001\n", "row 3, pga_g: 196 is not above 0 and up to 10"),
        (GOOD + "0.1,0.001\n", "row 3, pga_g: 0.1 is no more than in the row before"),
        (GOOD + "0.05,0.001\n", "row 3, pga_g"),
        (GOOD + "0.2,0.01\n", "row 3, annual_rate: 0.01: a stronger shaking"),
        (GOOD + "0.2,0.02\n", "row 3, annual_rate"),
        (GOOD + "0.2,0\n", "row 3, annual_rate"),
        (GOOD + "0.2,1e-30\n", "row 3, annual_rate"),
        ("pga_g,probability_in_50_years\n0.1,10\n", "row 2, probability_in_50_years: 10 is not above 0 and up to 1"),
        ("pga_g,probability_in_50_years\n0.1,1\n", "row 2, probability_in_50_years: what is certain"),
        ("pga_g,return_period_years\n0.1,0\n", "row 2, return_period_years"),
        ('pga_g,annual_rate\n"0.1,0.01\n', "CSV"),
    ],
)
def test_damaged_files_are_refused_with_place_and_remedy(tmp_path: Path, text: str, place: str) -> None:
    with pytest.raises(InputError) as refused:
        read_hazard(written(tmp_path, text))
    message = str(refused.value)
    assert message.startswith(f"{tmp_path / 'hazard.csv'}: ")
    assert place in message
    assert ";" in message, "a remedy follows"


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "hazard.csv"
    file.write_bytes(b"pga_g,annual_rate\n\xff\xfe")
    with pytest.raises(InputError, match="UTF-8"):
        read_hazard(file)
    file.write_bytes(b"#" * 40_000_000)
    with pytest.raises(InputError, match="its size"):
        read_hazard(file)


def site(folder: Path, name: str) -> Path:
    motions = [("design", half_sine_pulse(2.0, 0.3).called("pulse"))]
    place = SiteTable(name="Test", latitude=0.0, longitude=0.0)
    manifest = write_site(folder / "site", motions, place, licence="none", why="a test")
    manifest.write_text(manifest.read_text().replace("[site]\n", f'[site]\nhazard = "{name}"\n', 1))
    return manifest


def test_a_site_names_its_hazard_curve(tmp_path: Path) -> None:
    manifest = site(tmp_path, "hazard.csv")
    with pytest.raises(InputError, match=r"site\.hazard: there is no file 'hazard\.csv'"):
        read_site(manifest)
    written(manifest.parent, GOOD + "0.3,0.001\n")
    found = read_site(manifest)
    assert found.hazard is not None
    assert found.hazard.rate == (0.01, 0.001)
    # It is no record that somebody forgot to name.
    assert unlisted(manifest, load_manifest(manifest)) == []


def test_a_hazard_curve_stays_inside_of_the_folder(tmp_path: Path) -> None:
    outside = written(tmp_path, GOOD + "0.3,0.001\n")
    with pytest.raises(InputError, match="hazard"):
        read_site(site(tmp_path / "up", "../hazard.csv"))
    manifest = site(tmp_path / "link", "hazard.csv")
    (manifest.parent / "hazard.csv").symlink_to(outside)
    with pytest.raises(InputError, match="a link out of the site's folder"):
        read_site(manifest)
