"""Rocking and two-directional sliding beside MuJoCo, an engine of rigid bodies with soft contacts.

Its own compiled loop (`rollout`) runs the record; the base's acceleration is a force on the body's slides.
"""

from collections.abc import Sequence
from types import ModuleType

import numpy as np

from pipeline.quantities import Array, G
from pipeline.records import Excitation
from tests.benchmarks.common import Comparison, Ours, clocked, strong
from tests.benchmarks.peers import peer

SETTINGS = (
    (1, "0.02", "as it comes, dt"),
    (4, "0.005", "stiff contacts, dt/4"),
    (10, "0.002", "stiff contacts, dt/10"),
)
"""Steps in each of the record's, the contacts' time constant [s] (two steps is the least allowed), and their name."""

HALF_WIDTH = np.array([0.08, 0.1, 0.12, 0.15, 0.2, 0.25, 0.06, 0.3])
CG_HEIGHT = np.array([0.35, 0.5, 0.4, 0.6, 0.8, 0.7, 0.2, 1.0])
FRICTION = np.array([0.1, 0.12, 0.15, 0.18, 0.2, 0.25])

HINGE = '<joint type="hinge" axis="0 1 0"/>'
SLIDES = ("1 0 0", "0 1 0", "0 0 1")


def comparisons() -> list[Comparison]:
    """Compare rocking and sliding under all components; none where MuJoCo is missing."""
    mujoco = peer("mujoco")
    return [] if mujoco is None else [*_rocking(mujoco), *_sliding(mujoco)]


def _rocking(mujoco: ModuleType) -> list[Comparison]:
    motion = strong(1)
    ours = Ours("rocking", motion, half_width=HALF_WIDTH, cg_height=CG_HEIGHT)
    alpha = np.arctan2(HALF_WIDTH, CG_HEIGHT)
    fell = ours.outputs("reference")["overturned"] > 0.0
    rows = []
    for fine, contact, setting in SETTINGS:
        runs = []
        for b, h, a in zip(HALF_WIDTH, CG_HEIGHT, alpha, strict=True):
            # Friction enough that the body cannot slide, as in our model.
            body = _model(mujoco, motion.dt / fine, (b, b, h), (0, 2), HINGE, 10.0, contact)
            path, seconds = _run(mujoco, body, _forces(motion, fine, (motion.x, motion.z)))
            runs.append((float(np.abs(path[:, 2]).max()) / a, seconds))
        # A body that fell lies on its side, a quarter turn from where it stood; soft contacts let it sink in a little.
        theirs = np.array([ratio for ratio, _ in runs]) * alpha > 1.5
        outcomes = int(np.sum(theirs == fell)), fell.size
        rows.append(ours.beside("rocking", f"MuJoCo, {setting}", runs, 500.0, counted=~fell, outcomes=outcomes))
    return rows


def _sliding(mujoco: ModuleType) -> list[Comparison]:
    motion = strong(2)
    ours = Ours("sliding", motion, friction_static=FRICTION)
    rows = []
    for fine, contact, setting in SETTINGS:
        runs = []
        for mu in FRICTION:
            body = _model(mujoco, motion.dt / fine, (0.2, 0.2, 0.05), (0, 1, 2), "", mu, contact)
            path, seconds = _run(mujoco, body, _forces(motion, fine, (motion.x, motion.y, motion.z)))
            runs.append((float(np.hypot(path[:, 0], path[:, 1]).max()), seconds))
        rows.append(ours.beside("sliding 2-D", f"MuJoCo, {setting}", runs))
    return rows


def _model(
    mujoco: ModuleType,
    dt: float,
    half: tuple[float, float, float],
    slides: tuple[int, ...],
    hinge: str,
    mu: float,
    contact: str,
) -> object:
    joints = "".join(f'<joint type="slide" axis="{SLIDES[k]}"/>' for k in slides) + hinge
    surface = f'friction="{mu}" solref="{contact} 1"'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{dt}" gravity="0 0 {-G}" cone="elliptic" impratio="10"/><worldbody>'
        f'<geom type="plane" size="50 50 1" {surface}/><body pos="0 0 {half[2]}">{joints}'
        f'<geom type="box" size="{half[0]} {half[1]} {half[2]}" mass="1" {surface}/></body></worldbody></mujoco>'
    )


def _forces(motion: Excitation, fine: int, components: Sequence[Array]) -> Array:
    """Return the forces (steps, 3) N of the base's acceleration on a unit mass, one a slide, and none on a hinge."""
    samples = motion.dt * np.arange(motion.x.size)
    times = motion.dt / fine * np.arange((motion.x.size - 1) * fine)
    forces = np.zeros((times.size, 3))
    for k, a in enumerate(components):
        forces[:, k] = -np.interp(times, samples, a)
    return forces


def _run(mujoco: ModuleType, model: object, forces: Array) -> tuple[Array, float]:
    """Return the joints' positions (steps, 3) and the seconds of the integration."""
    from mujoco import rollout

    data = mujoco.MjData(model)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    begin = np.empty(mujoco.mj_stateSize(model, full))
    mujoco.mj_getState(model, data, begin, full)
    control = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
    (states, _), seconds = clocked(lambda: rollout.rollout(model, data, begin, forces[None], control_spec=control))
    return states[0, :, 1:4], seconds
