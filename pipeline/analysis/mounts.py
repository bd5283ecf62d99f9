"""How a thing is held: in a case or by a mount, and by what else its record says of display, furniture and isolator.

A coin lies on its largest face; a mask is held by a mount of which hardly any record says how it grips.  Either is
stated by a house rule, or shown by what the record says of its support, or taken as is usual (tables/mounts.csv).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from math import cos, radians, sin
from textwrap import shorten

from pipeline.analysis.house.matching import MOUNTED_BY, HouseEffect
from pipeline.analysis.section import share_of
from pipeline.analysis.sizes import SIZES, Sizes, sizes_known
from pipeline.records import Estimate, Furniture, Item, Mount, Origin, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed_rows import WHEN_HELD, ObjectClass
from pipeline.tables.held_rows import CASES, told_by, words_for
from pipeline.tables.mount_rows import MountRow, mount_rows
from pipeline.tables.rows import any_of
from pipeline.tables.surface_rows import surfaces_in

BULKY, LAID = 0.35, 0.2
"""Smallest over largest size, and largest size [m], from which on a thing stands rather than lies: judgement."""

TALL, DEEP = 1.2, 0.3
"""Height and least size [m] from which on what is held by mounts stands on a base of its own: judgement."""

_UPRIGHT = (Mount.STANDING, Mount.LEANING)


@dataclass(frozen=True)
class MountGuess:
    """How a thing is held.

    Attributes
    ----------
    row : MountRow
        Which way.
    origin : Origin
        Of that knowledge.
    note : str
        In words, where it is assumed; "" where somebody said it.
    """

    row: MountRow
    origin: Origin
    note: str = ""

    @property
    def way(self) -> Mount:
        """Which way."""
        return self.row.mount

    @property
    def stands(self) -> bool:
        """Whether it stands by itself as other things do."""
        return self.way is Mount.STANDING

    @property
    def models_need_size(self) -> bool:
        """Whether its models ask how wide it is: it may tip."""
        return self.way in _UPRIGHT


def mount_of(item: Item, row: ObjectClass, house: HouseEffect, *, cased: bool = False) -> MountGuess | None:
    """Return how a thing is held.

    Parameters
    ----------
    item : Item
        Its record, with what house rules say of its support.
    row : ObjectClass
        Its class.
    house : HouseEffect
        What house rules come to for it.
    cased : bool
        Whether it would hang by its class, and is in a case (`told.in_case`).

    Returns
    -------
    MountGuess or None
        None for what stands or hangs by its class, for what hangs by its record, and for what is fastened by a section
        that was measured.
    """
    rows, told, words = mount_rows(), house.stated.get("mount"), told_by(item.displayed).mount
    # What leans does so whatever its class: a panel on an easel hangs no more.
    leans = words is Mount.LEANING and item.support is Support.FREESTANDING
    if words is not None and (leans or cased or item.support in (None, row.support)):
        return MountGuess(rows[words], Origin.MEASURED)
    if WHEN_HELD not in row.models and not cased:
        return None
    if told is not None:
        return MountGuess(rows[Mount(str(told.value))], Origin.STATED)
    if words is Mount.UNKNOWN:
        # On a pin or rod: what carries it is told, and not whether that holds it.
        return MountGuess(rows[words], Origin.MEASURED)
    if item.support is not None and not cased:
        way = MOUNTED_BY.get(item.support)
        if way is None or (way is Mount.SECURED and item.section_width_m is not None):
            return None
        return MountGuess(rows[way], Origin.STATED if "held" in house.stated else Origin.MEASURED)
    # Miniatures and plaques that are small enough lie in their case.
    other = rows[Mount.LYING if cased and max(sizes_known(item).values(), default=LAID) < LAID else Mount.UNKNOWN]
    usual = next((one for one in rows.values() if one.kind == row.name), other)
    if (usual.mount is Mount.LYING and _bulky(item)) or (usual.kind == "mounted" and _upright_by_itself(item)):
        usual = rows[Mount.STANDING]
    note = f"{say.MOUNT(mount=usual.title, told=row.told)}; {say.NOT_RECORDED()}"
    return MountGuess(usual, Origin.ASSUMED, note)


def _bulky(item: Item) -> bool:
    """Say whether a thing is too thick and too large to be laid down in a case."""
    sizes = sizes_known(item).values()
    return len(sizes) == len(SIZES) and min(sizes) >= BULKY * max(sizes) and max(sizes) >= LAID


def _upright_by_itself(item: Item) -> bool:
    """Say whether what is held by mounts is as tall and as deep as a figure: it has a stand with a base of its own.

    A suit of armour, a costume or a harp is no thing that a mount in a case could hold.
    """
    sizes = sizes_known(item)
    return (
        len(sizes) == len(SIZES)
        and sizes["height"] == max(sizes.values())
        and sizes["height"] >= TALL
        and min(sizes.values()) >= DEEP
    )


def mount_estimates(guess: MountGuess, row: ObjectClass, sizes: Sizes) -> Mapping[str, Estimate]:
    """Return what the models of a thing need of how it is held.

    Parameters
    ----------
    guess : MountGuess
        How it is held; not standing as other things do.
    row : ObjectClass
        Its class.
    sizes : Sizes
        Recorded or assumed.

    Returns
    -------
    mapping of str to Estimate
        ``friction_static`` where its mount grips it, ``clearance`` where it comes off by moving on it, ``half_width``
        and ``cg_height`` as it lies or leans where its sizes say them.
    """
    out: dict[str, Estimate] = {}
    told = guess.row
    grip, room, lean = (told.range(name) for name in ("grip", "room", "lean"))
    if grip is not None:
        note = say.GRIP(grip=grip, mount=told.title)
        out["friction_static"] = Estimate.assumed(grip.value, grip.low, grip.high, "-", note, grip.source)
    if room is not None:
        note = say.OFF_ITS_MOUNT(room=room)
        out["clearance"] = Estimate.assumed(room.value, room.low, room.high, "m", note, room.source)
    known = {name: getattr(sizes.filled, f"{name}_m") for name in SIZES}
    if lean is not None:
        lengths = {name: size for name, size in known.items() if size}
        long = _upright(lengths)
        if long:
            out |= _leaning(sizes, long, 0.5 * lengths[long], (lean.low, lean.value, lean.high), lean.source)
    elif guess.way is Mount.LYING and all(known.values()) and row.cg is not None and row.base is not None:
        thin, narrow, _ = sorted(known, key=known.__getitem__)
        cg = share_of(row, row.cg, known[thin], "m", "height of the centre of gravity", f"smallest size, its {thin}")
        half = share_of(row, row.base, 0.5 * known[narrow], "m", "half width of what it lies on", narrow)
        out["cg_height"] = sizes.spread(cg, (thin,))
        out["half_width"] = sizes.spread(half, (narrow,))
    return out


def _upright(lengths: Mapping[str, float]) -> str:
    """Return along which of its sizes a thing leans: its height, or where that is its thickness the longest."""
    if "height" in lengths and (len(lengths) == 1 or lengths["height"] > min(lengths.values())):
        return "height"
    return max(lengths, key=lengths.__getitem__, default="")


def _leaning(
    sizes: Sizes, long: str, half: float, angles: tuple[float, float, float], source: str
) -> dict[str, Estimate]:
    low, best, high = angles
    note = say.LEANS(lean=angles)
    wide, least, most = (half * sin(radians(angle)) for angle in (best, low, high))
    tall = half * cos(radians(best))
    cg = Estimate(tall, "m", Origin.DERIVED, tall, tall, say.LEANS_ON(size=long))
    return {
        "half_width": sizes.spread(Estimate.assumed(wide, least, most, "m", note, source), (long,)),
        "cg_height": sizes.spread(cg, (long,)),
    }


SLENDEREST = 9.0
"""Height over the smaller plan dimension from which nothing stands by itself: it lies, leans, hangs or is held."""

_QUOTED = 80
"""Characters of the museum's words that a note repeats."""

_ABOVE = (Support.HUNG, Support.SUSPENDED)

_TO_STAND_ON = (Furniture.FLOOR, Furniture.SHOWCASE, Furniture.PEDESTAL, Furniture.SHELF)

_IN_CASES = (Furniture.SHOWCASE, Furniture.SHELF)


def as_displayed(item: Item) -> Item:
    """Return a record with what its words for how it is displayed tell, where it does not name that.

    Parameters
    ----------
    item : Item
        The record.
    """
    if not item.displayed.strip():
        return item
    told = told_by(item.displayed)
    # Of what is recorded to hang or to stand the words for the other are about something else.
    stands = item.support is not None and item.support not in _ABOVE
    return replace(
        item,
        support=item.support or (None if item.hanging is not None else told.support),
        hanging=item.hanging or (None if stands else told.hanging),
        furniture=item.furniture or told.furniture,
        furniture_anchorage=item.furniture_anchorage or told.anchorage,
        surface_material=item.surface_material or " and ".join(surfaces_in(item.displayed)),
    )


def held_as_displayed(item: Item, support: Support) -> bool:
    """Say whether the words for its display alone tell that a thing is held by a brace, clips, ties or the like.

    Parameters
    ----------
    item : Item
        The record.
    support : Support
        How it is taken to be held.
    """
    return support is Support.FASTENED and told_by(item.displayed).mount is Mount.SECURED


def display_note(item: Item, support: Support) -> tuple[str, ...]:
    """Return what the words for its display say of how a thing is held, as the beginning of its notes; () for nothing.

    Parameters
    ----------
    item : Item
        The record.
    support : Support
        How it is taken to be held.
    """
    if told_by(item.displayed).support is not support:
        return ()
    said = say.HELD_AS_DISPLAYED if held_as_displayed(item, support) else say.DISPLAYED
    words = shorten(item.displayed.replace(";", ","), _QUOTED, placeholder="...")
    return (said(support=support.value, words=words),)


def as_told(item: Item, row: ObjectClass) -> Item:
    """Return a record with the support that the rest of it tells, where it does not name one.

    What has a footing that was measured stands on it, whatever things of its class usually do, and so does what usually
    hangs where its record names furniture to stand on.  What has an isolator stands on that.

    Parameters
    ----------
    item : Item
        The record, with what house rules say of its support.
    row : ObjectClass
        Its class.
    """
    if item.support is not None or item.hanging is not None:
        return item
    if item.isolator.strip():
        return replace(item, support=Support.ISOLATED)
    hangs = row.support in _ABOVE
    stands = _footing(item) or (hangs and (item.furniture in _TO_STAND_ON or _names_case(item)))
    usual = row.support is Support.FREESTANDING and WHEN_HELD not in row.models
    if not stands or (usual and not too_slender(item)):
        return item
    return replace(item, support=Support.FREESTANDING)


def in_case(item: Item, row: ObjectClass) -> bool:
    """Say whether what hangs by its class is held by a mount in a case: its record names one.

    A miniature, an icon or an enamelled plaque in "case 8" does not hang on the wall of the room.

    Parameters
    ----------
    item : Item
        The record, with what house rules say of its support.
    row : ObjectClass
        Its class.
    """
    if item.support is not None or item.hanging is not None or row.support is not Support.HUNG or _footing(item):
        return False
    return item.furniture in _IN_CASES or (item.furniture is None and _names_case(item))


def _footing(item: Item) -> bool:
    measured = item.base_width_m or item.base_depth_m or item.contact_polygon
    return bool(measured) or item.tilt_angle_deg is not None


def _names_case(item: Item) -> bool:
    return bool(item.case) and _case_words().search(item.case) is not None


@cache
def _case_words() -> re.Pattern[str]:
    # In a field for cases a bare word is enough; elsewhere it may be of furniture that is shown.
    return any_of([*CASES, "cabinet", *(word for kind in _IN_CASES for word in words_for(kind))])


def too_slender(item: Item) -> float:
    """Return how many times as high as deep a thing is that by that cannot stand by itself; else 0."""
    plan = [d for d in (item.base_width_m or item.width_m, item.base_depth_m or item.depth_m) if d]
    times = item.height_m / min(plan) if plan and item.height_m is not None else 0.0
    return times if times > SLENDEREST else 0.0
