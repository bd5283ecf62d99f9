"""Medians that others published for things like museum objects (tables/fragility.csv)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import inf
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field

from pipeline.quantities import G
from pipeline.records import Scene
from pipeline.tables import table
from pipeline.tables.rows import Number, checked


@dataclass(frozen=True)
class Published:
    """A published fragility.

    Attributes
    ----------
    what : str
        What it is of.
    median : float
        In m/s2; the table has it in g.
    dispersion : float
        Standard deviation of ln [-].
    support : str
        How the object is held.
    friction_below : float
        It is of objects with less friction than this [-].
    source : str
        Who says so.
    """

    what: str
    median: Annotated[Number, Field(alias="median_g"), AfterValidator(lambda g: g * G)]
    dispersion: Number
    support: str
    friction_below: Annotated[float, BeforeValidator(lambda cell: cell or inf)]
    source: str


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
    """Return what a scene is set beside: the row of its support with the least friction that it is below.

    Parameters
    ----------
    scene : Scene
        The object as it stands.

    Returns
    -------
    Published or None
        None where there is none, or where its friction is not known.
    """
    friction = scene.parameters.get("friction_static")
    if friction is None:
        return None
    rows = [p for p in all_published() if p.support == scene.support.value and friction.value < p.friction_below]
    return min(rows, key=lambda p: p.friction_below, default=None)
