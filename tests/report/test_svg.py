"""Charts: scales against their definition, marks where the data say, weight, text alternatives."""

from dataclasses import replace
from math import inf, log10, nan

import numpy as np
import pytest
from lxml import etree

from pipeline.records import Axis, Chart, Curve, Zone
from pipeline.report import ReportError, Units
from pipeline.report.plots.chart import Drawing, Spot, _all_inside, inside, roomy
from pipeline.report.plots.panel import Scale, linear_ticks, log_between, log_ticks
from pipeline.report.plots.svg import element, text, thin, write
from pipeline.report.plots.traces import trace

from . import builder

SQUARE = Chart(
    "k",
    "Title & <b>",
    "",
    Axis("Across", "m", "log"),
    Axis("Up", "m/s2"),
    (Curve("a line", (0.01, 0.1, 1.0), (0.0, 4.903325, 9.80665)),),
    (Zone("falls <i>", (0.01, 1.0, 1.0, 0.01), (0.0, 0.0, 4.0, 4.0), "danger"),),
)


def test_whatever_an_element_holds_stays_text() -> None:
    hostile = "</text><script>'\"&amp;"
    drawn = etree.fromstring(write(element("g", text(hostile, 1.25, 3.0, hostile), element("use"), aria_label=hostile)))
    (words, _use) = drawn
    assert [e.tag for e in drawn.iter()] == ["g", "text", "use"]
    assert (words.text, words.get("class"), drawn.get("aria-label")) == (hostile, hostile, hostile)
    assert (float(words.get("x")), words.get("y")) == (pytest.approx(1.25, abs=0.051), "3")


def test_log_scale_halves_at_the_geometric_mean() -> None:
    assert Scale(1.0, 100.0, 0.0, 200.0, log=True).at(10.0) == pytest.approx(100.0, abs=1e-12)
    assert Scale(2.0, 6.0, 10.0, 0.0).at(3.0) == pytest.approx(7.5, abs=1e-12)


def test_many_values_lie_where_each_would_and_leave_the_frame_where_one_is_held() -> None:
    scale = Scale(1.0, 100.0, 0.0, 200.0, log=True)
    pixels = scale.pixels(np.array([10.0, 1000.0, 0.1]))
    assert pixels == pytest.approx([100.0, 300.0, -100.0], abs=1e-12)
    assert np.isfinite(scale.pixels(np.array([0.0, 1e300]))).all()
    assert Scale(2.0, 6.0, 10.0, 0.0).pixels(np.array([3.0, 8.0])) == pytest.approx([7.5, -5.0], abs=1e-12)


def test_log_paper_has_two_to_nine_between_its_powers() -> None:
    assert log_between(0.5, 30.0) == pytest.approx([0.5, 0.6, 0.7, 0.8, 0.9, 2, 3, 4, 5, 6, 7, 8, 9, 20, 30], rel=1e-12)


@pytest.mark.parametrize("value", [-inf, -1.0, 0.0, nan])
def test_what_has_no_place_on_a_log_axis_is_held_at_its_foot(value: float) -> None:
    assert Scale(1.0, 100.0, 0.0, 200.0, log=True).at(value) == 0.0


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-0.3, 17.0), (0.0, 3e-5), (1e6, 9e6), (-1.0, -0.2)])
def test_linear_ticks_are_round_even_and_inside(low: float, high: float) -> None:
    ticks = linear_ticks(low, high)
    step = ticks[1] - ticks[0]
    assert 3 <= len(ticks) <= 9
    assert all(low - 1e-9 <= t <= high + 1e-9 for t in ticks)
    assert round(step / 10 ** round(log10(step) - 0.5), 6) in (1.0, 2.0, 2.5, 5.0, 10.0)


@pytest.mark.parametrize(("low", "high"), [(0.2, 5.0), (5.0, 400.0), (1e-6, 1e6), (1.0, 3.0)])
def test_log_ticks_are_few_and_inside(low: float, high: float) -> None:
    ticks = log_ticks(low, high)
    assert 3 <= len(ticks) <= 9
    assert all(low * 0.999 <= t <= high * 1.001 for t in ticks)


def test_thinning_stays_within_its_tolerance_and_keeps_the_ends() -> None:
    circle = [(x / 10, (100 - (x / 10 - 10) ** 2) ** 0.5) for x in range(201)]
    kept = thin(circle, 0.3)
    assert kept[0] == circle[0]
    assert kept[-1] == circle[-1]
    assert len(kept) < 40
    for x, y in circle:
        far = min(_to_segment(x, y, kept[i - 1], kept[i]) for i in range(1, len(kept)))
        assert far <= 0.3 + 1e-9


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4_000])
def test_a_line_of_any_length_is_thinned(count: int) -> None:
    """A zigzag needs all of its points, points in one place need two."""
    zigzag = [(float(i), 100.0 * (i % 2)) for i in range(count)]
    assert thin(zigzag, 0.3) == zigzag
    assert thin([(5.0, 5.0)] * count, 0.3) == [(5.0, 5.0)] * min(count, 2)


def test_many_points_are_found_inside_as_one_is() -> None:
    numbers = np.random.default_rng(4)
    for corners in range(3, 40):
        # Sides that are level, and points on a level with corners, are where such rules differ.
        px, py = numbers.uniform(0, 90, corners), np.round(numbers.uniform(0, 90, corners), -1)
        x, y = numbers.uniform(0, 90, 60), np.round(numbers.uniform(0, 90, 60), -1)
        expected = [inside(a, b, px.tolist(), py.tolist()) for a, b in zip(x, y, strict=True)]
        assert _all_inside(x, y, px, py).tolist() == expected


def _to_segment(x: float, y: float, a: tuple[float, float], b: tuple[float, float]) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = max(0.0, min(1.0, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)))
    return float(((x - a[0] - t * dx) ** 2 + (y - a[1] - t * dy) ** 2) ** 0.5)


def test_label_places_lie_wholly_inside_a_concave_zone() -> None:
    px, py = (0.0, 300.0, 300.0, 250.0, 250.0, 0.0), (0.0, 0.0, 200.0, 200.0, 40.0, 40.0)
    places = roomy(px, py, 30.0)
    assert places
    assert all(inside(x + dx, y, px, py) for x, y in places for dx in (-30.0, 30.0))


def _figure(*spots: Spot, units: Units | None = None) -> etree._Element:
    return etree.fromstring(Drawing(SQUARE, units or Units(), "c0").figure(spots, "12 <b>"))


def test_a_mark_is_drawn_where_the_data_say() -> None:
    drawing = Drawing(SQUARE, Units(), "c0")
    circle = next(_figure(Spot(0.1, 4.903325, "it")).iter("circle"))
    middle = (drawing.panel.x.start + drawing.panel.x.end) / 2  # 0.1 is the geometric mean of the limits 0.01 and 1
    assert float(circle.get("cx")) == pytest.approx(middle, abs=0.06)  # written with one digit
    assert float(circle.get("cy")) == pytest.approx((drawing.panel.y.start + drawing.panel.y.end) / 2, abs=0.06)


def test_the_text_alternative_names_the_mark_in_numbers_and_its_zone() -> None:
    told = _figure(Spot(0.1, 3.5, "it")).findtext("desc")
    assert told is not None
    assert 'it: Across 10\u202fcm, Up 0.357\u202fg, in the zone "falls <i>"' in told
    assert "10\u202fcm" not in (_figure(Spot(0.1, 3.5, "it"), units=Units("in")).findtext("desc") or "")


@pytest.mark.parametrize(
    ("x", "y", "angle"), [(50.0, 1.0, 90), (1e-9, 1.0, -90), (0.0, 1.0, -90), (0.1, inf, 0), (0.1, -inf, 180)]
)
def test_a_mark_off_the_chart_becomes_an_arrow_at_the_frame(x: float, y: float, angle: int) -> None:
    figure = _figure(Spot(x, y, "it"))
    assert not list(figure.iter("circle"))
    assert f"rotate({angle})" in etree.tostring(figure).decode()
    assert "beyond the edge" in (figure.findtext("desc") or "")


def test_an_unknown_place_is_said_and_not_drawn() -> None:
    figure = _figure(Spot(nan, 1.0, "it"))
    assert not list(figure.iter("circle"))
    assert "place is not known" in (figure.findtext("desc") or "")


def test_equal_axes_share_one_scale() -> None:
    path = next(c for c in builder.charts().values() if c.equal)
    drawing = Drawing(path, Units(), "c0")
    across = (drawing.panel.x.end - drawing.panel.x.start) / (drawing.panel.x.high - drawing.panel.x.low)
    up = (drawing.panel.y.start - drawing.panel.y.end) / (drawing.panel.y.high - drawing.panel.y.low)
    assert across == pytest.approx(up, rel=1e-12)


@pytest.mark.parametrize("chart", builder.charts().values(), ids=lambda c: c.title)
def test_every_chart_is_light_well_formed_and_labelled(chart: Chart) -> None:
    symbol = Drawing(chart, Units(), "c0").symbol()
    root = etree.fromstring(symbol)
    assert len(symbol) < 12_000
    said = " ".join(root.itertext())
    assert all(curve.label in said for curve in chart.curves)


def test_curves_break_where_they_cannot_be_drawn() -> None:
    curve = Curve("", (0.01, 0.1, nan, 0.5, 1.0), (1.0, 2.0, 3.0, 4.0, 5.0))
    root = etree.fromstring(Drawing(replace(SQUARE, curves=(curve,)), Units(), "c0").symbol())
    (line,) = (e.get("d") or "" for e in root.iter("path") if e.get("class") == "cu")
    assert line.count("M") == 2


@pytest.mark.parametrize(
    ("chart", "named"),
    [
        (replace(SQUARE, zones=(replace(SQUARE.zones[0], tone="pink"),)), "pink"),
        (replace(SQUARE, x=Axis("Across", "m", "cubic")), "cubic"),
        (replace(SQUARE, curves=(Curve("", (nan,), (1.0,)),), zones=()), "x axis"),
    ],
)
def test_a_chart_that_cannot_be_drawn_is_refused_by_name(chart: Chart, named: str) -> None:
    with pytest.raises(ReportError, match=named):
        Drawing(chart, Units(), "c0").symbol()


def test_the_accelerogram_shows_three_components_and_its_peak() -> None:
    root = etree.fromstring(trace(builder.motion(), Units(), "m"))
    assert sum(e.get("class") == "tr" for e in root.iter("path")) == 3
    peak = max(abs(v) for k, s in builder.motion().series.items() if k != "t" for v in s) / 9.80665
    assert f"{peak:.3g}" in (root.findtext("desc") or "")


def test_series_of_unequal_length_are_refused() -> None:
    broken = replace(builder.motion(), series={"t": (0.0, 1.0), "x": (0.0, 1.0, 2.0)})
    with pytest.raises(ReportError, match="Malibu"):
        trace(broken, Units(), "m")
