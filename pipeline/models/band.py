r"""Largest and least pseudo-acceleration of an oscillator over a band of natural frequencies: searched, not sampled.

A response spectrum is no monotone function of the frequency: its largest value over a band lies inside it as a rule.
It is looked for on a grid that is finer than any peak of it can be narrow, the half-power width 2 zeta f of a resonance
that lasts, and closer where it has an extremum.  The grid does not depend on the band, so that a spectrum is worked out
once for all who ask: a piece of it at a time, for each shaking and damping.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache, partial
from hashlib import blake2b
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from pipeline.cache import SPECTRA, Cache, CacheEntry, key_of
from pipeline.models.common import remembered
from pipeline.models.oscillator import oscillate_any
from pipeline.quantities import Array
from pipeline.records import Excitation

PER_WIDTH = 5.0
"""Points of the grid in a half-power width: the one nearest to the peak of a resonance is 2 % below it at most."""

WIDEST = 8e-3
"""Largest step of the grid, relative: a spectrum of large damping has kinks all the same."""

LEAST_DAMPING = 0.0025
"""Ratio below which the grid becomes no finer: records of minutes do not tell narrower peaks apart."""

HALVINGS = 2
"""How often the steps beside an extremum are halved, each of which leaves a quarter of what was missed."""

CALM = 5e-3
"""Relative rise in the steps beside an extremum up to which it is left as it is: a kink hides half of that at most."""

MISSED = 1e-2
"""Share by which the largest value found may be below the true one: of 57,000 bands of 38 motions none was by 0.8 %."""

OVER = 4e-2
"""Share by which what is found may be above the true one: at a kink, where the least is, and where a band ends between
two points of the grid.  Of the same bands the least was by 2.7 % at most, the largest of a narrow band by 4.0 %."""

LOWEST, HIGHEST = -2, 3
"""Powers of ten between which the grid lies [Hz]: beyond 1 kHz an object feels the acceleration of its base."""

PIECES = 2
"""Pieces of a decade, each worked out where a band touches it: a hundred points or two, kept in one file."""

_GRAIN = 2.0**30
"""Steps to the peak in which shaking is told apart, so that what is only scaled has the same spectrum, scaled."""

_KEPT = 32768
"""Pieces of spectra that are remembered, of 5 kB as a rule: without what they are spectra of."""

_SINGLE = 4096
"""Oscillators that are remembered of each: those of what is worked on together, for which measures ask again."""

_Place = tuple[bytes, float, int]
"""Of a piece: a digest of the shaking that it is a spectrum of, the damping, and which piece it is."""

_Piece = tuple[Array, Array]


class _Pieces:
    """Pieces of spectra by their places: the latest asked for, and where a cache is lent all that were found."""

    def __init__(self) -> None:
        self._found: OrderedDict[_Place, _Piece] = OrderedDict()
        self._lock = Lock()
        self._cache: Cache | None = None

    @contextmanager
    def shared(self, cache: Cache) -> Iterator[None]:
        """Find in a cache what others who work found, and keep there what is found, until the end of the block."""
        before, self._cache = self._cache, cache
        try:
            yield
        finally:
            self._cache = before

    def of(self, shaking: Callable[[], Excitation], places: Sequence[_Place]) -> list[_Piece]:
        """Return the natural logarithms of frequencies over pieces and a step beyond, and the spectrum there.

        Parameters
        ----------
        shaking : Callable[[], Excitation]
            Gives what they are spectra of, where one is not known yet.

        Returns
        -------
        list of _Piece
        """
        with self._lock:
            there = {place: self._found[place] for place in places if place in self._found}
            for place in there:
                self._found.move_to_end(place)
        missing = [place for place in places if place not in there]
        # Others who work want the same at the same time: each begins with other ones.
        for at in np.random.default_rng().permutation(len(missing)).tolist():
            place = missing[at]
            there[place] = self._had(shaking, place)
            with self._lock:
                self._found[place] = there[place]
                if len(self._found) > _KEPT:
                    self._found.popitem(last=False)
        return [there[place] for place in places]

    def _had(self, shaking: Callable[[], Excitation], place: _Place) -> _Piece:
        lent = self._cache
        if lent is None:
            return _piece(shaking(), *place[1:])
        key = key_of(place[0].hex(), *place[1:])
        kept = lent.get(SPECTRA, key)
        if kept is not None:
            return kept.arrays["logs"], kept.arrays["values"]
        logs, values = _piece(shaking(), *place[1:])
        lent.put(SPECTRA, key, CacheEntry(arrays={"logs": logs, "values": values}))
        return logs, values


_pieces = _Pieces()


def sharing_spectra(cache: Cache | None) -> AbstractContextManager[None]:
    """Share the pieces of spectra with all who work with the same cache, within the block; None: with nobody.

    What is found is the same either way.
    """
    return nullcontext() if cache is None else _pieces.shared(cache)


def band_accelerations(motion: Excitation, low: Array, high: Array, zeta: Array) -> tuple[Array, Array]:
    """Return the least and the largest pseudo-acceleration over bands of natural frequencies.

    Parameters
    ----------
    motion : Excitation
        Along one direction; in two each oscillator answers with its longest resultant, the worst of all directions.
    low, high : ndarray, shape (n,)
        Ends of each band [Hz].
    zeta : ndarray, shape (n,)
        Damping ratio [-].

    Returns
    -------
    least, most : ndarray, shape (n,)
        [m/s2].
    """
    peak, key = _identity(motion)
    if peak == 0.0 or low.size == 0:
        return np.zeros_like(low), np.zeros_like(low)
    shaking = cache(partial(_unit_shaking, motion, peak))
    # Parameter sets differ in more than these: each band is searched once.
    order = np.lexsort((zeta, high, low))
    rows = np.column_stack([low, high, zeta])[order]
    first = np.concatenate([[True], (rows[1:] != rows[:-1]).any(axis=1)])
    place = np.empty(low.size, dtype=np.intp)
    place[order] = np.cumsum(first) - 1
    bands = rows[first]
    least, most = np.full(bands.shape[0], np.inf), np.zeros(bands.shape[0])
    begin, end = (np.clip(side, 10.0**LOWEST, 10.0**HIGHEST) for side in bands.T[:2])
    for damping in np.unique(bands[:, 2]):
        touched = []
        for piece in range(LOWEST * PIECES, HIGHEST * PIECES):
            bottom, top = 10.0 ** (piece / PIECES), 10.0 ** ((piece + 1) / PIECES)
            chosen = np.flatnonzero((bands[:, 2] == damping) & (begin <= top) & (end >= bottom))
            if chosen.size:
                touched.append((piece, bottom, top, chosen))
        found = _pieces.of(shaking, [(key, float(damping), piece) for piece, *_ in touched])
        for (_, bottom, top, chosen), (logs, values) in zip(touched, found, strict=True):
            ends = np.log([np.maximum(begin[chosen], bottom), np.minimum(end[chosen], top)])
            for fold, best in ((np.minimum, least), (np.maximum, most)):
                best[chosen] = fold(best[chosen], _between(fold, logs, values, ends))
    return peak * least[place], peak * most[place]


def pseudo_accelerations(motion: Excitation, frequency: Array, zeta: Array) -> Array:
    """Return the largest pseudo-acceleration of single oscillators, each of which is run once.

    Parameters
    ----------
    motion : Excitation
        As of `band_accelerations`.
    frequency, zeta : ndarray, shape (n,)
        Natural frequency [Hz] and damping ratio [-].

    Returns
    -------
    ndarray, shape (n,)
        [m/s2].
    """
    # Parameter sets differ in more than these.
    asked, place = np.unique(frequency + 1j * zeta, return_inverse=True)
    return np.asarray(_singles(motion).of(motion, asked)[place.reshape(-1)])


class _Singles:
    """What single oscillators do under one shaking: those that were asked for lately, as frequency + i damping."""

    def __init__(self) -> None:
        self._kept: tuple[NDArray[np.complex128], Array] = np.empty(0, np.complex128), np.empty(0)

    def of(self, motion: Excitation, asked: NDArray[np.complex128]) -> Array:
        """Return the pseudo-acceleration of oscillators that are sorted, each there once."""
        known, told = self._kept
        place = np.searchsorted(known, asked)
        there = np.zeros(asked.size, dtype=bool)
        inside = place < known.size
        there[inside] = known[place[inside]] == asked[inside]
        push = np.empty(asked.size)
        push[there] = told[place[there]]
        fresh = asked[~there]
        if fresh.size:
            w = 2.0 * np.pi * fresh.real
            push[~there] = w**2 * oscillate_any(motion, w, fresh.imag)
            every = np.concatenate([known, fresh]), np.concatenate([told, push[~there]])
            order = np.argsort(every[0])
            self._kept = (every[0][order], every[1][order]) if order.size <= _SINGLE else (asked, push)
        return push


@remembered
def _singles(_motion: Excitation) -> _Singles:
    return _Singles()


def _between(fold: np.ufunc, logs: Array, values: Array, ends: Array) -> Array:
    """Return the largest (or least) of a curve between pairs of ends (2, n), themselves included."""
    out = fold(*np.interp(ends, logs, values))
    first, last = np.searchsorted(logs, ends[0], side="left"), np.searchsorted(logs, ends[1], side="right")
    inside = np.flatnonzero(first < last)
    if inside.size:
        # Every other one is what lies between a band and the next.
        pairs = np.column_stack([first[inside], last[inside]]).reshape(-1)
        out[inside] = fold(out[inside], fold.reduceat(values, pairs)[::2])
    return np.asarray(out)


def _ways(motion: Excitation) -> tuple[Array, ...]:
    return (motion.x,) if motion.y is None else (motion.x, motion.y)


@remembered
def _identity(motion: Excitation) -> tuple[float, bytes]:
    """Return the peak of shaking, and a digest of what it is beside that."""
    peak = max(float(np.abs(way).max(initial=0.0)) for way in _ways(motion))
    digest = blake2b(np.array([motion.dt, -1.0 if motion.tail is None else motion.tail]).tobytes(), digest_size=16)
    for one in _grains(motion, peak) if peak else ():
        digest.update(one.tobytes())
    return peak, digest.digest()


def _grains(motion: Excitation, peak: float) -> list[Array]:
    return [np.rint(way / peak * _GRAIN) for way in _ways(motion)]


def _unit_shaking(motion: Excitation, peak: float) -> Excitation:
    """Return shaking with a peak of 1."""
    x, *others = (one / _GRAIN for one in _grains(motion, peak))
    return Excitation(motion.dt, x, others[0] if others else None, np.zeros_like(x), motion.tail)


def _piece(shaking: Excitation, zeta: float, piece: int) -> tuple[Array, Array]:
    whole = np.log(10.0) / PIECES
    steps = int(np.ceil(whole / min(WIDEST, 2.0 * max(zeta, LEAST_DAMPING) / PER_WIDTH)))
    logs = piece * whole + np.arange(-1, steps + 2) * (whole / steps)

    def spectrum(at: Array) -> Array:
        w = 2.0 * np.pi * np.exp(at)
        return np.asarray(w**2 * oscillate_any(shaking, w, np.full_like(w, zeta)))

    return _refined(spectrum, logs, spectrum(logs))


def _refined(of: Callable[[Array], Array], logs: Array, values: Array) -> tuple[Array, Array]:
    """Return a curve with the steps beside its extrema halved a few times."""
    for _ in range(HALVINGS):
        rise = np.diff(values)
        turns = np.flatnonzero(rise[:-1] * rise[1:] <= 0.0) + 1
        turns = turns[np.maximum(np.abs(rise[turns - 1]), np.abs(rise[turns])) > CALM * values[turns]]
        where = np.unique(np.concatenate([turns - 1, turns]))
        fresh = 0.5 * (logs[where] + logs[where + 1])
        logs, values = np.insert(logs, where + 1, fresh), np.insert(values, where + 1, of(fresh))
    return logs, values
