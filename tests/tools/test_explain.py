"""`kouros run --explain`: what it prints is what a night finds, step by step, and nothing is stored."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from pipeline.cli.commands import run as command
from pipeline.cli.console import Console
from pipeline.cli.explaining import explanation_lines
from pipeline.cli.shared import Options
from pipeline.collection.database import open_database
from pipeline.mitigate.saying import ANCHORED
from pipeline.night.run import run
from pipeline.operations.workspace import open_workspace
from pipeline.quantities import figures
from pipeline.records import DecisionKind
from pipeline.settings import Settings, load_settings
from pipeline.store.runs import list_runs, load_run
from pipeline.tools.decisions import Wish, decide
from pipeline.tools.explain import explain
from tests.museum import workspace

pytestmark = pytest.mark.slow_file

ROWS = [
    "1,A,Vase \x1b[31mred,1.2,0.2,0.2",
    "2,B,Plate,0.03,0.3,0.3",
    "3,B,Vase,,0.2,0.2",
]


@pytest.fixture(scope="module")
def museum(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    settings = workspace(tmp_path_factory.mktemp("museum"), ROWS)
    run(settings, Console(quiet=True))
    return settings


def explained(museum: Settings, *words: str, verbose: bool = False) -> Result:
    options = Options(config=str(Path(museum.home) / "kouros.toml"), quiet=True, verbose=verbose, debug=False)
    return CliRunner().invoke(command, ["--explain", *words], obj=options)


def test_the_chain_of_reasoning_is_that_of_the_night(museum: Settings) -> None:
    engine = open_database(museum.database)
    before = [r.run_id for r in list_runs(engine)]
    result = explained(museum, "1", "--json")
    assert result.exit_code == 0
    (one,) = json.loads(result.stdout)
    assert [r.run_id for r in list_runs(engine)] == before
    (night,) = [a for a in load_run(engine).assessments if a.scene.item.object_number == "1"]
    assert [(r["finding"]["model"], r["finding"]["verdict"]) for r in one["reasonings"]] == [
        (f.model, f.verdict.value) for f in night.findings
    ]
    assert [r["finding"]["demand"] for r in one["reasonings"]] == [f.demand for f in night.findings]
    assert [a["measure"] for a in one["advice"]] == [r.measure for r in night.recommendations]
    assert set(one["scene"]["skipped"]) == set(night.scene.skipped)
    # Each step narrows what the one before it left.
    for reasoning in one["reasonings"]:
        bounds = {(t["motion"], t["inputs"]): t for t in reasoning["taken"] if t["step"] == "bound"}
        for taken in reasoning["taken"]:
            bound = bounds[taken["motion"], taken["inputs"]]
            middle = 0.5 * (taken["low"] + taken["high"]) if taken["high"] is not None else taken["low"]
            assert bound["low"] <= middle
            assert bound["high"] is None or middle <= bound["high"]


def test_the_words_name_every_step_and_no_control_character_passes(museum: Settings) -> None:
    text = explained(museum, "1").stdout
    for part in (
        "class    vessel",
        "friction_static",
        "not run",
        "bound ",
        "capacity",
        "verdict",
        "advice",
        "rejected",
    ):
        assert part in text, part
    assert "\x1b" not in text
    assert "height" in explained(museum, "3").stdout


def test_what_came_of_it_stands_first_and_each_step_only_when_asked_for(museum: Settings) -> None:
    """Steps of one kind under one motion are one line; with -v they are those of the JSON."""
    short, whole = (explained(museum, "1", verbose=verbose).stdout.splitlines() for verbose in (False, True))
    assert short[1].split()[0] == "verdict"
    assert "  advice   " in "\n".join(short[: short.index(next(line for line in short if line.startswith("  class")))])
    (one,) = json.loads(explained(museum, "1", "--json").stdout)
    taken = [step for reasoning in one["reasonings"] for step in reasoning["taken"]]
    kinds = {step["step"] for step in taken}
    steps, told = ([line for line in lines if line[4:14].strip() in kinds] for lines in (whole, short))
    assert len(steps) == len(taken)
    assert len(told) == sum(len({(s["motion"], s["step"]) for s in r["taken"]}) for r in one["reasonings"])
    # What is left out lies between the two numbers that are told.
    first = [s for s in one["reasonings"][0]["taken"] if s["step"] == "bound" and s["motion"] == taken[0]["motion"]]
    ends = min(s["low"] for s in first), max(s["high"] for s in first)
    assert told[0].endswith(f"with {len(first) - 1} other sets: {figures(ends[0], 4)} to {figures(ends[1], 4)}")


def test_an_unknown_object_is_refused_with_close_ones(museum: Settings) -> None:
    from pipeline.operations.workspace import UsageError

    problem = explained(museum, "11").exception
    assert isinstance(problem, UsageError)
    assert problem.exit_code == 2
    assert "did you mean '1'" in str(problem)


def test_what_stands_on_an_installed_isolator_is_explained_as_the_night_judged_it(tmp_path: Path) -> None:
    """The isolator's own demand, and the object's own models on what it passes on; a reason steers no terminal."""
    settings = workspace(tmp_path, ROWS)
    run(settings, Console(quiet=True))
    words = ["isolator=generic 0.5 Hz, friction 0.05", "stroke_m=0.9"]
    wish = Wish("1", DecisionKind.INSTALLED, ["horizontal_isolator", *words], why="bought \x1b[31m in May", who="Ann")
    decide(open_workspace(settings), wish)
    run(settings, Console(quiet=True))
    (night,) = [a for a in load_run(open_database(settings.database)).assessments if a.scene.item.object_number == "1"]
    assert {f.model for f in night.findings} == {"horizontal_isolator", "standing", "sliding", "flexible_stress"}
    result = explained(settings, "1", "--json")
    (one,) = json.loads(result.stdout)
    assert [(r["finding"]["model"], r["finding"]["demand"]) for r in one["reasonings"]] == [
        (f.model, f.demand) for f in night.findings
    ]
    assert one["scene"]["skipped"] == dict(night.scene.skipped)
    assert [a["measure"] for a in one["advice"]] == [r.measure for r in night.recommendations]
    spoken = explained(settings, "1")
    assert spoken.exit_code == 0
    assert "\x1b" not in spoken.stdout
    assert "isolator passes on" in spoken.stdout


@pytest.mark.long("test_what_stands_on_an_installed_isolator_is_explained_as_the_night_judged_it")
def test_furniture_that_is_not_fastened_is_explained_as_the_night_judged_it(tmp_path: Path) -> None:
    """Whether its furniture falls is reasoned too, and that it is fastened first; a scan states no error."""
    settings = workspace(tmp_path, ROWS[:1], furnished=True)
    file = tmp_path / "kouros.toml"
    rule = 'furniture = "showcase"\nfurniture_anchorage = "unanchored"\nsaid_by = "a test"\nsaid_on = 2026-01-01\n'
    rule = f'\n[[house]]\nsupport = "freestanding"\n{rule}'
    file.write_text(file.read_text(encoding="utf-8") + rule, encoding="utf-8")
    settings = load_settings(file)
    run(settings, Console(quiet=True))
    (night,) = [a for a in load_run(open_database(settings.database)).assessments if a.scene.item.object_number == "1"]
    assert [f.model for f in night.findings].count("unanchored") == 1
    (one,) = json.loads(explained(settings, "1", "--json").stdout)
    assert [(r["finding"]["model"], r["finding"]["verdict"], r["finding"]["sentence"]) for r in one["reasonings"]] == [
        (f.model, f.verdict.value, f.sentence) for f in night.findings
    ]
    assert one["scene"]["skipped"] == dict(night.scene.skipped)
    assert [(a["measure"], a["sentence"]) for a in one["advice"]] == [
        (r.measure, r.sentence) for r in night.recommendations
    ]
    taken = [t for r in one["reasonings"] for t in r["taken"]]
    assert {t["error"] for t in taken if t["step"] == "scan"} == {None}
    spoken = explained(settings, "1").stdout
    assert "scan " in spoken
    assert "nan" not in spoken
    (reasoned,) = explain(open_workspace(settings), "1", Console(quiet=True))
    (advice,) = reasoned.advice
    # It is as heavy as its furniture must be fastened for.
    assert advice.sentence.startswith(f"{ANCHORED} ")
    less = replace(reasoned, advice=(replace(advice, sentence=advice.sentence.removeprefix(f"{ANCHORED} ")),))
    assert set(explanation_lines(reasoned)) - set(explanation_lines(less)) == {f"    {ANCHORED}"}


def test_what_an_object_counts_and_why_is_told(museum: Settings, tmp_path: Path) -> None:
    """80,000 at 20,000 for an object of class C is 4, and thrice that, as it is irreplaceable: stakes.csv."""
    assert "  worth    counts 2: nothing is recorded of its value" in explained(museum, "1").stdout.splitlines()
    settings = workspace(tmp_path, ["1,A,Vase,1.2,0.2,0.2"])
    file = tmp_path / "kouros.toml"
    file.write_text(file.read_text(encoding="utf-8").replace("value_per_c = 0.0", "value_per_c = 20000.0"), "utf-8")
    for name, more in (("export.csv", ",value,irreplaceable,on_loan"), ("mapping.toml", "")):
        said = (tmp_path / name).read_text(encoding="utf-8").splitlines()
        if more:
            said = [said[0] + more, *(f"{line},80000,yes,no" for line in said[1:])]
        else:
            said += [f'[columns.{field}]\ncolumn = "{field}"' for field in ("value", "irreplaceable", "on_loan")]
        (tmp_path / name).write_text("\n".join(said) + "\n", encoding="utf-8")
    settings = load_settings(file)
    summary = run(settings, Console(quiet=True))
    assert "  worth    counts 12: valued at 80,000, irreplaceable" in explained(settings, "1").stdout.splitlines()
    assert summary.report is not None
    page = next(summary.report.parent.glob("a-*.html")).read_text(encoding="utf-8")
    assert "counts 12: valued at 80,000, irreplaceable" in page
