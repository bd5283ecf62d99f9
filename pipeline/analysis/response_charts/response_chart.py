"""A response chart: built from a model's analyses, asked by the hundred thousand.

Adaptive nodes: cells are halved until what they predict at held-out points agrees with what the model gives there.

A cell has seven nodes.  The cubic through the first, third, fifth and seventh predicts the other three, which the model
is run at as well; where the prediction is good enough the cell is kept, with all seven for its lookups, and otherwise
its halves have four of their seven nodes already.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pipeline.cache import CacheEntry
from pipeline.errors import InputError
from pipeline.kernels.lookup import CUBIC, POINTS, UNIT, cubic_weights, lookup_batch
from pipeline.quantities import Array
from pipeline.records import ChartAxis, Columns, Excitation, Model, notebook

Integers = NDArray[np.int64]

DEPTH = 15
"""How often the axis is halved at most."""

BEGIN = 3
"""How often the axis is halved before any cell is trusted."""

UNITS = UNIT * 2**DEPTH
"""The length of the axis in smallest distances between nodes."""

SMALL = 0.01
"""Share of the largest value of an output below which errors count as if the value were that large."""

SAFETY = 2.0
"""What the error at the held-out points is multiplied by to be the reported one.

They are three, and the worst point lies between them.  On the other hand they become nodes, which makes the
interpolation that is used better than the one that was measured: at a kink by two, elsewhere by sixteen.
"""

CLAIM = 0.1
"""Share of the error allowed below which none is reported: three points cannot vouch for less."""

MOST_NODES = 6_000
"""Analyses after which a chart is left as it is."""


@dataclass(frozen=True)
class ChartCells:
    """The cells of a chart, along its axis.

    Attributes
    ----------
    edges : Array
        (cells + 1,), from 0 to UNITS.
    values : Array
        (cells, 7, outputs).
    bounds : Array
        (cells, outputs), the error that the lookups in a cell may have by interpolation.
    own : Array
        (cells,), the largest error of the model itself at the nodes, of its first output.
    note : Integers
        (cells,) int64, the bits of the notes at the nodes.
    resolved : NDArray[np.bool_]
        (cells,) bool, whether the bounds are within the tolerance.
    nodes : int
        How many analyses it took.
    """

    edges: Array
    values: Array
    bounds: Array
    own: Array
    note: Integers
    resolved: NDArray[np.bool_]
    nodes: int


Analyses = Callable[[Integers], Array]
"""Places (n,) on the axis, 0 to UNITS -> the outputs, the error of the first of them, the note: (n, outputs + 2)."""


class _Nodes:
    """All analyses so far, by place."""

    def __init__(self, analyse: Analyses) -> None:
        self._analyse = analyse
        self._places = np.empty(0, dtype=np.int64)
        self._rows = np.empty((0, 0))

    def __len__(self) -> int:
        return self._places.size

    def at(self, places: Integers) -> Array:
        """Return the rows at places of any shape; what is not known yet is run, in one call."""
        fresh = np.setdiff1d(places, self._places)
        if fresh.size:
            rows = self._analyse(fresh)
            known = np.concatenate([self._places, fresh])
            order = np.argsort(known)
            self._rows = np.concatenate([self._rows.reshape(-1, rows.shape[1]), rows])[order]
            self._places = known[order]
        return self._rows[np.searchsorted(self._places, places)]


def _predict(values: Array) -> Array:
    """Return what the cubic through every other node of each cell says at all of them; (cells, 7, outputs)."""
    weights = np.empty((POINTS, CUBIC))
    for i in range(POINTS):
        cubic_weights(0.5 * i, weights[i])
    return np.asarray(np.einsum("ai,cio->cao", weights, values[:, ::2]))


def refine(analyse: Analyses, tolerance: float, most_nodes: int = MOST_NODES, counted: int | None = None) -> ChartCells:
    """Halve cells until their error is below ``tolerance`` times the value there, or no more analyses may be run.

    Parameters
    ----------
    analyse : Analyses
        Runs the model; its outputs are magnitudes.
    tolerance : float
        Of max(value, SMALL x the largest value), of every output that counts.
    most_nodes : int, optional
        Of the first cells and of halving them; the worst are halved first where not all can be.
    counted : int or None, optional
        How many of the outputs count, the first ones; None: all.

    Returns
    -------
    ChartCells
        The cells; those that could not be resolved have the bounds that they have.
    """
    nodes = _Nodes(analyse)
    size = UNITS // 2**BEGIN
    begin = np.arange(0, UNITS, size)
    grid = np.arange(POINTS)
    done: list[tuple[Integers, Array, Array, Array, Integers, NDArray[np.bool_]]] = []
    floor: Array | None = None
    while begin.size:
        rows = nodes.at(begin[:, None] + size // UNIT * grid)
        values = rows[..., :-2]
        if floor is None:
            # From the first cells alone: a tighter tolerance halves the same cells and more.
            floor = SMALL * values.max(axis=(0, 1))
        allowed = tolerance * np.maximum(values.min(axis=1), floor)
        bounds = SAFETY * np.abs(_predict(values) - values).max(axis=1)
        bad = (bounds > allowed)[:, :counted].any(axis=1)
        # Not even halvings that quartered the error could mend a jump, or chaos: leave it early.
        hopeless = (bounds > allowed * (size / UNIT) ** 2)[:, :counted].any(axis=1)
        halved = bad & ~hopeless & (size > UNIT)
        # Halving a cell adds the six midpoints of its nodes.
        room = max(0, most_nodes - len(nodes)) // UNIT
        if np.count_nonzero(halved) > room:
            share = np.divide(bounds, allowed, out=np.full_like(bounds, np.inf), where=allowed > 0.0)
            share = share[:, :counted].max(axis=1)
            halved[np.argsort(np.where(halved, -share, 0.0), kind="stable")[room:]] = False
        stay = ~halved
        note = np.bitwise_or.reduce(rows[stay, :, -1].astype(np.int64), axis=1)
        bounds = np.maximum(bounds, CLAIM * allowed)
        done.append((begin[stay], values[stay], bounds[stay], rows[stay, :, -2].max(axis=1), note, ~bad[stay]))
        size //= 2
        begin = np.ravel(begin[halved, None] + np.array([0, size]))
    starts, values, bounds, own, note, resolved = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.argsort(starts)
    edges = np.append(starts[order], UNITS).astype(np.float64)
    return ChartCells(edges, values[order], bounds[order], own[order], note[order], resolved[order], len(nodes))


_DRAWN = 400
"""Points of a drawn chart."""

Run = Callable[[Mapping[str, Array]], Columns]
"""Parameters of a model, (n,) each -> its columns, with "error" and "note", under the motion of the chart."""


@dataclass(frozen=True)
class Looked:
    """What a chart says, row for row of what it was asked.

    Attributes
    ----------
    columns : Columns
        The outputs, (n,) each.
    bounds : Columns
        By how much interpolation may be wrong in each of them.
    own : Array
        (n,), the error of the analyses that the chart is made of, of the first output.
    note : Integers
        (n,) bits; what was said of any analysis nearby is said.
    resolved : NDArray[np.bool_]
        (n,), whether the bounds are within the chart's tolerance.
    """

    columns: Columns
    bounds: Columns
    own: Array
    note: Integers
    resolved: NDArray[np.bool_]


@dataclass(frozen=True)
class ResponseChart:
    """The response of one model under one motion, along one parameter, all others fixed.

    Attributes
    ----------
    outputs : tuple of str
        Names of what is tabulated.
    low, high : float
        The stretch of the axis that the cells cover.
    settled : float
        Value from which on the response is that at the end of the chart; inf: nowhere.
    tolerance : float
        Wanted of every output, relative to max(value, 1 % of its largest).
    """

    axis: ChartAxis
    outputs: tuple[str, ...]
    low: float
    high: float
    settled: float
    tolerance: float
    cells: ChartCells

    @classmethod
    def build(
        cls,
        model: Model,
        axis: ChartAxis,
        excitation: Excitation,
        fixed: Mapping[str, float],
        run: Run,
        tolerance: float,
        most_nodes: int = MOST_NODES,
        *,
        first: bool = False,
    ) -> "ResponseChart":
        """Run the model where it is needed.

        Parameters
        ----------
        axis : ChartAxis
            The model's, or a stretch of it.
        excitation : Excitation
            The strongest that the run may shake with: in both directions for a worst direction.
        fixed : mapping of str to float
            The model's parameters besides that of the axis (NaN: left out).
        first : bool, optional
            Whether the tolerance is that of the first output alone, whatever becomes of the others.

        Returns
        -------
        'ResponseChart'
        """
        settled = np.inf if axis.settled is None else axis.settled(excitation)
        high = axis.high if settled > axis.high else max(settled, 2.0 * axis.low)
        outputs = tuple(q.name for q in model.gives)
        begin, length = np.log(axis.low), np.log(high / axis.low)

        def analyse(places: Integers) -> Array:
            along = np.clip(np.exp(begin + length * places / UNITS), axis.low, high)
            # A kink stands at the end, so that the end must be met exactly.
            along = np.where(places == UNITS, high, along)
            columns = run({q.name: along if q.name == axis.name else _all(fixed[q.name], along) for q in model.needs})
            return np.column_stack([columns[name] for name in (*outputs, "error", "note")])

        cells = refine(analyse, tolerance, most_nodes, 1 if first else None)
        return cls(axis, outputs, axis.low, high, settled if settled <= high else np.inf, tolerance, cells)

    def kept(self) -> CacheEntry:
        """Return the chart as the cache keeps it."""
        said = {"outputs": self.outputs, "low": self.low, "high": self.high, "settled": self.settled}
        cells = {name: np.asarray(values) for name, values in asdict(self.cells).items()}
        return CacheEntry(said | {"tolerance": self.tolerance}, cells)

    @classmethod
    def of(cls, axis: ChartAxis, kept: CacheEntry) -> "ResponseChart":
        """Return a chart from what the cache kept of it, bit for bit; the axis is a part of its key."""
        said, cells = kept.said, dict(kept.arrays)
        nodes = int(cells.pop("nodes"))
        outputs = tuple(said["outputs"])
        return cls(
            axis,
            outputs,
            said["low"],
            said["high"],
            said["settled"],
            said["tolerance"],
            ChartCells(**cells, nodes=nodes),
        )

    def covers(self, along: Array) -> NDArray[np.bool_]:
        """Return which values (n,) of the axis' parameter the chart speaks of."""
        return ((along >= self.low) & (along <= self.high)) | (along >= self.settled)

    def look(self, along: Array) -> Looked:
        """Return the response at values (n,) of the axis' parameter, which the chart covers; about 50 ns each."""
        at = np.log(np.clip(along, self.low, self.high) / self.low) * (UNITS / np.log(self.high / self.low))
        at = np.where(along >= self.settled, UNITS, np.clip(at, 0.0, UNITS))
        cells = self.cells
        columns = np.empty((len(self.outputs), along.size))
        cell = np.empty(along.size, dtype=np.int64)
        lookup_batch(at, cells.edges, cells.values, columns, cell)
        bounds = cells.bounds.T[:, cell]
        # The end is a node: from there on nothing is interpolated.
        bounds[:, at == UNITS] = 0.0
        return Looked(
            dict(zip(self.outputs, columns, strict=True)),
            dict(zip(self.outputs, bounds, strict=True)),
            cells.own[cell],
            cells.note[cell],
            cells.resolved[cell],
        )

    @property
    def nodes(self) -> Array:
        """The values of the axis' parameter, rising, at which the model was run for the cells as they are."""
        edges = self.cells.edges
        within = np.arange(POINTS - 1) / (POINTS - 1)
        places = np.append(np.ravel(edges[:-1, None] + np.diff(edges)[:, None] * within), UNITS)
        along = self.low * (self.high / self.low) ** (places / UNITS)
        return np.append(np.clip(along[:-1], self.low, self.high), self.high)

    def worst(self, output: str) -> float:
        """Return the largest bound of an output anywhere, relative to max(value, 1 % of its largest value)."""
        at = self.outputs.index(output)
        values, bounds = self.cells.values[..., at], self.cells.bounds[:, at]
        size = np.maximum(values.min(axis=1), SMALL * values.max())
        return float(np.divide(bounds, size, out=np.zeros_like(size), where=size > 0.0).max())

    def _repr_html_(self) -> str:
        rows = {
            f"along {self.axis.name}": [f"{self.low:.4g} to {self.high:.4g}, {self.cells.nodes:,} analyses"],
            "settled from": [f"{self.settled:.4g}"] if np.isfinite(self.settled) else ["nowhere"],
            "tolerance": [f"{self.tolerance:.2g}"],
            "interpolated within": [f"{name}: {self.worst(name):.2g}" for name in self.outputs],
        }
        return notebook.table("Response chart", rows)

    def plot(self, output: str | None = None, axes: Any = None) -> Any:
        """Draw an output along the axis, as far as interpolation may be wrong, with matplotlib.

        Parameters
        ----------
        output : str, optional
            One of `outputs`; None: the first.
        axes : matplotlib Axes, optional
            Where to draw; None: in a new figure.

        Returns
        -------
        matplotlib Axes
            In SI, over the logarithm of the axis' parameter.

        Raises
        ------
        InputError
            For an output that there is not.
        KourosError
            Where matplotlib is not installed.
        """
        name = self.outputs[0] if output is None else output
        if name not in self.outputs:
            raise InputError(f"the chart has no output {name!r}; it has {', '.join(self.outputs)}")
        (at,) = notebook.axes_for(1, axes)
        along = np.geomspace(self.low, self.high, _DRAWN)
        looked = self.look(along)
        value, bound = looked.columns[name], looked.bounds[name]
        at.fill_between(along, value - bound, value + bound, color="0.8")
        at.plot(along, value, color="black", linewidth=1.0)
        at.set(xscale="log", xlabel=self.axis.name, ylabel=name)
        return at


def _all(value: float, like: Array) -> Array:
    return np.full_like(like, value)


def axis_of(model: Model) -> ChartAxis:
    """Return the axis along which a model is tabulated.

    Raises
    ------
    ValueError
        With the reason for a model that is not.
    """
    if model.chart is None:
        raise InputError(f"{model.name} has no chart: {model.uncharted}; ask for history")
    return model.chart
