"""The page of a site's records: its numbers are the inspection's, its curves lie where the data say, nothing runs."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from math import exp, log, log10
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from lxml import etree

from pipeline.motions.inspection import Inspection, inspect
from pipeline.motions.intensity import integrate
from pipeline.motions.synthesis import band_limited_random, ricker
from pipeline.quantities import G
from pipeline.records import Motion
from pipeline.report import Units
from pipeline.report.pages.record_charts import envelope, konno_ohmachi
from pipeline.report.pages.record_page import render_record
from pipeline.report.pages.record_words import summary_lines
from pipeline.resources import resource

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

HTML = "{http://www.w3.org/1999/xhtml}"
SVG = "{http://www.w3.org/2000/svg}"

HOSTILE = '<script>alert(1)</script> & \\"Ricker\\"'
X_AZIMUTH = 70.0
PULSE_AZIMUTH = 60.0
"""Degrees clockwise from north of the one direction in which the synthetic record shakes horizontally."""

TARGET = ((0.1, 1.0, 4.0), (0.5, 0.5, 0.05))

ROUNDED = 5.1e-3
"""Relative: three significant digits are off by at most half a unit of the third, which is 5e-3 of 1.00."""


def _table(rows: np.ndarray, dt: float, processed: bool) -> str:
    head = f"# processed: {'yes' if processed else 'no'}\ntime (s), HNE (m/s2), HNN (m/s2), HNZ (m/s2)\n"
    lines = [f"{i * dt:.3f}, " + ", ".join(f"{v:.9e}" for v in row) for i, row in enumerate(rows.T)]
    return head + "\n".join(lines) + "\n"


def _entry(file: Path, name: str, extra: str) -> str:
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    return (
        f'[[level.record]]\nname = "{name}"\nfiles = ["{file.name}"]\n{extra}\nsource = "<b>nobody</b>"\n'
        'licence = "CC0 <i>"\n[level.record.components]\nHNE = { axis = "x" }\nHNN = { axis = "y" }\n'
        'HNZ = { axis = "z" }\n'
        f'[level.record.sha256]\n"{file.name}" = "{digest}"\n'
    )


def _folder(folder: Path) -> Path:
    """A site with one pulse in one known direction, once raw with a drifting baseline, once as processed."""
    pulse = ricker(2.4, 1.6, of="acceleration", dt=0.01)
    noise = band_limited_random(0.05, 0.5, 20.0, 40.0, 3, dt=0.01, ramp=3.0).acceleration[0]
    n, first = noise.size, 1500
    along = np.zeros(n)
    along[first : first + pulse.samples] = pulse.acceleration[0]
    turn = np.radians(PULSE_AZIMUTH)
    rows = np.stack([np.sin(turn) * along, np.cos(turn) * along, noise])
    drift = np.linspace(-0.02, 0.06, n) ** 2 * 10.0
    (folder / "raw.csv").write_text(_table(rows + 0.05 + drift, 0.01, False))
    (folder / "done.csv").write_text(_table(rows, 0.01, True))
    (folder / "manifest.toml").write_text(
        f'[site]\nname = "The <b>site</b>"\nlatitude = 34.0\nlongitude = -118.0\nx_azimuth = {X_AZIMUTH}\n'
        '[[level]]\nname = "design"\ncombine = "max"\n'
        f"[level.target]\nperiods_s = {list(TARGET[0])}\npsa_g = {list(TARGET[1])}\n"
        + _entry(folder / "raw.csv", HOSTILE, "highpass_hz = 0.08\nlowpass_hz = 20.0")
        + _entry(folder / "done.csv", "as its source left it", "")
    )
    return folder


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> list[Inspection]:
    return inspect(_folder(tmp_path_factory.mktemp("site")))


@pytest.fixture(scope="module")
def file(records: list[Inspection], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return render_record(records, tmp_path_factory.mktemp("page") / "records.html", Units())


@pytest.fixture(scope="module")
def sections(file: Path) -> list[etree._Element]:
    # The page is written as XML too, so that a strict parser, which repairs nothing, is the judge.
    return [e for e in etree.parse(str(file)).iter("section") if e.get("class") == "rec"]


def _text(element: etree._Element) -> str:
    return " ".join("".join(element.itertext()).split())


def _rows(section: etree._Element, caption: str) -> dict[str, list[str]]:
    table = next(t for t in section.iter("table") if _text(t.find("caption")).startswith(caption))
    return {_text(r.find("th")): [_text(c) for c in r.findall("td")] for r in table.find("tbody")}


def _number(text: str) -> float:
    return float(text.replace("−", "-"))


def _svgs(section: etree._Element, title: str) -> list[etree._Element]:
    return [s for s in section.iter("svg") if s.find("title") is not None and title in _text(s.find("title"))]


def _paths(svg: etree._Element, kind: str) -> list[np.ndarray]:
    found = [p.get("d") for p in svg.iter("path") if kind in (p.get("class") or "").split()]
    pairs = (re.findall(r"([-\d.]+) ([-\d.]+)", d) for d in found)
    return [np.array([(float(x), float(y)) for x, y in points]) for points in pairs if points]


# -- numbers ----------------------------------------------------------------------------------------------------------


def test_measures_before_and_after_are_those_of_the_inspection(
    records: list[Inspection], sections: list[etree._Element]
) -> None:
    one = records[0]
    rows = _rows(sections[0], "How strong")
    for stem, title, factor in (("pga", "PGA (g)", 1.0 / G), ("pgv", "PGV (cm/s)", 100.0), ("pgd", "PGD (cm)", 100.0)):
        keys = [f"{stem}_{axis}" for axis in ("x", "y", "z", "resultant")]
        wanted = [factor * values[key] for key in keys for values in (one.measures_before, one.measures)]
        assert [_number(cell) for cell in rows[title]] == pytest.approx(wanted, rel=ROUNDED)
    left = [100.0 * integrate(m)[1][axis, -1] for axis in range(3) for m in (one.before, one.motion)]
    assert [_number(c) for c in rows["Displacement left at the end (cm)"][:6]] == pytest.approx(left, rel=ROUNDED)
    span = [one.measures_before["duration_5_95"], one.measures["duration_5_95"]]
    assert [_number(c) for c in rows["Significant duration D5–95 (s)"][6:]] == pytest.approx(span, rel=ROUNDED)


def test_a_record_processed_by_its_source_has_no_before(
    records: list[Inspection], sections: list[etree._Element]
) -> None:
    assert not records[1].filtered
    assert "Processed by its source and left alone" in _text(sections[1])
    wanted = [records[1].measures[f"pga_{axis}"] / G for axis in ("x", "y", "z", "resultant")]
    assert [_number(c) for c in _rows(sections[1], "How strong")["PGA (g)"]] == pytest.approx(wanted, rel=ROUNDED)
    assert not [p for svg in sections[1].iter("svg") for p in _paths(svg, "was")]
    assert [p for svg in sections[0].iter("svg") for p in _paths(svg, "was")]


def test_lengths_follow_the_readers_unit(records: list[Inspection], tmp_path: Path) -> None:
    page = etree.parse(str(render_record(records[:1], tmp_path / "r.html", Units("in"))))
    row = _rows(page.getroot(), "How strong")["PGD (in)"]
    assert _number(row[1]) == pytest.approx(records[0].measures["pgd_x"] / 0.0254, rel=ROUNDED)
    assert "Velocity (in/s)" in _text(page.getroot())


def test_spectra_are_the_inspections_and_the_target_is_straight_in_log_log(
    records: list[Inspection], sections: list[etree._Element]
) -> None:
    spectra = records[0].spectra
    for period, cells in _rows(sections[0], "Pseudo-acceleration in g").items():
        k = int(np.argmin(np.abs(spectra["x"].periods - float(period))))
        exact = float(spectra["x"].periods[k])
        assert float(period) == pytest.approx(exact, rel=ROUNDED)
        wanted = [spectra[name].pseudo_acceleration[0, k] / G for name in ("x", "y", "z", "rotd50")]
        wanted += list(spectra["rotd100"].pseudo_acceleration[:, k] / G)
        assert [_number(c) for c in cells[:7]] == pytest.approx(wanted, rel=ROUNDED)
        if exact < 0.1 or exact > 4.0:
            assert cells[7] == "–"
        elif exact <= 1.0:
            assert _number(cells[7]) == pytest.approx(0.5, rel=ROUNDED)
        else:  # from 0.5 g at 1 s to 0.05 g at 4 s the slope in log-log is -log(10)/log(4)
            assert _number(cells[7]) == pytest.approx(exp(log(0.5) - log(10) / log(4) * log(exact)), rel=ROUNDED)


def test_the_pulse_points_where_it_was_made_whatever_the_axes_are(
    records: list[Inspection], sections: list[etree._Element]
) -> None:
    """The record shakes along azimuth 60 degrees alone; its axes are turned to 70 and 340."""
    found = records[0].pulse
    assert found is not None
    assert found.is_pulse
    said = _text(sections[0])
    azimuth = re.search(r"azimuth (\d+)° or (\d+)° clockwise from north", said)
    assert azimuth is not None
    # The filters work on each row alike, and the page writes whole degrees.
    assert float(azimuth[1]) == pytest.approx(PULSE_AZIMUTH, abs=1.0)
    assert float(azimuth[2]) == float(azimuth[1]) + 180.0
    assert f"Pulse-like (Shahi and Baker 2014, indicator {found.indicator:.1f}" in said
    cycle = records[0].half_cycles["x"][0]
    first = next(r for r in _table_rows(sections[0], "Largest half-cycles"))
    assert [_number(c) for c in first[1:]] == pytest.approx(
        [cycle.start, cycle.duration, 100.0 * cycle.peak, 100.0 * cycle.area], rel=ROUNDED
    )


def _table_rows(section: etree._Element, caption: str) -> list[list[str]]:
    table = next(t for t in section.iter("table") if _text(t.find("caption")).startswith(caption))
    return [[_text(c) for c in row] for row in table.find("tbody")]


def test_corners_say_who_chose_them(records: list[Inspection], sections: list[etree._Element], tmp_path: Path) -> None:
    assert "high-pass at 0.08 Hz, low-pass at 20 Hz" in _text(sections[0])
    assert "Given in the site’s manifest" in _text(sections[0])
    steps = ("high-pass corner 0.08 Hz chosen by noise: 3 times", "clipped <b>; accepted: I looked at it")
    chosen = replace(records[0], motion=_with_steps(records[0], steps))
    text = _text(etree.parse(str(render_record([chosen], tmp_path / "r.html", Units()))).getroot())
    assert "Chosen from the record by noise: 3 times" in text
    assert "Accepted by a person: clipped <b>; accepted: I looked at it" in text
    assert any("accepted: I looked at it" in line for line in summary_lines(chosen, Units()))


def _with_steps(one: Inspection, steps: tuple[str, ...]) -> Motion:
    return Motion(one.motion.dt, one.motion.acceleration, one.motion.name, steps, one.motion.source)


def test_a_record_without_horizontal_shaking_says_so(records: list[Inspection], tmp_path: Path) -> None:
    still = replace(records[0], pulse=None, half_cycles={"x": (), "y": ()})
    text = _text(etree.parse(str(render_record([still], tmp_path / "r.html", Units()))).getroot())
    assert "No pulse was looked for" in text
    assert any("No pulse was looked for" in line for line in summary_lines(still, Units()))


# -- drawings ---------------------------------------------------------------------------------------------------------


def _value_scale(svg: etree._Element, low: float, high: float) -> tuple[float, float]:
    """Slope and offset from pixels down to values, from the labelled ticks between two pixels."""
    ticks = [t for t in svg.iter("text") if t.get("class") == "ty" and low <= float(t.get("y")) - 4.0 <= high]
    pixels, values = [float(t.get("y")) - 4.0 for t in ticks], [_number(_text(t)) for t in ticks]
    slope, offset = np.polyfit(pixels, values, 1)
    return float(slope), float(offset)


def test_peaks_survive_the_thinning_and_lie_where_the_ticks_say(
    records: list[Inspection], sections: list[etree._Element]
) -> None:
    """Pixels and ticks are written to 0.1; the panel is 108 pixels high for 2.24 peaks or more: 0.5 % of the peak."""
    for axis, svg in zip("xyz", _svgs(sections[0], "acceleration, velocity and displacement"), strict=True):
        for row, (stem, factor) in enumerate((("pga", 1.0 / G), ("pgv", 100.0), ("pgd", 100.0))):
            top = 8.0 + 120.0 * row
            slope, offset = _value_scale(svg, top, top + 108.0)
            drawn = slope * _paths(svg, f"c{axis}")[row][:, 1] + offset
            largest = factor * max(records[0].measures[f"{stem}_{a}"] for a in "xyz")
            wanted = factor * records[0].measures[f"{stem}_{axis}"]
            assert np.abs(drawn).max() == pytest.approx(wanted, abs=0.01 * largest)


def test_a_drifting_record_is_cut_off_and_said_to_be(records: list[Inspection], sections: list[etree._Element]) -> None:
    before, after = records[0].measures_before["pgd_x"], records[0].measures["pgd_x"]
    assert before > 3.0 * after
    said = re.search(r"drifts in .*displacement in all three directions, up to ([\d.]+)\s*cm", _text(sections[0]))
    assert said is not None
    most = max(records[0].measures_before[f"pgd_{axis}"] for axis in "xyz")
    assert float(said[1]) == pytest.approx(100.0 * most, rel=ROUNDED)
    assert "drifts in" not in _text(sections[1])
    svg = _svgs(sections[0], "acceleration, velocity and displacement")[0]
    # What leaves the frame is hidden by the clip of its panel.
    assert _paths(svg, "was")[2][:, 1].min() < 248.0 or _paths(svg, "was")[2][:, 1].max() > 356.0
    clips = {c.get("id"): c.find("rect") for c in svg.iter("clipPath")}
    groups = [g.get("clip-path") for g in svg.iter("g")]
    assert [g[5:-1] for g in groups] == list(clips)


def test_corners_stand_at_their_frequencies(sections: list[etree._Element]) -> None:
    """The axis runs from 0.01 Hz to the Nyquist frequency of 50 Hz over the pixels 64 to 324, logarithmic."""
    for svg in _svgs(sections[0], "Fourier amplitude"):
        at = [float(p.get("d")[1:].split()[0]) for p in svg.iter("path") if p.get("class") == "corner"]
        wanted = [64.0 + 260.0 * log10(f / 0.01) / log10(50.0 / 0.01) for f in (0.08, 20.0)]
        assert at == pytest.approx(wanted, abs=0.5)  # the last line of the transform is within one line of Nyquist
    assert not [p for s in _svgs(sections[1], "Fourier") for p in s.iter("path") if p.get("class") == "corner"]


def test_the_target_is_drawn_beside_the_spectra(sections: list[etree._Element]) -> None:
    horizontal, components = _svgs(sections[0], "response spectra")
    (target,) = (p for p in _paths(horizontal, "target") if len(p) > 2)
    wanted = [64.0 + 360.0 * log10(t / 0.01) / log10(20.0 / 0.01) for t in TARGET[0]]
    assert target[:, 0] == pytest.approx(wanted, abs=0.06)  # pixels are written to 0.1
    assert target[0, 1] == target[1, 1] < target[2, 1]
    # The sample of a legend is a path of one point and a step.
    assert sum(len(p) > 2 for p in _paths(components, "was")) == 3
    assert sum(len(p) > 2 for kind in ("thin1", "thin2") for p in _paths(horizontal, kind)) == 2


def test_the_pulse_lies_over_its_velocity_and_the_residue_below(
    records: list[Inspection], sections: list[etree._Element]
) -> None:
    """Two panels of 150 pixels for 2.24 times the peak: pixels written to 0.1 are 0.2 % of it."""
    found = records[0].pulse
    assert found is not None
    (svg,) = _svgs(sections[0], "velocity pulse and residue")
    for kind, top, peak in (
        ("vel", 26, found.pgv),
        ("cx", 26, found.pulse_pgv),
        ("rest", 190, found.pgv_ratio * found.pgv),
    ):
        slope, offset = _value_scale(svg, top, top + 150)
        (line,) = (p for p in _paths(svg, kind) if len(p) > 2)
        assert np.abs(slope * line[:, 1] + offset).max() == pytest.approx(100.0 * peak, abs=1.0 * found.pgv)


def test_smoothing_keeps_a_flat_spectrum_and_the_place_of_a_peak() -> None:
    frequency = np.linspace(0.0, 50.0, 5001)
    flat = np.ones((3, frequency.size))
    centres, out = konno_ohmachi(frequency, flat, 0.01)
    assert out == pytest.approx(1.0, rel=1e-12)  # the weights add up to one
    assert (np.diff(centres) > 0.0).all()
    assert centres[[0, -1]] == pytest.approx([0.01, 50.0], rel=1e-12)
    peaked = 1.0 / np.hypot(frequency / 3.0 - 3.0 / np.maximum(frequency, 1e-9), 0.1)
    centres, out = konno_ohmachi(frequency, np.stack([peaked] * 3), 0.01)
    # 240 centres over 3.7 decades are 3.6 % apart.
    assert centres[np.argmax(out[0])] == pytest.approx(3.0, rel=0.036)
    assert out.max() < peaked.max()


def test_a_long_history_keeps_its_extremes_at_their_times() -> None:
    values = np.random.default_rng(7).normal(size=20_011)
    t, thinned = envelope(values, 0.005)
    assert thinned.size <= 602
    assert thinned.min() == values.min()
    assert thinned.max() == values.max()
    assert t[np.argmax(thinned)] == pytest.approx(0.005 * np.argmax(values), rel=1e-12)
    assert values[np.rint(t / 0.005).astype(int)] == pytest.approx(thinned, abs=0.0)


# -- the page as a file -----------------------------------------------------------------------------------------------


def test_it_is_well_formed_and_every_drawing_has_words(file: Path) -> None:
    page = etree.parse(str(file))
    ids = Counter(e.get("id") for e in page.iter() if e.get("id"))
    assert [i for i, n in ids.items() if n > 1] == []
    assert len(list(page.iter("h1"))) == 1
    levels = [int(str(e.tag)[1]) for e in page.iter("h1", "h2", "h3", "h4")]
    assert all(b - a <= 1 for a, b in pairwise(levels))
    pictures = [s for s in page.iter("svg") if s.get("aria-hidden") is None]
    assert len(pictures) == 2 * 9
    for svg in pictures:
        assert svg.get("role") == "img"
        assert (svg.get("aria-labelledby") or "").split() == [svg.find("title").get("id"), svg.find("desc").get("id")]
        assert _text(svg.find("desc"))
    assert all(link.get("href")[1:] in ids for link in page.iter("a"))


def test_what_files_say_stays_text(file: Path, records: list[Inspection]) -> None:
    page = etree.parse(str(file))
    assert not list(page.iter("script", "b", "i", "img", "iframe"))
    headings = [_text(e) for e in page.iter("h2")]
    assert headings[0] == records[0].motion.name == '<script>alert(1)</script> & "Ricker"'
    text = _text(page.getroot())
    assert "<b>nobody</b>" in text
    assert "CC0 <i>" in text
    for step in records[0].motion.steps:
        assert " ".join(step.split()) in text


def test_a_control_character_reaches_neither_page_nor_terminal(records: list[Inspection], tmp_path: Path) -> None:
    motion = records[0].motion.called("bell\x07\x1b[2J", "step \x1b[31m; accepted: \x07")
    one = replace(records[0], motion=motion, level="\x1b]0;t")
    text = render_record([one], tmp_path / "r.html", Units()).read_text(encoding="utf-8")
    for said in (text, *summary_lines(one, Units())):
        assert "\x1b" not in said
        assert "\x07" not in said


def test_the_same_records_give_the_same_bytes(file: Path, records: list[Inspection], tmp_path: Path) -> None:
    again = render_record(records, tmp_path / "r.html", Units())
    assert again.read_bytes() == file.read_bytes()
    assert list(tmp_path.iterdir()) == [again]


def test_a_page_weighs_little(file: Path) -> None:
    """Two records: a mail program still takes the page, a browser still scrolls it."""
    assert file.stat().st_size < 600_000


# -- the terminal -----------------------------------------------------------------------------------------------------


def test_the_summary_is_short_and_says_the_numbers(records: list[Inspection]) -> None:
    for one in records:
        lines = summary_lines(one, Units())
        assert 8 <= len(lines) <= 14
        pga = next(line for line in lines if line.startswith("  PGA"))
        found = [float(v) for v in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", pga)]
        values = (one.measures_before, one.measures) if one.filtered else (one.measures,)
        keys = [f"pga_{axis}" for axis in ("x", "y", "z", "resultant")]
        assert found == pytest.approx([v[key] / G for key in keys for v in values], rel=ROUNDED)
    lines = "\n".join(summary_lines(records[0], Units()))
    assert "high-pass at 0.08 Hz, low-pass at 20 Hz" in lines
    assert "Azimuth 60 degrees" in lines


# -- the demonstration site, in a browser -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def demo_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With spectra of few periods: those of the synthetic record above are whole."""
    folder = tmp_path_factory.mktemp("demo")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pipeline.motions.inspection.SPECTRUM_POINTS", 12)
        return render_record(inspect(resource("site_motions", "demo")), folder / "records.html", Units())


def test_the_demonstration_site_is_raw_and_its_axes_are_north_and_east(demo_page: Path) -> None:
    text = _text(etree.parse(str(demo_page)).getroot())
    assert "high-pass at 0.1 Hz" in text
    assert "East (x)" in text
    assert "North (y)" in text


@pytest.mark.browser
@pytest.mark.parametrize("width", [1200, 400])
def test_it_opens_without_complaint_and_without_a_sideways_scroll(
    browser: Chrome, demo_page: Path, file: Path, width: int
) -> None:
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        for page in (demo_page, file):
            browser.get(page.as_uri())
            assert [e for e in browser.get_log("browser") if e["level"] == "SEVERE"] == []
            assert browser.execute_script("return innerWidth") == width
            assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
            boxes = browser.execute_script(
                "return [...document.querySelectorAll('svg.chart')].map(e => e.getBoundingClientRect())"
                ".map(r => [r.width, r.height])"
            )
            assert all(wide > 300 and high > 200 for wide, high in boxes)
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.browser
def test_no_word_leaves_its_drawing(browser: Chrome, file: Path) -> None:
    browser.get(file.as_uri())
    outside = browser.execute_script(
        """
        const out = [];
        for (const svg of document.querySelectorAll('svg.chart')) { const s = svg.getBoundingClientRect();
          for (const t of svg.querySelectorAll('text')) { const r = t.getBoundingClientRect();
            if (r.left < s.left - 1 || r.right > s.right + 1 || r.top < s.top - 1 || r.bottom > s.bottom + 1)
              out.push(t.textContent) } }
        return out
        """
    )
    assert outside == []
