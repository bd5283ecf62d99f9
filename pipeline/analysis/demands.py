"""Demands of a work under one motion: bounds first, then charts, then histories."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.chart_runs import deciding, look_up
from pipeline.analysis.context import Context
from pipeline.analysis.model_runs import run_model
from pipeline.analysis.plan import Indices, Work
from pipeline.analysis.response_charts import ChartCache
from pipeline.cache import key_of
from pipeline.quantities import Array
from pipeline.records import Columns, Executor, Model, Motion, Numerics
from pipeline.records.numerics import AUTO, CHART

CHUNK = 96
"""Parameter sets in one task: small enough to share between workers, large enough to make the task worth its call."""

WHOLE = 4096
"""Parameter sets in one task that only bounds them, or that nobody shares: bounds the memory."""

HISTORY_ERROR = 2e-3
"""Share of a demand by which a history may be off what is bounded or tabulated.

Of 1,200 slides none was off its reference by more than 5e-4; swings are far better.  A bound holds for the true
response and a chart is made of histories of its own, but a verdict is that of this very history.
"""

CHART_SAFETY = 2.0
"""What the error that a chart states is multiplied by before a verdict hangs on it.

Of 2,000 lookups, none was off by more than the stated error, which is itself twice what was measured (see refine).
"""


class Step(IntEnum):
    """How far a parameter set was taken, from cheapest to dearest."""

    BOUND = 0
    CHART = 1
    HISTORY = 2


@dataclass
class Demands:
    """What is known of one model's parameter sets under one motion, row for row of its work's values.

    Attributes
    ----------
    step : NDArray[np.int8]
        (k,) how far each row was taken.
    low, high : Columns
        By output that counts, (k,): between these lies what a history gives; it is both once it was run.
    note : Array
        (k,) bits, of the bounds.
    trail : list of (str, Indices, Columns) or None
        Where it is a list, every step is kept there: the fidelity that it ran at, which rows, what was found.
    """

    work: Work
    motion: Motion
    step: NDArray[np.int8]
    low: Columns
    high: Columns
    note: Array
    _slot: NDArray[np.int32]
    trail: list[tuple[str, Indices, Columns]] | None = None
    _kept: dict[str, list[Array]] = field(default_factory=dict)
    _count: int = 0

    def settle(self, rows: Indices, columns: Columns, step: Step, ran: str, errors: Columns | None = None) -> None:
        """Fill in what a chart or histories give for some rows.

        Parameters
        ----------
        rows
            (n,) rows of the work's values.
        columns
            All outputs, "error" and "note", (n,) each, in the units of the model.
        step
            What gave them.
        ran
            The fidelity that it ran at.
        errors
            By output, (n,): how far off it may be; None: not at all.
        """
        if rows.size == 0:
            return
        self.step[rows] = step
        if self.trail is not None:
            self.trail.append((ran, rows, columns))
        for output, low in self.low.items():
            value, high = columns[output], self.high[output]
            exact = self._exact(output)
            if errors is None:
                if not exact:
                    # A search is off by as much when it is made again: what it was bounded by goes on to hold.
                    found = ~self.work.searched[rows]
                    low[rows[found]] = high[rows[found]] = value[found]
                continue
            # What is tabulated is never below zero; the bounds go on to hold.
            low[rows] = np.clip(value - errors[output], low[rows], high[rows])
            high[rows] = np.clip(value + errors[output], low[rows], high[rows])
        self._slot[rows] = self._count + np.arange(rows.size)
        self._count += rows.size
        for name, column in columns.items():
            self._kept.setdefault(name, []).append(column)

    def column(self, output: str, rows: Indices) -> Array:
        """Return an output of rows that were looked up or integrated.

        Parameters
        ----------
        output
            Its name.
        rows
            (n,) rows of the work's values.

        Returns
        -------
        ndarray
            (n,) in the unit of the output.
        """
        return self._whole(output)[self._slot[rows]]

    def told(self, row: int) -> dict[str, float]:
        """Return all outputs of one row, with their errors and "note".

        Parameters
        ----------
        row
            Of the work's values.

        Returns
        -------
        dict of str to float
            By name, in the units of the model.  Zeros where it was neither looked up nor integrated.  Where the
            certificate is the demand, that is the demand.
        """
        model, at = self.work.model, int(self._slot[row])
        names = (*(q.name for q in model.gives), "error", *model.errors.values(), "note")
        out = {name: float(self._whole(name)[at]) if at >= 0 else 0.0 for name in names}
        if at < 0:
            out["note"] = float(self.note[row])
        if model.demand in self.low and self._exact(model.demand):
            out[model.demand] = float(self.low[model.demand][row])
        return out

    def points(self, output: str) -> tuple[Array, Array]:
        """Return the range of what is best known of an output.

        Parameters
        ----------
        output
            Its name.

        Returns
        -------
        low, high : ndarray
            (k,) each, in the unit of the output: of what was only bounded both bounds, else the same twice.
        """
        low, high = self.low[output], self.high[output]
        charted = np.flatnonzero(self.step == Step.CHART)
        if charted.size:
            value = self.column(output, charted)
            low, high = low.copy(), high.copy()
            low[charted] = high[charted] = value
        return low, high

    def _exact(self, output: str) -> bool:
        return self.work.model.exact and output == self.work.model.demand

    def _whole(self, name: str) -> Array:
        parts = self._kept[name]
        if len(parts) > 1:
            parts[:] = [np.concatenate(parts)]
        return parts[0]


_Bounded = tuple[Array | None, Mapping[str, tuple[Array, Array]], Array]
_BoundTask = tuple[Model, Motion, float | None, Mapping[str, Array], bool]


def _bound(task: _BoundTask) -> _Bounded:
    model, motion, angle, values, whole = task
    excitation = motion.excitation(angle)
    certificate = None if model.certificate is None else model.certificate(excitation, values)
    if model.bound is None or not whole:
        return certificate, {}, np.zeros(next(iter(values.values())).size)
    bounds = model.bound(excitation, values)
    outputs = bounds.outputs
    if angle is None and bounds.worst:
        # What is shaken from all sides answers with the worst.
        outputs = {name: (np.maximum(low, bounds.worst.get(name, low)), high) for name, (low, high) in outputs.items()}
    return certificate, outputs, bounds.note


def bounded(work: Work, motion: Motion, outputs: Sequence[str], executor: Executor, *, whole: bool = True) -> Demands:
    """Return what is known of the outputs that count without any integration.

    Parameters
    ----------
    work
        Parameter sets (k,) of one model.
    motion
        What shakes them.
    outputs
        Names of the outputs that count.
    executor
        Where the sets are bounded.
    whole
        By the model's bounds too; else only by its certificate.

    Returns
    -------
    Demands
        Ranges of the outputs, row for row of the work's values.
    """
    model, size = work.model, work.size
    low = {output: np.zeros(size) for output in outputs}
    high = {output: np.full(size, np.inf) for output in outputs}
    note = np.zeros(size)
    parts = [
        (angle, rows[i : i + WHOLE])
        for angle, rows in work.by_angle(np.unique(work.first))
        for i in range(0, rows.size, WHOLE)
    ]
    # The certificate of a demand that counts needs no bounds besides.
    needed = whole and not (model.exact and set(outputs) == {model.demand} and model.rests is not None)
    tasks: list[_BoundTask] = [(model, motion, angle, work.some(rows), needed) for angle, rows in parts]
    for (_, rows), (certificate, bounds, said) in zip(parts, executor.map(_bound, tasks), strict=True):
        note[rows] = said
        for output in outputs:
            if output in bounds:
                least, most = bounds[output]
                # A yes or a no has no error.
                off = 0.0 if model.output(output).unit == "bool" else HISTORY_ERROR
                low[output][rows] = least - off * np.abs(least)
                high[output][rows] = most + off * np.abs(most)
            if certificate is None:
                continue
            if model.rests is not None:
                # Nothing moves, and there is nothing to integrate.
                resting = rows[certificate <= model.rests]
                low[output][resting] = high[output][resting] = 0.0
            if model.exact and output == model.demand:
                low[output][rows] = high[output][rows] = certificate
    # What is the same is bounded once.
    low, high = ({output: column[work.first] for output, column in side.items()} for side in (low, high))
    note = note[work.first]
    return Demands(work, motion, np.zeros(size, dtype=np.int8), low, high, note, np.full(size, -1, dtype=np.int32))


_RunTask = tuple[Model, Motion, float | None, Mapping[str, Array], Numerics]


def _run(task: _RunTask) -> Columns:
    model, motion, angle, values, numerics = task
    return run_model(model, motion, values, numerics, angle)[0]


def integrate(found: Demands, rows: Indices, context: Context, numerics: Numerics) -> int:
    """Integrate some rows, in chunks on the executor; what the context remembers is taken over.

    Parameters
    ----------
    found
        What is known so far; filled in.
    rows
        (n,) rows of the work's values.
    context
        Where they are run, and the histories that were run before.
    numerics
        How finely: a fidelity that integrates.

    Returns
    -------
    int
        How many rows there were.
    """
    work, histories = found.work, context.histories
    # What a motion is made ready for is worth as many sets as there are, where nobody else waits for some.
    most = WHOLE if context.executor.workers == 1 else CHUNK
    groups: list[_Group] = []
    tasks: list[_RunTask] = []
    for angle, group in work.by_angle(rows):
        each, place = np.unique(work.first[group], return_inverse=True)
        key = key_of(work.model.name, found.motion.hash, angle, numerics.fidelity, numerics.azimuth_step)
        there = np.zeros(each.size, dtype=bool)
        known: Columns = {}
        if histories is not None:
            there, known = histories.recall(key, work.some(each))
        left = each[~there]
        chunks = [left[i : i + most] for i in range(0, left.size, most)]
        tasks += [(work.model, found.motion, angle, work.some(some), numerics) for some in chunks]
        groups.append(_Group(key, group, place, each, there, known, len(chunks)))
    ran = iter(context.executor.map(_run, tasks))
    for one in groups:
        columns = dict(one.known)
        parts = [next(ran) for _ in range(one.chunks)]
        if parts:
            fresh = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
            if histories is not None:
                histories.note(one.key, work.some(one.each[~one.there]), fresh)
            columns = {name: _merged(one.there, one.known.get(name), column) for name, column in fresh.items()}
        of_rows = {name: column[one.place] for name, column in columns.items()}
        found.settle(one.rows, of_rows, Step.HISTORY, numerics.fidelity)
    return int(rows.size)


@dataclass(frozen=True)
class _Group:
    """Rows shaken along one angle.

    each  : the different ones among them;  place : of each row in it
    there : which of those were run before, with what they gave;  chunks : in how many parts the others are run
    """

    key: str
    rows: Indices
    place: Indices
    each: Indices
    there: NDArray[np.bool_]
    known: Columns
    chunks: int


def _merged(there: NDArray[np.bool_], known: Array | None, fresh: Array) -> Array:
    out = np.empty(there.size)
    out[~there] = fresh
    if known is not None:
        out[there] = known
    return out


def chart(found: Demands, rows: Indices, charts: ChartCache, numerics: Numerics) -> None:
    """Look some rows up in charts; those that are on none stay as they are.

    Parameters
    ----------
    found
        What is known so far; filled in.
    rows
        (n,) rows of the work's values.
    charts
        Where charts are found and kept.
    numerics
        How verdicts are found.  At "auto" a chart is built only where that costs less than the histories that it takes
        the place of.
    """
    model, work = found.work.model, found.work
    if model.chart is None or rows.size == 0:
        return
    least, finely = model.chart.nodes if numerics.fidelity == AUTO else 0, deciding(model.name, numerics)
    for angle, group in work.by_angle(rows):
        looked = look_up(model, found.motion, work.some(group), finely, angle, charts, least)
        there = looked.found
        columns = {name: column[there] for name, column in looked.columns.items()}
        columns |= {model.error_of(o): looked.bounds[o][there] for o in (model.gives[0].name, model.demand)}
        errors = {
            output: CHART_SAFETY * looked.bounds[output][there] + HISTORY_ERROR * columns[output]
            for output in found.low
        }
        found.settle(group[there], columns, Step.CHART, CHART, errors)
