"""What is outside of what earthquakes do asks a person: size, shape against unit, what a processed record leaves."""

import numpy as np
import pytest

from pipeline.motions import MotionError, read_motion
from pipeline.motions.doubts import doubts
from pipeline.motions.intensity import measures
from pipeline.motions.plausibility import doubt_motion, mean_period, quick
from pipeline.quantities import G
from pipeline.records import Motion

from .conftest import DT, tone


def asked(folder, judgement, *words):
    with pytest.raises(MotionError) as caught:
        read_motion(folder)
    assert caught.value.judgement == judgement
    for word in (*words, f"accept.{judgement}"):
        assert word in str(caught.value)


@pytest.mark.parametrize(("peak", "units", "told"), [(0.00055, "g", "0.00055 g"), (4.9, "g", "4.9 g")])
def test_a_wrong_unit_is_asked_about(three, write_manifest, peak, units, told):
    """0.55 g taken for 0.00055, and 4.9 gal called g: a tone of 1 Hz peaks at its amplitude within its sampling."""
    three(*(peak * share * tone() / np.abs(tone()).max() for share in (1.0, 0.5, 0.25)))
    asked(write_manifest(units=units), "size", told, "outside of 0.002 to 3 g")


def test_a_small_record_is_accepted_for_a_reason(three, write_manifest):
    three(*(0.001 * a * tone() for a in (1.0, 2.0, 0.5)))
    (motion,) = read_motion(write_manifest(accept={"size": "an aftershock of magnitude 3"}))
    assert any("accepted: an aftershock of magnitude 3" in step for step in motion.steps)


def test_what_is_scaled_is_judged_as_it_was_recorded(three, write_manifest):
    """A weak record scaled up is still a weak record; a common one scaled to 3.5 g is the engineer's own wish."""
    three(*(0.001 * a * tone() for a in (1.0, 2.0, 0.5)))
    asked(write_manifest(scale_to_pga_g=0.4), "size", "0.000204 g")
    three()
    (motion,) = read_motion(write_manifest(scale_to_pga_g=3.5))
    assert measures(motion)["pga"] == pytest.approx(3.5 * G, rel=1e-9)


def test_a_velocity_called_acceleration_is_asked_about(three, write_manifest):
    """A tone of 4 s as acceleration: its PGV over its PGA is 4 / (2 pi) = 0.64 s, its mean period 4 s."""
    three(*(a * tone(frequency=0.25) for a in (1.0, 2.0, 0.5)))
    asked(write_manifest(), "size", "velocity or displacement called acceleration")


def test_the_mean_period_of_a_tone_is_its_period():
    rows = [tone(8000, a, 0.5) for a in (1.0, 2.0, 0.5)]
    assert mean_period(Motion(DT, rows)) == pytest.approx(2.0, rel=0.01)


def test_a_raw_record_called_processed_is_asked_about(three, write_manifest):
    """An offset of 0.02 m/s2 over 40 s is 0.8 m/s at the end, several times the PGV of the tone."""
    three(*(a * tone() + 0.02 for a in (1.0, 2.0, 0.5)))
    asked(write_manifest(), "drift", "is called processed", "processed = false")


def test_gravity_in_a_vertical_called_processed_is_asked_about(three, write_manifest):
    """As loggers and telephones write it."""
    three(z=0.5 * tone() + G)
    asked(write_manifest(), "drift", "the mean of its vertical is 1 g", "processed = false")


def test_a_processed_displacement_beyond_any_fault_is_asked_about():
    """A velocity of 1 m/s for 30 s and back is 30 m; with its end at rest the velocity alone says nothing."""
    v = np.interp(np.arange(6000) * DT, [0, 10, 15, 40, 45, 60], [0, 0, 1, 1, 0, 0])
    row = np.gradient(v, DT)
    doubt = doubt_motion(Motion(DT, [row, row, row]), velocity=None, processed=True)
    assert doubt is not None
    assert doubt.judgement == "drift"
    assert "displacement reaches 30 m" in doubt.wrong


def test_the_end_is_looked_at_before_the_filter(three, write_manifest):
    """A raw record that ends amid its shaking is refused for that, whatever corner it would have needed."""
    three(*(a * tone()[:2000] for a in (1.0, 2.0, 0.5)))
    asked(write_manifest(processed=False), "cut_off", "ends during strong shaking")


@pytest.mark.parametrize(("frequency", "doubted"), [(8.0, False), (10.0, False), (11.5, True), (16.0, True)])
def test_a_time_step_ten_times_too_small_is_doubted(frequency, doubted):
    """A tone has a PGV of its PGA over its circular frequency: 0.0199, 0.0159, 0.0138 and 0.0099 s."""
    t = 0.001 * np.arange(20000)
    row = np.cos(2.0 * np.pi * frequency * t) * np.sin(np.pi * t / t[-1]) ** 2
    said = quick(Motion(0.001, [row, 0.5 * row, 0.3 * row]))
    assert (said is not None) == doubted
    assert said is None or float(said.split()[6]) == pytest.approx(1.0 / (2.0 * np.pi * frequency), rel=0.005)
    assert said is None or doubts([said]) == (said,)
