"""How a thing is held by what its record says besides: how it is displayed, its footing, furniture and isolator."""

import re
from dataclasses import replace
from functools import cache
from textwrap import shorten

from pipeline.analysis.rules import PICTURES, readings
from pipeline.collection.places import beside_case, case_in
from pipeline.quantities import LENGTHS
from pipeline.records import Furniture, Hanging, Item, Mount, Scene, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed_rows import WHEN_HELD, ObjectClass
from pipeline.tables.held_rows import CASES, hangs_above, stands_or_hangs, stands_too, told_by, words_for
from pipeline.tables.rows import any_of
from pipeline.tables.surface_rows import surfaces_in

SLENDEREST = 9.0
"""Height over the smaller plan dimension from which nothing stands by itself: it lies, leans, hangs or is held."""

SLENDEREST_CLOCK = 12.0
"""The same of longcase clocks: five of the Carnegie Museum of Art are 5.4 to 9.05 times as high as they are deep."""

CLOCK, LONGCASE = "clock", 1.5
"""Their class, and height [m] from which a clock is one."""

_QUOTED = 80
"""Characters of the museum's words that a note repeats."""

_LINES = (
    r"(?:wires?|cables?|chains?|ropes?|cords?|rods?|lines?|Kette[n]?|Seile?n?|Stahlseile?n?|Drähten?|Draht|chaînes?|"
    r"câbles?|cordes?|caten[ae]|cav[io]|cadenas?|cables?|αλυσίδα|συρματόσχοινο)"
)
_LONG = r"(\d{1,3}(?:[.,]\d{1,3})?)\s?(m|cm|ft|feet)\b"
_OF_STUFF = (
    r"(?: (?:aus|en|in|di|de|of|d['’]) ?(?:Edelstahl|Stahl|steel|acero|acier|acciaio|aço|hierro|fer|ferro|laiton|latón"
    r"|ottone|n[yi]lon|chanvre|canapa|cáñamo|algodón|cordage)| ropes?| d['’](?:acier|acciaio|inox))?"
)
_HUNG_BY = re.compile(
    rf"\b{_LINES}{_OF_STUFF}(?:,| (?:of|von|de|di|da))? ?{_LONG}|(?<![\d.,]){_LONG}(?:[ -]long)? {_LINES}\b",
    re.IGNORECASE,
)
"""How long a line is that something hangs by: "by a chain of 2 m", "on 3 m cables"."""

_WALL = re.compile(
    r"wall|wand\b|wänd|\bmur|paret|pared|perete|τοίχ|壁|벽|墙|\bzid|стен|стін|ścian|stěn|\bfal|duvar|vegg|vägg|væg|sein",
    re.IGNORECASE,
)
_BEHIND = re.compile(
    r"\b(?:to|into|from|against) (?:(?:the|a|its|steel|metal|rear|back|stone|brick|wooden) ){0,2}"
    r"(?:walls?|pillars?|piers?|columns?|backboards?|back ?plates?|back ?panels?)\b"
    r"|\b(?:through|by) (?:its |the )?back(?:board|plate| board)?\b|\bbraced\b|\bstruts?\b|\bstay(?:s|ed)\b|\bguyed\b"
    r"|\ban (?:der|die) Wand\b|\bam Pfeiler\b|verstrebt|\bStreben?\b|Rückwand|\b(?:au|à la|contre le) (?:mur|pilier)\b"
    r"|\ba(?:lla|l) (?:parete|muro|pilastro)\b|\ba(?: la|l) (?:pared|muro|pilar)\b|arriostrad|controventat|haubané"
    r"|στον τοίχο|壁",
    re.IGNORECASE,
)
"""What says that a thing that is made fast is held above its base too."""

_FURNITURE = ("cabinet", "clock", "table", "seat")
DEEP = 0.25
"""Smaller plan dimension [m] from which what stands by its class hardly hangs flat on a wall: judgement."""
THICK, STANDS_FROM = 0.15, 1.0
"""Smaller plan dimension and height [m] from which it stands before the wall that it is fixed to: judgement."""
TALL, HEAVY = 1.5, 100.0
"""Height [m] and mass [kg] from which it does so where its plan is not recorded, or is too low for that: judgement."""
BULKY = 0.4
"""Smaller plan dimension [m] from which what is held by a mount stands as well, where it is as tall: judgement."""
_UPRIGHT = (*_FURNITURE, "statue", "standing_figure")
HANGS_FROM = 0.5
"""Largest size [m] from which a title is believed that says that a thing hangs from above: judgement."""

_ABOVE = (Support.HUNG, Support.SUSPENDED)

_TOGETHER = ((Support.FASTENED, Support.FREESTANDING), (Support.ISOLATED, Support.FREESTANDING))
"""How a thing is held, and what may be said of it besides: what is made fast stands too."""

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
        item = _as_titled(_as_placed(item))
    if not item.displayed.strip():
        return item
    told = told_by(item.displayed)
    # A stand within a case is no pedestal of its own, nor is its floor the room's: "case 3", fixed to its base.
    within = told.furniture in (Furniture.PEDESTAL, Furniture.FLOOR) and _names_case(item)
    # What hangs from a line or a hook of a case is shaken as that is.
    hangs_in_case = told.support in _ABOVE and _names_case(item) and not _WALL.search(item.displayed)
    cased = Furniture.SHOWCASE if hangs_in_case else None
    # Of what is recorded to hang or to stand the words for the other are about something else.
    stands = item.support is not None and item.support not in _ABOVE
    return replace(
        item,
        support=item.support or (None if item.hanging is not None else told.support),
        hanging=item.hanging or (None if stands else told.hanging),
        furniture=item.furniture or (cased if within else told.furniture or cased),
        furniture_anchorage=item.furniture_anchorage or told.anchorage,
        surface_material=item.surface_material or " and ".join(surfaces_in(item.displayed)),
    )


def _as_placed(item: Item) -> Item:
    """Return a record with what its field for cases says of how it is held: "on the wall", "case 3, hung"."""
    if not item.case.strip():
        return item
    if not _names_case(item):
        return replace(item, displayed=item.case, case=case_in(item.case)) if stands_or_hangs(item.case) else item
    beside = beside_case(item.case)
    return replace(item, displayed=item.case) if beside and stands_or_hangs(beside) else item


def _as_titled(item: Item) -> Item:
    """Return a record as displayed as its title says of a large thing that hangs: "Dinghy suspended above stairs".

    A pendant is suspended from its chain: what is small is not meant.  Nor is what a picture shows.
    """
    open_ = item.support is None and item.furniture is None
    large = max(item.height_m or 0.0, item.width_m or 0.0, item.depth_m or 0.0) >= HANGS_FROM
    if not (open_ and large and hangs_above(item.title)) or readings(item).decided.rule.object_class in PICTURES:
        return item
    return replace(item, displayed=item.title)


def line_of(words: str) -> float | None:
    """Return how long the lines are that a thing hangs by [m], by the words for its display; None where none says it.

    Parameters
    ----------
    words : str
        For its display.
    """
    found = _HUNG_BY.search(words)
    if found is None:
        return None
    number, unit = (one.lower() for one in found.groups() if one is not None)
    return float(number.replace(",", ".")) * LENGTHS["ft" if unit == "feet" else unit] or None


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


def held_behind(item: Item, support: Support) -> bool:
    """Say whether the words for its display tell that a thing is held at a wall, a pillar or a brace above its base.

    Parameters
    ----------
    item : Item
        The record.
    support : Support
        How it is taken to be held.
    """
    words = item.displayed
    told = told_by(words).support in (Support.FASTENED, Support.HUNG)
    return support is Support.FASTENED and told and _BEHIND.search(words) is not None


def display_note(item: Item, support: Support) -> tuple[str, ...]:
    """Return what the words for its display say of how a thing is held, as the beginning of its notes; () for nothing.

    Parameters
    ----------
    item : Item
        The record.
    support : Support
        How it is taken to be held.
    """
    how = told_by(item.displayed)
    told = how.support
    words = shorten(item.displayed.replace(";", ","), _QUOTED, placeholder="...")
    if told is None:
        return ()
    notes = [say.DISPLAY_WALL()] if how.furniture is Furniture.WALL and support is Support.HUNG else []
    if told is support:
        said = say.HELD_AS_DISPLAYED if held_as_displayed(item, support) else say.DISPLAYED
        notes.append(said(support=support.value, words=words))
    other = told if told is not support else Support.FREESTANDING if stands_too(item.displayed) else support
    if other is not support and (support, other) not in _TOGETHER and not _hangs_so(item, support, other):
        notes.append(say.SAID_OTHERWISE(support=support.value, other=other.value, words=words))
    return tuple(notes)


def unseen_holds(scene: Scene) -> tuple[str, ...]:
    """Return the notes of a scene on what it takes to hold by its record alone, whatever state it is found in.

    Parameters
    ----------
    scene : Scene
        With its notes.
    """
    notes = display_note(as_displayed(scene.item), scene.support)
    held = held_as_displayed(scene.item, scene.support)
    shown = [note for note in notes if note == say.DISPLAY_WALL() or (held and note.startswith("support:"))]
    return tuple(note for note in shown if note in scene.assumptions)


def _hangs_so(item: Item, support: Support, told: Support) -> bool:
    """Whether what its words tell is what it is taken for, said in another way."""
    if told is Support.HUNG:
        # A bell that "hangs in its frame" hangs from above; a sword that hangs on pegs lies on them; a wardrobe that is
        # screwed to the wall stands and is held by it.
        how = told_by(item.displayed)
        fixed = support is Support.FASTENED and how.hanging is Hanging.FIXED
        return fixed or how.mount is Mount.RESTING or (support is Support.SUSPENDED and not _named_wall(item))
    # What hangs by its class and is bolted to the wall is held by that.
    return support is Support.HUNG and told is Support.FASTENED and item.hanging is Hanging.FIXED


def as_told(item: Item, row: ObjectClass) -> Item:
    """Return a record with the support that the rest of it tells, where it does not name one.

    What has a footing that was measured stands on it, whatever things of its class usually do, and so does what usually
    hangs where its record names furniture to stand on.  What has an isolator stands on that.  Chains and wires alone
    hold a chandelier from above, and a picture on a wall.

    Parameters
    ----------
    item : Item
        The record, with what house rules say of its support.
    row : ObjectClass
        Its class.
    """
    if row.support is Support.SUSPENDED and _of_no_wall(item):
        return replace(item, support=Support.SUSPENDED, hanging=None)
    if WHEN_HELD in row.models and item.support is Support.HUNG and told_by(item.displayed).mount is Mount.RESTING:
        # A sword on two pegs lies on them and may come off; nothing of it swings.
        on_wall = Furniture.WALL if item.furniture is None and not item.case and _named_wall(item) else item.furniture
        return replace(item, support=None, hanging=None, furniture=on_wall)
    if row.support is Support.FREESTANDING and WHEN_HELD not in row.models and item.support is Support.HUNG:
        if item.hanging is Hanging.FIXED and _stands_at_wall(item, row.name):
            # A wardrobe or a longcase clock that is screwed to the wall stands there, and is held by it.
            return replace(item, support=Support.FASTENED, hanging=None)
        if row.name in _FURNITURE and item.hanging is None and _large(item, DEEP, STANDS_FROM) and _named_wall(item):
            # What is "on the wall, bracketed" and as deep and as high as a wardrobe stands before it.
            return replace(item, support=Support.FREESTANDING)
        if item.hanging in (None, Hanging.WIRE) and _large(item, DEEP) and not _named_wall(item):
            # A bell, a bicycle or a drum that hangs, and of no wall is told, hangs from above.
            return replace(item, support=Support.SUSPENDED, hanging=None)
    if row.support is Support.HUNG and item.hanging is None and _held_by_wall(item):
        return replace(item, support=Support.HUNG, hanging=Hanging.FIXED)
    if WHEN_HELD in row.models and item.hanging is Hanging.FIXED and item.support is Support.HUNG:
        plan = [side for side in (item.width_m, item.depth_m) if side]
        bulky = _large(item, BULKY, TALL) and (item.height_m or 0.0) > max(plan)
        if bulky or stands_too(item.displayed):
            # A double bass or a suit of armour that is fixed to the wall stands on the floor.
            return replace(item, support=Support.FASTENED, hanging=None)
    if item.support is not None or item.hanging is not None:
        return item
    if item.isolator.strip():
        return replace(item, support=Support.ISOLATED)
    hangs = row.support in _ABOVE
    stands = _footing(item) or (hangs and (item.furniture in _TO_STAND_ON or _names_case(item)))
    usual = row.support is Support.FREESTANDING and WHEN_HELD not in row.models
    if not stands or (usual and not too_slender(item, row.name)):
        return item
    return replace(item, support=Support.FREESTANDING)


def _held_by_wall(item: Item) -> bool:
    """Whether a panel has struts to the wall, or a stele is dowelled to it: the wall holds it, and not its footing."""
    return (
        held_behind(item, Support.FASTENED)
        and item.support is Support.FASTENED
        and not (_footing(item) or _names_case(item))
    )


def _of_no_wall(item: Item) -> bool:
    """Whether the words for its display tell that a thing hangs, and neither how it hangs on a wall nor of any wall."""
    told = told_by(item.displayed)
    bare = (
        told.hanging in (None, Hanging.WIRE) and told.hanging is item.hanging and item.support in (None, told.support)
    )
    return told.support is Support.HUNG and bare and not _named_wall(item)


def _named_wall(item: Item) -> bool:
    return _WALL.search(f"{item.gallery} {item.displayed}") is not None


def _large(item: Item, depth: float, height: float = 0.0) -> bool:
    """Whether a thing that is told to hang is so deep, and so high, that it hardly hangs flat on a wall."""
    plan = [side for side in (item.width_m, item.depth_m) if side]
    return len(plan) > 1 and min(plan) >= depth and (item.height_m or 0.0) >= height and bool(item.displayed.strip())


def _stands_at_wall(item: Item, object_class: str) -> bool:
    """Whether what stands by its class, and is fixed to a wall, stands before it: it is thick, heavy, or tall."""
    if _large(item, THICK, STANDS_FROM) or longcase(item, object_class):
        return True
    height, plan = item.height_m or 0.0, [side for side in (item.width_m, item.depth_m) if side]
    if len(plan) > 1:
        upright = height >= max(HANGS_FROM, 0.5 * max(plan)) and min(plan) >= THICK
        return upright and (item.mass_kg or 0.0) >= HEAVY
    # Of its sides one is not recorded: a cupboard, or what is as wide as that, and not an oar.
    return height >= TALL and (
        object_class in _UPRIGHT or (not plan and (item.mass_kg or 0.0) >= HEAVY) or sum(plan) >= DEEP
    )


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
    # Miniatures that are pinned to the panel of a case are in it; what is recorded as fixed by its footing stands.
    pinned = item.support is Support.FASTENED and told_by(item.displayed).support is Support.FASTENED
    if not (item.support is None or pinned) or item.hanging is not None or _footing(item):
        return False
    if row.support is not Support.HUNG:
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


def longcase(item: Item, object_class: str) -> bool:
    """Say whether a thing of a class is a longcase clock, which stands though it is very slender."""
    return object_class == CLOCK and (item.height_m or 0.0) >= LONGCASE


def too_slender(item: Item, object_class: str) -> float:
    """Return how many times as high as deep a thing is that by that cannot stand by itself; else 0."""
    plan = [d for d in (item.base_width_m or item.width_m, item.base_depth_m or item.depth_m) if d]
    times = item.height_m / min(plan) if plan and item.height_m is not None else 0.0
    return times if times > (SLENDEREST_CLOCK if longcase(item, object_class) else SLENDEREST) else 0.0
