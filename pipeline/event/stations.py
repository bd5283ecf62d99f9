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
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.event.message import (
    ACCELERATIONS,
    MOST_PGA,
    MOST_PGV,
    PGA_SIGMA,
    PGV_SIGMA,
    VELOCITIES,
    Message,
    ReportedEarthquake,
    SiteShaking,
    cut_off,
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

CHECKED = 40
"""Stations about a place that tell how well such estimates do there: judgement."""

MOST = 100_000
"""Stations of a list."""

PEAKS = {"pga": (ACCELERATIONS, "ln(g)"), "pgv": (VELOCITIES, "ln(cm/s)")}
"""Units of each peak, in g and cm/s, and that of its natural logarithm."""

UNIT_OF = {"pga": "g", "pgv": "cm/s"}
MOST_PEAK = {"pga": MOST_PGA, "pgv": MOST_PGV}

FELT = frozenset({"dyfi", "mmi", "intensity", "ciim"})
"""Networks of ShakeMap that are no instruments."""

UNITS_REMEDY = "take stationlist.json of the event's ShakeMap, which names the unit of each amplitude"


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
        origin = f"{len(far):,} stations, the nearest {far[0][1]} at {far[0][0]:.1f} km"
        return SiteShaking(pga, pgv, pga_sd, pgv_sd, origin, (*self.notes, *self._unfitted(len(far))))

    def _unfitted(self, stations: int) -> tuple[str, ...]:
        if stations < FEWEST:
            return (f"Only {stations} stations: how the shaking falls off with distance is not fitted.",)
        if self.quake.latitude is None:
            return (
                "Nobody says where the earthquake was: how the shaking falls off with distance is not fitted; give a "
                "message beside the stations that does, such as grid.xml.",
            )
        return ()

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
        about = np.argsort(far, kind="stable")[:CHECKED]
        return math.exp(here + float(weights @ left)), spread * self._wider(places, values - trend, about, sd)

    def _wider(self, places: Sequence[tuple[float, float]], left: Array, about: Any, sd: float) -> float:
        """Return by how much stations about here miss what the others say of their places, beside what is expected.

        Each left out in turn, in closed form: with K how alike they are, it is missed by (K^-1 r)_i / (K^-1)_ii, of
        which 1 / (K^-1)_ii is expected.  Ranges are widened by it, and never narrowed.
        """
        if about.size < FEWEST or sd <= 0.0:
            return 1.0
        between = np.array([[kilometres(*places[i], *places[j]) for j in about] for i in about])
        inverse = np.linalg.inv(_alike(between) + 1e-6 * np.eye(about.size))
        own = np.diag(inverse)
        missed = (inverse @ left[about]) / np.sqrt(own) / sd
        return max(1.0, math.sqrt(float(np.mean(missed**2))))

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
    sound = 0.0 < 0.01 * pga <= MOST_PGA, 0.0 < pgv <= MOST_PGV
    return Station(code, *place, 0.01 * pga if sound[0] else None, pgv if sound[1] else None)


def read_station_json(file: Path, data: bytes) -> StationList:
    """Read a ShakeMap station list of version 4 (GeoJSON): each amplitude in its own unit, those flagged left out.

    Raises
    ------
    MessageError
        For what is no such list, is cut off, or has no amplitude that can be used.
    """
    try:
        said = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        wrong = f"is no whole JSON ({str(error)[:120]})"
        raise cut_off(file, wrong) from error
    features = said.get("features") if isinstance(said, dict) else None
    if not isinstance(features, list):
        raise refused(file, "features", "is no list", "take stationlist.json of the event's ShakeMap")
    left = LeftOut()
    stations = list(_features(file, features[: MOST + 1], left))
    if stations and left.reasons and not any(one.pga_g or one.pgv_cm_s for one in stations):
        raise refused(file, "stations", f"no amplitude can be used: {left.told()}", UNITS_REMEDY)
    return replace(_listed(file, ReportedEarthquake(), stations), notes=left.notes())


@dataclass
class LeftOut:
    """Stations whose amplitudes cannot be used, by the reason."""

    reasons: dict[str, list[str]] = field(default_factory=dict)
    bare: int = 0

    def add(self, why: str, code: str) -> None:
        """Note a station."""
        codes = self.reasons.setdefault(why, [])
        if code not in codes:
            codes.append(code)

    def told(self) -> str:
        """Return the reasons in words, each with its stations."""
        return "; ".join(
            f"{why} ({', '.join(codes[:5])}{f' and {len(codes) - 5} more' if len(codes) > 5 else ''})"
            for why, codes in self.reasons.items()
        )

    def notes(self) -> tuple[str, ...]:
        """Return what a reader has to know of it."""
        out = [f"Amplitudes of stations were left out: {self.told()}."] if self.reasons else []
        if self.bare:
            out.append(
                f"{self.bare} stations name no channels: their peaks are taken as % of g and cm/s, as the manual "
                "of ShakeMap has them."
            )
        return tuple(out)


def _features(file: Path, features: Sequence[Any], left: LeftOut) -> Iterator[Station]:
    for at, one in enumerate(features):
        said = one.get("properties") if isinstance(one, dict) else None
        geometry = one.get("geometry") if isinstance(one, dict) else None
        where = geometry.get("coordinates") if isinstance(geometry, dict) else None
        if not isinstance(said, dict) or not isinstance(where, list) or len(where) < 2:
            raise refused(file, f"features[{at}]", "is no station at a point", "fetch the list again")
        if said.get("station_type") == "macroseismic" or str(said.get("network")).lower() in FELT:
            continue  # What people felt, put into numbers.
        code = str(one.get("id") or said.get("code") or at)[:40]
        place = position(file, f"features[{at}]", where[1], where[0])
        channels = said.get("channels")
        if isinstance(channels, list) and channels:
            # What the list says of the whole station does not say whether it is of a sound channel.
            found = {name: list(_amplitudes(channels, name, code, left)) for name in PEAKS}
        else:
            found = {name: [bare] if (bare := _bare(said.get(name), name, code, left)) else [] for name in PEAKS}
            left.bare += any(found.values())
        yield Station(code, *place, max(found["pga"], default=None), max(found["pgv"], default=None))


def _amplitudes(channels: Sequence[Any], name: str, code: str, left: LeftOut) -> Iterator[float]:
    """Yield a station's peaks in its horizontal channels that nobody flagged, in g or cm/s."""
    sound = [one for one in channels if isinstance(one, dict)]
    for channel in _horizontal(sound):
        amplitudes = channel.get("amplitudes")
        for one in amplitudes if isinstance(amplitudes, list) else ():
            if not isinstance(one, dict) or str(one.get("name") or "").lower() != name:
                continue
            if str(one.get("flag") or "0").strip() != "0":
                continue
            value = _peak(one.get("value"), one.get("units"), name, code, left)
            if value:
                yield value


def _horizontal(channels: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the channels that are not vertical, by their names, such as "01.HNZ", "UP", or the third of three."""
    names = [str(one.get("name") or "").upper().rpartition(".")[2] for one in channels]
    ends = {name[-1:] for name in names}
    vertical = "3" if {"1", "2", "3"} <= ends and "Z" not in ends else "Z"
    return [
        one
        for one, name in zip(channels, names, strict=True)
        if not (name.endswith(vertical) or name in ("UP", "U", "V", "UD", "VERT", "VERTICAL"))
    ]


def _peak(value: Any, unit: Any, name: str, code: str, left: LeftOut) -> float | None:
    """Return a peak in g or cm/s; None where there is none ("null" in such lists), or it is left out."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        return None
    if not math.isfinite(found):
        return None
    said = str(unit or "").strip().lower()
    factors, logarithm = PEAKS[name]
    if said == logarithm:
        found = math.exp(min(found, 50.0))
    elif said not in factors:
        left.add(
            f"{name} without a unit" if not said else f"{name} in the unit {said[:20]!r}, which is not known", code
        )
        return None
    elif found <= 0.0:
        return None
    else:
        found *= factors[said]
    if found > MOST_PEAK[name]:
        left.add(f"{name} of {found:.3g} {UNIT_OF[name]}, more than was ever recorded", code)
        return None
    return found


def _bare(value: Any, name: str, code: str, left: LeftOut) -> float | None:
    return _peak(value, {"pga": "%g", "pgv": "cm/s"}[name], name, code, left)


def _listed(file: Path, quake: ReportedEarthquake, stations: Sequence[Station]) -> StationList:
    if not stations or len(stations) > MOST:
        wrong = "has no station" if not stations else f"has more than {MOST:,} stations"
        raise refused(file, "stations", wrong, "take the station list of the event's ShakeMap")
    return StationList(file, "stations", 2, quake, stations=tuple(stations))
