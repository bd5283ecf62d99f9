"""What each isolator of the catalogue does under the site's motions: run once, used by all that may stand on it."""

from dataclasses import dataclass
from typing import Any

from pipeline.models.common import largest_push, lift_ratios
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.records import Executor, Motion
from pipeline.response import prepare, respond, transmit
from pipeline.tables import number, table
from pipeline.verdicts import LevelMotions

PASSED = 0.03
"""Error that the sampling of what an isolator passes on may bring to an oscillator of 20 Hz on it.

What stands on it slides at most 0.5 % off then, and is lifted 0.3 % off; 1e-3 would take eight times as long.
"""


@dataclass(frozen=True)
class Isolator:
    """A row of the catalogue with its own demand under the motions of a level.

    stroke       : m, its largest displacement
    acceleration : m/s2, the largest horizontal acceleration passed on
    lift         : -, the largest |a_h| / N passed on: what an object's slope b/h is held against
    passed       : the motions that it passes on; the others are combined from them as the level says
    """

    frequency: float
    damping: float
    friction: float
    source: str
    stroke: float
    acceleration: float
    lift: float
    passed: tuple[Motion, ...]


@dataclass(frozen=True)
class _Trial:
    frequency: float
    damping: float
    friction: float
    source: str
    level: LevelMotions


def _run(trial: _Trial) -> Isolator:
    given: dict[str, Any] = {"frequency": trial.frequency, "damping": trial.damping, "friction": trial.friction}
    strokes, accelerations, lifts, passed_on = [], [], [], []
    for motion in trial.level.motions:
        # One pass without an error estimate: the trials only rank, and the room asked for has a margin of its own.
        own = HORIZONTAL_ISOLATOR.run(motion.excitation(None), prepare(HORIZONTAL_ISOLATOR, given), 2, False)
        passed = transmit("horizontal_isolator", motion, error=PASSED, **given)
        passed_on.append(passed)
        shaken = passed.excitation(None)
        strokes.append(float(own["displacement"][0]))
        accelerations.append(max(float(own["acceleration"][0]), largest_push(shaken)))
        lifts.append(max(lift_ratios(shaken)))
    stroke, acceleration, lift = (trial.level.combined(each) for each in (strokes, accelerations, lifts))
    return Isolator(
        trial.frequency, trial.damping, trial.friction, trial.source, stroke, acceleration, lift, tuple(passed_on)
    )


def horizontal_isolators(level: LevelMotions, executor: Executor) -> list[Isolator]:
    """Run every horizontal isolator of tables/isolators.csv under every motion of a level, gentlest first."""
    trials = [
        _Trial(
            number(row, "frequency", "isolators.csv"),
            number(row, "damping", "isolators.csv"),
            number(row, "friction", "isolators.csv"),
            row["source"],
            level,
        )
        for row in table("isolators")
        if row["kind"] == "horizontal_isolator"
    ]
    return sorted(executor.map(_run, trials), key=lambda i: i.acceleration)


@dataclass(frozen=True)
class Pad:
    """A rotational isolator of the catalogue."""

    frequency: float
    damping: float
    source: str


def rotational_pads() -> list[Pad]:
    """Return the rotational isolators of tables/isolators.csv, in their order."""
    return [
        Pad(number(row, "frequency", "isolators.csv"), number(row, "damping", "isolators.csv"), row["source"])
        for row in table("isolators")
        if row["kind"] == "rotational_isolator"
    ]


def on_pad(level: LevelMotions, pad: Pad, cg_height: float, inertia_ratio: float) -> tuple[float, float]:
    """Return rotation [rad] and acceleration of the centre of gravity [m/s2] of an object on a pad."""
    rotations, accelerations = [], []
    for motion in level.motions:
        row = respond(
            "rotational_isolator",
            motion,
            angle=None,
            azimuth_step=30.0,
            frequency=pad.frequency,
            damping=pad.damping,
            cg_height=cg_height,
            inertia_ratio=inertia_ratio,
        )
        rotations.append(float(row["rotation"].iloc[0]))
        accelerations.append(float(row["acceleration"].iloc[0]))
    return level.combined(rotations), level.combined(accelerations)
