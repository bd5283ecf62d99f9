"""What many objects share is told once a page, and nothing is lost by it."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest
from lxml import etree
from markupsafe import Markup

from pipeline.analysis.classify import classify
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.rule import HouseRule
from pipeline.records import Item, Mark, Verdict
from pipeline.report import Units, render
from pipeline.report.pages.museum_views import GalleryView
from pipeline.report.pages.notes import Notes, PageNotes
from pipeline.report.pages.views import NumberView

from . import builder
from .shown import Shown, shown

SHARED, ALONE = "friction: 0.18, not measured", "mass: weighed with <its> frame"


@pytest.fixture(scope="module")
def museum() -> Shown:
    return shown(builder.record(), Units())


def test_what_recurs_is_listed_and_cited_and_what_does_not_stays_where_it_is() -> None:
    notes = Notes("A", [(SHARED, ""), (ALONE, "a list"), (SHARED, "Table 3"), (SHARED, "Table 3")])
    assert [(n.label, n.text, n.source) for n in notes.listed] == [("A1", SHARED, "Table 3")]
    assert notes.cite([ALONE, SHARED]) == Markup('mass: weighed with &lt;its&gt; frame; <a href="#A1">friction A1</a>')


@pytest.mark.parametrize("text", ["no colon at all", "x" * 60 + ": a long beginning"])
def test_a_text_without_a_short_beginning_is_cited_by_its_number_alone(text: str) -> None:
    assert Notes("R", [(text, ""), (text, "")]).cite([text]) == '<a href="#R1">R1</a>'


def test_a_hostile_beginning_stays_text() -> None:
    text = '<script>alert("1")</script>: it is rejected'
    cited = Notes("R", [(text, ""), (text, "")]).cite([text])
    assert cited == '<a href="#R1">&lt;script&gt;alert(&#34;1&#34;)&lt;/script&gt; R1</a>'


def test_numbers_tell_their_origin_and_cite_their_note() -> None:
    numbers = (
        NumberView("mass 860\u202fkg", "measured", "", ""),
        NumberView("friction 0.18 (0.12 to 0.37)", "assumed", SHARED, "Table 3"),
        NumberView("height 1\u202fm", "assumed", ALONE, "a list"),
    )
    notes = PageNotes(Notes("A", [(SHARED, "Table 3"), (SHARED, "")]), Notes("R", ()), Notes("M", ()))
    assert notes.numbers(numbers) == (
        'Measured: mass 860\u202fkg. Assumed: friction 0.18 (0.12 to 0.37) <a href="#A1">A1</a>; '
        "height 1\u202fm (mass: weighed with &lt;its&gt; frame; a list)."
    )


def _text(folder: Path, gallery: GalleryView) -> str:
    page = etree.parse(str(folder / gallery.page.file))
    return " ".join("".join(page.getroot().itertext()).split())


def test_every_fact_about_every_object_is_on_its_page(report: Path, museum: Shown) -> None:
    told = {gallery.page.file: _text(report, gallery) for gallery in museum.galleries}
    assert told
    for gallery in museum.galleries:
        for view in (o for o in gallery.objects if o.carded):
            facts = [*view.assumptions, *view.skipped, *(n.text for n in view.numbers)]
            facts += [text for f in view.findings for text in (f.sentence, f.numbers, f.screen, f.note)]
            facts += [text for m in view.measures for text in (m.sentence, *m.rejected, m.source)]
            facts += [text for m in view.measures for c in m.checks for text in (c.title, c.demand, c.capacity)]
            missing = [fact for fact in facts if " ".join(fact.split()) not in told[gallery.page.file]]
            assert missing == [], gallery.page.file


def test_each_object_links_only_to_notes_of_its_own(report: Path, museum: Shown) -> None:
    """An entry's links name exactly the texts that its view holds, read back through the page's lists."""
    for gallery in museum.galleries:
        page = etree.parse(str(report / gallery.page.file))
        listed = {e.get("id"): " ".join("".join(e.itertext()).split()) for e in page.iterfind(".//li[@id]")}
        for view in (o for o in gallery.objects if o.carded):
            card = page.find(f".//article[@id='{view.anchor}']")
            assert card is not None
            cited = {(a.get("href") or "")[1:] for a in card.iter("a")} & set(listed)
            own = {*view.assumptions, *view.skipped, *(n.note for n in view.numbers)}
            own |= {text for m in view.measures for text in m.rejected} | {
                t for f in view.findings for t in f.assumptions
            }
            assert cited
            assert all(any(" ".join(text.split()) in listed[label] for text in own if text) for label in cited)


def test_pictures_are_for_what_fails_and_for_the_measure_never_for_what_passes(report: Path, museum: Shown) -> None:
    for gallery in museum.galleries:
        page = etree.parse(str(report / gallery.page.file))
        for view in gallery.objects:
            card = page.find(f".//article[@id='{view.anchor}']")
            pictures = [] if card is None else list(card.iter("figure"))
            assert len(pictures) == len(view.figures)
            assert view.state == "act" or not pictures


def test_a_passing_finding_marks_no_chart() -> None:
    whole = builder.rocking(Item("1", "g"))
    failing, passing = whole.findings
    marked = replace(passing, mark=Mark(f"friction:{builder.HASH}", 0.2, 0.041))
    for verdict, kinds in ((Verdict.PASS, ["stability"]), (Verdict.UNDETERMINED, ["stability", "friction"])):
        both = replace(whole, findings=(failing, replace(marked, verdict=verdict)))
        (gallery,) = shown(replace(builder.record(), assessments=(both,)), Units()).galleries
        assert [figure.chart.partition(":")[0] for figure in gallery.objects[0].figures] == kinds


def test_a_page_names_the_house_rule_behind_each_number_and_each_word(tmp_path: Path) -> None:
    """What a rule states, what it says of how the object stands, and where the record overrules it."""
    rules = [
        HouseRule(gallery="Hall <1>", friction=0.31, clearance_m=0.5, furniture="showcase", said_by="A. Smith & Co",
                  said_on=date(2031, 5, 1)),
    ]  # fmt: skip
    vase = Item("1", "Hall <1>", "Vase", height_m=0.4, width_m=0.2, depth_m=0.2, clearance_m=0.2)
    scene = classify(vase, house=HouseRules(rules, ["vessel"]))
    run = builder.record()
    finding = next(f for a in run.assessments for f in a.findings if f.verdict is Verdict.FAIL)
    told = replace(finding, object_number="1", gallery="Hall <1>", mark=None)
    assessment = replace(run.assessments[0], scene=scene, findings=(told,), recommendations=(), fragilities=())
    folder = render(replace(run, assessments=(assessment,), wishes=None, decisions=()), tmp_path / "one").parent
    page = next(file for file in folder.glob("*.html") if 'class="card' in file.read_text(encoding="utf-8"))
    text = " ".join("".join(etree.parse(str(page)).getroot().itertext()).split())
    rule = "by the house rule for gallery Hall <1>"
    assert f"House rules: it stands in a showcase, {rule} (A. Smith & Co, 2031-05-01)" in text
    assert f"Stated by a house rule: friction static 0.31 (friction: {rule}; A. Smith & Co, 2031-05-01)" in text, text[
        text.index("Stated by") :
    ][:200]
    assert "clearance_m: its record says 0.2, which is used; the house rule for gallery Hall <1>" in text
    assert "clearance 20 cm" in text.replace("\u202f", " ")
