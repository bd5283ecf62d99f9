"""Histories that were run on an earlier night, row for row, so that one changed motion costs only its own.

What a history gives depends on the model, its parameters, the motion and how finely it is run, and on nothing else; a
night that must judge a sheet again because something changed finds here all that did not.
"""

import hashlib
import json
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.response_charts.chart_cache import DAY, code_version, remove
from pipeline.quantities import Array
from pipeline.records import Columns
from pipeline.resources import arrays, replacing

_UNREADABLE = (OSError, ValueError, KeyError, BadZipFile, EOFError, TypeError)


class Histories:
    """The histories of one sheet: those that were kept, and those that are used or run now, which are kept again.

    file : where they are kept; None: nowhere, and only what is asked for twice is run once.  What is damaged, or was
           written by other code, counts as nothing
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        self._old = {} if file is None else _read(file)
        self._places: dict[str, dict[bytes, int]] = {}
        self._used: dict[str, dict[bytes, Array]] = {}
        self._names: dict[str, tuple[str, ...]] = {}

    def recall(self, key: str, values: Mapping[str, Array]) -> tuple[NDArray[np.bool_], Columns]:
        """Return which rows are there, and the columns of those.

        key    : of everything but the parameters (see `history_key`)
        values : the parameters, (n,) each
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
        there = np.array([row in used for row in rows], dtype=bool)
        if not there.any():
            return there, {}
        found = np.array([used[row] for row in rows if row in used])
        return there, {name: np.ascontiguousarray(found[:, i]) for i, name in enumerate(self._names[key])}

    def note(self, key: str, values: Mapping[str, Array], columns: Columns) -> None:
        """Take down histories that were run now."""
        self._names[key] = tuple(columns)
        table = np.column_stack([np.asarray(column, dtype=np.float64) for column in columns.values()])
        self._used.setdefault(key, {}).update(zip(_rows(values), table, strict=True))

    def keep(self) -> None:
        """Write what was used, atomically; a folder that cannot be written only costs the next night its time."""
        if self._file is None:
            return
        tables: dict[str, Any] = {"code": np.array(code_version())}
        for number, (key, used) in enumerate((key, used) for key, used in self._used.items() if used):
            parameters = np.frombuffer(b"".join(used), dtype=np.float64).reshape(len(used), -1)
            tables[f"t{number}"] = np.hstack([parameters, np.array(list(used.values()))])
            tables[f"k{number}"] = np.array(json.dumps([key, *self._names[key]]))
        with suppress(OSError):
            self._file.parent.mkdir(parents=True, exist_ok=True)
            with replacing(self._file) as aside, aside.open("wb") as stream:
                np.savez(stream, **tables)


def prune(folder: Path, *, days: float, most_bytes: int) -> None:
    """Remove the files that nobody wrote or used for some days, and the oldest of too many."""
    now, total = time.time(), 0
    files = []
    for file in folder.glob("*.npz") if folder.is_dir() else ():
        with suppress(OSError):
            facts = file.stat()
            files.append((facts.st_mtime, facts.st_size, file))
    for used, size, file in sorted(files, key=lambda one: (-one[0], one[2].name)):
        if now - used > days * DAY or total + size > most_bytes:
            remove(file)
        else:
            total += size


def history_key(*parts: object) -> str:
    """Return the name of everything that a history depends on besides its parameters."""
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


def _rows(values: Mapping[str, Array]) -> list[bytes]:
    # Bit for bit, so that NaN (not given) equals NaN.
    matrix = np.ascontiguousarray(np.column_stack(list(values.values())), dtype=np.float64)
    return [row.tobytes() for row in matrix]


def _read(file: Path) -> dict[str, tuple[tuple[str, ...], Array]]:
    found = {}
    try:
        with arrays(file) as kept:
            if str(kept["code"]) != code_version():
                return {}
            for number in range((len(kept.files) - 1) // 2):
                key, *names = json.loads(str(kept[f"k{number}"]))
                table = kept[f"t{number}"]
                if table.ndim != 2 or table.dtype != np.float64 or table.shape[1] < len(names):
                    raise ValueError("its tables do not fit")
                found[str(key)] = (tuple(map(str, names)), table)
    except _UNREADABLE:
        return {}
    return found
