"""The worst of all directions (RotD100) of models that are shaken along one: found coarsely, then integrated."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pipeline.kernels import SENSITIVE
from pipeline.quantities import Array
from pipeline.records import Columns, Model, Motion

CLOSE = 1e-3
"""How close to the worst direction, relatively, another one found by a coarse step may come without a finer one."""


def worst_direction(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    refine: int,
    tail: float | None,
    azimuth_step: float,
) -> tuple[Columns, Array]:
    """Return the response of each row in its worst direction.

    A direction counts as the worst once no other one, as the coarse step found it, is within CLOSE below it or above.

    Parameters
    ----------
    model : Model
        One that is shaken along one direction.
    motion : Motion
        What shakes.
    values : mapping of str to ndarray, shape (n,)
        Its parameters.
    refine : int
        As in `Model.run`; each direction is looked at with half of it first.
    tail : float or None
        Seconds of rest after the record; None: until rest.
    azimuth_step : float
        Degrees between the directions that are looked at.

    Returns
    -------
    columns : Columns
        As `Model.run` gives them with an estimate.  Where an outcome of one direction hangs on the amplitude and
        another direction settles it, the error covers the first output of that one too.
    direction : ndarray, shape (n,)
        Degrees from x towards y.
    """
    size = next(iter(values.values())).size
    first = model.gives[0].name
    outcome = next((q.name for q in model.gives if q.unit == "bool"), None)
    ways, scans = _scanned(model, motion, values, max(1, refine // 2), tail, azimuth_step)
    outputs, pushes, others = _ranking(model, scans)
    where = np.full(size, np.nan)
    best: Columns = {first: np.full(size, -np.inf)}
    left = np.arange(size)
    # A worst direction that the finer integration does not confirm (a block that fell, and then did not), or that
    # others come close to, says nothing: each of those is looked at, unless an outcome is settled.
    while left.size:
        worst = _worst(outputs[:, left], pushes[:, left], others[:, left])
        for way in np.unique(worst):
            rows = left[worst == way]
            one = {name: v[rows] for name, v in values.items()}
            columns = model.run(motion.excitation(float(ways[way]), tail), one, refine, True)
            larger = ~(columns[first] <= best[first][rows])
            where[rows[larger]] = ways[way]
            for name, column in columns.items():
                best.setdefault(name, np.empty(size))[rows[larger]] = column[larger]
        outputs[worst, left] = -np.inf
        settled = np.zeros(left.size, dtype=bool) if outcome is None else best[outcome][left] > 0.0
        near = best[first][left] * np.where(settled, 1.0 + CLOSE, 1.0 - CLOSE)
        left = left[outputs[:, left].max(axis=0) > near]
    if outcome is not None:
        _doubt_directions(model, motion, values, tail, dict(zip(ways, scans, strict=True)), where, best, outcome)
    return best, where


def worst_scanned(
    model: Model, motion: Motion, values: Mapping[str, Array], refine: int, tail: float | None, azimuth_step: float
) -> tuple[Columns, Array]:
    """Return the response of each row in its worst direction as one look at each finds it.

    Parameters
    ----------
    model, motion, values, refine, tail, azimuth_step
        As in `worst_direction`; each direction is looked at with all of `refine`.

    Returns
    -------
    columns : Columns
        As `Model.run` gives them without an estimate.
    direction : ndarray, shape (n,)
        Degrees from x towards y.
    """
    ways, scans = _scanned(model, motion, values, refine, tail, azimuth_step)
    worst = _worst(*_ranking(model, scans))
    rows = np.arange(worst.size)
    return {name: np.array([columns[name] for columns in scans])[worst, rows] for name in scans[0]}, ways[worst]


def _ranking(model: Model, scans: Sequence[Columns]) -> tuple[Array, Array, Array]:
    """Return what ranks directions, (ways, n) each: the first output, then the demand, then the next output."""
    first = model.gives[0].name
    next_one = next((q.name for q in model.gives[1:] if q.unit not in ("bool", "count") and not q.optional), first)
    outputs, pushes, others = (
        np.nan_to_num([columns[name] for columns in scans], nan=-np.inf, posinf=np.inf)
        for name in (first, model.demand, next_one)
    )
    return outputs, pushes, others


def _worst(outputs: Array, pushes: Array, others: Array) -> NDArray[np.intp]:
    """Return the place of the worst direction of each row.

    Where the first output ties (nothing moved in either direction), the demand decides, then the next output, and of
    what is alike in all, the first direction: of what is turned round that is the last.
    """
    ranked = np.lexsort([one[::-1] for one in (others, pushes, outputs)], axis=0)
    return np.asarray(outputs.shape[0] - 1 - ranked[-1])


def _scanned(
    model: Model, motion: Motion, values: Mapping[str, Array], refine: int, tail: float | None, azimuth_step: float
) -> tuple[Array, list[Columns]]:
    """Return the directions that are looked at, and the response of all rows in each."""
    turn = 180.0 if model.symmetric(values) else 360.0
    ways = np.arange(0.0, turn - 1e-9, azimuth_step)
    return ways, [model.run(motion.excitation(float(way), tail), values, refine, False) for way in ways]


def _doubt_directions(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    tail: float | None,
    scans: Mapping[float, Columns],
    where: Array,
    best: Columns,
    outcome: str,
) -> None:
    # Whether 1 % of the amplitude changes the outcome of the worst of all directions: a yes in one that stays a yes
    # settles it, whatever the others do; a no can become a yes in any.  `best` is the row of the direction `where`.
    if model.flips is None:
        return
    first = model.gives[0].name
    note = best["note"].astype(np.int64)
    yes = best[outcome] > 0.0
    told = (note & SENSITIVE) > 0
    for direction, columns in scans.items():
        # What a coarse step found, and a finer one did not.
        told |= (columns[outcome] > 0.0) & ~yes
        asked = (where != direction) & ((columns[outcome] > 0.0) == yes) & (told == yes)
        if not asked.any():
            continue
        some = {name: value[asked] for name, value in values.items()}
        found = {name: column[asked] for name, column in columns.items()}
        told[asked] = model.flips(motion.excitation(direction, tail), some, found)
        # The outcome is settled, by another direction: the output may be that one's.
        cleared = asked & yes & ~told
        apart = np.abs(best[first] - columns[first])
        best["error"][cleared] = np.maximum(best["error"], apart)[cleared]
    best["note"] = np.where(told, note | SENSITIVE, note & ~SENSITIVE).astype(np.float64)
