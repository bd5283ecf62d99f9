"""Histories that were run on an earlier night, row for row, so that one changed motion costs only its own.

What a history gives depends on the model, its parameters, the motion and how finely it is run, and on nothing else; a
night that must judge a sheet again because something changed finds here all that did not.
"""

from collections.abc import Mapping
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from pipeline.cache import HISTORIES, Cache, CacheEntry
from pipeline.quantities import Array
from pipeline.records import Columns

COMMON = 300
"""Parameter sets of a model under a motion that are common to all who work in a process: of those that tables give,
such as a friction, there are few, and all objects share them."""

CommonHistories = dict[str, tuple[tuple[str, ...], dict[bytes, Array]]]
"""By key, the names of the columns and the histories by their parameters."""


class Histories:
    """The histories of what is worked on together: those that were kept, and those used or run now, to be kept.

    Parameters
    ----------
    cache : Cache, optional
        None: nothing is kept, and only what is asked for twice is run once.
    key : str, optional
        Under which they are kept together.
    common : CommonHistories, optional
        Those of this process that others who work ask for too.
    """

    def __init__(self, cache: Cache | None = None, key: str = "", common: CommonHistories | None = None) -> None:
        self._cache, self._key, self._common = cache, key, common
        self._old = {} if cache is None else _tables(cache.get(HISTORIES, key))
        self._places: dict[str, dict[bytes, int]] = {}
        self._used: dict[str, dict[bytes, Array]] = {}
        self._names: dict[str, tuple[str, ...]] = {}

    def recall(self, key: str, values: Mapping[str, Array]) -> tuple[NDArray[np.bool_], Columns]:
        """Return which rows are there, and the columns of those.

        Parameters
        ----------
        key : str
            Of everything but the parameters, see `pipeline.cache.key_of`.
        values : mapping of str to ndarray, shape (n,)
            The parameters, in SI; those that are not given are NaN.

        Returns
        -------
        there : ndarray of bool, shape (n,)
        columns : dict of str to ndarray, shape (there.sum(),)
        """
        rows = _rows(values)
        used = self._used.setdefault(key, {})
        if key in self._old:
            names, table = self._old[key]
            self._names[key] = names
            if key not in self._places:
                parameters = np.ascontiguousarray(table[:, : len(values)])
                self._places[key] = {row.tobytes(): at for at, row in enumerate(parameters)}
            places = self._places[key]
            used.update((row, table[places[row], len(values) :]) for row in rows if row in places and row not in used)
        if self._common is not None and key in self._common:
            names, common = self._common[key]
            self._names[key] = names
            used.update((row, common[row]) for row in rows if row not in used and row in common)
        there = np.array([row in used for row in rows], dtype=bool)
        if not there.any():
            return there, {}
        found = np.array([used[row] for row in rows if row in used])
        return there, {name: np.ascontiguousarray(found[:, i]) for i, name in enumerate(self._names[key])}

    def note(self, key: str, values: Mapping[str, Array], columns: Columns) -> None:
        """Take down histories that were run now.

        Parameters
        ----------
        key, values
            As in `recall`.
        columns : mapping of str to ndarray, shape (n,)
            What they gave.
        """
        self._names[key] = tuple(columns)
        table = np.column_stack([np.asarray(column, dtype=np.float64) for column in columns.values()])
        fresh = dict(zip(_rows(values), table, strict=True))
        self._used.setdefault(key, {}).update(fresh)
        if self._common is not None:
            _, common = self._common.setdefault(key, (self._names[key], {}))
            for row, told in islice(fresh.items(), max(0, COMMON - len(common))):
                common[row] = told

    def keep(self) -> None:
        """Keep what was used."""
        if self._cache is None:
            return
        used = {key: rows for key, rows in self._used.items() if rows}
        arrays = {}
        for number, rows in enumerate(used.values()):
            parameters = np.frombuffer(b"".join(rows), dtype=np.float64).reshape(len(rows), -1)
            arrays[str(number)] = np.hstack([parameters, np.array(list(rows.values()))])
        said = {"tables": [[key, *self._names[key]] for key in used]}
        self._cache.put(HISTORIES, self._key, CacheEntry(said, arrays))


def _rows(values: Mapping[str, Array]) -> list[bytes]:
    # Bit for bit, so that NaN (not given) equals NaN.
    matrix = np.ascontiguousarray(np.column_stack(list(values.values())), dtype=np.float64)
    return [row.tobytes() for row in matrix]


def _tables(kept: CacheEntry | None) -> dict[str, tuple[tuple[str, ...], Array]]:
    if kept is None:
        return {}
    return {key: (tuple(names), kept.arrays[str(at)]) for at, (key, *names) in enumerate(kept.said["tables"])}
