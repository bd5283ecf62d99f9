"""What hangs on the corner: closed forms of tones, the same record processed anew, and agencies' own versions."""

from itertools import product

import numpy as np
import pytest

from pipeline.errors import InputError
from pipeline.motions import read_motion, read_site
from pipeline.motions.corner_range import CornerRange, corner_range, corner_range_of
from pipeline.motions.intensity import measures
from pipeline.motions.site import with_corner
from pipeline.resources import resource
from tests.motions.formats.conftest import agency_file
from tests.motions.test_raw_to_agency import agency, site
from tests.soak import some

__all__ = ["agency", "agency_file", "site"]

DT = 0.01

LONG = pytest.mark.long("test_the_range_is_that_of_the_record_processed_at_other_corners")


def test_a_tone_at_the_corner_has_the_filters_gain():
    """Of two poles forwards and backwards: 1 / (1 + (fc/f)^4), which is 16/17, 1/2 and 1/17."""
    t = np.arange(20_000) * DT
    tone = np.sin(2 * np.pi * 0.2 * t) * np.sin(np.pi * t / t[-1]) ** 2
    found = corner_range(np.stack([tone, 0.0 * t, 0.0 * t]), DT, 0.2, slice(None))
    v, u = 1.0 / (2 * np.pi * 0.2), 1.0 / (2 * np.pi * 0.2) ** 2
    assert found.highpass_hz == (0.1, 0.4)
    assert found.pgv == pytest.approx((v / 17, v * 16 / 17), rel=0.01)
    # The filter answers before the record begins: of the displacement that is left out, which begins at its start.
    assert found.pgd == pytest.approx((u / 17, u * 16 / 17), rel=0.02)
    far = corner_range(np.stack([np.sin(2 * np.pi * 5.0 * t) * np.sin(np.pi * t / t[-1]) ** 2, 0 * t, 0 * t]), DT, 0.02,
                       slice(None))  # fmt: skip
    assert far.pgv[1] == pytest.approx(far.pgv[0], rel=1e-4)
    assert corner_range(np.zeros((3, 2000)), DT, 30.0, slice(None)) is None


def test_what_is_written_is_read():
    one = CornerRange((0.05, 0.2), (0.4, 0.5), (0.1, 0.3))
    assert corner_range_of(("read", one.scaled(1.0), "rotated")) == one
    assert corner_range_of((one.scaled(-2.0),)).pgv == (0.8, 1.0)
    assert corner_range_of(("high-pass 0.1 Hz",)) is None


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        pytest.param(*case, marks=LONG if at else [])
        for at, case in enumerate(
            some(
                product(
                    ["weitchpec", "redwood"],
                    [{}, {"window_s": [5.0, 30.0], "accept": {"cut_off": "a test"}}, {"scale": 2.5}],
                ),
                3,
            )
        )
    ],
)
def test_the_range_is_that_of_the_record_processed_at_other_corners(site, name, changes):
    file = site(name, highpass_hz=0.15, **changes)
    told = corner_range_of(read_motion(file)[0].steps)
    whole = read_site(file)
    peaks = []
    for factor in (0.5, 1.0, 2.0):
        other = with_corner(whole, factor)
        assert other.manifest.level[0].record[0].highpass_hz == pytest.approx(0.15 * factor)
        peaks.append(other.levels[0].motions[0].measures)
    assert with_corner(whole, 1.0).levels[0].motions[0].motion.hash == whole.levels[0].motions[0].motion.hash
    for stem, (low, high) in {"pgv": told.pgv, "pgd": told.pgd}.items():
        found = [one[f"{stem}_resultant"] for one in peaks]
        # Peaks between samples are seen by the measures alone.
        assert (low, high) == pytest.approx((min(found), max(found)), rel=3e-3)


@pytest.mark.parametrize("name", ["weitchpec", "redwood"])
def test_the_agencys_own_peak_lies_within(site, agency, name):
    """The larger horizontal PGV of the processed file, over the larger one of this motion, times the range: 5 %."""
    _, _, pgv = agency(name)
    (motion,) = read_motion(site(name))
    told = corner_range_of(motion.steps)
    own = measures(motion)
    most = max(value for towards, value in pgv.items() if towards != "up")
    assert 0.95 * told.pgv[0] <= most * own["pgv_resultant"] / own["pgv"] <= 1.05 * told.pgv[1]


def test_a_processed_record_has_no_other_corner(demo_suite):
    assert corner_range_of(demo_suite["Coalinga"].steps) is None


@pytest.fixture
def demo_suite():
    return {one.name.split(" ")[0]: one for one in read_motion(resource("site_motions", "demo_suite"))}


def test_a_site_whose_records_were_not_filtered_has_no_corner_to_change(tmp_path, site):
    whole = read_site(site("redwood", highpass_hz="none", accept={"size": "a test", "drift": "a test"}))
    with pytest.raises(InputError, match="no record of the ground is filtered here"):
        with_corner(whole, 0.5)
    with pytest.raises(InputError, match="above 0, not -1"):
        with_corner(whole, -1.0)
