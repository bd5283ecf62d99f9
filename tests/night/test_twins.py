"""What is found of one object holds for all that are like it, that night and, where nothing else changed, later."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest
from pipeline.execute.crew import Alone
from pipeline.night.deduplication import Twins, as_own, likeness

from pipeline.analysis.classify import classify
from pipeline.analysis.response_charts import Shelf
from pipeline.collection.listing import Listed, Listing
from pipeline.collection.object_index import object_index
from pipeline.collection.record import assessment_digest_of
from pipeline.mitigate.installed import Placed
from pipeline.models import model_named
from pipeline.night import assessment as assessing
from pipeline.night import scheduler as rounds
from pipeline.night.importing import import_collection
from pipeline.night.prepare import popular
from pipeline.night.units import Part
from pipeline.operations.workspace import HISTORIES, open_workspace
from pipeline.records import Assessment, Item, Problem, Provenance, Support
from pipeline.records.scene import Origin
from pipeline.settings import load_settings
from tests.night.test_unchanged_nights import found, museum, night, rows, write

CUP = Item(
    "1", "Room 1", title="Cup", object_name="cup", medium="earthenware", height_m=0.1, width_m=0.08, depth_m=0.08
)


def like(**changes: object) -> object:
    return likeness(classify(replace(CUP, **changes)))


@pytest.mark.parametrize(
    "changes",
    [
        {"object_number": "2"},
        {"gallery": "Room 2"},
        {"title": "A cup"},
        {"position_x_m": 1.0, "position_y_m": 2.0},
        {"value_class": "A"},
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


def test_of_too_many_kinds_the_first_are_forgotten() -> None:
    twins = Twins(most=2)
    scene = classify(CUP)
    for kind in "abc":
        twins.note(kind, Assessment(scene, (), ()), {})
    assert twins.get("a") is None
    assert twins.get("c") is not None


@pytest.fixture
def assessed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The numbers of the objects that anything was run for."""
    numbers: list[str] = []
    true = assessing._assessed

    def noted(brief: assessing.Brief, storey: assessing.Storey, objects: list[Placed]) -> list[assessing.Known]:
        numbers.extend(one.scene.item.object_number for one in objects)
        return true(brief, storey, objects)

    monkeypatch.setattr(assessing, "_assessed", noted)
    return numbers


def set_of_vases() -> list[dict[str, str]]:
    """Three rooms with four vases each, of four sizes in all."""
    return [row | {"width_m": "0.12"} for row in rows()]


def test_a_set_is_worked_on_once_and_shown_as_if_each_had_been(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum(tmp_path / "set", set_of_vases())
    night(settings)
    assert assessed == ["0.0", "0.1", "0.2", "0.3"]
    together = found(settings)
    for one in together.assessments:
        assert all(f.object_number == one.scene.item.object_number for f in (*one.findings, *one.recommendations))
        assert all(f.gallery == one.scene.item.gallery for f in (*one.findings, *one.recommendations))
    # Each in a museum of its own, where nothing is like it.
    for number, row in ((5, set_of_vases()[5]), (10, set_of_vases()[10])):
        alone = museum(tmp_path / f"alone-{number}", [row])
        night(alone)
        (own,) = found(alone).assessments
        assert own == together.assessments[number]


def test_of_a_changed_sheet_only_what_changed_is_worked_on(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum(tmp_path / "museum", rows())
    night(settings)
    assessed.clear()
    objects = rows()
    objects[5]["height_m"] = "0.9"
    objects[6]["title"] = "A vase with another title"
    write(settings.home, objects)
    summary = night(settings)
    assert summary.fresh == 4
    assert assessed == ["1.1"]
    fresh = museum(tmp_path / "fresh", objects)
    night(fresh)
    assert found(settings) == found(fresh)


def test_under_other_shaking_or_other_settings_nothing_is_taken_over(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum(tmp_path / "museum", rows())
    night(settings)
    assessed.clear()
    manifest = settings.home / "site" / "manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.6"), encoding="utf-8")
    night(settings)
    assert len(assessed) == 12
    assessed.clear()
    file = settings.home / "kouros.toml"
    told = file.read_text(encoding="utf-8")
    assert "azimuth_step = 10.0" in told
    file.write_text(told.replace("azimuth_step = 10.0", "azimuth_step = 15.0"), encoding="utf-8")
    night(load_settings(file))
    assert len(assessed) == 12


def test_why_models_were_left_out_is_taken_over_too() -> None:
    scene = replace(classify(CUP), skipped={"Stress": "it is whole"})
    twin = classify(replace(CUP, object_number="2", gallery="Room 2"))
    assert as_own(twin, Assessment(scene, (), ())).scene == replace(twin, skipped={"Stress": "it is whole"})


class Pair(Alone):
    """Two who work, one after the other in this process, so that it can be seen what each is given."""

    workers = 2


@pytest.fixture
def pair(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rounds, "FEW", 0)
    monkeypatch.setattr(rounds, "BATCH", 4)
    monkeypatch.setattr(rounds, "KIND_BATCH", 1)
    monkeypatch.setattr(rounds, "crew", lambda **_: nullcontext(Pair()))


@pytest.mark.usefixtures("pair")
def test_where_several_work_what_holds_for_many_is_found_before_the_sheets(tmp_path: Path, assessed: list[str]) -> None:
    settings = museum(tmp_path / "set", set_of_vases())
    execution = settings.execution.model_copy(update={"processes": 2})
    settings = settings.model_copy(update={"execution": execution})
    night(settings)
    assert sorted(assessed) == ["0.0", "0.1", "0.2", "0.3"]
    kept = settings.kept / HISTORIES
    parts = {file.name for file in kept.iterdir()}
    # The next night's parts are the same, whatever else changed.
    write(settings.home, [*set_of_vases(), set_of_vases()[0] | {"object_number": "9.9", "height_m": "0.77"}])
    night(settings)
    assert sorted(assessed) == ["0.0", "0.1", "0.2", "0.3", "9.9"]
    assert parts <= {file.name for file in kept.iterdir()}


def listed(number: str, kind: int, case: str = "") -> Listed:
    return Listed(number, "Room", case, True, number, str(kind))


def piece(*objects: Listed, floor: str = "") -> rounds._Piece:
    return rounds._Piece(Part("Room", True, 1, 1, Listing.of(objects)), floor, "basis", "key", (), None)


def test_which_kinds_are_found_beforehand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of more than one object, the most frequent first; all of them where all can be remembered."""
    first = piece(listed("1", 7), listed("2", 8), listed("3", 7), listed("5", 9, case="A"))
    second = piece(listed("6", 8), listed("7", 8), listed("8", 5), listed("9", 9))
    upstairs = piece(listed("10", 7), floor="Upstairs")
    every = rounds._frequent([first, second, upstairs], ())
    assert every == {"": {"8": "2", "7": "1", "9": "9", "5": "8"}, "Upstairs": {"7": "10"}}
    # What a decision changes is the object's own.
    assert rounds._frequent([first, second], {"1", "8"}) == {"": {"8": "2", "7": "3", "9": "9"}}
    monkeypatch.setattr(rounds, "KINDS", 4)
    assert rounds._frequent([first, second, upstairs], ()) == {"": {"8": "2", "7": "1"}}
    monkeypatch.setattr(rounds, "KINDS", 1)
    assert rounds._frequent([first, second, upstairs], ()) == {"": {"8": "2"}}


def test_a_kind_is_what_the_record_says_but_for_what_is_the_objects_own() -> None:
    assert assessment_digest_of(CUP) == assessment_digest_of(
        replace(CUP, object_number="2", gallery="R", value_class="A", problems=(Problem("a", "b"),))
    )
    others = [replace(CUP, height_m=0.11), replace(CUP, medium="glass"), replace(CUP, on_display=False)]
    kinds = {assessment_digest_of(one) for one in (CUP, *others)}
    assert len(kinds) == 4


def test_pads_have_a_chart_where_many_works_hang_on_walls(tmp_path: Path) -> None:
    """Whoever works on which sheets: what is looked up in a chart must not hang on that."""
    settings = museum(tmp_path / "walls", rows(1, 1))
    workspace = open_workspace(settings)

    def names(count: int) -> set[float]:
        hung = [
            {"object_number": f"P.{n}", "object_name": "painting", "gallery": "Room", "height_m": f"{0.3 + n / 3000}"}
            | {"width_m": "0.5", "depth_m": "0.04", "medium": "oil on canvas"}
            for n in range(count)
        ]
        write(settings.home, hung)
        import_collection(workspace, settings.home / "collection.csv", "kouros", shrink_limit=1.0)
        everything = object_index(workspace.engine)
        found = popular(everything, everything.objects, workspace.rules, workspace.measures, 90.0)
        return {alike["damping"] for model, _, alike in found.values() if model.name == "swing"}

    assert names(500) == set()
    # At the ends of both, length and damping: each end of the damping has a chart.
    assert names(1_400) == {0.02, 0.13}
    assert names(5_000) == {0.02, 0.06, 0.13}


def test_a_shelf_that_was_told_what_pays_asks_nobody_else() -> None:
    swing = model_named("swing").chart
    assert swing is not None
    assert Shelf(admitted=frozenset({"a"})).pays("a", "key", swing, 1, 400)
    assert not Shelf(admitted=frozenset({"a"})).pays("b", "key", swing, 10_000, 400)
    assert Shelf().pays("b", "key", swing, 10_000, 400)
