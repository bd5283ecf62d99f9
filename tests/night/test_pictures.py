"""The paper's Figures 4, 5 and 6: pictures of response charts, which say how far off they may be."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from pipeline.analysis.context import Context
from pipeline.analysis.figures import PICTURED, chart_keys, draw
from pipeline.analysis.model_runs import prepare, run_model
from pipeline.analysis.response import respond
from pipeline.analysis.response_charts import ChartCache, ResponseChart, axis_of
from pipeline.cache import CHARTS, PICTURES, CacheWarning
from pipeline.execute import Threads
from pipeline.models import model_named
from pipeline.models.common import lift_ratios
from pipeline.models.swing import PICTURED_EVERY
from pipeline.motions import read_motion
from pipeline.motions.synthesis import band_limited_random
from pipeline.night.prepare import Pictures
from pipeline.quantities import Array, G
from pipeline.records import Chart, ChartFigure, Motion, Numerics, Silent
from pipeline.records.numerics import SCAN
from pipeline.resources import resource
from pipeline.settings import KEPT, Settings
from tests.soak import some

pytestmark = pytest.mark.slow_file

LONG = pytest.mark.long("test_a_figure_is_as_far_off_as_it_says")


def curves_of(model: str) -> list[dict[str, float]]:
    """What the curves of a model's figure have fixed."""
    (figure,) = (one for one in model_named(model).pictures if isinstance(one, ChartFigure))
    return [dict(fixed) for fixed in figure.curves.values()]


SWINGS, ISOLATORS = curves_of("swing"), curves_of("horizontal_isolator")


@pytest.fixture(scope="module")
def motion() -> Motion:
    """Six seconds of noise of 0.5 to 8 Hz in both directions."""
    x, y = (band_limited_random(0.3 * G, 0.5, 8.0, 6.0, seed, dt=0.02).acceleration[0] for seed in (1, 2))
    return Motion(0.02, np.array([x, y, 0.2 * x]), "noise")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("charts") / KEPT


@pytest.fixture(scope="module")
def drawn(motion: Motion, folder: Path) -> dict[str, Chart]:
    return draw(motion, Context(Threads(2), charts=ChartCache(folder)))


def kind(drawn: dict[str, Chart], name: str) -> Chart:
    return next(chart for key, chart in drawn.items() if key.startswith(f"{name}:"))


def told(chart: Chart) -> list[float]:
    """Return the errors that a caption owns up to, curve by curve, as shares."""
    said = chart.caption.partition("at most ")[2]
    return [float(value) / 100.0 for value in re.findall(r"([\d.]+) %", said)]


def true(motion: Motion, name: str, at: Array) -> list[Array]:
    """Return the histories of each curve of a figure at values of its axis."""
    if name == "sliding":
        return [respond("sliding", motion, friction_static=at)["displacement"].to_numpy()]
    if name == "swing":
        given = {"angle": None, "azimuth_step": PICTURED_EVERY, "length": at}
        return [respond("swing", motion, **given, **fixed)["displacement"].to_numpy() for fixed in SWINGS]
    return [
        respond("horizontal_isolator", motion, frequency=at, **fixed)["acceleration"].to_numpy() for fixed in ISOLATORS
    ]


@pytest.fixture(scope="module", params=["noise", pytest.param("record", marks=LONG)])
def pictured(
    request: pytest.FixtureRequest, motion: Motion, drawn: dict[str, Chart]
) -> tuple[Motion, dict[str, Chart]]:
    """The noise, and the demonstration's record, with their pictures."""
    if request.param == "noise":
        return motion, drawn
    record = read_motion(resource("site_motions", "demo"))[0]
    return record, draw(record, Context(Threads(2), charts=ChartCache()))


@pytest.mark.parametrize("name", some(["sliding", "swing", "isolator"], 2))
def test_a_figure_is_as_far_off_as_it_says(pictured: tuple[Motion, dict[str, Chart]], name: str) -> None:
    """Straight lines between its points at 60 fresh places against histories: within the error told in 98 of 100.

    Relative to max(value, 1 % of the largest), as the caption says.  A kink may hide between held-out points: of 8,400
    places under seven motions 99.7 in 100 were within, and none was off by three times the 2 % that are allowed; the
    lines between 240 points and more, and five digits, are far below that.
    """
    motion, charts = pictured
    chart = kind(charts, name)
    ends = chart.curves[0].x[0], chart.curves[0].x[-1]
    at = np.exp(np.random.default_rng(7).uniform(*np.log(ends), 60))
    off, within = [], []
    errors = told(chart)
    assert len(errors) == len(chart.curves)
    for curve, error, want in zip(chart.curves, errors, true(motion, name, at), strict=True):
        # The figure that decides is told to half of a verdict's 1 %.
        assert 0.0 < error <= (0.005 if name == "sliding" else PICTURED)
        got = np.interp(np.log(at), np.log(curve.x), curve.y)
        off.append(np.abs(got - want) / np.maximum(want, 0.01 * want.max()))
        within.append(off[-1] <= error + 1e-12)
    assert np.concatenate(within).mean() >= 0.98
    assert np.concatenate(off).max() < 3.0 * PICTURED


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("swing", marks=pytest.mark.long("test_what_is_only_drawn_is_integrated_coarsely_and_hardly_off")),
        "horizontal_isolator",
    ],
)
def test_what_is_only_drawn_is_integrated_coarsely_and_hardly_off(name: str) -> None:
    """Under the demonstration's record, against histories: a tenth of what a picture is told to.

    Of 3,600 isolators under six motions the worst was off by 0.14 %.
    """
    record = read_motion(resource("site_motions", "demo"))[0]
    model = model_named(name)
    (first, axis), places = (model.gives[0].name, axis_of(model)), np.random.default_rng(8)
    for fixed in curves_of(name):
        at = np.exp(places.uniform(np.log(max(0.1, axis.low)), np.log(axis.high), 40))
        values = prepare(model, {**fixed, axis.name: at})
        drawn, true = (
            run_model(model, record, values, Numerics(fidelity, PICTURED_EVERY), None)[0]
            for fidelity in (SCAN, "history")
        )
        np.testing.assert_allclose(drawn[first], true[first], rtol=0.1 * PICTURED)
        assert np.isnan(drawn["error"]).all()


def test_every_figure_is_there_and_points_lie_where_the_response_turns(drawn: dict[str, Chart], motion: Motion) -> None:
    assert list(drawn) == chart_keys(motion)
    steps = np.diff(np.log(kind(drawn, "swing").curves[0].x))
    assert (steps > 0.0).all()
    assert steps.min() < 0.2 * np.median(steps)


def test_beyond_the_certificate_nothing_slides(drawn: dict[str, Chart], motion: Motion) -> None:
    """The line lies on the axis from there to the end of the chart, and above it before."""
    (curve,) = kind(drawn, "sliding").curves
    rests = max(lift_ratios(motion.excitation(None)))
    assert curve.x[-1] == 1.5
    assert all(y == 0.0 for x, y in zip(curve.x, curve.y, strict=True) if x > rests)
    assert all(y > 0.0 for x, y in zip(curve.x, curve.y, strict=True) if x < 0.9 * rests)


def test_read_back_it_is_the_same_picture(
    drawn: dict[str, Chart], motion: Motion, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> ResponseChart:
        raise AssertionError("built again")

    monkeypatch.setattr(ResponseChart, "build", refuse)
    assert draw(motion, Context(Threads(1), charts=ChartCache(folder))) == drawn
    names = [file.name for file in (folder / CHARTS).iterdir()]
    assert len(names) == 1 + len(SWINGS) + len(ISOLATORS)
    assert all(motion.hash[:16] in name for name in names)


@pytest.fixture
def kept(drawn: dict[str, Chart], folder: Path, tmp_path: Path) -> Path:
    """A cache with the response charts of the motion, so that drawing takes no time, and no pictures yet."""
    assert drawn
    return Path(shutil.copytree(folder / CHARTS, tmp_path / KEPT / CHARTS)).parent


@pytest.fixture
def drawing(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The motions whose pictures were drawn, in their order; their hashes."""
    done: list[str] = []

    def counted(motion: Motion, context: Context) -> dict[str, Chart]:
        done.append(motion.hash)
        return draw(motion, context)

    monkeypatch.setattr("pipeline.night.prepare.draw", counted)
    return done


def pictures_of(folder: Path, *motions: Motion) -> dict[str, Chart]:
    pictures = Pictures(Settings(home=folder.parent))
    try:
        return pictures.of(motions, Silent())
    finally:
        pictures.close()


def test_pictures_are_kept_by_the_content_of_their_motion(
    drawn: dict[str, Chart], motion: Motion, kept: Path, drawing: list[str]
) -> None:
    """An unchanged motion costs nothing, whatever it is called; a damaged file is told, and drawn again."""
    assert pictures_of(kept, motion) == drawn
    assert pictures_of(kept, motion, motion.called("otherwise")) == drawn
    assert drawing == [motion.hash]
    (file,) = (kept / PICTURES).iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole.replace(b"Drawn from", b"Drawm from"))
    with pytest.warns(CacheWarning, match="not what was written"):
        assert pictures_of(kept, motion) == drawn
    assert drawing == 2 * [motion.hash]
    assert file.read_bytes() == whole


def test_pictures_of_another_motion_or_by_other_code_are_drawn(
    motion: Motion, kept: Path, drawing: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether they are there is asked, and no picture drawn: of a sample changed in its last digit, and by new code."""
    pictures_of(kept, motion)
    drawing.clear()
    shaking = motion.acceleration.copy()
    shaking[0, 100] = np.nextafter(shaking[0, 100], np.inf)
    other = Motion(motion.dt, shaking, motion.name)
    nothing: dict[str, Chart] = {}
    monkeypatch.setattr("pipeline.night.prepare.draw", lambda motion, _: drawing.append(motion.hash) or nothing)
    pictures_of(kept, motion, other)
    assert drawing == [other.hash] != [motion.hash]
    monkeypatch.setattr("pipeline.cache.code_version", lambda: "0" * 64)
    pictures_of(kept, motion)
    assert drawing == [other.hash, motion.hash]
