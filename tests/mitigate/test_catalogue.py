"""A museum's own measures and isolators: read, used, and refused with file, line, column and remedy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.mitigate import measure_catalogue
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.operations.workspace import UsageError, Workspace
from pipeline.records import Motion
from pipeline.settings import Mitigation, Settings, load_settings, template
from pipeline.tables import TableError
from tests.museum import small

from .scenes import BLOCK, TOWER, demo_motion, solve

MEASURES = "measure,order,title,limit,limit_unit,limit_high,classes,what,sentence,source\n"
ISOLATORS = "name,kind,frequency,damping,friction,stroke,source\n"
OURS = "Ours,horizontal_isolator,0.45,0.05,0.08,0.25,maker's sheet\n"


@pytest.fixture(scope="module")
def motion() -> Motion:
    return demo_motion()


def written(folder: Path, text: str) -> Path:
    file = folder / "ours.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_a_museums_isolators_take_the_place_of_ours(tmp_path: Path, motion: Motion) -> None:
    have = measure_catalogue(isolators=written(tmp_path, ISOLATORS + OURS))
    assert [isolator.name for isolator in have.isolators] == ["Ours"]
    assert have.measures == own_catalogue().measures
    advice = solve(replace(TOWER, allowable_stress_pa=2e5), motion, have)
    assert advice.measure == "horizontal_isolator"
    assert (advice.parameters["frequency"], advice.parameters["friction"]) == (0.45, 0.08)
    assert advice.parameters["stroke"] <= 0.25


def test_an_isolators_own_stroke_is_kept_to(tmp_path: Path, motion: Motion) -> None:
    short = measure_catalogue(isolators=written(tmp_path, ISOLATORS + OURS.replace("0.25", "0.01")))
    advice = solve(replace(TOWER, allowable_stress_pa=2e5), motion, short)
    assert advice.measure != "horizontal_isolator"
    assert any("no horizontal isolator that keeps to its stroke" in text for text in advice.rejected)


def test_a_museums_row_replaces_ours(tmp_path: Path, motion: Motion) -> None:
    """A limit of 2 cm of room, and the measure's own words; the other rows stay."""
    row = "clearance,10,Move apart,0.02,m,0.02,,ours,Move it {clearance} away.,our conservator\n"
    have = measure_catalogue(measures=written(tmp_path, MEASURES + row))
    assert [m.row.name for m in have.measures] == [m.row.name for m in own_catalogue().measures]
    advice = solve(BLOCK, motion, have)
    assert advice.measure != "clearance"
    assert advice.rejected[0].startswith("Move apart: it would need")
    wide = measure_catalogue(measures=written(tmp_path, MEASURES + row.replace("0.02,m,0.02", "0.5,m,0.5")))
    moved = solve(BLOCK, motion, wide)
    assert (moved.title, moved.sentence, moved.source) == ("Move apart", "Move it {clearance} away.", "our conservator")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (MEASURES, "ours.csv has no rows"),
        (MEASURES.replace("title,", "") + "x," * 8 + "x\n", "ours.csv: there is no column 'title'"),
        (MEASURES.replace("source", "source,extra") + "x," * 10 + "x\n", "column 'extra' is not known"),
        (
            MEASURES + "glue,1,Glue,,,,,w,Glue it.,s\n",
            "line 2, measure 'glue': column 'like': is empty, and nothing is known .*use one of chocks",
        ),
        (
            MEASURES + 2 * "fasten,1,F,,,,,w,Fix.,s\n",
            "line 3, measure 'fasten': column 'measure': line 2 has this name; give each row its own",
        ),
        (MEASURES + "fasten,first,F,,,,,w,Fix.,s\n", "column 'order': input should be a valid number, .*, not 'first'"),
        (MEASURES + "fasten,nan,F,,,,,w,Fix.,s\n", "column 'order': input should be a finite number, not 'nan'"),
        (MEASURES + "grip_pad,1,G,,-,,,w,On it.,s\n", "column 'limit': is empty; write the number"),
        (MEASURES + "grip_pad,1,G,-0.5,-,,,w,On it.,s\n", "column 'limit': input should be greater than 0, not '-0.5'"),
        (MEASURES + "clearance,1,C,30,cm,60,,w,Away.,s\n", "column 'limit_unit': must be 'm', not 'cm'"),
        (MEASURES + "fasten,1,F,,,,vase,w,Fix.,s\n", "column 'classes': names 'vase', which is no class"),
        (MEASURES + "fasten,1,F,,,,,w,Hold {weight}.,s\n", r"asks for \{weight\}; there is \{force\}, \{moment\}"),
        (MEASURES + "fasten,1,F,,,,,w,Hold {force:.2f}.,s\n", r"column 'sentence': asks for \{force\}"),
        (MEASURES + "fasten,1,F,,,,,w,Hold {force.,s\n", "column 'sentence': has a stray brace"),
        (MEASURES + "fasten,1,,,,,,w,Fix.,s\n", "column 'title': is empty"),
        (MEASURES + "remove,1,R,,,,,w,Away.,s\n", "measure 'remove': column 'order' must be the largest"),
        (MEASURES + "fasten,1\n", "ours.csv, line 2: not as many cells"),
    ],
)
def test_measures_that_cannot_be_used_are_named(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(TableError, match=message):
        measure_catalogue(measures=written(tmp_path, text))


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("", "ours.csv has no rows"),
        (OURS + OURS, "line 3, name 'Ours': column 'name': line 2 has this name; give each row its own"),
        (OURS.replace("Ours", " "), "line 2, name ' ': column 'name': is empty"),
        (OURS.replace("horizontal_isolator", "springs"), "column 'kind': is 'springs'; use one of friction_isolator"),
        (OURS.replace("0.45", "0"), "column 'frequency': must be a finite number above 0 Hz, not 0"),
        (OURS.replace("0.45", "inf"), "column 'frequency': must be a finite number"),
        (OURS.replace("0.05", "-1"), "column 'damping': must be a finite number at least 0"),
        (OURS.replace("0.08", "low"), "column 'friction': input should be a valid number, .*, not 'low'"),
        (OURS.replace("0.25", "0"), "column 'stroke': input should be greater than 0, not '0'"),
        (OURS.replace("maker's sheet", ""), "column 'source': is empty"),
        ("Pad,friction_isolator,0.5,,0.1,,s\n", "column 'frequency': must be empty: a friction_isolator has none"),
        ("Pad,rotational_isolator,3,0.2,,0.1,s\n", "column 'stroke': must be empty: it turns"),
    ],
)
def test_isolators_that_cannot_be_used_are_named(tmp_path: Path, row: str, message: str) -> None:
    with pytest.raises(TableError, match=message):
        measure_catalogue(isolators=written(tmp_path, ISOLATORS + row))


def test_the_settings_name_the_files(tmp_path: Path) -> None:
    """Relative to kouros.toml; a file that is not there is told with its setting."""
    written(tmp_path, ISOLATORS + OURS)
    file = tmp_path / "kouros.toml"
    text = small(template(museum="M", source="", mapping="kouros", site="demo"))
    file.write_text(text.replace('catalogue = ""', 'catalogue = "ours.csv"'), encoding="utf-8")
    settings = load_settings(file)
    engine: object = None
    assert [i.name for i in Workspace(settings, engine).measures.isolators] == ["Ours"]  # type: ignore[arg-type]
    lost = Settings(mitigation=Mitigation(measures="lost.csv"), home=tmp_path)
    with pytest.raises(UsageError, match=r"lost\.csv is not there; \[mitigation\] measures names"):
        _ = Workspace(lost, engine).measures  # type: ignore[arg-type]
