"""Medians that others published for things like museum objects (tables/fragility.csv)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from pipeline.quantities import G
from pipeline.records import Scene
from pipeline.tables import number, table


@dataclass(frozen=True)
class Published:
    """A published fragility: median [m/s2], dispersion, what it is of, and who says so."""

    what: str
    median: float
    dispersion: float
    support: str
    friction_below: float
    source: str


@cache
def all_published() -> Sequence[Published]:
    """Return the rows of the table.

    raises : TableError for what is no number
    """
    return tuple(
        Published(
            row["what"],
            number(row, "median_g", "fragility.csv") * G,
            number(row, "dispersion", "fragility.csv"),
            row["support"],
            number(row, "friction_below", "fragility.csv") if row["friction_below"] else float("inf"),
            row["source"],
        )
        for row in table("fragility")
    )


def published(scene: Scene) -> Published | None:
    """Return what a scene is set beside: the row of its support with the least friction that it is below, or None."""
    friction = scene.parameters.get("friction_static")
    if friction is None:
        return None
    rows = [p for p in all_published() if p.support == scene.support.value and friction.value < p.friction_below]
    return min(rows, key=lambda p: p.friction_below, default=None)
