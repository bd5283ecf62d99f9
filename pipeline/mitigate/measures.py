"""The measures on one object: what each proposes for it.  Limits and words: tables/measures.csv."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from math import ceil, inf, isfinite

from pipeline.analysis.classify import material_of
from pipeline.analysis.verdicts import judge
from pipeline.mitigate.bench import Bench, Bodies, Trial
from pipeline.mitigate.changes import changed, held, knows_section
from pipeline.mitigate.holding import footing, force_and_moment, strengths, wax_area, wax_checks
from pipeline.mitigate.means import Isolator, Means, Measure
from pipeline.mitigate.offers import Need, Numbers, Offer, Proposal, refused
from pipeline.models import settled_by_room
from pipeline.models.stress import STRESS
from pipeline.quantities import G
from pipeline.records import Check, Finding, Scene, Support, Verdict
from pipeline.tables import number, table

Propose = Callable[[Need, Bench, Measure], Proposal]

MARGIN = 1.1
"""Room asked for over the largest demand of the uncertain inputs: the error of the motion is not in it."""

SPARE = 1.01
"""Margin on sizes that are found in closed form and then run: 1 %, so that rounding never decides."""

FREE = refused("it does not stand free")
UNKNOWN_SECTION = refused("its mass or critical section is not known, so the stress of a held base cannot be checked")


def up(value: float, step: float = 0.01) -> float:
    """Round up to the next whole step, a centimetre where nothing else is said."""
    return round(step * ceil(value / step - 1e-9), 12) if isfinite(value) else value


def on_floor(need: Need, measure: Measure, numbers: Numbers) -> Scene:
    """Return the scene of an object on its floor with the measure in place."""
    return changed(need.scene, measure.name, {name: value for name, (value, _) in numbers.items()})


def keep_clear(need: Need, bench: Bench, measure: Measure) -> Proposal:  # noqa: ARG001
    """Give it the room that it needs.

    Room changes no demand, so nothing is run again: the demands of its findings are held against the new room.  All
    others must pass as they stand: an object that may rock is not helped by room, even where only its sliding is known
    to need some.
    """
    moving = [f for f in need.findings if settled_by_room(f.model) and f.high is not None]
    others = [f for f in need.findings if not settled_by_room(f.model) and f.verdict is not Verdict.PASS]
    if others:
        may = "it fails" if any(f.verdict is Verdict.FAIL for f in others) else "it may fail"
        return refused(f"room does not help: {may} otherwise than by moving")
    if not moving:
        return refused("it does not move")
    most = max(f.high or 0.0 for f in moving)
    room = up(MARGIN * most)
    allowed = measure.limit_high if need.scene.support in (Support.HUNG, Support.SUSPENDED) else measure.limit
    if room > allowed:
        return refused(f"it would need {100 * room:.0f} cm of room, more than the {100 * allowed:.0f} cm allowed")
    numbers = {"clearance": (room, "m"), "movement": (most, "m")}
    capacity = on_floor(need, measure, numbers).parameters["clearance"]
    checks = []
    for f in need.findings:
        demand, used, limit = f.demand or 0.0, f.utilisation or 0.0, f.capacity or 0.0
        passes = f.verdict is Verdict.PASS
        if settled_by_room(f.model):
            judged = judge(demand, f.low or 0.0, f.high or 0.0, capacity)
            passes, used, limit = judged.verdict is Verdict.PASS, judged.utilisation, judged.capacity
        checks.append((f.level, Check(f.model, f.title, demand, f.unit, limit, used, passes, f.demand)))
    return Proposal((Offer(numbers, checks=tuple(checks)),))


def rubber_pads(need: Need, bench: Bench, measure: Measure) -> Proposal:  # noqa: ARG001
    """Damp the swing of a painting by rubber pads behind its lower corners."""
    if need.scene.support is not Support.HUNG:
        return refused("it does not hang on a wall")
    if need.scene.parameters["damping"].value >= measure.limit:
        return refused("it has as much damping already")
    numbers = {"damping": (measure.limit, "-")}
    return _one(need, measure, numbers, finish=_movement, mark_of="swing")


def padded(scenes: Sequence[Scene], means: Means) -> list[Scene]:
    """Return those of the scenes that rubber pads would damp, with the pads in place."""
    out = []
    for measure in (measure for measure in means.measures if measure.name == "rubber_pads"):
        hung = [scene for scene in scenes if scene.support is Support.HUNG and "damping" in scene.parameters]
        damped = {"damping": measure.limit}
        out += [changed(s, measure.name, damped) for s in hung if s.parameters["damping"].value < measure.limit]
    return out


def surface(need: Need, bench: Bench, measure: Measure) -> Proposal:  # noqa: ARG001
    """Put it on the least rough surface of Table 3 that is rougher than its own and holds its base well enough."""
    refusal = _needs_grip(need)
    if refusal:
        return refusal
    item = need.scene.item
    material = (item.base_material or material_of(item)["friction_as"]).strip().lower()
    least = need.scene.parameters["friction_static"].low
    pairs = [
        (number(row, "low", "friction.csv"), row["surface_material"])
        for row in table("friction")
        if row["object_material"].lower() == material
    ]
    rougher = sorted(pair for pair in pairs if least < pair[0] <= measure.limit)
    offers = []
    for friction, name in rougher:
        numbers = {"friction": (friction, "-")}
        trial = Trial(on_floor(need, measure, numbers))
        words = {"surface": name.lower()}
        offers.append(Offer(numbers, (trial,), words=words, finish=_movement, mark_of="sliding"))
    if not offers:
        return refused("Table 3 has no rougher surface for the material of its base")
    return Proposal(tuple(offers))


def grip_pad(need: Need, bench: Bench, measure: Measure) -> Proposal:  # noqa: ARG001
    """Put it on a rougher surface; it must not rock there."""
    refusal = _needs_grip(need)
    if refusal:
        return refusal
    return _one(need, measure, {"friction": (measure.limit, "-")}, finish=_movement, mark_of="sliding")


def _needs_grip(need: Need) -> Proposal | None:
    if need.scene.support is not Support.FREESTANDING:
        return FREE
    if any(f.model == "rocking" and f.verdict is not Verdict.PASS for f in need.findings):
        return refused("it may rock: a surface that holds it does not keep it upright")
    return None


def wax(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Hold it by museum wax: it neither rocks nor slides while the wax holds, and its section bears the push."""
    scene = need.scene
    if scene.support is not Support.FREESTANDING:
        return FREE
    if not knows_section(scene) or not {"half_width", "cg_height"} <= set(scene.parameters):
        return UNKNOWN_SECTION
    held_up_to = strengths("museum wax")["acceleration"].low
    if bench.push > held_up_to:
        return refused(f"wax is known to hold up to {held_up_to / G:.2g} g; the shaking is {bench.push / G:.2g} g")
    area, room = up(wax_area(scene, bench), 1e-5), measure.limit * footing(scene)
    if area > room:
        return refused(f"it would need {1e4 * area:.3g} cm2 of wax; its footing has room for {1e4 * room:.3g} cm2")
    numbers = {"area": (area, "m2")}
    finish = partial(_holds, scene, bench)
    checks = tuple(("", check) for check in wax_checks(scene, bench, area))
    return _one(need, measure, numbers, finish=finish, checks=checks)


def ballast(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Lower its centre of gravity by ballast: as much as the push asks for, run again with all that is uncertain."""
    scene = need.scene
    if scene.support is not Support.FREESTANDING:
        return FREE
    if not {"half_width", "cg_height", "mass"} <= set(scene.parameters):
        return refused("its base, its mass or its centre of gravity is not known")
    if not _rocks(need):
        return refused("it does not rock: a lower centre of gravity does not help")
    if measure.classes and scene.object_class not in measure.classes:
        return refused("objects of its kind have no room for ballast")
    mass, cg, half = (scene.parameters[name] for name in ("mass", "cg_height", "half_width"))
    at = measure.limit_high * cg.value
    # At the worst of what is uncertain: the heaviest and highest body, and the least height that may be left.
    left = half.low / bench.lift
    if left <= at:
        return refused("no ballast brings its centre of gravity low enough")
    needed = SPARE * mass.high * (cg.high - left) / (left - at)
    share = needed / mass.value
    if share > measure.limit:
        return refused(f"it would need {100 * share:.0f} % of its mass; {100 * measure.limit:.0f} % is allowed")
    numbers = {"mass": (max(needed, 0.0), "kg"), "height": (at, "m")}
    lowered = on_floor(need, measure, numbers)
    numbers["cg_height"] = (lowered.parameters["cg_height"].value, "m")
    return Proposal((Offer(numbers, (Trial(lowered),), mark_of="rocking"),))


def wide_base(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Fix it to a footing plate so wide that it does not rock, with the room that it slides in around the plate.

    Its critical section bears the push, as that of a clamped object does.
    """
    scene = need.scene
    if scene.support is not Support.FREESTANDING:
        return FREE
    if not {"half_width", "cg_height"} <= set(scene.parameters):
        return refused("its base or its centre of gravity is not known")
    if not _rocks(need):
        return refused("it does not rock: a wider base does not help")
    if not knows_section(scene):
        return UNKNOWN_SECTION
    half = scene.parameters["half_width"]
    width = up(SPARE * 2.0 * bench.lift * scene.parameters["cg_height"].high)
    allowed = 2.0 * measure.limit * half.value
    if width > allowed:
        return refused(f"it would need a plate {100 * width:.0f} cm wide; {100 * allowed:.0f} cm is allowed")
    room = up(MARGIN * max((f.high or 0.0 for f in need.findings if settled_by_room(f.model)), default=0.0))
    if room > measure.limit_high:
        least = f"the {100 * measure.limit_high:.0f} cm allowed"
        return refused(f"it would need {100 * room:.0f} cm of room around its plate, more than {least}")
    numbers = {"width": (width, "m"), "clearance": (room, "m")}
    return _one(need, measure, numbers, finish=partial(_holds, scene, bench), mark_of="rocking")


def fasten(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Clamp it at its base: it neither rocks nor slides, and its critical section must bear the push."""
    if need.scene.support is not Support.FREESTANDING:
        return FREE
    if not knows_section(need.scene):
        return UNKNOWN_SECTION
    return _one(need, measure, {}, finish=partial(_holds, need.scene, bench))


def restrain(need: Need, bench: Bench, measure: Measure) -> Proposal:  # noqa: ARG001
    """Fix a hung object to the wall as well: nothing is left that swings; the fixings bear the push."""
    scene = need.scene
    if scene.support is not Support.HUNG:
        return refused("it does not hang on a wall")
    mass = scene.parameters.get("mass")
    if mass is None:
        return refused("its mass is not known, so the force on the fixings cannot be given")
    checks = tuple(
        (f.level, Check("swing", f.title, 0.0, f.unit, f.capacity or 0.0, 0.0, True, f.demand))
        for f in need.findings
        if f.model == "swing"
    )
    trials = (Trial(held(scene)),) if knows_section(scene) else ()
    return Proposal((Offer({"force": (mass.high * bench.push, "N")}, trials, checks=checks),))


def low_friction_pad(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Let it slide; first it must not rock, whatever the friction (paper, 2.6)."""
    scene = need.scene
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return refused("it does not stand")
    if not {"half_width", "cg_height"} <= set(scene.parameters):
        return refused("whether it rocks is not known")
    half, cg = scene.parameters["half_width"], scene.parameters["cg_height"]
    if bench.lift > half.low / cg.high:
        return refused("it may rock: a low friction never excuses that")
    upright = replace(scene, support=Support.FREESTANDING, models=("rocking",))
    offers = []
    for carried in bench.carried("friction_isolator"):
        pad = carried.isolator
        room = up(MARGIN * carried.stroke)
        if room > min(measure.limit, pad.stroke):
            continue
        numbers = {"friction": (pad.friction, "-"), "clearance": (room, "m"), "movement": (carried.stroke, "m")}
        trials = [Trial(upright), Trial(on_floor(need, measure, numbers))]
        if knows_section(scene):
            trials.append(Trial(held(scene), carried))
        marks = {level: ("sliding", pad.friction, moved) for level, moved in carried.strokes.items()}
        offers.append(Offer(numbers, tuple(trials), marks=marks))
    if not offers:
        return refused("no low-friction pad keeps to the room that there is")
    return Proposal(tuple(offers))


def rotational_isolator(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Mount it on an elastomeric pad that lets it turn a little and spares its base.

    The stress is that of a rigid body under the acceleration of its centre of gravity on the pad.
    """
    scene = need.scene
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return refused("it does not stand")
    if not knows_section(scene) or "cg_height" not in scene.parameters:
        return UNKNOWN_SECTION
    if STRESS.applies(held(scene)):
        return refused("it is flexible itself: no model has a flexible object on a pad that turns")
    offers = []
    for pad in bench.means.of("rotational_isolator"):
        numbers = _turning_numbers(pad, measure)
        turning = on_floor(need, measure, numbers)
        rotation, share = bench.on_pad(pad, _bodies(turning))
        numbers |= {"rotation": (rotation, "rad"), "acceleration": (share * bench.push, "m/s2")}
        cg = scene.parameters["cg_height"]
        amplified = replace(cg, value=share, low=share, high=share, unit="-", note="on its pad")
        bent = held(scene)
        bent = replace(bent, models=("stress",), parameters={**bent.parameters, "amplification": amplified})
        offers.append(Offer(numbers, (Trial(turning), Trial(bent))))
    if not offers:
        return refused("the catalogue has no rotational isolator")
    return Proposal(tuple(offers), "on none of the pads does it turn and bend little enough")


def _turning_numbers(pad: Isolator, measure: Measure) -> dict[str, tuple[float, str]]:
    return {
        "frequency": (pad.frequency, "Hz"),
        "damping": (pad.damping, "-"),
        "rotation_limit": (measure.limit, "rad"),
    }


def turn_together(needs: Sequence[Need], bench: Bench, measure: Measure) -> None:
    """Run all objects that a rotational isolator will be proposed for on its pads at once."""
    for pad in bench.means.of("rotational_isolator"):
        numbers, objects = _turning_numbers(pad, measure), []
        for need in needs:
            scene = need.scene
            stands = scene.support in (Support.FREESTANDING, Support.FASTENED)
            if stands and knows_section(scene) and "cg_height" in scene.parameters and not STRESS.applies(held(scene)):
                objects.append(_bodies(on_floor(need, measure, numbers)))
        bench.on_pads(pad, objects)


def _bodies(turning: Scene) -> Bodies:
    """Return the best estimates of an object on a pad, and all ends of what is uncertain."""
    cg, ratio = turning.parameters["cg_height"], turning.parameters["inertia_ratio"]
    return (cg.value, ratio.value), *product((cg.low, cg.high), (ratio.low, ratio.high))


def strengthen(need: Need, bench: Bench, measure: Measure) -> Proposal:
    """Make its critical section thicker, as much as the push asks for, and hold it at its base."""
    scene = need.scene
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return refused("it does not stand")
    if not knows_section(scene):
        return UNKNOWN_SECTION
    mass, area, modulus, allowed = (
        scene.parameters[name] for name in ("mass", "area", "section_modulus", "allowable_stress")
    )
    (now,) = bench.run([Trial(held(scene))])
    # Held as it is, its tension and self-weight make up the bending, which falls with the cube of the size.
    tension = max(f.high or 0.0 for f in now)
    weight = mass.high * G / area.value
    times = up(SPARE * (max(tension + weight, 0.0) / allowed.low) ** (1.0 / 3.0)) if allowed.low > 0.0 else inf
    if times <= 1.0:
        return refused("its critical section is strong enough as it is")
    if times > measure.limit:
        return refused(f"its section would have to be {times:.2g} times as large; {measure.limit:g} is allowed")
    numbers = {"enlargement": (times, "-"), "section_modulus": (times**3 * modulus.value, "m3")}
    return _one(need, measure, numbers, finish=partial(_holds, scene, bench))


def remove(need: Need, bench: Bench, measure: Measure) -> Proposal:  # noqa: ARG001
    """Take it off display."""
    return Proposal((Offer({}),))


def _rocks(need: Need) -> bool:
    return any(f.model == "rocking" and f.verdict is not Verdict.PASS for f in need.findings)


def _movement(findings: Sequence[Finding]) -> Numbers:
    moves = [f for f in findings if settled_by_room(f.model)]
    return {"movement": (max((f.high or 0.0 for f in moves), default=0.0), "m")}


def _holds(scene: Scene, bench: Bench, findings: Sequence[Finding]) -> Numbers:
    force, moment = force_and_moment(scene, bench, findings)
    return {"force": (force, "N"), "moment": (moment, "N m")}


def _one(
    need: Need,
    measure: Measure,
    numbers: Numbers,
    *,
    finish: Callable[[Sequence[Finding]], Numbers],
    checks: tuple[tuple[str, Check], ...] = (),
    mark_of: str = "",
) -> Proposal:
    trial = Trial(on_floor(need, measure, numbers))
    return Proposal((Offer(numbers, (trial,), checks=checks, finish=finish, mark_of=mark_of),))


MEASURES: Mapping[str, Propose] = {
    "clearance": keep_clear,
    "rubber_pads": rubber_pads,
    "surface": surface,
    "grip_pad": grip_pad,
    "wax": wax,
    "ballast": ballast,
    "wide_base": wide_base,
    "fasten": fasten,
    "restrain": restrain,
    "friction_isolator": low_friction_pad,
    "rotational_isolator": rotational_isolator,
    "strengthen": strengthen,
    "remove": remove,
}
"""What each row of measures.csv that acts on one object proposes."""

TOGETHER: Mapping[str, Callable[[Sequence[Need], Bench, Measure], None]] = {"rotational_isolator": turn_together}
"""What is run for all objects at once, before each of them is proposed something: the proposals find it done."""
