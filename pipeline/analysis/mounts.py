"""How a thing is held that lies in a case or cannot stand by itself, and the numbers that its models need of that.

A coin lies on its largest face; a mask is held by a mount of which hardly any record says how it grips.  Either is
stated by a house rule, or shown by what the record says of its support, or taken as is usual (tables/mounts.csv).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, radians, sin

from pipeline.analysis.house.matching import MOUNTED_BY, HouseEffect
from pipeline.analysis.section import share_of
from pipeline.analysis.sizes import SIZES, Sizes, sizes_known
from pipeline.records import Estimate, Furniture, Hanging, Item, Mount, Origin, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed_rows import WHEN_HELD, ObjectClass
from pipeline.tables.body_rows import CYCLES, BodyRow
from pipeline.tables.held_rows import told_by
from pipeline.tables.mount_rows import MountRow, mount_rows

BULKY, LAID = 0.35, 0.2
"""Smallest over largest size, and largest size [m], from which on a thing stands rather than lies: judgement."""

THIN = 0.15
"""Smallest over largest size below which what lies in cases leans on its stand: judgement."""

DEEP_ENOUGH = 0.7
"""Smaller plan dimension over height from which on what is long slides before it tips: judgement."""

TALL, DEEP = 1.2, 0.3
"""Height and least size [m] from which on what is held by mounts stands on a base of its own: judgement."""

OF_CASE = 0.6
"""Height [m] below which the stand of what is held by mounts is a mount, and no figure with a base of its own.

Judgement: what is taller than most cases stands on its own base.
"""

_STAND = re.compile(
    r"\b(?:on|by|with) (?:\S+ ){0,3}\S*stands?\b|t-bar|ständer|stativ|support|supporto|soporte|suporte|standaard"
    r"|stojan|stojak|állvány|подставк|βάση|台",
    re.IGNORECASE,
)
"""Words for the stand of what is held by mounts."""

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
    # So does what lies: a carpet on the floor.
    laid = words is Mount.LYING and row.support is Support.HUNG
    leans = (words is Mount.LEANING or laid) and item.support is Support.FREESTANDING
    fixed = item.hanging is Hanging.FIXED
    if words is not None and (leans or cased or (item.support in (None, row.support) and not fixed)):
        return MountGuess(rows[words], Origin.MEASURED)
    pinned = words is Mount.UNKNOWN and item.support is Support.FASTENED and item.section_width_m is None
    if WHEN_HELD not in row.models and not (cased or pinned):
        return None
    if told is not None:
        return MountGuess(rows[Mount(str(told.value))], Origin.STATED)
    if words is Mount.UNKNOWN:
        # On a pin or rod: what carries it is told, and not whether that holds it.
        return MountGuess(rows[words], Origin.MEASURED)
    if item.support is Support.FASTENED and cased:
        return MountGuess(rows[Mount.SECURED], Origin.MEASURED)
    if item.support is not None and not cased:
        way = MOUNTED_BY.get(item.support)
        if way is None or (way is Mount.SECURED and item.section_width_m is not None):
            return None
        if way is Mount.STANDING and row.name == rows[Mount.LYING].kind and _thin(item):
            # A disc or a plaque on a stand does not stand on its edge.
            way = Mount.LEANING
        elif way is Mount.STANDING and _on_small_stand(item, row, rows):
            # A mask or a helmet on a stand has no foot: what stands is its mount, and how that grips is not told.
            way = Mount.UNKNOWN
        elif way is Mount.STANDING and _low(item):
            # An anchor stock on two blocks lies along them.
            way = Mount.LYING
        return MountGuess(rows[way], Origin.STATED if "held" in house.stated else Origin.MEASURED)
    # Miniatures and plaques that are small enough lie in their case.
    other = rows[Mount.LYING if cased and max(sizes_known(item).values(), default=LAID) < LAID else Mount.UNKNOWN]
    usual = next((one for one in rows.values() if one.kind == row.name), other)
    if (usual.mount is Mount.LYING and _bulky(item)) or (usual.kind == "mounted" and _upright_by_itself(item)):
        usual = rows[Mount.STANDING]
    note = f"{say.MOUNT(mount=usual.title, told=row.told)}; {say.NOT_RECORDED()}"
    return MountGuess(usual, Origin.ASSUMED, note)


def mount_of_body(item: Item, support: Support, body: BodyRow | None) -> MountGuess | None:
    """Return how a thing is held whose kind has no section that is known to be weak; None where it stands by itself.

    A bicycle that is strapped to its plinth does not bend at its foot: what holds it is what may fail.  On a bracket it
    is held by that, and does not stand on it as on a shelf.

    Parameters
    ----------
    item : Item
        Its record.
    support : Support
        How it is taken to be held.
    body : BodyRow or None
        What is known of its shape.
    """
    if body is None or body.section or item.section_width_m is not None:
        return None
    told, rows = told_by(item.displayed), mount_rows()
    if support is Support.FASTENED and told.mount is Mount.SECURED:
        return MountGuess(rows[Mount.SECURED], Origin.MEASURED)
    if body.body in CYCLES and support is Support.FREESTANDING and told.furniture is Furniture.SHELF:
        return MountGuess(rows[Mount.UNKNOWN], Origin.MEASURED)
    return None


def _on_small_stand(item: Item, row: ObjectClass, rows: Mapping[Mount, MountRow]) -> bool:
    """Say whether what cannot stand by itself is said to be on a stand that is no taller than what fits a case."""
    tall = sizes_known(item).get("height", 0.0) >= OF_CASE
    return row.name == rows[Mount.UNKNOWN].kind and not tall and _STAND.search(item.displayed) is not None


def _thin(item: Item) -> bool:
    """Say whether a thing is so thin that it leans on whatever it is said to stand on."""
    sizes = sizes_known(item).values()
    return len(sizes) > 1 and min(sizes) < THIN * max(sizes)


def _low(item: Item) -> bool:
    """Say whether a thing is so much longer than high, and nearly as deep as that, that it lies on its underside."""
    sizes = sizes_known(item)
    if len(sizes) < len(SIZES):
        return False
    plan = (sizes["width"], sizes["depth"])
    return sizes["height"] <= BULKY * max(plan) and min(plan) >= DEEP_ENOUGH * sizes["height"]


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
