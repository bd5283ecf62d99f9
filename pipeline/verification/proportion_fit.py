"""Proportions of objects by class: ratios of their sizes, measured on a museum's file, and held against another's.

The rows of tables/proportions.csv are the 5th, 50th and 95th percentile of the ratio of two sizes over the objects of a
class, the class being the one that Kouros itself gives.  Where there are few such objects the percentiles of a class
that is built alike take their place, made wider: judgement.
"""

from __future__ import annotations

import csv
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np

from pipeline.analysis.classify import classify
from pipeline.analysis.sizes import SIZES, ratio_of, sizes_known
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.records import Item, Support
from pipeline.tables.assumed import assumed
from pipeline.tables.assumed_rows import NO_MODEL, WHEN_HELD

ENOUGH = 20
"""Objects from which the percentiles of a class are its own."""

LIKE = {"standing_figure": "statue", "clock": "cabinet", "chandelier": "lamp"}
"""Class of few objects -> the one whose proportions it is taken to have: judgement."""

LOOSE = ("object", "small_flat", "mounted")
"""Classes of things of all shapes, of which one size says nothing of the others."""

WIDER = 1.5
"""By how much the range of another class is made wider on either side: judgement."""

PERCENTILES = (5.0, 50.0, 95.0)

TALL = {0.3: "from 0.3 to 1 m high", 1.0: "from 1 m high on"}
"""Heights [m] from which what stands has proportions of its own, and how they are told: tall things are slender."""

COLUMNS = ("class", "size", "of", "above", "low", "value", "high", "known", "source")

Ratios = Mapping[str, Sequence[tuple[float, float, float]]]
"""By class, height, width and depth of its objects [m]."""


def sizes_by_class(items: Iterable[Item]) -> dict[str, list[tuple[float, float, float]]]:
    """Return height, width and depth [m] of the objects of which all three are recorded, by class."""
    out: dict[str, list[tuple[float, float, float]]] = defaultdict(list)
    for item in items:
        height, width, depth = item.height_m, item.width_m, item.depth_m
        if height and width and depth:
            out[classify(item).object_class].append((height, width, depth))
    return dict(out)


def rows_of(sizes: Ratios, where: str) -> list[dict[str, str]]:
    """Return the rows of the table.

    Parameters
    ----------
    sizes : mapping of str to sequence of (float, float, float)
        By class, see `sizes_by_class`.
    where : str
        What was measured, in the words of a source.

    Returns
    -------
    list of dict
        Those of each class of Kouros's own table for which there is a model, each pair of sizes once.

    Raises
    ------
    KeyError
        For a class of few objects that is like no other one.
    """
    out = []
    for name, row in assumed().classes.items():
        if NO_MODEL in row.models:
            continue
        mine, like = sizes.get(name, ()), name
        if len(mine) < ENOUGH:
            like = LIKE[name]
        some = np.array(sizes[like])
        for (at, size), (of_at, of) in permutations(enumerate(SIZES), 2):
            if row.round and "height" not in (size, of):
                continue
            ratios = some[:, at] / some[:, of_at]
            if WHEN_HELD in row.models:
                # How thick it is, over the smaller side of its face.
                ratios = np.divide(*np.sort(some, axis=1)[:, :2].T)
            low, value, high = np.percentile(ratios, PERCENTILES)
            source = f"{where}: 5th, 50th and 95th percentile of {len(some)} records"
            if like != name:
                low, high = low / WIDER, high * WIDER
                source = f"judgement: {len(mine)} records only; those of {len(some)} of class {like}, made wider"
            out.append(
                {
                    "class": name,
                    "size": size,
                    "of": of,
                    "above": "0",
                    "low": f"{low:.3g}",
                    "value": f"{value:.3g}",
                    "high": f"{high:.3g}",
                    "known": "2" if name in LOOSE else "1",
                    "source": source,
                }
            )
    return out


def tall_rows_of(sizes: Ratios, where: str) -> list[dict[str, str]]:
    """Return the rows of what stands and is tall, of classes of which there are enough such objects.

    Parameters
    ----------
    sizes, where : mapping, str
        As of `rows_of`, of several museums together, as one has few of these.

    Returns
    -------
    list of dict
        Width and depth over height, by class and by the heights of `TALL`.
    """
    out = []
    steps = (*TALL, float("inf"))
    for name, row in assumed().classes.items():
        if NO_MODEL in row.models or WHEN_HELD in row.models or row.support is not Support.FREESTANDING:
            continue
        some = np.array(sizes.get(name, ())).reshape(-1, 3)
        for above, below in pairwise(steps):
            tall = some[(some[:, 0] >= above) & (some[:, 0] < below)]
            if len(tall) < ENOUGH:
                continue
            for at, size in enumerate(SIZES[1:], start=1):
                low, value, high = (f"{one:.3g}" for one in np.percentile(tall[:, at] / tall[:, 0], PERCENTILES))
                source = f"{where}: 5th, 50th and 95th percentile of {len(tall)} records {TALL[above]}"
                known = "2" if name in LOOSE else "1"
                values = (name, size, SIZES[0], f"{above:g}", low, value, high, known, source)
                out.append(dict(zip(COLUMNS, values, strict=True)))
    return out


def inside(items: Iterable[Item]) -> dict[str, tuple[int, int]]:
    """Return by class how many sizes were hidden one at a time, and how many lay within the range that was assumed."""
    out: dict[str, tuple[int, int]] = {}
    for item in items:
        known = sizes_known(item)
        if len(known) < len(SIZES):
            continue
        scene = classify(item)
        row = assumed().classes[scene.object_class]
        for hidden, true in known.items():
            left = {name: size for name, size in known.items() if name != hidden}
            found = ratio_of(row, hidden, left)
            if found is not None:
                tried, right = out.get(row.name, (0, 0))
                out[row.name] = tried + 1, right + (found.low <= true <= found.high)
    return out


def main() -> None:
    """Write the table from a museum's file and the mapping that reads it, in the words of a source.

    What is tall is of all files and mappings that follow, with the words of their source before them.
    """
    path, mapping, where, *tall = sys.argv[1:]
    writer = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows_of(sizes_by_class(_items(path, mapping)), where))
    if tall:
        words, *files = tall
        items = [item for file, reads in zip(files[::2], files[1::2], strict=True) for item in _items(file, reads)]
        writer.writerows(tall_rows_of(sizes_by_class(items), words))


def _items(path: str, mapping: str) -> Sequence[Item]:
    return read_items(Path(path), load_mapping(mapping)).items


if __name__ == "__main__":
    main()
