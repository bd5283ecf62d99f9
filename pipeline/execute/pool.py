"""Worker pools: this process, processes of this machine, or the workers of a Dask cluster.

All three run the same function on the same tasks and hand the results back in the order of the tasks, so that nothing
depends on who was quicker.  A task that is run twice, because a worker died, gives the same and is taken once.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager

from pipeline.execute.workers import AHEAD, MissingClusterError, PoolError, Result, Shared, Task, WorkerPool

__all__ = ["AHEAD", "MissingClusterError", "PoolError", "SerialPool", "WorkerPool", "cores", "pool"]


class SerialPool:
    """Works in this process, one task after the other."""

    workers = 1

    def each(self, work: Callable[[Shared, Task], Result], shared: Shared, tasks: Iterable[Task]) -> Generator[Result]:
        """Yield what the function returns for each task; see `WorkerPool.each`.

        Parameters
        ----------
        work, shared, tasks : callable, object, iterable
            As of `WorkerPool.each`.

        Yields
        ------
        object
            The results, in the order of the tasks.
        """
        for task in tasks:
            yield work(shared, task)


@contextmanager
def pool(*, address: str = "", processes: int = 0, modules: Sequence[str] = ()) -> Iterator[WorkerPool]:
    """Start a pool of workers, and end it with the block, whatever happens.

    Parameters
    ----------
    address : str
        Of a Dask cluster's scheduler, such as "tcp://host:8786"; its workers have Kouros installed, and how it is
        reached safely (TLS) is Dask's own configuration.
    processes : int
        Of this machine, where no address is given; 0 or 1: this process.
    modules : sequence of str
        What such a process imports before it is given anything to do.

    Raises
    ------
    PoolError
        Where the cluster cannot be reached or has no workers, or Dask is not installed.
    """
    if address:
        try:
            from pipeline.execute.cluster import cluster_pool
        except ModuleNotFoundError as problem:
            if (problem.name or "").partition(".")[0] not in ("dask", "distributed"):
                raise
            raise MissingClusterError(
                f"[execution] cluster names {address}, and Dask is not installed; install it with "
                "`pip install 'kouros[cluster]'`, or leave cluster empty for processes of this machine"
            ) from problem
        with cluster_pool(address) as cluster:
            yield cluster
    elif processes > 1:
        from pipeline.execute.processes import ProcessPool

        with ProcessPool(processes, modules) as local:
            yield local
    else:
        yield SerialPool()


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
