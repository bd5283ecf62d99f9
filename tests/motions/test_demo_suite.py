"""The demonstration's suite: what its README says of it, found anew from its files."""

from __future__ import annotations

import csv
import re

import numpy as np
import pytest

from pipeline.motions import Site, read_site
from pipeline.motions.spectra import response_spectra
from pipeline.quantities import G
from pipeline.resources import resource

FOLDER = resource("site_motions", "demo_suite")
PERIODS = np.geomspace(0.1, 2.0, 60)


@pytest.fixture(scope="module")
def suite() -> Site:
    return read_site(FOLDER)


def elastic(periods: np.ndarray) -> np.ndarray:
    """EN 1998-1:2004, (3.2) to (3.5): a_g 0.25 g, type 1, ground type B, 5 % damping; g."""
    ag, s, tb, tc, td = 0.25, 1.2, 0.15, 0.5, 2.0
    falling = np.where(periods <= td, tc / periods, tc * td / periods**2)
    shape = np.where(periods < tb, 1.0 + 1.5 * periods / tb, np.where(periods <= tc, 2.5, 2.5 * falling))
    return ag * s * shape


def test_the_target_is_the_codes_formula() -> None:
    with (FOLDER / "target.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    periods = np.array([float(row["period_s"]) for row in rows])
    # Five digits are printed.
    np.testing.assert_allclose([float(row["sa_g"]) for row in rows], elastic(periods), rtol=5e-5)


def test_eleven_motions_of_one_level_have_its_mean(suite: Site) -> None:
    (level,) = suite.levels
    assert len(level.motions) >= 11
    assert (level.combine, level.return_period_years, level.caution) == ("mean", 475.0, "")
    spectra = []
    for one in level.motions:
        assert one.motion.acceleration.any(axis=1).all()
        assert one.licence
        spectra.append(response_spectra(one.motion, PERIODS, 0.05, ("rotd50",))["rotd50"].pseudo_acceleration[0] / G)
    logs = np.log(spectra)
    off = np.exp(logs.mean(axis=0)) / elastic(PERIODS) - 1.0
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    (said,) = re.findall(r"RotD50 spectra is within (\d+\.\d) %", readme)
    # 40 periods were compared, and 60 are here: between them it is off by no more than a tenth of the limit.
    assert np.abs(off).max() < 0.10
    assert 100 * np.abs(off).max() == pytest.approx(float(said), abs=1.0)
    low, high = (float(v) for v in re.findall(r"logarithm is (\d\.\d\d) to (\d\.\d\d)", readme)[0])
    spread = logs.std(axis=0, ddof=1)
    assert (spread.min(), spread.max()) == pytest.approx((low, high), abs=0.02)


def test_each_motion_is_named_for_what_it_is(suite: Site) -> None:
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    rows = {
        name: (float(a), float(v)) for name, a, v in re.findall(r"^\| (.+?) \| ([\d.]+) \| ([\d.]+) \|$", readme, re.M)
    }
    (level,) = suite.manifest.level
    (motions,) = (one.motions for one in suite.levels)
    assert rows.keys() == {record.name for record in level.record}
    for record, one in zip(level.record, motions, strict=True):
        made = record.files[0].startswith("2-matched/")
        assert made == record.name.endswith(", spectrum-compatible") == ("no recorded motion" in record.source)
        pga, pgv = rows[record.name]
        assert one.measures["pga"] / G == pytest.approx(pga, abs=6e-4)
        assert 100 * one.measures["pgv"] == pytest.approx(pgv, abs=0.06)
    assert sum(file.stat().st_size for file in FOLDER.rglob("*") if file.is_file()) < 3_000_000
