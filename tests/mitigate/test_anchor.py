"""Furniture that is not fastened and may fall: it is advised to be fastened, alone or with what else is needed."""

from csv import DictWriter
from dataclasses import replace
from functools import cache
from pathlib import Path

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.furniture import filter_of
from pipeline.analysis.rules import with_own
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate.installed import InstalledMeasure, placed
from pipeline.mitigate.search import ANCHORED, advise
from pipeline.motions import read_motion
from pipeline.records import Anchorage, Finding, Furniture, Item, Motion, Support, Verdict
from pipeline.resources import resource
from pipeline.tables import table
from pipeline.tables.assumed import assumed_with

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


def test_what_helps_only_in_fastened_furniture_is_advised_with_that(tmp_path: Path) -> None:
    """A slippery bowl without room in a case of the museum's that falls: held, and its case fastened besides."""
    row = next(row for row in table("furniture") if row["furniture"] == "showcase")
    narrow = {"half_width": "0.1", "cg_height": "1", "friction": "0.8"}
    cells = {f"{name}{end}": value for name, value in narrow.items() for end in ("", "_low", "_high")}
    file = tmp_path / "narrow.csv"
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = DictWriter(stream, row)
        writer.writeheader()
        writer.writerow(row | cells)
    item = replace(CUP, friction=0.05, clearance_m=0.001)
    scene, levels = classify(item, with_own(None, assumed_with({"furniture": file}))), [shaking()]
    _, findings = assess([scene], levels, Context(Threads(1)))
    (falls,) = (one for one in findings[0] if _itself(one))
    assert (falls.verdict, falls.outcome) == (Verdict.FAIL, "overturns with its furniture")
    assert "falls over after" in falls.sentence
    ((advice,),) = advise([scene], findings, levels, Context(Threads(1)))
    assert advice.measure not in ("anchor", "remove")
    assert advice.sentence.startswith(ANCHORED)
