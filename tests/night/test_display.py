"""Only what is on display is assessed, advised and headlined; stores, where they are asked for, are counted apart."""

import csv
import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from lxml import html

from pipeline.cli.console import summary_lines
from pipeline.collection.database import open_database
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.night import scheduler
from pipeline.night.run import Selection, run
from pipeline.night.units import paged
from pipeline.operations.run_summary import Summary
from pipeline.operations.workspace import open_workspace
from pipeline.records import Assessment, DecisionKind
from pipeline.settings import Settings, load_settings
from pipeline.store.runs import load_run
from pipeline.tools.decisions import Wish, decide
from tests.mitigate.scenes import TOWER, demo_motion, solve
from tests.museum import MAPPING, SILENT, workspace

pytestmark = pytest.mark.slow_file

SHOWN = "1,Hall,Vase,1.2,0.2,0.2,yes"
ROWS = [SHOWN, "2,Cellar,Vase,1.3,0.2,0.2,no", "3,Cellar,Bowl,,,,no", "4,,Vase,1.4,0.2,0.2,"]
"""A vase that overturns; one of those in the cellar, a bowl without a size there, and one without a place."""


def museum(folder: Path, rows: list[str] = ROWS, *, stores: bool = False) -> Settings:
    folder.mkdir(exist_ok=True)
    workspace(folder, [])
    head = "object_number,gallery,title,height_m,width_m,depth_m,on_display"
    (folder / "export.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    said = MAPPING + '[columns.on_display]\ncolumn = "on_display"\n'
    (folder / "mapping.toml").write_text(said, encoding="utf-8")
    toml = folder / "kouros.toml"
    text = toml.read_text(encoding="utf-8")
    assert "[display]" in text, "`kouros init` says how to ask for stores"
    if stores:
        text = text.replace("stores = false", "stores = true")
    toml.write_text(text.replace("shrink_limit = 0.2", "shrink_limit = 0.9"), encoding="utf-8")
    return load_settings(toml)


def table(summary: Summary, name: str) -> list[dict[str, str]]:
    assert summary.report is not None
    with summary.report.with_name(name).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def words(summary: Summary, name: str = "index.html") -> str:
    assert summary.report is not None
    page = html.parse(str(summary.report.with_name(name))).getroot()
    return " ".join(page.find(".//main").text_content().split())


def found(folder: Path) -> dict[str, Assessment]:
    record = load_run(open_database(folder / "kouros.sqlite"))
    return {assessment.scene.item.object_number: assessment for assessment in record.assessments}


def test_what_is_not_on_display_is_counted_and_named_and_nothing_else(tmp_path: Path) -> None:
    summary = run(museum(tmp_path), SILENT)
    assert (summary.objects, summary.on_display, summary.stores) == (4, 1, None)
    assert (summary.act, summary.watch, summary.fine, summary.cannot, summary.fresh) == (1, 0, 0, 0, 1)
    assert sum(summary.measures.values()) == 1
    assert summary.missing == {}
    assert [text.split()[0] for text in summary.first] == ["1"]
    for name in ("findings.csv", "recommendations.csv"):
        assert {row["object_number"] for row in table(summary, name)} == {"1"}
    # Nothing is lost: a row for each object, and a page that names them.
    objects = {row["object_number"]: (row["state"], row["on_display"]) for row in table(summary, "objects.csv")}
    left = ("not on display", "false")
    assert objects == {"1": ("act", "true"), "2": left, "3": left, "4": left}
    for page in ("index.html", "not-on-display.html"):
        assert "3 objects are not on display, and were not assessed." in words(summary, page)
        assert "stores = true in [display] of the settings" in words(summary, page)
    said = "not on display: 3 objects, not assessed (set [display] stores = true)"
    assert said in "\n".join(summary_lines(summary))
    assert "none is left out" not in words(summary)
    assert summary.report is not None
    told = json.loads(summary.report.with_name("summary.json").read_text(encoding="utf-8"))
    assert (told["objects"], told["on_display"], told["not_on_display"], told["stores"]) == (4, 1, 3, None)
    assert "overturns" not in words(summary, "not-on-display.html")
    # Nor is anything kept of them but what they are.
    assert all(a.aside and not a.findings and not a.fragilities for n, a in found(tmp_path).items() if n != "1")


def test_pages_of_what_is_stored_lead_to_each_other_and_old_ones_are_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scheduler, "paged", partial(paged, stored=2))
    stored = [f"{n},Cellar,Vase,0.3,0.2,0.2,no" for n in range(8, 29)]

    def pages(count: int) -> dict[str, html.HtmlElement]:
        summary = run(museum(tmp_path, [SHOWN, *stored[:count]]), SILENT)
        assert summary.report is not None
        return {file.name: html.parse(str(file)).getroot() for file in summary.report.parent.glob("not-on-display*")}

    shown = pages(21)
    names = ["not-on-display.html", *(f"not-on-display-{n}.html" for n in range(2, 12))]
    assert set(shown) == set(names)
    listed = [row.findtext("bdi") for name in names for row in shown[name].xpath("//table//tbody/tr/th")]
    assert listed == [str(n) for n in range(8, 29)]
    middle = shown["not-on-display-5.html"].xpath("//p[contains(@class, 'turn')]")[0]
    assert middle.xpath("*/text()") == ["1", "…", "3", "4", "5", "6", "7", "…", "11"]
    assert [a.get("href") for a in middle.iterfind("a")] == [names[n - 1] for n in (1, 3, 4, 6, 7, 11)]
    assert middle.find("a").get("title") == "8 – 9"
    assert set(pages(3)) == set(names[:2])


def test_stores_are_a_section_of_their_own_and_never_mixed_in(tmp_path: Path) -> None:
    summary = run(museum(tmp_path, stores=True), SILENT)
    assert (summary.objects, summary.on_display, summary.act, summary.cannot) == (4, 1, 1, 0)
    assert summary.stores is not None
    stored = summary.stores
    assert (stored.act + stored.watch + stored.fine + stored.cannot, stored.cannot) == (3, 1)
    assert stored.act == 2
    assert [text.split()[0] for text in summary.first] == ["1"]
    assert sum(summary.measures.values()) == 1
    assert {row["object_number"] for row in table(summary, "findings.csv")} == {"1", "2", "4"}
    first = words(summary).partition("Galleries")[0]
    assert "1 object needs action" in first
    assert "Cellar" not in first
    assert "no model of shelves" in words(summary)
    assert "counted apart: 3 objects: 2 to act on" in "\n".join(summary_lines(summary))


@pytest.mark.long("night/test_incremental::test_a_night_that_finds_only_what_changed_equals_one_from_nothing")
def test_with_setting_or_flag_changed_a_night_is_as_one_from_scratch(tmp_path: Path) -> None:
    """Each night of a museum where one thing changed, against the first night of another that was always so."""
    other = [SHOWN.replace("yes", "no"), ROWS[1].replace("no", "yes"), *ROWS[2:]]
    run(museum(tmp_path / "old"), SILENT)
    for at, (rows, stores) in enumerate([(ROWS, True), (other, False)]):
        summary = run(museum(tmp_path / "old", rows, stores=stores), SILENT)
        fresh = run(museum(tmp_path / f"new-{at}", rows, stores=stores), SILENT)
        assert found(tmp_path / "old") == found(tmp_path / f"new-{at}")
        assert (summary.act, summary.stores, summary.first) == (fresh.act, fresh.stores, fresh.first)
        for name in ("objects.csv", "findings.csv", "recommendations.csv"):
            bare = [[{k: v for k, v in row.items() if k != "run"} for row in table(s, name)] for s in (summary, fresh)]
            assert bare[0] == bare[1]
    # What was assessed and is not any more: the setting is named, and nothing counts as fixed.
    changes = run(museum(tmp_path / "old", other, stores=True), SILENT).changes
    assert changes is not None
    assert [(change.name, change.after) for change in changes.settings] == [("display.stores", True)]
    assert not changes.fixed
    assert not changes.inputs


def test_a_decision_about_a_stored_object_is_not_about_a_lost_one(tmp_path: Path) -> None:
    settings = museum(tmp_path, [SHOWN])
    run(settings, SILENT)
    decide(open_workspace(settings), Wish("1", DecisionKind.ACCEPT, (), "low shelf", "Ann"))
    settings = museum(tmp_path, [SHOWN.replace("yes", "no"), "5,Hall,Vase,1.2,0.2,0.2,yes"])
    (doubted,) = run(settings, SILENT).doubted
    assert "the object is not on display, and was not assessed" in doubted
    assert "no longer in the inventory" not in doubted


def test_where_nothing_is_on_display_nothing_is_called_safe(tmp_path: Path) -> None:
    summary = run(museum(tmp_path, ROWS[1:]), SILENT)
    assert (summary.objects, summary.on_display, summary.fine, summary.fresh) == (3, 0, 0, 0)
    assert words(summary).startswith("No object on display was assessed")
    alone = run(museum(tmp_path), SILENT, Selection(objects=("2",)))
    assert (alone.objects, alone.on_display, alone.act) == (1, 0, 0)


def test_no_stored_object_is_told_to_be_taken_off_display() -> None:
    """The same tower, with removal as the only measure."""
    last = replace(own_catalogue(), measures=own_catalogue().measures[-1:])
    shown, stored = (solve(replace(TOWER, on_display=there), demo_motion(), last) for there in (True, False))
    assert (shown.measure, shown.title) == ("remove", "Remove from display")
    assert stored.measure == "store_lower"
    assert "display" not in stored.title + stored.sentence
    assert "shelves" in stored.sentence


def test_where_no_column_says_what_is_on_display_that_is_said(tmp_path: Path) -> None:
    rows = ["1,Hall,Vase,1.2,0.2,0.2", "2,Hall,Plate,0.03,0.3,0.3"]
    summary = run(workspace(tmp_path, rows), SILENT)
    said = "o column says what is on display: all 2 objects are taken to be"
    assert said in words(summary)
    assert said in "\n".join(summary_lines(summary))
    assert summary.reading is not None
    assert summary.reading["unsaid"] == 2
    assert run(museum(tmp_path, [SHOWN]), SILENT).reading == summary.reading | {"rows": 1, "unsaid": 0}


@pytest.mark.parametrize("stores", [True, False])
def test_the_setting_is_a_truth_value(tmp_path: Path, stores: bool) -> None:
    assert museum(tmp_path, stores=stores).display.stores is stores
