"""Motions by whatever names them: a site that comes with Kouros, a folder, a manifest, a record's file."""

from __future__ import annotations

import shutil
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from lxml import html

from pipeline import Motion, respond, trace
from pipeline.errors import KourosError
from pipeline.models import MODELS
from pipeline.motions import MotionError, read_motion, read_site
from pipeline.quantities import G
from pipeline.resources import resource
from pipeline.tools.synthetic import synthesise

FILES = ("CI.CLC..HNE.mseed", "CI.CLC..HNN.mseed", "CI.CLC..HNZ.mseed")


@pytest.fixture(autouse=True, scope="module")
def _no_windows() -> None:
    mpl.use("Agg")


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """The bundled record's files without their manifest."""
    for name in (*FILES, "CI.CLC.xml", "README.md"):
        shutil.copy(resource("site_motions", "demo", name), tmp_path / name)
    return tmp_path


def test_a_bundled_site_has_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion is that of its folder and of its manifest; a folder of the same name needs a path."""
    synthesise("sine", ["amplitude=1.2", "frequency=2", "cycles=2"], tmp_path / "demo")
    monkeypatch.chdir(tmp_path)
    (named,) = read_motion("demo")
    (of_file,) = read_motion(resource("site_motions", "demo", "manifest.toml"))
    assert named.hash == of_file.hash
    (own,) = read_motion("./demo")
    assert own.hash != named.hash
    assert own.hash == read_motion(Path("demo"))[0].hash


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_a_record_is_read_with_those_that_belong_to_it(beside: Path, name: str) -> None:
    """Any of three component files: the instrument is removed by the StationXML beside them, the shape is the site's.

    The bundled manifest cuts a window and scales to a peak of 0.7 g, by which what is read without it is that motion.
    """
    (motion,) = read_motion(beside / name)
    (site,) = read_motion("demo")
    assert motion.dt == site.dt
    factor = 0.7 * G / np.abs(motion.acceleration[:2]).max()
    for mine, theirs in zip(factor * motion.acceleration, site.acceleration, strict=True):
        strong = theirs[2000:4000]
        at = int(np.correlate(mine, strong, "valid").argmax())
        left = mine[at : at + strong.size] - strong
        assert np.abs(left).max() < 0.05 * np.abs(strong).max()


def test_half_a_record_is_refused_by_name(beside: Path) -> None:
    (beside / FILES[2]).unlink()
    with pytest.raises(MotionError, match=r"(?s)CI.CLC..HNE.mseed.*2 channels.*three components"):
        read_motion(beside / FILES[0])


@pytest.mark.parametrize(("name", "words"), [("no.mseed", "there is no such"), ("README.md", "no whole record")])
def test_what_is_no_record_is_refused(beside: Path, name: str, words: str) -> None:
    with pytest.raises(MotionError, match=words):
        read_motion(beside / name)


def test_a_motion_shows_itself_and_no_name_of_it_does_more() -> None:
    t = np.arange(4000) * 0.01
    hostile = "<script>alert(1)</script> & $x$"
    motion = Motion(0.01, np.vstack([np.sin(t), 2.0 * np.cos(t), 0.0 * t]), hostile, ["<b>step</b>"], "a <i>source</i>")
    shown = motion._repr_html_()
    tree = html.fromstring(f"<div>{shown}</div>")
    assert {one.tag for one in tree.iter()} == {
        "div", "table", "caption", "tr", "th", "td", "br", "svg", "path",
    }  # fmt: skip
    assert tree.findtext(".//caption") == hostile
    text = "".join(tree.itertext())
    assert "39.99 s, 4,000 samples of 0.01 s" in text
    assert "y: 2 m/s2 (0.204 g)" in text
    assert "<b>step</b>" in text


def test_a_motion_is_drawn_as_it_is() -> None:
    (motion,) = read_motion("demo")
    axes = motion.plot()
    for at, values in zip(axes, motion.acceleration, strict=True):
        (line,) = at.lines
        np.testing.assert_array_equal(line.get_ydata(), values)
        assert line.get_xdata()[-1] == pytest.approx(motion.duration)
    axes[0].figure.canvas.draw()
    again = motion.plot(axes)
    assert len(again[0].lines) == 2
    with pytest.raises(KourosError, match="3 axes"):
        motion.plot(axes[:2])


def test_the_rows_of_a_response_carry_their_parameters_and_units() -> None:
    (motion,) = read_motion("demo")
    table = respond("oscillator", motion, frequency=[2.0, 5.0], damping=0.02)
    assert table["frequency"].tolist() == [2.0, 5.0]
    assert table["damping"].tolist() == [0.02, 0.02]
    units = table.attrs["units"]
    assert (units["displacement"], units["error"], units["frequency"], units["damping"]) == ("m", "m", "Hz", "-")
    assert (table.attrs["model"], table.attrs["motion"]) == ("oscillator", motion.name)
    assert table.attrs["motion_hash"] == motion.hash
    history = trace("oscillator", motion, frequency=2.0, damping=0.02)
    assert history.attrs["parameters"] == {"frequency": 2.0, "damping": 0.02}


def test_no_parameter_has_the_name_of_a_column_of_its_model() -> None:
    for model in MODELS:
        columns = {q.name for q in model.gives} | {"error", "fidelity", "note", "angle", "low", "high"}
        assert not columns & {q.name for q in model.needs}, model.name


def test_a_site_that_is_read_has_the_same_motions() -> None:
    assert [m.motion.hash for level in read_site(resource("site_motions", "demo")).levels for m in level.motions] == [
        m.hash for m in read_motion("demo")
    ]
