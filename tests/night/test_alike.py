"""What is found of one object holds for all that are like it, that night and, where nothing else changed, later."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.response_charts import ChartCache
from pipeline.cache import HISTORIES
from pipeline.collection.object_index import object_index, read_packed
from pipeline.collection.record import assessment_digest_of
from pipeline.execute.pool import SerialPool
from pipeline.mitigate.installed import Placed
from pipeline.models import model_named
from pipeline.night import assessment as assessing
from pipeline.night import scheduler, staff
from pipeline.night.assessment import Assessed, likeness
from pipeline.night.context import RunContext
from pipeline.night.floors import Floor
from pipeline.night.importing import import_collection
from pipeline.night.prepare import popular
from pipeline.night.unit_tasks import Assessments, UnitTask
from pipeline.operations.workspace import open_workspace
from pipeline.records import Assessment, Furniture, Item, Problem, Provenance, Support
from pipeline.records.scene import Origin
from pipeline.settings import load_settings
from tests.museum import found, museum_of, night, vases, write_collection
from tests.night.changing import leave_out_pages
from tests.soak import SOAK

pytestmark = pytest.mark.slow_file

CUP = Item(
    "1", "Room 1", title="Cup", object_name="cup", medium="earthenware", height_m=0.1, width_m=0.08, depth_m=0.08
)


@pytest.fixture(autouse=True)
def without_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out what costs most of a small night, and is looked at elsewhere."""
    leave_out_pages(monkeypatch)


def like(**changes: object) -> object:
    return likeness(Placed(classify(replace(CUP, **changes))))


@pytest.mark.parametrize(
    "changes",
    [
        {"object_number": "2"},
        {"gallery": "Room 2"},
        {"title": "A cup"},
        {"position_x_m": 1.0, "position_y_m": 2.0},
        {"value": 5e6},
        {"on_loan": True},
        {"provenance": (Provenance("height_m", Origin.MEASURED, "10 cm"),)},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_what_tells_one_from_another_does_not_make_them_unlike(changes: dict[str, object]) -> None:
    assert like(**changes) == like()


@pytest.mark.parametrize(
    "changes",
    [
        {"height_m": 0.11},
        {"mass_kg": 0.3},
        {"medium": "glass"},
        {"orientation_deg": 30.0},
        {"susceptible": False},
        {"on_display": False},
        {"condition": 0.8},
        {"clearance_m": 0.02},
        {"support": Support.FASTENED},
        {"object_name": "statue"},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_what_anything_computed_rests_on_does(changes: dict[str, object]) -> None:
    assert like(**changes) != like()


def test_company_counts_in_a_case_and_on_an_isolator() -> None:
    assert like(case="A") is None
    assert like(support=Support.ISOLATED, isolator="friction_isolator") is None


@pytest.fixture
def assessed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The numbers of the objects that anything was run for."""
    numbers: list[str] = []
    true = assessing._assessed

    def noted(
        context: RunContext, floor: Floor, objects: list[Placed], working: Context
    ) -> list[tuple[Assessment, dict[str, int]]]:
        numbers.extend(one.scene.item.object_number for one in objects)
        return true(context, floor, objects, working)

    monkeypatch.setattr(assessing, "_assessed", noted)
    return numbers


def set_of_vases() -> list[dict[str, str]]:
    """Three rooms with four vases each, of four sizes in all."""
    return [row | {"width_m": "0.12"} for row in vases()]


def test_a_set_is_worked_on_once_and_shown_as_if_each_had_been(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum_of(tmp_path / "set", set_of_vases(), furnished=True, sampled=True)
    night(settings)
    assert sorted(number.partition(".")[2] for number in assessed) == ["0", "1", "2", "3"]
    together = found(settings)
    for one in together.assessments:
        assert all(f.object_number == one.scene.item.object_number for f in (*one.findings, *one.recommendations))
        assert all(f.gallery == one.scene.item.gallery for f in (*one.findings, *one.recommendations))
    # Each in a museum of its own, where nothing is like it.
    for number, row in ((5, set_of_vases()[5]), (10, set_of_vases()[10])):
        alone = museum_of(tmp_path / f"alone-{number}", [row], furnished=True, sampled=True)
        night(alone)
        (own,) = found(alone).assessments
        assert own == together.assessments[number]


@pytest.mark.long("night/test_unchanged_nights::test_one_changed_object_costs_only_itself_and_the_rest_is_taken_over")
def test_of_a_changed_gallery_only_what_changed_is_worked_on(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum_of(tmp_path / "museum", vases(2), sampled=True)
    night(settings)
    assessed.clear()
    objects = vases(2)
    objects[5]["height_m"] = "0.9"
    objects[6]["title"] = "A vase with another title"
    write_collection(settings.home, objects)
    summary = night(settings)
    # Titles are looked at to class objects.
    assert summary.fresh == 2
    assert sorted(assessed) == ["1.1", "1.2"]
    fresh = museum_of(tmp_path / "fresh", objects, sampled=True)
    night(fresh)
    assert found(settings) == found(fresh)


@pytest.mark.long("night/test_keys_of_units::test_what_a_change_costs")
def test_under_other_shaking_or_other_settings_nothing_is_taken_over(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum_of(tmp_path / "museum", vases(1), sampled=True)
    night(settings)
    assessed.clear()
    manifest = settings.home / "site" / "manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.6"), encoding="utf-8")
    night(settings)
    assert len(assessed) == 4
    assessed.clear()
    file = settings.home / "kouros.toml"
    told = file.read_text(encoding="utf-8")
    assert "azimuth_step = 10.0" in told
    file.write_text(told.replace("azimuth_step = 10.0", "azimuth_step = 15.0"), encoding="utf-8")
    night(load_settings(file))
    assert len(assessed) == 4


def test_why_models_were_left_out_is_taken_over_too() -> None:
    scene = replace(classify(CUP), skipped={"Stress": "it is whole"})
    twin = classify(replace(CUP, object_number="2", gallery="Room 2"))
    own = assessing._as_own(twin, Assessed(Assessment(scene, (), ()), {}))
    assert own.assessment.scene == replace(twin, skipped={"Stress": "it is whole"})


class Pair(SerialPool):
    """Two who work, one after the other in this process, so that it can be seen what each is given."""

    workers = 2


@pytest.fixture
def pair(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (scheduler, staff):
        monkeypatch.setattr(module, "FEW", 0)
    monkeypatch.setattr(staff, "SHOWN", 0)
    for limit in ("BATCH", "WHOLE"):
        monkeypatch.setattr(scheduler, limit, 2)
    monkeypatch.setattr(staff, "pool", lambda **_: nullcontext(Pair()))


@pytest.mark.long("test_a_set_is_worked_on_once_and_shown_as_if_each_had_been")
@pytest.mark.usefixtures("pair")
def test_where_several_work_what_is_alike_is_still_worked_on_once(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum_of(tmp_path / "set", set_of_vases(), furnished=True, sampled=True)
    night(settings)
    assert sorted(number.partition(".")[2] for number in assessed) == ["0", "1", "2", "3"]
    batches = {file.name for file in (settings.kept / HISTORIES).iterdir()}
    assessed.clear()
    write_collection(settings.home, [*set_of_vases(), set_of_vases()[0] | {"object_number": "9.9", "height_m": "0.77"}])
    night(settings)
    assert assessed == ["9.9"]
    # What is run for one object does not take the place of what was run for all.
    assert {file.name for file in (settings.kept / HISTORIES).iterdir()} == batches


@pytest.mark.usefixtures("pair")
def test_what_is_worked_on_together_stands_in_the_same_furniture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the record or as is usual for its class, in parts of two units or so, none of them twice and none left out."""
    told = [("pedestal", "Vase"), ("shelf", "Vase"), ("", "Cabinet"), ("", "Vase")]
    rows = []
    for at, row in enumerate(vases(galleries=2, each=8)):
        furniture, name = told[at % len(told)]
        height = (0.2 if name == "Vase" else 1.2) + 0.01 * at
        rows.append(
            row | {"furniture": furniture, "title": name, "object_name": name, "height_m": str(round(height, 3))}
        )
    given: list[list[Item]] = []

    def assess_units(context: RunContext, task: UnitTask) -> Assessments:
        given.append(read_packed(task.records))
        return true(context, task)

    true = scheduler.assess_units
    monkeypatch.setattr(scheduler, "assess_units", assess_units)
    settings = museum_of(tmp_path / "museum", rows, furnished=True, sampled=True)
    assert night(settings).fresh == len(rows)
    kinds = [{classify(item).furniture for item in some} for some in given]
    assert all(len(kind) == 1 for kind in kinds)
    assert set.union(*kinds) == {Furniture.PEDESTAL, Furniture.SHELF, Furniture.FLOOR, Furniture.SHOWCASE}
    assert len(given) > 4
    numbers = [item.object_number for some in given for item in some]
    assert sorted(numbers) == sorted(row["object_number"] for row in rows)


def test_a_kind_is_what_the_record_says_but_for_what_is_the_objects_own() -> None:
    assert assessment_digest_of(CUP) == assessment_digest_of(
        replace(CUP, object_number="2", gallery="R", value=4e4, on_loan=True, problems=(Problem("a", "b"),))
    )
    others = [replace(CUP, height_m=0.11), replace(CUP, medium="glass"), replace(CUP, on_display=False)]
    # What it is worth decides whether an isolator is in proportion.
    others += [replace(CUP, value_class="A"), replace(CUP, irreplaceable=True)]
    kinds = {assessment_digest_of(one) for one in (CUP, *others)}
    assert len(kinds) == 6


def test_pads_have_a_chart_where_many_works_hang_on_walls(tmp_path: Path) -> None:
    """Whoever works on which sheets: what is looked up in a chart must not hang on that."""
    settings = museum_of(tmp_path / "walls", vases(1, 1), sampled=True)
    workspace = open_workspace(settings)

    def names(count: int) -> set[float]:
        hung = [
            {"object_number": f"P.{n}", "object_name": "painting", "gallery": "Room", "height_m": f"{0.3 + n / 3000}"}
            | {"width_m": "0.5", "depth_m": "0.04", "medium": "oil on canvas"}
            for n in range(count)
        ]
        write_collection(settings.home, hung)
        import_collection(workspace, settings.home / "collection.csv", "kouros", shrink_limit=1.0)
        everything = object_index(workspace.engine)
        found = popular(everything, everything.objects, workspace.rules, workspace.measures, 90.0)
        return {alike["damping"] for model, _, alike in found.values() if model.name == "swing"}

    assert names(500) == set()
    # At the ends of both, length and damping: each end of the damping has a chart.
    assert names(1_400) == {0.02, 0.13}
    if SOAK:
        assert names(5_000) == {0.02, 0.06, 0.13}


def test_a_cache_of_charts_that_was_told_what_pays_asks_nobody_else() -> None:
    swing = model_named("swing").chart
    assert swing is not None
    assert ChartCache(admitted=frozenset({"a"})).pays("a", "key", swing, 1, 400)
    assert not ChartCache(admitted=frozenset({"a"})).pays("b", "key", swing, 10_000, 400)
    assert ChartCache().pays("b", "key", swing, 10_000, 400)
