"""Ways in which a work on a wall may hang, and the numbers that its models need of them.

How it hangs is recorded, or shown by a cord that is longer than the work; otherwise it is one of the ways that are
usual for its class and size (tables/usual_hangings.csv), all of which are looked at: a verdict on which they differ is
open. Each way has its strength, the depth of its hooks and how far above the centre of gravity they are
(tables/hangings.csv).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import sqrt

from pipeline.records import Estimate, Hanging, Item, Origin
from pipeline.records import phrases as say
from pipeline.records.phrase import Clause
from pipeline.tables.hanging_rows import UsualHanging, hanging_rows, usual_hangings

ANY = "*"
"""In the column object_class of usual_hangings.csv: of every class that no other row names."""

OFFSET = (0.3, 0.5, 0.7)
"""Centre of gravity of a framed work in front of its back, as a share of its depth, by judgement: low, best, high."""

THIN = (0.01, 0.02, 0.05)
"""The same in m where its depth is not recorded."""

REBOUND = (0.1, 0.3, 0.6)
"""Share of its speed that a frame keeps from a blow on wall or hook, by judgement."""


OF_HANGING = frozenset(
    {"freedom", "length", "hooks_open", "hook_depth", "hook_height", "hook_offset", "gyration", "restitution"}
    | {"hanger_strength", "amplification"}
)
"""Parameters of a scene that follow from how it hangs."""


@dataclass(frozen=True)
class HangingGuess:
    """Ways in which a work may hang, the likeliest first.

    Attributes
    ----------
    ways : tuple of Hanging
        One where it is known.
    origin : Origin
        Of that knowledge.
    note, source : str
        In words, and who says so.
    """

    ways: tuple[Hanging, ...]
    origin: Origin
    note: str
    source: str = ""

    @property
    def known(self) -> Hanging | None:
        """How it hangs; None where it is one of several ways."""
        return self.ways[0] if len(self.ways) == 1 else None


def titled(ways: Sequence[Hanging]) -> str:
    """Return ways to hang in words: "two hooks or D-rings, or security hardware"."""
    titles = [hanging_rows()[way].title for way in ways]
    return titles[0] if len(titles) == 1 else f"{', '.join(titles[:-1])}, or {titles[-1]}"


@cache
def _usual(object_class: str, size: float) -> UsualHanging:
    mine = [row for row in usual_hangings() if row.object_class == object_class]
    others = [row for row in usual_hangings() if row.object_class == ANY]
    return max((row for row in mine or others if size >= row.larger_than), key=lambda row: row.larger_than)


def hanging_of(item: Item, object_class: str, told: Hanging | None = None, by: str = "") -> HangingGuess:
    """Return how a work on a wall hangs.

    Parameters
    ----------
    item : Item
        Its record.
    object_class : str
        Row of classes.csv.
    told : Hanging, optional
        How it hangs by its record or else by a house rule, where either says it.
    by : str
        That rule in words; "" for the record.

    Returns
    -------
    HangingGuess
        One way where it is recorded or its cord shows it, else those that are usual.
    """
    told = told or item.hanging
    if told is not None:
        origin = Origin.STATED if by else Origin.MEASURED
        return HangingGuess((told,), origin, f"{say.HANGING(ways=titled((told,)))}, {by or 'as recorded'}")
    if item.suspension_length_m is not None and item.suspension_length_m > 0.5 * (item.height_m or 0.0):
        return HangingGuess((Hanging.WIRE,), Origin.DERIVED, say.HANGING_BY_CORD())
    usual = _usual(object_class, max(item.height_m or 0.0, item.width_m or 0.0))
    note = f"{say.HANGING(ways=titled(usual.hangings))}; {say.HANGING_NOT_RECORDED()}"
    return HangingGuess(usual.hangings, Origin.ASSUMED, note, f"usual_hangings.csv ({usual.source})")


def swings(guess: HangingGuess) -> bool:
    """Say whether a work may swing in the plane of its wall."""
    return any(hanging_rows()[way].swings for way in guess.ways)


def _flag(guess: HangingGuess, column: str) -> Estimate:
    each = [float(getattr(hanging_rows()[way], column)) for way in guess.ways]
    return Estimate(each[0], "-", guess.origin, min(each), max(each), guess.note, guess.source)


def _of_table(ways: Sequence[Hanging], column: str, unit: str, times: float, phrase: Clause) -> Estimate:
    spans = [hanging_rows()[way].range(column) for way in ways]
    low, best, high = (
        times * value for value in (min(s.low for s in spans), spans[0].value, max(s.high for s in spans))
    )
    note = phrase(span=(low, best, high), ways=titled(ways))
    return Estimate(best, unit, Origin.ASSUMED, low, high, note, f"hangings.csv ({spans[0].source})")


def hanging_estimates(item: Item, guess: HangingGuess) -> dict[str, Estimate]:
    """Return what the models of a work on a wall need to know of how it hangs.

    Parameters
    ----------
    item : Item
        Its record.
    guess : HangingGuess
        How it hangs, or may.

    Returns
    -------
    dict of str to Estimate
        ``freedom`` where it may swing; ``hooks_open``, ``hook_depth`` and the body above its hooks where it may be
        lifted off and its height is known; ``hanger_strength`` and ``amplification``.
    """
    out: dict[str, Estimate] = {}
    if swings(guess):
        out["freedom"] = _flag(guess, "swings")
    lifted = [way for way in guess.ways if hanging_rows()[way].lifts_off]
    if lifted and item.height_m is not None:
        out["hooks_open"] = _flag(guess, "lifts_off")
        out["hook_depth"] = _of_table(lifted, "hook_depth", "m", 1.0, say.HOOK_DEPTH)
        out["hook_height"] = _of_table(lifted, "hook_height", "m", item.height_m, say.HOOK_HEIGHT)
        out |= _plate(item, item.height_m)
    out["hanger_strength"] = _of_table(guess.ways, "strength", "-", 1.0, say.HANGERS_BEAR)
    out["amplification"] = _of_table(guess.ways, "amplification", "-", 1.0, say.SWING_AND_SLAP)
    return out


def _plate(item: Item, height: float) -> dict[str, Estimate]:
    """Return the body of a framed work as its hooks have it: a plate of even thickness."""
    depth = item.depth_m
    low, best, high = THIN if depth is None else (share * depth for share in OFFSET)
    offset = (low, best, high)
    note = say.OFFSET(offset=offset) if depth is None else say.OFFSET_BY_DEPTH(offset=offset, depth=depth)
    gyration = sqrt((height**2 + (depth or 0.0) ** 2) / 12.0)
    least, rebound, most = REBOUND
    kept = say.REBOUND(rebound=REBOUND)
    return {
        "hook_offset": Estimate(best, "m", Origin.ASSUMED, low, high, note, "judgement"),
        "gyration": Estimate(gyration, "m", Origin.DERIVED, gyration, gyration, say.GYRATION_OF_PLATE()),
        "restitution": Estimate(rebound, "-", Origin.ASSUMED, least, most, kept, "judgement"),
    }
