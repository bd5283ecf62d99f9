"""Crews: the same results from this process, from processes and from a cluster, whatever happens to a worker."""

import os
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from distributed import LocalCluster

from pipeline.execute.crew import AHEAD, Crew, CrewError, crew

from .work import Shared, dies, dies_once, fails, product, slow

# Dask's own threads and sockets are still closing when a test ends.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """A cluster of two worker processes, which a crew is given the address of."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as made:
        yield made


@pytest.fixture
def hands(cluster: LocalCluster) -> Iterator[Crew]:
    """A crew on that cluster."""
    with crew(address=cluster.scheduler_address) as found:
        yield found


def test_this_process_works_alone_and_in_order(tmp_path: Path) -> None:
    with crew() as alone:
        done = list(alone.each(product, Shared(tmp_path), range(5)))
    assert done == [(3 * n, os.getpid()) for n in range(5)]


def test_a_cluster_gives_the_same_in_the_same_order_by_other_processes(hands: Crew, tmp_path: Path) -> None:
    done = list(hands.each(product, Shared(tmp_path), range(40)))
    assert [number for number, _ in done] == [3 * n for n in range(40)]
    assert os.getpid() not in {who for _, who in done}
    assert len({who for _, who in done}) == 2


def test_a_dying_worker_loses_nothing_and_doubles_nothing(hands: Crew, tmp_path: Path) -> None:
    assert list(hands.each(dies_once, Shared(tmp_path), range(12))) == [3 * n for n in range(12)]
    assert (tmp_path / "died").exists()


def test_a_crew_leaves_the_environment_as_it_was(tmp_path: Path) -> None:
    """Dask gives its workers one thread of BLAS by way of this process, and the hash seed besides."""
    before = dict(os.environ)
    with crew(processes=2) as hands:
        assert list(hands.each(product, Shared(tmp_path), range(4)))
    assert dict(os.environ) == before


def test_what_kills_every_worker_is_named_instead_of_tried_for_ever(tmp_path: Path) -> None:
    with crew(processes=2) as hands, pytest.raises(CrewError, match="workers died of one part of the work"):
        list(hands.each(dies, Shared(tmp_path), range(4)))


def test_an_error_comes_back_as_it_was_raised(hands: Crew, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="errand 4 cannot be done"):
        list(hands.each(fails, Shared(tmp_path), range(40)))


def test_whoever_stops_listening_leaves_nothing_running(hands: Crew, cluster: LocalCluster, tmp_path: Path) -> None:
    with closing(hands.each(slow, Shared(tmp_path), range(100))) as done:
        assert next(done) == 0
    limit = time.monotonic() + 20.0
    while cluster.scheduler.tasks and time.monotonic() < limit:
        time.sleep(0.1)
    assert not cluster.scheduler.tasks
    # No more than those that were handed out ahead were ever begun.
    assert len(list(tmp_path.glob("begun-*"))) <= 2 * AHEAD + 1


def test_a_cluster_that_does_not_answer_is_named() -> None:
    with (
        pytest.raises(CrewError, match=r"no Dask cluster answers at tcp://127\.0\.0\.1:9 "),
        crew(address="tcp://127.0.0.1:9"),
    ):
        pass
