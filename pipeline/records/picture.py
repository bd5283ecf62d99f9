"""Charts and what lies on them."""

from __future__ import annotations

from dataclasses import dataclass


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
