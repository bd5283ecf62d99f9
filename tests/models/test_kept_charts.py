"""Charts kept in files: found again bit for bit, never believed when damaged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shaking import along_x, random_motion

from pipeline import cache, respond
from pipeline.analysis.chart_runs import response_chart
from pipeline.analysis.response_charts import ChartCache, ResponseChart
from pipeline.cache import CHARTS, CacheWarning
from pipeline.records import Motion, Numerics


class RebuiltError(Exception):
    pass


def refuse(*_: object, **__: object) -> ResponseChart:
    raise RebuiltError


def ask(motion: Motion, folder: Path, friction: float = 0.1234, **settings: float) -> float:
    table = respond(
        "sliding", motion, fidelity="chart", charts=ChartCache(folder), friction_static=friction, **settings
    )
    return float(table["displacement"].iloc[0])


def test_charts_are_found_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bit for bit, by what they depend on; another kernel, code, motion, direction or tolerance has another chart."""
    motion = random_motion(3)
    first = ask(motion, tmp_path, tolerance=1e-2)
    (kept,) = (tmp_path / CHARTS).iterdir()
    assert motion.hash[:16] in kept.name
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
    monkeypatch.setattr(cache, "code_version", lambda: 64 * "0")
    with pytest.raises(RebuiltError):
        ask(motion, tmp_path, tolerance=1e-2)


def test_every_number_of_a_chart_is_found_again(tmp_path: Path) -> None:
    """All columns, bounds, notes and marks of what is unresolved, at 1,000 values, and nothing is left aside."""
    given = {"length": np.geomspace(0.1, 20.0, 1000), "damping": 0.0, "tolerance": 1e-2}
    tables = [
        respond("swing", random_motion(5), fidelity="chart", charts=ChartCache(tmp_path), **given) for _ in range(2)
    ]
    assert tables[0].equals(tables[1])
    assert len(list((tmp_path / CHARTS).iterdir())) == 1


def test_a_folder_that_cannot_be_written_costs_nothing_but_time(tmp_path: Path) -> None:
    file = tmp_path / "no-folder"
    file.write_text("a file")
    with pytest.warns(CacheWarning, match="Not a directory"):
        assert ask(random_motion(3), file, tolerance=1e-2) == ask(random_motion(3), tmp_path, tolerance=1e-2)
    assert file.read_text() == "a file"


def test_a_damaged_chart_is_built_again_and_said(tmp_path: Path) -> None:
    """Wherever a bit is flipped: the answer stays, and the file is mended."""
    motion = along_x(0.5 * 9.81 * np.sin(np.arange(60.0)), 0.02)
    first = ask(motion, tmp_path, tolerance=3e-2)
    (kept,) = (tmp_path / CHARTS).iterdir()
    good = kept.read_bytes()
    for at in np.random.default_rng(0).integers(0, len(good), 20).tolist():
        kept.write_bytes(good[:at] + bytes([good[at] ^ 0x10]) + good[at + 1 :])
        with pytest.warns(CacheWarning, match="it is made again"):
            assert ask(motion, tmp_path, tolerance=3e-2) == first
        assert kept.read_bytes() == good
