"""Charts and what lies on them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis of a chart: its label, SI unit of the data, and "linear" or "log"."""

    label: str
    unit: str
    scale: str = "linear"


@dataclass(frozen=True, slots=True)
class Curve:
    """A line of a chart; x and y in the axes' units."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Zone:
    """A labelled region of a chart: a closed polygon and how it is judged ("safe", "warn", "danger")."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    tone: str


@dataclass(frozen=True, slots=True)
class Chart:
    """A picture of one motion's effect, shared by all objects marked on it.

    key   : identity within a run, such as "stability:<motion hash>"
    equal : the two axes share one scale (a path on the floor)
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
    """Where an object lies on a chart (x, y in the axes' units)."""

    chart: str
    x: float
    y: float
    label: str = ""
