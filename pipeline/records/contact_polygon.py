"""Contact polygon of a standing object: the convex outline of where it touches what it stands on."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import atan2, cos, degrees, hypot, inf, isfinite, radians, sin

from pipeline.errors import InputError

FLAT = 1e-9
"""Share of its extent below which an outline has no area, and a distance to its edge is none."""

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class ContactPolygon:
    """Convex polygon around the projected centre of gravity, about whose edges an object rocks.

    Attributes
    ----------
    corners : tuple of (float, float)
        Counter-clockwise as seen from above, m about the projected centre of gravity: x along the object's width, y a
        quarter turn counter-clockwise from it.
    """

    corners: tuple[Point, ...]

    @classmethod
    def around(cls, points: Iterable[Point]) -> ContactPolygon:
        """Return the convex hull of points of contact.

        Parameters
        ----------
        points : iterable of (float, float)
            In any order, m about the projected centre of gravity.

        Returns
        -------
        ContactPolygon
            Its corners are some of the points.

        Raises
        ------
        InputError
            For points that are not finite, fewer than three, or in one line, and for a hull that does not hold the
            centre of gravity: it would fall over by itself.
        """
        from scipy.spatial import ConvexHull, QhullError

        given = list(points)
        if not all(isfinite(x) and isfinite(y) for x, y in given):
            raise InputError("the contact polygon has a point that is no finite number; correct it")
        if len(set(given)) < 3:
            raise InputError("a contact polygon needs at least three different points; give more")
        try:
            hull = ConvexHull(given)
        except QhullError as problem:
            raise InputError("the points of the contact polygon lie in one line; give the outline of it") from problem
        extent = max(hypot(*point) for point in given)
        corners = tuple((float(given[at][0]), float(given[at][1])) for at in hull.vertices)
        polygon = cls(corners)
        if hull.volume <= FLAT * extent**2:
            raise InputError("the points of the contact polygon lie in one line; give the outline of it")
        nearest = float(-hull.equations[:, 2].max())
        if nearest <= FLAT * extent:
            raise InputError(
                f"the contact polygon does not hold the centre of gravity, which lies {max(-nearest, 0.0):.4g} m "
                "beyond one of its edges: it would fall over by itself; its points are meant about the projected "
                "centre of gravity"
            )
        return polygon

    @property
    def edges(self) -> tuple[tuple[Point, Point], ...]:
        """Its edges, each from a corner to the next."""
        return tuple(zip(self.corners, (*self.corners[1:], self.corners[0]), strict=True))

    def reach(self, angle: float) -> float:
        """Return the half width in a direction: from the projected centre of gravity to the edge.

        Parameters
        ----------
        angle : float
            Degrees from x towards y.

        Returns
        -------
        float
            In m.
        """
        ux, uy = cos(radians(angle)), sin(radians(angle))
        nearest = inf
        for (x1, y1), (x2, y2) in self.edges:
            # The outward normal of an edge, as long as the edge.
            nx, ny = y2 - y1, x1 - x2
            along = nx * ux + ny * uy
            if along > 0.0:
                nearest = min(nearest, (nx * x1 + ny * y1) / along)
        return nearest

    def narrowest(self) -> tuple[float, float]:
        """Return the least half width in any direction [m], and that direction [degrees from x towards y].

        It is the distance to the nearest edge, about which an object tips first.
        """
        best, angle = inf, 0.0
        for (x1, y1), (x2, y2) in self.edges:
            nx, ny = y2 - y1, x1 - x2
            distance = (nx * x1 + ny * y1) / hypot(nx, ny)
            if distance < best:
                best, angle = distance, degrees(atan2(ny, nx)) % 360.0
        return best, angle

    @property
    def text(self) -> str:
        """Its corners as a record's cell holds them: "x y; x y; ...", to a hundredth of a millimetre."""
        return "; ".join(f"{x:.5f} {y:.5f}" for x, y in self.corners)

    @property
    def extents(self) -> tuple[float, float]:
        """How wide it is along x and along y [m]."""
        xs, ys = zip(*self.corners, strict=True)
        return max(xs) - min(xs), max(ys) - min(ys)

    def inscribed(self, most: int) -> ContactPolygon:
        """Return it with fewer corners, those whose loss costs the least area: it never grows.

        Parameters
        ----------
        most : int
            Corners that are kept.

        Returns
        -------
        ContactPolygon
            Itself, where it has no more.
        """
        corners = list(self.corners)
        while len(corners) > most:
            sides = zip([corners[-1], *corners[:-1]], corners, [*corners[1:], corners[0]], strict=True)
            lost = [(bx - ax) * (cy - ay) - (by - ay) * (cx - ax) for (ax, ay), (bx, by), (cx, cy) in sides]
            corners.pop(lost.index(min(lost)))
        return ContactPolygon(tuple(corners))
