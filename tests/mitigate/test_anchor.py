"""Furniture that is not fastened and may fall: it is advised to be fastened, alone or with what else is needed."""

from csv import DictWriter
from dataclasses import replace
from functools import cache
from pathlib import Path

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.furniture import filter_of
from pipeline.analysis.rule_table import with_own
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.mitigate.installed import InstalledMeasure, assess_above, placed
from pipeline.mitigate.saying import ANCHORED
from pipeline.mitigate.search import advise
from pipeline.motions import read_motion
from pipeline.records import Anchorage, Finding, Furniture, Item, Motion, Scene, Support, Verdict
from pipeline.records.numerics import HISTORIES
from pipeline.resources import resource
from pipeline.tables import table
from pipeline.tables.assumed import assumed_with

from .scenes import BLOCK, TOWER

CUP = Item("1", "G", title="Bowl", object_name="Bowl", support=Support.FREESTANDING, height_m=0.06, width_m=0.3,
           depth_m=0.3, base_width_m=0.3, base_depth_m=0.3, cg_height_m=0.03, mass_kg=1.0, friction=5.0,
           clearance_m=0.3, susceptible=False, furniture=Furniture.SHOWCASE,
           furniture_anchorage=Anchorage.UNANCHORED)  # fmt: skip
"""Squat and rough: whatever happens to it is its furniture's doing."""


@cache
def shaking() -> LevelMotions:
    """The strongest part of the demonstration's record."""
    demo = read_motion(resource("site_motions", "demo"))[0]
    part = demo.acceleration[:, round(15.0 / demo.dt) : round(30.0 / demo.dt)]
    return LevelMotions("design", "max", (Motion(demo.dt, part, "strong"),))


def notes(scene: Scene) -> list[str]:
    return [one.note for one in scene.parameters.values()]


def _itself(finding: Finding) -> bool:
    return finding.model == "unanchored"


def test_furniture_that_may_fall_is_advised_to_be_fastened() -> None:
    """The bowl itself passes in the same case fastened; installed, its furniture is judged no more."""
    scene, levels = classify(CUP), [shaking()]
    _, findings = assess([scene], levels, Context(Threads(1)))
    assert {one.verdict for one in findings[0] if _itself(one)} == {Verdict.UNDETERMINED}
    ((advice,),) = advise([scene], findings, levels, Context(Threads(1)))
    assert advice.measure == "anchor"
    after = placed(scene, [InstalledMeasure("anchor", {}, "Ann")]).scene
    assert after.anchorage is Anchorage.ANCHORED
    assert filter_of(after) == filter_of(classify(replace(CUP, furniture_anchorage=None)))
    assert not [text for text in after.assumptions if "friction on its floor" in text]
    assert [text for text in scene.assumptions if text.endswith("; not fastened, as recorded")]
    assert not [text for text in (*after.assumptions, *notes(after)) if "not fastened" in text]


def _placed_in_a_narrow_case(item: Item, folder: Path) -> Scene:
    """Return it in a case of the museum's that falls unless it is fastened."""
    row = next(row for row in table("furniture") if row["furniture"] == "showcase")
    narrow = {"half_width": "0.1", "cg_height": "1", "friction": "0.8"}
    cells = {f"{name}{end}": value for name, value in narrow.items() for end in ("", "_low", "_high")}
    file = folder / "narrow.csv"
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = DictWriter(stream, row)
        writer.writeheader()
        writer.writerow(row | cells)
    return classify(item, with_own(None, assumed_with({"furniture": file})))


def test_what_helps_only_in_fastened_furniture_is_advised_with_that(tmp_path: Path) -> None:
    """A slippery bowl without room in a case of the museum's that falls: held, and its case fastened besides."""
    scene = _placed_in_a_narrow_case(replace(CUP, friction=0.05, clearance_m=0.001), tmp_path)
    levels = [shaking()]
    _, findings = assess([scene], levels, Context(Threads(1)))
    (falls,) = (one for one in findings[0] if _itself(one))
    assert (falls.verdict, falls.outcome) == (Verdict.FAIL, "overturns with its furniture")
    assert "falls over after" in falls.sentence
    ((advice,),) = advise([scene], findings, levels, Context(Threads(1)))
    assert advice.measure not in ("anchor", "remove")
    assert advice.sentence.startswith(ANCHORED)


def test_an_isolator_for_fastened_furniture_is_for_all_that_stand_in_it(tmp_path: Path) -> None:
    """The bowl only wants its case fastened: it is a part of the tower's load all the same, 20 kg and 1 kg."""
    tower = replace(TOWER, object_number="A", allowable_stress_pa=2e5, case="X", furniture=CUP.furniture,
                    furniture_anchorage=CUP.furniture_anchorage)  # fmt: skip
    bowl = replace(CUP, object_number="C", case="X", frequency_hz=tower.frequency_hz)
    scenes, levels = [_placed_in_a_narrow_case(one, tmp_path) for one in (tower, bowl)], [shaking()]
    _, findings = assess(scenes, levels, Context(Threads(1)))
    (of_tower,), (of_bowl,) = advise(scenes, findings, levels, Context(Threads(1)))
    assert of_tower.measure == "horizontal_isolator"
    assert of_tower.sentence.startswith(f"{ANCHORED} Put case X, with C in it, on a horizontal isolator")
    assert of_tower.parameters["load"] == tower.mass_kg + bowl.mass_kg
    assert of_bowl.measure == "anchor"


def test_furniture_under_a_pad_is_judged_once() -> None:
    """A pad is tried on the floor twice, and installed run with what stands on it: its furniture is the same."""
    weak = LevelMotions("design", "max", (shaking().motions[0].scaled(0.35, "weak"),))
    item = replace(BLOCK, clearance_m=0.0005, furniture=CUP.furniture, furniture_anchorage=CUP.furniture_anchorage)
    scene, own = classify(item), own_catalogue()
    pads = replace(
        own, measures=tuple(one for one in own.measures if one.name == "friction_isolator" or one.last_resort)
    )
    _, findings = assess([scene], [weak], Context(Threads(1)))
    ((advice,),) = advise([scene], findings, [weak], Context(Threads(1)), catalogue=pads)
    assert advice.measure == "friction_isolator"
    assert [check.model for check in advice.checks] == ["rocking", "unanchored", "friction_isolator", "stress"]
    pad = placed(scene, [InstalledMeasure(advice.measure, advice.parameters, "Ann")])
    _, below = assess([pad.scene], [weak], Context(Threads(1)))
    ((above, _),) = assess_above([pad], [weak], Context(Threads(1)), HISTORIES)
    assert [finding.model for finding in (*below[0], *above)].count("unanchored") == 1


def test_what_helps_in_fastened_furniture_stands_beside_what_is_found_now(tmp_path: Path) -> None:
    """A bowl that rests in its loose case slides in the fastened one: fastening it is not enough."""
    scene, levels = _placed_in_a_narrow_case(replace(CUP, friction=0.5, clearance_m=0.003), tmp_path), [shaking()]
    _, findings = assess([scene], levels, Context(Threads(1)))
    ((advice,),) = advise([scene], findings, levels, Context(Threads(1)))
    assert advice.measure == "clearance"
    assert advice.sentence.startswith(ANCHORED)
    (now,) = (one for one in findings[0] if one.model == "sliding")
    (check,) = (check for check in advice.checks if check.model == "sliding")
    assert check.before == now.demand == 0.0
    assert check.demand > 0.0
    assert [text.partition(":")[0] for text in advice.rejected] == ["Fasten its furniture"]
    assert "sliding" in advice.rejected[0]
