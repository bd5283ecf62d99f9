"""No single object stops a night, whatever is recorded about it; what Kouros itself fails on is told, and only that."""

import csv
import json
import os
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest

from pipeline.analysis.classify import classify, object_classes
from pipeline.analysis.faults import LIKE, apart
from pipeline.cli.console import Console, summary_lines
from pipeline.collection.database import open_database
from pipeline.collection.record import plausible
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.night import assessment as assessing
from pipeline.night import unit_tasks
from pipeline.night.run import run
from pipeline.operations.event_log import journal
from pipeline.operations.run_summary import Summary
from pipeline.operations.workspace import open_workspace
from pipeline.records import Decision, DecisionKind, Item, Support
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.settings import Settings, load_settings, template
from pipeline.settings.operations import Logs
from pipeline.store.decisions import add_decision
from pipeline.store.runs import load_run
from pipeline.tools.doctor import diagnose
from tests.museum import in_common, kouros, small

pytestmark = pytest.mark.slow_file

LONG = pytest.mark.long("test_every_measure_at_the_ends_of_its_range_is_run_on_every_class")

NAMES = {
    "framed": "Painting", "relief": "Relief", "chandelier": "Chandelier", "wall_painting": "Fresco",
    "installation": "Installation", "small_flat": "Medal", "mounted": "Mask", "stemmed_glass": "Wine glass",
    "standing_figure": "Statue", "bust": "Bust", "statue": "Sculpture", "figurine": "Figurine", "vessel": "Vase",
    "dish": "Plate", "lamp": "Candlestick", "cabinet": "Cabinet", "seat": "Armchair", "table": "Table",
    "model": "Architectural model", "clock": "Clock", "object": "Thing",
}  # fmt: skip
SIZES = {"height_m": 0.5, "width_m": 0.3, "depth_m": 0.25}
STUFF = {"stemmed_glass": {"medium": "glass"}, "standing_figure": {"medium": "marble", "height_m": 1.8}}
SHAPES = ("", "round", "hollow round", "ring", "rectangle", "legs", "hexagon", "=1+1")
NUMBERS = tuple(name for name in plausible() if name != "diameter_m")
SOAK = "KOUROS_OBJECTS" in os.environ
ROUNDS = int(os.environ.get("KOUROS_OBJECTS", "1"))
"""Records of each class and support with numbers drawn at the ends of what is plausible."""


def records() -> list[dict[str, Any]]:
    """Every class with every support: complete, without each size, empty, and with numbers at the ends or left out."""
    chance, out = Random(20261122), []
    for at, (kind, name) in enumerate(NAMES.items()):
        # Every third support where there is little time.
        for support in ("", *Support) if SOAK else ("", *Support)[at % 3 :: 3]:
            whole = {"object_name": name, "support": str(support), **SIZES, **STUFF.get(kind, {})}
            some = [whole, {**whole, "height_m": ""}, {**whole, "width_m": "", "depth_m": ""}]
            some.append({**whole, "base_width_m": 0.2, "base_depth_m": 0.2, "mass_kg": 8.0})
            for _ in range(ROUNDS):
                ends = {f: chance.choice((plausible()[f].low, plausible()[f].high, "")) for f in NUMBERS}
                texts = {"section_shape": chance.choice(SHAPES), "susceptible": chance.choice(("yes", "no", ""))}
                texts |= {"object_name": name, "support": str(support), "medium": whole.get("medium", "")}
                some.append(ends | texts)
            # In turn where there is little time: each class with each of them, not in every support.
            out += some if SOAK else [some[len(out) % len(some)]]
    return [
        {"object_number": f"{at}", "gallery": f"Room {at % 7}", "title": f"No. {at}"} | row
        for at, row in enumerate(out)
    ]


def write(folder: Path, rows: list[dict[str, Any]]) -> None:
    columns = sorted({name for row in rows for name in row})
    with (folder / "collection.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)


def museum(folder: Path, rows: list[dict[str, Any]]) -> Settings:
    """A museum of these records under one short strong motion, with all that a night can be asked for."""
    in_common(folder)
    write(folder, rows)
    words = ("sine", "amplitude=7", "frequency=1.5", "cycles=3", "--out", "site")
    assert kouros("motions", "synthesise", *words, folder=folder).returncode == 0
    text = small(template(museum="Every kind", source="collection.csv", mapping="kouros", site="site"))
    (folder / "kouros.toml").write_text(text, encoding="utf-8")
    return load_settings(folder / "kouros.toml")


def things(given: Any) -> list[Any]:
    """The objects that arguments speak of, but for those that are told to have failed."""
    if isinstance(given, list | tuple):
        return [one for each in given for one in things(each)]
    if getattr(given, "fault", ""):
        return []
    for name in ("scene", "item"):
        if hasattr(given, name):
            return things(getattr(given, name))
    return things(given.assessments) if hasattr(given, "assessments") else [given]


def night(settings: Settings) -> Summary:
    return run(settings, Console(quiet=True))


def test_the_names_are_of_every_class() -> None:
    for kind, name in NAMES.items():
        item = Item("1", "G", object_name=name, **(SIZES | STUFF.get(kind, {})))  # type: ignore[arg-type]
        assert classify(item).object_class == kind
    assert set(NAMES) == set(object_classes())


@LONG
def test_every_class_is_assessed_however_it_is_held_and_whatever_is_missing_extreme_or_contradictory(
    tmp_path: Path,
) -> None:
    """Before: the first mask that was recorded as fastened ended the night with `classes.csv, mounted: ...`, exit 2."""
    rows = records()
    summary = night(museum(tmp_path, rows))
    assert summary.objects == len(rows)
    assert summary.faults == 0
    assert min(summary.act, summary.watch, summary.fine, summary.cannot) > 0
    for assessment in load_run(open_database(tmp_path / "kouros.sqlite")).assessments:
        # Each has an answer, or the reason why there is none.
        assert bool(assessment.findings) is not bool(assessment.scene.missing), assessment.scene


@pytest.mark.parametrize("half", [0, pytest.param(1, marks=LONG)])
def test_every_measure_at_the_ends_of_its_range_is_run_on_every_class(half: int, tmp_path: Path) -> None:
    """What people say is installed, and the class that they say it is, stop no night either."""
    pairs = [
        (kind, measure, end)
        for at, kind in enumerate(NAMES)
        for number, measure in enumerate(own_catalogue().installable)
        if number % 2 == half
        for end in ("low", "high")
        # In turn where there is little time.
        if SOAK or (at + number) % 72 == (0 if end == "low" else 36)
    ]
    rows = [
        {"object_number": f"{at}", "gallery": f"Room {at % 5}", "title": f"No. {at}", "object_name": "Thing", **SIZES}
        for at, _ in enumerate(pairs)
    ]
    settings = museum(tmp_path, rows)
    assert kouros("import", "collection.csv", "--mapping", "kouros", folder=tmp_path).returncode == 0
    engine = open_workspace(settings).engine
    digests = open_workspace(settings).object_index().digests([row["object_number"] for row in rows])
    for at, (kind, measure, end) in enumerate(pairs):
        own = {
            "object_number": f"{at}",
            "who": "A",
            "date": "2026-01-01",
            "why": "b",
            "recorded": "2026-01-01T00:00:00Z",
        }
        takes = own_catalogue().installable[measure].parameters
        given = {q.name: (q.low or 1e-3) if end == "low" else min(q.high, 50.0) for q in takes}
        add_decision(engine, Decision(id=0, kind=DecisionKind.CLASS, object_class=kind, digest=digests[f"{at}"], **own))
        add_decision(
            engine,
            Decision(
                id=0, kind=DecisionKind.INSTALLED, measure=measure, parameters=given,
                units={q.name: q.unit for q in takes}, digest=digests[f"{at}"], **own,
            ),
        )  # fmt: skip
    summary = night(settings)
    assert (summary.objects, summary.faults) == (len(pairs), 0)
    assert summary.decisions == {"class": len(pairs), "installed": len(pairs)}


def test_what_fails_is_found_among_many_and_the_others_are_worked_on_together() -> None:
    asked: list[int] = []

    def work(some: list[int]) -> list[int]:
        asked.append(len(some))
        if any(one in (3, 700) for one in some):
            raise ValueError(f"no {min(some)}")
        return [2 * one for one in some]

    found = apart(work, range(1000), lambda one: one % 2)
    assert {at for at, one in enumerate(found) if isinstance(one, ValueError)} == {3, 700}
    assert all(one == 2 * at for at, one in enumerate(found) if at not in (3, 700))
    assert sum(asked) < 5000  # each in some twelve parts, not in a thousand


def test_of_a_kind_that_all_fail_not_every_one_is_tried_and_another_kind_is_not_given_up() -> None:
    asked: list[int] = []

    def work(some: list[int]) -> list[int]:
        asked.append(len(some))
        if any(one < 5000 for one in some):
            raise KeyError("a class")
        return list(some)

    found = apart(work, range(6000), lambda one: one < 5000)
    assert [isinstance(one, KeyError) for one in found] == [one < 5000 for one in range(6000)]
    assert asked.count(1) < 3 * LIKE


@pytest.mark.parametrize("problem", [OSError(28, "No space left on device"), MemoryError()])
def test_what_is_full_is_no_objects_doing(problem: Exception) -> None:
    def work(some: list[int]) -> list[int]:
        raise problem

    with pytest.raises(type(problem)):
        apart(work, range(10), lambda _: None)


def few() -> list[dict[str, Any]]:
    """Twelve things that all are assessed, no two alike, near each other, two of them in one case."""
    kinds = ("Vase", "Painting", "Statue", "Armchair")
    rows = [
        {"object_number": f"{at}", "gallery": "Room", "title": f"No. {at}", "object_name": kinds[at % 4], **SIZES,
         "height_m": 0.5 + 0.01 * at, "position_x_m": 0.4 * at, "position_y_m": 0.0}
        for at in range(12)
    ]  # fmt: skip
    rows[7] |= {"case": "A"}
    rows[3] |= {"case": "A"}
    return rows


def told(settings: Settings) -> dict[str, Any]:
    record = load_run(open_database(settings.database))
    return {a.scene.item.object_number: a for a in record.assessments}


STAGES = {
    "classify": "0", "assess": "1", "advise": "2", "telling_requests": "4", "neighbours": "5", "anonymous": "6",
    "sampled_fragilities": "8", "draw": "9",
}  # fmt: skip
"""Steps of the work on many objects, and the object that each is made to fail on."""


def failing(name: str, true: Callable[..., Any]) -> Callable[..., Any]:
    """Return a step of the work that fails on one object, but not on the page or record that says so."""

    def step(*given: Any, **more: Any) -> Any:
        if any(getattr(one, "object_number", "") == STAGES[name] for one in things(given)):
            # An error may quote what no database holds, and at any length.
            raise ValueError(f"operands could not be broadcast together in {name} \ud83d{'!' * 5000}")
        return true(*given, **more)

    return step


def test_a_fault_of_ours_costs_one_object_its_answer_for_one_night(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each step of the work fails on an object of its own; the others are found as ever, and once mended all are.

    Before: the first of these ended the night with exit code 2 and without a report.
    """
    settings = museum(tmp_path, few()).model_copy(update={"logs": Logs(file="log.jsonl")})
    with monkeypatch.context() as broken, journal(settings, str):
        for name in STAGES:
            where = {"draw": PageRenderer, "anonymous": unit_tasks, "neighbours": unit_tasks}.get(name, assessing)
            broken.setattr(where, name, failing(name, getattr(where, name)))
        summary = night(settings)
    assert summary.faults == len(STAGES)
    assert any(f"{len(STAGES)}  of all these met a fault of Kouros" in line for line in summary_lines(summary))
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text(encoding="utf-8").splitlines()]
    logged = {line["object"]: line["traceback"] for line in lines if line["event"] == "object.failed"}
    assert summary.latest is not None
    assert json.loads((summary.latest / "summary.json").read_text(encoding="utf-8"))["faults"] == len(STAGES)
    pages = "".join(page.read_text(encoding="utf-8") for page in summary.latest.glob("*.html"))
    failed = told(settings)
    for name, number in STAGES.items():
        words = f"ValueError: operands could not be broadcast together in {name}"
        # What was found is kept; only its page could not be drawn.
        assert words in failed[number].fault or name == "draw"
        assert words in logged[number]
        # What is missing of an object is told in words.
        assert words in pages or words.replace("_", " ") in pages
        # What came of it before it failed is kept.
        assert failed[number].assessed is (name in ("telling_requests", "neighbours", "draw"))
    with monkeypatch.context() as broken:
        broken.setattr(assessing, "classify", failing("classify", assessing.classify))
        looked = {one.what: one for one in diagnose(tmp_path / "kouros.toml")}["objects"]
    assert looked.state == "warning"
    assert "fails on 1 of 12 objects, such as 0: ValueError" in looked.message
    mended = night(settings)
    assert (mended.faults, mended.objects) == (0, 12)
    after = told(settings)
    assert failed.keys() == after.keys()
    for number, assessment in after.items():
        assert assessment.assessed
        if number not in STAGES.values() or failed[number].assessed:
            assert failed[number].findings == assessment.findings, number
            assert failed[number].recommendations == assessment.recommendations


def test_a_night_in_which_every_object_fails_publishes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [row | {"object_number": f"{at}.{row['object_number']}"} for at in range(3) for row in few()]
    settings = museum(tmp_path, rows)

    def every(*given: Any, **more: Any) -> Any:
        raise ZeroDivisionError("division by zero")

    with monkeypatch.context() as broken:
        broken.setattr(assessing, "assess", every)
        with pytest.raises(RuntimeError, match=r"failed on 36 objects: ZeroDivisionError"):
            night(settings)
    assert not (tmp_path / "reports" / "latest").exists()
    assert night(settings).faults == 0
