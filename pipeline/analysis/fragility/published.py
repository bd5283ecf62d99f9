"""Medians that others published for things like museum objects (tables/fragility.csv)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

from pipeline.analysis.scene_parameters import material_of
from pipeline.quantities import G
from pipeline.records import Scene
from pipeline.tables import table
from pipeline.tables.assumed import assumed
from pipeline.tables.rows import Entries, Number, checked


@dataclass(frozen=True)
class Published:
    """A published fragility.

    Attributes
    ----------
    what : str
        What it is of.
    median : float
        Of the shaking at which it fails, in `unit`.
    unit : {"g", "m/s"}
        Of a peak acceleration, or of a peak velocity of the floor.
    dispersion : float
        Standard deviation of ln [-].
    support : str
        How the object is held; "" where nothing here stands so.
    classes : tuple of str
        Classes of the objects that it is of; empty for all.
    materials, surface : tuple of str, str
        Rows of materials.csv: of what the base of the object is, and of what it stands on; empty for anything.
    source : str
        Who says so.
    """

    what: str
    median: Number
    unit: Literal["g", "m/s"]
    dispersion: Number
    support: str
    classes: Entries
    materials: Entries
    surface: str
    source: str

    def suits(self, scene: Scene) -> bool:
        """Say whether an object is of its kind; what it stands on is, where nothing is recorded."""
        item = scene.item
        base = assumed().material_in(item.base_material) or material_of(item)
        under = assumed().material_in(item.surface_material)
        elsewhere = bool(self.surface and item.surface_material) and (under is None or under.name != self.surface)
        return (
            self.support == scene.support.value
            and (not self.classes or scene.object_class in self.classes)
            and (not self.materials or base.name in self.materials)
            and not elsewhere
        )


@cache
def all_published() -> Sequence[Published]:
    """Return the rows of the table.

    Returns
    -------
    sequence of Published
        In its order.

    Raises
    ------
    TableError
        For what is no number.
    """
    return checked(Published, table("fragility"), "fragility.csv", named="what")


def published(scene: Scene) -> Published | None:
    """Return what a scene is set beside: of the rows in peak acceleration that it is of the kind of, the lowest median.

    Parameters
    ----------
    scene : Scene
        The object as it stands.

    Returns
    -------
    Published or None
        None where there is none.
    """
    rows = [one for one in all_published() if one.unit == "g" and one.suits(scene)]
    return min(rows, key=lambda one: one.median, default=None)


def in_si(one: Published) -> float:
    """Return a median in m/s2 or m/s."""
    return one.median * G if one.unit == "g" else one.median
