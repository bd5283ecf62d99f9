"""The page of the earthquake: measures in a table, all charts of the motion, and who answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from lxml import etree

from pipeline.motions.corner_range import CornerRange
from pipeline.quantities import G
from pipeline.report import Units, render
from pipeline.report.pages.ground import motion_view

from . import builder

COLUMNS = ("East (x)", "North (y)", "Up (z)", "Larger horizontal", "Resultant")


def test_measures_stand_in_their_row_and_column() -> None:
    measures = {"pga_x": 0.5 * G, "pga_y": 0.7 * G, "pga_z": 0.4 * G, "pga": 0.7 * G, "pga_resultant": 0.8 * G}
    motion = replace(builder.motion(), measures=measures | {"pgv": 0.57, "arias_y": 5.124, "duration_5_95": 15.943})
    view = motion_view(motion, {}, Units())
    assert view.columns == COLUMNS
    assert view.table == (
        ("PGA", ("0.5\u202fg", "0.7\u202fg", "0.4\u202fg", "0.7\u202fg", "0.8\u202fg")),
        ("PGV", ("–", "–", "–", "57\u202fcm/s", "–")),
        ("Arias intensity", ("–", "5.12 m/s", "–", "–", "–")),
    )
    assert view.others == (("Significant duration (5 to 95 %)", "15.9\u202fs"),)


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("pulse_period", 1.25, ("Pulse period", "1.25\u202fs")),
        ("arias_intensity", 4.2, ("Arias intensity", "4.2 m/s")),
        ("pgv_of_the_pulse", 0.3, ("PGV of the pulse", "30\u202fcm/s")),
        ("something", 2.0, ("Something", "2 (SI)")),
        ("something", float("inf"), ("Something", "no limit (∞)")),
    ],
)
def test_a_measure_without_a_column_is_listed_with_its_unit(name: str, value: float, shown: tuple[str, str]) -> None:
    view = motion_view(replace(builder.motion(), measures={name: value}), {}, Units())
    assert view.others == (shown,)
    assert not view.table


def test_what_hangs_on_the_corner_is_said_of_the_ground() -> None:
    step = CornerRange((0.05, 0.2), (0.468, 0.616), (0.137, 0.434)).scaled(1.0)
    motion = replace(builder.motion(), steps=("high-pass 0.1 Hz", step))
    assert motion_view(motion, {}, Units()).corner == (
        "For seismologists: between half and double of the corner of its filter (0.05 and 0.2\u00a0Hz) the resultant "
        "PGV is 46.8 to 61.6\u202fcm/s and the PGD 13.7 to 43.4\u202fcm. The verdicts are of the corner that was used."
    )
    assert not motion_view(replace(motion, floor="attic"), {}, Units()).corner
    assert not motion_view(builder.motion(), {}, Units()).corner


def test_its_own_charts_come_in_the_order_of_the_papers_figures() -> None:
    charts = builder.charts()
    stranger = replace(next(iter(charts.values())), key="stability:0000000000000000")
    spectrum = replace(
        charts[f"swing:{builder.HASH}"], key=f"spectrum:{builder.HASH[:16]}", source="Nigam and Jennings"
    )
    held = {c.key: c for c in (spectrum, stranger, *reversed(charts.values()))}
    kinds = [key.partition(":")[0] for key in motion_view(builder.motion(), held, Units()).charts]
    assert kinds == ["stability", "path", "friction", "swing", "isolator", "spectrum"]  # Figures 2 to 6, then none


def test_the_page_shows_every_chart_with_caption_source_and_steps(report: Path) -> None:
    page = etree.parse(str(report / "motion.html"))
    figures = list(page.iterfind(".//div[@class='pair']/figure"))
    assert [f.findtext("h4") for f in figures] == [
        c.title for c in sorted(builder.charts().values(), key=lambda c: c.source)
    ]
    for chart in builder.charts().values():
        (caption,) = ("".join(e.itertext()) for e in page.iter("figcaption") if chart.caption in "".join(e.itertext()))
        assert chart.source in caption
    assert [li.text for li in page.iterfind(".//ol[@class='steps']/li")] == list(builder.motion().steps)
    assert builder.record().level_notes[0] in " ".join(page.getroot().itertext())


def test_a_chart_that_marks_nothing_says_what_it_shows(report: Path) -> None:
    page = etree.parse(str(report / "motion.html"))
    told = {e.findtext("title"): e.findtext("desc") or "" for e in page.iter("svg") if e.get("role") == "img"}
    assert "Lines: uplift, overturning. Zones: stays still, rocks, overturns." in told["Rocking stability"]
    assert not [text for text in told.values() if "Nothing is marked" in text]


@pytest.mark.parametrize(
    ("settings", "shown"),
    [({"credit": "Museum <b>A</b> & B (CC0)"}, True), ({"credit": ""}, False), ({}, False), ({"credit": None}, False)],
)
def test_the_sources_credit_is_in_the_footer_of_every_page(
    settings: dict[str, object], shown: bool, tmp_path: Path
) -> None:
    folder = render(replace(builder.record(), settings=settings), tmp_path / "r").parent
    for path in folder.glob("*.html"):
        footer = " ".join("".join(etree.parse(str(path)).find(".//footer").itertext()).split())
        assert ("Collection data: Museum <b>A</b> & B (CC0)." in footer) is shown
        assert "Collection data" in footer or not shown
        assert builder.record().run_id in footer
