"""Who works on the sheets of a run: this process, processes of this machine, or the workers of a Dask cluster.

All three do the same work on the same errands and hand the results back in the order of the errands, so that nothing
depends on who was quicker.  An errand that is done twice, because a worker died, gives the same and is taken once.
"""

from __future__ import annotations

import gc
import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from pipeline.errors import KourosError

if TYPE_CHECKING:
    from distributed import Client, Future

Shared = TypeVar("Shared")
Errand = TypeVar("Errand")
Done = TypeVar("Done")

AHEAD = 2
"""Errands that are handed out for each worker at a time: nobody waits, and memory stays bounded by them."""

RARELY = (100_000, 20, 50)
"""How often Python looks for garbage that refers to itself, as `gc.set_threshold` takes it, while there is work."""

DEATHS = 3
"""Workers that may die of one errand before it is given up."""


class CrewError(KourosError):
    """The workers cannot be reached, or die of an errand."""

    exit_code = 1


class Alone:
    """Works in this process, one errand after the other."""

    workers = 1

    def each(
        self, work: Callable[[Shared, Errand], Done], shared: Shared, errands: Iterable[Errand]
    ) -> Generator[Done]:
        """Yield what comes of each errand, in their order."""
        for errand in errands:
            yield work(shared, errand)


class Dask:
    """Works on a Dask cluster: one that was started for this run, or one of the museum's own."""

    def __init__(self, client: Client, workers: int) -> None:
        self._client, self.workers = client, workers

    def each(
        self, work: Callable[[Shared, Errand], Done], shared: Shared, errands: Iterable[Errand]
    ) -> Generator[Done]:
        """Yield what comes of each errand, in their order; at the end, or when nobody wants more, nothing is left.

        raises : whatever an errand raises; CrewError where workers die of it
        """
        from distributed import KilledWorker

        # As a task, which is done again where the worker that held it died; what is scattered would be lost.
        brief = self._client.submit(_given, shared, pure=False)
        waiting: deque[Future[Any]] = deque()
        try:
            source = iter(errands)
            for errand in source:
                waiting.append(self._client.submit(_done, work, brief, errand, pure=False))
                if len(waiting) >= AHEAD * self.workers:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        except KilledWorker as problem:
            raise CrewError(
                f"{DEATHS} workers died of one part of the work ({problem}); give them more memory, or fewer at a time "
                "([execution] processes)"
            ) from problem
        finally:
            self._client.cancel([*waiting, brief], force=True)


def _given(shared: Shared) -> Shared:
    return shared


def _done(work: Callable[[Shared, Errand], Done], shared: Shared, errand: Errand) -> Done:
    # What an errand makes stays to its end: to look for garbage in it every 700 objects takes an eighth of the time.
    before = gc.get_threshold()
    gc.set_threshold(*RARELY)
    try:
        return work(shared, errand)
    finally:
        gc.set_threshold(*before)


Crew = Alone | Dask


@contextmanager
def crew(*, address: str = "", processes: int = 0) -> Iterator[Crew]:
    """Call a crew together, and send it home at the end, whatever happens.

    address   : of a Dask cluster's scheduler, such as "tcp://host:8786"; its workers have Kouros installed, and how it
                is reached safely (TLS) is Dask's own configuration
    processes : of this machine, where no address is given; 0 or 1: this process
    raises    : CrewError where the cluster cannot be reached or has no workers
    """
    if not address and processes <= 1:
        yield Alone()
        return
    import dask
    from distributed import Client, LocalCluster

    settings: dict[str, Any] = {
        "distributed.scheduler.allowed-failures": DEATHS,
        # The errands are as large as they are meant to be.
        "distributed.admin.large-graph-warning-threshold": "1GB",
        # One thread each.  Dask would also have every large array given back to the system when it is freed
        # (MALLOC_TRIM_THRESHOLD_), and fetched from it page by page when the next is made: a sixth of the night.
        "distributed.nanny.pre-spawn-environ": {
            f"{name}_NUM_THREADS": 1 for name in ("OMP", "MKL", "OPENBLAS", "NUMBA", "NUMEXPR")
        },
    }
    with dask.config.set(settings), _environment():
        if not address:
            with (
                # Any free port for the web page that nobody looks at: 8787 may be taken.
                LocalCluster(
                    n_workers=processes, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
                ) as cluster,
                Client(cluster) as client,
            ):
                yield Dask(client, processes)
            return
        try:
            client = Client(address, timeout="10s", set_as_default=False)
        except (OSError, TimeoutError, ValueError) as problem:
            raise CrewError(
                f"no Dask cluster answers at {address} ({problem}); start it, or correct its address"
            ) from (problem)
        with client:
            workers = len(client.scheduler_info(n_workers=-1)["workers"])
            if not workers:
                raise CrewError(f"the Dask cluster at {address} has no workers; start some (`dask worker {address}`)")
            yield Dask(client, workers)


@contextmanager
def _environment() -> Iterator[None]:
    """Put back what Dask leaves in the environment of this process when it starts workers: what they start with."""
    before = dict(os.environ)
    try:
        yield
    finally:
        for name in os.environ.keys() - before.keys():
            del os.environ[name]
        os.environ.update(before)


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
