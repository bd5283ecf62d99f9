"""Worker pools: the same results from this process, from processes and from a cluster, whatever happens to a worker."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from threading import Thread

import pytest
from distributed import LocalCluster

from pipeline.errors import fault_words
from pipeline.execute.pool import AHEAD, MissingClusterError, PoolError, WorkerPool, pool

from . import work
from .work import Shared, dies, dies_once, fails, product, runs_out, slow

# Dask's own threads and sockets are still closing when a test ends.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """A cluster of two worker processes, which a pool is given the address of."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as made:
        yield made


@pytest.fixture(scope="module")
def processes() -> Iterator[WorkerPool]:
    """Two processes of this machine, started where nobody else has seen to it that BLAS has one thread."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OPENBLAS_NUM_THREADS", "2")
        with pool(processes=2) as made:
            yield made


@pytest.fixture(params=["processes", "cluster"])
def workers(request: pytest.FixtureRequest, cluster: LocalCluster) -> Iterator[WorkerPool]:
    """Two workers of each kind."""
    if request.param == "processes":
        yield request.getfixturevalue("processes")
        return
    with pool(address=cluster.scheduler_address) as made:
        yield made


def until(true: Callable[[], object], seconds: float = 20.0) -> bool:
    """Wait until something is so, and say whether it came."""
    limit = time.monotonic() + seconds
    while not true() and time.monotonic() < limit:
        time.sleep(0.05)
    return bool(true())


def alive(pid: int) -> bool:
    """Say whether a process that is nobody's child here is there."""
    with suppress(ProcessLookupError, FileNotFoundError):
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text("utf-8").rpartition(")")[2].split()[0] != "Z"
    return False


def test_this_process_works_alone_and_in_order(tmp_path: Path) -> None:
    with pool() as alone:
        done = list(alone.each(product, Shared(tmp_path), range(5)))
    assert done == [(3 * n, os.getpid()) for n in range(5)]


def test_workers_give_the_same_in_the_same_order_by_other_processes(workers: WorkerPool, tmp_path: Path) -> None:
    done = list(workers.each(product, Shared(tmp_path), range(40)))
    assert [number for number, _ in done] == [3 * n for n in range(40)]
    assert os.getpid() not in {who for _, who in done}
    assert workers.workers == 2


def test_all_workers_work(workers: WorkerPool, tmp_path: Path) -> None:
    """Ten tasks of 0.3 s each take 1.5 s of two, and 3 s of one."""
    list(workers.each(product, Shared(tmp_path), range(4)))
    began = time.monotonic()
    assert list(workers.each(slow, Shared(tmp_path), range(10))) == list(range(10))
    assert time.monotonic() - began < 2.8


def test_a_pool_can_be_asked_again_for_something_else(workers: WorkerPool, tmp_path: Path) -> None:
    for factor in (2, 5):
        done = list(workers.each(product, Shared(tmp_path, factor), range(4)))
        assert [number for number, _ in done] == [factor * n for n in range(4)]


@pytest.mark.parametrize(("task", "mark"), [(dies_once, "died"), (runs_out, "full")])
def test_a_dying_worker_loses_nothing_and_doubles_nothing(
    processes: WorkerPool, tmp_path: Path, task: Callable[[Shared, int], int], mark: str
) -> None:
    """It is killed, or its memory runs out."""
    assert list(processes.each(task, Shared(tmp_path), range(12))) == [3 * n for n in range(12)]
    assert (tmp_path / mark).exists()


def test_a_dying_worker_of_a_cluster_loses_nothing_and_doubles_nothing(cluster: LocalCluster, tmp_path: Path) -> None:
    with pool(address=cluster.scheduler_address) as made:
        assert list(made.each(dies_once, Shared(tmp_path), range(12))) == [3 * n for n in range(12)]
    assert (tmp_path / "died").exists()


def test_a_process_that_is_killed_from_outside_is_replaced(processes: WorkerPool, tmp_path: Path) -> None:
    with closing(processes.each(slow, Shared(tmp_path), range(12))) as done:
        assert next(done) == 0
        victim = next(iter(processes._all))._process  # type: ignore[attr-defined]
        victim.kill()
        assert list(done) == list(range(1, 12))
    assert not victim.is_alive()


def test_workers_leave_the_environment_as_it_was(workers: WorkerPool, tmp_path: Path) -> None:
    before = dict(os.environ)
    assert list(workers.each(product, Shared(tmp_path), range(4)))
    assert dict(os.environ) == before


def test_a_process_keeps_linear_algebra_to_one_thread(processes: WorkerPool, tmp_path: Path) -> None:
    """There are as many processes as cores."""
    assert next(processes.each(work.threads, Shared(tmp_path), [0])) == {1}


def test_what_kills_every_worker_is_named_instead_of_tried_for_ever(processes: WorkerPool, tmp_path: Path) -> None:
    with pytest.raises(PoolError, match="3 workers died of one part of the work"):
        list(processes.each(dies, Shared(tmp_path), range(4)))
    # And the pool can still be used.
    assert len(list(processes.each(product, Shared(tmp_path), range(4)))) == 4


def test_what_kills_every_worker_of_a_cluster_is_named(cluster: LocalCluster, tmp_path: Path) -> None:
    """As Dask says it: to kill its workers again and again takes it minutes on a machine that is busy."""
    with (
        pool(address=cluster.scheduler_address) as workers,
        pytest.raises(PoolError, match="workers of the cluster died of one part of the work"),
    ):
        list(workers.each(work.given_up, Shared(tmp_path), range(4)))


def test_an_error_comes_back_as_it_was_raised(workers: WorkerPool, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="task 4 cannot be done") as caught:
        list(workers.each(fails, Shared(tmp_path), range(40)))
    assert str(caught.value) == "task 4 cannot be done"


def test_an_unexpected_error_of_a_process_says_where_in_kouros_it_was_raised(
    processes: WorkerPool, tmp_path: Path
) -> None:
    from pipeline.quantities import counted

    with pytest.raises(TypeError) as caught:
        list(processes.each(work.calls, Shared(tmp_path), [counted]))
    assert "(quantities.py, line " in fault_words(caught.value)
    assert "In a worker process" in caught.value.__notes__[0]


def test_what_cannot_be_sent_is_an_error_and_not_a_death(processes: WorkerPool, tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="OddError: this and 0"):
        list(processes.each(work.fails_oddly, Shared(tmp_path), [0]))
    with pytest.raises((AttributeError, TypeError), match="pickle"):
        list(processes.each(work.unsendable, Shared(tmp_path), [0]))
    with pytest.raises((AttributeError, TypeError), match="pickle"):
        list(processes.each(product, Shared(tmp_path), [lambda: None]))  # type: ignore[list-item]
    assert len(list(processes.each(product, Shared(tmp_path), range(4)))) == 4


def test_no_more_is_read_ahead_than_workers_need(workers: WorkerPool, tmp_path: Path) -> None:
    read: list[int] = []

    def tasks() -> Iterator[int]:
        for number in range(100):
            read.append(number)
            yield number

    with closing(workers.each(product, Shared(tmp_path), tasks())) as done:
        for at, _ in enumerate(done):
            assert len(read) <= at + 2 * AHEAD
            if at == 20:
                break


def test_whoever_stops_listening_leaves_nothing_running(cluster: LocalCluster, tmp_path: Path) -> None:
    with (
        pool(address=cluster.scheduler_address) as workers,
        closing(workers.each(slow, Shared(tmp_path), range(100))) as done,
    ):
        assert next(done) == 0
    assert until(lambda: not cluster.scheduler.tasks)
    # No more than those that were handed out ahead were ever begun.
    assert len(list(tmp_path.glob("begun-*"))) <= 2 * AHEAD + 1


def test_whoever_stops_listening_to_processes_leaves_nothing_running(processes: WorkerPool, tmp_path: Path) -> None:
    with closing(processes.each(slow, Shared(tmp_path), range(100))) as done:
        assert next(done) == 0
    begun = len(list(tmp_path.glob("begun-*")))
    assert begun <= 2 * AHEAD + 1
    time.sleep(1.0)
    # What was being worked on came to its end, and nothing else was begun.
    assert len(list(tmp_path.glob("begun-*"))) <= begun + 2


def test_a_pool_ends_its_processes_at_once_whatever_they_are_at(tmp_path: Path) -> None:
    before = set(multiprocessing.active_children())
    with pool(processes=2) as made:
        done = made.each(work.sleeps, Shared(tmp_path), range(100))
        with pytest.raises(KeyboardInterrupt):
            _interrupted(done, tmp_path)
        ours = set(multiprocessing.active_children()) - before
        began = time.monotonic()
    assert time.monotonic() - began < 1.0
    assert len(ours) == 2
    assert not any(one.is_alive() for one in ours)


def _interrupted(done: Iterator[int], folder: Path) -> None:
    """Wait for a result that takes a minute, as Ctrl-C comes."""

    def stop() -> None:
        if until(lambda: len(list(folder.glob("sleeps-*"))) == 2):
            os.kill(os.getpid(), signal.SIGINT)

    Thread(target=stop, daemon=True).start()
    next(done)


def test_no_process_outlives_the_one_that_started_it(tmp_path: Path) -> None:
    """Killed while its workers are at work, which no block of Python hears of."""
    root = Path(__file__).resolve().parents[2]
    code = (
        "from pathlib import Path\nfrom pipeline.execute.pool import pool\nfrom tests.execute import work\n"
        f"with pool(processes=2) as made: list(made.each(work.sleeps, work.Shared(Path({str(tmp_path)!r})), range(9)))"
    )
    process = subprocess.Popen([sys.executable, "-c", code], cwd=root)
    try:
        assert until(lambda: len(list(tmp_path.glob("sleeps-*"))) == 2)
        pids = [int(mark.read_text("utf-8")) for mark in tmp_path.glob("sleeps-*")]
        assert all(alive(pid) for pid in pids)
    finally:
        process.kill()
        process.wait()
    assert until(lambda: not any(alive(pid) for pid in pids), 5.0)


def test_a_cluster_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pipeline.execute.cluster.PATIENCE_S", 1.0)
    with (
        pytest.raises(PoolError, match=r"no Dask cluster answers at tcp://127\.0\.0\.1:9 "),
        pool(address="tcp://127.0.0.1:9"),
    ):
        pass


def test_processes_need_no_dask_and_a_cluster_without_it_names_the_extra(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("dask", "distributed"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(sys.modules, "pipeline.execute.cluster", raising=False)
    with pool(processes=2) as made:
        assert [number for number, _ in made.each(product, Shared(tmp_path), range(3))] == [0, 3, 6]
    with (
        pytest.raises(MissingClusterError, match=r"pip install 'kouros\[cluster\]'") as caught,
        pool(address="tcp://127.0.0.1:9"),
    ):
        pass
    assert caught.value.exit_code == 2
