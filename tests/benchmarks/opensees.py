"""Sliding, isolator and oscillator beside OpenSeesPy: one zero-length element, Newmark's average acceleration.

Only its analysis is timed, not the building of its model.
"""

import tempfile
import time
from pathlib import Path
from types import ModuleType

import numpy as np

from pipeline.quantities import G
from pipeline.records import Excitation
from tests.benchmarks.common import Comparison, Ours, level
from tests.benchmarks.peers import peer
from tests.benchmarks.truth import oscillator_peak, sliding_peak

SETTINGS = ((1, 1e-4), (10, 1e-6))
"""Steps in each of the record's, and the displacement [m] at which dry friction, an elastic-plastic spring, yields.

A stiffer spring does not converge at the record's own step.
"""

Materials = list[tuple[str, float, float] | tuple[str, float]]


def comparisons() -> list[Comparison]:
    """Compare the three models, in one direction without vertical motion; none where OpenSeesPy is missing."""
    ops = peer("openseespy.opensees")
    return [] if ops is None else [*_sliding(ops), *_isolator(ops), *_oscillator(ops)]


def _sliding(ops: ModuleType) -> list[Comparison]:
    mu = np.array([0.1, 0.12, 0.15, 0.18, 0.2, 0.25])
    motion = level()
    ours = Ours("sliding", motion, friction_static=mu, directions=1.0)
    truth = np.array([sliding_peak(motion.x, motion.dt, m) for m in mu])
    rows = []
    for fine, give in SETTINGS:
        runs = [_run(ops, motion, [("ElasticPP", m * G / give, give)], 0.0, fine) for m in mu]
        name = f"OpenSees ElasticPP, {_step(fine)}, yield {give:.0e} m"
        rows.append(ours.beside("sliding 1-D", name, runs, 500.0, truth))
    return rows


def _isolator(ops: ModuleType) -> list[Comparison]:
    frequency, damping = np.array([0.3, 0.5, 0.8, 1.0, 2.0, 3.0]), 0.02
    friction = np.array([0.05, 0.1, 0.1, 0.15, 0.2, 0.1])
    motion = level()
    ours = Ours("horizontal_isolator", motion, frequency=frequency, damping=damping, friction=friction, directions=1.0)
    # The first output is the acceleration passed on, which OpenSees samples at its steps: compare the stroke.
    truth = ours.outputs("reference")["displacement"]
    rows = []
    for fine, give in SETTINGS:
        runs = []
        for w, mu in zip(2.0 * np.pi * frequency, friction, strict=True):
            materials: Materials = [("Elastic", w**2), ("ElasticPP", mu * G / give, give)]
            runs.append(_run(ops, motion, materials, 2.0 * damping * w, fine))
        name = f"OpenSees ElasticPP, {_step(fine)}, yield {give:.0e} m"
        rows.append(ours.beside("isolator 1-D", name, runs, truth=truth, output="displacement"))
    return rows


def _oscillator(ops: ModuleType) -> list[Comparison]:
    w, damping = 2.0 * np.pi * np.array([0.5, 1.0, 2.0, 5.0, 10.0, 20.0]), 0.05
    motion = level()
    ours = Ours("oscillator", motion, frequency=w / (2.0 * np.pi), damping=damping)
    truth = np.array([oscillator_peak(motion.x, motion.dt, f, damping) for f in w])
    rows = []
    for fine, _ in SETTINGS:
        runs = [_run(ops, motion, [("Elastic", f**2)], 2.0 * damping * f, fine) for f in w]
        rows.append(ours.beside("oscillator", f"OpenSees Elastic, {_step(fine)}", runs, truth=truth))
    return rows


def _step(fine: int) -> str:
    return "dt" if fine == 1 else f"dt/{fine}"


def _run(ops: ModuleType, motion: Excitation, materials: Materials, damping: float, fine: int) -> tuple[float, float]:
    """Return the largest displacement [m] of a unit mass on springs side by side, and the seconds of the analysis."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, 1.0)
    tags = range(1, len(materials) + 1)
    for tag, (kind, *values) in zip(tags, materials, strict=True):
        ops.uniaxialMaterial(kind, tag, *values)
    ops.element("zeroLength", 1, 1, 2, "-mat", *tags, "-dir", *(1 for _ in tags))
    ops.rayleigh(damping, 0.0, 0.0, 0.0)
    ops.timeSeries("Path", 1, "-dt", motion.dt, "-values", *motion.x.tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    with tempfile.TemporaryDirectory() as folder:
        envelope = Path(folder) / "envelope.txt"
        ops.recorder("EnvelopeNode", "-file", str(envelope), "-precision", 16, "-node", 2, "-dof", 1, "disp")
        ops.constraints("Plain")
        ops.numberer("Plain")
        ops.system("BandGeneral")
        if any(kind == "ElasticPP" for kind, *_ in materials):
            ops.test("NormUnbalance", 1e-8, 50)
            ops.algorithm("Newton")
        else:
            ops.algorithm("Linear")
        ops.integrator("Newmark", 0.5, 0.25)
        ops.analysis("Transient")
        start = time.perf_counter()
        failed = ops.analyze((motion.x.size - 1) * fine, motion.dt / fine)
        seconds = time.perf_counter() - start
        ops.wipe()
        if failed:
            raise RuntimeError("OpenSees did not converge")
        return float(np.loadtxt(envelope)[2]), seconds
