"""The stock: what an answer needs of each object on display, in columns, kept from the night for the worst one.

To read all results of 100,000 objects takes the better part of a minute; this takes a second.  It is kept page by page
in the cache, under a key of all that it depends on: what is missing, damaged or of other code is made anew from the
results.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.stakes import danger_of, value_of
from pipeline.cache import CacheEntry, key_of
from pipeline.event.capacities import Capacities, FloorMotions, Shares, capacities, joined
from pipeline.quantities import Array
from pipeline.records import Assessment

_TEXTS = ("numbers", "titles", "galleries", "cases", "floors")
_COLUMNS = ("ln_capacity", "beta", "common", "own")
_SHARES = ("ln_pga", "kind", "at", "share")


@dataclass(frozen=True)
class Stock:
    """Objects on display, in columns.

    Attributes
    ----------
    numbers, titles, galleries, cases, floors : tuple of str
        As the museum names each and where it stands.
    value, danger : ndarray, shape (m,)
        What each is worth, and what its fall is to people, in objects of class C.
    capacities : Capacities
        What each can take.
    """

    numbers: tuple[str, ...]
    titles: tuple[str, ...]
    galleries: tuple[str, ...]
    cases: tuple[str, ...]
    floors: tuple[str, ...]
    value: Array
    danger: Array
    capacities: Capacities

    def __len__(self) -> int:
        """Return how many objects there are."""
        return len(self.numbers)

    def packed(self) -> CacheEntry:
        """Return it as the cache keeps it."""
        able = self.capacities
        arrays: dict[str, NDArray[Any]] = {"value": self.value, "danger": self.danger}
        arrays |= {name: getattr(able, name) for name in _COLUMNS}
        arrays |= {f"{name} {at}": getattr(one, name) for at, one in enumerate(able.shares) for name in _SHARES}
        said = {name: list(getattr(self, name)) for name in _TEXTS}
        return CacheEntry({**said, "shares": len(able.shares)}, arrays)

    @classmethod
    def of_packed(cls, kept: CacheEntry) -> Stock:
        """Return what `packed` gave."""
        arrays = kept.arrays
        shares = [Shares(*(arrays[f"{name} {at}"] for name in _SHARES)) for at in range(kept.said["shares"])]
        ln_capacity, beta, common, own = (arrays[name] for name in _COLUMNS)
        able = Capacities(ln_capacity, beta, common, own, shares)
        numbers, titles, galleries, cases, floors = (tuple(kept.said[name]) for name in _TEXTS)
        return cls(numbers, titles, galleries, cases, floors, arrays["value"], arrays["danger"], able)


def stock_of(assessments: Sequence[Assessment], floors: Mapping[str, FloorMotions]) -> Stock:
    """Return the stock of objects as a run found them; those that are not on display are left out.

    Parameters
    ----------
    assessments : sequence of Assessment
        Of objects.
    floors : mapping of str to FloorMotions
        Of the run.
    """
    shown = [one for one in assessments if one.scene.item.on_display]
    texts = [
        (item.object_number, item.called, item.gallery, item.case, one.scene.floor)
        for one in shown
        for item in (one.scene.item,)
    ]
    columns: list[tuple[str, ...]] = list(zip(*texts, strict=True)) or [()] * len(_TEXTS)
    numbers, titles, galleries, cases, on_floors = columns
    value, danger = (np.array([of(one.scene) for one in shown], dtype=float) for of in (value_of, danger_of))
    return Stock(numbers, titles, galleries, cases, on_floors, value, danger, capacities(shown, floors))


def stock_joined(parts: Sequence[Stock]) -> Stock:
    """Return the stock of all objects of several, one after the other."""
    numbers, titles, galleries, cases, floors = (
        tuple(text for part in parts for text in getattr(part, name)) for name in _TEXTS
    )
    value, danger = (np.concatenate([getattr(part, name) for part in parts]) for name in ("value", "danger"))
    able = joined([part.capacities for part in parts])
    return Stock(numbers, titles, galleries, cases, floors, value, danger, able)


def stock_key(page: str, floors: Mapping[str, FloorMotions], value_per_c: float) -> str:
    """Return what the stock of a page is kept under.

    Parameters
    ----------
    page : str
        The page's own key, a digest of its objects and of their results.
    floors : mapping of str to FloorMotions
        Of the run.
    value_per_c : float
        The money that counts as one object of class C.
    """
    said = [[name, floor.levels, floor.ratio, floor.ratio_sd, floor.up] for name, floor in sorted(floors.items())]
    return key_of(page, said, value_per_c)
