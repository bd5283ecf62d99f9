"""Furniture that is not fastened to its floor: a `standing` body, which fails if it falls over.

That it slides or rocks is no failure of its own: what it passes on then to the objects in it is judged with them
(`pipeline.analysis.loose`).
"""

from collections.abc import Mapping
from dataclasses import replace

from pipeline.models.common import N_, needs
from pipeline.models.rigid_body import HALF, OVERTURNS
from pipeline.models.standing import STANDING
from pipeline.records import Scene

FALLS = "overturns with its furniture"

ABOUT = "This is about what it stands in, which is not fastened: it fails if that furniture itself falls over."


def _applies(scene: Scene) -> str:
    # Only furniture has it among its models: an object is never tried with it.
    if UNANCHORED.name not in scene.models:
        return N_("it is about furniture that is not fastened")
    return needs(scene, "half_width", "cg_height", "friction_static")


def _outcome(row: Mapping[str, float], parameters: Mapping[str, float]) -> tuple[str, str]:
    word, sentence = STANDING.outcome(row, parameters)
    return FALLS if word == OVERTURNS else word, sentence


UNANCHORED = replace(
    STANDING,
    name="unanchored",
    title="Tipping of its furniture",
    sentence=ABOUT,
    fails=FALLS,
    applies=_applies,
    otherwise=lambda _scene: ("overturned", HALF, ABOUT),
    outcome=_outcome,
    mark=lambda _parameters, _demand: None,
    supports=(),
    tips=False,
    says=(FALLS,),
)
