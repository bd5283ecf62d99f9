"""Those who work in a run: this process, processes of this machine, or a cluster."""

from collections import deque
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from threading import Thread
from typing import Self

from pipeline.analysis.model_runs import prepare
from pipeline.execute.pool import WorkerPool, cores, pool
from pipeline.execute.workers import give_back
from pipeline.kernels import is_kept
from pipeline.models.standing import STANDING
from pipeline.motions.synthesis import sine
from pipeline.night.context import RunContext
from pipeline.settings import Execution

_KERNEL = "standing.standing_batch"
"""Takes longest to compile, and all that stands needs it: two workers that meet it at once compile it both."""


def to_compile() -> bool:
    """Return whether there is something that a worker may as well compile at once."""
    return not is_kept(_KERNEL)


def compile_ahead(_shared: None, _task: None) -> None:
    """Compile it, by running it once on next to nothing."""
    STANDING.run(sine(1.0, 2.0, 1.0).excitation(0.0), prepare(STANDING, STANDING.trials.sample), 1, False)


FEW = 200
"""Objects to be assessed for which other processes do not pay: each takes seconds to start, and does again some of what
all objects need.  Up to here threads share the kernels of one process, but only one does the rest: two processes found
400 objects in 0.62 of its time, and the demonstration in 0.55."""

SHOWN = 4_000
"""Objects to be shown for which other processes do not pay, unless they are there; and to be assessed, from which on
they end before anything is shown: what each remembers is a gigabyte."""

_MODULES = ("pipeline.night.unit_tasks", "pipeline.night.publication")
"""What a process that is started ahead makes ready meanwhile."""


def _begin_compiling(workers: WorkerPool) -> None:
    # What goes wrong in it goes wrong again where it is needed, and is said there; the run may also be over.
    with suppress(Exception, CancelledError):
        deque(workers.each(compile_ahead, None, [None]), maxlen=0)


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

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *problem: object) -> None:
        self._end()

    def call(self, objects: int) -> None:
        """Start processes for so many objects, if that pays, before it is known what there is to do."""
        if objects > FEW and not self._wanted.cluster:
            self._processes()

    def _processes(self) -> WorkerPool:
        if self._local is None:
            local = pool(processes=self._wanted.processes or cores(), modules=_MODULES)
            self._local = self._stack.enter_context(local)
            if to_compile():
                Thread(target=_begin_compiling, args=(self._local,), daemon=True).start()
        return self._local

    @contextmanager
    def workers(
        self, objects: int, context: RunContext, *, showing: bool = False
    ) -> Iterator[tuple[WorkerPool, RunContext]]:
        """Yield who works on so many objects, with what they are to know."""
        if objects <= (SHOWN if showing and self._local is None else FEW):
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
