"""What analyses share and what they do not: the charts are everybody's, the histories those of one batch."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest

from pipeline.analysis import demands
from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context, remembered
from pipeline.analysis.response_charts import ChartCache
from pipeline.analysis.verdicts import LevelMotions
from pipeline.cache import Cache
from pipeline.execute import Threads
from pipeline.records import Columns, Furniture, Item, Motion, Support
from pipeline.records.numerics import HISTORIES


def test_batches_at_the_same_time_keep_the_histories_of_their_own_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two batches in two threads, with one cache of charts: neither finds later what only the other one ran."""
    charts, both = ChartCache(), Barrier(2)
    motion = Motion(0.01, np.random.default_rng(1).normal(0.0, 3.0, (3, 200)), "noise")
    level = LevelMotions("design", "max", (motion,))
    ran: list[float] = []
    true = demands._run

    def noted(task: demands._RunTask) -> Columns:
        model, _, _, values, _ = task
        if model.name == "sliding":
            ran.extend(values["friction_static"].tolist())
        return true(task)

    def batch(friction: float, file: str, *, together: bool = False) -> None:
        item = Item("1", "G", support=Support.FREESTANDING, furniture=Furniture.FLOOR,
                    height_m=0.1, base_width_m=0.3, base_depth_m=0.3,
                    friction=friction, clearance_m=0.01)  # fmt: skip
        with remembered(Cache(tmp_path), file) as histories:
            if together:
                both.wait(10)
            assess([classify(item)], [level], Context(Threads(1), charts=charts, histories=histories), HISTORIES)
            if together:
                both.wait(10)

    monkeypatch.setattr(demands, "_run", noted)
    with ThreadPoolExecutor(2) as pool:
        done = [pool.submit(batch, *task, together=True) for task in ((0.1, "a"), (0.15, "b"))]
        for one in done:
            one.result(30)
    assert sorted(ran) == [0.1, 0.15]
    ran.clear()
    batch(0.1, "a")
    batch(0.15, "b")
    assert not ran
    batch(0.15, "a")
    batch(0.1, "b")
    assert ran == [0.15, 0.1]


def test_work_that_fails_keeps_nothing(tmp_path: Path) -> None:
    def fails() -> None:
        with remembered(Cache(tmp_path), "a") as histories:
            histories.note("key", {"friction": np.array([0.1])}, {"displacement": np.array([1.0])})
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fails()
    assert not list(tmp_path.iterdir())
