"""Charts in the night and ad hoc: the same verdicts as histories, each said what decided it, kept for the next time."""

import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.plan import plan
from pipeline.analysis.response import respond
from pipeline.analysis.response_charts import ChartCache, ResponseChart
from pipeline.cache import CHARTS, CacheWarning
from pipeline.collection.database import open_database
from pipeline.execute import Threads
from pipeline.motions.synthesis import band_limited_random
from pipeline.night import units
from pipeline.night.run import run
from pipeline.quantities import G
from pipeline.records import Estimate, Finding, Item, Motion, Origin, Scene, Support, Verdict
from pipeline.records.numerics import Numerics
from pipeline.settings import Settings, load_settings
from pipeline.store.runs import load_run
from tests.museum import PAINTING, SILENT, VASE, kouros, workspace

pytestmark = pytest.mark.slow_file

ROWS = [
    *(f"{n},A,Covered vase,{0.2 + 0.02 * n},0.2,0.2" for n in range(12)),
    *(f"p{n},B,Painting of a landscape,{0.5 + 0.1 * n},0.8,0.05" for n in range(6)),
    "lost,B,Vase,,0.2,0.2",
]


def museum(folder: Path, fidelity: str) -> Settings:
    settings = workspace(folder, ROWS)
    shutil.rmtree(settings.kept, ignore_errors=True)
    return at(settings, fidelity)


def at(settings: Settings, fidelity: str) -> Settings:
    return settings.model_copy(update={"analysis": settings.analysis.model_copy(update={"fidelity": fidelity})})


def findings(settings: Settings) -> Mapping[tuple[str, str], Finding]:
    """Run a night and return what it stored."""
    done = run(settings, SILENT)
    record = load_run(open_database(settings.database), done.run_id)
    return {(f.object_number, f.model): f for a in record.assessments for f in a.findings}


def refuse(*_: object) -> ResponseChart:
    raise AssertionError("built again")


@pytest.mark.long("test_the_command_takes_it")
def test_a_night_by_charts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Verdicts of histories; rocking, which has no chart, by its certificate; the error covers the difference."""
    settings = museum(tmp_path, "chart")
    looked = findings(settings)
    charts = settings.kept / CHARTS
    kept = {file.name: file.read_bytes() for file in charts.iterdir()}
    true = findings(at(settings, "history"))
    assert looked.keys() == true.keys()
    deciders = {(f.model, f.decided_by, f.fidelity) for f in looked.values()}
    assert ("standing", "certificate", "bound") in deciders
    assert ("sliding", "chart", "chart") in deciders
    assert {model for model, by, _ in deciders if by == "chart"} <= {"sliding", "swing"}
    for key, one in looked.items():
        other = true[key]
        assert (one.verdict, one.capacity) == (other.verdict, other.capacity)
        assert one.demand is not None
        assert one.error is not None
        assert other.demand is not None
        assert abs(one.demand - other.demand) <= one.error
        if one.decided_by == "chart":
            # What does not move at all is told without an error.
            assert one.error > 0.0 or other.demand == 0.0
    # A night of other code judges anew, reads the charts that the first one kept, and changes nothing of them.
    with monkeypatch.context() as patch:
        patch.setattr(ResponseChart, "build", refuse)
        patch.setattr(units, "code_version", lambda: "other code")
        assert findings(settings) == looked
    assert {file.name: file.read_bytes() for file in charts.iterdir()} == kept
    # A damaged chart is said, and the night goes on as if there were none.
    for file in charts.iterdir():
        file.write_bytes(b"damaged")
    monkeypatch.setattr(units, "code_version", lambda: "another code again")
    with pytest.warns(CacheWarning, match="it is made again"):
        assert findings(settings) == looked
    assert "the response chart" in "".join(
        page.read_text(encoding="utf-8") for page in (tmp_path / "reports" / "latest").glob("*.html")
    )


def test_charts_of_motions_that_nobody_uses_go(tmp_path: Path) -> None:
    """The settings' days and megabytes are kept to at the end of a night; its own motion counts as used."""
    settings = museum(tmp_path, "history")
    folder = settings.kept / CHARTS
    other = Motion(0.02, np.ones((3, 20)), "another")
    respond("sliding", other, fidelity="chart", charts=ChartCache(settings.kept), tolerance=0.1, friction_static=0.1)
    (stranger,) = folder.iterdir()
    run(settings, SILENT)
    assert stranger.exists()
    none = settings.model_copy(update={"charts": settings.charts.model_copy(update={"megabytes": 0.0})})
    run(none, SILENT)
    assert not list(folder.iterdir())


def test_the_command_takes_it(tmp_path: Path) -> None:
    settings = workspace(tmp_path, ROWS[:3])
    done = kouros("-q", "run", "--fidelity", "chart", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    record = load_run(open_database(settings.database))
    assert {f.decided_by for a in record.assessments for f in a.findings if f.model == "sliding"} == {"chart"}
    file = tmp_path / "kouros.toml"
    file.write_text(file.read_text(encoding="utf-8").replace('fidelity = "auto"', 'fidelity = "chart"'))
    assert load_settings(file).analysis.fidelity == "chart"


def test_ad_hoc_charts_are_kept_beside_the_settings(tmp_path: Path) -> None:
    """The same answer from the file as when it was built; without settings nothing is written."""
    settings = workspace(tmp_path)
    shutil.rmtree(settings.kept)
    words = ("respond", "sliding", "friction_static=0.05,0.3", "--fidelity", "chart", "--json")
    first = kouros(*words, folder=tmp_path)
    (kept,) = (settings.kept / CHARTS).iterdir()
    built = kept.stat()
    again = kouros(*words, folder=tmp_path)
    assert again.stdout == first.stdout
    assert kept.stat().st_ino == built.st_ino
    assert kept.stat().st_mtime_ns > built.st_mtime_ns
    kept.write_bytes(b"damaged")
    mended = kouros(*words, folder=tmp_path)
    assert mended.stdout == first.stdout
    assert f"kouros: {kept}: cannot be used" in mended.stderr.replace("\n", " ")
    assert "Warning" not in mended.stderr
    bare = tmp_path / "bare"
    bare.mkdir()
    assert kouros(*words, folder=bare).stdout == first.stdout
    assert not list(bare.iterdir())


def noise(seed: int) -> Motion:
    x, y = (band_limited_random(0.3 * G, 0.5, 8.0, 6.0, seed + n, dt=0.02).acceleration[0] for n in (1, 2))
    return Motion(0.02, np.array([x, y, 0.2 * x]), f"noise {seed}")


def judged(
    scenes: list[Scene], motions: tuple[Motion, ...], fidelity: str, charts: ChartCache, combine: str = "max"
) -> list[list[Finding]]:
    levels = [LevelMotions("design", combine, motions)]
    return assess(scenes, levels, Context(Threads(2), charts=charts), Numerics(fidelity))[1]


@pytest.mark.parametrize("combine", ["max", "mean"])
def test_what_a_chart_leaves_undecided_is_integrated(combine: str) -> None:
    """Clearances a hair above and below the demand itself: within a chart's error, so histories must decide."""
    motions, charts = (noise(1), noise(11)), ChartCache()
    scene = classify(replace(VASE, friction=0.1234))
    each = [float(respond("sliding", m, friction_static=0.1234)["displacement"].iloc[0]) for m in motions]
    demand = max(each) if combine == "max" else float(np.mean(each))
    doubtful = []
    for hair in (1e-9, 1e-6, 1e-5):
        for sign, verdict in ((1.0, Verdict.PASS), (-1.0, Verdict.FAIL)):
            room = demand * (1.0 + sign * hair)
            parameters = {**scene.parameters, "clearance": Estimate(room, "m", Origin.MEASURED, room, room)}
            (found,) = judged([replace(scene, parameters=parameters)], motions, "chart", charts, combine)
            (sliding,) = (f for f in found if f.model == "sliding")
            assert sliding.verdict is verdict
            doubtful.append((sliding.decided_by, sliding.fidelity))
    assert set(doubtful) == {("history", "history")}
    # Ample room is for the chart to see.
    ample = {**scene.parameters, "clearance": Estimate(1.0, "m", Origin.MEASURED, 1.0, 1.0)}
    (found,) = judged([replace(scene, parameters=ample)], motions, "chart", charts, combine)
    assert {f.decided_by for f in found if f.model == "sliding"} == {"chart"}


def test_many_objects_by_charts_have_the_verdicts_of_histories() -> None:
    """200 objects of random friction and room, and 60 hung ones, at random: every verdict, and errors that cover."""
    rng = np.random.default_rng(5)
    motion = noise(1)
    items: list[Item] = [
        *(replace(VASE, object_number=str(n), friction=float(rng.uniform(0.03, 0.4)),
                  clearance_m=float(rng.uniform(0.001, 0.1))) for n in range(200)),
        *(replace(PAINTING, object_number=f"p{n}", support=Support.HUNG, damping=0.05,
                  suspension_length_m=float(rng.uniform(0.11, 2.0)), clearance_m=float(rng.uniform(0.01, 0.3)))
          for n in range(60)),
    ]  # fmt: skip
    scenes = [classify(item) for item in items]
    looked, true = (judged(scenes, (motion,), fidelity, ChartCache()) for fidelity in ("chart", "history"))
    by = []
    for one, other in zip((f for found in looked for f in found), (f for found in true for f in found), strict=True):
        assert (one.object_number, one.model, one.verdict) == (other.object_number, other.model, other.verdict)
        if one.decided_by == "chart":
            assert one.error is not None
            assert other.demand is not None
            by.append(abs((one.demand or 0.0) - other.demand) <= one.error)
    sliding = next(work for work in plan(scenes).work if work.model.name == "sliding")
    assert sliding.values["friction_static"].size >= 200
    assert len(by) > 200
    assert np.mean(by) >= 0.99
