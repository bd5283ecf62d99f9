"""What the shaking did to each object, as probabilities, and what follows: galleries in order, what to do first.

What nobody knows and all objects have in common (both peaks of the shaking, and how the record differs from others of
the same peaks) is drawn together; given that, objects come to harm each for itself.  So the number of objects down has
the range that a common shaking gives it, and not the narrow one of objects that have nothing in common.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.event.capacities import KINDS, Capacities, Stock
from pipeline.event.message import SiteShaking
from pipeline.quantities import Array, G
from pipeline.records import Band, Harm, Sampling
from pipeline.records.fragility import HARM

DRAWS, FEWER, MANY = 512, 128, 20_000
"""Draws of what all objects have in common, powers of two: fewer of more objects than so many, as a minute is all that
there is; the ends of a range are then told by 6 draws."""

LOW, HIGH = 0.05, 0.95
"""Shares of the draws between which the number of objects down is told."""

DANGEROUS = 1.0
"""From which danger to people on an object is made safe before anybody enters, in objects of class C: a tenth of what
hurting a visitor badly counts (stakes.csv); judgement."""

_AT_ONCE = 2000
"""Objects that are looked at together: what bounds the memory."""


@dataclass(frozen=True)
class Draws:
    """Draws of what all objects have in common, on the ground.

    Attributes
    ----------
    ln_pga, ln_pgv : ndarray, shape (s,)
        ln of the peaks [m/s2, m/s].
    record : ndarray, shape (s,)
        Standard normal: by how much the record is harder on objects than its peaks say.
    weights : ndarray, shape (s,)
        Of each draw; their sum is 1.
    """

    ln_pga: Array
    ln_pgv: Array
    record: Array
    weights: Array


def drawn(shaking: SiteShaking, objects: int = 0) -> Draws:
    """Return draws of the shaking: one Sobol' sequence, always the same.

    Parameters
    ----------
    shaking : SiteShaking
        With a peak velocity.
    objects : int
        How many these are for.
    """
    return placed(shaking, normals(objects))


def normals(objects: int = 0, *, count: int = 0) -> Array:
    """Return standard normal points (s, 3) of one Sobol' sequence, for so many objects, or a count of them."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    wanted = count or (DRAWS if objects <= MANY else FEWER)
    points = qmc.Sobol(3, scramble=True, rng=np.random.default_rng(1)).random(wanted)
    return np.asarray(ndtri(points))


def placed(shaking: SiteShaking, normals: Array, weights: Array | None = None) -> Draws:
    """Return draws at standard normal places, (s, 3)."""
    if shaking.pgv_cm_s is None:
        raise AssertionError("a peak velocity is estimated before anything is drawn")
    first, second, record = normals.T
    rho = shaking.correlation
    other = rho * first + math.sqrt(max(1.0 - rho * rho, 0.0)) * second
    even = np.full(len(normals), 1.0 / len(normals))
    return Draws(
        math.log(shaking.pga_g * G) + shaking.pga_ln_sd * first,
        math.log(0.01 * shaking.pgv_cm_s) + shaking.pgv_ln_sd * other,
        record,
        even if weights is None else weights,
    )


def chances(capacities: Capacities, draws: Draws, objects: slice) -> Array:
    """Return the probability of each kind for some objects under each draw, (k, s, n); 0 for what cannot be reached."""
    from scipy.special import ndtr

    ln_c, beta, own, common = (
        part[:, None, objects] for part in (capacities.ln_capacity, capacities.beta, capacities.own, capacities.common)
    )
    pga, pgv, record = (part[None, :, None] for part in (draws.ln_pga, draws.ln_pgv, draws.record))
    with np.errstate(invalid="ignore"):
        z = ((1.0 - beta) * pga + beta * pgv - ln_c + common * record) / own
    out = np.nan_to_num(ndtr(z), nan=0.0)
    for one in capacities.shares:
        mine = one.of(objects)
        if mine.at.size:
            out[mine.kind, :, mine.at] = mine.under(draws.ln_pga).T
    # What falls has rocked, and what reaches a state that harms is harmed: curves that are fitted apart may cross.
    falls = out[KINDS.index(Harm.FALLS.value)]
    rocks, harm = KINDS.index(Harm.ROCKS.value), KINDS.index(HARM)
    out[rocks] = np.maximum(out[rocks], np.where(np.isfinite(capacities.ln_capacity[rocks, objects]), falls, 0.0))
    out[harm] = np.maximum(out[harm], falls)
    return out


def moved_of(chance: Array) -> Array:
    """Return of probabilities by kind (k, ...) that of having moved or rocked and not fallen."""
    names = (Harm.SHIFTS.value, Harm.LEAVES.value, Harm.ROCKS.value)
    moved = np.max([chance[KINDS.index(name)] for name in names], axis=0)
    left: Array = np.maximum(moved - chance[KINDS.index(Harm.FALLS.value)], 0.0)
    return left


@dataclass(frozen=True, slots=True)
class ObjectAnswer:
    """What the shaking did to an object, as far as one can know it.

    Attributes
    ----------
    number, title, gallery, case, floor : str
        As the museum names it and where it stands.
    probability : float or None
        Of any harm; None where nothing is known of it.
    band : Band or None
        The word for it.
    states : mapping of str to float
        By `Harm`, of each state that it can reach.
    moved : float
        Of having moved or rocked and standing still.
    value, danger : float
        What it is worth, and what its fall is to people, in objects of class C.
    expected_loss : float
        See `pipeline.analysis.stakes`.
    aftershock : bool
        Whether it has likely moved or rocked, so that a further shock finds it weaker.
    make_safe : bool
        Whether it is to be made safe, or kept away from, before anybody works beside it.
    reported : str
        What people found; "" where nobody looked.
    """

    number: str
    title: str
    gallery: str
    case: str
    floor: str
    probability: float | None
    band: Band | None
    states: dict[str, float]
    moved: float
    value: float
    danger: float
    expected_loss: float
    aftershock: bool
    make_safe: bool
    reported: str = ""

    @property
    def fallen(self) -> float:
        """The probability that it has fallen."""
        return self.states.get(Harm.FALLS.value, 0.0)


@dataclass(frozen=True, slots=True)
class Count:
    """How many have fallen: expected, and between which numbers in 9 of 10 cases."""

    fallen: float
    low: int
    high: int


@dataclass(frozen=True, slots=True)
class GalleryAnswer:
    """A gallery: its objects on display, how many of them have fallen, and what is lost on average."""

    name: str
    floor: str
    objects: int
    unknown: int
    count: Count
    expected_loss: float
    make_safe: int


@dataclass(frozen=True)
class Answer:
    """What the shaking did.

    Attributes
    ----------
    shaking : SiteShaking
        At the museum, as the message says it.
    count : Count
        Of all objects on display.
    galleries : tuple of GalleryAnswer
        Where most is lost first.
    objects : tuple of ObjectAnswer
        What most is lost of first; those of which nothing is known last.
    """

    shaking: SiteShaking
    count: Count
    galleries: tuple[GalleryAnswer, ...]
    objects: tuple[ObjectAnswer, ...]

    @property
    def unknown(self) -> int:
        """Of how many objects nothing is known."""
        return sum(one.probability is None for one in self.objects)


def answered(
    stock: Stock,
    shaking: SiteShaking,
    sampling: Sampling,
    draws: Draws,
    found: Mapping[int, str] | None = None,
) -> Answer:
    """Return what the shaking did to objects.

    Parameters
    ----------
    stock : Stock
        The objects on display.
    shaking : SiteShaking
        At the museum.
    sampling : Sampling
        Whose words are used.
    draws : Draws
        Of the shaking.
    found : mapping of int to str or None
        By place of an object, what people found: standing, moved, fallen or broken.
    """
    found = found or {}
    able, size = stock.capacities, len(stock)
    names = {name: at for at, name in enumerate(dict.fromkeys(stock.galleries))}
    member = np.array([names[name] for name in stock.galleries], dtype=np.intp)
    counts = np.zeros((draws.weights.size, len(names)))
    expected = np.zeros((len(KINDS), size))
    moved = np.zeros(size)
    chosen = np.random.default_rng(0)
    for start in range(0, size, _AT_ONCE):
        part = slice(start, min(start + _AT_ONCE, size))
        chance = chances(able, draws, part)
        _put_found(chance, found, start)
        expected[:, part] = np.einsum("s,ksn->kn", draws.weights, chance)
        moved[part] = draws.weights @ moved_of(chance)
        falls = chance[KINDS.index(Harm.FALLS.value)]
        down = chosen.random(falls.shape) < falls
        for gallery in np.unique(member[part]).tolist():
            counts[:, gallery] += down[:, member[part] == gallery].sum(axis=1)
    objects = _objects(stock, expected, moved, sampling, found)
    falls = expected[KINDS.index(Harm.FALLS.value)]
    by_gallery: list[list[ObjectAnswer]] = [[] for _ in names]
    for one, number in zip(objects, member.tolist(), strict=True):
        by_gallery[number].append(one)
    down_in = np.bincount(member, weights=falls, minlength=len(names))
    galleries = [
        _gallery(name, by_gallery[number], _count(float(down_in[number]), counts[:, number], draws.weights))
        for name, number in names.items()
    ]
    return Answer(
        shaking,
        _count(float(falls.sum()), counts.sum(axis=1), draws.weights),
        tuple(sorted(galleries, key=lambda one: (-one.expected_loss, one.name))),
        tuple(sorted(objects, key=lambda one: (one.probability is None, -one.expected_loss, one.number, one.gallery))),
    )


def _put_found(chance: Array, found: Mapping[int, str], start: int) -> None:
    """Put what was found in place of probabilities."""
    sure = {
        "moved": (Harm.SHIFTS.value,),
        "fallen": (HARM, Harm.FALLS.value),
        "broken": (HARM, Harm.BREAKS.value),
    }
    for at, state in found.items():
        if start <= at < start + chance.shape[2]:
            chance[:, :, at - start] = 0.0
            for name in sure.get(state, ()):
                chance[KINDS.index(name), :, at - start] = 1.0


def _count(expected: float, counts: Array, weights: Array) -> Count:
    order = np.argsort(counts, kind="stable")
    share = np.cumsum(weights[order])
    low, high = (
        int(counts[order][min(int(np.searchsorted(share, at - 1e-12)), counts.size - 1)]) for at in (LOW, HIGH)
    )
    return Count(expected, low, high)


def _gallery(name: str, objects: Sequence[ObjectAnswer], count: Count) -> GalleryAnswer:
    return GalleryAnswer(
        name,
        objects[0].floor,
        len(objects),
        sum(one.probability is None for one in objects),
        count,
        math.fsum(one.expected_loss for one in objects),
        sum(one.make_safe for one in objects),
    )


def _objects(
    stock: Stock, expected: Array, moved: Array, sampling: Sampling, found: Mapping[int, str]
) -> list[ObjectAnswer]:
    """Return what became of each object, by the probability of each kind (k, m), and that of having moved (m,)."""
    reachable = stock.capacities.reachable
    known = np.asarray(reachable.any(axis=0)).tolist()
    harm, falls = expected[KINDS.index(HARM)], expected[KINDS.index(Harm.FALLS.value)]
    possible, unlikely = sampling.edges[2:]
    rows = zip(
        stock.numbers, stock.titles, stock.galleries, stock.cases, stock.floors, known, harm.tolist(),
        expected.T.tolist(), reachable.T.tolist(), moved.tolist(), stock.value.tolist(), stock.danger.tolist(),
        (harm * stock.value + falls * stock.danger).tolist(), (moved >= possible).tolist(),
        # What cannot fall hurts nobody: a heavy armchair that has moved needs no making safe.
        ((stock.danger >= DANGEROUS) & (moved + falls >= possible) & (falls >= unlikely)).tolist(), strict=True,
    )  # fmt: skip
    out = []
    for at, (
        number,
        title,
        gallery,
        case,
        floor,
        sure,
        chance,
        each,
        there,
        left,
        value,
        danger,
        loss,
        weak,
        safe,
    ) in enumerate(rows):
        reported = found.get(at, "")
        if not (sure or reported):
            out.append(
                ObjectAnswer(number, title, gallery, case, floor, None, None, {}, 0.0, value, danger, 0.0,
                             aftershock=False, make_safe=False)
            )  # fmt: skip
            continue
        states = {KINDS[kind]: each[kind] for kind in range(1, len(KINDS)) if there[kind]}
        out.append(
            ObjectAnswer(number, title, gallery, case, floor, chance, sampling.band(chance), states, left, value,
                         danger, loss, aftershock=weak, make_safe=safe, reported=reported)
        )  # fmt: skip
    return out
