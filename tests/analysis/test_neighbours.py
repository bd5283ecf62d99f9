"""Neighbours shaken together: identical ones, closed-form pulses, pendulums out of step, symmetry, many at once."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.neighbours import neighbours
from pipeline.analysis.verdicts import LevelMotions
from pipeline.cli.console import Console
from pipeline.execute import Threads
from pipeline.quantities import G
from pipeline.records import Furniture, Item, Motion, Numerics, Spacing, Support, Verdict

SILENT = Console(quiet=True)

VASE = Item(
    "1", "A", "Vase", support=Support.FREESTANDING, furniture=Furniture.FLOOR,
    height_m=0.1, base_width_m=0.2, base_depth_m=0.2, width_m=0.2,
    depth_m=0.2, cg_height_m=0.02, friction=0.1, clearance_m=5.0, mass_kg=2.0, orientation_deg=0.0,
    position_x_m=0.0, position_y_m=0.0,
)  # fmt: skip

LAMP = Item(
    "L1", "A", "Chandelier", support=Support.SUSPENDED, suspension_length_m=1.0, damping=0.0, height_m=0.5, width_m=0.4,
    depth_m=0.4, clearance_m=5.0, position_x_m=0.0, position_y_m=0.0,
)  # fmt: skip


def pulse(acceleration: float = 4.0, seconds: float = 0.25, dt: float = 0.0005) -> Motion:
    n = round(seconds / dt)
    x = np.zeros(n + 2000)
    x[1 : n + 1] = acceleration
    return Motion(dt, [x, np.zeros_like(x), np.zeros_like(x)], "pulse")


def spaced(
    *items: Item, motions: tuple[Motion, ...] = (), combine: str = "max", x_azimuth: float = 90.0
) -> list[Spacing]:
    levels = [LevelMotions("design", combine, motions or (pulse(),), x_azimuth)]
    scenes = [classify(item) for item in items]
    _, findings = assess(scenes, levels, Context(Threads(1)), Numerics("history"))
    return neighbours(scenes, findings, levels)


def at(item: Item, number: str, x: float, y: float = 0.0, **changed: object) -> Item:
    return replace(item, object_number=number, position_x_m=x, position_y_m=y, **changed)  # type: ignore[arg-type]


def newmark(friction: float, acceleration: float = 4.0, seconds: float = 0.25) -> float:
    """d = V^2 / (2 mu g) (1 - mu g/A): exact for a rectangular pulse."""
    resist = friction * G
    return (acceleration * seconds) ** 2 / (2.0 * resist) * (1.0 - resist / acceleration)


def test_two_identical_objects_are_not_driven_apart() -> None:
    (found,) = spaced(VASE, at(VASE, "2", 0.25))
    assert found.gap == pytest.approx(0.05)
    assert found.together == pytest.approx(2.0 * newmark(0.1), rel=1e-2)
    assert found.together > found.gap
    assert (found.needed, found.low, found.high, found.radial) == (0.0, 0.0, 0.0, 0.0)
    assert (found.verdict, found.decided_by) == (Verdict.PASS, "history")


@pytest.mark.parametrize(("first", "second"), [(0.1, 0.2), (0.2, 0.1), (0.05, 0.3)])
def test_two_frictions_under_one_pulse(first: float, second: float) -> None:
    """Truth: the difference of Newmark's distances; both lag to the west, so only the smoother one to the east closes.

    The pulse's flanks take half a millisecond of a quarter of a second: 2 times 0.2 % of V, 1 % of the difference.
    """
    (found,) = spaced(replace(VASE, friction=first), at(VASE, "2", 0.25, friction=second))
    slips = newmark(first), newmark(second)
    assert found.radial == pytest.approx(abs(slips[0] - slips[1]), rel=0.01)
    # The first stands to the west of the second; the gap closes where the second lags further.
    assert found.needed == pytest.approx(max(0.0, slips[1] - slips[0]), rel=0.01, abs=1e-12)
    assert found.verdict is (Verdict.FAIL if slips[1] - slips[0] > 0.05 else Verdict.PASS)


def test_a_turned_building_turns_the_motion_not_the_places() -> None:
    """x of the motion pointing north: what stands south of the other is closed in on, what stands beside it is not."""
    rough, smooth = replace(VASE, friction=0.3), {"friction": 0.05}
    (beside,) = spaced(rough, at(VASE, "2", 0.25, 0.0, **smooth), x_azimuth=0.0)
    (north,) = spaced(rough, at(VASE, "2", 0.0, 0.25, **smooth), x_azimuth=0.0)
    assert beside.needed == pytest.approx(0.0, abs=1e-12)
    assert north.needed == pytest.approx(newmark(0.05) - newmark(0.3), rel=0.01)
    (east,) = spaced(rough, at(VASE, "2", 0.25, 0.0, **smooth))
    assert east.needed == pytest.approx(north.needed, rel=1e-9)


def test_y_is_a_quarter_turn_to_the_left_of_x() -> None:
    """With x to the south (azimuth 180), y points east: a push along y closes as one along x does at azimuth 90."""
    along = pulse()
    turned = Motion(along.dt, along.acceleration[[1, 0, 2]], "along y")
    pair = replace(VASE, friction=0.3), at(VASE, "2", 0.25, friction=0.05)
    (x,), (y,) = spaced(*pair), spaced(*pair, motions=(turned,), x_azimuth=180.0)
    assert y.needed == pytest.approx(x.needed, rel=1e-6)


def noise(seed: int, seconds: float = 6.0) -> Motion:
    rng = np.random.default_rng(seed)
    n = round(seconds / 0.01)
    return Motion(0.01, 2.0 * rng.normal(size=(3, n)) * np.sin(np.pi * np.arange(n) / (n - 1)), f"noise {seed}")


@pytest.mark.parametrize("seed", range(3))
def test_who_is_named_first_changes_nothing(seed: int) -> None:
    one, other = replace(VASE, friction=0.12), at(VASE, "2", 0.23, 0.19, friction=0.07)
    (there,), (back,) = spaced(one, other, motions=(noise(seed),)), spaced(other, one, motions=(noise(seed),))
    assert (back.first, back.second) == (there.second, there.first)
    for name in ("gap", "needed", "low", "high", "radial", "together"):
        assert getattr(back, name) == pytest.approx(getattr(there, name), rel=1e-12)
    assert there.needed is not None
    assert there.radial is not None
    assert 0.0 < there.needed <= there.radial <= there.together


def test_uncertain_frictions_span_a_range() -> None:
    """Low is nothing (both alike at one end), high is one at each end."""
    unknown = {"friction": None, "base_material": "wood", "surface_material": "wood"}
    (found,) = spaced(replace(VASE, **unknown), at(VASE, "2", 0.25, **unknown))  # type: ignore[arg-type]
    assert found.needed == 0.0
    assert found.low == 0.0
    assert found.high is not None
    assert found.high > 0.0


@pytest.mark.long("test_equal_pendulums_swing_as_one")
def test_pendulums_out_of_step_come_closer_than_either_moves() -> None:
    """Truth: both pendulums integrated independently (scipy, DOP853), for a minute after the record.

    Driven between their natural frequencies they swing against each other.  What happens after the record is bounded by
    their amplitudes, so that what is needed is never less than the truth, nor more than both movements added.
    """
    t = np.arange(0.0, 12.0, 0.01)
    x = 0.5 * np.sin(2.0 * np.pi * 0.4 * t) * np.sin(np.pi * t / t[-1]) ** 2
    motion = Motion(0.01, [x, np.zeros_like(x), np.zeros_like(x)], "between")
    lengths = (1.0, 2.5)
    hanging = [at(LAMP, f"L{i}", 0.6 * i, suspension_length_m=length) for i, length in enumerate(lengths)]
    (found,) = spaced(*hanging, motions=(motion,))

    def rate(now: float, state: np.ndarray, length: float) -> list[float]:
        push = float(np.interp(now, t, x, right=0.0))
        return [state[1], -(G * np.sin(state[0]) + push * np.cos(state[0])) / length]

    times = np.arange(0.0, 72.0, 0.01)
    u = [
        length * np.sin(solve_ivp(rate, (0.0, 72.0), [0.0, 0.0], "DOP853", times, args=(length,), max_step=0.05,
                                  rtol=1e-8).y[0])
        for length in lengths
    ]  # fmt: skip
    truth = float((u[0] - u[1]).max())
    assert truth > 1.2 * max(float(np.abs(one).max()) for one in u)
    assert found.needed is not None
    assert truth * (1.0 - 1e-3) <= found.needed <= found.together * (1.0 + 1e-3)


def test_equal_pendulums_swing_as_one() -> None:
    (found,) = spaced(LAMP, at(LAMP, "L2", 0.6), motions=(noise(1),))
    assert found.gap < found.together
    assert found.needed == 0.0


@pytest.mark.parametrize(("orientation", "gap"), [(0.0, 0.6), (90.0, 0.9), (None, 1.0 - np.hypot(0.2, 0.05) * 2.0)])
def test_outlines_count_as_they_are_turned(orientation: float | None, gap: float) -> None:
    """0.4 by 0.1 m, one metre apart to the east; the width points north (0), or east (90), or nobody knows."""
    # Width along its azimuth: north for 0, so that the depth of 0.1 m lies along the line between them.
    expected = {0.0: 0.9, 90.0: 0.6}.get(orientation, gap) if orientation is not None else gap
    flat = replace(VASE, width_m=0.4, depth_m=0.1, orientation_deg=orientation)
    (found,) = spaced(flat, at(flat, "2", 1.0))
    assert found.gap == pytest.approx(expected)


def test_what_is_far_enough_is_decided_by_the_bound() -> None:
    (found,) = spaced(VASE, at(VASE, "2", 30.0))
    assert (found.verdict, found.decided_by, found.needed) == (Verdict.PASS, "bound", None)
    assert found.gap >= found.together


def test_overlapping_outlines_are_a_matter_for_the_record() -> None:
    (found,) = spaced(VASE, at(VASE, "2", 0.1))
    assert found.gap < 0.0
    assert found.verdict is Verdict.UNDETERMINED
    assert "mend their places" in found.note
    (same,) = spaced(VASE, at(VASE, "2", 0.0))
    assert "mend their places" in same.note


def test_a_painting_without_a_wall_has_only_the_bound() -> None:
    painting = Item(
        "P1", "A", "Painting", support=Support.HUNG, height_m=1.0, width_m=0.8, depth_m=0.05, suspension_length_m=0.5,
        damping=0.05, clearance_m=5.0, position_x_m=0.0, position_y_m=0.0, orientation_deg=90.0,
    )  # fmt: skip
    (told,) = spaced(painting, at(painting, "P2", 0.801, suspension_length_m=1.0), motions=(noise(2),))
    assert told.decided_by == "history"
    unknown = at(painting, "P2", 0.85, orientation_deg=None)
    (open_,) = spaced(painting, unknown, motions=(noise(2),))
    assert open_.verdict is Verdict.UNDETERMINED
    assert "orientation_deg" in open_.note
    assert "P2" in open_.note
    assert open_.needed is None


def test_a_level_combines_what_its_motions_need() -> None:
    pair = replace(VASE, friction=0.3), at(VASE, "2", 0.25, friction=0.05)
    motions = (pulse(), pulse(2.0))
    each = [newmark(0.05, a) - newmark(0.3, a) if a > 0.3 * G else newmark(0.05, a) for a in (4.0, 2.0)]
    (most,), (mean,) = (spaced(*pair, motions=motions, combine=how) for how in ("max", "mean"))
    assert most.needed == pytest.approx(max(each), rel=0.01)
    assert mean.needed == pytest.approx(sum(each) / 2.0, rel=0.01)
    assert most.motion == "pulse"


def test_only_what_can_touch_is_a_pair() -> None:
    """Another gallery, another case, another way of standing, not on display, no place, nothing that moves."""
    others = [
        at(VASE, "gallery", 0.25, gallery="B"),
        at(VASE, "case", 0.25, case="C1"),
        at(LAMP, "lamp", 0.25),
        at(VASE, "store", 0.25, on_display=False),
        replace(VASE, object_number="nowhere", position_x_m=None),
        at(VASE, "fastened", 0.25, support=Support.FASTENED),
    ]
    assert spaced(VASE, *others) == []
    cased = [at(VASE, str(i), 0.25 * i, case="C1") for i in range(2)]
    assert len(spaced(*cased)) == 1
    assert spaced() == []


def test_near_pairs_are_all_found_and_no_others() -> None:
    """Truth: every pair of 300 tried by hand; besides those that may meet there are only nearest ones."""
    rng = np.random.default_rng(5)
    items = [
        at(VASE, str(i), *rng.uniform(0.0, 40.0, 2), friction=float(rng.choice([0.05, 0.1, 0.3])),
           width_m=float(w), depth_m=float(w), base_width_m=float(w), base_depth_m=float(w))
        for i, w in enumerate(rng.choice([0.1, 0.3, 2.0], 300, p=[0.6, 0.38, 0.02]))
    ]  # fmt: skip
    found = {(s.first, s.second): s for s in spaced(*items)}
    moves = {mu: newmark(mu) for mu in (0.05, 0.1, 0.3)}
    meet = set()
    for one, other in combinations(items, 2):
        along = np.array([other.position_x_m - one.position_x_m, other.position_y_m - one.position_y_m])  # type: ignore[operator]
        distance = float(np.hypot(*along))
        # A square that is not turned reaches half its side times |cos| + |sin|.
        outline = 0.5 * (one.width_m + other.width_m) * float(np.abs(along / distance).sum())  # type: ignore[operator]
        if distance - outline < 0.98 * (moves[one.friction] + moves[other.friction]):  # type: ignore[index]
            meet.add((one.object_number, other.object_number))
    assert meet
    assert meet <= set(found)
    assert len(found) <= len(meet) + len(items) + 50
    assert {n for pair in found for n in pair} == {item.object_number for item in items}
