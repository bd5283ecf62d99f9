"""Executors of work: this process, on as many threads as there are cores (the kernels release the lock)."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Task = TypeVar("Task")
Answer = TypeVar("Answer")


class Threads:
    """Runs tasks on threads of this process; the answers come in the order of the tasks, whatever finished first."""

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers or len(os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else [0])

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """Run the work on each task.

        Parameters
        ----------
        work : callable
            Takes a task and returns its answer.
        tasks : sequence
            Of which each thread takes the next.

        Returns
        -------
        list
            The answers, in the order of the tasks.

        Raises
        ------
        Exception
            Whatever a task raises, the first in the order of the tasks; the others are not waited for.
        """
        if len(tasks) <= 1 or self.workers == 1:
            return [work(task) for task in tasks]
        with ThreadPoolExecutor(self.workers) as pool:
            return list(pool.map(work, tasks))
