"""Supports: what stands between the floor and an object, a filter from a motion to a motion."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.rotational_isolator import ROTATIONAL_ISOLATOR
from pipeline.quantities import Array, Quantity
from pipeline.records import Excitation, Model, Motion
from pipeline.supports.floor import carried
from pipeline.supports.polygon import conserving, resampled
from pipeline.supports.refining import refined

__all__ = ["SUPPORTS", "SupportModel", "refined", "resampled", "support_named"]


@dataclass(frozen=True)
class SupportModel:
    """A support: its parameters, how it passes a motion on, and the model of its own demand (None: it has none).

    transmit : motion, parameters, and the samples of the output for each of the input
    refines  : whether it heeds the third; one that does not chooses its own step
    """

    name: str
    needs: tuple[Quantity, ...]
    transmit: Callable[[Motion, Mapping[str, float], int], Motion]
    model: Model | None = None
    refines: bool = True


AFTER = 60.0
"""Seconds after the record for which the free motion of a support is passed on, at most."""

QUIET = 1e-6
"""Share of the largest acceleration passed on below which the free motion is left out."""


def _passed_on(motion: Motion, model: Model, parameters: Mapping[str, float], two: bool, refine: int) -> Motion:
    record = resampled(motion, refine)
    ways = _histories(model, record, parameters, two)
    size = np.hypot(*(felt for _, felt in ways))
    loud = np.flatnonzero(size[record.samples :] > QUIET * float(size.max()))
    end = min(record.samples + (int(loud[-1]) + 2 if loud.size else 0), size.size - 1)
    rows = np.zeros((3, end))
    for row, (moved, felt) in enumerate(ways):
        rows[row] = conserving(record.acceleration[row], felt[:end], moved[: end + 1], record.dt)
    rows[2, : record.samples] = record.acceleration[2]
    each = "one sample" if refine == 1 else f"{refine} samples"
    step = f"passed on by {_described(model, parameters)}, {each} for each of its input"
    return Motion(record.dt, rows, motion.name, (*motion.steps, step), motion.source)


def _histories(model: Model, motion: Motion, parameters: Mapping[str, float], two: bool) -> list[tuple[Array, Array]]:
    # Relative displacement and absolute acceleration along x and along y.
    if model.trace is None:
        raise ValueError(f"{model.name} passes no motion on")
    x, y, z = motion.acceleration
    if two:
        columns = model.trace(Excitation(motion.dt, x, y, z, AFTER), parameters)
        return [(columns["u_x"], columns["a_x"]), (columns["u_y"], columns["a_y"])]
    each = [model.trace(Excitation(motion.dt, way, None, z, AFTER), parameters) for way in (x, y)]
    return [(columns["u_x"], columns["a_x"]) for columns in each]


def _described(model: Model, parameters: Mapping[str, float]) -> str:
    known = ", ".join(f"{k} {v:.4g}" for k, v in parameters.items() if not np.isnan(v))
    return f"a {model.title.lower()} ({known})"


def _in_plane(name: str, model: Model) -> SupportModel:
    return SupportModel(
        name, model.needs, lambda motion, values, refine: _passed_on(motion, model, values, True, refine), model
    )


def _each_way(name: str, model: Model) -> SupportModel:
    return SupportModel(
        name, model.needs, lambda motion, values, refine: _passed_on(motion, model, values, False, refine), model
    )


def _floor(motion: Motion, values: Mapping[str, float], refine: int) -> Motion:  # noqa: ARG001
    # It chooses its own step: a factor needs none, and modes know their own periods.
    given = {name: value for name, value in values.items() if not np.isnan(value)}
    modes = int(given.pop("modes")) if "modes" in given else None
    return carried(motion, **given, modes=modes)


FLOOR = (
    Quantity("height_ratio", "-", "height of the floor over that of the building", 0.0, 1.0),
    Quantity("period", "s", "of the building's first mode", 0.0, exclusive=True, optional=True),
    Quantity("damping", "-", "of every mode, for a floor by its modes", 0.0, 1.0, exclusive=True, optional=True),
    Quantity("stiffness_ratio", "-", "alpha0: 0 bends, above 20 shears", 0.0, 650.0, optional=True),
    Quantity("modes", "count", "how many", 1.0, 30.0, optional=True),
)
"""Parameters of a floor; without the last three it is the factor of ASCE 7-22."""

SUPPORTS: tuple[SupportModel, ...] = (
    _in_plane("friction_isolator", FRICTION_ISOLATOR),
    _in_plane("horizontal_isolator", HORIZONTAL_ISOLATOR),
    _each_way("rotational_isolator", ROTATIONAL_ISOLATOR),
    _each_way("plinth", OSCILLATOR),
    SupportModel("floor", FLOOR, _floor, refines=False),
)


def support_named(name: str) -> SupportModel:
    """Return the support of that name.

    raises : ValueError naming the supports there are
    """
    for support in SUPPORTS:
        if support.name == name:
            return support
    raise ValueError(f"there is no support {name!r}; the supports are: {', '.join(s.name for s in SUPPORTS)}")
