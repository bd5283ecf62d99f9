r"""Largest and least pseudo-acceleration of an oscillator over a band of natural frequencies: searched, not sampled.

A response spectrum is no monotone function of the frequency: its largest value over a band lies inside it as a rule.
It is looked for on a grid that is finer than any peak of it can be narrow, the half-power width 2 zeta f of a resonance
that lasts, and closer where it has an extremum.  The grid does not depend on the band, so that a spectrum is worked out
once for all who ask: a piece of it at a time, for each shaking and damping.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from hashlib import blake2b
from threading import Lock

import numpy as np

from pipeline.cache import SPECTRA, Cache, CacheEntry, key_of
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

PIECES = 5
"""Pieces of a decade, each worked out where a band touches it: a few dozen points, which run side by side."""

_GRAIN = 2.0**30
"""Steps to the peak in which shaking is told apart, so that what is only scaled has the same spectrum, scaled."""

_KEPT = 65536
"""Pieces of spectra that are remembered, of 2 kB as a rule: without what they are spectra of."""


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

    def of(self, shaking: Excitation, places: Sequence[_Place]) -> list[_Piece]:
        """Return the natural logarithms of frequencies over pieces and a step beyond, and the spectrum there."""
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

    def _had(self, shaking: Excitation, place: _Place) -> _Piece:
        cache = self._cache
        if cache is None:
            return _piece(shaking, *place[1:])
        key = key_of(place[0].hex(), *place[1:])
        kept = cache.get(SPECTRA, key)
        if kept is not None:
            return kept.arrays["logs"], kept.arrays["values"]
        logs, values = _piece(shaking, *place[1:])
        cache.put(SPECTRA, key, CacheEntry(arrays={"logs": logs, "values": values}))
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
    peak = max(float(np.abs(way).max(initial=0.0)) for way in _ways(motion))
    if peak == 0.0 or low.size == 0:
        return np.zeros_like(low), np.zeros_like(low)
    key, shaking = _unit_shaking(motion, peak)
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


def _unit_shaking(motion: Excitation, peak: float) -> tuple[bytes, Excitation]:
    """Return shaking with a peak of 1, and a digest of its contents before it."""
    grains = [np.rint(way / peak * _GRAIN) for way in _ways(motion)]
    digest = blake2b(np.array([motion.dt, -1.0 if motion.tail is None else motion.tail]).tobytes(), digest_size=16)
    for one in grains:
        digest.update(one.tobytes())
    x, y = grains[0] / _GRAIN, grains[1] / _GRAIN if len(grains) > 1 else None
    return digest.digest(), Excitation(motion.dt, x, y, np.zeros_like(x), motion.tail)


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
