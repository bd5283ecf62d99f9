"""One model on prepared parameters under one motion: integrated, bounded, or by its closed form."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, Protocol

import numpy as np

from pipeline.errors import InputError
from pipeline.models import MODELS
from pipeline.models.common import BOUND
from pipeline.models.directions import worst_direction, worst_scanned
from pipeline.quantities import Array, Quantity, checked, real_array
from pipeline.records import Columns, Excitation, Model, Motion, Numerics
from pipeline.records.numerics import REFINE, SCAN


class Parametric(Protocol):
    """What has a name and takes parameters: a model or a support."""

    @property
    def name(self) -> str:
        """As the registry calls it."""
        ...

    @property
    def needs(self) -> tuple[Quantity, ...]:
        """Its parameters."""
        ...


def prepare(model: Parametric, parameters: Mapping[str, Any]) -> dict[str, Array]:
    """Return a model's parameters as arrays of one length; what was left out is NaN or its default.

    Parameters
    ----------
    model
        What takes them.
    parameters
        By name, in the units of the model: numbers, or arrays (n,), broadcast against each other.

    Returns
    -------
    dict of str to ndarray
        Every parameter of the model, (n,) floats each.

    Raises
    ------
    InputError
        For a parameter that is unknown, missing, not a number, outside its limits, or of another length.
    """
    known = {q.name: q for q in model.needs}
    for name in parameters:
        if name not in known:
            close = get_close_matches(name, known, n=1)
            hint = f"; did you mean {close[0]!r}?" if close else "."
            raise InputError(f"{model.name} has no parameter {name!r}{hint} It takes: {', '.join(known)}")
    arrays: dict[str, Array] = {}
    for name, quantity in known.items():
        value = parameters.get(name)
        if value is None:
            if not quantity.optional:
                raise InputError(f"{model.name} needs {name} [{quantity.unit}]: {quantity.meaning}")
            arrays[name] = np.array(np.nan if quantity.default is None else quantity.default)
            continue
        array = real_array(value)
        if array is None:
            raise InputError(f"{name} must be {quantity.allowed()}, not {value!r}")
        if array.size == 0:
            raise InputError(f"{name} is empty: give at least one value")
        if array.ndim > 1:
            raise InputError(f"{name} must be a number or one row of numbers, not an array of shape {array.shape}")
        quantity.check(np.atleast_1d(array))
        arrays[name] = array
    try:
        full = np.broadcast_arrays(*(np.atleast_1d(a) for a in arrays.values()))
    except ValueError as problem:
        sizes = ", ".join(f"{n}: {np.size(a)}" for n, a in arrays.items())
        raise InputError(f"the parameters of {model.name} have different lengths ({sizes})") from problem
    return {name: np.ascontiguousarray(a) for name, a in zip(arrays, full, strict=True)}


def single(model: Parametric, parameters: Mapping[str, Any], why: str) -> dict[str, float]:
    """Return one parameter set as numbers.

    Parameters
    ----------
    model, parameters
        As in `prepare`.
    why
        What is said where there is more than one.

    Returns
    -------
    dict of str to float
        Every parameter of the model.

    Raises
    ------
    InputError
        As `prepare`, and for more than one parameter set.
    """
    values = prepare(model, parameters)
    if any(column.size > 1 for column in values.values()):
        raise InputError(f"{why}; give single numbers")
    return {name: float(column[0]) for name, column in values.items()}


def run_model(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    numerics: Numerics,
    angle: float | None,
    tail: float | None = None,
) -> tuple[Columns, Array]:
    """Run a model on prepared parameters.

    Parameters
    ----------
    model
        The model.
    motion
        What shakes it.
    values
        Its parameters as `prepare` returns them, (n,) each.
    numerics
        How finely: fidelity "screen", "bound", "scan", "history" or "reference", and the step between directions.
    angle
        Degrees from x towards y along which a one-direction model is shaken; None: the worst direction of each row.
    tail
        Seconds of rest after the record; None: until rest or past the peak, with the cap of the model.

    Returns
    -------
    columns : dict of str to ndarray
        The outputs, "error" (in the unit of the first output; NaN at "scan") and "note" (bits), (n,) each; at "bound"
        "low" and "high" besides.
    angles : ndarray
        (n,) degrees; NaN: shaken in two directions, or the worst of all was found without an angle.

    Raises
    ------
    InputError
        For a bad tail or azimuth step, mixed `directions`, or a model without the fidelity asked.
    """
    angle, tail, azimuth_step = checked(angle, tail, numerics.azimuth_step)
    size = next(iter(values.values())).size
    both = both_ways(model, values)
    if numerics.fidelity in ("screen", "bound"):
        way = None if both else angle
        closed = _screened if numerics.fidelity == "screen" else _bounded
        return closed(model, motion.excitation(way, tail), values), np.full(size, np.nan if way is None else way)
    refine, estimate = REFINE[numerics.fidelity], numerics.fidelity != SCAN
    if both or (angle is None and model.resultant):
        return model.run(motion.excitation(None, tail), values, refine, estimate), np.full(size, np.nan)
    if angle is not None:
        return model.run(motion.excitation(angle, tail), values, refine, estimate), np.full(size, angle)
    search = worst_direction if estimate else worst_scanned
    return search(model, motion, values, refine, tail, azimuth_step)


def both_ways(model: Model, values: Mapping[str, Array]) -> bool:
    """Say whether a model on these parameters is shaken in both horizontal directions at once.

    Parameters
    ----------
    model, values
        As in `run_model`.

    Returns
    -------
    bool
        False: it is shaken along one direction.

    Raises
    ------
    InputError
        Where the rows' `directions` are mixed.
    """
    if model.directions != 0:
        return model.directions == 2
    asked = np.unique(values["directions"])
    if asked.size > 1 or asked[0] not in (1.0, 2.0):
        raise InputError(f"directions must be 1 or 2 for all rows, not {asked.tolist()}")
    return bool(asked[0] == 2.0)


def _screened(model: Model, motion: Excitation, values: Mapping[str, Array]) -> Columns:
    if model.screen is None:
        raise InputError(f"the paper gives no closed-form criterion for {model.name}; ask for history")
    return model.screen(motion, values)


def _bounded(model: Model, motion: Excitation, values: Mapping[str, Array]) -> Columns:
    if model.bound is None:
        others = ", ".join(m.name for m in MODELS if m.bound is not None)
        raise InputError(f"{model.name} has no guaranteed bounds; ask for history (bounds have: {others})")
    bounds = model.bound(motion, values)
    low, high = bounds.outputs[model.gives[0].name]
    columns: Columns = {}
    for quantity in model.gives:
        certain, most = bounds.outputs.get(quantity.name, (np.zeros_like(low), np.full_like(low, np.nan)))
        columns[quantity.name] = certain if quantity.unit in ("bool", "count") else most
    error = np.subtract(high, low, out=np.zeros_like(low), where=high > low)
    return columns | {"low": low, "high": high, "error": error, "note": bounds.note + BOUND}
