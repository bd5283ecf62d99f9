"""Records of two components: a vertical that is absent or estimated, and never one without saying so."""

import numpy as np
import pytest

from pipeline.motions import MotionError, read_motion, read_site
from pipeline.motions.inspection import inspect
from pipeline.motions.record import ESTIMATED, NO_VERTICAL
from pipeline.motions.vertical import ratio, with_vertical
from pipeline.night.prepare import _level_note
from pipeline.records import Motion
from pipeline.report.pages.record_words import processing

from .conftest import DT, tone

TWO = {"e.mseed": {"axis": "x", "orientation": 90}, "n.mseed": {"axis": "y", "orientation": 0}}


def two(three, write_manifest, vertical, **changes):
    three()
    return write_manifest(files=list(TWO), components=TWO, vertical=vertical, **changes)


@pytest.mark.parametrize(
    ("period", "expected"),
    [
        (0.0, 0.90),
        (0.05, 0.90 * 3.0 / (1.0 + 0.05 / 0.15 * 1.5)),
        (0.15, 0.90 * 3.0 / 2.5),
        (0.40, 0.90 * 3.0 * (0.15 / 0.40) / 2.5),
        (1.0, 0.90 * 3.0 * 0.15 / (2.5 * 0.40)),
        (2.0, 0.90 * 3.0 * 0.15 * 1.0 / 4.0 / (2.5 * 0.40 / 2.0)),
        (20.0, 0.90 * 3.0 * 0.15 * 1.0 / 4.0 / (2.5 * 0.40 / 2.0)),
    ],
)
def test_the_ratio_is_that_of_en_1998(period, expected):
    """Its equations 3.2 to 3.5 and 3.8 to 3.11 by hand, type 1, ground A."""
    assert ratio(np.array(period)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("frequency", [0.5, 2.0, 10.0])
def test_a_tone_is_multiplied_by_the_ratio_at_its_period(frequency):
    """In a wide envelope a tone is one frequency: nothing but the ratio there can come out, in phase."""
    a = np.zeros((3, 12000))
    a[0], a[1] = 0.3 * tone(12000, frequency=frequency), tone(12000, frequency=frequency)
    made = with_vertical(Motion(DT, a), "xyz")
    np.testing.assert_allclose(made.acceleration[2], ratio(np.array(1.0 / frequency)) * a[1], atol=0.01)
    assert "vertical estimated from y" in made.steps[-1]


def test_the_vertical_starts_with_what_the_filter_did_before():
    """The velocity is continuous: begun in the padding, it ends where the whole, padded history ends."""
    a = np.zeros((3, 4000))
    a[0] = np.concatenate([tone(2000), np.zeros(2000)])
    made = with_vertical(Motion(DT, a, start=(0.5, 0.0, 0.0)), "xyz")
    # Of the start of the horizontal, the ratio at long periods; of the filter's lead, next to nothing for a tone.
    assert made.start[2] == pytest.approx(0.5 * ratio(np.array(4.0)), abs=0.02)
    assert made.start[:2] == (0.5, 0.0)


def test_an_absent_vertical_is_told(three, write_manifest, monkeypatch):
    monkeypatch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 2)
    folder = two(three, write_manifest, "absent")
    (motion,) = read_motion(folder)
    assert not motion.acceleration[2].any()
    assert NO_VERTICAL in motion.steps
    assert "No vertical component was recorded: the motion has none." in processing(inspect(folder)[0])


def test_an_estimated_vertical_is_told_wherever_it_is_used(three, write_manifest, monkeypatch):
    monkeypatch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 2)
    folder = two(three, write_manifest, "estimated")
    (motion,) = read_motion(folder)
    assert motion.acceleration[2].any()
    assert ESTIMATED in motion.steps
    assert any("EN 1998-1:2004" in step and "judgement" in step and "n.mseed" in step for step in motion.steps)
    assert "the motion's is an estimate from the horizontals" in processing(inspect(folder)[0])
    (level,) = read_site(folder).levels
    assert "an estimate is assumed: hand-made" in _level_note(level)


def test_a_scale_counts_for_the_estimate_as_well(three, write_manifest):
    (plain,) = read_motion(two(three, write_manifest, "estimated"))
    (twice,) = read_motion(two(three, write_manifest, "estimated", scale=2.0))
    np.testing.assert_allclose(twice.acceleration, 2.0 * plain.acceleration, rtol=1e-12)


def test_what_is_said_of_the_vertical_fits_the_components(three, write_manifest):
    three()
    with pytest.raises(
        MotionError, match=r'vertical = "absent" where no vertical was recorded \("estimated": make one\)'
    ):
        read_motion(write_manifest(files=list(TWO), components=TWO))
    with pytest.raises(MotionError, match='with vertical = "absent" they are x and y'):
        read_motion(write_manifest(vertical="absent"))
    (motion,) = read_motion(write_manifest(vertical="estimated"))
    # A vertical that is there, as one that was estimated and written, is taken as it is, and said to be an estimate.
    assert np.array_equal(motion.acceleration[2], tone(amplitude=0.5))
    assert ESTIMATED in motion.steps
