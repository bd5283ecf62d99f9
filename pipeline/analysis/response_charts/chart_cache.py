"""Charts as files: sealed, named after what they depend on, and removed when nothing asks for them any more."""

import hashlib
import json
import os
import struct
import time
import warnings
import zlib
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from pipeline.analysis.response_charts.refine import Cells
from pipeline.analysis.response_charts.response_chart import ResponseChart
from pipeline.kernels import KERNEL_VERSION
from pipeline.records import ChartAxis
from pipeline.resources import arrays, digest_of, replacing

LARGEST = 16_000_000
"""Bytes beyond which a file is no chart: the largest have 0.5 MB."""

DAY = 86_400.0
"""Seconds."""

_MOTION = 16
"""Letters of a motion's hash in the name of a file."""

_CELLS = tuple(field.name for field in fields(Cells))

_UNREADABLE = (
    OSError, ValueError, KeyError, IndexError, TypeError, EOFError, BadZipFile, zlib.error, struct.error,
    NotImplementedError, RuntimeError, MemoryError, OverflowError, SyntaxError,
)  # fmt: skip
"""What numpy and zipfile raise when they are handed bytes that nobody wrote on purpose."""


class ChartWarning(UserWarning):
    """A kept chart could not be used; it is built again."""


@cache
def _code() -> str:
    """What computes a chart besides the kernels, as one hash: models, records, charts and the search of directions."""
    return digest_of("analysis", "models", "records")[:12]


def code_version() -> str:
    """Return the version of the kernels and of all other code that a chart depends on."""
    return f"{KERNEL_VERSION}-{_code()}"


def chart_identity(motion: str, **parts: object) -> str:
    """Return the identity of a chart, which is the name of its file too: versions, motion, a hash of all else.

    motion : its hash
    parts  : what the chart depends on besides the code, the kernels and the motion
    """
    digest = hashlib.sha256(json.dumps({"motion": motion, **parts}, sort_keys=True).encode())
    return f"{code_version()}-{motion[:_MOTION]}-{digest.hexdigest()[:32]}"


def keep(folder: Path, key: str, chart: ResponseChart) -> None:
    """Keep a chart, atomically; a folder that cannot be written only costs the next process its time."""
    said = json.dumps(
        {
            "key": key,
            "axis": chart.axis.name,
            "outputs": chart.outputs,
            "low": chart.low,
            "high": chart.high,
            "settled": chart.settled,
            "tolerance": chart.tolerance,
        }
    )
    cells: dict[str, Any] = {name: np.asarray(getattr(chart.cells, name)) for name in _CELLS}
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(folder / f"{key}.npz") as aside, aside.open("wb") as stream:
            np.savez(stream, said=np.array(said), seal=np.array(_seal(said, cells)), **cells)


def recall(folder: Path, key: str, axis: ChartAxis) -> ResponseChart | None:
    """Return the chart that was kept under this very identity, bit for bit, and note that it was used; else None.

    A damaged or foreign file is never believed: a ChartWarning names it, and the chart counts as not kept.
    """
    file = folder / f"{key}.npz"
    try:
        if file.stat().st_size > LARGEST:
            raise ValueError("it is too large")
        with arrays(file) as kept:
            text, seal = str(kept["said"]), str(kept["seal"])
            cells = {name: kept[name] for name in _CELLS}
        said = json.loads(text)
        if seal != _seal(text, cells):
            raise ValueError("its contents are not what was written")
        if said["key"] != key or said["axis"] != axis.name:
            raise ValueError("it is another chart under this name")
    except FileNotFoundError:
        return None
    except _UNREADABLE as problem:
        warnings.warn(f"{file}: is no chart ({problem}); it is built again", ChartWarning, stacklevel=2)
        return None
    with suppress(OSError):
        os.utime(file)
    nodes = int(cells.pop("nodes"))
    outputs = tuple(said["outputs"])
    return ResponseChart(
        axis, outputs, said["low"], said["high"], said["settled"], said["tolerance"], Cells(**cells, nodes=nodes)
    )


def _seal(said: str, cells: Mapping[str, Any]) -> str:
    digest = hashlib.sha256(said.encode())
    for name, values in cells.items():
        digest.update(f"{name} {values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()


def prune(folder: Path, *, days: float, most_bytes: int, using: Collection[str] = ()) -> None:
    """Remove charts of other versions, those of motions that nobody used for some days, and the oldest of too many.

    days       : since the last use of any chart of a motion
    most_bytes : of all charts together; what was used longest ago goes first
    using      : hashes of motions that are in use now, whether or not a chart of them was asked for
    Files of other names are not touched, and what cannot be removed stays.
    """
    now, version = time.time(), code_version()
    used = {motion[:_MOTION] for motion in using}
    charts: list[tuple[float, int, str, Path]] = []
    for file in folder.glob("*.npz") if folder.is_dir() else ():
        try:
            facts = file.stat()
        except OSError:
            continue
        parts = file.stem.split("-")
        if len(parts) != 4:
            continue
        if f"{parts[0]}-{parts[1]}" != version:
            remove(file)
        elif parts[2] in used:
            with suppress(OSError):
                os.utime(file)
            charts.append((now, facts.st_size, parts[2], file))
        else:
            charts.append((facts.st_mtime, facts.st_size, parts[2], file))
    last: dict[str, float] = {}
    for at, _, motion, _ in charts:
        last[motion] = max(last.get(motion, at), at)
    total = 0
    for _, size, motion, file in sorted(charts, key=lambda chart: (-chart[0], chart[3].name)):
        if now - last[motion] > days * DAY or total + size > most_bytes:
            remove(file)
        else:
            total += size


def remove(file: Path) -> None:
    """Remove a file; what cannot be removed stays."""
    with suppress(OSError):
        file.unlink()
