"""Catalogues beside records: earthquakes and stations from QuakeML, GeoJSON and StationXML, and back to the first two.

Which of these a file is, its content says and not its name.
"""

from __future__ import annotations

import io
import json
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from pipeline.motions.errors import refusal
from pipeline.motions.manifest import Manifest, SiteTable
from pipeline.motions.own_facts import finite, plain
from pipeline.motions.record import EventTable, Record, StationTable
from pipeline.motions.responses import load_obspy, read_inventory

LARGEST = 64 << 20
"""Bytes of a catalogue; a StationXML of a whole network has some 30 MB."""

_HEAD = 65_536


@dataclass(eq=False)
class Catalogues:
    """What the files beside records say of earthquakes and places.

    Attributes
    ----------
    inventories : mapping of Path to obspy.Inventory
        The stations of each StationXML.
    events : sequence of EventTable
        Of all QuakeML and GeoJSON files.
    stations : mapping of str to StationTable
        By network and station, "CI.CLC", or the station alone where no network is named.
    site : sequence of StationTable
        The museum's place, where a GeoJSON says it.
    """

    inventories: dict[Path, Any] = field(default_factory=dict)
    events: list[EventTable] = field(default_factory=list)
    stations: dict[str, StationTable] = field(default_factory=dict)
    site: list[StationTable] = field(default_factory=list)

    def take(self, file: Path) -> bool:
        """Read a file, where it is a catalogue.

        Parameters
        ----------
        file : Path
            Any file.

        Returns
        -------
        bool
            Whether it is one.

        Raises
        ------
        MotionError
            For a catalogue that cannot be read.
        """
        with file.open("rb") as stream:
            head = stream.read(_HEAD)
        text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
        kind = "XML" if text.startswith(b"<") else "JSON" if text.startswith(b"{") else ""
        if not kind or (kind == "XML" and not (b"FDSNStationXML" in head or b"quakeml" in head.lower())):
            return False
        if file.stat().st_size > LARGEST:
            wrong = f"{file.stat().st_size:,} bytes are more than a catalogue has ({LARGEST:,} at most)"
            raise refusal(file, "file", wrong, "ask the data centre for this event, or these stations, alone")
        if kind == "JSON":
            return self._take_json(file)
        if b"<!DOCTYPE" in head or b"<!ENTITY" in head:
            raise refusal(file, "file", "declares entities, which no catalogue needs", "fetch it again")
        if b"FDSNStationXML" in head:
            self._take_stations(file)
        else:
            self.events.extend(_quakeml(file))
        return True

    def _take_stations(self, file: Path) -> None:
        inventory = read_inventory(file, [])
        self.inventories[file] = inventory
        for network in inventory:
            for one in network:
                name = str(one.site.name or "") if one.site else ""
                self._station(f"{network.code}.{one.code}", name, one.latitude, one.longitude)

    def _station(self, code: str, name: str, latitude: Any, longitude: Any) -> None:
        said: dict[str, Any] = {
            "code": code,
            "name": plain(name),
            "latitude": finite(latitude),
            "longitude": finite(longitude),
        }
        try:
            self.stations.setdefault(code, StationTable(**{k: v for k, v in said.items() if v not in {None, ""}}))
        except ValidationError:
            return  # a place that is none says nothing of a record

    def _take_json(self, file: Path) -> bool:
        try:
            said = json.loads(file.read_text(encoding="utf-8-sig"))
        except (ValueError, RecursionError) as error:
            raise refusal(file, "file", f"is no JSON ({error!s:.200})", "fetch it again") from error
        kind = said.get("type") if isinstance(said, dict) else None
        if kind not in {"Feature", "FeatureCollection"}:
            return False
        features = said.get("features") if kind == "FeatureCollection" else [said]
        if not isinstance(features, list):
            raise refusal(file, "features", "is no list", "fetch the GeoJSON again")
        for number, feature in enumerate(features):
            self._feature(file, number, feature)
        return True

    def _feature(self, file: Path, number: int, feature: Any) -> None:
        properties = feature.get("properties") if isinstance(feature, dict) else None
        geometry = feature.get("geometry") if isinstance(feature, dict) else None
        if not isinstance(properties, dict) or not isinstance(geometry, dict) or geometry.get("type") != "Point":
            return
        at = geometry.get("coordinates")
        if not isinstance(at, list) or len(at) < 2 or any(finite(part) is None for part in at[:2]):
            raise refusal(file, f"features[{number}].geometry", "is no point", "fetch the GeoJSON again")
        if "mag" in properties and "time" in properties:
            self.events.append(_comcat(file, number, feature, properties, at))
        elif properties.get("kind") == "site":
            self.site.append(StationTable(name=plain(properties.get("name")) or None, latitude=at[1], longitude=at[0]))
        else:
            code = str(properties.get("code") or properties.get("station") or feature.get("id") or "")
            network = str(properties.get("network") or properties.get("net") or "")
            if code:
                full = code if "." in code or not network.isalnum() or len(network) > 2 else f"{network}.{code}"
                self._station(plain(full)[:100], str(properties.get("name") or ""), at[1], at[0])


def _event(file: Path, place: str, said: Mapping[str, Any]) -> EventTable:
    try:
        return EventTable(**{key: value for key, value in said.items() if value not in {None, ""}})
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise refusal(file, f"{place}.{where}", first["msg"], "correct it, or fetch the catalogue again") from error


def _comcat(file: Path, number: int, feature: Any, properties: Any, at: Sequence[Any]) -> EventTable:
    time, place = finite(properties["time"]), f"features[{number}]"
    try:
        when = None if time is None else datetime.fromtimestamp(time / 1000.0, UTC)
    except (OverflowError, OSError, ValueError) as error:
        raise refusal(file, f"{place}.properties.time", "is no time in ms", "fetch the GeoJSON again") from error
    said = {
        "name": plain(properties.get("title") or properties.get("place")),
        "id": plain(feature.get("id")),
        "time": when,
        "latitude": finite(at[1]),
        "longitude": finite(at[0]),
        "depth_km": finite(at[2]) if len(at) > 2 else None,
        "magnitude": finite(properties["mag"]),
        "magnitude_type": plain(properties.get("magType")),
    }
    return _event(file, place, said)


def _quakeml(file: Path) -> list[EventTable]:
    obspy = load_obspy()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = obspy.read_events(io.BytesIO(file.read_bytes()), format="QUAKEML")
    except Exception as error:  # on a broken file obspy's readers raise anything
        wrong = f"is no QuakeML ({type(error).__name__}: {str(error)[:200]})"
        raise refusal(file, "file", wrong, "fetch it again, as QuakeML 1.2") from error
    made = []
    for number, event in enumerate(found):
        origin = event.preferred_origin() or (event.origins[0] if event.origins else None)
        size = event.preferred_magnitude() or (event.magnitudes[0] if event.magnitudes else None)
        names = [d.text for d in event.event_descriptions if d.text]
        depth = None if origin is None else finite(origin.depth)
        when = None if origin is None or origin.time is None else origin.time.datetime.replace(tzinfo=UTC)
        said = {
            "name": plain(names[0] if names else ""),
            "id": plain(event.resource_id.id if event.resource_id else ""),
            "time": when,
            "latitude": None if origin is None else finite(origin.latitude),
            "longitude": None if origin is None else finite(origin.longitude),
            "depth_km": None if depth is None else depth / 1000.0,
            "magnitude": None if size is None else finite(size.mag),
            "magnitude_type": plain(size.magnitude_type if size else ""),
        }
        made.append(_event(file, f"event[{number}]", said))
    return made


def as_quakeml(records: Iterable[Record]) -> str:
    """Return the earthquakes of records as QuakeML 1.2, each once.

    Parameters
    ----------
    records : iterable of Record
        Those without an event add none; one without time or place cannot be an origin.

    Returns
    -------
    str
        The document.
    """
    load_obspy()
    from obspy import UTCDateTime
    from obspy.core.event import Catalog, Event, EventDescription, Magnitude, Origin, ResourceIdentifier

    events = []
    for said in dict.fromkeys(record.event for record in records if record.event is not None):
        event = Event()
        if said.id and said.id.startswith(("smi:", "quakeml:")):
            event.resource_id = ResourceIdentifier(said.id)
        if said.name:
            event.event_descriptions.append(EventDescription(said.name))
        if said.time is not None and said.latitude is not None and said.longitude is not None:
            depth = None if said.depth_km is None else 1000.0 * said.depth_km
            time = UTCDateTime(said.time.astimezone(UTC))
            event.origins.append(Origin(time=time, latitude=said.latitude, longitude=said.longitude, depth=depth))
        if said.magnitude is not None:
            event.magnitudes.append(Magnitude(mag=said.magnitude, magnitude_type=said.magnitude_type))
        events.append(event)
    stream = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        Catalog(events).write(stream, format="QUAKEML")
    return stream.getvalue().decode("utf-8")


def as_geojson(manifest: Manifest) -> str:
    """Return a site, the stations of its records and their earthquakes as GeoJSON (RFC 7946), which `take` reads.

    Parameters
    ----------
    manifest : Manifest
        Of the site.

    Returns
    -------
    str
        A FeatureCollection of points, degrees east and north; what has no place is left out, and so is a site at zero
        north and zero east, where `kouros init` puts one until somebody says where it is.
    """
    site: SiteTable = manifest.site
    features = []
    if site.latitude or site.longitude:
        features.append(_point(site.longitude, site.latitude, None, {"kind": "site", "name": site.name}))
    records = [record for _, record in manifest.records()]
    for one in dict.fromkeys(r.station for r in records if r.station is not None):
        if one.latitude is not None and one.longitude is not None:
            of = [r.name for r in records if r.station == one]
            said: dict[str, Any] = {"kind": "station", "code": one.code, "name": one.name, "records": of}
            features.append(_point(one.longitude, one.latitude, None, said))
    for event in dict.fromkeys(r.event for r in records if r.event is not None):
        if event.latitude is not None and event.longitude is not None:
            time = None if event.time is None else round(1000.0 * event.time.timestamp())
            said = {"kind": "event", "title": event.name, "mag": event.magnitude, "magType": event.magnitude_type}
            point = _point(event.longitude, event.latitude, event.depth_km, said | {"time": time})
            features.append(point | ({"id": event.id} if event.id else {}))
    return json.dumps({"type": "FeatureCollection", "features": features}, indent=2, ensure_ascii=False) + "\n"


def _point(longitude: float, latitude: float, depth: float | None, said: Mapping[str, Any]) -> dict[str, Any]:
    at = [longitude, latitude, *([] if depth is None else [depth])]
    known = {key: value for key, value in said.items() if value is not None}
    return {"type": "Feature", "geometry": {"type": "Point", "coordinates": at}, "properties": known}


def matching(events: Sequence[EventTable], start: float, end: float, station: StationTable | None) -> list[EventTable]:
    """Return the earthquakes that a record may be of, by its time: the largest first.

    Parameters
    ----------
    events : sequence of EventTable
        Of catalogues.
    start, end : float
        Of the record, s since 1970.
    station : StationTable or None
        Where it was made, if that is known.

    Returns
    -------
    list of EventTable
        Those whose waves can have been recorded: whose origin lies before the record's end, and not so long before its
        start that surface waves (3 km/s and slower by a third) have gone by.
    """
    found = []
    for event in events:
        if event.time is None:
            continue
        far = distance_km(event, station)
        late = 300.0 if far is None else 60.0 + far / 2.0
        if start - late <= event.time.timestamp() <= end:
            found.append(event)
    return sorted(found, key=lambda event: -(event.magnitude if event.magnitude is not None else -9.0))


def distance_km(event: EventTable | None, station: StationTable | None) -> float | None:
    """Return the epicentral distance in km on the WGS84 ellipsoid, None where a place is not known."""
    if event is None or station is None:
        return None
    if None in {event.latitude, event.longitude, station.latitude, station.longitude}:
        return None
    load_obspy()
    from obspy.geodetics import gps2dist_azimuth

    metres = gps2dist_azimuth(event.latitude, event.longitude, station.latitude, station.longitude)[0]
    return float(round(metres / 1000.0, 1))
