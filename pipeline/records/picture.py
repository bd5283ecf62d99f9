"""Charts, what lies on them, and what stands on and under them."""

from __future__ import annotations

from dataclasses import dataclass

from pipeline.records.phrase import Clause


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis of a chart.

    Attributes
    ----------
    label : str
        As it is written beside it.
    unit : str
        SI unit of the data.
    scale : str
        "linear" or "log".
    """

    label: str
    unit: str
    scale: str = "linear"


@dataclass(frozen=True, slots=True)
class Curve:
    """A line of a chart.

    Attributes
    ----------
    label : str
        In the legend.
    x, y : tuple of float
        In the axes' units.
    """

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Zone:
    """A labelled region of a chart.

    Attributes
    ----------
    label : str
        What is written in it.
    x, y : tuple of float
        Corners of a closed polygon, in the axes' units.
    tone : str
        How it is judged: "safe", "warn", "danger".
    """

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    tone: str


@dataclass(frozen=True, slots=True)
class Chart:
    """A picture of one motion's effect, shared by all objects marked on it.

    Attributes
    ----------
    key : str
        Identity within a run, such as "stability:<motion hash>".
    title, caption, source : str
        As they are shown with it.
    x, y : Axis
        Its axes, with the units of everything on it.
    curves : tuple of Curve
        Its lines.
    zones : tuple of Zone
        Its regions.
    equal : bool
        Whether the two axes share one scale (a path on the floor).
    """

    key: str
    title: str
    caption: str
    x: Axis
    y: Axis
    curves: tuple[Curve, ...]
    zones: tuple[Zone, ...] = ()
    equal: bool = False
    source: str = ""


@dataclass(frozen=True, slots=True)
class Mark:
    """Place of an object on a chart.

    Attributes
    ----------
    chart : str
        The chart's key.
    x, y : float
        In the axes' units.
    label : str
        What is written beside it.
    """

    chart: str
    x: float
    y: float
    label: str = ""


STABILITY = Clause(
    "Peak resultant acceleration {push:-~2f}\u00a0g, velocity {speed:cm/s~0f}. H' is twice the height of the centre of "
    "gravity. Below H' = {crossing:cm~0f} there is no band in which an object rocks without overturning. The lines are "
    "the paper's closed-form criteria, which let nothing slide; the verdict comes from friction, the vertical shaking "
    "and the time history."
)
PATH = Clause("Path of an object with friction {friction:-}")
PATH_SEEN = Clause("Seen from above, from where it stood (0, 0). It gets {far:cm~1f} away.")
EAST = Clause("east, {damping:%~0f}")
NORTH = Clause("north, {damping:%~0f}")
OF_DAMPING = Clause("damping {damping:-~2f}")
OF_FRICTION = Clause("friction {friction:-~2f}")
DRAWN_FROM = Clause(
    "Drawn from {count} analyses, closest together where the response turns. Error measured at points held out: at "
    "most {errors} of the value, or of a hundredth of the largest value where that is more."
)

CHART_WORDS = tuple(one for one in globals().values() if isinstance(one, Clause))
"""All of them."""
