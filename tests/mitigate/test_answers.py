"""For each row of the table of measures, an object for which exactly it is the answer."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.response import respond
from pipeline.analysis.survey import measurement_requests
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate import advise, changed
from pipeline.mitigate.catalogue import MeasureCatalogue, own_catalogue
from pipeline.mitigate.measures.brace import AT_TWO, BELOW, LEVER, STIFFER, STIFFER_AT_TWO, TOP
from pipeline.mitigate.saying import HEAVIEST, UNWEIGHED
from pipeline.motions.synthesis import sine
from pipeline.quantities import G
from pipeline.records import Furniture, Hanging, Item, Motion, Numerics, Support, Verdict
from pipeline.report.pages.plainly import plain_measure
from pipeline.report.units import Units
from pipeline.tables import table

from .scenes import BLOCK, HEAVY, PICTURE, STUMP, TOWER, demo_motion, rejected, solve, solve_all


@pytest.fixture(scope="module")
def motion() -> Motion:
    return demo_motion()


def test_room_is_the_right_answer(motion: Motion) -> None:
    advice = solve(BLOCK, motion)
    assert advice.measure == "clearance"
    moved = float(respond("sliding", motion, friction_static=0.1)["displacement"].iloc[0])
    # A tenth of margin, rounded up to a whole centimetre.
    assert advice.parameters["clearance"] == pytest.approx(np.ceil(110.0 * moved) / 100.0)


def test_a_non_slip_pad_is_the_right_answer(motion: Motion) -> None:
    """It slides further than any display can spare (30 cm), and does not rock."""
    strong = motion.scaled(1.6, "test")
    assert float(respond("sliding", strong, friction_static=0.001)["displacement"].iloc[0]) * 1.1 > 0.30
    advice = solve(replace(BLOCK, friction=0.001, base_width_m=2.0, base_depth_m=2.0), strong)
    assert advice.measure == "grip_pad"
    assert rejected(advice)[0] == "Keep clear"
    assert [check.model for check in advice.checks] == ["standing", "sliding"]


def test_fastening_is_the_right_answer(motion: Motion) -> None:
    """Too heavy for any fixing that is to be had, and strong enough."""
    advice = solve(HEAVY, motion)
    assert advice.measure == "fasten"
    assert {"Non-slip pad", "Padded clamps"} <= set(rejected(advice))


def test_whoever_builds_for_a_mass_that_is_assumed_is_told_what_it_may_be(motion: Motion) -> None:
    """The outline of a bronze is filled to 0.3 % or to a third: a mount for the heaviest is told to be that."""
    unweighed = replace(
        HEAVY, mass_kg=None, height_m=2.4, cg_height_m=1.2, width_m=0.5, depth_m=0.5, base_width_m=0.5,
        base_depth_m=0.5, section_width_m=0.3, section_depth_m=0.3,
    )  # fmt: skip
    mass = classify(unweighed).parameters["mass"]
    assert mass.high >= UNWEIGHED * mass.value
    advice = solve(unweighed, motion)
    assert advice.measure == "fasten"
    assert advice.sentence.endswith(HEAVIEST)
    assert (advice.parameters["heaviest"], advice.parameters["weight"]) == (mass.high, mass.value)
    assert advice.parameters["force"] / advice.parameters["heaviest"] > 0.7 * G
    told = plain_measure(advice, Units())
    # It holds for whatever the scales say; both forces are that share of the two weights, told with two digits.
    times, likely, weight, most, heaviest = map(
        float,
        re.findall(r"must hold ([\d.]+) times its weight.* That is (\d+)\skg if it weighs (\d+)\skg, as is likeliest, "
                   r"and (\d+)\skg if it weighs (\d+)\skg, the most", told)[0],
    )  # fmt: skip
    assert (likely / weight, most / heaviest) == pytest.approx((times, times), rel=0.1)
    assert most / likely == pytest.approx(mass.high / mass.value, rel=0.1)
    assert HEAVIEST not in solve(HEAVY, motion).sentence


def test_rubber_pads_are_the_right_answer(motion: Motion) -> None:
    """Paper, Table 4: damping 0.06 instead of 0.02; room is asked for first, so the wall must have none to spare."""
    strong = motion.scaled(2.0, "until room alone is not enough")
    before, after = respond("swing", strong, angle=None, length=1.2, damping=[0.02, 0.06])["displacement"]
    assert 1.1 * before > 0.60 > after
    advice = solve(replace(PICTURE, suspension_length_m=1.2, clearance_m=float(after) * 1.01), strong)
    assert advice.measure == "rubber_pads"
    assert advice.parameters["damping"] == 0.06


def test_a_second_fixing_is_the_right_answer(motion: Motion) -> None:
    strong = motion.scaled(4.0, "test")
    advice = solve(replace(PICTURE, suspension_length_m=3.0), strong)
    assert advice.measure == "restrain"
    push = float(np.hypot(*strong.acceleration[:2]).max())
    assert advice.parameters["force"] == pytest.approx(8.0 * push)


def test_stays_are_the_right_answer_for_what_hangs_from_above_without_room(motion: Motion) -> None:
    """A canoe of 120 kg: each of the lines at 45 degrees bears m A / cos 45; nothing else, least of all removal."""
    canoe = Item("3", "G", object_name="canoe", medium="wood", support=Support.SUSPENDED, height_m=0.5, width_m=5.0,
                 depth_m=0.8, mass_kg=120.0, suspension_length_m=1.5, clearance_m=0.05)  # fmt: skip
    strong = motion.scaled(4.0, "test")
    advice = solve(canoe, strong)
    assert advice.measure == "stays"
    push = float(np.hypot(*strong.acceleration[:2]).max())
    assert advice.parameters["force"] == pytest.approx(120.0 * push * np.sqrt(2.0))
    assert "Fix to the wall" in rejected(advice)


def test_an_isolator_is_the_right_answer(motion: Motion) -> None:
    """Too weak to be clamped (0.2 MPa where 0.4 arise), too slender to stand free."""
    advice = solve(replace(TOWER, allowable_stress_pa=2e5), motion)
    assert advice.measure == "horizontal_isolator"
    assert {"Fasten", "Low-friction pad"} <= set(rejected(advice))


def test_a_low_friction_pad_is_the_right_answer_for_what_is_clamped_too_hard(motion: Motion) -> None:
    """Clamped it breaks; it does not rock, so it may slide (paper, 2.6)."""
    clamped = replace(
        BLOCK, support=Support.FASTENED, section_width_m=0.05, section_depth_m=0.05, allowable_stress_pa=3e5
    )
    advice = solve(clamped, motion)
    assert advice.measure == "friction_isolator"
    assert advice.checks[0].model == "rocking"


def test_a_low_friction_pad_never_excuses_a_tall_object(motion: Motion) -> None:
    """Paper, 2.6: reduction of the friction will not increase the rocking stability of an object."""
    assert solve(replace(TOWER, friction=0.25), motion).title != "Low-friction pad"
    tall = replace(TOWER, support=Support.FASTENED, allowable_stress_pa=2e5)
    assert any(text.startswith("Low-friction pad: it may rock") for text in solve(tall, motion).rejected)


def without(kind: str) -> MeasureCatalogue:
    """The catalogue of a museum that has no isolator of that kind."""
    own = own_catalogue()
    return MeasureCatalogue(own.measures, tuple(isolator for isolator in own.isolators if isolator.kind != kind))


def test_another_surface_is_the_right_answer(motion: Motion) -> None:
    """Table 3: marble slides further than any display can spare on mosaic (0.13), and not on Formica (0.18)."""
    x, y, z = 2.5 * motion.acceleration
    strong = motion.changed([x, y, 0.0 * z], "until room alone is not enough, and nothing is lifted")
    on_mosaic, on_terrazzo, on_formica = respond("sliding", strong, friction_static=[0.13, 0.15, 0.18])["displacement"]
    assert 1.1 * on_mosaic > 0.30
    assert on_formica < on_terrazzo
    marble = replace(BLOCK, base_material="Marble", friction=0.13, base_width_m=2.0, base_depth_m=2.0)
    advice = solve(replace(marble, clearance_m=1.01 * float(on_formica)), strong)
    assert advice.measure == "surface"
    assert advice.sentence.startswith("Stand it on formica")
    assert advice.parameters["friction"] == 0.18
    assert advice.parameters["movement"] >= on_formica
    assert rejected(advice) == ["Keep clear", "Rubber pads behind it"]


def test_nothing_in_a_case_is_set_on_plywood(motion: Motion) -> None:
    """Of metal, plywood (0.37) is all that Table 3 has above terrazzo: it is the answer, but not in a case."""
    x, y, z = 3.5 * motion.acceleration
    strong = motion.changed([x, y, 0.0 * z], "until room alone is not enough, and nothing is lifted")
    metal = replace(BLOCK, base_material="Aluminum", friction=0.24, clearance_m=0.2, base_width_m=2.0, base_depth_m=2.0)
    on_floor, in_case = (solve(replace(metal, furniture=one), strong) for one in (Furniture.FLOOR, Furniture.SHOWCASE))
    assert (on_floor.measure, on_floor.sentence[:19]) == ("surface", "Stand it on plywood")
    assert in_case.measure != "surface"
    (why,) = (text for text in in_case.rejected if text.startswith("Another surface"))
    assert why == "Another surface: in a case plywood gives off acids that corrode metals, shell and glass"


def test_ballast_is_the_right_answer(motion: Motion) -> None:
    """(m h + M H) / (m + M) <= b / lift: the least M by hand, with 1 % to spare."""
    advice = solve(replace(STUMP, object_name="Vase"), motion)
    assert advice.measure == "ballast"
    x, y, z = motion.acceleration
    left = 0.1 / float((np.hypot(x, y) / (G + z)).max())
    height = 0.2 * 0.15
    least = 200.0 * (0.15 - left) / (left - height)
    assert advice.parameters["mass"] == pytest.approx(1.01 * least)
    assert advice.parameters["mass"] <= 0.5 * 200.0
    assert advice.parameters["height"] == pytest.approx(height)
    rocking = next(check for check in advice.checks if check.model == "standing")
    assert rocking.before is not None
    assert rocking.demand <= 1.0 < rocking.before


def test_a_wider_base_is_the_right_answer(motion: Motion) -> None:
    """The same object where it has no room for ballast: B = 2 h lift, with 1 % and up to a whole centimetre."""
    advice = solve(STUMP, motion)
    assert advice.measure == "wide_base"
    x, y, z = motion.acceleration
    lift = float((np.hypot(x, y) / (G + z)).max())
    assert advice.parameters["width"] == pytest.approx(np.ceil(100.0 * 1.01 * 0.3 * lift) / 100.0)
    assert {"standing", "sliding", "stress"} == {check.model for check in advice.checks}
    assert "Ballast in its base" in rejected(advice)


def test_a_pad_that_turns_is_the_right_answer() -> None:
    """Shaken at 12 Hz, a pad of 2 Hz passes (2/12)^2 and little more on; clamped, the section bears half the push."""
    fast = sine(0.7 * G, 12.0, 40.0, ramp=0.5)
    fragile = replace(TOWER, allowable_stress_pa=2e5)
    advice = solve(fragile, fast, without("horizontal_isolator"))
    assert advice.measure == "rotational_isolator"
    assert advice.parameters["acceleration"] < 0.35 * G
    assert {"Fasten", "Low-friction pad", "Horizontal isolator"} <= set(rejected(advice))
    assert [check.model for check in advice.checks] == ["rotational_isolator", "stress"]


def test_a_brace_is_the_right_answer(motion: Motion) -> None:
    """Clamped, the section bears twice what it may; braced above its middle half of that at most, by the table."""
    push = float(np.hypot(*motion.acceleration[:2]).max())
    bending, weight = 20.0 * push * 0.5 / (0.1**3 / 6.0), 20.0 * G / 0.01
    weak = replace(TOWER, object_name="Statue", allowable_stress_pa=0.55 * bending - weight)
    advice = solve(weak, motion)
    assert advice.measure == "brace"
    assert {"Padded clamps", "Fasten"} <= set(rejected(advice))
    assert advice.parameters == pytest.approx({"force": 20.0 * push, "height": 0.6})
    (check,) = advice.checks
    assert check.demand == pytest.approx(0.25 * bending - weight)
    # Nobody braces what is lower than a hand.
    small = {name: 0.1 * getattr(weak, name) for name in ("height_m", "base_width_m", "base_depth_m", "cg_height_m")}
    assert "brace" not in {r.measure for r in sum(solve_all([replace(weak, **small)], [motion]), [])}  # noqa: RUF017


def test_what_is_braced_is_not_braced_again(motion: Motion) -> None:
    """A section that bears less than the least that a brace leaves, and more than a second one seemed to."""
    push = float(np.hypot(*motion.acceleration[:2]).max())
    bending, weight = 20.0 * push * 0.5 / (0.1**3 / 6.0), 20.0 * G / 0.01
    item = replace(TOWER, object_name="Statue", allowable_stress_pa=0.1 * bending - weight)
    scene = own_catalogue().named("brace").change(classify(item), {})
    levels = [LevelMotions("design", "max", (motion,))]
    _, findings = assess([scene], levels, Context(Threads(1)))
    ((advice,),) = advise([scene], findings, levels, Context(Threads(1)))
    assert advice.measure not in ("brace", "armature")
    assert {f"{title}: it is braced already" for title in ("Brace it above its middle", "Brace it at two heights")} <= {
        text for text in advice.rejected if "braced already" in text
    }


def test_a_brace_leaves_a_quarter_of_the_bending_of_an_even_bar() -> None:
    """By the deflections of a cantilever: held at a, the force there brings it back to where it is not bent away.

    Frequencies: cos(x) cosh(x) = -1 of a bar that is fixed and free, tan(x) = tanh(x) of one that is fixed and held.
    """
    x = np.linspace(0.0, 1.0, 2001)
    for a in np.linspace(0.5, 1.0, 11):
        free = a**2 * (6.0 - 4.0 * a + a**2) / 24.0
        force = free / (a**3 / 3.0)
        moment = (1.0 - x) ** 2 / 2.0 - force * np.maximum(a - x, 0.0)
        # 5e-4 between the points that are looked at.
        assert np.abs(moment).max() <= LEVER[1] * 0.5 + 1e-12
    alone = brentq(lambda x: np.cos(x) * np.cosh(x) + 1.0, 1.0, 3.0)
    propped = brentq(lambda x: np.tan(x) - np.tanh(x), 3.2, 4.5)
    assert STIFFER[2] == pytest.approx((propped / alone) ** 2, abs=0.005)


def test_an_armature_is_the_right_answer(motion: Motion) -> None:
    """The section bears less than a quarter of the bending, and more than a fifth: what a brace leaves is too much."""
    push = float(np.hypot(*motion.acceleration[:2]).max())
    bending, weight = 20.0 * push * 0.5 / (0.1**3 / 6.0), 20.0 * G / 0.01
    weak = replace(TOWER, object_name="Statue", allowable_stress_pa=0.22 * bending - weight)
    advice = solve(weak, motion)
    assert advice.measure == "armature"
    assert "Brace it above its middle" in rejected(advice)
    assert advice.parameters == pytest.approx({"force": 20.0 * push, "height": 0.4, "second": 0.8})
    (check,) = advice.checks
    assert check.demand == pytest.approx(0.08 * bending - weight)


def test_an_even_bar_held_at_two_heights_bears_a_twentyfifth() -> None:
    """By finite elements that are exact in their nodes: bending, what the contacts bear, and the lowest frequency."""
    n, h = 200, 1.0 / 200
    stiff = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                      [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) / h**3  # fmt: skip
    heavy = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                      [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]) * h / 420  # fmt: skip
    load = np.array([h / 2, h * h / 12, h / 2, -h * h / 12])
    k, m, f = np.zeros((2 * n + 2, 2 * n + 2)), np.zeros((2 * n + 2, 2 * n + 2)), np.zeros(2 * n + 2)
    for at in range(0, 2 * n, 2):
        k[at : at + 4, at : at + 4] += stiff
        m[at : at + 4, at : at + 4] += heavy
        f[at : at + 4] += load

    def found(*held: float) -> tuple[float, float, float]:
        lost = [0, 1, *(2 * round(a * n) for a in held)]
        free = np.setdiff1d(np.arange(2 * n + 2), lost)
        u = np.zeros(2 * n + 2)
        u[free] = np.linalg.solve(k[np.ix_(free, free)], f[free])
        ends = [stiff @ u[at : at + 4] - load for at in range(0, 2 * n, 2)]
        bent = max(max(abs(end[1]), abs(end[3])) for end in ends)
        borne = max((abs((k @ u - f)[one]) for one in lost[2:]), default=0.0)
        w2 = eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True, subset_by_index=[0, 0])[0]
        return float(bent), float(borne), float(np.sqrt(w2))

    alone, held = found(), found(0.4, 0.8)
    assert held[0] / alone[0] == pytest.approx(AT_TWO[0], abs=1e-6)
    assert held[1] < 0.43
    assert held[2] / alone[2] == pytest.approx(STIFFER_AT_TWO[2], rel=0.04)
    assert (BELOW * 0.5, TOP * 0.5) == (0.4, 0.8)


def test_strengthening_is_the_right_answer(motion: Motion) -> None:
    """The bending m A l / S falls with the cube of the size; nothing that spares the object is to be had."""
    own = own_catalogue()
    nothing = MeasureCatalogue(own.measures, ())
    advice = solve(replace(TOWER, allowable_stress_pa=2e5), motion, nothing)
    assert advice.measure == "strengthen"
    push = float(np.hypot(*motion.acceleration[:2]).max())
    times, modulus, area = advice.parameters["enlargement"], 0.1**3 / 6.0, 0.01
    assert 1.0 < times <= 1.5
    assert advice.parameters["section_modulus"] == pytest.approx(times**3 * modulus)
    stress = 20.0 * push * 0.5 / (times**3 * modulus) - 20.0 * G / (times**2 * area)
    assert stress <= 2e5 < 20.0 * push * 0.5 / modulus - 20.0 * G / area
    (check,) = advice.checks
    assert check.demand == pytest.approx(stress)
    assert advice.parameters["force"] == pytest.approx(20.0 * push)


def test_every_row_of_the_table_has_its_object() -> None:
    """Each measure's test above names it as the answer."""
    from pathlib import Path

    here = Path(__file__).parent
    # What its mount holds is advised beside the other answers to how a thing is held.
    files = [*here.glob("test_*.py"), here.parent / "analysis" / "test_mounts.py"]
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    for row in table("measures"):
        assert f'advice.measure == "{row["measure"]}"' in text, row["measure"]


def test_removal_is_the_last_answer(motion: Motion) -> None:
    hopeless = replace(TOWER, allowable_stress_pa=1e3)
    strong = motion.scaled(3.0, "test")
    advice = solve(replace(hopeless, base_width_m=0.05, base_depth_m=0.05), strong)
    assert advice.measure == "remove"
    assert advice.checks == ()
    # Besides the removal itself nothing is said of fastening furniture, for it stands on the floor, nor of wheels.
    assert len(advice.rejected) == len(table("measures")) - 3


def test_open_rocking_is_not_answered_by_room(motion: Motion) -> None:
    """Sliding fails and rocking is open: what is advised passes for both.  Nothing fails: nothing is advised."""
    open_ = replace(
        BLOCK, base_width_m=None, base_depth_m=None, width_m=0.2, depth_m=0.2, height_m=1.4, cg_height_m=0.7
    )
    _, (found,) = assess([classify(open_)], [LevelMotions("design", "max", (motion,))], Context(Threads(1)))
    verdicts = {f.model: f.verdict for f in found}
    assert verdicts == {"standing": Verdict.UNDETERMINED, "sliding": Verdict.FAIL}
    advice = solve(open_, motion)
    assert advice.measure != "clearance"
    assert advice.rejected[0] == "Keep clear: room does not help: it may fail otherwise than by moving"
    assert all(check.passes for check in advice.checks)
    assert solve_all([replace(open_, height_m=0.2, cg_height_m=0.1, clearance_m=None, friction=None)], [motion]) == [[]]


def test_a_measure_passes_under_every_motion_of_a_level(motion: Motion) -> None:
    """The weak motion alone would let it stand free; with the strong one in the level it is fastened."""
    weak, strong = motion.scaled(0.2, "weak"), motion.scaled(1.2, "strong")
    (alone,) = solve_all([HEAVY], [weak])
    assert [r.measure for r in alone] != ["fasten"]
    ((both,),) = solve_all([HEAVY], [weak, strong])
    assert both.measure == "fasten"
    assert both.parameters["force"] == pytest.approx(500.0 * float(np.hypot(*strong.acceleration[:2]).max()))


def test_a_change_is_what_its_recommendation_says(motion: Motion) -> None:
    """The scene that a recommendation's own parameters give passes every model: what is installed is what was run."""
    level = LevelMotions("design", "max", (motion,))
    for item in (BLOCK, TOWER, HEAVY, STUMP, replace(STUMP, object_name="Vase")):
        advice = solve(item, motion)
        scene = changed(classify(item), advice.measure, advice.parameters)
        _, (found,) = assess([scene], [level], Context(Threads(1)), Numerics("history"))
        assert found
        assert all(f.verdict is Verdict.PASS for f in found)


def test_up_to_is_the_far_end_of_the_range(motion: Motion) -> None:
    """Whose friction is not measured slides at most as far as at the low end of its friction: that is what is said."""
    unsure = replace(BLOCK, friction=None, clearance_m=0.001)
    low = classify(unsure).parameters["friction_static"].low
    advice = solve(unsure, motion)
    most = float(respond("sliding", motion, friction_static=low)["displacement"].iloc[0])
    assert advice.measure == "clearance"
    assert advice.parameters["movement"] == pytest.approx(most)
    assert advice.parameters["clearance"] == pytest.approx(np.ceil(110.0 * most) / 100.0)


def test_a_mount_holds_a_flexible_object_at_the_low_end_of_its_damping(motion: Motion) -> None:
    """Its damping may be 1 %: the mount bears the mass times the pseudo-acceleration then, in its worst direction."""
    bending = replace(HEAVY, frequency_hz=4.0)
    damping = classify(bending).parameters["damping"]
    assert (damping.low, damping.value) == (0.01, 0.02)
    advice = solve(bending, motion)
    assert advice.measure == "fasten"
    # Of the worst direction 1 - cos(0.1 deg) is missed.
    finely = {"angle": None, "azimuth_step": 0.2}
    at = respond("oscillator", motion, **finely, frequency=4.0, damping=[damping.low, damping.value])
    least_damped, best = at["pseudo_acceleration"]
    assert least_damped > 1.02 * best
    assert advice.parameters["force"] == pytest.approx(500.0 * least_damped, rel=3e-6)


HOOKED = replace(PICTURE, hanging=Hanging.TWO_HOOKS, suspension_length_m=None)
"""The same picture flush with its wall."""


def falls_away(times: float, seconds: float) -> Motion:
    """Return a wall that falls away under what hangs on it, and stops."""
    z = np.zeros(400)
    z[100 : 100 + round(seconds / 0.005)] = -times * G
    return Motion(0.005, np.vstack([np.zeros_like(z), np.zeros_like(z), z]))


def test_closed_hooks_are_the_right_answer() -> None:
    """1.6 g for 0.15 s lifts by A (A - g) t^2 / 2g = 11 cm, further than any hook is deep; closed, nothing rises."""
    advice = solve(HOOKED, falls_away(1.6, 0.15))
    assert advice.measure == "close_hooks"
    (lift,) = [check for check in advice.checks if check.model == "unhooking"]
    assert lift.before == pytest.approx(1.6 * 0.6 * G * 0.15**2 / 2.0, rel=0.08)  # two ramps of 5 ms
    assert lift.demand == 0.0


def test_what_may_hang_in_several_ways_is_asked_and_not_advised(motion: Motion) -> None:
    """On one wire it needs more room, on two hooks none: a look behind it settles that, room does not."""
    unknown = replace(PICTURE, suspension_length_m=None, height_m=1.6)
    levels = [LevelMotions("design", "max", (motion,))]
    scene = classify(unknown)
    _, (found,) = assess([scene], levels, Context(Threads(1)))
    assert {f.model: f.verdict for f in found}["swing"] is Verdict.UNDETERMINED
    assert solve_all([unknown], [motion]) == [[]]
    asked = measurement_requests([scene], [found], levels, Context(Threads(1)))
    assert asked[0].field == "hanging"
    assert solve_all([replace(unknown, hanging=Hanging.TWO_HOOKS)], [motion]) == [[]]
    (on_a_wire,) = solve_all([replace(unknown, hanging=Hanging.WIRE)], [motion])
    assert [one.measure for one in on_a_wire] == ["clearance"]
