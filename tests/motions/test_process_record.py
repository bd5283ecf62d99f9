"""What a manifest asks of a record is what is done to it: baselines, corners, axes, targets, acceptance."""

import numpy as np
import pytest

from pipeline.motions import MotionError, load_manifest, read_motion, read_site
from pipeline.motions.doubts import doubts
from pipeline.motions.intensity import integrate, measures
from pipeline.motions.site import prepare
from pipeline.motions.spectra import psa
from pipeline.quantities import G

from .conftest import DT, tone

N = 12000
DRIFTS = {"size": "its drift is what is looked at"}
DRIFT = 0.02 + 1e-4 * np.arange(N) * DT


def raw(write_manifest, **changes):
    return write_manifest(processed=False, **changes)


def processed(folder):
    """The manifest's one record, processed, beside what it was before."""
    (level,) = load_manifest(folder).level
    return prepare(folder / "manifest.toml", "level[0].record[0]", level.record[0], level.target, 90.0)


def shaken(amplitude=1.0):
    """Thirty seconds of noise before and after a minute of a tone of 1 Hz."""
    quiet = 1e-4 * np.random.default_rng(7).normal(size=N)
    quiet[3000:9000] += tone(6000, amplitude)
    return quiet


@pytest.mark.parametrize(
    ("baseline", "said"),
    [
        ({"method": "linear"}, "linear baseline removed"),
        ({"method": "polynomial", "degree": 2}, "polynomial baseline of degree 2, fitted to the acceleration"),
        ({"method": "polynomial", "degree": 2, "of": "velocity"}, "fitted to the velocity"),
        ({"method": "two-segment", "t1_s": 30.0, "t2_s": 90.0}, "two-segment baseline (Boore 2001)"),
    ],
)
def test_every_baseline_flattens_what_it_is_made_for(three, write_manifest, baseline, said):
    """A drift of the instrument leaves tens of m/s of velocity; corrected, the velocity ends near zero."""
    offset = 0.02 * (np.arange(N) * DT > 30.0) if baseline["method"] == "two-segment" else DRIFT
    three(*(shaken(a) + offset for a in (1.0, 2.0, 0.5)))
    dirty = processed(raw(write_manifest, baseline={"method": "none"}, highpass_hz="none", accept=DRIFTS))
    clean = processed(raw(write_manifest, baseline=baseline, highpass_hz="none"))
    assert np.abs(integrate(dirty.motion)[0][:, -1]).min() > 1.0
    assert np.abs(integrate(clean.motion)[0][:, -1]).max() < 0.03
    assert said in " | ".join(clean.motion.steps)
    assert clean.filtered
    assert clean.corners == (None, None)


def test_the_mean_before_the_event(three, write_manifest):
    three(*(shaken(a) + 0.02 for a in (1.0, 2.0, 0.5)))
    wanted = {"baseline": {"method": "pre-event"}, "pre_event_s": 25.0, "highpass_hz": "none"}
    (motion,) = read_motion(raw(write_manifest, **wanted))
    # The mean of 2,500 samples of noise of 1e-4 m/s2 is 2e-6: four of these.
    assert np.abs(motion.acceleration[:, :2500].mean(axis=1)).max() < 8e-6
    with pytest.raises(MotionError, match=r"level\[0\]\.record\[0\]: baseline: the method pre-event needs pre_event_s"):
        read_motion(raw(write_manifest, baseline={"method": "pre-event"}))


def test_a_silent_manifest_has_its_corner_chosen_and_can_forbid_it(three, write_manifest):
    three(*(shaken(a) for a in (1.0, 2.0, 0.5)))
    chosen = processed(raw(write_manifest))
    corner, _ = chosen.corners
    # Three periods in 120 s ask for 0.025 Hz; below its tone of 1 Hz the record holds nothing but the noise before it.
    assert 0.025 <= corner < 1.0
    assert f"high-pass corner {corner:.4g} Hz chosen by" in " | ".join(chosen.motion.steps)
    given = processed(raw(write_manifest, highpass_hz=corner))
    assert np.array_equal(given.motion.acceleration, chosen.motion.acceleration)
    assert processed(raw(write_manifest, highpass_hz="none")).corners == (None, None)


def test_before_and_after_lie_over_each_other(three, write_manifest):
    """Scaled and turned alike: a tone far above the corner is the same in both."""
    three(*(shaken(a) for a in (1.0, 2.0, 0.5)))
    one = processed(raw(write_manifest, highpass_hz=0.05, scale_to_pga_g=0.4))
    assert measures(one.motion)["pga"] == pytest.approx(0.4 * G, rel=1e-12)
    assert one.before.samples == one.motion.samples
    # (0.05 / 1)^4 of the tone is taken by the filter.
    np.testing.assert_allclose(one.before.acceleration, one.motion.acceleration, atol=1e-3 * G)


def test_the_axes_of_the_building(three, write_manifest, tmp_path):
    """x at 30 degrees from north: a shaking along north is cos 30 along x and, y being at 300, cos 60 along y."""
    three(x=1e-7 * tone(), y=tone())
    folder = write_manifest()
    text = (folder / "manifest.toml").read_text()
    (folder / "manifest.toml").write_text(text.replace("longitude = -118.0", "longitude = -118.0\nx_azimuth = 30.0"))
    (motion,) = read_motion(folder)
    np.testing.assert_allclose(motion.acceleration[0], np.cos(np.radians(30)) * tone(), atol=1e-6)
    np.testing.assert_allclose(motion.acceleration[1], np.cos(np.radians(60)) * tone(), atol=1e-6)
    assert "x at 30 and y at 300 degrees" in motion.steps[-1]


def test_scaled_to_a_target_spectrum(three, write_manifest):
    """The one factor of least squares in log-log: no other makes the mean of ln(PSA / target) vanish."""
    three()
    folder = write_manifest(level="target = { periods_s = [0.1, 2.0], psa_g = [0.9, 0.3] }", scale_to_target=True)
    (motion,) = read_motion(folder)
    periods = np.geomspace(0.1, 2.0, 100)
    target = G * np.exp(np.interp(np.log(periods), np.log([0.1, 2.0]), np.log([0.9, 0.3])))
    assert np.mean(np.log(psa(motion, periods) / target)) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(MotionError, match="has scale_to_target, but the level has no target"):
        read_motion(write_manifest(scale_to_target=True))


def test_another_time_step(three, write_manifest):
    """A band-limited tone is the same tone on a finer step; a processed record may not be coarsened, which filters."""
    three()
    (fine,) = read_motion(write_manifest(resample_s=DT / 2))
    assert fine.dt == DT / 2
    np.testing.assert_allclose(fine.acceleration[0, ::2], tone(), atol=1e-9)
    with pytest.raises(MotionError, match="would filter it again"):
        read_motion(write_manifest(resample_s=2 * DT))


def test_the_manifest_may_say_v_max(three, write_manifest):
    from pipeline.analysis.response import respond

    three()
    (plain,) = read_motion(write_manifest())
    (told,) = read_motion(write_manifest(v_max_cm_s=200.0 * measures(plain)["pgv_resultant"]))
    velocity = [
        respond("rocking", m, fidelity="screen", angle=None, half_width=0.05, cg_height=0.5)["rotation_ratio"].iloc[0]
        for m in (plain, told)
    ]
    assert told.hash == plain.hash
    assert velocity[1] != velocity[0]


def test_a_clipped_record_is_refused_unless_accepted(three, write_manifest):
    cut = np.clip(tone(amplitude=2.0), -1.2, 1.2)
    three(y=cut)
    with pytest.raises(MotionError, match=r"n\.mseed.* is clipped.*accept\.clipping = .REASON") as refused:
        read_motion(write_manifest())
    assert refused.value.judgement == "clipping"
    (motion,) = read_motion(write_manifest(accept={"clipping": "the neighbour recorded the same peak"}))
    assert np.array_equal(motion.acceleration[1], cut)
    assert any("accepted: the neighbour recorded the same peak" in step for step in motion.steps)


def test_what_never_crosses_zero_is_doubted(three, write_manifest):
    push = 2.0 * np.exp(-(((np.arange(len(tone())) * DT - 10.0) / 0.5) ** 2))
    three(y=push)
    (motion,) = read_motion(write_manifest(accept={"drift": "a push of a shake table"}))
    assert np.array_equal(motion.acceleration[1], push)
    doubt, *_ = doubts(motion.steps)
    assert "is never below zero, and crosses its own trend" in doubt
    assert "may be a spectrum" in doubt


def test_a_record_that_ends_amid_the_shaking_is_refused_unless_accepted(three, write_manifest):
    three(*(tone()[:2000] * a for a in (1.0, 2.0, 0.5)))
    with pytest.raises(MotionError, match=r"ends during strong shaking.*accept\.cut_off") as refused:
        read_motion(write_manifest())
    assert refused.value.judgement == "cut_off"
    (motion,) = read_motion(write_manifest(accept={"cut_off": "the rest is known to be weak"}))
    assert any("accepted: the rest is known to be weak" in step for step in motion.steps)


def test_what_is_corrupt_cannot_be_accepted(three, write_trace, write_manifest):
    three()
    broken = tone()
    broken[100] = np.nan
    write_trace("n.mseed", broken, "HNN")
    everything = dict.fromkeys(("clipping", "cut_off", "size", "orientation"), "because I say so")
    with pytest.raises(MotionError, match="sample 100") as refused:
        read_motion(write_manifest(accept=everything))
    assert refused.value.judgement == ""


def test_a_silent_channel_is_dead_unless_it_is_meant(three, write_manifest):
    three(z=np.zeros(4000))
    components = {
        "e.mseed": {"axis": "x", "orientation": 90},
        "n.mseed": {"axis": "y", "orientation": 0},
        "z.mseed": {"axis": "z", "orientation": "up"},
    }
    with pytest.raises(MotionError, match="is dead"):
        read_motion(write_manifest(components=components))
    components["z.mseed"]["silent"] = True
    (motion,) = read_motion(write_manifest(components=components))
    assert not motion.acceleration[2].any()
    components["n.mseed"]["silent"] = True
    with pytest.raises(MotionError, match="is declared silent and is"):
        read_motion(write_manifest(components=components))


def test_the_mean_of_fewer_than_seven_is_cautioned(three, write_manifest):
    three()
    folder = write_manifest()
    text = (folder / "manifest.toml").read_text().replace('combine = "max"', 'combine = "mean"')
    (folder / "manifest.toml").write_text(text)
    assert "from 7 motions on" in read_site(folder).levels[0].caution


@pytest.mark.parametrize(
    ("steps", "told"),
    [
        (("scaled by 21.58 (HNE, from 0.0139 g to 0.3 g)",), "scaled by 21.6: so much stronger"),
        (("scaled by 0.1 (as the manifest says)",), "scaled by 0.1: so much weaker"),
        (("scaled by 3 (as the manifest says)", "scaled by 2 (again)"), "scaled by 6: so much stronger"),
        (("scaled by 4 (as the manifest says)",), ""),
        (("scaled by 0.25 (as the manifest says)",), ""),
        (("baseline corrected",), ""),
    ],
)
def test_a_record_that_is_scaled_far_is_doubtful(steps: tuple[str, ...], told: str) -> None:
    """Four times and a quarter are as far as suites are chosen; nobody is told of 21.6 by its peaks alone."""
    found = doubts(steps)
    assert [one.partition(" than")[0] for one in found] == ([told] if told else [])


@pytest.mark.parametrize(("step", "told"), [(0.02, False), (0.1, True)])
def test_samples_that_are_too_far_apart_are_doubted(three, write_manifest, step, told):
    """At 10 samples a second nothing above 5 Hz is told, by the sampling theorem; 50 are what agencies print."""
    n = round(40.0 / step)
    rows = [tone(n, amplitude, frequency=0.7, dt=step) for amplitude in (1.0, 2.0, 0.5)]
    three(*rows, delta=step)
    (motion,) = read_motion(raw(write_manifest, highpass_hz=0.1))
    assert [one for one in doubts(motion.steps) if one.startswith("sampled every")] == (
        [] if not told else [
            "sampled every 0.1 s: shaking above 5 Hz is not in it, and its peak acceleration is too small; take the "
            "record as its instrument sampled it"
        ]
    )  # fmt: skip
