"""The museum's own record of an earthquake: read and processed as any record of a site."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from pipeline.event.message import MessageError, ReportedEarthquake, SiteShaking, kilometres
from pipeline.motions.errors import MotionError
from pipeline.motions.gathering import gather
from pipeline.motions.placing import changed, commit, plan
from pipeline.motions.proposing import Answers, propose
from pipeline.motions.record import EventTable, StationTable
from pipeline.motions.site import SiteMotion, read_site
from pipeline.quantities import G

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
