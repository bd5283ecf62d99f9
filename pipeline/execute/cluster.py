"""The workers of a museum's own Dask cluster: the optional extra `cluster`."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import dask
from distributed import Client, KilledWorker

from pipeline.execute.workers import AHEAD, Pending, PoolError, Result, Shared, Task, collecting_rarely, in_order

logger = logging.getLogger(__name__)

PATIENCE_S = 10.0
"""How long a scheduler may take to answer."""


class ClusterPool:
    """Works on a Dask cluster, whose scheduler does a task again where the worker that had it died."""

    def __init__(self, client: Client, workers: int) -> None:
        self._client, self.workers = client, workers

    def each(self, work: Callable[[Shared, Task], Result], shared: Shared, tasks: Iterable[Task]) -> Generator[Result]:
        """Yield what the function returns for each task; see `pipeline.execute.workers.WorkerPool.each`.

        Parameters
        ----------
        work, shared, tasks : callable, object, iterable
            As of `WorkerPool.each`.

        Yields
        ------
        object
            The results, in the order of the tasks.
        """
        # As a task, which is done again where the worker that held it died; what is scattered would be lost.
        everywhere = self._client.submit(_itself, shared, pure=False)
        waiting: deque[Pending[Result]] = deque()

        def submit(task: Task) -> Any:
            return self._client.submit(_run, work, everywhere, task, pure=False)

        try:
            yield from in_order(submit, tasks, AHEAD * self.workers, waiting)
        except KilledWorker as problem:
            raise PoolError(
                f"workers of the cluster died of one part of the work ({problem}); give them more memory"
            ) from problem
        finally:
            self._client.cancel([*waiting, everywhere], force=True)


def _itself(shared: Shared) -> Shared:
    return shared


def _run(work: Callable[[Shared, Task], Result], shared: Shared, task: Task) -> Result:
    with collecting_rarely():
        return work(shared, task)


@contextmanager
def cluster_pool(address: str) -> Iterator[ClusterPool]:
    """Connect to a Dask cluster, and disconnect at the end of the block.

    Parameters
    ----------
    address : str
        Of the cluster's scheduler, such as "tcp://host:8786".

    Raises
    ------
    PoolError
        Where it cannot be reached or has no workers.
    """
    # The tasks are as large as they are meant to be.
    with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1GB"}):
        try:
            client = Client(address, timeout=PATIENCE_S, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as problem:
            raise PoolError(
                f"no Dask cluster answers at {address} ({problem}); start it, or correct its address"
            ) from problem
        with client:
            workers = len(client.scheduler_info(n_workers=-1)["workers"])
            if not workers:
                raise PoolError(f"the Dask cluster at {address} has no workers; start some (`dask worker {address}`)")
            logger.info("%d workers of the cluster at %s", workers, address)
            yield ClusterPool(client, workers)
