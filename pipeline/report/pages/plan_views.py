"""The plan of a gallery as plain data: what stands where, and the lines between neighbours that may meet."""

from dataclasses import dataclass

from markupsafe import Markup

from pipeline.report.pages.judging import SpacingView
from pipeline.report.pages.views import ObjectView


@dataclass(frozen=True, slots=True)
class PlaceView:
    """A row of the plan's table: the number on the plan, the object, and where it stands, in the reader's units."""

    number: int
    object: ObjectView
    position: str
    footprint: str
    clearance: str


@dataclass(frozen=True, slots=True)
class GalleryPlanView:
    """A gallery to scale: the drawing, its legend in rows, and how many objects have no recorded position.

    tight : the neighbours between which a line is drawn, for they may meet: each pair once, as it is at its worst level
    """

    svg: Markup
    places: tuple[PlaceView, ...]
    missing: int
    tight: tuple[SpacingView, ...]
