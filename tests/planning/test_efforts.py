"""The table of efforts: every measure has a row, and what cannot be used is told with file, row, field and remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.mitigate import measure_catalogue
from pipeline.planning.efforts import OTHER, TRADES, VISIT, efforts
from pipeline.tables import TableError, table

HEAD = "measure,trade,hours,hours_low,hours_high,hours_further,cost,cost_low,cost_high,cost_further,source\n"
GOOD = "wax,handler,0.2,0.1,0.4,0.5,3,1,9,1,our own\n"


def written(folder: Path, rows: str, head: str = HEAD) -> Path:
    file = folder / "our efforts.csv"
    file.write_text(head + rows, encoding="utf-8")
    return file


def test_every_measure_has_a_row_with_a_range_a_trade_and_a_source() -> None:
    have = efforts()
    named = {row["measure"] for row in table("measures")}
    assert {row["measure"] for row in table("efforts")} == named | {OTHER, VISIT}
    for row in have.rows.values():
        assert row.hours_low <= row.hours <= row.hours_high
        assert row.cost_low <= row.cost <= row.cost_high
        assert row.trade in TRADES
        assert row.source
    # What nobody told is as wide as all that is told.
    every = [row for name, row in have.rows.items() if name not in (OTHER, VISIT)]
    assert have.of("of another package") == have.rows[OTHER]
    assert have.rows[OTHER].hours_high >= sorted(row.hours_high for row in every)[-2]


def test_a_museums_rows_take_the_place_of_ours_and_the_others_stay(tmp_path: Path) -> None:
    have = efforts(written(tmp_path, GOOD))
    assert (have.of("wax").hours, have.of("wax").source) == (0.2, "our own")
    assert have.of("putty") == efforts().of("putty")


def test_a_measure_of_the_museums_own_takes_what_it_is_like_takes_unless_it_has_a_row(tmp_path: Path) -> None:
    measures = tmp_path / "measures.csv"
    measures.write_text(
        "measure,like,order,title,limit,limit_unit,limit_high,classes,what,sentence,source\n"
        "gel,wax,32.5,Gel,0.4,-,,,gel pads,Fix it with gel.,our mount-makers\n",
        encoding="utf-8",
    )
    catalogue = measure_catalogue(measures)
    assert efforts(None, catalogue).of("gel").hours == efforts().of("wax").hours
    assert efforts(written(tmp_path, GOOD), catalogue).of("gel").hours == 0.2
    own = efforts(written(tmp_path, GOOD.replace("wax", "gel")), catalogue)
    assert (own.of("gel").hours, own.of("wax").hours) == (0.2, efforts().of("wax").hours)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (
            GOOD.replace("wax", "glue"),
            r"line 2, measure 'glue': column 'measure': is 'glue'.*use one of chocks, clearance",
        ),
        (GOOD.replace("handler", "plumber"), r"line 2, measure 'wax': column 'trade': input should be 'handler'"),
        (GOOD.replace("0.2,0.1", "-0.2,-0.3"), r"column 'hours': input should be greater than or equal to 0"),
        (GOOD.replace("0.4,0.5", "0.15,0.5"), r"column 'hours_high': hours_low <= hours <= hours_high does not hold"),
        (GOOD.replace("3,1,9", "3,4,9"), r"column 'cost_high': cost_low <= cost <= cost_high does not hold \(4 3 9\)"),
        (GOOD.replace(",0.5,", ",1.5,"), r"column 'hours_further': input should be less than or equal to 1"),
        (GOOD.replace("0.2", "some"), r"column 'hours': input should be a valid number"),
        (GOOD.replace("0.2", "nan"), r"column 'hours': input should be a finite number"),
        (GOOD.replace("our own", " "), r"column 'source': is empty; every row needs it"),
        (GOOD + GOOD, r"line 3, measure 'wax': column 'measure': line 2 has this name"),
        ("", r"our efforts.csv has no rows; give it at least one, or leave its setting empty"),
    ],
)
def test_what_cannot_be_used_is_told(tmp_path: Path, rows: str, said: str) -> None:
    with pytest.raises(TableError, match=said) as told:
        efforts(written(tmp_path, rows))
    assert str(told.value).startswith("our efforts.csv")


def test_a_column_that_is_missing_or_strange_is_named(tmp_path: Path) -> None:
    with pytest.raises(TableError, match=r"column 'hours_low': there is no such column"):
        efforts(written(tmp_path, "wax,handler,0.2\n", "measure,trade,hours\n"))
    with pytest.raises(TableError, match=r"column 'colour': no column is called so"):
        efforts(written(tmp_path, GOOD.replace("\n", ",red\n"), HEAD.replace("\n", ",colour\n")))
