"""Supports: what stands between the floor and an object, a filter from a motion to a motion."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from pipeline.errors import InputError
from pipeline.models.friction_isolator import FRICTION_ISOLATOR
from pipeline.models.horizontal_isolator import HORIZONTAL_ISOLATOR
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.rotational_isolator import ROTATIONAL_ISOLATOR
from pipeline.quantities import Array, G, Quantity
from pipeline.records import Excitation, Model, Motion
from pipeline.supports.floor import carried
from pipeline.supports.refining import TRANSMITTED, conserving, refined, resampled

__all__ = ["SUPPORTS", "TRANSMITTED", "SupportModel", "refined", "resampled", "support_named"]


@dataclass(frozen=True)
class SupportModel:
    """A support: its parameters, how it passes a motion on, and the model of its own demand.

    Attributes
    ----------
    name : str
        As it is asked for.
    needs : tuple of Quantity
        Its parameters, with their units.
    transmit : callable
        (motion, parameters in SI, samples of the output for each of the input) -> the motion passed on.
    model : Model or None
        Of its own demand; None: it has none.
    refines : callable
        parameters -> whether more samples make the output more accurate; False: it is exact.
    """

    name: str
    needs: tuple[Quantity, ...]
    transmit: Callable[[Motion, Mapping[str, float], int], Motion]
    model: Model | None = None
    refines: Callable[[Mapping[str, float]], bool] = lambda _: True


AFTER = (4.0, 16.0, 60.0)
"""Seconds after the record for which the free motion of a support is passed on: the first by which it is quiet."""

QUIET = 1e-6
"""Share of the largest acceleration passed on below which the free motion is left out."""


def _passed_on(motion: Motion, model: Model, parameters: Mapping[str, float], two: bool, refine: int) -> Motion:
    record = resampled(motion, refine)
    for after in AFTER:
        felt, moved = _histories(model, record, parameters, two, after)
        size = np.sqrt((felt**2).sum(axis=0))
        loud = np.flatnonzero(size[record.samples :] > QUIET * float(size.max()))
        # It comes to rest within the step after the last loud sample; what is passed on ends one sample of rest later.
        end = record.samples + (int(loud[-1]) + 3 if loud.size else 0)
        if end < size.size:
            break
    end = min(end, size.size - 1)
    z = np.zeros(end)
    z[: record.samples] = record.acceleration[2]
    rows = conserving(record.acceleration[:2], felt[:, :end], moved[:, : end + 1], G + z, record.dt)
    each = "one sample" if refine == 1 else f"{refine} samples"
    step = f"passed on by {_described(model, parameters)}, {each} for each of its input"
    return Motion(record.dt, np.vstack([rows, z]), motion.name, (*motion.steps, step), motion.source)


def _histories(
    model: Model, motion: Motion, parameters: Mapping[str, float], two: bool, after: float
) -> tuple[Array, Array]:
    # Absolute acceleration and relative displacement along x and y, (2, m) each.
    if model.trace is None:
        raise ValueError(f"{model.name} passes no motion on")
    x, y, z = motion.acceleration
    if two:
        columns = model.trace(Excitation(motion.dt, x, y, z, after), parameters)
        return np.vstack([columns["a_x"], columns["a_y"]]), np.vstack([columns["u_x"], columns["u_y"]])
    each = [model.trace(Excitation(motion.dt, way, None, z, after), parameters) for way in (x, y)]
    return np.vstack([columns["a_x"] for columns in each]), np.vstack([columns["u_x"] for columns in each])


def _described(model: Model, parameters: Mapping[str, float]) -> str:
    known = ", ".join(f"{k} {v:.4g}" for k, v in parameters.items() if not np.isnan(v))
    title = model.title.lower()
    return f"{'an' if title[0] in 'aeiou' else 'a'} {title} ({known})"


def _in_plane(name: str, model: Model) -> SupportModel:
    return SupportModel(
        name, model.needs, lambda motion, values, refine: _passed_on(motion, model, values, True, refine), model
    )


def _each_way(name: str, model: Model) -> SupportModel:
    return SupportModel(
        name, model.needs, lambda motion, values, refine: _passed_on(motion, model, values, False, refine), model
    )


def _floor(motion: Motion, values: Mapping[str, float], refine: int) -> Motion:
    given = {name: value for name, value in values.items() if not np.isnan(value)}
    modes = int(given.pop("modes")) if "modes" in given else None
    return carried(motion, **given, modes=modes, refine=refine)


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
    SupportModel("floor", FLOOR, _floor, refines=lambda values: not np.isnan(values["modes"])),
)


def support_named(name: str) -> SupportModel:
    """Return the support of that name.

    Parameters
    ----------
    name : str
        One of those in SUPPORTS.

    Returns
    -------
    SupportModel
        The row of it.

    Raises
    ------
    InputError
        Naming the supports there are.
    """
    for support in SUPPORTS:
        if support.name == name:
            return support
    raise InputError(f"there is no support {name!r}; the supports are: {', '.join(s.name for s in SUPPORTS)}")
