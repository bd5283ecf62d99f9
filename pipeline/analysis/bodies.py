"""What is known of the shape of a thing besides its class: a post, a folding screen, a block of one stone, a pair."""

import re
from collections.abc import Callable
from dataclasses import replace

from pipeline.analysis.mounts import MountGuess
from pipeline.records import Estimate, Furniture, Item, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed import READ
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.body_rows import HELD, ON_EDGE, PAIR, SCREEN, STACK, STANDS, BodyRow, body_of
from pipeline.tables.rows import any_of

SOFT = ("inflated", "feathers", "foam", "cork", "basketry", "taxidermy")
"""Materials of which rocking harms nothing: judgement."""


_FOLDED = (0.2, 0.1, 0.4)
"""Depth over height of a folding screen as it stands: leaves of 0.4 of its height, folded by 15 to 75 degrees."""

_FOOT = (0.25, 0.12, 0.4)
"""The same of a stand that bears a flat thing, such as a shield: as deep as keeps it upright (judgement)."""

LEAF, FLAT = 0.05, 0.2
"""Depth over height below which the recorded depth of a folding screen is that of one leaf, and that of a thing on a
stand is its own and not that of the stand: judgement."""


_STACKED = any_of([
    *("stacked", "in stacks", "in a stack", "piled", "in a pile", "one on top of *other", "one on top of another"),
    *("one upon *other", "one above the other on top", "on top of each other", "gestapelt", "aufeinander", "im Stapel"),
    *("empilé", "empilés", "empilée", "empilées", "superposés", "superposées", "les uns sur les autres", "en pile"),
    *("impilati", "impilate", "sovrapposti", "sovrapposte", "uno sopra l'altro", "una sopra l'altra", "apilados"),
    *("apiladas", "superpuestos", "superpuestas", "uno sobre otro", "una sobre otra", "empilhados", "empilhadas"),
    *("gestapeld", "op elkaar", "staplade", "ustawione jeden na drugim", "στοιβαγμένα", "το ένα πάνω στο άλλο"),
    *("積み重ね", "重ねて", "叠放", "疊放", "쌓아"),
])  # fmt: skip
"""What says of a display that its things stand on each other."""

_PIECES = any_of([
    *("chess set", "chess sets", "chessmen", "chess pieces", "Schachspiel", "Schachfiguren", "jeu d'échecs", "scacchi"),
    *("juego de ajedrez", "tea service", "tea set", "coffee service", "coffee set", "dinner service", "dinner set"),
    *("dessert service", "breakfast service", "toilet service", "dressing table set", "cruet set", "Teeservice"),
    *("Kaffeeservice", "Tafelservice", "Speiseservice", "service à thé", "service à café", "service de table"),
    *("servizio da tè", "servizio da caffè", "servizio da tavola", "servicio de té", "juego de té", "juego de café"),
    *("vajilla", "serviço de chá", "serviço de jantar", "theeservies", "koffieservies", "eetservies", "serwis do kawy"),
    *("nativity set", "nativity scene", "presepe", "Weihnachtskrippe", "crèche de Noël", "toy soldiers"),
    *("Zinnsoldaten", "σερβίτσιο", "чайный сервиз", "茶器セット", "チェスセット"),
])  # fmt: skip
"""What names many pieces that stand beside each other."""

_ONE_BEHIND = re.compile(r"\s*:|\s*\(\s*[^\W\d_A-Z]")
_ONE_BEFORE = re.compile(
    r"\b(?:from|of|part|piece|aus|von|d'un|d'une|da un|di un|de un|de una)\b[\w\s]{0,20}$", re.IGNORECASE
)
"""What stands behind or before the name of a set in that of a piece: "Tea service: plate", "bowl from a tea set"."""


def _many(text: str) -> bool:
    found = _PIECES.search(text)
    return found is not None and not (_ONE_BEHIND.match(text, found.end()) or _ONE_BEFORE.search(text[: found.start()]))


def of_pieces(item: Item, shape: BodyRow | None, support: Support, mount: MountGuess | None) -> str:
    """Return what is said of things that are several and are followed as one, of what stands; "" of others.

    Parameters
    ----------
    item : Item
        Its record.
    shape : BodyRow or None
        What is known of its shape.
    support, mount : Support, MountGuess or None
        How it is held.
    """
    if shape is not None and shape.body in _AS_ONE:
        return _AS_ONE[shape.body]()
    if support is not Support.FREESTANDING or (mount is not None and not mount.stands):
        return ""
    if _STACKED.search(item.displayed):
        return say.STACKED()
    called = (item.object_name[:READ], item.title[:READ])
    of_one = any(_PIECES.search(text) and not _many(text) for text in called)
    return say.PIECES() if not of_one and any(map(_many, called)) else ""


_AS_ONE = {PAIR: say.TWO_BODIES, STACK: say.STACKED}
"""What is said of bodies that are several and are followed as one."""


def stands_deep(shape: BodyRow) -> Callable[[float], Estimate] | None:
    """Return what says how deep a body of some height stands [m], where its depth is not that; None of others."""
    said = {SCREEN: (_FOLDED, say.SCREEN_FOLDED), **dict.fromkeys(STANDS, (_FOOT, say.STAND_FOOT))}.get(shape.body)
    if said is None:
        return None
    shares, phrase = said

    def deep(height: float) -> Estimate:
        best, low, high = (share * height for share in shares)
        return Estimate.assumed(best, low, high, "m", phrase(share=shares), "judgement")

    return deep


def as_it_stands(item: Item, shape: BodyRow | None) -> Item:
    """Return a record without a depth that is no footing: of one leaf of a folding screen, of a shield on its stand.

    Parameters
    ----------
    item : Item
        The record.
    shape : BodyRow or None
        What is known of its shape.
    """
    if shape is None or (shape.body != SCREEN and shape.body not in STANDS):
        return item
    thin = (item.depth_m or 0.0) < (LEAF if shape.body == SCREEN else FLAT) * (item.height_m or 0.0)
    return replace(item, depth_m=None) if thin and (shape.body == SCREEN or item.depth_m) else item


def on_floor(item: Item, shape: BodyRow | None) -> Item:
    """Return a record as it is, and of two bodies with both on the floor: the lower one is no furniture.

    Parameters
    ----------
    item : Item
        The record.
    shape : BodyRow or None
        What is known of its shape.
    """
    if shape is None or shape.body != PAIR or item.furniture not in (None, Furniture.PEDESTAL):
        return item
    return replace(item, furniture=Furniture.FLOOR, furniture_anchorage=None)


def body(
    item: Item, row: ObjectClass, words: str, support: Support, mount: MountGuess | None, material: Material
) -> BodyRow | None:
    """Return what is known of the shape of a thing besides its class.

    Parameters
    ----------
    item : Item
        Its record.
    row : ObjectClass
        Its class.
    words : str
        Why it is of that, beginning with the rule.
    support, mount : Support, MountGuess or None
        How it is held.
    material : Material
        What it is made of.

    Returns
    -------
    BodyRow or None
        None for what a museum's own row says, and for what does not stand, unless it weighs alike however it is held.
    """
    hangs = support in (Support.HUNG, Support.SUSPENDED)
    stands = support in (Support.FREESTANDING, Support.FASTENED)
    if row.own or not (hangs or stands):
        return None
    text = f"{item.object_name[:READ]} {item.title[:READ]}"
    found = body_of(text, words.partition(":")[0], row.name, material.name, item.height_m or 0.0)
    if (hangs or (mount is not None and not mount.stands)) and (found is None or found.body not in HELD):
        return None
    # How thick a frame is says nothing of what an altarpiece stands on.
    return None if found is not None and found.body in ON_EDGE and item.depth_m is None else found
