"""First alerts: ShakeAlert's messages, with contours or a map of the shaking to be expected."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.event.message import (
    ACCELERATIONS,
    FIRST_SIGMA,
    VELOCITIES,
    Message,
    ReportedEarthquake,
    SiteShaking,
    cancelled,
    check_peaks,
    in_unit,
    kilometres,
    moment,
    number,
    position,
    refused,
)
from pipeline.quantities import Array

MOST = 100_000
"""Points of an alert's map."""

MARGIN = 0.75
"""How far beyond its points a map tells, in the distance of two of them."""

STEP = 1.5
"""ln of PGA between two contours, where there is only one: a unit of intensity (1.49 in its own messages)."""


@dataclass(frozen=True)
class Contour:
    """Within its line the shaking is as strong as this at least: g, cm/s, and points in degrees north and east."""

    pga_g: float
    pgv_cm_s: float
    line: tuple[tuple[float, float], ...]

    def holds(self, latitude: float, longitude: float) -> bool:
        """Say whether a place is within, by how often a ray from it crosses the line."""
        inside = False
        for (a, x), (b, y) in zip(self.line, (*self.line[1:], self.line[0]), strict=True):
            if (a > latitude) != (b > latitude) and longitude < x + (latitude - a) / (b - a) * (y - x):
                inside = not inside
        return inside

    def beyond(self, latitude: float, longitude: float) -> float:
        """Return how far a place is from the nearest point of the line, km."""
        return min(kilometres(latitude, longitude, *point) for point in self.line)


FIRST_NOTE = "A first alert: magnitude and extent may still change, and the range is wide (judgement)."


@dataclass(frozen=True, kw_only=True, eq=False)
class Alert(Message):
    """A ShakeAlert message.

    Attributes
    ----------
    contours : tuple of Contour
        From the weakest on.
    points : ndarray, shape (n, 4)
        Of its map, where it has one: degrees north and east, PGA [g], PGV [cm/s].
    """

    contours: tuple[Contour, ...]
    points: Array

    def at(self, latitude: float, longitude: float) -> SiteShaking:
        """Return the shaking at a place: between points, or half way between two contours, each in the logarithm.

        Raises
        ------
        MessageError
            For a place beyond the map or the weakest contour, with the distance.
        """
        if len(self.points):
            return self._between_points(latitude, longitude)
        if not self.contours:
            raise refused(
                self.file, "gm_info", "says no shaking, only the earthquake itself",
                "subscribe to the alert's contours, or wait for the first ShakeMap",
            )  # fmt: skip
        inside = [one for one in self.contours if one.holds(latitude, longitude)]
        if not inside:
            least = self.contours[0]
            raise refused(
                self.file, "site",
                f"the museum ({latitude:.4f}, {longitude:.4f}) lies {least.beyond(latitude, longitude):,.0f} km "
                f"outside of the alert's weakest contour ({least.pga_g:.2%} of g)",
                "give a message about an earthquake near the museum, or its place by --at LAT,LON",
            )  # fmt: skip
        here = inside[-1]
        stronger = [one for one in self.contours if one.pga_g > here.pga_g]
        step = math.log(stronger[0].pga_g / here.pga_g) if stronger else STEP
        faster = math.log(stronger[0].pgv_cm_s / here.pgv_cm_s) if stronger else STEP
        # Anywhere between two contours is as likely.
        sd = math.hypot(FIRST_SIGMA, step / math.sqrt(12.0))
        pga, pgv = here.pga_g * math.exp(0.5 * step), here.pgv_cm_s * math.exp(0.5 * faster)
        check_peaks(self.file, "contour", pga, pgv)
        where = f"ShakeAlert, version {self.quake.version}, between contours"
        return SiteShaking(pga, pgv, sd, sd, where, (*self.notes, FIRST_NOTE))

    def _between_points(self, latitude: float, longitude: float) -> SiteShaking:
        """Return the shaking between the nearest points of a map, in the logarithm, each by how near it is."""
        far = np.array([kilometres(latitude, longitude, *point[:2]) for point in self.points])
        near = np.argsort(far, kind="stable")[:4]
        step = max((kilometres(*self.points[near[0]][:2], *self.points[at][:2]) for at in near[1:3]), default=0.0)
        if far[near[0]] > max(MARGIN * step, 1.0):
            raise refused(
                self.file, "site",
                f"the museum ({latitude:.4f}, {longitude:.4f}) lies {far[near[0]]:,.0f} km from the nearest point of "
                "the alert's map",
                "give a message about an earthquake near the museum, or its place by --at LAT,LON",
            )  # fmt: skip
        weights = 1.0 / np.maximum(far[near], 1e-3)
        pga, pgv = np.exp(weights @ np.log(self.points[near, 2:]) / weights.sum()).tolist()
        check_peaks(self.file, "grid_data", pga, pgv)
        where = f"ShakeAlert, version {self.quake.version}, between points of its map"
        return SiteShaking(pga, pgv, FIRST_SIGMA, FIRST_SIGMA, where, (*self.notes, FIRST_NOTE))


def read_alert(file: Path, root: Any) -> Alert:
    """Read a ShakeAlert message.

    Parameters
    ----------
    file : Path
        Where it is from, for messages.
    root : lxml element
        event_message.

    Raises
    ------
    MessageError
        For one without an earthquake, or whose contours have no units.
    """
    core = root.find("core_info")
    if core is None:
        raise refused(file, "core_info", "is missing", "it was cut off, or is no event message: fetch it again")
    north, east = position(file, "core_info", core.findtext("lat"), core.findtext("lon"))
    quake = ReportedEarthquake(
        id=str(core.get("id") or "")[:100],
        magnitude=number(file, "core_info mag", core.findtext("mag")),
        latitude=north,
        longitude=east,
        depth_km=number(file, "core_info depth", core.findtext("depth")),
        time=moment(file, "core_info orig_time", core.findtext("orig_time") or ""),
        version=str(root.get("version") or "")[:20],
        scenario=str(root.get("category") or "").strip().lower() in ("test", "exercise", "scenario"),
    )
    contours = [_contour(file, one) for one in root.iterfind("gm_info/gmcontour_pred/contour")]
    ordered = tuple(sorted(contours, key=lambda one: one.pga_g))
    points = _points(file, root.find("gm_info/gmmap_pred"))
    taken_back = cancelled(root.get("message_type"))
    return Alert(file, "ShakeAlert", 1, quake, taken_back, contours=ordered, points=points)


def _points(file: Path, told: Any) -> Array:
    """Return the points of a map: lines of numbers, whose columns and units its fields name."""
    if told is None:
        return np.zeros((0, 4))
    columns = {
        str(one.get("name") or "").upper(): (int(number(file, "grid_field index", one.get("index"))) - 1, one)
        for one in told.iterfind("grid_field")
    }
    missing = [name for name in ("LAT", "LON", "PGA", "PGV") if name not in columns]
    if missing:
        raise refused(file, "gmmap_pred", f"has no field {', '.join(missing)}", "fetch the message again")
    factors = [1.0, 1.0] + [
        in_unit(file, f"grid_field {name}", columns[name][1].get("units"), units)
        for name, units in (("PGA", ACCELERATIONS), ("PGV", VELOCITIES))
    ]
    at = [columns[name][0] for name in ("LAT", "LON", "PGA", "PGV")]
    rows = [line.split() for line in (told.findtext("grid_data") or "").strip().splitlines()]
    if not rows or len(rows) > MOST or min(at) < 0 or any(len(row) <= max(at) for row in rows):
        raise refused(file, "gmmap_pred grid_data", "has no points, or too short lines", "fetch the message again")
    table = np.array([[number(file, "gmmap_pred grid_data", row[one]) for one in at] for row in rows])
    if (table[:, 2:] <= 0.0).any() or np.abs(table[:, 0]).max() > 90.0:
        raise refused(file, "gmmap_pred grid_data", "has what is no peak or no place", "fetch the message again")
    return np.asarray(table * factors)


def _contour(file: Path, one: Any) -> Contour:
    values = []
    for name, units in (("PGA", ACCELERATIONS), ("PGV", VELOCITIES)):
        element = one.find(name)
        if element is None:
            raise refused(file, f"contour {name}", "is missing", "fetch the message again")
        value = number(file, f"contour {name}", element.text) * in_unit(
            file, f"contour {name}", element.get("units"), units
        )
        if value <= 0.0:
            raise refused(file, f"contour {name}", f"{element.text!r} is no peak of shaking", "fetch the message again")
        values.append(value)
    pairs = [point.split(",") for point in (one.findtext("polygon") or "").split()]
    if len(pairs) < 3 or any(len(pair) != 2 for pair in pairs):
        raise refused(file, "contour polygon", "is no polygon of lat,lon", "fetch the message again")
    return Contour(values[0], values[1], tuple(position(file, "contour polygon", *pair) for pair in pairs))
