"""Charts kept in files: found again bit for bit, never believed when damaged, gone when nobody needs them."""

from __future__ import annotations

import json
import os
import threading
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from shaking import along_x, random_motion

from pipeline import respond
from pipeline.analysis.chart_runs import response_chart
from pipeline.analysis.response_charts import ChartCache, ChartWarning, ResponseChart
from pipeline.analysis.response_charts import chart_cache as keeping
from pipeline.records import Motion, Numerics
from pipeline.resources import arrays

DAY = 86_400.0


class RebuiltError(Exception):
    pass


def refuse(*_: object, **__: object) -> ResponseChart:
    raise RebuiltError


def ask(motion: Motion, folder: Path, friction: float = 0.1234, **settings: float) -> float:
    table = respond(
        "sliding", motion, fidelity="chart", charts=ChartCache(folder), friction_static=friction, **settings
    )
    return float(table["displacement"].iloc[0])


def files(folder: Path) -> set[str]:
    return {file.name for file in folder.iterdir()}


def aged(folder: Path, names: set[str], days: float) -> None:
    """Let files be as if they had been used last so many days ago."""
    at = time.time() - days * DAY
    for name in names:
        os.utime(folder / name, (at, at))


def test_charts_are_found_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bit for bit, by what they depend on; another kernel, code, motion, direction or tolerance has another chart."""
    motion = random_motion(3)
    first = ask(motion, tmp_path, tolerance=1e-2)
    (kept,) = tmp_path.iterdir()
    assert motion.hash[:16] in kept.name
    assert keeping.KERNEL_VERSION in kept.name
    monkeypatch.setattr(ResponseChart, "build", refuse)
    assert ask(motion, tmp_path, tolerance=1e-2) == first
    with pytest.raises(RebuiltError):
        ask(motion, tmp_path, tolerance=2e-2)
    with pytest.raises(RebuiltError):
        ask(motion, tmp_path, tolerance=1e-2, directions=1.0)
    response_chart("sliding", motion, numerics=Numerics(tolerance=1e-2), charts=ChartCache(tmp_path))
    with pytest.raises(RebuiltError):
        response_chart("sliding", motion, numerics=Numerics(tolerance=1e-2, first=True), charts=ChartCache(tmp_path))
    with pytest.raises(RebuiltError):
        ask(motion.scaled(1.01, "another"), tmp_path, tolerance=1e-2)
    for name, another in (("KERNEL_VERSION", "another"), ("_code", lambda: "another")):
        with monkeypatch.context() as patch:
            patch.setattr(keeping, name, another)
            with pytest.raises(RebuiltError):
                ask(motion, tmp_path, tolerance=1e-2)


def test_every_number_of_a_chart_is_found_again(tmp_path: Path) -> None:
    """All columns, bounds, notes and marks of what is unresolved, at 1,000 values, and nothing is left aside."""
    given = {"length": np.geomspace(0.1, 20.0, 1000), "damping": 0.0, "tolerance": 1e-2}
    tables = [
        respond("swing", random_motion(5), fidelity="chart", charts=ChartCache(tmp_path), **given) for _ in range(2)
    ]
    assert tables[0].equals(tables[1])
    assert not any(name.startswith(".") for name in files(tmp_path))


def flipped(good: bytes, at: int) -> bytes:
    return good[:at] + bytes([good[at] ^ 0x10]) + good[at + 1 :]


def test_a_damaged_chart_is_built_again_and_said(tmp_path: Path) -> None:
    """Cut short, emptied, overwritten, or with one bit flipped, anywhere: the answer stays, and the file is mended."""
    motion = along_x(0.5 * 9.81 * np.sin(np.arange(60.0)), 0.02)
    first = ask(motion, tmp_path, tolerance=3e-2)
    (kept,) = tmp_path.iterdir()
    good = kept.read_bytes()
    rng = np.random.default_rng(0)
    for damage in (b"", good[: len(good) // 2], good[:-1], b"PK" + bytes(100), rng.bytes(5000)):
        kept.write_bytes(damage)
        with pytest.warns(ChartWarning, match=f"{kept.name}: is no chart .*; it is built again"):
            assert ask(motion, tmp_path, tolerance=3e-2) == first
        assert len(kept.read_bytes()) == len(good)
    for at in rng.integers(0, len(good), 60).tolist():
        kept.write_bytes(flipped(good, at))
        with warnings.catch_warnings():
            # A bit of the archive's own headers may mean nothing.
            warnings.simplefilter("ignore", ChartWarning)
            assert ask(motion, tmp_path, tolerance=3e-2) == first


def test_a_foreign_chart_is_not_believed(tmp_path: Path) -> None:
    """Another's chart under this name; numbers that were changed by hand; pickled objects; a file beyond all size."""
    motion = random_motion(3)
    first = ask(motion, tmp_path, tolerance=1e-2)
    (kept,) = tmp_path.iterdir()
    good = kept.read_bytes()
    ask(motion, tmp_path, tolerance=3e-2)
    (other,) = set(tmp_path.iterdir()) - {kept}
    with np.load(kept) as archive:
        parts = {name: archive[name] for name in archive.files}
    for name, wrong in (
        ("values", 1.01 * parts["values"]),
        ("edges", parts["edges"][:-1]),
        ("resolved", ~parts["resolved"]),
        ("said", np.array(json.dumps({**json.loads(str(parts["said"])), "low": 0.02}))),
        ("note", np.array([object()], dtype=object)),
    ):
        np.savez(kept, **{**parts, name: wrong})
        with pytest.warns(ChartWarning, match="is built again"):
            assert ask(motion, tmp_path, tolerance=1e-2) == first
    for wrong_bytes in (other.read_bytes(), good + bytes(keeping.LARGEST)):
        kept.write_bytes(wrong_bytes)
        with pytest.warns(ChartWarning, match=r"another chart under this name|too large"):
            assert ask(motion, tmp_path, tolerance=1e-2) == first


def test_a_folder_that_cannot_be_written_costs_nothing_but_time(tmp_path: Path) -> None:
    file = tmp_path / "no-folder"
    file.write_text("a file")
    with pytest.warns(ChartWarning, match="Not a directory"):
        assert ask(random_motion(3), file, tolerance=1e-2) == ask(random_motion(3), tmp_path, tolerance=1e-2)
    assert file.read_text() == "a file"
    ChartCache(file).tidy(days=1.0, most_bytes=0)
    ChartCache(tmp_path / "absent").tidy(days=1.0, most_bytes=0)
    ChartCache().tidy(days=1.0, most_bytes=0)


def test_what_nobody_asks_for_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Charts of old versions, of motions that were not used for long, what a dead process left; nothing else."""
    used, unused, running = (random_motion(seed, n=100) for seed in (3, 4, 5))
    with monkeypatch.context() as patch:
        patch.setattr(keeping, "KERNEL_VERSION", "0123456789ab")
        ask(used, tmp_path, tolerance=1e-1)
    (old,) = files(tmp_path)
    names: dict[str, set[str]] = {}
    for name, motion in (("used", used), ("unused", unused), ("running", running)):
        before = files(tmp_path)
        ask(motion, tmp_path, tolerance=1e-1)
        ask(motion, tmp_path, tolerance=2e-1)
        names[name] = files(tmp_path) - before
    # What is being written is not a chart yet: whoever takes the lock sweeps it, see test_retention.py.
    (tmp_path / ".chart.npz.77-88.kouros.partial").write_bytes(b"half")
    (tmp_path / "mine.npz").write_bytes(b"of the user")
    others = {".chart.npz.77-88.kouros.partial", "mine.npz"}
    aged(tmp_path, files(tmp_path), 40.0)
    # To ask for one chart is to use its motion.
    ask(used, tmp_path, tolerance=1e-1)
    ChartCache(tmp_path).tidy(days=50.0, most_bytes=10**9)
    assert files(tmp_path) == names["used"] | names["unused"] | names["running"] | others
    assert old not in files(tmp_path)
    ChartCache(tmp_path).tidy(days=30.0, most_bytes=10**9, using=[running.hash])
    assert files(tmp_path) == names["used"] | names["running"] | others
    # It counts as used now.
    ChartCache(tmp_path).tidy(days=30.0, most_bytes=10**9)
    assert names["running"] <= files(tmp_path)


def test_all_charts_together_are_bounded(tmp_path: Path) -> None:
    """What was used longest ago goes first; a motion in use goes last."""
    motions = [random_motion(seed, n=100) for seed in (3, 4, 5)]
    order = []
    for age, motion in zip((3.0, 2.0, 1.0), motions, strict=True):
        before = files(tmp_path)
        ask(motion, tmp_path, tolerance=1e-1)
        (name,) = files(tmp_path) - before
        aged(tmp_path, {name}, age)
        order.append(name)
    size = {name: (tmp_path / name).stat().st_size for name in order}
    ChartCache(tmp_path).tidy(days=30.0, most_bytes=sum(size.values()))
    assert files(tmp_path) == set(order)
    ChartCache(tmp_path).tidy(days=30.0, most_bytes=sum(size.values()) - 1)
    assert files(tmp_path) == set(order[1:])
    ChartCache(tmp_path).tidy(days=30.0, most_bytes=max(size.values()), using=[motions[1].hash])
    assert files(tmp_path) == {order[1]}
    ChartCache(tmp_path).tidy(days=30.0, most_bytes=0)
    assert files(tmp_path) == set()


def test_files_of_arrays_are_read_by_one_thread_at_a_time(tmp_path: Path) -> None:
    """Two at once now and then end in a SystemError of Python's own."""
    file, inside = tmp_path / "a.npz", threading.Event()
    np.savez(file, a=np.arange(3))

    def other() -> None:
        with arrays(file) as kept:
            inside.set()
            assert kept["a"].sum() == 3

    second = threading.Thread(target=other)
    with arrays(file) as kept:
        second.start()
        assert not inside.wait(0.3)
        assert kept["a"].sum() == 3
    assert inside.wait(10.0)
    second.join()
