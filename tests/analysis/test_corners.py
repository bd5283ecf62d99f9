"""A verdict holds at every combination of the ends of what is uncertain, not only with one input at an end."""

from itertools import product

import numpy as np
import pytest

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.plan import corners, plan
from pipeline.analysis.response import respond
from pipeline.execute import Threads
from pipeline.models import MODELS
from pipeline.motions import read_motion
from pipeline.quantities import Array, G
from pipeline.records import Finding, Furniture, Item, Motion, Numerics, Scene, Support, Verdict
from pipeline.resources import resource

pytestmark = pytest.mark.slow_file

COUNT = 400


@pytest.fixture(scope="module")
def motion() -> Motion:
    """The strongest part of the demonstration's record."""
    whole = read_motion(resource("site_motions", "demo"))[0]
    return Motion(whole.dt, whole.acceleration[:, round(15.0 / whole.dt) : round(30.0 / whole.dt)], "strong")


@pytest.fixture(scope="module")
def judged(motion: Motion) -> list[tuple[Scene, Finding]]:
    """Objects of the sizes of a museum, free and fastened, with the rocking and the tension that is found of each."""
    rng = np.random.default_rng(16)
    scenes = []
    for at in range(COUNT):
        height = float(np.exp(rng.uniform(np.log(0.05), np.log(2.0))))
        across = height * float(rng.uniform(0.2, 4.0))
        support = Support.FASTENED if at % 2 else Support.FREESTANDING
        kind = ("Bust", "Vase", "Statue")[at % 3]
        item = Item(str(at), "G", title=kind, object_name=kind, medium=("bronze", "porcelain", "marble")[at % 3],
                    support=support, furniture=Furniture.FLOOR,
                    height_m=height, width_m=across, depth_m=across)  # fmt: skip
        scenes.append(classify(item))
    found = assess(scenes, [LevelMotions("design", "max", (motion,))], Context(Threads(1)))[1]
    return [(s, f) for s, each in zip(scenes, found, strict=True) for f in each if f.model in ("standing", "stress")]


def demand(scene: Scene, model: str, push: float, lift: float, of: dict[str, float]) -> float:
    """The closed forms themselves: a / N, or friction, over b / h (paper, 2.1), and K m A l / S - m g / A (2.3).

    The section of what is hollow shrinks with its mass: m / S and m / A are those of the solid one.
    """
    if model == "standing":
        return min(lift, of["friction_static"]) * of["cg_height"] / of["half_width"]
    mass = max(of["mass"], scene.parameters["solid_mass"].value if "solid_mass" in scene.parameters else 0.0)
    bending = of.get("concentration", 1.0) * mass * push * of["lever"] / of["section_modulus"]
    return bending - mass * G / scene.parameters["area"].value


def test_decided_verdicts_hold_at_all_corners_and_between_them(
    judged: list[tuple[Scene, Finding]], motion: Motion
) -> None:
    """Each corner, and 200 places within: uplift and tension rise or fall with each input, whatever the others are."""
    x, y, z = motion.acceleration
    push, lift = float(np.hypot(x, y).max()), float((np.hypot(x, y) / (G + z)).max())
    rng = np.random.default_rng(17)
    inputs = {
        "standing": ("half_width", "cg_height", "friction_static"),
        "stress": ("mass", "lever", "section_modulus", "concentration"),
    }
    decided = {"standing": 0, "stress": 0}
    broken = 0
    for scene, found in judged:
        names = [name for name in inputs[found.model] if name in scene.parameters]
        # Of an assumed friction less than its best estimate is not counted on.
        ends = [
            (p.value if n == "friction_static" else p.low, p.high) for n, p in ((n, scene.parameters[n]) for n in names)
        ]
        allowed = scene.parameters["allowable_stress"] if found.model == "stress" else None
        within = [rng.uniform(*np.transpose(ends)) for _ in range(200)]
        each = [
            demand(scene, found.model, push, lift, dict(zip(names, one, strict=True)))
            for one in [*product(*ends), *within]
        ]
        low, high = (1.0, 1.0) if allowed is None else (allowed.low, allowed.high)
        assert found.low is not None
        assert found.high is not None
        # What is found is rounded in another order.
        assert found.low <= min(each) + 1e-9 * abs(min(each))
        assert found.high >= max(each) - 1e-9 * abs(max(each))
        if found.verdict is Verdict.UNDETERMINED:
            continue
        decided[found.model] += 1
        broken += max(each) > low if found.verdict is Verdict.PASS else min(each) <= high
    assert broken == 0
    # Of few bases that are only assumed is a verdict on rocking sure, and of fewer where friction is from 0.1 to 0.9.
    assert min(decided.values()) > COUNT / 64


def test_every_combination_of_ends_comes_once() -> None:
    """1 + 2^k sets of k uncertain inputs; what is certain keeps its value."""
    uncertain = np.array([[False, False, False], [True, False, True], [True, True, True], [False, True, False]])
    base = np.arange(12.0).reshape(4, 3)
    sets, analysis = corners(base, base - 0.5, base + 0.25, uncertain)
    for at, varied in enumerate(uncertain):
        own: Array = sets[analysis == at]
        count = int(varied.sum())
        assert own.shape[0] == (1 + 2**count if count else 1)
        assert np.array_equal(own[0], base[at])
        ends = [(v - 0.5, v + 0.25) if u else (v,) for v, u in zip(base[at], varied, strict=True)]
        assert {tuple(one) for one in own[1:].tolist()} == (set(product(*ends)) if count else set())


def test_no_object_has_more_than_six_uncertain_inputs_in_a_model() -> None:
    """All combinations of k ends are 2^k: an object with a range in every field has 64 at the most."""
    flexible = Item("1", "G", title="Statue", object_name="Statue", medium="marble", support=Support.FASTENED,
                    furniture=Furniture.FLOOR,
                    height_m=1.0, width_m=0.3, depth_m=0.2, frequency_hz=3.0, orientation_deg=30.0)  # fmt: skip
    free = Item("2", "G", title="Statue", object_name="Statue", medium="marble", height_m=1.0, width_m=0.3, depth_m=0.2,
                orientation_deg=30.0, furniture=Furniture.FLOOR)  # fmt: skip
    hung = Item("3", "G", title="Landscape", classification="paintings", height_m=1.0, width_m=1.0)
    work = plan([classify(one) for one in (flexible, free, hung)]).work
    assert (
        {one.model.name for one in work}
        >= {"flexible_stress", "standing", "sliding", "swing"}
        < {model.name for model in MODELS}
    )
    assert max(int(one.spans.lengths.max()) for one in work) <= 1 + 2**6


def test_falling_is_looked_for_at_every_corner(motion: Motion) -> None:
    """Narrow and top-heavy together falls where neither does on its own: nobody may say of it that it passes."""
    items = [
        Item(str(at), "G", title="Vase", object_name="Vase", susceptible=False, support=Support.FREESTANDING,
             furniture=Furniture.FLOOR, friction=2.0,
             height_m=height, width_m=float(slope * height), depth_m=float(slope * height))
        for at, (slope, height) in enumerate(product(np.linspace(0.6, 2.2, 9), (0.1, 0.3, 0.8)))
    ]  # fmt: skip
    scenes = [classify(item) for item in items]
    level = LevelMotions("design", "max", (motion,))
    found = assess(scenes, [level], Context(Threads(2)), Numerics(azimuth_step=45.0))[1]
    rocking = [f for each in found for f in each if f.model == "standing"]
    assert len({f.verdict for f in rocking}) > 1
    for scene, one in zip(scenes, rocking, strict=True):
        b, h = scene.parameters["half_width"], scene.parameters["cg_height"]
        ends = np.array(list(product((b.low, b.high), (h.low, h.high))))
        rows = respond("rocking", motion, angle=None, azimuth_step=45.0, half_width=ends[:, 0], cg_height=ends[:, 1])
        falls = rows["overturned"].to_numpy()
        if one.verdict is Verdict.PASS:
            assert not falls.any()
        elif one.verdict is Verdict.FAIL:
            assert falls.all()
