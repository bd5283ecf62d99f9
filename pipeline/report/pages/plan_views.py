"""The plan of a gallery as plain data: what stands where, and the lines between neighbours that may meet."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pipeline.report.pages.judging import SpacingView
from pipeline.report.pages.views import ObjectView, State


@dataclass(frozen=True, slots=True)
class PlaceView:
    """A row of the plan's table: the number on the plan, the object, and where it stands, in the reader's units."""

    number: int
    object: ObjectView
    position: str
    footprint: str
    clearance: str


@dataclass(frozen=True, slots=True)
class TightView:
    """A line on a plan between two neighbours that may meet: from, to (pixels), and what is known of their gap."""

    x1: float
    y1: float
    x2: float
    y2: float
    spacing: SpacingView


@dataclass(frozen=True, slots=True)
class PlanView:
    """A gallery to scale: the drawing, its legend in rows, and how many objects have no recorded position.

    ground, objects : the drawing in two parts, between which lines may be drawn
    centres         : of what stands there, by object number, in the drawing's pixels; without numbers that stand twice
    """

    ground: str
    objects: str
    places: tuple[PlaceView, ...]
    missing: int
    centres: Mapping[str, tuple[float, float]]

    @property
    def svg(self) -> str:
        """The drawing without lines between neighbours."""
        return self.ground + self.objects

    def tight(self, spacings: Sequence[SpacingView]) -> tuple[TightView, ...]:
        """Return the lines between neighbours that may meet: each pair once, as it stands at its worst level.

        spacings : the worst first
        """
        pairs = {(s.first, s.second): s for s in reversed(spacings) if s.state != State.SAFE}
        return tuple(
            TightView(*self.centres[s.first], *self.centres[s.second], s)
            for s in reversed(pairs.values())
            if s.first in self.centres and s.second in self.centres
        )
