"""The survey asks for what would settle a verdict, for nothing else; its workbook comes back as measurements."""

from __future__ import annotations

from dataclasses import replace
from math import atan, degrees
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.survey import measurables, measurement_requests
from pipeline.collection.errors import CollectionError
from pipeline.collection.inventory import add_sheet, read_inventory, replace_inventory, return_to, versions
from pipeline.collection.reading import Reading
from pipeline.execute import Threads
from pipeline.mitigate.installed import InstalledMeasure, placed
from pipeline.operations.workspace import open_workspace
from pipeline.quantities import G
from pipeline.records import ITEM_FIELDS, Furniture, Item, MeasurementRequest, Motion, Origin, Support, Verdict
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.report.files.survey_sheet import column_name, sheet_title, write_survey
from pipeline.settings import load_settings
from pipeline.tools.survey import LENGTH_UNITS, read_sheet


class Silent:
    def step(self, what: str, done: int, total: int) -> None:
        """Say nothing."""


DT = 0.01
TIME = np.arange(600) * DT
SINE = 0.35 * G * np.sin(2 * np.pi * 1.5 * TIME)
MOTION = Motion(dt=DT, acceleration=np.array([SINE, 0.4 * SINE, 0.0 * SINE]), name="sine")
LEVELS = [LevelMotions("design", "max", (MOTION,))]

BOX = Item("1", "East", "Box", height_m=0.2, base_width_m=0.6, base_depth_m=0.6, cg_height_m=0.08, mass_kg=5.0,
           support=Support.FREESTANDING, furniture=Furniture.FLOOR, clearance_m=0.05, susceptible=False)  # fmt: skip


def surveyed(*items: Item) -> list[MeasurementRequest]:
    scenes = [classify(item) for item in items]
    _, findings = assess(scenes, LEVELS, Context(Threads(1)))
    return measurement_requests(scenes, findings, LEVELS, Context(Threads(1)))


def verdicts(item: Item) -> set[tuple[str, Verdict]]:
    _, (findings,) = assess([classify(item)], LEVELS, Context(Threads(1)))
    return {(finding.model, finding.verdict) for finding in findings}


def test_a_friction_that_decides_is_asked_for_and_settles_what_it_says() -> None:
    """The truth is the assessment of the record with the number filled in, low, best and high."""
    assert ("sliding", Verdict.UNDETERMINED) in verdicts(BOX)
    (request,) = surveyed(BOX)
    assert (request.field, request.open, request.unlocks) == ("friction", 1, 0)
    assert request.low is not None
    assert request.high is not None
    assert request.best is not None
    assert request.low < request.best < request.high
    filled = [verdicts(replace(BOX, friction=value)) for value in (request.low, request.best, request.high)]
    settled = sum(("sliding", Verdict.UNDETERMINED) not in found for found in filled)
    assert request.settles == pytest.approx(settled / 3)
    assert settled > 0


def test_what_would_settle_nothing_says_so() -> None:
    """Friction and room are both open, and so wide that neither settles anything without the other."""
    found = {request.field: request for request in surveyed(replace(BOX, clearance_m=None))}
    _, (findings,) = assess([classify(replace(BOX, clearance_m=None))], LEVELS, Context(Threads(1)))
    (sliding,) = [f for f in findings if f.model == "sliding"]
    for request in found.values():
        assert request.settles_nothing == (request.settles == 0.0)
    assert sliding.verdict is Verdict.UNDETERMINED
    assert {"friction", "clearance_m"} <= set(found)


def test_what_is_settled_already_is_not_asked_for() -> None:
    assert surveyed(replace(BOX, friction=0.8)) == []


def test_what_is_missing_comes_first_and_what_is_not_on_display_never() -> None:
    lost = Item("2", "West", height_m=0.2, support=Support.FREESTANDING, furniture=Furniture.FLOOR)
    first, *_ = found = surveyed(BOX, lost, replace(lost, object_number="3", on_display=False))
    assert (first.object_number, first.field, first.settles_nothing) == ("2", "width_m", False)
    assert first.unlocks > 0
    assert {request.object_number for request in found} == {"1", "2"}


ROCKS = replace(BOX, base_width_m=None, base_depth_m=None, width_m=0.1, depth_m=0.1, cg_height_m=None, friction=0.9,
                susceptible=None)  # fmt: skip
"""How wide it stands and how high its mass is, nobody measured."""


def test_a_tilt_test_is_the_first_question_and_settles_what_it_says() -> None:
    """The truth is the assessment of the record with the angle filled in, low, best and high."""
    assert ("standing", Verdict.UNDETERMINED) in verdicts(ROCKS)
    assert measurables()[0].field == "tilt_angle_deg"
    first, *others = surveyed(ROCKS)
    assert first.field == "tilt_angle_deg"
    assert all(first.gain >= other.gain for other in others)
    known = classify(ROCKS).parameters
    half, height = known["half_width"], known["cg_height"]
    slopes = (half.low / height.high, half.value / height.value, half.high / height.low)
    filled = [verdicts(replace(ROCKS, tilt_angle_deg=degrees(atan(slope)))) for slope in slopes]
    settled = sum(("standing", Verdict.UNDETERMINED) not in found for found in filled)
    assert first.settles == pytest.approx(settled / 3)
    assert settled == 3


@pytest.mark.parametrize("change", [{"mass_kg": 80.0}, {"susceptible": True}, {"condition": 0.2}])
def test_what_may_not_be_handled_is_not_tilted(change: dict[str, object]) -> None:
    asked = {request.field for request in surveyed(replace(ROCKS, **change))}  # type: ignore[arg-type]
    assert "tilt_angle_deg" not in asked
    assert "base_width_m" in asked


def test_what_was_tilted_is_not_tilted_again() -> None:
    assert "tilt_angle_deg" not in {request.field for request in surveyed(replace(ROCKS, tilt_angle_deg=5.0))}


def test_a_tilt_test_is_asked_for_where_no_base_is_known() -> None:
    lost = replace(BOX, title="Mask", base_width_m=None, base_depth_m=None)
    assert classify(lost).missing
    # A mask is held by a mount, and asked for its width; what stands is tilted.
    box = replace(lost, title="Box", height_m=0.9, cg_height_m=None, width_m=0.3, depth_m=0.3)
    assert "tilt_angle_deg" in {request.field for request in surveyed(box)}
    assert not classify(replace(lost, tilt_angle_deg=9.0)).missing


def test_every_field_of_the_survey_is_one_of_the_record() -> None:
    for measurable in measurables():
        assert measurable.field in ITEM_FIELDS
        assert measurable.how.endswith(".")


HOSTILE = '=HYPERLINK("http://x";"y")'


@pytest.mark.parametrize("length", LENGTH_UNITS)
def test_a_sheet_comes_back_as_it_was_filled_in(length: str, tmp_path: Path) -> None:
    named = replace(BOX, object_number=HOSTILE, title="+1-1", gallery="=East")
    path = tmp_path / "survey.xlsx"
    request = surveyed(named)
    assert write_survey(path, request, measurables(), length=length) == {"objects": 1, "quantities": 1, "waste": 0}
    book = openpyxl.load_workbook(path)
    sheet = book[sheet_title(length)]
    keys = [cell.value for cell in sheet[HEADER_ROW]]
    assert sheet.cell(HEADER_ROW + 1, 1).data_type == "s"
    sheet.cell(HEADER_ROW + 1, keys.index("friction") + 1).value = 0.31
    book.save(path)
    (item,) = read_sheet(path).items
    assert (item.object_number, item.gallery, item.friction, item.problems) == (HOSTILE, "=East", 0.31, ())


def test_lengths_are_read_in_the_unit_of_the_sheet(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    sheet = book.create_sheet(sheet_title("in"))
    sheet.append(["Object", "Gallery", "Free distance"])
    sheet.append(["object_number", "gallery", column_name("clearance_m", "in")])
    sheet.append(["1", "East", 10])
    book.save(tmp_path / "survey.xlsx")
    (item,) = read_sheet(tmp_path / "survey.xlsx").items
    assert item.clearance_m == 0.254


@pytest.mark.parametrize(
    ("length", "column", "cell", "kilograms"),
    [
        ("in", "mass [lb]", "10", 4.5359237),
        ("ft", "mass [lb]", "10 1/2", 4.762719885),
        ("in", "mass [lb]", "4 kg", 4.0),
        ("in", "mass [lb]", "2 lb 8 oz", 1.133980925),
        ("cm", "mass_kg", "10", 10.0),
        ("cm", "mass_kg", "10 lb", 4.5359237),
        # As workbooks were written before they asked for pounds.
        ("in", "mass_kg", "10", 10.0),
    ],
)
def test_masses_are_in_pounds_beside_inches(
    length: str, column: str, cell: str, kilograms: float, tmp_path: Path
) -> None:
    assert length == "cm" or column_name("mass_kg", length) == "mass [lb]"
    book = openpyxl.Workbook()
    sheet = book.create_sheet(sheet_title(length))
    sheet.append(["Object", "Gallery", "Mass"])
    sheet.append(["object_number", "gallery", column])
    sheet.append(["1", "East", cell])
    book.save(tmp_path / "survey.xlsx")
    (item,) = read_sheet(tmp_path / "survey.xlsx").items
    assert (item.mass_kg, item.problems) == (pytest.approx(kilograms), ())


def test_what_a_mass_is_taken_as_is_told_in_the_unit_that_is_asked_for(tmp_path: Path) -> None:
    asked = MeasurementRequest("1", "East", "Box", "mass_kg", "kg", 4.5359237, 6.0, 9.0718474, "", 1, 0.5, 0)
    write_survey(tmp_path / "s.xlsx", [asked], measurables(), length="in")
    sheet = openpyxl.load_workbook(tmp_path / "s.xlsx")[sheet_title("in")]
    labels, names, row = ([cell.value for cell in line] for line in sheet.iter_rows(min_row=1, max_row=3))
    assert ("Mass (lb)", "mass [lb]") in zip(labels, names, strict=True)
    assert "taken as 10 to 20 lb now" in row[-1]


def test_a_workbook_that_is_no_survey_is_refused(tmp_path: Path) -> None:
    openpyxl.Workbook().save(tmp_path / "other.xlsx")
    with pytest.raises(CollectionError, match=r"other\.xlsx: no sheet of a survey, such as 'survey in cm'"):
        read_sheet(tmp_path / "other.xlsx")


def made(*items: Item, source: str = "a.csv", sha256: str = "0" * 64) -> Reading:
    return Reading(items, len(items), (), source, sha256, "m", "M")


def test_measurements_stay_through_later_imports(tmp_path: Path) -> None:
    (tmp_path / "kouros.toml").write_text("", encoding="utf-8")
    engine = open_workspace(load_settings(tmp_path / "kouros.toml")).engine
    plain = Item("1", "East", height_m=0.2)
    replace_inventory(engine, made(plain, Item("2", "East")))
    with pytest.raises(CollectionError, match="no row fills in anything for an object of the inventory"):
        add_sheet(engine, made(Item("1", "East"), source="s.xlsx"))
    changes, unknown = add_sheet(
        engine, made(Item("1", "", clearance_m=0.1, friction=0.4), Item("9", "", friction=1.0))
    )
    assert set(changes.changed["1"]) == {"clearance_m", "friction"}
    assert unknown == ["9"]
    # A later sheet's cell replaces an earlier one's; what it leaves empty stays.
    add_sheet(engine, made(Item("1", "", friction=0.5), source="s2.xlsx"))
    # The museum's file comes again, now with a friction of its own.
    replace_inventory(engine, made(replace(plain, friction=0.2, title="New"), Item("2", "East"), sha256="1" * 64))
    first, second = read_inventory(engine)
    assert (first.title, first.clearance_m, first.friction, first.height_m) == ("New", 0.1, 0.5, 0.2)
    (problem,) = first.problems
    assert "the museum's record says 0.2, the sheet s2.xlsx says 0.5, which is used" in problem.message
    assert second == Item("2", "East")
    assert [info.kind for info in versions(engine)] == ["import", "sheet", "sheet", "import"]
    # Going back takes the sheets of later versions away as well.
    return_to(engine, versions(engine)[-1].id)
    replace_inventory(engine, made(replace(plain, title="Newer"), Item("2", "East"), sha256="2" * 64))
    assert read_inventory(engine)[0] == replace(plain, title="Newer")


def test_a_filled_in_number_says_which_sheet_it_is_from(tmp_path: Path) -> None:
    (tmp_path / "kouros.toml").write_text("", encoding="utf-8")
    engine = open_workspace(load_settings(tmp_path / "kouros.toml")).engine
    replace_inventory(engine, made(Item("1", "East")))
    sheet = tmp_path / "ours.csv"
    sheet.write_text("object_number,gallery,clearance_m\n1,East,0.25\n", encoding="utf-8")
    add_sheet(engine, read_sheet(sheet))
    ((item),) = read_inventory(engine)
    (told,) = item.provenance
    assert (told.field, told.origin, told.written, told.note) == (
        "clearance_m",
        Origin.MEASURED,
        "0.25 m",
        "sheet ours.csv",
    )


def test_what_is_open_on_an_isolator_is_not_tried_without_it() -> None:
    """Its models run on what the isolator passes on; tried on the floor, it would wrongly settle nothing."""
    springs = InstalledMeasure(
        "horizontal_isolator", {"frequency": 0.5, "damping": 0.02, "friction": 0.05, "stroke": 0.3}, "Ann"
    )
    stands = placed(classify(BOX), [springs])
    _, (own,) = assess([stands.scene], LEVELS, Context(Threads(1)))
    _, (free,) = assess([classify(BOX)], LEVELS, Context(Threads(1)))
    above = [f for f in free if f.verdict is Verdict.UNDETERMINED]
    assert above
    assert measurement_requests([stands.scene], [[*own, *above]], LEVELS, Context(Threads(1))) == []
