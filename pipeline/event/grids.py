"""Maps of shaking: ShakeMap's grid.xml of versions 3 and 4, between whose points is interpolated."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.event.message import (
    ACCELERATIONS,
    PGA_SIGMA,
    PGV_SIGMA,
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

MOST = 4_000_000
"""Points of a grid."""

MOST_SD = 3.0
"""Standard deviations of ln: more is none."""

WIDE = 0.2
"""Degrees between points from which on a reader is told: judgement; ShakeMap has 0.008 to 0.07."""

_LEAST = {"PGA": 5e-5, "PGV": 5e-3}
"""What is printed as 0.00: half of the last digit, in g and cm/s."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Grid(Message):
    """A map of the shaking.

    Attributes
    ----------
    longitudes, latitudes : ndarray, shapes (n,), (m,)
        Of its points, degrees, rising.
    fields : mapping of str to ndarray, shape (m, n)
        PGA [g], PGV [cm/s], STDPGA and STDPGV [of ln].
    told : mapping of str to float
        Standard deviations of ln that hold for the whole map, by "pga" and "pgv".
    """

    longitudes: Array
    latitudes: Array
    fields: Mapping[str, Array]
    told: Mapping[str, float]

    def at(self, latitude: float, longitude: float) -> SiteShaking:
        """Return the shaking at a place: between four points, straight in the logarithm.

        Raises
        ------
        MessageError
            For a place beyond the map, with the distance, and where the map has no number.
        """
        fields, told = self.fields, self.told
        # A map across the date line goes beyond 180 degrees.
        west = float(self.longitudes[0])
        east = west + (longitude - west) % 360.0
        within = (float(np.clip(latitude, *_ends(self.latitudes))), float(np.clip(east, *_ends(self.longitudes))))
        if not math.isclose(within[0], latitude, abs_tol=1e-9) or not math.isclose(within[1], east, abs_tol=1e-9):
            nearest = min(
                kilometres(latitude, longitude, within[0], one) for one in (within[1], *_ends(self.longitudes))
            )
            raise refused(
                self.file, "site",
                f"the museum ({latitude:.4f}, {longitude:.4f}) lies {nearest:,.0f} km outside of the map",
                "give the map of an earthquake near the museum, or its place by --at LAT,LON",
            )  # fmt: skip
        pga = self._between(fields["PGA"], *within, least=_LEAST["PGA"])
        pgv = self._between(fields["PGV"], *within, least=_LEAST["PGV"]) if "PGV" in fields else None
        notes: list[str] = []
        sd = {}
        for name, relation in (("pga", PGA_SIGMA), ("pgv", PGV_SIGMA)):
            field = fields.get(f"STD{name.upper()}")
            said = 0.0 if field is None else self._between(field, *within)
            if said < 0.0 or said > MOST_SD:
                raise refused(
                    self.file, f"grid_data STD{name.upper()}", f"{said:g} is no standard deviation of a logarithm",
                    "fetch the map again",
                )  # fmt: skip
            # Nothing is sure: 0 is printed where the map does not say it.
            if said > 0.0:
                sd[name] = said
            elif told.get(name, 0.0) > 0.0:
                sd[name] = told[name]
            elif name == "pgv" and "STDPGA" in fields and "STDPGV" not in fields:
                sd[name] = sd["pga"]
                notes.append("The map does not say how sure its PGV is: taken to be as sure as its PGA (judgement).")
            else:
                sd[name] = relation
                notes.append(
                    f"The map does not say how sure its {name.upper()} is: {relation:g} of ln is taken, what relations "
                    "of shaking have between and within earthquakes (Boore et al. 2014)."
                )
        check_peaks(self.file, "grid_data", pga, pgv)
        steps = max(float(np.diff(self.latitudes).max()), float(np.diff(self.longitudes).max()))
        if steps > WIDE:
            notes.append(
                f"The map's points lie up to {steps:.2g} degrees apart: it hardly tells what lies between them."
            )
        version = f", version {self.quake.version}" if self.quake.version else ""
        return SiteShaking(pga, pgv, sd["pga"], sd["pgv"], f"ShakeMap{version}, interpolated", (*self.notes, *notes))

    def _between(self, field: Array, latitude: float, longitude: float, least: float | None = None) -> float:
        rows, across = _weights(self.latitudes, latitude), _weights(self.longitudes, longitude)
        total = 0.0
        for row, by_row in rows:
            for column, by_column in across:
                weight, value = by_row * by_column, float(field[row, column])
                if weight == 0.0:
                    continue
                if not math.isfinite(value) or (least is not None and value < 0.0):
                    raise refused(
                        self.file, "grid_data", f"no number at the museum ({latitude:.4f}, {longitude:.4f})",
                        "wait for the next version of the map",
                    )  # fmt: skip
                total += weight * (value if least is None else math.log(max(value, least)))
        return total if least is None else math.exp(total)


def _ends(values: Array) -> tuple[float, float]:
    return float(values[0]), float(values[-1])


def _weights(points: Array, value: float) -> tuple[tuple[int, float], tuple[int, float]]:
    at = int(np.clip(np.searchsorted(points, value, side="right") - 1, 0, points.size - 2))
    share = (value - float(points[at])) / float(points[at + 1] - points[at])
    return (at, 1.0 - share), (at + 1, share)


def read_grid(file: Path, root: Any) -> Grid:
    """Read a ShakeMap grid.

    Parameters
    ----------
    file : Path
        Where it is from, for messages.
    root : lxml element
        shakemap_grid.

    Raises
    ------
    MessageError
        For a grid without PGA, without units, cut off, or whose points make no grid.
    """
    space = {"s": root.nsmap.get(None) or ""} if root.nsmap.get(None) else None

    def find(name: str) -> list[Any]:
        return list(root.findall(f"s:{name}" if space else name, space))

    quake = _quake(file, root, find("event"))
    columns, units = {}, {}
    for one in find("grid_field"):
        name = str(one.get("name") or "").upper()
        columns[name] = int(number(file, f"grid_field {name}", one.get("index"))) - 1
        units[name] = one.get("units")
    missing = [name for name in ("LON", "LAT", "PGA") if name not in columns]
    if missing:
        raise refused(file, "grid_field", f"has no {', '.join(missing)}", "take grid.xml of the event's ShakeMap")
    factors = {"PGA": in_unit(file, "grid_field PGA", units["PGA"], ACCELERATIONS)}
    if "PGV" in columns:
        factors["PGV"] = in_unit(file, "grid_field PGV", units["PGV"], VELOCITIES)
    table, shape = _table(file, find("grid_specification"), find("grid_data"), columns)
    longitudes, latitudes = (table[:, columns[name]].reshape(shape) for name in ("LON", "LAT"))
    # Rows go from north to south, or the other way.
    down = slice(None, None, -1) if latitudes[0, 0] > latitudes[-1, 0] else slice(None)
    east, north = longitudes[0], latitudes[down, 0]
    regular = np.ptp(longitudes, axis=0).max() < 1e-3 and np.ptp(latitudes, axis=1).max() < 1e-3
    on_earth = np.abs(latitudes).max() <= 90.0 and np.abs(longitudes).max() <= 540.0
    # Of what is no number nothing is true here.
    if not (regular and on_earth and (np.diff(east) > 0.0).all() and (np.diff(north) > 0.0).all()):
        raise refused(file, "grid_data", "its points make no regular grid", "fetch the map again")
    fields: dict[str, Array] = {
        str(name): factors.get(name, 1.0) * table[:, columns[name]].reshape(shape)[down]
        for name in ("PGA", "PGV", "STDPGA", "STDPGV")
        if name in columns
    }
    told = {
        str(one.get("name")): number(file, "event_specific_uncertainty", one.get("value"))
        for one in find("event_specific_uncertainty")
    }
    return Grid(
        file, "ShakeMap", 3, quake, cancelled(root.get("map_status")),
        longitudes=east, latitudes=north, fields=fields, told=told,
    )  # fmt: skip


def _quake(file: Path, root: Any, events: list[Any]) -> ReportedEarthquake:
    if not events:
        raise refused(file, "event", "is missing", "it was cut off, or is no grid.xml: fetch it again")
    one = events[0]
    north, east = position(file, "event", one.get("lat"), one.get("lon"))
    return ReportedEarthquake(
        id=str(root.get("event_id") or one.get("event_id") or "")[:100],
        name=str(one.get("event_description") or "")[:200],
        magnitude=number(file, "event magnitude", one.get("magnitude")),
        latitude=north,
        longitude=east,
        depth_km=number(file, "event depth", one.get("depth")),
        time=moment(file, "event event_timestamp", str(one.get("event_timestamp") or "")),
        version=str(root.get("shakemap_version") or "")[:20],
        scenario=str(root.get("shakemap_event_type") or "").strip().upper() == "SCENARIO",
    )


def _table(
    file: Path, specified: list[Any], data: list[Any], columns: Mapping[str, int]
) -> tuple[Array, tuple[int, int]]:
    if not (specified and data):
        raise refused(file, "grid_data", "is missing", "it was cut off, or is no grid.xml: fetch it again")
    across, down = (
        int(number(file, f"grid_specification {name}", specified[0].get(name))) for name in ("nlon", "nlat")
    )
    width = 1 + max(columns.values())
    if min(columns.values()) < 0 or width > 100 or min(across, down) < 2 or across * down > MOST:
        raise refused(file, "grid_specification", f"{across} x {down} points make no map", "fetch the map again")
    with warnings.catch_warnings():
        # Where it meets what is no number, numpy only warns, and stops.
        warnings.simplefilter("error")
        try:
            values = np.fromstring(data[0].text or "", sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise refused(
                file, "grid_data", f"holds what is no number ({error!s:.80})", "fetch the map again"
            ) from None
    if values.size != across * down * width:
        wrong = f"has {values.size:,} numbers in place of {across} x {down} x {width}"
        raise refused(file, "grid_data", wrong, "it was cut off on the way: fetch it again")
    return values.reshape(-1, width), (down, across)
