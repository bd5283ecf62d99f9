"""Files about an earthquake: which say its shaking, which are records (or the museum's own), what is taken."""

from __future__ import annotations

import gzip
import hashlib
import json
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from pipeline.event.alerts import read_alert
from pipeline.event.grids import read_grid
from pipeline.event.message import (
    Message,
    MessageError,
    ReportedEarthquake,
    SiteShaking,
    check_quake,
    content,
    kilometres,
    refused,
    xml_root,
)
from pipeline.event.stations import read_station_json, read_station_xml
from pipeline.motions.errors import MotionError
from pipeline.motions.gathering import gather
from pipeline.motions.placing import changed, commit, plan
from pipeline.motions.proposing import Answers, propose
from pipeline.motions.record import EventTable, StationTable
from pipeline.motions.site import SiteMotion, read_site
from pipeline.quantities import G

_READERS = {"shakemap_grid": read_grid, "event_message": read_alert, "shakemap-data": read_station_xml}

SAME_KM, SAME_S = 100.0, 120.0
"""How far two messages may be apart about one earthquake: judgement."""


@dataclass(frozen=True)
class EventFiles:
    """What files say of one earthquake.

    Attributes
    ----------
    quake : Earthquake
        By the message that is believed most, with what others know besides.
    messages : tuple of Message
        Those of the shaking, what is believed most first.
    records : tuple of Path
        Files that are none: records of the museum's own.
    digest : str
        SHA-256 of all of them.
    """

    quake: ReportedEarthquake
    messages: tuple[Message, ...]
    records: tuple[Path, ...]
    digest: str


def read_files(files: Sequence[Path], now: datetime) -> EventFiles:
    """Read the files about one earthquake.

    Parameters
    ----------
    files : sequence of Path
        Messages and records.
    now : datetime
        By this machine's clock.

    Raises
    ------
    MessageError
        For a message that cannot be used or takes the earthquake back, and for messages about different earthquakes.
    """
    messages: list[Message] = []
    records: list[Path] = []
    digests = []
    for file in files:
        data = content(file)
        digests.append(hashlib.sha256(data).hexdigest())
        message = read_message(file, data)
        if message is None:
            records.append(file)
            continue
        if message.cancelled:
            # Beside others as well: which of them holds only a person can say.
            others = " leave it out if the other files hold," if len(files) > 1 else ""
            raise MessageError(f"{file}: takes the earthquake back: it is cancelled;{others} earlier answers stay")
        check_quake(file, message.quake, now)
        messages.append(message)
    ordered = tuple(sorted(messages, key=lambda one: (-one.rank, -one.quake.version_number)))
    for one in ordered[1:]:
        _same(ordered[0], one)
    quake = ReportedEarthquake()
    for one in ordered:
        quake = with_more(quake, one.quake)
    # A list of stations does not say where the earthquake was; how the shaking falls off from there it tells.
    ordered = tuple(replace(one, quake=with_more(one.quake, quake)) for one in ordered)
    return EventFiles(quake, ordered, tuple(records), hashlib.sha256("\n".join(sorted(digests)).encode()).hexdigest())


def with_more(quake: ReportedEarthquake, other: ReportedEarthquake) -> ReportedEarthquake:
    """Return an earthquake with what another message knows of it besides."""
    missing = {
        name: getattr(other, name)
        for name in ("id", "name", "magnitude", "latitude", "longitude", "depth_km", "time", "version", "scenario")
        if not getattr(quake, name) and getattr(other, name)
    }
    return replace(quake, **missing)


def is_message(file: Path) -> bool:
    """Say by its beginning whether a file is a message about an earthquake, and not a record of one."""
    try:
        with file.open("rb") as stream:
            packed = stream.read(2) == b"\x1f\x8b"
        with gzip.open(file) if packed else file.open("rb") as opened:
            begins = opened.read(65536)
    except (OSError, EOFError, zlib.error):
        # What is damaged is refused by who reads it as a message.
        return True
    return _is_xml(begins) or _is_json(begins)


def _is_xml(data: bytes) -> bool:
    text = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    return text.startswith(b"<") and not (b"FDSNStationXML" in data[:65536] or b"quakeml" in data[:65536].lower())


def _is_json(data: bytes) -> bool:
    text = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    return text.startswith(b"{") and b'"FeatureCollection"' in text[:200_000]


def read_message(file: Path, data: bytes) -> Message | None:
    """Return what a file says of the shaking; None for what is no message, and so may be a record.

    Raises
    ------
    MessageError
        For a message that cannot be used.
    """
    if _is_xml(data):
        root = xml_root(file, data)
        from lxml import etree

        name = etree.QName(root).localname
        reader = _READERS.get(name)
        if reader is None:
            raise refused(
                file, "file", f"is XML of another kind ({name[:40]})",
                "give a ShakeMap grid.xml or stationlist, or a ShakeAlert event message",
            )  # fmt: skip
        return reader(file, root)
    if _is_json(data) and _is_station_list(data.removeprefix(b"\xef\xbb\xbf")):
        return read_station_json(file, data)
    return None


def _is_station_list(text: bytes) -> bool:
    """Whether it is cut off, which its reader says, or has what stations of ShakeMap have."""
    try:
        said = json.loads(text)
    except (ValueError, RecursionError):
        return True
    features = said.get("features")
    return isinstance(features, list) and any(
        isinstance(one, dict) and isinstance(one.get("properties"), dict) and "pga" in one["properties"]
        for one in features[:100]
    )


def _same(first: Message, other: Message) -> None:
    apart = first.quake.apart(other.quake)
    if apart is not None and not is_same(apart):
        far, seconds = apart
        raise MessageError(
            f"{first.file} and {other.file}: about different earthquakes, {far:,.0f} km and {seconds:,.0f} s apart; "
            "give the files of one"
        )


def is_same(apart: tuple[float, float]) -> bool:
    """Say whether two messages that are so far apart, in km and in s, are about one earthquake."""
    return apart[0] <= SAME_KM and apart[1] <= SAME_S


NEAR_KM = 1.0
"""How far from the museum its own instrument may stand: judgement; further away the ground may be another."""

SIGMA = 0.10
"""Standard deviation of ln of a recorded peak as that of the museum's ground: judgement, from 0.05 to 0.2; between
rooms of one building, and by what is filtered out."""


@dataclass(frozen=True)
class OwnRecord:
    """What the museum's own instrument recorded.

    Attributes
    ----------
    shaking : SiteShaking
        Its peaks.
    quake : ReportedEarthquake
        What its files say of the earthquake.
    motion : SiteMotion
        The whole motion, processed.
    x_azimuth : float
        Of its x axis, degrees clockwise from north.
    """

    shaking: SiteShaking
    quake: ReportedEarthquake
    motion: SiteMotion
    x_azimuth: float


def own_record(files: Sequence[Path], latitude: float, longitude: float) -> OwnRecord:
    """Return what the museum's own instrument recorded.

    Parameters
    ----------
    files : sequence of Path
        Records in any format that is read, StationXML beside them.
    latitude, longitude : float
        Of the museum, degrees.

    Raises
    ------
    MotionError
        For what is no record, or cannot be used.
    MessageError
        Where something is not known that only a person can say, where there are several records, and for one of
        another place, with the distance.
    """
    named = ", ".join(path.name for path in files)
    proposals, left = propose(found := gather(files), Answers())
    wrong = [*left, *found.unusable]
    if not proposals:
        raise MotionError("; ".join(f"{one.name}: {one.reason}" for one in wrong[:5]) or f"{named}: no record is in it")
    if len(proposals) > 1:
        names = ", ".join(one.name for one in proposals[:5])
        raise MessageError(f"{named}: {len(proposals)} records ({names}); give the files of one, on the ground")
    one = proposals[0]
    if one.questions:
        asked = "; ".join(f"{question.text}" for question in one.questions)
        raise MessageError(
            f"{named}: {asked}; give StationXML beside it, or make a site of it by `kouros motions add`, which asks, "
            "and give its peaks by --pga and --pgv"
        )
    with TemporaryDirectory(prefix="kouros-event-") as name:
        folder = Path(name) / "site"
        made = plan(folder, "event", proposals, {}, None, None)
        if made.refused:
            raise MotionError("; ".join(f"{who}: {problem}" for who, problem in made.refused))
        commit(made, changed(made, StationTable(name="museum", latitude=latitude, longitude=longitude)))
        site = read_site(folder)
    motion = site.levels[0].motions[0]
    measures = motion.measures
    record = made.placed[0].record
    station = record.station
    if station is not None and station.latitude is not None and station.longitude is not None:
        apart = kilometres(latitude, longitude, station.latitude, station.longitude)
        if apart > NEAR_KM:
            raise MessageError(
                f"{named}: recorded {apart:,.1f} km from the museum ({latitude:.4f}, {longitude:.4f}), and the "
                f"museum's own record is made within {NEAR_KM:g} km; give the ShakeMap, or the place by --at LAT,LON"
            )
    shaking = SiteShaking(
        measures["pga"] / G, 100.0 * measures["pgv"], SIGMA, SIGMA, f"the museum's own record, {record.name}",
        ("Taken as the shaking of the ground: a record of an upper floor would count that floor twice.",),
    )  # fmt: skip
    return OwnRecord(shaking, _quake(record.event), motion, site.manifest.site.x_azimuth)


def _quake(said: EventTable | None) -> ReportedEarthquake:
    if said is None:
        return ReportedEarthquake()
    return ReportedEarthquake(
        said.id or "", said.name or "", said.magnitude, said.latitude, said.longitude, said.depth_km, said.time
    )
