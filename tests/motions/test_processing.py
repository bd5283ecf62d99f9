"""Processing against what a filter must do to a tone, an offset and a drift, and rotation against geometry."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from pipeline.motions import read_motion
from pipeline.motions.filtering import highpass, lowpass, pad_seconds, remove_baseline
from pipeline.motions.intensity import integrate
from pipeline.motions.processing import cut, rotate, starting_velocity
from pipeline.records import Motion

from .conftest import DT, tone


def test_pad_is_boore_2005():
    """1.5 n / fc: 60 s for four poles at 0.1 Hz."""
    assert pad_seconds(0.1) == pytest.approx(60.0)


def test_highpass_leaves_a_one_hertz_tone_alone():
    """Two passes of two poles: the gain at f is 1/(1 + (fc/f)^4), that is 1e-4 below one at 10 fc."""
    a = np.stack([tone(8000), np.zeros(8000), tone(8000, 0.3)])
    out, step, _ = highpass(a, DT, 0.1)
    assert np.abs(out - a).max() < 5e-4
    assert np.abs(out[1]).max() == 0.0
    assert "high-pass 0.1 Hz" in step
    assert "60 s" in step


def test_highpass_gain_at_the_corner_is_one_half():
    """-3 dB a pass: 1/2 after both; read off the middle of a long tone, where the ends have died away."""
    t = np.arange(40000) * DT
    out, _, _ = highpass(np.sin(2 * np.pi * 0.1 * t)[None, :], DT, 0.1)
    middle = slice(15000, 25000)
    assert np.abs(out[0, middle]).max() == pytest.approx(0.5, rel=1e-3)
    # Zero phase: the tone still crosses zero where it did.
    assert np.abs(out[0, 20000]) < 1e-3


def test_lowpass_removes_a_fast_tone_and_keeps_a_slow_one():
    slow, fast = tone(8000, frequency=1.0), tone(8000, frequency=40.0)
    out, _ = lowpass(np.stack([slow + fast]), DT, 10.0)
    # The bilinear filter is at least as steep as its analogue: (10/40)^4 = 0.4 % is left.
    assert np.abs(out[0] - slow).max() < 5e-3


def test_baseline_and_highpass_remove_offset_and_drift():
    n = 12000
    t = np.arange(n) * DT
    clean = tone(n)
    dirty = clean + 0.4 + 0.003 * t
    line, step = remove_baseline(np.stack([dirty, dirty, dirty]), DT)
    # The tone is itself nearly free of a mean and a slope: the line found is the one put in, to 1e-3.
    assert np.abs(line[0] - clean).max() < 1e-3
    assert "m/s3" in step
    # A slow wave, which no straight line is, goes with the high-pass: (0.01/0.1)^4 is left, and the ends' transients.
    wave = 0.2 * np.sin(np.pi * t / t[-1]) ** 2 * np.cos(2 * np.pi * 0.01 * t)
    out, _, _ = highpass((clean + wave)[None, :], DT, 0.1)
    assert np.abs(out[0] - clean).max() < 0.005


def test_baseline_of_a_line_is_nothing():
    t = np.arange(1000) * DT
    out, _ = remove_baseline(np.stack([1 + 2 * t, 3 - t, 0 * t]), DT)
    assert np.abs(out).max() < 1e-11


@pytest.mark.parametrize("corner", [50.0, 60.0])
def test_a_corner_above_nyquist_is_refused(corner):
    with pytest.raises(ValueError, match=r"lowpass_hz .* Nyquist"):
        lowpass(np.zeros((3, 100)), DT, corner)


@pytest.mark.parametrize(
    ("first", "second"), [(90, 0), (0, 90), (30, 120), (120, 30), (270, 180), (350, 80), (360, 90)]
)
def test_rotation_finds_east_and_north(first, second):
    rng = np.random.default_rng(1)
    east, north, up = rng.normal(size=(3, 50))

    def seen(azimuth):
        return east * np.sin(np.radians(azimuth)) + north * np.cos(np.radians(azimuth))

    out, _ = rotate(np.stack([seen(first), seen(second), up]), first, second)
    np.testing.assert_allclose(out, [east, north, up], atol=1e-14)


def test_rotation_by_right_angles_keeps_silence():
    out, _ = rotate(np.stack([np.zeros(5), np.ones(5), np.zeros(5)]), 180.0, 270.0)
    assert np.array_equal(out[0], -np.ones(5))
    assert not out[1].any()


def test_a_small_skew_is_undone():
    """Channels at 0 and 91 degrees of a motion due north: the second sees cos(91 deg) of it, and east is silent."""
    north = tone()
    out, _ = rotate(np.stack([north, np.cos(np.radians(91.0)) * north, north]), 0.0, 91.0)
    np.testing.assert_allclose(out[0], 0.0, atol=1e-14)
    np.testing.assert_allclose(out[1], north, atol=1e-14)


def test_channels_that_are_not_orthogonal_are_refused():
    with pytest.raises(ValueError, match="off a right angle"):
        rotate(np.zeros((3, 5)), 0.0, 45.0)


def test_cut_says_what_velocity_is_left():
    out, step = cut(np.ones((3, 1001)), DT, 1.0, 3.0)
    assert out.shape == (3, 201)
    assert "x 2, y 2, z 2" in step


@pytest.mark.parametrize(
    ("start", "end", "message"), [(0.0, 11.0, "after the record's end"), (1.0, 1.001, "fewer than")]
)
def test_bad_windows(start, end, message):
    with pytest.raises(ValueError, match=message):
        cut(np.zeros((3, 1001)), DT, start, end)


def its_velocity(start):
    """Half a minute of a tone in an envelope, its velocity from a start, and a time step."""
    a = np.stack([tone(3000, 2.0), tone(3000, 1.0, 2.0), tone(3000, 0.5, 3.0)])
    return a, integrate(Motion(DT, a, start=start))[0]


def test_the_velocity_at_the_start_is_the_first_one_of_the_files():
    start = np.array([0.02, -0.01, 0.0])
    a, velocity = its_velocity(start)
    found, said = starting_velocity(a, velocity, DT)
    assert found.tolist() == velocity[:, 0].tolist() == start.tolist()
    assert said == ()


def test_a_transient_in_the_first_velocity_is_not_what_a_record_starts_with():
    """A filter's ringing over the first 0.3 s: by the first sample alone, 30 s would add 0.6 m to the displacement."""
    start = np.array([0.001, 0.0, 0.0])
    a, velocity = its_velocity(start)
    velocity = velocity + 0.02 * np.exp(-np.arange(3000) * DT / 0.1)
    found, said = starting_velocity(a, velocity, DT)
    # The mean of the transient over the record: 0.02 m/s times 0.1 s / 30 s.
    assert found == pytest.approx(start + 0.02 * 0.1 / 30.0, abs=4e-6)
    assert [told[:1] for told in said] == ["x", "y", "z"]
    assert "starts at 0.0011 m/s, by all of the velocity of its files; their first sample is 0.021 m/s" in said[0]


def test_a_velocity_that_is_not_the_integral_of_its_acceleration_is_told():
    a, velocity = its_velocity(np.zeros(3))
    peak = np.abs(velocity[0]).max()
    velocity[0] += 0.2 * peak * np.linspace(0.0, 1.0, 3000)
    found, said = starting_velocity(a, velocity, DT)
    assert found.tolist() == [0.0, 0.0, 0.0]
    (told,) = said
    assert told.startswith(f"x: its acceleration drifts against the velocity of its files, by {0.2 * peak:.2g} m/s")


def test_the_displacement_of_coalinga_1983_is_the_printed_one(tmp_path):
    """CE36456, of which CSMIP prints 5.449, 8.911 and 3.820 cm (90, 360, up), and 28.253, 34.298 and 11.377 cm/s."""
    packed = Path(__file__).parents[1] / "data" / "motions" / "ce36456p_CE36456.V2.gz"
    (tmp_path / "CE36456.V2").write_bytes(gzip.decompress(packed.read_bytes()))
    (motion,) = read_motion(tmp_path / "CE36456.V2")
    velocity, displacement = integrate(motion)
    assert np.abs(velocity).max(axis=1) == pytest.approx([0.28253, 0.34298, 0.11377], rel=0.015)
    assert np.abs(displacement).max(axis=1) == pytest.approx([0.05449, 0.08911, 0.0382], rel=0.15)
