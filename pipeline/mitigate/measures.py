"""The measures: each changes the chain of a scene and runs its models again.  Limits and words: tables/measures.csv."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from math import ceil

import numpy as np

from pipeline.classify import MODELS_OF
from pipeline.mitigate.isolators import Isolator, horizontal_isolators, on_pad, rotational_pads
from pipeline.models import model_named
from pipeline.models.common import largest_push, lift_ratios
from pipeline.models.stress import section_stresses
from pipeline.quantities import G
from pipeline.records import Check, Estimate, Executor, Finding, Motion, Origin, Scene, Support, Verdict
from pipeline.response import respond
from pipeline.tables import Row, number, table
from pipeline.verdicts import LevelMotions, judge

DISPLACEMENTS = frozenset({"sliding", "swing", "swing_3d", "friction_isolator"})
"""Models whose failure is a collision: room settles it."""

MARGIN = 1.1
"""Room asked for over the largest demand of the uncertain inputs: the error of the motion is not in it."""


@dataclass(frozen=True)
class Tried:
    """A measure on one scene: what to build, the evidence, and where it lies on a chart; or why it is not enough."""

    parameters: Mapping[str, float]
    units: Mapping[str, str]
    checks: tuple[Check, ...]
    reason: str = ""
    mark: tuple[str, float, float] | None = None

    @property
    def passes(self) -> bool:
        """Whether every model that was run again passes."""
        return not self.reason and all(check.passes for check in self.checks)


def _not(reason: str) -> Tried:
    return Tried({}, {}, (), reason)


class Site:
    """One level of shaking with what all objects share: peaks, lift ratios, isolators; each computed once.

    What is said of the level is combined from its motions as its findings are: the largest, or the mean.
    """

    def __init__(self, level: LevelMotions, executor: Executor) -> None:
        self.level = level
        self._executor = executor
        self._slides: dict[tuple[str, float], float] = {}
        self._swings: dict[tuple[str, float, float], float] = {}

    @cached_property
    def push(self) -> float:
        """A_max [m/s2], resultant."""
        return self.level.combined([largest_push(m.excitation(None)) for m in self.level.motions])

    @cached_property
    def lift(self) -> float:
        """The largest |a_h| / N."""
        return self.level.combined([max(lift_ratios(m.excitation(None))) for m in self.level.motions])

    @cached_property
    def isolators(self) -> list[Isolator]:
        """The horizontal isolators of the catalogue under these motions, gentlest first."""
        return horizontal_isolators(self.level, self._executor)

    def slide(self, friction: float, motions: Sequence[Motion] | None = None) -> float:
        """Return the sliding displacement [m] at a friction, under the motions of the level or those given."""
        under = self.level.motions if motions is None else motions
        key = (under[0].hash, friction)
        if key not in self._slides:
            runs = [respond("sliding", m, friction_static=friction)["displacement"].iloc[0] for m in under]
            self._slides[key] = self.level.combined(runs)
        return self._slides[key]

    def swing(self, model: str, length: float, damping: float) -> float:
        """Return the swing [m] in the worst direction."""
        key = (model, length, damping)
        if key not in self._swings:
            runs = [
                respond(model, m, angle=None, length=length, damping=damping)["displacement"].iloc[0]
                for m in self.level.motions
            ]
            self._swings[key] = self.level.combined(runs)
        return self._swings[key]


@cache
def measures() -> tuple[Row, ...]:
    """Return the rows of measures.csv, least intrusive first."""
    return tuple(sorted(table("measures"), key=lambda row: number(row, "order", "measures.csv")))


def limit(row: Row, hanging: bool = False) -> float:
    """Return the limit of a measure [SI]; hanging objects may have a higher one."""
    column = "limit_high" if hanging and row["limit_high"] else "limit"
    return number(row, column, f"measures.csv, {row['measure']}")


def _check(model: str, title: str, demand: float, unit: str, capacity: Estimate, high: float | None = None) -> Check:
    verdict = judge(demand, demand, demand if high is None else high, capacity)
    return Check(model, title, demand, unit, verdict.capacity, verdict.utilisation, verdict.verdict is Verdict.PASS)


def _exactly(value: float, unit: str) -> Estimate:
    return Estimate(value, unit, Origin.DERIVED, value, value)


def _rocking(scene: Scene, lift: float) -> Check:
    slope = scene.parameters["half_width"].value / scene.parameters["cg_height"].value
    worst = scene.parameters["half_width"].low / scene.parameters["cg_height"].high
    return _check("rocking", "Rocking", lift / slope, "-", _exactly(1.0, "-"), lift / worst)


def _stress(scene: Scene, push: float) -> Check:
    best, high = _tension(scene, push)
    return _check("stress", "Stress", best, "Pa", scene.parameters["allowable_stress"], high)


def _tension(scene: Scene, push: float) -> tuple[float, float]:
    # The tension of the critical section: best estimate, and the highest that its uncertain measures give.
    p = scene.parameters

    def tension(mass: float, lever: float, modulus: float) -> float:
        given = {"mass": mass, "lever": lever, "area": p["area"].value, "section_modulus": modulus}
        return float(section_stresses(np.array([push]), {k: np.array([v]) for k, v in given.items()})["tension"][0])

    best = tension(p["mass"].value, p["lever"].value, p["section_modulus"].value)
    # The same rule as for findings: one uncertain input at a time at its end.
    high = max(
        tension(p["mass"].high, p["lever"].value, p["section_modulus"].value),
        tension(p["mass"].value, p["lever"].high, p["section_modulus"].value),
        tension(p["mass"].value, p["lever"].value, p["section_modulus"].low),
    )
    return best, high


def _knows_section(scene: Scene) -> bool:
    return all(name in scene.parameters for name in ("mass", "lever", "area", "section_modulus", "allowable_stress"))


def _up(value: float) -> float:
    """Round a length up to the next whole centimetre."""
    return ceil(100.0 * value - 1e-9) / 100.0


def keep_clear(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Give it the room that it needs."""
    moving = [f for f in findings if f.model in DISPLACEMENTS and f.high is not None]
    if any(f.verdict is Verdict.FAIL and f.model not in DISPLACEMENTS for f in findings):
        return _not("room does not help: it fails otherwise than by moving")
    if not moving:
        return _not("it does not move")
    demand, high = max(f.demand or 0.0 for f in moving), max(f.high or 0.0 for f in moving)
    room = _up(MARGIN * high)
    hanging = scene.support in (Support.HUNG, Support.SUSPENDED)
    if room > limit(row, hanging):
        return _not(
            f"it would need {100 * room:.0f} cm of room, more than the {100 * limit(row, hanging):.0f} cm allowed"
        )
    checks = tuple(_check(f.model, f.title, f.demand or 0.0, f.unit, _exactly(room, "m"), f.high) for f in moving)
    return Tried({"clearance": room, "movement": demand}, {"clearance": "m", "movement": "m"}, checks)


def rubber_pads(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Damp the swing of a painting by rubber pads behind its lower corners."""
    if scene.support is not Support.HUNG:
        return _not("it does not hang on a wall")
    damping = limit(row)
    length = scene.parameters["length"]
    if scene.parameters["damping"].value >= damping:
        return _not("it has as much damping already")
    swings = [site.swing("swing", value, damping) for value in (length.value, length.low, length.high)]
    check = _check("swing", "Swinging", swings[0], "m", scene.parameters["clearance"], max(swings))
    if not check.passes:
        return _not(f"with damping {damping:g} it still swings {100 * max(swings):.0f} cm")
    mark = ("swing", length.value, swings[0])
    return Tried({"damping": damping, "movement": swings[0]}, {"damping": "-", "movement": "m"}, (check,), mark=mark)


def grip_pad(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:
    """Put it on a rougher surface; it must not rock there."""
    if scene.support is not Support.FREESTANDING:
        return _not("it does not stand free")
    if any(f.model == "rocking" and f.verdict is not Verdict.PASS for f in findings):
        return _not("it may rock: a surface that holds it does not keep it upright")
    friction = limit(row)
    moved = site.slide(friction)
    checks = (
        _rocking(scene, site.lift),
        _check("sliding", "Sliding", moved, "m", scene.parameters["clearance"]),
    )
    if not all(check.passes for check in checks):
        return _not(f"on a friction of {friction:g} it still moves {100 * moved:.0f} cm")
    mark = ("sliding", friction, moved)
    return Tried({"friction": friction, "movement": moved}, {"friction": "-", "movement": "m"}, checks, mark=mark)


def fasten(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Clamp it at its base: it neither rocks nor slides, and its critical section must bear the push."""
    if scene.support is not Support.FREESTANDING:
        return _not("it does not stand free")
    if not _knows_section(scene):
        return _not("its mass or critical section is not known, so the stress of a clamped base cannot be checked")
    check = _stress(scene, site.push)
    if not check.passes:
        worst = _tension(scene, site.push)[1] / scene.parameters["allowable_stress"].low
        sure = f", {check.utilisation:.2g} times by the best estimates" if worst > 1.05 * check.utilisation else ""
        return _not(f"clamped, its critical section may reach {worst:.2g} times what is allowed{sure}")
    force = scene.parameters["mass"].high * site.push
    moment = force * scene.parameters["cg_height"].high
    parameters = {"force": force, "moment": moment}
    return Tried(parameters, {"force": "N", "moment": "N m"}, (check,))


def restrain(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Fix a hung object to the wall as well: nothing is left that swings; the fixings bear the push."""
    if scene.support is not Support.HUNG:
        return _not("it does not hang on a wall")
    mass = scene.parameters.get("mass")
    if mass is None:
        return _not("its mass is not known, so the force on the fixings cannot be given")
    remaining = replace(scene, support=Support.FASTENED, models=MODELS_OF[Support.FASTENED])
    swing = model_named("swing")
    still = swing.applies(remaining)
    if not still:
        return _not("it would still swing")
    force = mass.high * site.push
    check = _check("swing", "Swinging", 0.0, "m", scene.parameters["clearance"])
    return Tried({"force": force}, {"force": "N"}, (check,))


def low_friction_pad(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Let it slide; first it must not rock, whatever the friction (paper, 2.6)."""
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return _not("it does not stand")
    if "half_width" not in scene.parameters or "cg_height" not in scene.parameters:
        return _not("whether it rocks is not known")
    upright = _rocking(scene, site.lift)
    if not upright.passes:
        return _not("it may rock: a low friction never excuses that")
    friction = limit(row)
    moved = site.slide(friction)
    room = _up(MARGIN * moved)
    checks = [upright, _check("friction_isolator", "Friction isolator", moved, "m", _exactly(room, "m"))]
    if _knows_section(scene):
        # It passes on at most friction times the largest normal acceleration.
        down = max(float(np.max(np.maximum(0.0, G + m.acceleration[2]))) for m in site.level.motions)
        checks.append(_stress(scene, min(site.push, friction * down)))
    if not all(check.passes for check in checks):
        return _not("sliding on a low friction it still breaks")
    parameters = {"friction": friction, "clearance": room, "movement": moved}
    units = {"friction": "-", "clearance": "m", "movement": "m"}
    return Tried(parameters, units, tuple(checks), mark=("sliding", friction, moved))


def horizontal_isolator(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Put it on a horizontal isolator: the shortest stroke of the catalogue that keeps it standing and whole.

    It is fastened to the isolator where its section bears that, else it stands free on it and must not rock there.
    """
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return _not("it does not stand")
    if not _knows_section(scene) and "half_width" not in scene.parameters:
        return _not("neither its base nor its critical section is known")
    longest = limit(row)
    best: Tried | None = None
    shortest = np.inf
    for isolator in site.isolators:
        if _up(isolator.stroke * MARGIN) > longest or isolator.stroke >= shortest:
            continue
        stroke = _check("horizontal_isolator", "Isolator stroke", isolator.stroke, "m", _exactly(longest, "m"))
        checks = _on_isolator(scene, isolator, site)
        if stroke.passes and checks:
            shortest = isolator.stroke
            parameters = {
                "frequency": isolator.frequency,
                "friction": isolator.friction,
                "stroke": _up(isolator.stroke * MARGIN),
                "acceleration": isolator.acceleration,
            }
            units = {"frequency": "Hz", "friction": "-", "stroke": "m", "acceleration": "m/s2"}
            mark = ("isolator", isolator.frequency, isolator.acceleration)
            best = Tried(parameters, units, (stroke, *checks), mark=mark)
    return best or _not("no isolator of the catalogue passes on little enough within its stroke")


def _on_isolator(scene: Scene, isolator: Isolator, site: Site) -> tuple[Check, ...]:
    # The models of the object itself, on what comes out of the isolator; nothing where neither way of standing passes.
    if _knows_section(scene):
        held = _stress(scene, isolator.acceleration)
        if held.passes:
            return (held,)
    if "half_width" not in scene.parameters or "friction_static" not in scene.parameters:
        return ()
    upright = _rocking(scene, isolator.lift)
    friction, room = scene.parameters["friction_static"], scene.parameters["clearance"]
    if not upright.passes:
        return ()
    moved = [site.slide(value, isolator.passed) for value in (friction.value, friction.low)]
    slides = _check("sliding", "Sliding", moved[0], "m", room, max(moved))
    return (upright, slides) if slides.passes else ()


def rotational_isolator(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Mount it on an elastomeric pad that lets it turn a little and spares its base."""
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return _not("it does not stand")
    if not _knows_section(scene) or "cg_height" not in scene.parameters:
        return _not("its mass or critical section is not known")
    cg = scene.parameters["cg_height"].value
    half = scene.parameters.get("half_width")
    width = half.value if half is not None else 0.5 * cg
    # A uniform body about the middle of its base: I = m h^2 + m (b^2 + h^2) / 3.
    ratio = 1.0 + (width**2 + cg**2) / (3.0 * cg**2)
    for pad in rotational_pads():
        rotation, acceleration = on_pad(site.level, pad, cg, ratio)
        checks = (
            _check("rotational_isolator", "Turn on its pad", rotation, "rad", _exactly(limit(row), "rad")),
            _stress(scene, acceleration),
        )
        if all(check.passes for check in checks):
            parameters = {"frequency": pad.frequency, "rotation": rotation, "acceleration": acceleration}
            return Tried(parameters, {"frequency": "Hz", "rotation": "rad", "acceleration": "m/s2"}, checks)
    return _not("on none of the pads does it turn and bend little enough")


def remove(scene: Scene, findings: Sequence[Finding], site: Site, row: Row) -> Tried:  # noqa: ARG001
    """Take it off display."""
    return Tried({}, {}, ())
