"""A run comes back exactly as it was saved, or nothing of it is there."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from sqlalchemy import Engine, Table, delete, func, select, update

from pipeline.collection.database import open_database
from pipeline.records import Assessment, Chart, Estimate, MeasurementRequest, Origin, Page, RunRecord, Spacing, Verdict
from pipeline.store.codec import StoreError
from pipeline.store.migrate import upgrade
from pipeline.store.pages import load_page, remove_runs
from pipeline.store.results import anonymous, damaged, encode, keep
from pipeline.store.runs import commit_run, latest_run_id, list_runs, load_head, load_run
from pipeline.store.tables import PAGE, RESULT, RUN, RUN_CHART, RUN_MOTION, RUN_PAGE
from pipeline.store.verifying import verify_table
from tests.soak import examples
from tests.store.run_samples import RUNS, assessment, finding, motion, run, save_run

TABLES = (RUN, RUN_MOTION, RUN_CHART, RUN_PAGE, PAGE, RESULT)


def rows(engine: Engine) -> dict[str, int]:
    """How many rows each table of results has."""
    with engine.connect() as connection:
        return {
            table.name: connection.execute(select(func.count()).select_from(table)).scalar_one() for table in TABLES
        }


NOTHING = dict.fromkeys((table.name for table in TABLES), 0)


@settings(deadline=None, max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(record=RUNS)
def test_a_run_comes_back_exactly(engine: Engine, record: RunRecord) -> None:
    with engine.begin() as connection:
        connection.execute(delete(RUN))
    save_run(engine, record)
    loaded = load_run(engine, record.run_id)
    assert loaded == record
    # Beyond equality: an enumeration is no text, 1.0 is no 1, and the order of mappings is kept.
    assert repr(_positive_zero(loaded)) == repr(_positive_zero(record))


def _positive_zero(record: RunRecord) -> str:
    """SQLite keeps -0.0 as 0.0, which is equal."""
    return repr(record).replace("-0.0,", "0.0,").replace("-0.0)", "0.0)").replace("-0.0}", "0.0}")


def test_mappings_that_are_no_dictionaries_are_refused_or_become_them(engine: Engine) -> None:
    one = assessment("1", finding("1"))
    scene = replace(one.scene, skipped=MappingProxyType({"swing": "stands"}))
    with pytest.raises(StoreError, match=r"Expected `dict.*skipped"):
        save_run(engine, run("a", replace(one, scene=scene)))
    record = replace(run("a", one), settings=MappingProxyType({"keep": (1, 2)}))
    save_run(engine, record)
    loaded = load_run(engine, "a")
    assert loaded == record
    assert type(loaded.settings) is dict


def test_infinity_and_nan_survive(engine: Engine) -> None:
    odd = finding("1", demand=math.nan, low=-math.inf, high=math.inf, utilisation=math.inf, error=None)
    one = assessment("1", odd)
    wild = Estimate(math.nan, "m", Origin.ASSUMED, -math.inf, math.inf)
    save_run(engine, run("a", replace(one, scene=replace(one.scene, parameters={"lever": wild}))))
    loaded = load_run(engine).assessments[0]
    back = loaded.findings[0]
    assert back.demand is not None
    assert math.isnan(back.demand)
    assert (back.low, back.high, back.utilisation, back.error) == (-math.inf, math.inf, math.inf, None)
    assert math.isnan(loaded.scene.parameters["lever"].value)
    assert loaded.scene.parameters["lever"].high == math.inf


def test_numbers_of_numpy_are_numbers(engine: Engine) -> None:
    odd = finding("1", demand=np.float64(0.1) + np.float64(0.2), capacity=np.int64(3), error=np.float32(0.1))
    shaken = replace(motion("malibu", "ab"), samples=np.int64(2**40))
    record = run("a", assessment("1", odd), motions=(shaken,))
    save_run(engine, record)
    loaded = load_run(engine, "a")
    assert loaded == record
    assert [type(loaded.assessments[0].findings[0].capacity), type(loaded.motions[0].samples)] == [float, int]


def test_an_empty_run_comes_back(engine: Engine) -> None:
    record = run("", motions=())
    save_run(engine, record)
    assert load_run(engine) == record
    assert load_run(engine, "") == record


def test_wishes_come_back_page_by_page_what_settles_most_first(engine: Engine) -> None:
    def wish(number: str, gallery: str, settles: float) -> MeasurementRequest:
        return MeasurementRequest(number, gallery, "Kouros", "mass_kg", "kg", 1.0, 2.0, 3.0, "a guess", 3, settles, 0)

    objects = (assessment("1", gallery="G1"), assessment("2", gallery="G1"), assessment("3", gallery="G2"))
    asked = (wish("2", "G1", 2.0), wish("1", "G1", 1.0), wish("3", "G2", 3.0))
    record = replace(run("a", *objects), wishes=asked)
    save_run(engine, record)
    assert load_run(engine, "a").wishes == asked
    save_run(engine, replace(record, run_id="b", wishes=()))
    assert load_run(engine, "b").wishes == ()


def test_objects_in_one_case_share_a_row_and_so_do_those_that_are_alike(engine: Engine) -> None:
    def of(number: str, case: str, **changed: float) -> Assessment:
        one = assessment(number, finding(number, **changed))
        return replace(one, scene=replace(one.scene, item=replace(one.scene.item, case=case)))

    record = run("a", of("1", "c", demand=0.1), of("2", "c", demand=0.2), of("3", ""), of("4", ""))
    save_run(engine, record)
    assert rows(engine) == NOTHING | {"run": 1, "page": 1, "run_page": 1, "result": 2}
    assert load_run(engine, "a") == record


def test_a_run_of_a_page_that_is_not_kept_leaves_nothing_of_itself(engine: Engine) -> None:
    before = run("before", assessment("1", finding("1")))
    save_run(engine, before)
    had = rows(engine)
    many = tuple(motion(str(number), "ab") for number in range(2_500))
    with pytest.raises(StoreError, match=r"'gone' was not stored.*or a result of it is gone"):
        commit_run(engine, run("gone", motions=many), [Page("none", "", True, 1, 1, "gone", "")], counts={})
    assert rows(engine) == had
    assert load_run(engine) == before


def test_a_run_is_never_overwritten(engine: Engine) -> None:
    first = run("a", assessment("1", finding("1")))
    save_run(engine, first)
    had = rows(engine)
    with pytest.raises(StoreError, match=r"'a' was not stored.*there is a run of that id already"):
        save_run(engine, replace(first, museum="Another museum"))
    assert rows(engine) == had
    assert load_run(engine, "a") == first


@pytest.mark.parametrize(
    ("changed", "what"), [({"demand": "much"}, "demand"), ({"title": "broken \ud800"}, "surrogates"),
                          ({"verdict": "fail?"}, "verdict")],
)  # fmt: skip
def test_what_cannot_be_kept_is_refused_before_anything_is_written(
    engine: Engine, changed: dict[str, object], what: str
) -> None:
    good = finding("1")
    with pytest.raises(StoreError, match=f"(?s){what}"):
        save_run(engine, run("a", assessment("1", replace(good, **changed))))
    assert rows(engine) == NOTHING


def test_settings_charts_and_motions_that_cannot_be_kept_are_named(engine: Engine) -> None:
    with pytest.raises(StoreError, match=r"run 'a': settings\.out is a (Posix|Windows)Path"):
        save_run(engine, replace(run("a"), settings={"out": Path("reports")}))
    with pytest.raises(StoreError, match=r"(?s)motion 'malibu'.*samples"):
        save_run(engine, run("a", motions=(replace(motion("malibu", "ab"), samples=2.5),)))
    charts: Mapping[str, Chart] = {"stability": 3}  # type: ignore[dict-item]
    with pytest.raises(StoreError, match="chart 'stability'"):
        save_run(engine, replace(run("a"), charts=charts))
    assert rows(engine) == NOTHING


def test_an_unknown_run_lists_the_known_ones(engine: Engine) -> None:
    with pytest.raises(StoreError, match=r"no finished run.*kouros run"):
        load_run(engine)
    with pytest.raises(StoreError, match=r"no run 'z'.*none; make one"):
        load_run(engine, "z")
    save_run(engine, run("a", day=1))
    save_run(engine, run("b", day=2))
    with pytest.raises(StoreError, match="no run 'z'; the runs, newest first, are: 'b', 'a'"):
        load_run(engine, "z")


def test_the_newest_finished_run_is_the_latest(engine: Engine) -> None:
    assert latest_run_id(engine) is None
    assert list_runs(engine) == ()
    for run_id, day in (("b", 3), ("a", 1), ("c", 2)):
        save_run(engine, run(run_id, day=day))
    save_run(engine, replace(run("later", day=4), finished=""))
    assert latest_run_id(engine) == "b"
    assert load_run(engine).run_id == "b"
    assert [(one.run_id, one.status) for one in list_runs(engine)] == [
        ("later", "unfinished"),
        ("b", "finished"),
        ("c", "finished"),
        ("a", "finished"),
    ]


def test_the_list_counts(engine: Engine) -> None:
    verdicts = (Verdict.FAIL, Verdict.FAIL, Verdict.PASS)
    findings = [finding("1", f"model {i}", verdict) for i, verdict in enumerate(verdicts)]
    save_run(engine, run("a", assessment("1", *findings), assessment("2"), motions=(motion("malibu", "ab"),)))
    assert list_runs(engine)[0].counts == {
        "objects": 2,
        "assessed": 1,
        "findings": 3,
        "pass": 1,
        "fail": 2,
        "undetermined": 0,
        "recommendations": 2,
        "pages": 1,
        "charts": 0,
        "motions": 1,
    }


def test_what_two_runs_share_stays_until_both_are_gone(engine: Engine) -> None:
    """And what no run holds, as an interrupted one leaves behind, goes."""
    one = run("one", assessment("1", finding("1")))
    save_run(engine, one)
    _, pages = load_head(engine, "one")
    commit_run(engine, replace(one, run_id="two", assessments=()), pages, counts={})
    stray = encode("stray", [anonymous(assessment("2"), {}, None)])
    keep(engine, "cut off", "2031-05-01T00:00:00+00:00", [stray])
    remove_runs(engine, ["one", "never there"])
    assert rows(engine) == NOTHING | {"run": 1, "run_page": 1, "page": 1, "result": 1}
    assert load_run(engine, "two").assessments == one.assessments
    remove_runs(engine, ["two"])
    assert rows(engine) == NOTHING


def test_a_result_that_another_page_shows_stays(engine: Engine) -> None:
    """Of two nights that found the same of one object and another thing of its neighbour."""
    spacing = Spacing("G1", "design", "1", "2", 0.05, 0.06, 0.02, 0.08, 0.06, 0.2, Verdict.PASS, "bound", "malibu")
    old = replace(run("old", assessment("1"), assessment("2", finding("2"))), spacings=(spacing,))
    new = replace(run("new", assessment("1"), assessment("2", finding("2", demand=0.5)), day=2), spacings=(spacing,))
    save_run(engine, old)
    save_run(engine, new)
    assert rows(engine) == NOTHING | {"run": 2, "run_page": 2, "page": 2, "result": 4}
    remove_runs(engine, ["old"])
    assert rows(engine) == NOTHING | {"run": 1, "run_page": 1, "page": 1, "result": 3}
    assert load_run(engine, "new") == new


def _altered(engine: Engine, table: Table, column: str) -> None:
    """Change the last letter, or the last byte, of a row's column."""
    with engine.begin() as connection:
        if table is PAGE:
            # The rows of a run name it.
            connection.execute(delete(RUN_PAGE))
        old = connection.execute(select(table.c[column])).scalar_one()
        new = old[:-1] + ("0" if old[-1] != "0" else "1") if isinstance(old, str) else old[:-1] + bytes([old[-1] ^ 1])
        connection.execute(update(table).values({column: new}))


@pytest.mark.parametrize("column", ["key", "run_id", "made", "outline", "found", "seal"])
def test_a_result_that_is_not_what_was_written_is_noticed(engine: Engine, column: str) -> None:
    save_run(engine, run("a", assessment("1", finding("1"))))
    assert list(damaged(engine)) == []
    _altered(engine, RESULT, column)
    assert len(list(damaged(engine))) == 1
    with pytest.raises(StoreError, match=r"result .*(is damaged|pruned while it was read)"):
        load_run(engine, "a")


@pytest.mark.parametrize("column", ["key", "run_id", "made", "members", "seal"])
def test_a_page_that_is_not_what_was_written_is_noticed(engine: Engine, column: str) -> None:
    save_run(engine, run("a", assessment("1", finding("1"))))
    _, (page,) = load_head(engine, "a")
    assert list(verify_table(engine, "page")) == []
    _altered(engine, PAGE, column)
    assert len(list(verify_table(engine, "page"))) == 1
    with pytest.raises(StoreError, match=r"page .*(is damaged|pruned while it was read)"):
        load_page(engine, page.key)


def test_a_run_that_lost_rows_is_not_shown_as_whole(engine: Engine) -> None:
    save_run(engine, run("a", assessment("1", finding("1"))))
    with engine.begin() as connection:
        connection.execute(delete(RUN_PAGE))
    with pytest.raises(StoreError, match="run 'a' is not whole"):
        load_run(engine, "a")


def test_a_database_without_tables_says_how_to_make_them(empty: Engine) -> None:
    for act in (load_run, list_runs, latest_run_id, lambda engine: save_run(engine, run("a"))):
        with pytest.raises(StoreError, match="kouros init"):
            act(empty)


def test_a_folder_with_a_percent_sign_and_a_quote(tmp_path: Path) -> None:
    where = open_database(tmp_path / "100% Kouros's données" / "kouros.db")
    upgrade(where)
    save_run(where, run("a"))
    assert load_run(where) == run("a")
    where.dispose()
