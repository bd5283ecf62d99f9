"""The levels of shaking that each gallery feels: those of the floor that it stands on."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from math import exp, log
from statistics import fmean

from pipeline.analysis.fragility.objects import Stripe
from pipeline.analysis.verdicts import EAST, LevelMotions
from pipeline.errors import near
from pipeline.motions.manifest import GROUND_FLOOR, FloorTable
from pipeline.motions.site import Level, Site, levels_at
from pipeline.motions.summary import summaries
from pipeline.records import Item, MotionSummary
from pipeline.records.fragility import HazardCurve
from pipeline.records.phrases import ON_GROUND
from pipeline.settings import Floors, Settings, SettingsError


@dataclass(frozen=True)
class Floor:
    """A floor that objects stand on, with its levels of shaking and the places of its objects in the list of all.

    Attributes
    ----------
    name : str
        "" for the ground.
    x_azimuth : float
        Degrees clockwise from north of the x axis of the motions.
    hazard : HazardCurve or None
        Curve of the floor, where the site's manifest names one.
    """

    name: str
    levels: tuple[Level, ...]
    members: tuple[int, ...]
    x_azimuth: float = EAST
    hazard: HazardCurve | None = None

    @property
    def shaking(self) -> list[LevelMotions]:
        """The levels as objects are run under them."""
        return [
            LevelMotions(v.name, v.combine, tuple(m.motion for m in v.motions), self.x_azimuth) for v in self.levels
        ]

    @property
    def stripes(self) -> list[Stripe]:
        """The levels as fragilities see them: by the peak acceleration and velocity of this floor."""
        return [
            Stripe(
                tuple(m.motion for m in v.motions),
                tuple(m.measures["pga"] for m in v.motions),
                v.return_period_years,
                tuple(m.measures["pgv"] for m in v.motions),
            )
            for v in self.levels
        ]

    @property
    def summaries(self) -> tuple[MotionSummary, ...]:
        """What a report shows of its motions."""
        return summaries(self.levels, self.name)


def floors_with(settings: Settings, site: Site, items: Sequence[Item]) -> list[Floor]:
    """Sort the objects by the floor that their gallery stands on, the ground first; each on one.

    Raises
    ------
    SettingsError, MotionError
        As `floors_of`.
    """
    places: dict[str, list[int]] = {}
    for index, item in enumerate(items):
        places.setdefault(floor_name(settings, item.gallery), []).append(index)
    found = floors_of(settings, site, {item.gallery for item in items})
    return [replace(floor, members=tuple(places[name])) for name, floor in found.items()]


def floors_of(settings: Settings, site: Site, galleries: Collection[str]) -> dict[str, Floor]:
    """Return the floors that some galleries stand on, by name, the ground first; without any objects.

    Raises
    ------
    SettingsError
        For a floor that the manifest does not have.
    MotionError
        For a record of a floor.
    """
    known(settings, site)
    wanted = {settings.floors.of(gallery) or GROUND_FLOOR for gallery in galleries}
    x_azimuth = site.manifest.site.x_azimuth
    found = {}
    for name in (GROUND_FLOOR, *site.floors):
        if name in wanted:
            said = "" if name == GROUND_FLOOR else name
            levels = levels_at(site, name)
            found[said] = Floor(said, levels, (), x_azimuth, _hazard(site, levels))
    return found


def _hazard(site: Site, levels: Sequence[Level]) -> HazardCurve | None:
    """Return the hazard curve of a floor: that of the ground, as many times as strong as the floor's motions are."""
    curve = site.hazard
    if curve is None:
        return None
    there, ground = (
        [log(m.measures[curve.measure]) for v in those for m in v.motions if m.measures[curve.measure] > 0.0]
        for those in (levels, site.levels)
    )
    if not (there and ground):
        return None
    times = exp(fmean(there) - fmean(ground))
    return replace(curve, intensity=tuple(times * one for one in curve.intensity))


def floor_name(settings: Settings, gallery: str) -> str:
    """Return the name of the floor that a gallery stands on, "" for the ground."""
    name = settings.floors.of(gallery)
    return "" if name is None or name == GROUND_FLOOR else name


def known(settings: Settings, site: Site) -> None:
    """Check that the floors of the settings are floors of the manifest.

    Raises
    ------
    SettingsError
        Naming the floor and those that there are.
    """
    there = (GROUND_FLOOR, *site.floors)
    for name in settings.floors.root:
        if name not in there:
            raise SettingsError(
                f"kouros.toml: floors.{name!r}: {site.file} has no such floor; it has {', '.join(there)}"
            )


def strangers(floors: Floors, galleries: Iterable[str]) -> list[str]:
    """Say of each gallery of the settings that the inventory does not have that it is not there."""
    there = set(galleries)
    notes = []
    for floor, names in floors.root.items():
        for name in names:
            if name != "*" and name not in there:
                notes.append(
                    f"kouros.toml puts gallery {name!r} on floor {floor!r}: the inventory has no such gallery"
                    f"{near(name, there)}"
                )
    return notes


def notes(settings: Settings, site: Site, galleries: Collection[str]) -> list[str]:
    """Say how each floor's motion was obtained and which galleries stand where."""
    if not site.floors:
        return [f"{ON_GROUND()}."]
    out = []
    for table in site.manifest.floor:
        on = sorted(name for name in galleries if settings.floors.of(name) == table.name)
        if on:
            out.append(f"Floor {table.name} ({method(table)}): {_listed(on)}.")
    ground = sorted(name for name in galleries if (settings.floors.of(name) or GROUND_FLOOR) == GROUND_FLOOR)
    if ground:
        out.append(f"On the ground: {_listed(ground)}.")
    return [*out, *(f"{text}." for text in strangers(settings.floors, galleries))]


def method(table: FloorTable) -> str:
    """Say in words how a floor's motion is obtained."""
    if table.records:
        return "recorded on the floor"
    where = f"{table.height_ratio:g} of the building's height"
    period = "unknown period" if table.period_s is None else f"period {table.period_s:g} s"
    if table.method == "modal":
        return f"modes of a shear-flexural beam, {where}, {period}, Miranda and Taghavi 2005"
    return f"floor factor, {where}, {period}, ASCE 7-22"


def _listed(names: Sequence[str], most: int = 12) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
