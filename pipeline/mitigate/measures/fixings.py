"""Force and moment that a fixing at the base must hold, and the shares of both that several measures tell."""

from collections.abc import Sequence
from itertools import product

from pipeline.analysis.response import respond
from pipeline.mitigate.proposals import Numbers
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.stress import FLEXIBLE_STRESS
from pipeline.records import Finding, Motion, Scene

HOLDS = ("force", "moment")
"""Numbers of a measure that holds an object at its base."""


def force_and_moment(scene: Scene, runner: TrialRunner, findings: Sequence[Finding]) -> Numbers:
    """Return what a fixing at the base must hold, without the help of the weight.

    Parameters
    ----------
    scene : Scene
        The object as it stands.
    runner : TrialRunner
    findings : sequence of Finding
        Of the object held at its base; a flexible one pushes by its pseudo-acceleration.

    Returns
    -------
    mapping of str to (float, str)
        ``force`` [N] and ``moment`` [N m].

    References
    ----------
    Agbabian et al. (1991), sec. 2.3.
    """
    bends = any(f.model == FLEXIBLE_STRESS.name for f in findings)
    push = max(runner.push, _pseudo_acceleration(scene, runner)) if bends else runner.push
    force = scene.parameters["mass"].high * push
    return {"force": (force, "N"), "moment": (force * scene.parameters["cg_height"].high, "N m")}


def _pseudo_acceleration(scene: Scene, runner: TrialRunner) -> float:
    """Return the largest that its oscillator feels [m/s2], in any direction, at all ends of what is uncertain."""
    f, zeta = scene.parameters["frequency"], scene.parameters["damping"]
    ends = [(f.value, zeta.value), *product((f.low, f.high), (zeta.low, zeta.high))]
    frequencies, dampings = [one for one, _ in ends], [other for _, other in ends]

    def largest(motion: Motion) -> float:
        rows = respond("oscillator", motion, angle=None, frequency=frequencies, damping=dampings)
        return float(rows["pseudo_acceleration"].max())

    return runner.largest(largest)
