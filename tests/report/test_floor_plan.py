"""The plan: positions against the scale bar, rings against the needed room, the same in a table."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from lxml import etree

from pipeline.records import Item, Origin, Verdict
from pipeline.report import Units, render
from pipeline.report.pages.floor_plan import GalleryPlanView, needed_clearance
from pipeline.report.pages.museum_views import GalleryView

from . import builder
from .shown import shown


def gallery(units: Units | None = None) -> GalleryView:
    museum = shown(builder.record(), units or Units())
    return next(g for g in museum.galleries if g.name == builder.GREEK)


def plan(units: Units | None = None) -> GalleryPlanView:
    found = gallery(units).plan
    assert found is not None
    return found


def shapes(view: GalleryPlanView) -> dict[str, etree._Element]:
    """The link of each object on the plan, by the object's number in the museum."""
    root = etree.fromstring(view.svg)
    by_anchor = {p.object.anchor: p.object.number for p in view.places}
    return {by_anchor[(a.get("href") or "")[1:]]: a for a in root.iter("a")}


def centre(link: etree._Element) -> tuple[float, float]:
    box = next(link.iter("rect"))
    x, y, w, h = (float(box.get(k) or "") for k in ("x", "y", "width", "height"))
    return x + w / 2, y + h / 2


def metre(view: GalleryPlanView) -> float:
    """Pixels of a metre, read off the drawn scale bar as a person with a ruler does."""
    root = etree.fromstring(view.svg)
    bar = next(e.get("d") or "" for e in root.iter("path") if e.get("class") == "pb")
    start, end = float(bar[1:].split(" ")[0]), float(bar.partition("H")[2].partition("V")[0])
    label = next(e.text or "" for e in root.iter("text") if e.get("class") == "pl")
    length, unit = label.split()
    return (end - start) / (float(length) * {"m": 1.0, "ft": 0.3048}[unit])


@pytest.mark.parametrize("units", [Units(), Units("in")])
def test_distances_are_to_the_drawn_scale(units: Units) -> None:
    """79.AA.143 stands at (1, 1), 70.AA.2 at (1.1, 3), 85.AA.40 at (4, 3.2): 0.1 m pixel rounding is 0.2 px at most."""
    view = plan(units)
    where = {number: centre(link) for number, link in shapes(view).items() if list(link.iter("rect"))}
    scale = metre(view)
    (x0, y0), (x1, y1), (x2, y2) = where["79.AA.143"], where["70.AA.2"], where["85.AA.40"]
    assert ((x1 - x0) / scale, (y0 - y1) / scale) == pytest.approx((0.1, 2.0), abs=0.01)
    assert ((x2 - x0) / scale, (y0 - y2) / scale) == pytest.approx((3.0, 2.2), abs=0.01)


def test_a_footprint_is_to_scale_and_turned_as_it_stands() -> None:
    """A width of azimuth 30 points (sin 30, cos 30) east and north; SVG turns with the clock, its y points south."""
    view = plan()
    box = next(shapes(view)["82.AB.7"].iter("rect"))
    size = (float(box.get("width") or ""), float(box.get("height") or ""))
    assert size == pytest.approx((0.5 * metre(view), 0.4 * metre(view)), abs=0.2)
    turn = math.radians(float((box.get("transform") or "").removeprefix("rotate(").split(" ")[0]))
    east, north = math.cos(turn), -math.sin(turn)
    assert (east, north) == pytest.approx((0.5, math.sqrt(0.75)))
    east_facing = next(shapes(view)["85.AA.40"].iter("rect"))
    assert east_facing.get("transform") is None  # its azimuth is 90
    assert next(shapes(view)["73.AA.33"].iter("path")).get("class") == "po pc"  # no footprint: a cross


def test_each_verdict_has_a_fill_of_its_own() -> None:
    kinds = {number: next(iter(link)).get("class") for number, link in shapes(plan()).items()}
    assert (kinds["79.AA.143"], kinds["73.AA.33"], kinds["96.AC.77"]) == ("pa", "po pc", "pu")


def test_the_ring_is_the_room_that_is_asked_for() -> None:
    """Advice that names a clearance is what to keep; else it is the farthest that any model says."""
    item = Item("1", "g")
    moved = builder.sliding(item)
    assert needed_clearance(moved) == 0.131  # the end of the range of 11.8 cm
    kept = replace(moved.recommendations[0], parameters={"clearance": 0.2}, units={"clearance": "m"})
    assert needed_clearance(replace(moved, recommendations=(kept,))) == 0.2
    assert needed_clearance(builder.endless(item)) == 0.05  # an endless end is no room that can be drawn
    assert needed_clearance(builder.unknown(item)) == 0.0
    ring = next(e for e in etree.fromstring(plan().svg).iter("rect") if e.get("class") == "rg")
    assert float(ring.get("rx") or "") > 0.0


def test_the_table_says_what_the_drawing_says() -> None:
    view = plan()
    assert [p.number for p in view.places] == list(range(1, len(builder.PLACES) + 1))
    assert {p.object.number for p in view.places} == set(builder.PLACES)
    assert view.missing == 1
    amphora = next(p for p in view.places if p.object.number == "70.AA.2")
    assert amphora.position == "110\u202fcm east, 300\u202fcm north"
    assert (amphora.footprint, amphora.clearance) == ("50 × 40\u202fcm", "13.5\u202fcm")
    inches = next(p for p in plan(Units("in")).places if p.object.number == "70.AA.2")
    assert inches.footprint == "19\u00a0⅝ × 15\u00a0¾\u00a0in"


def test_without_a_position_there_is_no_plan() -> None:
    museum = shown(builder.record(), Units())
    assert [g.plan is None for g in museum.galleries] == [g.name != builder.GREEK for g in museum.galleries]


def test_what_is_measured_first_is_an_errand_and_a_waste_is_none() -> None:
    found = gallery().survey
    assert [s.what for s in found] == [
        "Narrowest width of its footing",  # makes two checks possible
        "Friction under the base",  # 1.5 verdicts; the other friction would settle nothing
        "Height of its centre of gravity",  # two thirds of one
    ]
    assert [[o.number for o in s.objects] for s in found] == [["96.AC.77"], ["79.AA.143"], ["73.AA.33"]]
    bust = next(o for o in gallery().objects if o.number == "73.AA.33")
    assert [(w.effect, w.waste) for w in bust.wishes] == [
        ("settles it in 2 of 3 trials", False),
        ("alone it settles nothing", True),
    ]


def test_a_task_counts_what_overturns_or_breaks() -> None:
    tasks = {t.title: t for t in gallery().tasks}
    assert tasks["Fasten the object to its base"].grave == 2
    assert tasks["Keep clear around it"].grave == 0


def test_what_settled_the_verdicts_adds_up() -> None:
    museum = shown(builder.record(), Units()).museum
    findings = [f for a in builder.record().assessments for f in a.findings]
    assert sum(d.verdicts for d in museum.decided) == len(findings)
    # The largest share of any history's demand that an error of 0.004 or of the like makes.
    assert {f.capacity_origin for f in findings} == {Origin.DERIVED}
    assert museum.decided[0].means == "a guaranteed bound"
    assert all(d.worst.endswith("%") for d in museum.decided[1:])
    assert Verdict.PASS in {f.verdict for f in findings}


def test_a_line_joins_neighbours_whose_gap_is_too_small(tmp_path: Path) -> None:
    """From centre to centre, once a pair as at its worst level; none where they keep apart or one stands nowhere."""
    pairs = (
        builder.gap("79.AA.143", "82.AB.7", Verdict.UNDETERMINED),
        builder.gap("79.AA.143", "82.AB.7", Verdict.FAIL, "rare"),
        builder.gap("83.AC.10", "82.AB.7", Verdict.UNDETERMINED),
        builder.gap("83.AC.10", "85.AA.40", Verdict.PASS),
        builder.gap("71.AB.9", "85.AA.40", Verdict.FAIL),
    )
    record = replace(builder.record(), spacings=pairs)
    index = render(record, tmp_path / "r")
    museum = shown(record, Units())
    greek = next(g for g in museum.galleries if g.name == builder.GREEK)
    page = etree.parse(str(index.parent / greek.page.file))
    (drawing,) = (e for e in page.iter("svg") if e.get("class") == "plan")
    lines = [e for e in drawing.iter("path") if (e.get("class") or "").startswith("gap ")]
    assert [e.get("class") for e in lines] == ["gap act", "gap open"]
    assert greek.plan is not None
    where = {number: centre(link) for number, link in shapes(greek.plan).items() if list(link.iter("rect"))}
    for line, (first, second) in zip(lines, (("79.AA.143", "82.AB.7"), ("83.AC.10", "82.AB.7")), strict=True):
        ends = [float(n) for n in (line.get("d") or "").strip("M").replace("L", " ").split()]
        assert ends == pytest.approx([*where[first], *where[second]], abs=0.2)
        assert line.get("role") == "img"
        assert (line.findtext("title") or "").startswith(f"{first}, {second}: ")
    text = " ".join("".join(page.getroot().itertext()).split())
    assert "gap between neighbours too small" in text
    assert "gap between neighbours may be too small" in text
    keys = [e.get("class") for ul in page.iter("ul") if ul.get("class") == "key" for e in ul.iter("path")]
    assert keys == ["gap act", "gap open"]


def test_numbers_that_stand_twice_have_no_line() -> None:
    """Two records of one number: nobody knows which of them the pair means."""
    twin = builder.rocking(
        Item("79.AA.143", builder.GREEK, "Twin", base_width_m=0.5, base_depth_m=0.4, position_x_m=3.0, position_y_m=2.0)
    )
    record = replace(builder.record(twin), spacings=(builder.gap("79.AA.143", "82.AB.7", Verdict.FAIL),))
    greek = next(g for g in shown(record, Units()).galleries if g.name == builder.GREEK)
    assert greek.plan is not None
    assert greek.plan.tight == ()


def test_a_plan_of_one_object_says_one() -> None:
    alone = replace(builder.record(), assessments=builder.record().assessments[:1])
    (only,) = shown(alone, Units()).galleries
    assert only.plan is not None
    assert "1 object at its recorded position," in only.plan.svg
