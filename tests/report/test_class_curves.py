"""Mean fragility of classes: against the mixture written out, whatever the pages, and what is only bounded."""

import csv
import io
from dataclasses import replace
from math import log

import numpy as np
import pytest
from scipy.stats import norm

from pipeline.quantities import G
from pipeline.records import Assessment, Found, Fragility, Item
from pipeline.report.pages.class_curves import GRID, class_curve_views, class_curves, curves_csv
from pipeline.report.pages.tallies import tally, total

from . import builder

CURVE = Fragility(
    "1", "", "", 0.3 * G, 0.2 * G, 0.5 * G, "", 0.5, 0.4, True, 0.2, 0.25, 1, False,
    1 / 900.0, 1 / 2000.0, 1 / 500.0, state="harm", samples=64,
)  # fmt: skip


def of(number: int, curve: Fragility | None, object_class: str = "vessel") -> Assessment:
    one = builder.rocking(Item(str(number), "A", "Vase"))
    scene = replace(one.scene, object_class=object_class)
    return replace(one, scene=scene, fragilities=() if curve is None else (curve,))


def some() -> list[Assessment]:
    medians = np.geomspace(0.15, 1.2, 12)
    return [of(at, replace(CURVE, median=m * G), ("vessel", "dish")[at % 2]) for at, m in enumerate(medians.tolist())]


def test_the_mean_is_the_mixture_and_its_curve_lies_close() -> None:
    """Truth: the mean of the normal distributions; of medians even in ln the variances add, to 3 % for so few."""
    museum, *classes = class_curves(tally(Found(tuple(some()))))
    assert [one.object_class for one in classes] == ["dish", "vessel"]
    assert (museum.object_class, museum.objects, museum.curves) == ("", 12, 12)
    medians = np.geomspace(0.15, 1.2, 12)
    for a, p in zip(GRID, museum.mean, strict=True):
        assert p == pytest.approx(np.mean(norm.cdf(np.log(a / medians) / 0.5)), abs=1e-6)
    assert museum.median == pytest.approx(float(np.exp(np.log(medians).mean())), rel=0.01)
    assert museum.dispersion == pytest.approx(float(np.hypot(0.5, np.log(medians).std())), rel=0.03)
    assert museum.difference is not None
    assert museum.difference < 0.03
    assert museum.harmed == pytest.approx(12 * (1.0 - np.exp(-50.0 / 900.0)), abs=1e-5)


def test_pages_add_up_to_the_same_in_any_order() -> None:
    objects = some()
    whole = class_curves(tally(Found(tuple(objects))))
    pages = [tally(Found(tuple(objects[at : at + 5]))) for at in range(0, 12, 5)]
    assert class_curves(total(pages)) == whole
    assert class_curves(total(reversed(pages))) == whole


def test_what_is_not_on_display_or_has_no_curve_has_no_say() -> None:
    objects = some()
    away = of(99, CURVE)
    away = replace(away, scene=replace(away.scene, item=replace(away.scene.item, on_display=False)))
    assert class_curves(tally(Found((*objects, away, of(98, None))))) == class_curves(tally(Found(tuple(objects))))
    assert class_curves(tally(Found((of(98, None),)))) == ()


def test_a_bound_counts_as_far_as_it_was_looked_for() -> None:
    """Three in four never reached up to 1 g: the mean is known up to there, and half is not reached."""
    stripes = ((0.25 * G, 16, 0), (0.5 * G, 16, 0), (1.0 * G, 16, 4))
    bound = replace(CURVE, bound="above", median=G, stripes=stripes, annual_rate=None, rate_low=None, rate_high=None)
    (museum, _) = class_curves(tally(Found((of(1, CURVE), *(of(at, bound) for at in range(2, 5))))))
    known = {a: p for a, p in zip(GRID, museum.mean, strict=True) if p is not None}
    assert max(known) < 1.0 < GRID[-1]
    assert max(known) * GRID[1] / GRID[0] > 1.0
    for a, p in known.items():
        own = norm.cdf(log(a / 0.3) / 0.5)
        seen = 0.25 * min(max(log(a / 0.5) / log(2.0), 0.0), 1.0)
        assert p == pytest.approx((own + 3.0 * seen) / 4.0, abs=2e-6)
    assert (museum.median, museum.bound, museum.limit) == (None, "above", max(known))
    assert (museum.told, museum.curves, museum.objects) == (1, 1, 4)
    (view, _) = class_curve_views((museum, museum))
    assert view.median.startswith("above ")


def test_the_file_has_a_row_for_each_and_runs_no_formula() -> None:
    objects = [*some(), of(50, CURVE, "=cmd()")]
    rows = list(csv.DictReader(io.StringIO(curves_csv(class_curves(tally(Found(tuple(objects))))))))
    assert [row["object_class"] for row in rows] == ["", "'=cmd()", "dish", "vessel"]
    assert [int(row["objects"]) for row in rows] == [13, 1, 6, 6]
    assert all(float(row["median_g"]) > 0.0 for row in rows)
    assert rows[0][f"p_{GRID[0]:g}_g"] != ""
