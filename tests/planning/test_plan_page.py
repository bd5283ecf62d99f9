"""The page and the sheet of a plan: bounded, in order, and whatever a museum's texts hold stays text."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from gettext import GNUTranslations
from io import BytesIO
from pathlib import Path

import openpyxl
import pytest
from babel.messages.mofile import write_mo
from lxml import html

from pipeline.mitigate.by_class import NAMED_FIRST
from pipeline.mitigate.saying import HEAVIEST, SIZED
from pipeline.planning.choice import EffortLimits
from pipeline.planning.efforts import efforts
from pipeline.planning.errands import Advised
from pipeline.planning.plan import ErrandPlan, PlanTerms, plan_of
from pipeline.report import Language
from pipeline.report.files.plan_files import PLAN_COLUMNS, write_plan_sheet, write_plan_table
from pipeline.report.pages.compose import PageHead
from pipeline.report.pages.errand_views import SHOWN, number, plan_page, plan_view
from pipeline.tables import table
from tests.report.builder import HOSTILE
from tests.report.test_language import catalogue
from tests.soak import SOAK

from .objects import advised, collection

TITLES = {row["measure"]: row["title"] for row in table("measures")}
HEAD = PageHead("Museum <b>", "1", "2031-01-01T00:00:00", "0", "", demonstration=False)


def planned(found: list[Advised], limits: EffortLimits | None = None) -> ErrandPlan:
    return plan_of(found, 1.2 * sum(one.loss for one in found), {}, PlanTerms(efforts(), limits or EffortLimits()))


def shown(plan: ErrandPlan, *, alone: bool = False) -> html.HtmlElement:
    return html.fromstring(plan_page(plan, HEAD, Language(), alone=alone))


def words(element: html.HtmlElement) -> str:
    return " ".join(element.text_content().split())


def hostile() -> list[Advised]:
    return [
        Advised(f"{number_}{text}", text, text, text, "wax", text, f"{text}: do it.", 2.0, 0.1, f"e.html#{number_}")
        for number_, text in HOSTILE.items()
    ]


def test_hostile_texts_are_text_on_the_page_and_in_the_list(tmp_path: Path) -> None:
    plan = planned(hostile())
    page = shown(plan)
    assert not page.xpath("//script|//img|//*[@onerror]")
    said = words(page)
    assert "<script>alert(1)</script>" in said
    assert "{{7*7}}" in said
    assert "{demand}" in said
    assert "\ud800" not in said
    file = tmp_path / "plan.csv"
    write_plan_table(file, plan)
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(HOSTILE)
    assert tuple(rows[0]) == PLAN_COLUMNS
    for row in rows:
        assert not any(cell[:1] in "=+@\t\r" for cell in row.values() if cell)
        assert float(row["hours"]) > 0.0


def test_hostile_texts_are_text_on_the_sheet(tmp_path: Path) -> None:
    file = tmp_path / "plan.xlsx"
    write_plan_sheet(file, planned([*hostile(), advised("9", "remove", 1.0)]))
    book = openpyxl.load_workbook(file)
    assert book.sheetnames == ["Plan", "To decide with a curator"]
    assert all(cell.data_type != "f" for sheet in book for row in sheet.iter_rows() for cell in row)
    assert len(list(book["Plan"].iter_rows(min_row=2))) == len(HOSTILE)
    galleries = {cell.value for (cell,) in book["Plan"].iter_rows(min_row=2, min_col=2, max_col=2)}
    assert HOSTILE["H.1"] in galleries
    assert HOSTILE["H.3"] in galleries
    assert book["Plan"].print_title_rows == "$1:$1"


def test_the_first_layer_says_what_there_is_and_what_that_avoids() -> None:
    found = collection(40, 3)
    limits = EffortLimits(40.0, 5_000.0, {"mount-maker": 12.0})
    plan = planned(found, limits)
    page = shown(plan)
    lede = words(page.xpath("//p[@class='lede']")[0])
    assert lede.startswith("With 40 hours, 12 hours of a mount-maker and a cost of 5,000 you avoid ")
    assert f"{plan.share:.0%}".replace("%", " %") in lede
    rows = page.xpath("//table[contains(@class, 'errands')]")[0].xpath("tbody/tr")
    assert [int(words(row.xpath("th")[0])) for row in rows] == [at + 1 for at in sorted(plan.choice.chosen)]
    assert len(page.xpath("//span[@class='tick']")) == len(rows)
    # The numbers of the page are those of the plan.
    assert number(plan.hours.value) in words(page)
    assert number(plan.cost.value) in words(page)
    (picture,) = page.xpath("//svg[contains(@class, 'chart')]")
    assert "this plan" in words(picture)


def test_without_limits_what_avoids_most_for_an_hour_comes_first() -> None:
    plan = planned(collection(40, 4))
    rows = shown(plan).xpath("//table[contains(@class, 'errands')]")[0].xpath("tbody/tr")
    assert [int(words(row.xpath("th")[0])) - 1 for row in rows] == list(plan.best_first)
    assert "Half of that is avoided by the first" in words(shown(plan))


def test_a_page_is_bounded_and_what_needs_something_stays_behind_it() -> None:
    plan = planned(collection(1_500, 9, galleries=8, removed=0.1))
    page = shown(plan)
    tables = page.xpath("//table[contains(@class, 'errands')]")
    assert len(tables[0].xpath("tbody/tr")) == SHOWN
    assert len(tables[1].xpath("tbody/tr")) < SHOWN
    assert f"{len(plan.chosen) - SHOWN:,} more of the plan" in words(page)
    assert "taken from view" in words(page.xpath("//section[@aria-labelledby='away']")[0])
    assert len(plan_page(plan, HEAD, Language())) < 500_000


def test_alone_it_has_no_links_and_in_another_language_no_english_advice() -> None:
    plan = planned(collection(10, 2))
    assert shown(plan, alone=True).xpath("//main//a") == []
    assert shown(plan, alone=True).xpath("//nav") == []
    assert shown(plan).xpath("//main//a[starts-with(@href, 'east.html#')]")
    view = plan_view(plan, sentences=False)
    assert not [text for one in view.errands for text in one.told if text == "Do it."]


def test_what_a_number_hangs_on_stands_beside_it() -> None:
    """The most that an object may weigh is four times the best: who buys a clamp by that alone buys four."""
    most = HEAVIEST.format(heaviest="112 kg", weight="30.6 kg")
    paint = "It has paint: have a conservator say first where it may be touched."
    said = {
        most: f"Fasten it: hold 240 kg sideways. {most.partition(';')[0]}. Weigh it first.",
        f"{paint} {most}": f"Fasten it: hold 240 kg sideways. {most.partition(';')[0]}. Weigh it first.",
        SIZED: "Fasten it: hold 240 kg sideways. Weigh it first.",
        f"{SIZED} {NAMED_FIRST}": "Fasten it: hold 240 kg sideways. Say first what it is.",
        paint: "Fasten it: hold 240 kg sideways.",
    }
    for rest, told in said.items():
        plan = planned([advised("1", "fasten", 1.0, sentence=f"Fasten it: hold 240 kg sideways. {rest}")])
        assert [text for one in plan_view(plan).errands for text in one.told] == [told]


@pytest.mark.long("report/test_language::test_no_english_is_left")
def test_all_words_of_the_page_can_be_translated() -> None:
    """A catalogue that answers in letters of another script leaves no Latin ones but in what the museum wrote."""
    file = BytesIO()
    write_mo(file, catalogue())
    file.seek(0)
    tongue = Language("it", GNUTranslations(file))
    found = [
        replace(one, measure_title=TITLES[one.measure])
        for one in collection(400 if SOAK else 150, 9, galleries=8, removed=0.1)
    ]
    for limits in (EffortLimits(), EffortLimits(90.0, 4_000.0, {"handler": 20.0, "engineer": 50.0})):
        page = html.fromstring(plan_page(planned(found, limits), HEAD, tongue))
        for element in page.xpath("//head|//style|//bdi|//*[@class='code']"):
            element.drop_tree()
        said = re.sub(r"plan\.csv|\.csv|1 gen 2031", "", words(page))  # The month is Italian, and not of the catalogue.
        assert not re.findall(r"[A-Za-z]{2,}", said)


def test_nothing_to_plan_is_said() -> None:
    assert "Nothing is advised" in words(shown(planned([])))
    assert "nothing can be done" in words(shown(planned([advised("1", "wax", 1.0)], EffortLimits(0.0))))


def test_the_same_plan_is_the_same_bytes() -> None:
    once, twice = (plan_page(planned(collection(80, 6), EffortLimits(30.0)), HEAD, Language()) for _ in range(2))
    assert once == twice


@pytest.mark.parametrize(
    ("value", "said"),
    [(0.0, "0"), (0.15, "0.15"), (9.5, "9.5"), (39.96, "40"), (2130.4, "2,100"), (139_352.0, "140,000"), (99.6, "100")],
)
def test_amounts_are_written_with_the_digits_that_they_have(value: float, said: str) -> None:
    assert number(value) == said
