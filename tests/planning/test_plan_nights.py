"""The plan of a real night: on its page, by the command, and unchanged on an unchanged night."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import openpyxl
import pytest
from lxml import html

from pipeline.operations.workspace import UsageError, open_workspace
from pipeline.planning.choice import EffortLimits
from pipeline.records import DecisionKind
from pipeline.report.files.plan_files import gathered_from
from pipeline.settings import Settings, load_settings
from pipeline.store.codec import StoreError
from pipeline.tables import TableError
from pipeline.tools.decisions import Wish, decide
from pipeline.tools.planning import plan_museum
from pipeline.tools.rerender import render_again
from tests.museum import edit, kouros, museum_of, night, on_the_floor, vases


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """A museum after its first night: vases that stand on the floor, one beside the other."""
    folder = tmp_path_factory.mktemp("plans") / "museum"
    museum_of(folder, vases(), sampled=True)
    return on_the_floor(folder)


@pytest.fixture(scope="module")
def report(settings: Settings) -> Path:
    summary = night(settings)
    assert summary.report is not None
    return summary.report.parent


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_night_writes_the_plan_and_the_index_leads_to_it(report: Path) -> None:
    listed = rows(report / "plan.csv")
    advice = rows(report / "recommendations.csv")
    assert listed
    assert {one["objects"] for one in listed} == {one["object_number"] for one in advice}
    losses = {one["object_number"]: float(one["expected_loss"] or 0.0) for one in rows(report / "objects.csv")}
    for one in listed:
        assert float(one["loss"]) == pytest.approx(losses[one["objects"]])
        assert 0.0 <= float(one["avoided"]) <= float(one["loss"]) + 1e-9
    index = html.parse(str(report / "index.html"))
    assert index.xpath("//nav/a[@href='plan.html']")
    assert index.xpath("//main//a[@href='plan.html']")
    page = html.parse(str(report / "plan.html"))
    ids = {name: set(html.parse(str(report / name)).xpath("//@id")) for name in {p.name for p in report.glob("*.html")}}
    for link in page.xpath("//main//a/@href"):
        file, _, anchor = link.partition("#")
        assert (report / file).is_file(), link
        assert not anchor or anchor in ids[file], link


def test_an_unchanged_night_takes_the_plan_over_and_other_limits_make_another(settings: Settings, report: Path) -> None:
    again = night(settings).report
    assert again is not None
    for name in ("plan.html", "plan.csv"):
        assert (report / name).samefile(again.parent / name)
    edit(settings.home / "kouros.toml", "[plan]", "[plan]\n# what there is this year")
    file = settings.home / "kouros.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("\nhours = 0.0", "\nhours = 2.0"), encoding="utf-8")
    summary = night(load_settings(file))
    file.write_text(text, encoding="utf-8")
    assert summary.report is not None
    assert summary.fresh == 0
    assert "With 2 hours you avoid" in (summary.report.parent / "plan.html").read_text(encoding="utf-8")
    done = [one for one in rows(summary.report.parent / "plan.csv") if one["do"] == "yes"]
    assert sum(float(one["hours"]) for one in done) <= 2.0
    # The pages of galleries do not hang on it.
    page = next(report.glob("room-*.html")).name
    assert (report / page).samefile(summary.report.parent / page)


def test_the_command_says_what_the_report_says(settings: Settings, report: Path, tmp_path: Path) -> None:
    out = tmp_path / "sheets" / "plan.csv"
    planned = plan_museum(open_workspace(settings), EffortLimits(), path=out)
    assert rows(out) == rows(report / "plan.csv")
    assert planned.plan.loss == pytest.approx(gathered_from(report).plan(planned.plan.terms).loss, rel=1e-12)
    one = plan_museum(open_workspace(settings), EffortLimits(), galleries=("Room 1",))
    assert {errand.gallery for errand in one.plan.errands} == {"Room 1"}
    assert one.plan.loss < planned.plan.loss


def test_the_command_prints_and_writes(settings: Settings, report: Path, tmp_path: Path) -> None:
    folder = settings.home
    done = kouros("plan", "--hours", "3", "--hours", "engineer=0", "--cost", "50", "--json", folder=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["hours"]["value"] <= 3.0
    assert told["cost"]["value"] <= 50.0
    assert told["limits"] == {"hours": 3.0, "cost": 50.0, "trades": {"engineer": 0.0}, "removals": False}
    assert 0.0 < told["share"] < 1.0
    assert told["avoided"] == pytest.approx(sum(one["avoided"] for one in told["errands"]))
    sheet, page = tmp_path / "plan.xlsx", tmp_path / "plan.html"
    for file in (sheet, page):
        done = kouros("plan", "--hours", "3", "--out", str(file), folder=folder)
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[2].startswith("With 3 hours you avoid ")
        # A space that does not break is no sign that steers a terminal.
        assert "\ufffd" not in done.stdout
        assert " % of what an earthquake" in done.stdout
        assert done.stdout.splitlines()[-1] == f"wrote {file}"
    assert openpyxl.load_workbook(sheet).sheetnames[0] == "Plan"
    assert "With 3 hours" in page.read_text(encoding="utf-8")
    dry = kouros("plan", "--out", str(tmp_path / "no.xlsx"), "--dry-run", folder=folder)
    assert dry.returncode == 0, dry.stderr
    assert not (tmp_path / "no.xlsx").exists()


def test_what_cannot_be_asked(settings: Settings, report: Path, tmp_path: Path) -> None:
    workspace = open_workspace(settings)
    with pytest.raises(UsageError, match=r"there is no gallery 'Room 9'.*did you mean 'Room"):
        plan_museum(workspace, EffortLimits(), galleries=("Room 9",))
    with pytest.raises(UsageError, match=r"give the file one of these endings"):
        plan_museum(workspace, EffortLimits(), path=tmp_path / "plan.pdf")
    for words, said in ((("--hours", "many"), "give a number, such as 40"), (("--hours", "cook=3"), "no such trade")):
        done = kouros("plan", *words, folder=settings.home)
        assert done.returncode == 2
        assert said in done.stderr


def test_before_the_first_night_the_remedy_is_told(tmp_path: Path) -> None:
    fresh = museum_of(tmp_path / "museum", vases(), sampled=True)
    with pytest.raises(StoreError, match=r"no finished run of the whole collection.*kouros run"):
        plan_museum(open_workspace(fresh), EffortLimits())
    (fresh.home / "kouros.toml").write_text(
        (fresh.home / "kouros.toml").read_text(encoding="utf-8").replace('efforts = ""', 'efforts = "ours.csv"'),
        encoding="utf-8",
    )
    named = load_settings(fresh.home / "kouros.toml")
    with pytest.raises(UsageError, match=r"ours.csv is not there; \[plan\] efforts names"):
        night(named)
    (fresh.home / "ours.csv").write_text("measure,trade\nwax,handler\n", encoding="utf-8")
    with pytest.raises(TableError, match=r"ours.csv, line 2, measure 'wax': column 'hours': there is no such column"):
        night(named)


def test_a_night_that_asks_for_no_probabilities_has_no_plan(tmp_path: Path) -> None:
    made = museum_of(tmp_path / "museum", vases(1, 2), sampled=True)
    edit(made.home / "kouros.toml", "samples = 64", "samples = 0")
    summary = night(load_settings(made.home / "kouros.toml"))
    assert summary.report is not None
    assert not (summary.report.parent / "plan.html").exists()
    assert "plan.html" not in summary.report.read_text(encoding="utf-8")
    with pytest.raises(UsageError, match=r"does not know how likely harm is.*samples"):
        plan_museum(open_workspace(load_settings(made.home / "kouros.toml")), EffortLimits())


def test_what_people_accepted_is_no_errand_and_a_report_drawn_again_has_the_same_plan(tmp_path: Path) -> None:
    museum_of(tmp_path / "museum", vases(2, 3), sampled=True)
    settings = on_the_floor(tmp_path / "museum")
    first = night(settings).report
    assert first is not None
    before = rows(first.parent / "plan.csv")
    number = before[0]["objects"]
    decide(open_workspace(settings), Wish(number, DecisionKind.ACCEPT, [], "it is a copy", "Ann"))
    second = night(settings).report
    assert second is not None
    after = rows(second.parent / "plan.csv")
    assert {one["objects"] for one in before} - {one["objects"] for one in after} == {number}
    drawn = render_again(settings, None)
    assert drawn.parent != second.parent
    for name in ("plan.csv", "plan.html"):
        assert drawn.with_name(name).read_bytes() == second.with_name(name).read_bytes()
