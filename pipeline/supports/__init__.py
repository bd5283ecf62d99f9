"""Supports: what stands between the floor and an object, a filter from a motion to a motion."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.rotational_isolator import ROTATIONAL_ISOLATOR
from pipeline.quantities import Array
from pipeline.records import Columns, Excitation, Model, Motion


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
    return Motion(motion.dt / refine, rows, motion.name, motion.steps, motion.source)


def _passed_on(motion: Motion, x: Array, y: Array, what: str) -> Motion:
    rows = np.vstack([x, y, motion.acceleration[2]])
    return Motion(motion.dt, rows, motion.name, (*motion.steps, f"passed on by {what}"), motion.source)


def _described(model: Model, parameters: Mapping[str, float]) -> str:
    known = ", ".join(f"{k} {v:.4g}" for k, v in parameters.items() if not np.isnan(v))
    return f"a {model.title.lower()} ({known})"


def _in_plane(model: Model) -> Callable[[Motion, Mapping[str, float], int], Motion]:
    def transmit(motion: Motion, parameters: Mapping[str, float], refine: int) -> Motion:
        fine = resampled(motion, refine)
        x, y, z = fine.acceleration
        columns = _trace(model, Excitation(fine.dt, x, y, z, 0.0), parameters)
        return _passed_on(fine, columns["a_x"], columns["a_y"], _described(model, parameters))

    return transmit


def _each_way(model: Model) -> Callable[[Motion, Mapping[str, float], int], Motion]:
    def transmit(motion: Motion, parameters: Mapping[str, float], refine: int) -> Motion:
        fine = resampled(motion, refine)
        x, y, z = fine.acceleration
        ways = [_trace(model, Excitation(fine.dt, way, None, z, 0.0), parameters)["a_x"] for way in (x, y)]
        return _passed_on(fine, ways[0], ways[1], _described(model, parameters))

    return transmit


def _trace(model: Model, motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    if model.trace is None:
        raise ValueError(f"{model.name} passes no motion on")
    return model.trace(motion, parameters)


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
