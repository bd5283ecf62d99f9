"""Objects that one measure each is the answer for, and how they are advised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate import MeasureCatalogue, advise
from pipeline.motions import read_motion
from pipeline.records import Furniture, Item, Motion, Recommendation, Support
from pipeline.resources import resource


def demo_motion() -> Motion:
    """The main shock of the demonstration's record: 25 of 100 s, with the peaks of all, at a quarter of the cost."""
    whole = read_motion(resource("site_motions", "demo"))[0]
    return Motion(whole.dt, whole.acceleration[:, round(12.0 / whole.dt) : round(37.0 / whole.dt)], whole.name)


def solve_all(
    items: Sequence[Item], motions: Sequence[Motion], catalogue: MeasureCatalogue | None = None, combine: str = "max"
) -> list[list[Recommendation]]:
    scenes = [classify(item) for item in items]
    levels = [LevelMotions("design", combine, tuple(motions))]
    _, findings = assess(scenes, levels, Context(Threads(1)))
    return advise(scenes, findings, levels, Context(Threads(1)), catalogue=catalogue)


def solve(item: Item, motion: Motion, catalogue: MeasureCatalogue | None = None) -> Recommendation:
    ((only,),) = solve_all([item], [motion], catalogue)
    return only


def rejected(advice: Recommendation) -> Sequence[str]:
    return [text.partition(":")[0] for text in advice.rejected]


BLOCK = Item(
    "1", "G", title="Block", object_name="Trial body", support=Support.FREESTANDING, furniture=Furniture.FLOOR,
    height_m=0.2, width_m=0.6, depth_m=0.6, base_width_m=0.6,
    base_depth_m=0.6, cg_height_m=0.1, mass_kg=20.0, friction=0.1, clearance_m=0.02, section_shape="rectangle",
    section_width_m=0.3, section_depth_m=0.3, allowable_stress_pa=5e6, medium="Bronze", frequency_hz=60.0,
)  # fmt: skip
"""A squat block that never rocks under the demonstration's motion and slides about 5 cm.

Of a metal that does not break where its base is held, and so stiff that it moves as one piece.
"""

TOWER = replace(BLOCK, title="Tower", height_m=1.0, width_m=0.2, depth_m=0.2, base_width_m=0.2, base_depth_m=0.2,
                cg_height_m=0.5, friction=0.9, clearance_m=0.3, section_width_m=0.1, section_depth_m=0.1)  # fmt: skip
"""A slender one that falls over: its foot does not slide first."""

HEAVY = replace(TOWER, title="Heavy tower", mass_kg=500.0, allowable_stress_pa=5e7)
"""The same of half a tonne, which no fixing holds that is to be had, with a section that bears it."""

STUMP = replace(TOWER, title="Stump", height_m=0.3, cg_height_m=0.15, mass_kg=200.0)
"""Just too slender: b/h = 0.67 where 0.72 is pushed; too heavy for wax, putty, ties and clips."""

PICTURE = Item("2", "G", title="Picture", support=Support.HUNG, height_m=0.6, width_m=0.5, suspension_length_m=0.8,
               damping=0.02, clearance_m=0.05, mass_kg=8.0)  # fmt: skip
