"""Furniture that an object stands on or in, or hangs from, and the numbers by which that passes the shaking on.

Which furniture it is comes from the record, else from a house rule, else from the case that the record names, else from
what is usual for the class and height of the object (tables/usual_furniture.csv).  Its numbers come from the row of its
kind (tables/furniture.csv) and are ranges: what they do to the shaking is found for the whole range
(`pipeline.analysis.furnished`).  Furniture that is not fastened slides or rocks itself (`pipeline.analysis.loose`).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from math import hypot, radians

from pipeline.analysis.footing import on_wheels
from pipeline.analysis.house.matching import HouseEffect
from pipeline.models.unanchored import UNANCHORED
from pipeline.records import Anchorage, Estimate, Furniture, Item, Origin, Scene, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed import AssumedValues, assumed
from pipeline.tables.furniture_rows import ANY, STANDING, FurnitureRow, UsualFurniture, usual_furniture
from pipeline.tables.held_rows import in_no_case, words_for
from pipeline.tables.limit_rows import limit
from pipeline.tables.rows import any_of
from pipeline.tables.surface_rows import surfaces_in

FREQUENCY, DAMPING, LEVEL_ERROR = "furniture_frequency", "furniture_damping", "level_error"

HALF_WIDTH, CG_HEIGHT, FRICTION = "furniture_half_width", "furniture_cg_height", "furniture_friction"

SHELF_HEIGHT = "shelf_height"

OF_LOOSE = (HALF_WIDTH, CG_HEIGHT, FRICTION, SHELF_HEIGHT)
"""Parameters of a scene that follow from its furniture where that is not fastened."""

OF_FURNITURE = (FREQUENCY, DAMPING, LEVEL_ERROR, *OF_LOOSE)
"""Parameters of a scene that follow from its furniture."""

LONG = 0.6
"""Share of its larger side that counts as a height when it is guessed what a thing stands on: judgement.

A canoe of 5 m, 0.45 m high, stands in no showcase.
"""

TALL = 0.6
"""Height [m] from which its larger side counts too: a rocking horse of 1.5 m stands on no pedestal; judgement."""

STANDS = (Support.FREESTANDING, Support.FASTENED, Support.ISOLATED)
"""How what bears on its furniture is held."""

FLOOR_BEARS = 500.0
"""Load [kg/m2] that floors of museums are made for (5 kN/m2: EN 1991-1-1, C3)."""

_SLOPES = re.compile(
    r"\b(?:(?:sloping|uneven|sagging|tilted|inclined|unlevel) (?:\w+ )?(?:floor|ground|boards|flags)|"
    r"floor (?:slopes|sags|is (?:not level|uneven|sloping))|(?:out of|off|not) level|"
    r"(?:schief|schräg|uneben|geneigt)e[nmrs]? (?:Fuß)?[Bb]oden|sol (?:en pente|inégal|incliné)|"
    r"pavimento (?:inclinato|in pendenza|irregolare|sconnesso)|(?:suelo|piso) (?:inclinado|desnivelado|irregular)|"
    r"κεκλιμένο δάπεδο|ανισόπεδο δάπεδο)\b|傾いた床|床が傾|床の傾斜",
    re.IGNORECASE,
)
"""What says of a floor that it is not level."""

WHAT_HANGS = {Support.HUNG: "what hangs on a wall", Support.SUSPENDED: "what hangs from above"}
"""What is said of furniture to be usual for, where it is so for whatever hangs."""
IN_THE_OPEN = "what stands in the open"
IN_NO_CASE = "what its record puts in no case"
"""The same of whatever stands in a garden, a court, on a terrace."""
ON_WHEELS = "what stands on wheels"
"""The same of what would stand on a pedestal, and rolls."""
_OPEN = any_of([
    *("garden", "gardens", "courtyard", "patio", "terrace", "grounds", "outdoors", "outside", "forecourt", "car park"),
    *("lawn", "sculpture park", "foreshore", "Garten", "Innenhof", "Hof", "Vorplatz", "Außengelände", "im Freien"),
    *("jardin", "jardins", "cour", "parc", "parvis", "extérieur", "giardino", "cortile", "terrazza", "parco"),
    *("jardín", "terraza", "parque", "exterior", "jardim", "pátio", "terraço", "tuin", "binnenplaats", "esterno"),
    *("grădină", "curte", "bahçe", "bahçesi", "avlu", "avlusu", "αυλή", "κήπος", "dvorište", "vrt", "perivoj", "двор"),
    *("двір", "подвір'я", "сад", "градина", "двориште", "ogród", "dziedziniec", "zahrada", "nádvoří", "kert", "udvar"),
    *("gårdsplads", "hage", "trädgård", "piha", "中庭", "庭園", "前庭", "屋外", "庭院", "室外", "마당"),
    *("정원", "야외", "حديقة", "فناء", "حیاط", "חצר", "גן", "halaman", "taman", "sân", "vườn"),
])  # fmt: skip
"""Words of places under the sky; with one of a room, as in "Garden Room", they name that (judgement)."""
_ROOFED = re.compile(
    r"room|galler|hall|wing|salle|sala\b|saal|raum|zaal|terem|αίθουσα|salon|зал|室|館|ward|cabinet|restaurant|caf[eé]|shop",
    re.IGNORECASE,
)

_CASES = frozenset({Furniture.SHOWCASE, Furniture.SHELF})

_NOT_FASTENED = re.compile(r"; (?:taken as )?not fastened, .*$", re.DOTALL)
"""The end of a note of furniture that is not fastened, with who says so."""


@dataclass(frozen=True, slots=True)
class LooseBody:
    """Furniture that is not fastened, as a rigid body on its floor.

    Attributes
    ----------
    half_width, cg_height, friction : float
        From the middle of its base to the nearest edge [m], height of the centre of gravity [m], friction [-].
    shelf_height : float
        At which objects stand in it or on it [m].
    """

    half_width: float
    cg_height: float
    friction: float
    shelf_height: float


@dataclass(frozen=True, slots=True)
class LooseBodies:
    """What furniture that is not fastened may be.

    Attributes
    ----------
    best : LooseBody
        By the best estimates.
    firm : LooseBody
        That which moves last, and so passes on the most of what shakes it: wide, low and rough.
    tippy : LooseBody
        That which rocks first: narrow, high and rough.
    slippery : LooseBody
        That which slides first, by the best estimates of its size.
    """

    best: LooseBody
    firm: LooseBody
    tippy: LooseBody
    slippery: LooseBody


@dataclass(frozen=True, slots=True)
class FurnitureFilter:
    """What furniture does to the shaking of its floor, as far as it is known.

    Attributes
    ----------
    frequency, damping : tuple of float
        Low, best and high of its lowest mode [Hz] and [-]; () for what moves as the floor does.
    level_error : float
        By how much it may be off level, in any direction [rad].
    resonant : bool
        Whether what stands in it has a frequency of its own that is known, so that any of its own may be the worst.
    loose : LooseBodies or None
        What it may be as a body on its floor; None where it is fastened.
    """

    frequency: tuple[float, ...]
    damping: tuple[float, ...]
    level_error: float
    resonant: bool = False
    loose: LooseBodies | None = None


@dataclass(frozen=True, slots=True)
class FurnitureGuess:
    """Furniture of an object, and where that is known from.

    Attributes
    ----------
    furniture : Furniture
        Its kind.
    origin : Origin
        Of that knowledge.
    words, source : str
        In words, and who says so.
    """

    furniture: Furniture
    origin: Origin
    words: str
    source: str = ""


@cache
def _usual(object_class: str, support: str, height: float) -> UsualFurniture:
    here = [row for row in usual_furniture() if row.support == support and (height >= row.taller_than or row.unsized)]
    mine = [row for row in here if row.object_class == object_class] or [row for row in here if row.object_class == ANY]
    unsized = [row for row in mine if row.unsized and not height]
    return max(unsized or [row for row in mine if height >= row.taller_than], key=lambda row: row.taller_than)


def furniture_of(item: Item, object_class: str, support: Support, house: HouseEffect) -> FurnitureGuess:
    """Return what an object stands on or in, or hangs from.

    Parameters
    ----------
    item : Item
        Its record.
    object_class : str
        Row of classes.csv.
    support : Support
        How it is held.
    house : HouseEffect
        What the house rules come to for it.

    Returns
    -------
    FurnitureGuess
        By its record, else by a house rule, else by the case that its record names, else as is usual for its class.
    """
    stated = house.stated.get("furniture")
    if item.furniture is not None and stated is None:
        return FurnitureGuess(item.furniture, Origin.MEASURED, "as recorded")
    if stated is not None:
        return FurnitureGuess(Furniture(str(stated.value)), Origin.STATED, stated.origin, stated.source)
    hangs = support in (Support.HUNG, Support.SUSPENDED)
    case = item.case.strip()
    if case and not hangs:
        # Whatever else it is called, what things stand in is a showcase; one with a shelf in it is softer.
        named = (kind for kind in (Furniture.PEDESTAL, Furniture.SHELF) if _named(kind).search(case))
        kind = next(named, Furniture.SHOWCASE)
        return FurnitureGuess(kind, Origin.DERIVED, f"for its record names the case or plinth {case!r}")
    row = _usual(object_class, support.value if hangs else STANDING, _largest(item, hangs=hangs))
    if row.furniture in _CASES and not hangs and in_the_open(item.gallery):
        words = f"assumed for: {IN_THE_OPEN}, usual_furniture.csv; not recorded"
        return FurnitureGuess(Furniture.FLOOR, Origin.ASSUMED, words, "judgement: no case stands under the sky")
    if row.furniture is Furniture.SHOWCASE and not hangs and in_no_case(item.displayed):
        words = f"assumed for: {IN_NO_CASE}, usual_furniture.csv; not recorded"
        return FurnitureGuess(Furniture.PEDESTAL, Origin.ASSUMED, words, "judgement: its record says it is in no case")
    if row.furniture is Furniture.PEDESTAL and not hangs and on_wheels(item, object_class) is not None:
        words = f"assumed for: {ON_WHEELS}, usual_furniture.csv; not recorded"
        return FurnitureGuess(Furniture.FLOOR, Origin.ASSUMED, words, "judgement: nothing rolls about on a pedestal")
    about = "what stands" if row.object_class == ANY else object_class.replace("_", " ")
    from_ = f" from {row.taller_than:g} m on" if row.taller_than else ""
    about = WHAT_HANGS.get(support, about)
    words = f"assumed for: {about}{from_}, usual_furniture.csv; not recorded"
    return FurnitureGuess(row.furniture, Origin.ASSUMED, words, f"usual_furniture.csv ({row.source})")


@lru_cache(maxsize=4096)
def in_the_open(place: str) -> bool:
    """Say whether the name of a place is that of one under the sky: a garden, a court, a terrace."""
    return _OPEN.search(place) is not None and _ROOFED.search(place) is None


def _largest(item: Item, *, hangs: bool) -> float:
    """Return what counts as a height [m] when it is guessed what a thing stands on or hangs from."""
    height, side = item.height_m or 0.0, max(item.width_m or 0.0, item.depth_m or 0.0)
    if hangs:
        return height
    return hypot(height, side) if height >= TALL else max(height, LONG * side)


@cache
def _named(kind: Furniture) -> re.Pattern[str]:
    return any_of(words_for(kind))


def in_furniture(scene: Scene, house: HouseEffect, values: AssumedValues) -> Scene:
    """Return a scene with the furniture that its object stands on or in, or hangs from.

    Parameters
    ----------
    scene : Scene
        Without it.
    house : HouseEffect
        What the house rules come to for the object.
    values : AssumedValues
        The numbers of each kind of furniture.

    Returns
    -------
    Scene
        With its kind, where that comes from, and, where models are run on it, its numbers and what is assumed of them.
    """
    guess = furniture_of(scene.item, scene.object_class, scene.support, house)
    row = values.furniture[guess.furniture.value]
    said, words = _anchorage(scene.item, house) if row.frequency is not None else (None, "")
    scene = replace(scene, furniture=guess.furniture, furniture_origin=guess.origin, anchorage=said)
    if not scene.models:
        return scene
    known = _numbers(row, guess, said, words)
    if known:
        notes = tuple(one.note for one in known.values())
    elif guess.origin is Origin.ASSUMED and scene.support not in (Support.HUNG, Support.SUSPENDED):
        notes = (f"furniture: {row.title}, {guess.words}",)
    else:
        notes = ()
    slope = _slope(scene, known.get(LEVEL_ERROR))
    if slope is not None:
        known, notes = {**known, LEVEL_ERROR: slope}, (*notes, slope.note)
    notes = (*notes, *_overloads(scene, row))
    return replace(scene, parameters={**scene.parameters, **known}, assumptions=(*scene.assumptions, *notes))


def _slope(scene: Scene, own: Estimate | None) -> Estimate | None:
    """Return by how much a thing is off level whose record says that its floor slopes [rad]; None of others.

    own : of what it stands on or in, which leans by as much more
    """
    item = scene.item
    if scene.support in (Support.HUNG, Support.SUSPENDED) or not _SLOPES.search(f"{item.displayed}; {item.gallery}"):
        return None
    room = limit("sloping_floor")
    most = radians(room.value) + (0.0 if own is None else own.high)
    return Estimate.assumed(0.0, -most, most, "rad", say.FLOOR_SLOPES(angle=room.value), f"limits.csv ({room.source})")


def row_of_loads(row: FurnitureRow) -> FurnitureRow:
    """Return the row that says what furniture bears and takes: the museum's own, or else Kouros's of that kind."""
    return row if row.bears is not None or row.takes is not None else assumed().furniture[row.key]


def _overloads(scene: Scene, row: FurnitureRow) -> tuple[str, ...]:
    """Return the doubt that what an object stands on bears it, by the best estimate of its mass; () for none."""
    mass, item = scene.parameters.get("mass"), scene.item
    if mass is None or scene.support not in STANDS:
        return ()
    bears, glass = row_of_loads(row).range("bears"), limit("glass_shelf")
    indoors = scene.furniture in (Furniture.SHOWCASE, Furniture.SHELF)
    if indoors and mass.value > glass.value and "glass" in surfaces_in(item.surface_material, of_surface=True):
        return (say.HEAVY_FOR_GLASS(mass=mass.value, bears=glass),)
    if bears is not None:
        if mass.value <= bears.value:
            return ()
        return (say.HEAVY_FOR_FURNITURE(mass=mass.value, furniture=row.title, bears=bears),)
    area = (item.width_m or item.depth_m or 0.0) * (item.depth_m or item.width_m or 0.0)
    load = mass.value / max(area, limit("floor_spread").value)
    if scene.furniture is not Furniture.FLOOR or load <= FLOOR_BEARS:
        return ()
    return (say.HEAVY_FOR_FLOOR(load=load, bears=FLOOR_BEARS),)


def _anchorage(item: Item, house: HouseEffect) -> tuple[Anchorage | None, str]:
    """Return whether furniture is fastened, None where nobody says it, and who says it in words."""
    stated = house.stated.get("furniture_anchorage")
    if stated is not None:
        return Anchorage(str(stated.value)), stated.origin
    return item.furniture_anchorage, "" if item.furniture_anchorage is None else "as recorded"


@lru_cache(maxsize=4096)
def _numbers(row: FurnitureRow, guess: FurnitureGuess, said: Anchorage | None, words: str) -> Mapping[str, Estimate]:
    out = {}
    loose = (said or row.anchorage) is Anchorage.UNANCHORED
    held = f"{'not ' if loose else ''}fastened, {words}" if words else ""
    frequency, damping = row.range("frequency"), row.range("damping")
    if frequency is not None and damping is not None:
        low, best, high = frequency.low, frequency.value, frequency.high
        held = held or f"taken as {'not ' if loose else ''}fastened, which nobody says"
        shakes = say.FURNITURE_SHAKES(frequency=frequency, table=row.table)
        note = f"furniture: {row.title}, {guess.words}; {shakes}; {held}"
        out[FREQUENCY] = Estimate.assumed(best, low, high, "Hz", note, frequency.source)
        low, best, high = damping.low, damping.value, damping.high
        note = say.FURNITURE_DAMPING(damping=damping, table=row.table, furniture=row.title)
        out[DAMPING] = Estimate.assumed(best, low, high, "-", note, damping.source)
    if row.level_error:
        most = radians(row.level_error)
        note = say.FURNITURE_LEVEL(angle=row.level_error, table=row.table, furniture=row.title)
        out[LEVEL_ERROR] = Estimate.assumed(0.0, -most, most, "rad", note, f"{row.table} ({row.source})")
    return out | _body(row) if loose else out


def _body(row: FurnitureRow) -> dict[str, Estimate]:
    """Return what furniture slides or rocks by: of the museum's own row, or else of Kouros's."""
    row = row if row.shelf_height is not None else assumed().furniture[row.key]
    out = {}
    for name, column, unit, phrase in (
        (HALF_WIDTH, "half_width", "m", say.FURNITURE_HALF_WIDTH),
        (CG_HEIGHT, "cg_height", "m", say.FURNITURE_CG),
        (FRICTION, "friction", "-", say.FURNITURE_FRICTION),
    ):
        span = row.range(column)
        if span is None:
            continue
        note = phrase(span=span, table=row.table, furniture=row.title)
        out[name] = Estimate.assumed(span.value, span.low, span.high, unit, note, span.source)
    if row.shelf_height is not None:
        at = row.shelf_height
        note = say.FURNITURE_HEIGHT(height=at, table=row.table, furniture=row.title)
        out[SHELF_HEIGHT] = Estimate.assumed(at, at, at, "m", note, f"{row.table} ({row.source})")
    return out


def loose(scene: Scene) -> bool:
    """Say whether the furniture of a scene is not fastened, and what it slides or rocks by is known."""
    return all(name in scene.parameters for name in OF_LOOSE)


def fastened(scene: Scene) -> Scene:
    """Return a scene whose furniture is fastened: what was assumed of it as a loose body is forgotten."""
    gone = {scene.parameters[name].note for name in OF_LOOSE if name in scene.parameters}
    kept = {name: one for name, one in scene.parameters.items() if name not in OF_LOOSE}
    said = {}
    if FREQUENCY in kept:
        before = kept[FREQUENCY].note
        said[before] = _NOT_FASTENED.sub("; fastened", before)
        kept[FREQUENCY] = replace(kept[FREQUENCY], note=said[before])
    return replace(
        scene,
        anchorage=Anchorage.ANCHORED,
        parameters=kept,
        assumptions=tuple(said.get(text, text) for text in scene.assumptions if text not in gone),
    )


def itself(scene: Scene) -> Scene:
    """Return the furniture of a scene that is not fastened, as a standing body under the number of its object.

    What makes it slide and rock is its own shaking: its mass is taken to move as what stands in it would.
    """
    known = scene.parameters
    return Scene(
        Item(scene.item.object_number, scene.item.gallery),
        "",
        "",
        Support.FREESTANDING,
        (UNANCHORED.name,),
        {name: known[name] for name in (FREQUENCY, DAMPING) if name in known}
        | {"half_width": known[HALF_WIDTH], "cg_height": known[CG_HEIGHT], "friction_static": known[FRICTION]},
        floor=scene.floor,
    )


def without_furniture(scene: Scene) -> Scene:
    """Return a scene on which the furniture has no part in the shaking: of what feels what that passes on already."""
    gone = (FREQUENCY, DAMPING, LEVEL_ERROR)
    return replace(scene, parameters={name: one for name, one in scene.parameters.items() if name not in gone})


def filter_of(scene: Scene) -> FurnitureFilter | None:
    """Return what the furniture of a scene does to the shaking of its floor; None where it does nothing to it."""
    known = scene.parameters
    frequency, damping, level = (known.get(name) for name in (FREQUENCY, DAMPING, LEVEL_ERROR))
    if frequency is None and level is None:
        return None
    ends = [() if one is None else (one.low, one.value, one.high) for one in (frequency, damping)]
    own = known.get("frequency")
    # Of one that is a range the worst is searched for anyway; that of an isolator is not the object's.
    resonant = own is not None and own.low == own.high and scene.support is not Support.ISOLATED
    off = 0.0 if level is None else max(abs(level.low), abs(level.high))
    return FurnitureFilter(ends[0], ends[1], off, resonant, _bodies(known) if loose(scene) else None)


def _bodies(known: Mapping[str, Estimate]) -> LooseBodies:
    half, high, rough, shelf = (known[name] for name in OF_LOOSE)
    at = shelf.value
    return LooseBodies(
        best=LooseBody(half.value, high.value, rough.value, at),
        firm=LooseBody(half.high, high.low, rough.high, at),
        tippy=LooseBody(half.low, high.high, rough.high, at),
        slippery=LooseBody(half.value, high.value, rough.low, at),
    )
