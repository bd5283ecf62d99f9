"""Peaks of real records beside what agencies published: `[KOUROS_RECORDS=FOLDER] python -m tests.benchmarks agencies`.

Those of the repository, and whatever a folder holds besides.  A processed file is taken as it stands, its velocity
integrated from the acceleration and the velocity that it begins with; a raw one is filtered at the corner that Kouros
chooses by itself.  Published is what a header prints, or what the agency's processed file of the same record has.
"""

from __future__ import annotations

import gzip
import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.motions.corners import choose_corner
from pipeline.motions.errors import MotionError
from pipeline.motions.filtering import highpass, remove_baseline
from pipeline.motions.grouping import grouped
from pipeline.motions.intensity import integrate
from pipeline.motions.processing import starting_velocity
from pipeline.motions.reading import open_traces
from pipeline.records import Motion

DATA = Path(__file__).parents[1] / "data" / "motions"
PROCESSED = {
    "CE89146.V1": ("CE89146.V2",),
    "np01002r_4225a_u.smc": tuple(f"np01002p_4225{one}_a.smc" for one in "abc"),
}
"""Of raw files the agency's processed ones."""

MOST = 200
"""Files of a folder that are looked at."""


def peaks(traces: Sequence[Any]) -> tuple[list[str], np.ndarray, np.ndarray, str]:
    """Return channels, PGA [m/s2] and PGV [m/s] of each, and what was done."""
    dt, count = traces[0].stats.delta, min(trace.stats.npts for trace in traces)
    factors = [trace.stats.kouros.si_factor for trace in traces]
    data = np.array([f * np.asarray(t.data[:count], float) for f, t in zip(factors, traces, strict=True)])
    names = [f"{t.stats.station}.{t.stats.channel} {t.stats.kouros.get('orientation')}" for t in traces]
    rows = np.vstack([data, np.zeros((3 - len(data), count))])
    if traces[0].stats.kouros.processed:
        start = np.zeros(3)
        said = [t.stats.kouros.get("velocity") for t in traces]
        if all(one is not None for one in said):
            start, _ = starting_velocity(
                rows, np.vstack([*[np.asarray(v)[:count] for v in said], rows[len(data) :]]), dt
            )
        motion, done = Motion(dt, rows, start=tuple(map(float, start))), "processed"
    else:
        # The horizontals first, of which a corner is chosen.
        order = sorted(range(len(data)), key=lambda i: traces[i].stats.kouros.get("orientation") in {"up", "down"})
        flat, _ = remove_baseline(rows[[*order, *range(len(data), 3)]], dt)
        corner = choose_corner(Motion(dt, flat)).frequency
        filtered, _, begin = highpass(flat, dt, corner)
        motion, done = Motion(dt, filtered, start=tuple(map(float, begin))), f"raw, high-pass {corner:.3f} Hz"
        names = [names[i] for i in order]
    speed, _ = integrate(motion)
    n = len(names)
    return names, np.abs(motion.acceleration[:n]).max(axis=1), np.abs(speed[:n]).max(axis=1), done


def rows(files: Sequence[Path]) -> Iterator[str]:
    """One line a channel: what Kouros makes of it, what is published, and the ratio."""
    known = {path.name: path for path in files}
    for of, every in grouped([(path.name, _traces(path)) for path in files]):
        traces = every[:3]
        if not traces or any(t.stats.get("kouros", {}).get("si_factor") is None for _, t in traces):
            continue
        try:
            names, pga, pgv, done = peaks([trace for _, trace in traces])
        except (MotionError, ValueError) as error:
            yield f"| {of} | not compared: {str(error)[:90]} | | | | |"
            continue
        printed = {f"{t.stats.station}.{t.stats.channel} {t.stats.kouros.get('orientation')}": t for _, t in traces}
        other = [t for name in PROCESSED.get(traces[0][0], ()) if name in known for t in _traces(known[name])]
        by_way = {str(t.stats.kouros.get("orientation")): t for t in other}
        for name, a, v in zip(names, pga, pgv, strict=True):
            one = by_way.get(name.partition(" ")[2], printed[name])
            said = one.stats.kouros.get("peak", {})
            # Of counts a header prints the largest, with the sensor's offset.
            counts = one.stats.kouros.units == "counts" and one.stats._format != "KNET"
            said_a, said_v = None if counts else said.get("acceleration"), said.get("velocity")
            if other and said_v is None:
                _, _, (said_v, *_), _ = peaks([one])
            yield f"| {of[:34]} {name} | {done} | {_pair(100 * a, said_a, 100)} | {_pair(100 * v, said_v, 100)} |"


def _pair(ours: float, said: float | None, scale: float) -> str:
    said = scale * abs(said or 0.0)
    return f"{ours:.4g} | {said:.4g} ({ours / said:.3f})" if said else f"{ours:.4g} | none"


def _traces(path: Path) -> list[Any]:
    try:
        return list(open_traces(path, []))
    except MotionError:
        return []


def agencies() -> None:
    """Print the table."""
    print("| record, channel | what was done | PGA [cm/s2] | published (ratio) | PGV [cm/s] | published (ratio) |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for packed in sorted(DATA.glob("*.gz")):
            (Path(folder) / packed.stem).write_bytes(gzip.decompress(packed.read_bytes()))
        here = sorted(Path(folder).iterdir())
        there = os.environ.get("KOUROS_RECORDS")
        more = [path for path in sorted(Path(there).rglob("*")) if path.is_file()][:MOST] if there else []
        for line in [*rows(here), *rows([path for path in more if path.name not in {one.name for one in here}])]:
            print(line, flush=True)
