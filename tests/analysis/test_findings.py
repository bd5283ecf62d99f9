"""What a finding's numbers and words are: of the best estimates, of a range that was found, or of bounds around it."""

import csv
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.furnished import furnished
from pipeline.analysis.furniture import FurnitureFilter, filter_of
from pipeline.analysis.response import respond
from pipeline.execute import Threads
from pipeline.motions import read_motion, read_site
from pipeline.records import Finding, Furniture, Item, Motion, RunRecord, Support, Verdict
from pipeline.records.result import BOUNDS, DEMANDS
from pipeline.report.pages.judging import most, spanned
from pipeline.report.units import Units
from pipeline.resources import resource

pytestmark = pytest.mark.slow_file


@pytest.fixture(scope="module")
def motions() -> tuple[Motion, ...]:
    (level,) = read_site(resource("site_motions", "demo_suite")).levels
    return tuple(one.motion for one in level.motions)


@pytest.fixture(scope="module")
def record(demo_record: RunRecord) -> RunRecord:
    return demo_record


def test_an_outcome_is_told_exactly_where_the_best_demand_is_beyond_the_capacity(demo_report: Path) -> None:
    with (demo_report / "findings.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    told = Counter((bool(row["outcome"]), float(row["utilisation"]) > 1.0) for row in rows)
    assert set(told) == {(True, True), (False, False)}, told


def test_ranges_of_what_passes_are_demands_or_say_that_they_are_bounds(
    record: RunRecord, motions: tuple[Motion, ...]
) -> None:
    """Histories at both ends of the friction, in all variants of the furniture, of all that slides and passes."""
    site = LevelMotions("design", "mean", motions)

    @cache
    def slides(friction: float, furniture: FurnitureFilter | None) -> list[float]:
        run = [
            [respond("sliding", one, friction_static=friction) for one in some]
            for some in furnished(site, furniture).variants
        ]
        return [float(np.mean([rows["displacement"].iloc[0] for rows in some])) for some in run]

    seen: Counter[str] = Counter()
    for a in record.assessments:
        friction = a.scene.parameters.get("friction_static")
        for f in (f for f in a.findings if f.model == "sliding" and f.verdict is Verdict.PASS):
            assert friction is not None
            assert f.low is not None
            assert f.high is not None
            stands = filter_of(a.scene)
            truth = [d for one in (friction.low, friction.value, friction.high) for d in slides(one, stands)]
            # What was bounded is off by no more than what a history is.
            assert f.low <= min(truth) * 1.002
            assert f.high >= max(truth) * 0.998
            if f.range_is == DEMANDS:
                assert (f.low, f.high) == pytest.approx((min(truth), max(truth)), rel=5e-3)
            seen[f.range_is] += 1
    assert seen


def bounded(**fields: float | str | None) -> Finding:
    """A block on a rough floor with much room: its bound is enough."""
    item = Item("1", "G", title="Block", support=Support.FREESTANDING, furniture=Furniture.FLOOR,
                height_m=0.3, base_width_m=0.3, base_depth_m=0.3,
                width_m=0.3, depth_m=0.3, cg_height_m=0.15, clearance_m=5.0, **fields)  # type: ignore[arg-type] # fmt: skip
    x, y, z = read_motion(resource("site_motions", "demo"))[0].acceleration[:, 1500:3500]
    shaking = Motion(0.01, [x, y, z], "strong")
    found = assess([classify(item)], [LevelMotions("design", "max", (shaking,))], Context(Threads(1)))[1][0]
    return next(f for f in found if f.model == "sliding")


def test_bounds_read_as_bounds() -> None:
    """Of a range between bounds the lower one is no demand, and is not shown; of what is measured there is no range."""
    units = Units()
    found = bounded(base_material="metal", surface_material="wood")
    assert (found.verdict, found.range_is) == (Verdict.PASS, BOUNDS)
    assert found.high is not None
    assert spanned(found, units) == f"at most {units.text(found.high, 'm')}"
    sure = bounded(friction=0.3)
    assert (sure.fidelity, sure.range_is, spanned(sure, units)) == ("bound", BOUNDS, "")
    assert sure.demand is not None
    assert most(sure, units) == f"at most {units.text(sure.demand, 'm')}"
