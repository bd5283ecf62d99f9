"""The same night by this process, by processes of this machine and by a cluster: the same results, bit for bit."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from distributed import LocalCluster
from threadpoolctl import threadpool_limits

from pipeline.night import scheduler, staff
from pipeline.night.unit_tasks import Assessments
from pipeline.settings import Settings
from pipeline.store.results import Stored
from tests.museum import found, museum_of, night, vases
from tests.soak import SOAK

pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning"),
    pytest.mark.slow_file,
]

OBJECTS = vases(galleries=4 if SOAK else 3, each=2)


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """The museum after a night of this process alone, whose BLAS has two threads, where that of workers has one."""
    settings = museum_of(
        tmp_path_factory.mktemp("crews") / "alone", OBJECTS, threads=True, furnished=True, sampled=True
    )
    with threadpool_limits(limits=2, user_api="blas"):
        night(settings)
    return settings


@pytest.fixture
def shared(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three batches of two objects or more, and others do the work whatever its size."""
    for limit in ("BATCH", "WHOLE"):
        monkeypatch.setattr(scheduler, limit, 2)
    for module in (scheduler, staff):
        monkeypatch.setattr(module, "FEW", 0)
    monkeypatch.setattr(staff, "SHOWN", 0)


def files(settings: Settings) -> dict[str, bytes]:
    """Return pages and exports, without the run that is named in them and the time."""
    folder = settings.path("reports").joinpath("latest").resolve()
    run = folder.name.encode()
    names = [*(p.name for p in folder.glob("room-*.html")), "findings.jsonl", "objects.csv", "recommendations.csv"]
    stamp = run[:15]
    date = b"%s-%s-%s" % (stamp[:4], stamp[4:6], stamp[6:8])
    out = {}
    for name in names:
        text = (folder / name).read_bytes().replace(run, b"")
        out[name] = b"\n".join(line for line in text.split(b"\n") if date not in line)
    return out


@pytest.mark.long("night/test_jobs::test_findings_do_not_depend_on_the_rest_of_the_collection")
@pytest.mark.usefixtures("shared")
def test_two_processes_of_this_machine(alone: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Those that assess draw the pages as well.
    monkeypatch.setattr(staff, "SHOWN", len(OBJECTS))
    settings = museum_of(tmp_path / "two", OBJECTS, threads=True, furnished=True, sampled=True)
    execution = settings.execution.model_copy(update={"processes": 2})
    settings = settings.model_copy(update={"execution": execution})
    assert night(settings).fresh == len(OBJECTS)
    assert found(settings) == found(alone)
    assert files(settings) == files(alone)


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """A cluster of two workers that sees none of the museum's folders, as far as this test lets it."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as made:
        yield made


def of_a_cluster(folder: Path, cluster: LocalCluster) -> Settings:
    """The museum after a night whose work a cluster did."""
    settings = museum_of(folder, OBJECTS, threads=True, furnished=True, sampled=True)
    execution = settings.execution.model_copy(update={"cluster": cluster.scheduler_address})
    settings = settings.model_copy(update={"execution": execution})
    assert night(settings).fresh == len(OBJECTS)
    return settings


@pytest.mark.long("test_a_worker_with_several_threads")
@pytest.mark.usefixtures("shared")
def test_a_cluster_given_by_its_address(alone: Settings, cluster: LocalCluster, tmp_path: Path) -> None:
    settings = of_a_cluster(tmp_path / "cluster", cluster)
    assert found(settings).assessments == found(alone).assessments
    assert files(settings) == files(alone)


@pytest.mark.usefixtures("shared")
def test_a_worker_with_several_threads(alone: Settings, tmp_path: Path) -> None:
    """As `dask worker` has by default: batches that are worked on at once know nothing of each other.

    It speaks to the night as one of another machine does.
    """
    with LocalCluster(
        n_workers=1, threads_per_worker=4, processes=False, protocol="tcp", dashboard_address=":0"
    ) as made:
        settings = of_a_cluster(tmp_path / "threads", made)
    assert found(settings).assessments == found(alone).assessments
    assert files(settings) == files(alone)


@pytest.mark.long("execute/test_pool::test_a_process_that_is_killed_from_outside_is_replaced")
@pytest.mark.usefixtures("shared")
def test_a_worker_that_is_killed_in_the_middle_of_a_night_loses_nothing(
    alone: Settings, cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed when the first results are stored, while both workers are at later ones."""
    settings = museum_of(tmp_path / "killed", OBJECTS, threads=True, furnished=True, sampled=True)
    execution = settings.execution.model_copy(update={"cluster": cluster.scheduler_address})
    settings = settings.model_copy(update={"execution": execution})
    killed: list[int] = []

    def told(self: scheduler.Scheduler, came: Assessments) -> list[Stored]:
        if not killed:
            killed.append(next(iter(cluster.workers.values())).process.pid)
            os.kill(killed[0], signal.SIGKILL)
        return true(self, came)

    true = scheduler.Scheduler._told
    monkeypatch.setattr(scheduler.Scheduler, "_told", told)
    assert night(settings).fresh == len(OBJECTS)
    assert killed
    assert found(settings).assessments == found(alone).assessments
