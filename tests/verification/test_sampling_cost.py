"""What a probability costs: the error by an independent long run, the samples by the rule, a case without any error."""

import numpy as np
import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.likelihood import draws
from pipeline.analysis.likelihood.analyses import Stood
from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.cli.console import Console, tradeoff_lines
from pipeline.execute import Threads
from pipeline.kernels import KERNEL_VERSION
from pipeline.motions.synthesis import half_sine_pulse
from pipeline.quantities import G
from pipeline.records import Furniture, Item, Sampling, Scene
from pipeline.verification import sampling_cost
from pipeline.verification.sampling_cost import NUMBERS, SamplingCost, sampling_costs
from pipeline.verification.tradeoff import Tradeoff
from tests.soak import soaked

pytestmark = pytest.mark.slow_file

SILENT = Console(quiet=True)
LEVEL = LevelMotions("pulse", "max", (half_sine_pulse(0.35 * G, 0.4, dt=0.01),))


@pytest.fixture(scope="module")
def scenes() -> list[Scene]:
    """Vases from squat to slender, on the floor itself, whose friction and centre of gravity nobody knows."""
    return [
        classify(
            Item(
                str(n), "G", title="Vase", object_name="vase", medium="earthenware", height_m=0.3 + 0.02 * n,
                width_m=0.16, depth_m=0.16, base_width_m=0.11, base_depth_m=0.11, furniture=Furniture.FLOOR,
            )
        )
        for n in range(10)
    ]  # fmt: skip


@pytest.fixture(scope="module")
def found(scenes: list[Scene]) -> list[SamplingCost]:
    return sampling_costs(scenes, [LEVEL], SILENT)


@pytest.mark.long("test_what_is_certain_has_no_error")
def test_each_number_and_the_rule_are_measured(found: list[SamplingCost]) -> None:
    assert [one.samples for one in found[:-1]] == list(NUMBERS)
    assert {one.objects for one in found} == {10}
    assert 64.0 <= found[-1].samples <= 512.0
    assert all(one.seconds > 0.0 and 0.0 <= one.rms <= one.worst for one in found)
    assert all(0.0 <= one.right <= 1.0 for one in found)


@pytest.mark.long("test_what_is_certain_has_no_error")
def test_the_error_is_that_against_a_run_with_other_random_numbers(
    scenes: list[Scene], found: list[SamplingCost], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same objects by a Sobol' sequence of another scrambling, 4,096 samples of each.

    That run errs by 0.5 / sqrt(4096) = 0.008 at most where its samples were independent; a root mean square of ten
    objects that share their samples may be off by so much either way.
    """
    few = likelihoods([Stood(at, s) for at, s in enumerate(scenes)], 10, [LEVEL], Sampling(64, 2.0), Threads())
    draws._shares.cache_clear()
    monkeypatch.setattr(draws, "SEED", 7)
    many = likelihoods([Stood(at, s) for at, s in enumerate(scenes)], 10, [LEVEL], Sampling(4096, 2.0), Threads())
    draws._shares.cache_clear()
    short, long = (np.array([one[0].probability for one in run]) for run in (few, many))
    assert found[0].rms == pytest.approx(float(np.sqrt(np.mean((short - long) ** 2))), abs=0.008)
    assert found[0].worst == pytest.approx(float(np.max(np.abs(short - long))), abs=4.0 * 0.008)


@pytest.mark.long("test_what_is_certain_has_no_error")
def test_errors_keep_what_they_state(found: list[SamplingCost]) -> None:
    """Those of independent samples, of which the measured root mean square is half as much again with a
    probability of 1 % at ten objects (chi square: 2.25 times ten degrees of freedom); balanced ones stay below.
    """
    for one in found:
        assert one.rms < 1.5 * one.stated


@soaked
def test_errors_fall_with_the_number_of_samples(scenes: list[Scene], monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight times the samples: a third of the error where they were independent, less as they are balanced.

    Of four scramblings together: with ten objects that share their samples, 64 samples of a single one may be lucky.
    """
    # Against 1,536 others each, whose own error is a third of that.
    monkeypatch.setattr(sampling_cost, "NUMBERS", (64, 512))
    monkeypatch.setattr(sampling_cost, "TRUE_SAMPLES", 2048)
    few, many = [], []
    for seed in range(1, 5):
        draws._shares.cache_clear()
        monkeypatch.setattr(draws, "SEED", seed)
        found = sampling_costs(scenes, [LEVEL], SILENT)
        few.append(found[0].rms)
        many.append(found[1].rms)
    draws._shares.cache_clear()
    assert np.mean(np.square(many)) < 0.6**2 * np.mean(np.square(few))


def test_what_is_certain_has_no_error() -> None:
    """A slab flat on the floor neither tips nor leaves its place in a push of 1 % of g: all samples agree."""
    slab = classify(
        Item("1", "G", title="Altar", object_name="altar", medium="stone", height_m=0.3, width_m=1.0, depth_m=1.0,
             base_width_m=1.0, base_depth_m=1.0, furniture=Furniture.FLOOR)
    )  # fmt: skip
    weak = LevelMotions("weak", "max", (half_sine_pulse(0.01 * G, 0.3, dt=0.01),))
    for one in sampling_costs([slab], [weak], SILENT):
        assert (one.rms, one.worst, one.right) == (0.0, 0.0, 1.0)


def test_nothing_is_measured_where_there_is_no_object() -> None:
    assert sampling_costs([], [LEVEL], SILENT) == []


@pytest.mark.long("test_what_is_certain_has_no_error")
def test_the_lines_show_every_way(found: list[SamplingCost]) -> None:
    lines = tradeoff_lines(Tradeoff("", KERNEL_VERSION, [], [], [], found), 1e-3)
    assert "Probabilities of harm of 10 objects, against other samples of the same objects:" in lines
    assert [line.split()[0] for line in lines[-5:]] == ["64", "128", "256", "512", "until"]
