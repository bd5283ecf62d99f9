"""Those who work in a run: this process, processes of this machine, or a cluster."""

from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from threading import Thread
from typing import Self

import numpy as np

from pipeline.analysis.model_runs import prepare
from pipeline.execute.pool import WorkerPool, cores, pool
from pipeline.execute.workers import give_back
from pipeline.kernels import is_kept
from pipeline.models import model_named
from pipeline.models.friction import slip_bounds
from pipeline.models.oscillator import oscillate_any
from pipeline.motions.synthesis import sine
from pipeline.night.context import RunContext
from pipeline.settings import Execution

_MODELS: dict[str, str] = {"swing_3d": "spherical.spherical_batch", "unhooking": "hung_plate.hung_plate_batch"}
"""Kernels that some museums need, by the models that run them."""


def _model(name: str, angle: float | None) -> None:
    model = model_named(name)
    sample = {name: low for name, (low, _) in model.trials.ranges.items()}
    sample.update(model.trials.sample)
    model.run(sine(1.0, 2.0, 1.0).excitation(angle), prepare(model, sample), 1, False)


_AHEAD: dict[str, Callable[[], object]] = {
    "standing.standing_batch": lambda: _model("standing", 0.0),
    "resultant.resultant_batch": lambda: oscillate_any(sine(1.0, 2.0, 1.0).excitation(None), np.ones(1), np.ones(1)),
    "bounds.slip_bounds_batch": lambda: slip_bounds(sine(1.0, 2.0, 1.0).excitation(None), np.ones(1), np.ones(1)),
    "spherical.spherical_batch": lambda: _model("swing_3d", None),
    "hung_plate.hung_plate_batch": lambda: _model("unhooking", 0.0),
}
"""What takes longest to compile, the longest first, and what runs it once on next to nothing.  Two workers that meet it
at once compile it both.  What the pictures of motions need is not among it: this process compiles that."""


def to_compile(models: Collection[str] = ()) -> tuple[str, ...]:
    """Return the kernels that workers may as well compile at once.

    Parameters
    ----------
    models : collection of str
        Names of models that will run, whose kernels not every museum needs.
    """
    some = {kernel for model, kernel in _MODELS.items() if model not in models}
    return tuple(name for name in _AHEAD if name not in some and not is_kept(name))


def compile_ahead(_shared: None, kernel: str) -> None:
    """Compile a kernel, by running it once on next to nothing."""
    _AHEAD[kernel]()


FEW = 200
"""Objects to be assessed for which other processes do not pay: each takes seconds to start, and does again some of what
all objects need.  Up to here threads share the kernels of one process, but only one does the rest: two processes found
400 objects in 0.62 of its time, and the demonstration in 0.55."""

SHOWN = 4_000
"""Objects to be shown for which other processes do not pay, unless they are there; and to be assessed, from which on
they end before anything is shown: what each remembers is a gigabyte."""

_MODULES = ("pipeline.night.unit_tasks", "pipeline.night.publication")
"""What a process that is started ahead makes ready meanwhile."""


def _begin_compiling(workers: WorkerPool, kernels: Sequence[str]) -> None:
    # What goes wrong in it goes wrong again where it is needed, and is said there; the run may also be over.
    with suppress(Exception, CancelledError):
        deque(workers.each(compile_ahead, None, kernels), maxlen=0)


class Staff:
    """Those who work in a run, until the end of the block; processes that assess draw the pages as well.

    Parameters
    ----------
    wanted
        How many of whom.
    """

    def __init__(self, wanted: Execution) -> None:
        self._wanted = wanted
        self._local: WorkerPool | None = None
        self._stack = ExitStack()
        self._asked: set[str] = set()
        self._compiling: list[Thread] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *problem: object) -> None:
        self._end()

    def call(self, objects: int) -> None:
        """Start processes for so many objects, if that pays, before it is known what there is to do."""
        if objects > FEW and not self._wanted.cluster:
            self._processes()

    def begin_compiling(self, models: Collection[str] = ()) -> None:
        """Let processes begin to compile what is not kept, while this one prepares the work.

        Parameters
        ----------
        models : collection of str, optional
            Names of those that will run, as far as it is known by now.
        """
        kernels = [name for name in to_compile(models) if name not in self._asked]
        if not kernels or self._wanted.cluster or (self._wanted.processes or cores()) < 2:
            return
        self._asked.update(kernels)
        self._compiling.append(Thread(target=_begin_compiling, args=(self._processes(), kernels), daemon=True))
        self._compiling[-1].start()

    @property
    def compiling(self) -> bool:
        """Whether processes compile, or did: what this one needs of the same sort may not be kept yet."""
        return bool(self._compiling)

    def _processes(self) -> WorkerPool:
        if self._local is None:
            local = pool(processes=self._wanted.processes or cores(), modules=_MODULES)
            self._local = self._stack.enter_context(local)
        return self._local

    @contextmanager
    def workers(
        self, objects: int, context: RunContext, *, showing: bool = False
    ) -> Iterator[tuple[WorkerPool, RunContext]]:
        """Yield who works on so many objects, with what they are to know."""
        if objects <= (SHOWN if showing and self._local is None else FEW):
            # Who compiles has begun before this process could, and is ready sooner.
            for each in self._compiling:
                each.join()
            with pool() as here:
                yield here, context
            return
        # What reading the records and drawing the motions took is there for the workers.
        give_back(objects)
        context = replace(context, threads=1)
        if self._wanted.cluster:
            # Its workers may not see our folders.
            with pool(address=self._wanted.cluster) as cluster:
                yield cluster, replace(context, kept=None)
            return
        yield self._processes(), context
        if objects > SHOWN:
            self._end()

    def _end(self) -> None:
        self._local = None
        self._stack.close()
