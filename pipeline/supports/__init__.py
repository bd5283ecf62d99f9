"""Supports: what stands between the floor and an object, a filter from a motion to a motion."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.rotational_isolator import ROTATIONAL_ISOLATOR
from pipeline.quantities import Array
from pipeline.records import Excitation, Model, Motion


@dataclass(frozen=True)
class SupportModel:
    """A support: the model of its own demand, and how it passes a motion on."""

    name: str
    model: Model
    transmit: Callable[[Motion, Mapping[str, float], int], Motion]


def resampled(motion: Motion, refine: int) -> Motion:
    """Return the same polygon with ``refine`` samples for each of its own: the excitation does not change.

    raises : ValueError for a refinement below 1
    """
    if refine < 1:
        raise ValueError(f"refine must be at least 1, not {refine}")
    if refine == 1 or motion.samples < 2:
        return motion
    n = (motion.samples - 1) * refine + 1
    fine = np.arange(n) / refine
    grid = np.arange(motion.samples)
    rows: Array = np.vstack([np.interp(fine, grid, row) for row in motion.acceleration])
    return Motion(motion.dt / refine, rows, motion.name, motion.steps, motion.source, motion.start, motion.v_max)


AFTER = 60.0
"""Seconds after the record for which the free motion of a support is passed on, at most."""

QUIET = 1e-6
"""Share of the largest acceleration passed on below which the free motion is left out."""


def _passed_on(motion: Motion, model: Model, parameters: Mapping[str, float], two: bool, refine: int) -> Motion:
    record = resampled(motion, refine)
    x, y = _felt(model, record, parameters, two)
    size = np.hypot(x, y)
    loud = np.flatnonzero(size[record.samples :] > QUIET * float(size.max()))
    end = record.samples + (int(loud[-1]) + 2 if loud.size else 0)
    z = np.concatenate([record.acceleration[2], np.zeros(x.size - record.samples)])
    step = f"passed on by {_described(model, parameters)}"
    rows = np.vstack([x, y, z])[:, :end]
    return Motion(record.dt, rows, motion.name, (*motion.steps, step), motion.source)


def _felt(model: Model, motion: Motion, parameters: Mapping[str, float], two: bool) -> tuple[Array, Array]:
    if model.trace is None:
        raise ValueError(f"{model.name} passes no motion on")
    x, y, z = motion.acceleration
    if two:
        columns = model.trace(Excitation(motion.dt, x, y, z, AFTER), parameters)
        return columns["a_x"], columns["a_y"]
    ways = [model.trace(Excitation(motion.dt, way, None, z, AFTER), parameters)["a_x"] for way in (x, y)]
    return ways[0], ways[1]


def _described(model: Model, parameters: Mapping[str, float]) -> str:
    known = ", ".join(f"{k} {v:.4g}" for k, v in parameters.items() if not np.isnan(v))
    return f"a {model.title.lower()} ({known})"


def _in_plane(model: Model) -> Callable[[Motion, Mapping[str, float], int], Motion]:
    return lambda motion, parameters, refine: _passed_on(motion, model, parameters, True, refine)


def _each_way(model: Model) -> Callable[[Motion, Mapping[str, float], int], Motion]:
    return lambda motion, parameters, refine: _passed_on(motion, model, parameters, False, refine)


SUPPORTS: tuple[SupportModel, ...] = (
    SupportModel("friction_isolator", FRICTION_ISOLATOR, _in_plane(FRICTION_ISOLATOR)),
    SupportModel("horizontal_isolator", HORIZONTAL_ISOLATOR, _in_plane(HORIZONTAL_ISOLATOR)),
    SupportModel("rotational_isolator", ROTATIONAL_ISOLATOR, _each_way(ROTATIONAL_ISOLATOR)),
    SupportModel("plinth", OSCILLATOR, _each_way(OSCILLATOR)),
)


def support_named(name: str) -> SupportModel:
    """Return the support of that name.

    raises : ValueError naming the supports there are
    """
    for support in SUPPORTS:
        if support.name == name:
            return support
    raise ValueError(f"there is no support {name!r}; the supports are: {', '.join(s.name for s in SUPPORTS)}")
