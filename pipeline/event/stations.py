r"""Stations near the museum: ShakeMap's stationlist.json and stationlist.xml, and what they say of a place between.

What falls off with distance is taken out first, a straight line of ln of the peaks over ln of the distance to the
hypocentre, by least squares over the stations themselves.  What is left of it is like at places close to each other,

.. math::

    \rho(d) = e^{-3 d / b}

and from the nearest ones the most likely value follows, and how sure it is (simple kriging).

References
----------
Jayaram, N. and Baker, J. W. (2009). Correlation model for spatially distributed ground-motion intensities. Earthquake
Engineering & Structural Dynamics 38, 1687-1708: b = 8.5 km for PGA where soil does not come in clusters.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.event.message import (
    PGA_SIGMA,
    PGV_SIGMA,
    Message,
    ReportedEarthquake,
    SiteShaking,
    kilometres,
    number,
    position,
    refused,
)
from pipeline.quantities import Array

RANGE_KM = 8.5
"""b of the formula."""

FAR_KM = 50.0
"""How far the nearest station may be: judgement; beyond it a relation of the whole earthquake says as much."""

USED = 20
"""Stations that the value at a place is found from: those that are nearest."""

FEWEST = 8
"""Stations that tell how the shaking falls off with distance: judgement."""

MOST = 100_000
"""Stations of a list."""


@dataclass(frozen=True)
class Station:
    """A station and its larger horizontal peaks: g, cm/s; None where it has none that is sound."""

    code: str
    latitude: float
    longitude: float
    pga_g: float | None
    pgv_cm_s: float | None


@dataclass(frozen=True, kw_only=True)
class StationList(Message):
    """What stations recorded of an earthquake."""

    stations: tuple[Station, ...]

    def without(self, code: str) -> StationList:
        """Return the list without a station, to see what the others say of its place."""
        return replace(self, stations=tuple(one for one in self.stations if one.code != code))

    def at(self, latitude: float, longitude: float) -> SiteShaking:
        """Return the shaking at a place between the stations.

        Raises
        ------
        MessageError
            Where none is near, with the distance of the nearest.
        """
        far = sorted(
            (kilometres(latitude, longitude, one.latitude, one.longitude), one.code)
            for one in self.stations
            if one.pga_g
        )
        if not far or far[0][0] > FAR_KM:
            near = f"the nearest station is {far[0][0]:,.0f} km away" if far else "it has no station with a sound PGA"
            raise refused(
                self.file, "site", f"{near} from the museum ({latitude:.4f}, {longitude:.4f})",
                "give the list of an earthquake near the museum, or its ShakeMap",
            )  # fmt: skip
        pga, pga_sd = self._estimate([one.pga_g for one in self.stations], latitude, longitude, PGA_SIGMA)
        speeds = [one.pgv_cm_s for one in self.stations]
        told = sum(bool(speed) for speed in speeds) >= 1
        pgv, pgv_sd = self._estimate(speeds, latitude, longitude, PGV_SIGMA) if told else (None, PGV_SIGMA)
        return SiteShaking(
            pga,
            pgv,
            pga_sd,
            pgv_sd,
            f"{len(far):,} stations, the nearest {far[0][1]} at {far[0][0]:.1f} km",
            self.notes,
        )

    def _estimate(
        self, peaks: Sequence[float | None], latitude: float, longitude: float, relation: float
    ) -> tuple[float, float]:
        """Return the median and the standard deviation of ln at a place."""
        rows = [(one.latitude, one.longitude, peak) for one, peak in zip(self.stations, peaks, strict=True) if peak]
        places, values = [row[:2] for row in rows], np.log([row[2] for row in rows])
        far = np.array([kilometres(latitude, longitude, *place) for place in places])
        near = np.argsort(far, kind="stable")[:USED]
        trend, here, sd = self._trend(places, values, (latitude, longitude), near, relation)
        left = (values - trend)[near]
        between = np.array([[kilometres(*places[i], *places[j]) for j in near] for i in near])
        alike, to = _alike(between), _alike(far[near])
        # Two stations at one place would say the same twice.
        weights = np.linalg.solve(alike + 1e-6 * np.eye(near.size), to)
        spread = sd * math.sqrt(max(1.0 - float(weights @ to), 0.0))
        return math.exp(here + float(weights @ left)), spread

    def _trend(
        self, places: Sequence[tuple[float, float]], values: Array, at: tuple[float, float], near: Any, relation: float
    ) -> tuple[Array, float, float]:
        """Return what the distance alone says, at the stations and at a place, and the deviation of what is left."""
        quake = self.quake
        if len(places) < FEWEST or quake.latitude is None or quake.longitude is None:
            mean = float(values[near].mean())
            return np.full(values.size, mean), mean, relation
        deep = max(quake.depth_km or 0.0, 5.0)
        epicentre = (quake.latitude, quake.longitude)
        logs = np.log(np.hypot([kilometres(*epicentre, *place) for place in places], deep))
        rows = np.stack([np.ones(values.size), logs], axis=1)
        found, *_ = np.linalg.lstsq(rows, values, rcond=None)
        left = values - rows @ found
        sd = math.sqrt(float(left @ left) / (values.size - 2))
        here = math.log(math.hypot(kilometres(*epicentre, *at), deep))
        return rows @ found, float(found[0] + found[1] * here), sd


def _alike(distance: Array) -> Array:
    return np.asarray(np.exp(-3.0 * distance / RANGE_KM))


def read_station_xml(file: Path, root: Any) -> StationList:
    """Read a ShakeMap station list of version 3: peaks in % of g and cm/s, those that are flagged left out.

    Raises
    ------
    MessageError
        For a list without an earthquake or a station.
    """
    one = root.find("earthquake")
    if one is None:
        raise refused(file, "earthquake", "is missing", "it was cut off: fetch it again")
    north, east = position(file, "earthquake", one.get("lat"), one.get("lon"))
    when = [int(number(file, f"earthquake {name}", one.get(name))) for name in
            ("year", "month", "day", "hour", "minute", "second")]  # fmt: skip
    try:
        time = datetime(*when, tzinfo=UTC)  # type: ignore[misc,arg-type]
    except ValueError:
        raise refused(file, "earthquake", "its time is none", "fetch the list again") from None
    quake = ReportedEarthquake(
        id=f"{one.get('network') or ''}{one.get('id') or ''}"[:100],
        name=str(one.get("locstring") or "")[:200],
        magnitude=number(file, "earthquake mag", one.get("mag")),
        latitude=north,
        longitude=east,
        depth_km=number(file, "earthquake depth", one.get("depth")),
        time=time,
        version=str(root.get("map_version") or "")[:20],
    )
    stations = [_station_of(file, station) for station in root.iterfind("stationlist/station")]
    return _listed(file, quake, stations)


def _station_of(file: Path, station: Any) -> Station:
    code = str(station.get("code") or "")[:40]
    peaks: dict[str, list[float]] = {"pga": [], "acc": [], "pgv": [], "vel": []}
    for component in station.iterfind("comp"):
        if str(component.get("name") or "").upper().endswith("Z"):
            continue
        for name, found in peaks.items():
            one = component.find(name)
            if one is not None and str(one.get("flag") or "0") == "0":
                found.append(number(file, f"station {code} {name}", one.get("value")))
    pga, pgv = (max((*peaks[a], *peaks[b]), default=0.0) for a, b in (("pga", "acc"), ("pgv", "vel")))
    place = position(file, f"station {code}", station.get("lat"), station.get("lon"))
    return Station(code, *place, 0.01 * pga if pga > 0.0 else None, pgv if pgv > 0.0 else None)


def read_station_json(file: Path, data: bytes) -> StationList:
    """Read a ShakeMap station list of version 4 (GeoJSON): peaks in % of g and cm/s, those that are flagged left out.

    Raises
    ------
    MessageError
        For what is no such list, or is cut off.
    """
    try:
        said = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        wrong = f"is no whole JSON ({str(error)[:120]})"
        raise refused(file, "file", wrong, "it was cut off on the way: fetch it again") from error
    features = said.get("features") if isinstance(said, dict) else None
    if not isinstance(features, list):
        raise refused(file, "features", "is no list", "take stationlist.json of the event's ShakeMap")
    return _listed(file, ReportedEarthquake(), list(_features(file, features[: MOST + 1])))


def _features(file: Path, features: Sequence[Any]) -> Iterator[Station]:
    for at, one in enumerate(features):
        said = one.get("properties") if isinstance(one, dict) else None
        geometry = one.get("geometry") if isinstance(one, dict) else None
        where = geometry.get("coordinates") if isinstance(geometry, dict) else None
        if not isinstance(said, dict) or not isinstance(where, list) or len(where) < 2:
            raise refused(file, f"features[{at}]", "is no station at a point", "fetch the list again")
        if said.get("station_type") == "macroseismic":
            continue  # What people felt, put into numbers.
        place = position(file, f"features[{at}]", where[1], where[0])
        found = {name: list(_amplitudes(said.get("channels"), name)) for name in ("pga", "pgv")}
        pga, pgv = (max(found[name], default=_plain(said.get(name))) for name in ("pga", "pgv"))
        code = str(one.get("id") or said.get("code") or at)[:40]
        yield Station(code, *place, 0.01 * pga if pga > 0.0 else None, pgv if pgv > 0.0 else None)


def _amplitudes(channels: Any, name: str) -> Iterator[float]:
    """Yield a station's peaks in its horizontal channels that nobody flagged, in % of g or cm/s."""
    for channel in channels if isinstance(channels, list) else ():
        if not isinstance(channel, dict) or str(channel.get("name") or "").upper().endswith("Z"):
            continue
        amplitudes = channel.get("amplitudes")
        for one in amplitudes if isinstance(amplitudes, list) else ():
            if isinstance(one, dict) and one.get("name") == name and str(one.get("flag") or "0") == "0":
                value = _plain(one.get("value"))
                if value > 0.0:
                    yield value


def _plain(value: Any) -> float:
    """Return a peak; 0 for "null", which such lists have in place of none."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        return 0.0
    return found if math.isfinite(found) else 0.0


def _listed(file: Path, quake: ReportedEarthquake, stations: Sequence[Station]) -> StationList:
    if not stations or len(stations) > MOST:
        wrong = "has no station" if not stations else f"has more than {MOST:,} stations"
        raise refused(file, "stations", wrong, "take the station list of the event's ShakeMap")
    return StationList(file, "stations", 2, quake, stations=tuple(stations))
