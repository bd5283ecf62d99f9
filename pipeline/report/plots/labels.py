"""Where the labels of a picture fit: inside areas, beside marks, below each other."""

from collections.abc import Sequence

import numpy as np

from pipeline.quantities import Array
from pipeline.report.plots.svg import Point

LETTER = 6.3
"""Mean width in pixels of a letter at the 12 pixel size of chart text; only used to keep labels apart."""


def spread(wanted: Sequence[float], gap: float, top: float, bottom: float) -> list[float]:
    """Return sorted positions moved apart until no two are closer than the gap, between top and bottom if they fit."""
    placed: list[float] = []
    for y in wanted:
        placed.append(max(y, placed[-1] + gap if placed else top))
    limit = bottom
    for i in reversed(range(len(placed))):
        placed[i] = min(placed[i], limit)
        limit = placed[i] - gap
    return placed


def clear(place: Point, half: float, mark: Point) -> bool:
    """Say whether a label at a place, with half its width in pixels, is out of the way of a mark and its own label."""
    # A mark's own label reaches some 90 pixels to either side of it and 24 above or below.
    return abs(place[0] - mark[0]) > half + 90 or abs(place[1] - mark[1]) > 34


def inside(x: float, y: float, px: Sequence[float], py: Sequence[float]) -> bool:
    """Say whether a point lies in a closed polygon (even-odd rule)."""
    within = False
    for i in range(len(px)):
        x0, y0, x1, y1 = px[i - 1], py[i - 1], px[i], py[i]
        if (y0 > y) != (y1 > y) and x < (x1 - x0) * (y - y0) / (y1 - y0) + x0:
            within = not within
    return within


def roomy(px: Sequence[float], py: Sequence[float], half: float) -> list[Point]:
    """Return places for a label in a polygon.

    Parameters
    ----------
    px, py : sequence of float, shape (n,)
        Corners of the polygon in pixels.
    half : float
        Half the label's width in pixels.

    Returns
    -------
    list of Point
        Points of a grid where the whole label lies inside, the one farthest from the sides first; none for a polygon
        that is too thin.
    """
    across = np.linspace(min(px), max(px), 26)[1:-1]
    up = np.linspace(min(py), max(py), 26)[1:-1]
    x, y = (grid.ravel() for grid in np.meshgrid(across, up, indexing="ij"))
    held = np.ones(x.size, bool)
    for dx in (-half, 0.0, half):
        for dy in (-7.0, 7.0):
            held &= _all_inside(x + dx, y + dy, np.array(px), np.array(py))
    places: list[tuple[float, float, float]] = []
    for a, b in zip(x[held].tolist(), y[held].tolist(), strict=True):
        room = min(_distance((a, b), (px[i - 1], py[i - 1]), (px[i], py[i])) for i in range(len(px)))
        if room > 8.0:
            places.append((-room, a, b))
    return [(a, b) for _, a, b in sorted(places)]


def _all_inside(x: Array, y: Array, px: Array, py: Array) -> Array:
    """Return which points (m,) lie in a closed polygon of n corners, as `inside` says of one."""
    x0, y0 = np.roll(px, 1), np.roll(py, 1)
    crosses = (y0 > y[:, None]) != (py > y[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        where = (px - x0) * (y[:, None] - y0) / (py - y0) + x0
    within: Array = np.count_nonzero(crosses & (x[:, None] < where), axis=1) % 2 == 1
    return within


def _distance(point: Point, start: Point, end: Point) -> float:
    (x, y), (x0, y0), (x1, y1) = point, start, end
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    share = min(1.0, max(0.0, ((x - x0) * dx + (y - y0) * dy) / square)) if square else 0.0
    return float(np.hypot(x - x0 - share * dx, y - y0 - share * dy))
