"""Processes of this machine that share the work, by the standard library's multiprocessing.

`concurrent.futures.ProcessPoolExecutor` would be less code, but when one of its processes dies it drops the work of all
of them and does not say which task was at fault, and before Python 3.14 it cannot be told to kill its processes.
"""

from __future__ import annotations

import importlib
import logging
import multiprocessing
import os
import pickle  # nosec B403 - between this process and those that it started
import signal
import sys
import threading
import traceback
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Self

from pipeline.errors import raised_at
from pipeline.execute.workers import (
    AHEAD,
    DEATHS,
    Pending,
    PoolError,
    Result,
    Shared,
    Task,
    collecting_rarely,
    in_order,
)

logger = logging.getLogger(__name__)

_SPAWN = multiprocessing.get_context("spawn")
"""Processes start anew on every operating system: what is forked would hold locks of threads that it does not have."""


class _Worker:
    """A process of this machine, and the pipe to it; used by one thread at a time."""

    def __init__(self, modules: Sequence[str]) -> None:
        self._pipe, theirs = _SPAWN.Pipe()
        # A daemon: it is ended with this process.
        self._process: BaseProcess = _SPAWN.Process(target=_serve, args=(theirs, tuple(modules)), daemon=True)
        self._process.start()
        theirs.close()
        self._has: object = None

    def run(self, call: _Call, task: object) -> tuple[bool, Any]:
        """Return whether a task was done, and what came of it: a result or what was raised.

        Raises
        ------
        EOFError, OSError
            The process died.
        """
        pickled = pickle.dumps(task, pickle.HIGHEST_PROTOCOL)
        self._pipe.send_bytes(b"" if self._has is call else call.pickled)
        self._has = call
        self._pipe.send_bytes(pickled)
        done, outcome = pickle.loads(self._pipe.recv_bytes())  # noqa: S301  # nosec B301 - from a process of our own
        return done, outcome

    def end(self) -> None:
        """End the process, whatever it is at."""
        self._process.kill()

    def close(self) -> None:
        """Wait for the process, which was told to end, and let go of it."""
        self._process.join()
        self._pipe.close()


@dataclass(frozen=True, eq=False)
class _Call:
    """A function and its first argument, pickled once for all workers."""

    pickled: bytes


class ProcessPool:
    """Works in processes of this machine; one that dies is replaced, and its task is done again.

    Each process has a thread here that waits for it, so that the next task goes to whoever is free.
    """

    def __init__(self, workers: int, modules: Sequence[str] = ()) -> None:
        self.workers = workers
        self._modules = modules
        self._lock = threading.Lock()
        self._closed = False
        self._idle: deque[_Worker] = deque()
        self._all: set[_Worker] = set()
        self._threads = ThreadPoolExecutor(workers, thread_name_prefix="kouros-worker")

    def __enter__(self) -> Self:
        try:
            for _ in range(self.workers):
                self._idle.append(self._started())
        except BaseException:
            self.close()
            raise
        logger.info("%d worker processes started", self.workers)
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all processes at once; what is being worked on is dropped."""
        with self._lock:
            self._closed = True
            for worker in self._all:
                worker.end()
        self._threads.shutdown(cancel_futures=True)
        for worker in self._all:
            worker.close()

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
        call = _Call(pickle.dumps((work, shared), pickle.HIGHEST_PROTOCOL))
        waiting: deque[Pending[Result]] = deque()

        def submit(task: Task) -> Future[Any]:
            return self._threads.submit(self._run, call, task)

        try:
            yield from in_order(submit, tasks, AHEAD * self.workers, waiting)
        finally:
            for future in waiting:
                if isinstance(future, Future):
                    future.cancel()

    def _run(self, call: _Call, task: object) -> Any:
        for death in range(1, DEATHS + 1):
            # As many threads as workers: whoever runs this finds one.
            worker = self._idle.pop()
            try:
                done, outcome = worker.run(call, task)
            except (EOFError, OSError):
                logger.warning("a worker process died of a task (%d of %d times)", death, DEATHS)
                self._idle.append(self._replaced(worker))
                continue
            except BaseException:
                self._idle.append(worker)  # The task cannot be pickled, which is no fault of the worker.
                raise
            self._idle.append(worker)
            if done:
                return outcome
            raise outcome
        raise PoolError(
            f"{DEATHS} workers died of one part of the work; give the machine more memory, or work with fewer at a "
            "time ([execution] processes)"
        )

    def _started(self) -> _Worker:
        with self._lock:
            if self._closed:
                raise CancelledError
            worker = _Worker(self._modules)
            self._all.add(worker)
            return worker

    def _replaced(self, dead: _Worker) -> _Worker:
        fresh = self._started()
        with self._lock:
            self._all.discard(dead)
        dead.end()
        dead.close()
        return fresh


def _serve(pipe: Connection, modules: Sequence[str]) -> None:
    """Do in a worker what comes by the pipe, until it is closed or the process that started this one is gone."""
    # Ctrl-C goes to all processes of a terminal: the one that started this one ends it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _one_thread_each()
    for name in modules:
        importlib.import_module(name)
    call: tuple[bool, Any] = (False, None)
    # Memory that ran out is given back whole by ending; the task is done again by another.
    with suppress(EOFError, OSError, MemoryError), collecting_rarely():
        while True:
            fresh, task = pipe.recv_bytes(), pipe.recv_bytes()
            if fresh:
                call = _attempt(pickle.loads, fresh)
            pipe.send_bytes(_pickled(_attempt(_work, *call[1], task) if call[0] else call))


def _work(work: Callable[[Any, Any], Any], shared: object, task: bytes) -> Any:
    return work(shared, pickle.loads(task))  # noqa: S301  # nosec B301 - from the process that started it


def _attempt(function: Callable[..., Any], *arguments: Any) -> tuple[bool, Any]:
    """Return whether a call succeeded, and what it returned or raised."""
    try:
        return True, function(*arguments)
    except MemoryError:
        raise
    except Exception as problem:  # noqa: BLE001 - it is raised where the result is wanted
        return False, problem


def _pickled(outcome: tuple[bool, Any]) -> bytes:
    done, value = outcome
    if done:
        done, value = _attempt(pickle.dumps, (True, value), pickle.HIGHEST_PROTOCOL)
        if done:
            return bytes(value)
    text = "".join(traceback.format_exception(value))
    try:
        value.raised_at = raised_at(value)
        value.add_note(f"In a worker process:\n{text}")
        pickled = pickle.dumps((False, value), pickle.HIGHEST_PROTOCOL)
        pickle.loads(pickled)  # noqa: S301  # nosec B301 - some exceptions can be pickled and not be made again
    except Exception:  # noqa: BLE001 - whatever the pickling of somebody's class raises
        return pickle.dumps((False, RuntimeError(f"{type(value).__name__}: {value}\n{text}")))
    return pickled


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _one_thread_each() -> None:
    """Keep libraries of linear algebra to one thread: there are as many processes as cores."""
    os.environ.update({f"{name}_NUM_THREADS": "1" for name in ("OMP", "MKL", "OPENBLAS", "NUMBA", "NUMEXPR")})
    if "numpy" in sys.modules:  # It has read the environment already.
        from threadpoolctl import threadpool_limits

        threadpool_limits(limits=1)
