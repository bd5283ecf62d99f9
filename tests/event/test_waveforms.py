"""Objects under the very motion of an earthquake, or under the suite's records as they fit it."""

from __future__ import annotations

import math
from pathlib import Path
from time import perf_counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pipeline.event.message import SiteShaking
from pipeline.motions.record import EventTable
from pipeline.night.waveforms import shaken_by, under
from pipeline.operations.workspace import open_workspace
from pipeline.quantities import G
from pipeline.resources import resource
from pipeline.settings import load_settings
from pipeline.store.runs import load_head, load_run
from pipeline.tools.event import TypedShaking
from pipeline.tools.event_waveforms import BANDWIDTH, SLOTS, conditioned_suite, fitting
from tests.event.test_command import ask, museum, night, shown

__all__ = ["museum", "night"]


def record(magnitude: float | None = None, distance: float | None = None) -> Any:
    event = None if magnitude is None else EventTable(magnitude=magnitude)
    return SimpleNamespace(event=event, distance_km=distance)


def test_under_the_motions_of_the_night_objects_do_what_they_did_in_the_night(museum: Path) -> None:
    """The same samples of the same models under the same motion: the same counts."""
    workspace = open_workspace(load_settings(museum / "kouros.toml"))
    run = load_run(workspace.engine)
    site = workspace.site()
    _, pages = load_head(workspace.engine, run.run_id)
    sampling = workspace.settings.likelihood.sampling
    shaken = shaken_by(site, "again", site.manifest.site.x_azimuth)
    found = under(workspace, pages, ["3", "2", "1"], shaken, sampling, math.inf)
    night = {one.scene.item.object_number: one.likelihoods for one in run.assessments}
    assert {number for number, one in night.items() if one} == set(found)
    for number, one in found.items():
        (before,) = night[number]
        assert (one.probability, one.samples, one.states) == (before.probability, before.samples, before.states)
    # Where there is no time only the first of them are run.
    assert set(under(workspace, pages, ["1"] * 20 + ["2"], shaken, sampling, perf_counter() - 1.0)) == {"1"}


@pytest.mark.long("event/test_watch::test_a_record_waits_for_its_stationxml_and_a_folder_is_one_earthquake")
def test_the_own_record_is_run_whole(museum: Path) -> None:
    site = resource("site_motions", "demo")
    records = [*sorted(site.glob("*.mseed")), site / "CI.CLC.xml"]
    done = ask(museum, *records, at=(35.81574, -117.59751), seconds=60.0)
    event = done.document["event"]
    assert (event["modelled"], event["modelled_under"]) == (2, "the museum's own record")
    first = done.folder.with_name(done.folder.name.removesuffix("-models"))
    assert (first / "answer.json").is_file(), "an answer without them is there before"
    assert shown(done) == done.folder.resolve()
    assert "all models were run again, under the museum&#39;s own record" in (done.folder / "index.html").read_text()
    assert ask(museum, *records, at=(35.81574, -117.59751), seconds=60.0).again


def test_the_suite_is_scaled_to_both_peaks_and_counted_by_fit(museum: Path) -> None:
    """One record of PGA a and PGV v under twice both: twice as strong; under 4 a and v: twice, the geometric mean."""
    workspace = open_workspace(load_settings(museum / "kouros.toml"))
    site = workspace.site()
    (one,) = site.levels[0].motions
    a, v = one.measures["pga"], one.measures["pgv"]
    for times in ((2.0, 2.0), (4.0, 1.0)):
        wanted = SiteShaking(times[0] * a / G, 100.0 * times[1] * v, 0.0, 0.0, "")
        shaken, number = conditioned_suite(site, wanted, None, None)
        level = shaken("")
        assert level is not None
        assert (number, len(level.motions)) == (1, SLOTS)
        peak = np.abs(level.motions[0].acceleration).max() / np.abs(one.motion.acceleration).max()
        assert peak == pytest.approx(2.0)
    done = ask(museum, typed=TypedShaking(0.3, 30.0, 0.2), seconds=60.0)
    assert "1 records of the site's suite" in done.document["event"]["modelled_under"]


def test_records_that_fit_better_count_more() -> None:
    """A normal kernel: one bandwidth off counts exp(-1/2) times as much; what nobody knows takes nothing away."""
    off = np.array([0.0, BANDWIDTH])
    even = fitting(np.zeros(2), [record(), record()], 6.0, 30.0)
    assert even == pytest.approx([0.5, 0.5])
    shares = fitting(off, [record(), record()], None, None)
    assert shares[1] / shares[0] == pytest.approx(math.exp(-0.5))
    large = fitting(np.zeros(2), [record(6.0), record(7.0)], 6.0, None)
    assert large[1] / large[0] == pytest.approx(math.exp(-0.5))
    far = fitting(np.zeros(2), [record(None, 10.0), record(None, 10.0 * math.e)], None, 10.0)
    assert far[1] / far[0] == pytest.approx(math.exp(-0.5))
