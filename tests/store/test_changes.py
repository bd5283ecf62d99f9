"""What changed between two runs, against a computation by hand and one in plain Python."""

import json
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sqlalchemy import Engine, Table, delete, select, update

from pipeline.collection.database import open_database
from pipeline.collection.sealing import sealed
from pipeline.errors import DamageWarning
from pipeline.records import (
    Assessment,
    Brief,
    Cause,
    CauseKind,
    FieldChange,
    InputChange,
    MotionChange,
    Move,
    NewsKind,
    ObjectChange,
    ObjectPlace,
    RunChanges,
    RunRecord,
    State,
    Verdict,
    VerdictChange,
)
from pipeline.store.codec import StoreError
from pipeline.store.migrate import upgrade
from pipeline.store.news import Causes
from pipeline.store.results import DamagedRunError
from pipeline.store.runs import changes_since, compare_runs
from pipeline.store.tables import PAGE, RESULT, RUN
from tests.soak import examples
from tests.store.run_samples import assessment, finding, motion, run, save_run

ACTS = Brief(State.ACT, "", "room", "More room")
PASS, FAIL, UNDETERMINED = Verdict.PASS, Verdict.FAIL, Verdict.UNDETERMINED


def test_changes_by_hand(engine: Engine) -> None:
    old = run(
        "old",
        assessment("stays", finding("stays")),
        assessment("gone", finding("gone", verdict=FAIL), gallery="G0"),
        assessment("wider", finding("wider", "rocking", FAIL), finding("wider", "sliding"), half_width=0.1),
        assessment("moves", finding("moves", "stress", PASS, title="Tension"), gallery="G1"),
        motions=(motion("malibu", "aa"), motion("dropped", "bb"), motion("malibu", "cc", level="rare")),
    )
    new = run(
        "new",
        assessment("stays", finding("stays", demand=0.41)),
        assessment("wider", finding("wider", "rocking", UNDETERMINED), half_width=0.2),
        assessment(
            "moves",
            finding("moves", "stress", PASS, title="Tension"),
            finding("moves", "stress", FAIL, title="Shear"),
            gallery="G2",
        ),
        assessment("fresh", finding("fresh", verdict=FAIL), gallery="G3"),
        day=2,
        motions=(motion("malibu", "ab"), motion("malibu", "cc", level="rare")),
    )
    save_run(engine, old)
    save_run(engine, new)
    motion_changed = (Cause(CauseKind.MOTION, "dropped"), Cause(CauseKind.MOTION, "malibu"))
    found = compare_runs(engine, "old", "new")
    width = found.inputs[0].fields[0]
    assert (width.name, width.before["value"], width.after["value"]) == ("parameters.half_width", 0.1, 0.2)
    assert found == RunChanges(
        "old",
        "new",
        added=(ObjectPlace("fresh", "G3"),),
        removed=(ObjectPlace("gone", "G0"),),
        moved=(Move("moves", "G1", "G2"),),
        inputs=(InputChange("wider", "G1", (width,)),),
        verdicts=(
            VerdictChange("wider", "G1", "rocking", "design", FAIL, UNDETERMINED, motion_changed),
            VerdictChange("wider", "G1", "sliding", "design", PASS, None, motion_changed),
            VerdictChange("moves", "G2", "stress", "design", PASS, FAIL, motion_changed),
        ),
        motions=(
            MotionChange("design", "", "dropped", ("bb",), None),
            MotionChange("design", "", "malibu", ("aa",), ("ab",)),
        ),
        started=old.started,
        # What is wider by its estimates alone is no news of its own: the motion changed for all.
        objects=(
            ObjectChange("fresh", "Kouros", "G3", None, ACTS),
            ObjectChange("moves", "Kouros", "G2", replace(ACTS, state=State.FINE), ACTS, came_from="G1"),
            ObjectChange("gone", "Kouros", "G0", ACTS, None, recorded=False),
        ),
        shared={"better": 1},
    )
    assert [one.kind for one in found.objects] == [NewsKind.DANGER, NewsKind.WORSE, NewsKind.GONE]
    assert [(v.fixed, v.worsened) for v in found.verdicts] == [(False, False), (False, False), (False, True)]
    assert (found.worsened, found.fixed, len(found.others)) == (found.verdicts[2:], (), 2)


def test_a_run_has_not_changed_against_itself_or_its_equal(engine: Engine) -> None:
    one = run("a", assessment("1", finding("1")), motions=(motion("malibu", "ab"),))
    save_run(engine, one)
    save_run(engine, replace(one, run_id="b"))
    assert not compare_runs(engine, "a", "a")
    assert not compare_runs(engine, "a", "b")


@pytest.mark.parametrize(
    ("table", "column"), [(RESULT, "found"), (RESULT, "outline"), (RESULT, "key"), (PAGE, "members"), (PAGE, "made")]
)
def test_what_changed_since_a_damaged_run_is_not_known_and_said_so(sqlite: Engine, table: Table, column: str) -> None:
    """The new run is sound: a night does not fail for what the last one left."""
    _empty(sqlite)
    save_run(sqlite, run("old", assessment("1", finding("1"))))
    with sqlite.begin() as connection:
        value = connection.execute(select(table.c[column])).scalar_one()
        connection.execute(update(table).values({column: value[::-1]}))
    save_run(sqlite, run("new", assessment("1", finding("1", verdict=FAIL), half_width=0.2), day=2))
    with pytest.raises(DamagedRunError, match=r"damaged|pruned|is gone|changed in the database"):
        compare_runs(sqlite, "old", "new")
    with pytest.warns(DamageWarning, match="what changed since run 'old' is not known"):
        assert changes_since(sqlite, "old", "new") is None
    assert changes_since(sqlite, "new", "new") == compare_runs(sqlite, "new", "new")


def test_an_unknown_run_is_named(engine: Engine) -> None:
    save_run(engine, run("a"))
    with pytest.raises(StoreError, match="no run 'b'; the runs, newest first, are: 'a'"):
        compare_runs(engine, "a", "b")


def _assessments(draws: dict[str, dict[tuple[str, str], Verdict]]) -> list[Assessment]:
    return [
        assessment(number, *(finding(number, model, verdict, level=level) for (model, level), verdict in found.items()))
        for number, found in draws.items()
    ]


_FOUND = st.dictionaries(
    st.sampled_from(list(product(("rocking", "sliding"), ("design", "rare")))), st.sampled_from(Verdict), max_size=4
)
_RUN = st.dictionaries(st.sampled_from(["1", "2", "a'b", "\0"]), _FOUND, max_size=4)


@pytest.fixture(scope="module")
def sqlite(tmp_path_factory: pytest.TempPathFactory) -> Engine:
    engine = open_database(Path(tmp_path_factory.mktemp("changes")) / "kouros.db")
    upgrade(engine)
    return engine


def _empty(engine: Engine) -> None:
    with engine.begin() as connection:
        for one in (RUN, PAGE, RESULT):
            connection.execute(delete(one))


@settings(deadline=None, max_examples=examples(40), suppress_health_check=[HealthCheck.too_slow])
@given(before=_RUN, after=_RUN)
def test_changes_equal_a_plain_comparison(
    sqlite: Engine, before: dict[str, dict[tuple[str, str], Verdict]], after: dict[str, dict[tuple[str, str], Verdict]]
) -> None:
    _empty(sqlite)
    records: list[RunRecord] = [run("a", *_assessments(before)), run("b", *_assessments(after))]
    for record in records:
        save_run(sqlite, record)
    found = compare_runs(sqlite, "a", "b")
    assert {place.object_number for place in found.added} == after.keys() - before.keys()
    assert {place.object_number for place in found.removed} == before.keys() - after.keys()
    expected = {
        (number, *key, before[number].get(key), after[number].get(key))
        for number in before.keys() & after.keys()
        for key in before[number].keys() | after[number].keys()
        if before[number].get(key) != after[number].get(key)
    }
    assert {(c.object_number, c.model, c.level, c.before, c.after) for c in found.verdicts} == expected
    assert len(found.verdicts) == len(expected)


def test_house_rules_are_a_cause_only_for_what_rests_on_one() -> None:
    settings = [FieldChange("house", "a", "b"), FieldChange("analysis.tilt", 1, 2)]

    def told(number: str, housed: frozenset[str] | None) -> list[str]:
        found = Causes([], [], ({}, {}), settings, [], housed).of(number, "design", "", "")
        return [cause.what.partition(":")[0] for cause in found]

    assert told("1", frozenset("1")) == told("2", None) == ["house", "analysis.tilt"]
    assert told("2", frozenset("1")) == ["analysis.tilt"]


def test_of_a_run_of_an_earlier_version_nothing_is_made_up(sqlite: Engine) -> None:
    """Its outlines say nothing in short: what is new and gone is known, how things stood is not."""
    _empty(sqlite)
    save_run(sqlite, run("old", assessment("1", finding("1")), assessment("2", finding("2"))))
    with sqlite.begin() as connection:
        for row in connection.execute(select(RESULT)).mappings().all():
            bare = json.dumps([one[:3] for one in json.loads(row["outline"])])
            new = sealed(RESULT, {name: bare if name == "outline" else row[name] for name in row if name != "seal"})
            connection.execute(update(RESULT).where(RESULT.c.key == row["key"]).values(new))
    worse = assessment("1", finding("1", verdict=FAIL), half_width=0.2)
    save_run(sqlite, run("new", worse, assessment("3", finding("3", verdict=FAIL), half_width=0.3), day=2))
    found = compare_runs(sqlite, "old", "new")
    assert [(one.object_number, one.kind) for one in found.objects] == [("3", NewsKind.DANGER), ("2", NewsKind.GONE)]
    assert [v.object_number for v in found.verdicts] == ["1"]
