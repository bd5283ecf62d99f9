"""One answer for many objects: asked before their measurements, typed into a workbook, read back as house rules."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from datetime import date
from pathlib import Path

import openpyxl
import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.house.questions import RuleQuestion, rule_questions
from pipeline.analysis.house.rule import HouseRule, Span
from pipeline.collection.inventory import replace_inventory
from pipeline.collection.reading import Reading
from pipeline.operations.workspace import open_workspace
from pipeline.records import Hanging, Item, MeasurementRequest, Support
from pipeline.report.files.rules_sheet import RULES_SHEET
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.report.files.survey_sheet import write_survey
from pipeline.settings import SettingsError, load_settings
from pipeline.tools.doctor import diagnose
from pipeline.tools.house_answers import add_rules, rules_of, to_paste
from pipeline.tools.sheet_answers import take_sheet

WHEN = date(2031, 5, 1)
PAINTINGS = [
    Item(str(n), "West", "Painting", medium="oil on canvas", height_m=0.5 + 0.1 * n, width_m=0.8) for n in range(7)
]
VASES = [Item(f"v{n}", "East", "Vase", height_m=0.4, width_m=0.2, depth_m=0.2) for n in range(6)]


def wish(item: Item, field: str, low: float, best: float, high: float, settles: float = 1.0) -> MeasurementRequest:
    return MeasurementRequest(
        item.object_number, item.gallery, item.title, field, "-", low, best, high, "assumed", 1, settles, 0
    )


def questions() -> list[RuleQuestion]:
    """Of seven paintings the length is asked, as it is assumed: a quarter to the half of the height and 1 m more."""
    wishes = [wish(p, "suspension_length_m", *_length(p)) for p in PAINTINGS]
    wishes += [wish(v, "friction", 0.2 + 0.01 * n, 0.4, 0.6 + 0.01 * n, 0.5) for n, v in enumerate(VASES)]
    # Too few ask for these, and these would settle nothing.
    wishes += [wish(v, "clearance_m", 0.05, 0.1, 0.3) for v in VASES[:4]]
    wishes += [wish(v, "cg_height_m", 0.1, 0.2, 0.3, 0.0) for v in VASES]
    return rule_questions([classify(item) for item in (*PAINTINGS, *VASES)], wishes)


def _length(painting: Item) -> tuple[float, float, float]:
    height = painting.height_m or 0.0
    return 0.25 * height, 0.5 * height, 0.5 * height + 1.0


def test_equal_questions_are_one_and_the_most_useful_comes_first() -> None:
    lengths, frictions, *unsaid = questions()
    assert lengths.criteria == {"class": "framed"}
    assert (lengths.field, lengths.objects, lengths.settles) == ("suspension_ratio", 7, 7.0)
    # The smallest painting, of 0.5 m, has the highest share: half of it and 1 m more.
    assert (lengths.low, lengths.best, lengths.high) == pytest.approx((0.25, 0.5, 2.5))
    assert (frictions.field, frictions.objects) == ("friction", 6)
    assert (frictions.low, frictions.high) == pytest.approx((0.2, 0.65))
    assert [(q.field, q.object_class, q.objects) for q in unsaid] == [
        ("hanging", "framed", 7),
        ("furniture", "vessel", 6),
        ("furniture_anchorage", "vessel", 6),
    ]


def test_how_works_hang_is_asked_once_and_first_where_it_settles_most() -> None:
    """A wish for it of each work takes the place of the question that is asked of all unrecorded works anyway."""
    wishes = [replace(wish(p, "hanging", 0.0, 0.0, 1.0), low=None, best=None, high=None) for p in PAINTINGS]
    wishes += [wish(p, "clearance_m", 0.15, 0.3, 0.6, 0.3) for p in PAINTINGS]
    asked = rule_questions([classify(item) for item in PAINTINGS], wishes)
    assert [(q.field, q.settles) for q in asked] == [("hanging", 7.0), ("clearance_m", pytest.approx(2.1))]


def test_a_class_that_is_held_in_two_ways_is_asked_about_by_both() -> None:
    held = [replace(v, support=Support.FASTENED) if n == 0 else v for n, v in enumerate(VASES)]
    (only,) = rule_questions([classify(item) for item in held], [wish(v, "friction", 0.2, 0.3, 0.4) for v in held[1:]])[
        :1
    ]
    assert only.criteria == {"class": "vessel", "support": "freestanding"}


def test_what_is_printed_is_refused_until_somebody_signs_it() -> None:
    text = to_paste(questions(), WHEN)
    framed, vessel = tomllib.loads(text)["house"]
    assert framed["suspension_ratio"] == {"low": 0.25, "best": 0.5, "high": 2.5}
    assert framed["hanging"] == "wire | two_hooks | cleat | security | fixed"
    assert set(vessel) == {"class", "friction", "furniture", "furniture_anchorage", "said_by", "said_on"}
    answers = {"furniture": "shelf", "furniture_anchorage": "unanchored"}
    with pytest.raises(ValueError, match="said_by"):
        HouseRule(**vessel | answers)
    assert HouseRule(**vessel | answers | {"said_by": "Ann"}).said_on == WHEN


def workbook(path: Path, *filled: dict[str, object], length: str = "cm") -> Path:
    """A survey's workbook with rows of its sheet Rules filled in: those of the same class and field, or new ones."""
    write_survey(path, [], (), length=length, rules=questions())
    book = openpyxl.load_workbook(path)
    sheet = book[RULES_SHEET]
    columns = [cell.value for cell in sheet[HEADER_ROW]]
    for row in filled:
        about = [row.get(name) for name in ("class", "states")]
        at = next(
            n
            for n in range(HEADER_ROW + 1, sheet.max_row + 1)
            if [sheet.cell(n, columns.index(name) + 1).value for name in ("class", "states")] in (about, [None, None])
        )
        for name, value in row.items():
            sheet.cell(at, columns.index(name) + 1).value = value
    book.save(path)
    return path


SIGNED = {"said_by": "Ann", "said_on": WHEN}
HOOKS = {"class": "framed", "states": "hanging", "value": "two_hooks"} | SIGNED
LENGTH = {"class": "framed", "states": "suspension_ratio", "value": 0.3, "low": 0.2, "high": 0.5} | SIGNED
ROOM = {
    "gallery": "East|West",
    "states": "clearance_m",
    "value": 30,
    "unit": "cm",
    "said_by": "Bob",
    "said_on": "2031-05-02",
}


def test_a_workbook_comes_back_as_the_rules_that_were_typed_in(tmp_path: Path) -> None:
    first, second = rules_of(workbook(tmp_path / "survey.xlsx", HOOKS, LENGTH, ROOM)).rules
    assert (first.object_class, first.hanging, first.said_by) == (("framed",), Hanging.TWO_HOOKS, "Ann")
    assert first.suspension_ratio == Span(low=0.2, best=0.3, high=0.5)
    assert (second.gallery, second.said_on) == (("East", "West"), date(2031, 5, 2))
    assert second.clearance_m == Span(low=0.3, best=0.3, high=0.3)


def test_a_workbook_that_nobody_filled_in_has_no_rules(tmp_path: Path) -> None:
    assert rules_of(workbook(tmp_path / "survey.xlsx")).rules == ()
    openpyxl.Workbook().save(tmp_path / "other.xlsx")
    assert rules_of(tmp_path / "other.xlsx").rules == ()
    assert rules_of(tmp_path / "other.csv").rules == ()


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (HOOKS | {"said_by": ""}, r"row 5, said_by: is empty; a rule says who says so, and when"),
        (HOOKS | {"said_on": "May"}, r"row 5, said_on: .May. is no day that can be read; write the day as 2031-05-01"),
        (HOOKS | {"value": "string"}, r"row 5, value: .*'wire', 'two_hooks'"),
        (HOOKS | {"value": '=HYPERLINK("x")'}, r"row 5, value: .*formula"),
        (LENGTH | {"high": None}, r"row 3: give low and high, or neither"),
        (LENGTH | {"value": "long"}, r"row 3, value: 'long' is no number; write one number, as 0\.3"),
        (LENGTH | {"high": 70}, r"row 3, .*suspension_ratio must lie within 0 and 50"),
        (LENGTH | {"low": 0.4}, r"row 3, .*low <= best <= high"),
        (ROOM | {"unit": "ell"}, r"row 8, unit: 'ell' is no unit of lengths"),
        (ROOM | {"states": "height"}, r"row 8, states: 'height' is nothing that a rule states"),
        (ROOM | {"gallery": None}, r"row 8, .*name what it is for"),
    ],
)
def test_a_row_that_cannot_be_meant_is_named(row: dict[str, object], said: str, tmp_path: Path) -> None:
    fault = rules_of(workbook(tmp_path / "survey.xlsx", row)).faults[0]
    where = f", {fault.column}" if fault.column else ""
    assert re.match(said, f"row {fault.row}{where}: {fault.message}; {fault.remedy}")


@pytest.fixture
def config(tmp_path: Path) -> Path:
    file = tmp_path / "kouros.toml"
    file.write_text('# ours\n[museum]\nname = "Ours"\n', encoding="utf-8")
    return file


def test_rules_are_added_once_below_what_stands_there(config: Path, tmp_path: Path) -> None:
    config.chmod(0o600)
    rules = rules_of(workbook(tmp_path / "survey.xlsx", HOOKS, LENGTH, ROOM)).rules
    before = config.read_text(encoding="utf-8")
    added = add_rules(config, rules, dry_run=True)
    assert config.read_text(encoding="utf-8") == before
    assert add_rules(config, rules) == added
    assert config.read_text(encoding="utf-8") == f"{before}\n{added}"
    assert config.stat().st_mode & 0o777 == 0o600
    assert load_settings(config).house == rules
    assert add_rules(config, rules) == ""
    assert load_settings(config).house == rules


def test_a_sheet_that_says_something_else_than_a_rule_there_changes_nothing(config: Path, tmp_path: Path) -> None:
    add_rules(config, (HouseRule(**{"class": "framed"}, hanging="wire", said_by="Eve", said_on=WHEN),))
    before = config.read_bytes()
    rules = rules_of(workbook(tmp_path / "survey.xlsx", HOOKS)).rules
    with pytest.raises(
        SettingsError, match=r"1 \(class framed\) and .* 2 \(class framed\) .* wire and hanging two_hooks"
    ):
        add_rules(config, rules)
    assert config.read_bytes() == before


def test_a_workbook_with_rules_alone_needs_no_measurement(config: Path, tmp_path: Path) -> None:
    workspace = open_workspace(load_settings(config))
    replace_inventory(workspace.engine, Reading(tuple(PAINTINGS), 7, (), "a.csv", "0" * 64, "m", "M"))
    taken = take_sheet(workspace, config, workbook(tmp_path / "survey.xlsx", HOOKS))
    assert taken.changes is None
    assert taken.rules.startswith('[[house]]\nclass = "framed"\nhanging = "two_hooks"\nsaid_by = "Ann"')


# ----------------------------------------------------------------------------------------------------------------------
# What kouros check says


def looked(config: Path, *rules: str) -> tuple[str, str]:
    said = "\n".join(f'[[house]]\n{rule}\nsaid_by = "Ann"\nsaid_on = 2031-05-01' for rule in rules)
    config.write_text(said, encoding="utf-8")
    workspace = open_workspace(load_settings(config))
    items = (*PAINTINGS, *(replace(v, friction=0.3) if n < 2 else v for n, v in enumerate(VASES)))
    replace_inventory(workspace.engine, Reading(items, 13, (), "a.csv", "0" * 64, "m", "M"))
    (found,) = [one for one in diagnose(config) if one.what == "house rules"]
    return found.state, found.message


def test_check_says_which_rules_match_nothing_are_never_taken_or_contradict_a_record(config: Path) -> None:
    state, message = looked(
        config,
        'class = "framed"\nhanging = "wire"',
        'gallery = "Est"\nfriction = 0.4',
        'class = "framed"\nfriction = 0.4',
        'class = "vessel"\nfriction = 0.5',
    )
    assert state == "warning"
    assert "[[house]] 1 (class framed) matches 7 objects" in message
    assert "[[house]] 2 (gallery Est) matches nothing: there is no gallery 'Est'; did you mean 'East'" in message
    assert "nothing of [[house]] 3 (class framed) is taken" in message
    assert (
        "[[house]] 4 (class vessel) contradicts the record of 2 objects: v0: friction: its record says 0.3" in message
    )
    assert looked(config, 'class = "framed"\nhanging = "wire"')[0] == "ok"


def test_check_finds_rules_that_tie_wrong_and_names_both(config: Path) -> None:
    state, message = looked(config, 'class = "framed"\nclearance_m = 0.1', 'gallery = "West"\nclearance_m = 0.2')
    assert state == "wrong"
    assert "for class framed (Ann, 2031-05-01) and for gallery West (Ann, 2031-05-01) are equally particular" in message
    assert "(7 objects: 0, 1, 2 and 4 more)" in message


def test_an_error_of_a_rule_names_it_as_people_count(config: Path) -> None:
    rule = '[[house]]\ngallery = "East"\nfriction = {}\nsaid_by = "Ann"\nsaid_on = 2031-05-01\n'
    config.write_text(rule.format(0.3) + rule.format(3), encoding="utf-8")
    with pytest.raises(
        SettingsError, match=r"kouros\.toml: \[\[house\]\] 2: .*friction must lie within 0\.01 and 1\.5"
    ):
        load_settings(config)
