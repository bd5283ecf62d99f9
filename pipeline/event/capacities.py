r"""What each object can take, in the two peaks of the shaking, from the curves or probabilities that a run found.

A run keeps a lognormal curve of each state by the peak acceleration A of the floor, and one by its peak velocity V,
from the same samples under the same motions.  Motions that are scaled keep the ratio V / A, so that one capacity lies
behind both curves:

.. math::

    z = \frac{(1 - \beta) \ln A + \beta \ln V - \ln c}{\sigma}, \quad
    \beta = \frac{1}{2} \left(1 + \frac{D_A^2 - D_V^2}{s^2}\right), \quad
    \ln c = (1 - \beta) \ln m_A + \beta \ln m_V, \quad
    \sigma^2 = D_A^2 - \beta^2 s^2 = D_V^2 - (1 - \beta)^2 s^2

with m and D the medians and dispersions of the curves, and s the standard deviation of ln V / A over the motions (and
over those that might have come: 1 / n of its published square is added for n motions).  With both peaks known nothing
has to be run again, and what else differs from record to record is the rest of sigma.

Of what a run found no curve for, the shares of its samples at each acceleration are taken between its stripes; where it
made no curves, the probabilities at its levels, with the dispersions of tables/dispersion.csv.

The stock: what an answer needs of each object on display, in columns, kept from the night for the worst one.

To read all results of 100,000 objects takes the better part of a minute; this takes a second.  It is kept page by page
in the cache, under a key of all that it depends on: what is missing, damaged or of other code is made anew from the
results.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.fragility.curve import stated
from pipeline.analysis.stakes import danger_of, value_of
from pipeline.cache import CacheEntry, key_of
from pipeline.event.message import RATIO_SIGMA
from pipeline.quantities import Array
from pipeline.records import Assessment, Fragility, Harm, Likelihood, MotionSummary
from pipeline.records.fragility import HARM

Indices = NDArray[np.intp]

KINDS = (HARM, *(one.value for one in Harm))
"""What there is a capacity of: any harm, then each state."""

UP_SIGMA = 0.3
"""Standard deviation of ln of how many times as strong a floor shakes, where its motions do not tell: judgement."""


@dataclass(frozen=True)
class FloorMotions:
    """Motions of a run on one floor.

    Attributes
    ----------
    levels : mapping of str to (float, float)
        By level, ln of the geometric means of PGA [m/s2] and PGV [m/s].
    ratio, ratio_sd : float
        Mean and standard deviation of ln of PGV over PGA [s], the latter over all motions that might have come.
    up : (float, float, float)
        ln of how many times as strong as on the ground PGA and PGV are, and its standard deviation.
    """

    levels: Mapping[str, tuple[float, float]]
    ratio: float
    ratio_sd: float
    up: tuple[float, float, float] = (0.0, 0.0, 0.0)


def floors_of(motions: Sequence[MotionSummary], ground: Sequence[MotionSummary]) -> dict[str, FloorMotions]:
    """Return the floors of a run by name, "" for the ground.

    Parameters
    ----------
    motions : sequence of MotionSummary
        Of all floors that the run has.
    ground : sequence of MotionSummary
        Those of the ground, in the order of each floor's.
    """
    by_floor: dict[str, list[MotionSummary]] = {"": list(ground)}
    for one in motions:
        if one.floor:
            by_floor.setdefault(one.floor, []).append(one)
    below = _peaks(ground)
    return {name: _floor(those, below if name else _peaks(those)) for name, those in by_floor.items()}


def _peaks(motions: Sequence[MotionSummary]) -> Array:
    """Return ln of PGA and PGV, (n, 2)."""
    peaks = np.array([[one.measures["pga"], one.measures["pgv"]] for one in motions], dtype=float).reshape(-1, 2)
    return np.asarray(np.log(np.maximum(peaks, 1e-12)))


def _floor(motions: Sequence[MotionSummary], below: Array) -> FloorMotions:
    peaks = _peaks(motions)
    ratios = peaks[:, 1] - peaks[:, 0]
    levels: dict[str, list[int]] = {}
    for at, one in enumerate(motions):
        levels.setdefault(one.level, []).append(at)
    means = {name: tuple(peaks[places].mean(axis=0).tolist()) for name, places in levels.items()}
    n = ratios.size
    sd = math.sqrt(float(ratios.var()) + RATIO_SIGMA**2 / n)
    times = peaks - below if below.shape == peaks.shape else peaks.mean(axis=0) - below.mean(axis=0)[None]
    spread = float(times.std(axis=0).max()) if times.shape[0] > 1 else UP_SIGMA
    up = tuple(times.mean(axis=0).tolist())
    return FloorMotions(means, float(ratios.mean()), sd, (up[0], up[1], 0.0 if not np.any(times) else spread))


@dataclass(frozen=True)
class Shares:
    """Shares of samples that reached a state, at the same peak accelerations, where no curve tells it.

    Attributes
    ----------
    ln_pga : ndarray, shape (g,)
        Of the ground, rising; one alone holds at all.
    kind, at : ndarray of int, shape (n,)
        Of which kind and of which object each row is; objects rise.
    share : ndarray, shape (n, g)
        0 to 1, never falling along a row.
    """

    ln_pga: Array
    kind: Indices
    at: Indices
    share: Array

    def of(self, objects: slice) -> Shares:
        """Return the rows of some objects, whose places count from the first of them."""
        start, stop = objects.start or 0, objects.stop
        rows = slice(*np.searchsorted(self.at, [start, stop]).tolist())
        return Shares(self.ln_pga, self.kind[rows], self.at[rows] - start, self.share[rows])

    def under(self, ln_pga: Array) -> Array:
        """Return the share of each row at some peak accelerations, (s, n): straight between two, the same beyond."""
        if self.ln_pga.size == 1:
            return np.repeat(self.share.T, ln_pga.size, axis=0)
        clipped = np.clip(ln_pga, self.ln_pga[0], self.ln_pga[-1])
        low = np.clip(np.searchsorted(self.ln_pga, clipped, side="right") - 1, 0, self.ln_pga.size - 2)
        part = (clipped - self.ln_pga[low]) / (self.ln_pga[low + 1] - self.ln_pga[low])
        below, above = self.share[:, low], self.share[:, low + 1]
        return np.asarray((below + part * (above - below)).T)


@dataclass
class Capacities:
    """Capacities of m objects by kind (k, m), NaN where an object cannot reach a state or nothing is known of it.

    Attributes
    ----------
    ln_capacity, beta : ndarray, shape (k, m)
        ln c [m/s2 and m/s] and the share of the velocity, on the ground.
    common, own : ndarray, shape (k, m)
        Parts of sigma that all objects have in common, being of the record, and that each has for itself.
    shares : list of Shares
        Of those kinds of objects that no curve tells.
    """

    ln_capacity: Array
    beta: Array
    common: Array
    own: Array
    shares: list[Shares] = field(default_factory=list)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Of which objects anything is known, (m,)."""
        return np.asarray(self.reachable.any(axis=0))

    @property
    def reachable(self) -> NDArray[np.bool_]:
        """Which kinds each object can reach, as far as is known, (k, m)."""
        found = np.isfinite(self.ln_capacity)
        for one in self.shares:
            found[one.kind, one.at] = True
        return np.asarray(found)

    def some(self, places: Sequence[int]) -> Capacities:
        """Return those of some objects, in that order."""
        chosen = np.asarray(places, dtype=np.intp)
        new = np.full(self.ln_capacity.shape[1], -1, dtype=np.intp)
        new[chosen] = np.arange(chosen.size)
        shares = [_rising(one.ln_pga, one.kind, new[one.at], one.share, new[one.at] >= 0) for one in self.shares]
        ln_capacity, beta, common, own = (
            part[:, chosen] for part in (self.ln_capacity, self.beta, self.common, self.own)
        )
        return Capacities(ln_capacity, beta, common, own, shares)

    def centred(
        self, told: Mapping[int, Mapping[str, float]], ln_pga: float, ln_pgv: float, *, same: bool
    ) -> Capacities:
        """Return the same where of some objects the probability of each kind is known at some peaks.

        How the probability grows with the peaks stays as the curves have it, or is as stated where there are none.

        Parameters
        ----------
        told : mapping of int to mapping of str to float
            By place of the object, the probability of each kind that it can reach, between 0 and 1.
        ln_pga, ln_pgv : float
            ln of the peaks of the ground [m/s2, m/s] at which they are.
        same : bool
            Whether they are under the very motion, so that nothing of it differs any more from what is drawn.
        """
        from scipy.special import ndtri

        parts = [part.copy() for part in (self.ln_capacity, self.beta, self.common, self.own)]
        ln_capacity, beta, common, own = parts
        usual_beta, usual_common, usual_own = _usual()
        for at, chances in told.items():
            for kind, name in enumerate(KINDS):
                if name not in chances:
                    ln_capacity[kind, at] = np.nan
                    continue
                if not math.isfinite(ln_capacity[kind, at]):
                    beta[kind, at], common[kind, at], own[kind, at] = usual_beta, usual_common, usual_own
                if same:
                    common[kind, at] = 0.0
                sigma = math.hypot(own[kind, at], common[kind, at])
                peaks = (1.0 - beta[kind, at]) * ln_pga + beta[kind, at] * ln_pgv
                ln_capacity[kind, at] = peaks - sigma * float(ndtri(chances[name]))
        places = list(told)
        shares = [_rising(one.ln_pga, one.kind, one.at, one.share, ~np.isin(one.at, places)) for one in self.shares]
        return Capacities(ln_capacity, beta, common, own, shares)


def _rising(ln_pga: Array, kind: Indices, at: Indices, share: Array, keep: NDArray[np.bool_]) -> Shares:
    """Return the rows that are kept, by rising places."""
    rows = np.flatnonzero(keep)
    rows = rows[np.argsort(at[rows], kind="stable")]
    return Shares(ln_pga, kind[rows], at[rows], share[rows])


def capacities(assessments: Sequence[Assessment], floors: Mapping[str, FloorMotions]) -> Capacities:
    """Return what objects can take.

    Parameters
    ----------
    assessments : sequence of Assessment
        As a run found them.
    floors : mapping of str to FloorMotions
        Of the run.
    """
    shape = len(KINDS), len(assessments)
    ln_capacity, beta, common, own = np.full((4, *shape), np.nan)
    found = Capacities(ln_capacity, beta, common, own)
    rows: dict[tuple[float, ...], list[tuple[int, int, Array]]] = {}
    for at, one in enumerate(assessments):
        floor = floors.get(one.scene.floor)
        if floor is None:
            continue
        curves = {curve.state: curve for curve in one.fragilities if curve.state in KINDS}
        for kind, name in enumerate(KINDS):
            if name in curves:
                told = _by_curve(found, kind, at, curves[name], floor)
                if told is not None:
                    rows.setdefault(told[0], []).append((kind, at, told[1]))
            elif not curves and one.likelihoods:
                _by_levels(found, kind, at, one.likelihoods, floor)
    for ln_pga, those in rows.items():
        kinds, places, shares = (np.array(part) for part in zip(*those, strict=True))
        found.shares.append(Shares(np.array(ln_pga), kinds, places, shares))
    return found


def joined(parts: Sequence[Capacities]) -> Capacities:
    """Return the capacities of all objects of several, one after the other."""
    ln_capacity, beta, common, own = (
        np.concatenate([getattr(one, name) for one in parts], axis=1)
        for name in ("ln_capacity", "beta", "common", "own")
    )
    grids: dict[tuple[float, ...], list[tuple[Indices, Indices, Array]]] = {}
    start = 0
    for part in parts:
        for one in part.shares:
            grids.setdefault(tuple(one.ln_pga.tolist()), []).append((one.kind, one.at + start, one.share))
        start += part.ln_capacity.shape[1]
    shares = [
        Shares(np.array(grid), *(np.concatenate(some) for some in zip(*rows, strict=True)))
        for grid, rows in grids.items()
    ]
    return Capacities(ln_capacity, beta, common, own, shares)


def _by_curve(
    found: Capacities, kind: int, at: int, curve: Fragility, floor: FloorMotions
) -> tuple[tuple[float, ...], Array] | None:
    """Put the capacity that a curve tells in its place; else return the shares at ln of the peaks of the ground."""
    if curve.bound or curve.median_pgv is None or curve.dispersion_pgv is None:
        rows = [(math.log(pga) - floor.up[0], reached / taken) for pga, taken, reached in curve.stripes if taken]
        # More shaking never spares what less did not: samples that are few may say so.
        return (tuple(at for at, _ in rows), np.maximum.accumulate([share for _, share in rows])) if rows else None
    own = math.hypot(curve.inputs, curve.modelling)
    medians = math.log(curve.median), math.log(curve.median_pgv)
    _put(found, kind, at, medians, (curve.dispersion, curve.dispersion_pgv), own, floor)
    return None


def _by_levels(found: Capacities, kind: int, at: int, said: Sequence[Likelihood], floor: FloorMotions) -> None:
    from scipy.special import ndtri

    name = KINDS[kind]
    own, record, by_speed = _stated()
    spread = math.hypot(own, record), math.hypot(own, by_speed)
    medians = []
    for one in said:
        if one.level not in floor.levels or (name != HARM and name not in one.states):
            continue
        share = one.probability if name == HARM else one.states[name]
        # Of none and of all half a sample is off.
        share = min(max(share, 0.5 / (one.samples + 1.0)), 1.0 - 0.5 / (one.samples + 1.0))
        peaks = floor.levels[one.level]
        medians.append([peak - sd * float(ndtri(share)) for peak, sd in zip(peaks, spread, strict=True)])
    if medians:
        ln_a, ln_v = (sum(column) / len(medians) for column in zip(*medians, strict=True))
        _put(found, kind, at, (ln_a, ln_v), spread, own, floor)


@cache
def _stated() -> tuple[float, float, float]:
    return stated("modelling").value, stated("record").value, stated("record_velocity").value


@cache
def _usual() -> tuple[float, float, float]:
    """Return the share of the velocity, and what is in common and what is an object's own, where no curve tells it."""
    own, record, by_speed = _stated()
    return (*_parted((math.hypot(own, record), math.hypot(own, by_speed)), own, RATIO_SIGMA**2), own)


def _parted(spread: tuple[float, float], own: float, square: float) -> tuple[float, float]:
    """Return the share of the velocity, and what all objects have in common of the spread by both peaks."""
    by_a, by_v = (sd * sd for sd in spread)
    beta = min(max(0.5 * (1.0 + (by_a - by_v) / square), 0.0), 1.0)
    # Equal, unless beta is at an end.
    rest = 0.5 * (by_a - beta * beta * square + by_v - (1.0 - beta) ** 2 * square)
    return beta, math.sqrt(max(rest - own * own, 0.0))


def _put(
    found: Capacities,
    kind: int,
    at: int,
    medians: tuple[float, float],
    spread: tuple[float, float],
    own: float,
    floor: FloorMotions,
) -> None:
    """Put the capacity behind two curves in its place, as one of the shaking of the ground."""
    own = max(own, 0.05)
    beta, common = _parted(spread, own, floor.ratio_sd**2)
    up_a, up_v, up_sd = floor.up
    found.ln_capacity[kind, at] = (1.0 - beta) * (medians[0] - up_a) + beta * (medians[1] - up_v)
    found.beta[kind, at] = beta
    found.own[kind, at] = own
    found.common[kind, at] = math.hypot(common, up_sd)


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
