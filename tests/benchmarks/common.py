"""What the benchmarks share: the record, a clock that takes the least of several runs, and the table of comparisons."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import groupby
from typing import TypeVar

import numpy as np

from pipeline.analysis.model_runs import prepare
from pipeline.models import model_named
from pipeline.motions import read_motion
from pipeline.quantities import Array
from pipeline.records import Columns, Excitation, Motion
from pipeline.records.numerics import REFINE
from pipeline.resources import resource

Result = TypeVar("Result")

OBJECTS = 512
"""Analyses in one call of ours."""

SHORT = 4_000
"""Samples of the part of the record that slow peers are given."""

FAR = 0.1
"""Median error of the peak from which a peer's answer is of no use."""

SEED = 20190706


@cache
def shaking() -> Motion:
    """Return the demonstration's motion, repeated to 20,000 samples: 0.7 g and 200 s."""
    motion = read_motion(resource("site_motions", "demo"))[0]
    return Motion(motion.dt, np.tile(motion.acceleration, 2)[:, :20_000], motion.name)


def strongest() -> Array:
    """Return the horizontal component of the record with the larger peak: what shakes a model in one direction."""
    horizontal = shaking().acceleration[:2]
    return np.ascontiguousarray(horizontal[np.abs(horizontal).max(axis=1).argmax()])


def level(x: Array | None = None) -> Excitation:
    """Return the strongest component, or another one, without vertical motion, ending with the record."""
    motion = shaking()
    return Excitation(motion.dt, strongest() if x is None else x, None, np.zeros(motion.samples), 0.0)


def strong(directions: int) -> Excitation:
    """Return the first 40 s of the record, the strong shaking, for peers that take seconds for it."""
    motion = shaking()
    x, y, z = motion.acceleration[:, :SHORT]
    return Excitation(motion.dt, x if directions == 2 else strongest()[:SHORT], y if directions == 2 else None, z, 0.0)


def least(work: Callable[[], object], repeats: int = 3) -> float:
    """Return the seconds of the fastest of several calls, after one that compiles and warms up."""
    work()
    return fastest(work, repeats)


def fastest(work: Callable[[], object], repeats: int) -> float:
    """Return the seconds of the fastest of several calls."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def clocked(work: Callable[[], Result]) -> tuple[Result, float]:
    """Return what one call gives and its seconds."""
    start = time.perf_counter()
    result = work()
    return result, time.perf_counter() - start


class Ours:
    """One of our models on one excitation, for a few parameter sets repeated to OBJECTS analyses in one call."""

    def __init__(self, name: str, motion: Excitation, **parameters: Array | float) -> None:
        self._model = model_named(name)
        self.motion = motion
        self._values = prepare(self._model, parameters)

    @cached_property
    def seconds(self) -> float:
        """Seconds of one analysis at `history`, its error estimate left out (peers give none)."""
        many = {name: np.resize(column, OBJECTS) for name, column in self._values.items()}
        return least(lambda: self._model.run(self.motion, many, REFINE["history"], False)) / OBJECTS

    def outputs(self, fidelity: str = "history") -> Columns:
        """Return the outputs of the few parameter sets."""
        return self._model.run(self.motion, self._values, REFINE[fidelity], True)

    def beside(
        self,
        work: str,
        name: str,
        runs: Sequence[tuple[float, float]],
        wanted: float = 0.0,
        truth: Array | None = None,
        counted: Array | None = None,
        output: str = "",
        outcomes: tuple[int, int] = (0, 0),
    ) -> "Comparison":
        """Return the row that compares a peer's peaks and seconds, one a parameter set, with ours.

        truth   : the true peaks of the output; else what `reference` gives
        counted : which parameter sets have an error, else all
        output  : which output is compared, else the first
        outcomes: how many overturn or do not as they should, of how many; (0, 0) where nothing can
        """
        first = output or self._model.gives[0].name
        peaks, seconds = np.array(runs).T
        true = self.outputs("reference")[first] if truth is None else truth
        use = slice(None) if counted is None else counted
        return Comparison(
            f"{work}, {self.motion.x.size:,}",
            name,
            float(seconds.mean()),
            self.seconds,
            relative(peaks, true)[use],
            relative(self.outputs()[first], true)[use],
            wanted,
            outcomes,
        )


@dataclass(frozen=True)
class Comparison:
    """A row of the table: seconds of one analysis and relative errors of the peak, theirs and ours.

    peer     : its name and, after a comma, its setting
    wanted   : the ratio of times that is asked for, or 0
    outcomes : how many overturn or do not as they should, of how many
    """

    work: str
    peer: str
    theirs: float
    ours: float
    their_errors: Array
    our_errors: Array
    wanted: float = 0.0
    outcomes: tuple[int, int] = (0, 0)

    @property
    def right(self) -> bool:
        """Whether the peer's answer can be used: all outcomes right, and a median error below FAR."""
        return self.outcomes[0] == self.outcomes[1] and float(np.median(self.their_errors)) < FAR

    def line(self, counts: str = "") -> str:
        """Return the row in fixed columns.

        counts : what is said of the row's ratio, such as that it is the one to read
        """
        ratio = self.theirs / self.ours
        wanted = "" if self.wanted == 0.0 else f"{self.wanted:,.0f}" + (" " if ratio >= self.wanted else "!")
        right, of = self.outcomes
        said = filter(None, (counts, f"outcomes right: {right} of {of}" if of else ""))
        return (
            f"{self.work:<26}{self.peer:<48}{1e3 * self.theirs:>10.3f}{1e3 * self.ours:>10.4f}{ratio:>9,.0f}{wanted:>8}"
            f"   {spread(self.their_errors):<18}{spread(self.our_errors):<18}{'; '.join(said)}"
        ).rstrip()


def marked(rows: Sequence[Comparison]) -> list[tuple[Comparison, str]]:
    """Return the rows with what counts: of each work and peer, the coarsest setting that can be used.

    rows : the settings of a peer from the coarsest to the finest, one after the other
    """
    out = []
    for _, group in groupby(rows, key=lambda row: (row.work, row.peer.partition(",")[0])):
        settings = list(group)
        first = next((k for k, row in enumerate(settings) if row.right), None)
        for k, row in enumerate(settings):
            last = k == len(settings) - 1
            out.append((row, "<- read this" if k == first else "none can be used" if first is None and last else ""))
    return out


HEADING = (
    f"{'work':<26}{'peer and its setting':<48}{'ms theirs':>10}{'ms ours':>10}{'ratio':>9}{'wanted':>8}"
    f"   {'error theirs':<18}{'error ours':<18}"
).rstrip()


def spread(errors: Array) -> str:
    """Return the median and the largest of some errors."""
    return f"{np.median(errors):.0e} / {np.max(errors):.0e}" if errors.size else "-"


def relative(values: Array, truth: Array) -> Array:
    """Return |value / truth - 1|."""
    return np.abs(np.asarray(values) / truth - 1.0)
