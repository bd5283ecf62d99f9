"""Inches and centimetres of the same thing: which converts which, whether they agree, which one is believed."""

from __future__ import annotations

from functools import cache

from pipeline.collection.dimensions.lexicon import LexiconUnit, units
from pipeline.collection.dimensions.quantities import DimensionQuantity, troy
from pipeline.collection.dimensions.result import DimensionNote
from pipeline.collection.record import plausible
from pipeline.quantities import figures

_CLOSE = {"length": 0.003, "mass": 0.003}
_SHARE = 0.03
_GUESSES = {"imperial": ("cm", "mm", "m"), "metric": ("in", "ft"), "": ("in", "cm", "ft", "mm", "m")}
_EPS = 1e-9


def agree(one: float, two: float, kind: str) -> bool:
    """Say whether two readings of one thing differ by no more than 3 mm (3 g) or no more than 3 % of the larger.

    Parameters
    ----------
    one, two : float
        In m or kg.
    kind : {"length", "mass"}
        What they are.

    Returns
    -------
    bool
        Whether they may be one.
    """
    gap = abs(one - two)
    return gap <= _CLOSE[kind] + _EPS or gap <= _SHARE * max(one, two)


def is_in_inches(bare: DimensionQuantity, other: DimensionQuantity) -> bool:
    """Say whether a number without a unit is what another length is in inches."""
    inch = units()["in"]
    return other.kind == "length" and _near(bare.num * inch.num / (bare.den * inch.den), other.si())


def _near(one: float, two: float) -> bool:
    """Say whether two numbers differ by no more than 3 %: a slip is only seen where 3 mm do not hide everything."""
    return abs(one - two) <= _SHARE * max(one, two)


def pair(
    open_: list[DimensionQuantity], others: list[DimensionQuantity], notes: list[DimensionNote]
) -> list[DimensionQuantity]:
    """Set each number beside its conversion.

    Parameters
    ----------
    open_ : list of Quantity
        Numbers that have no conversion yet, in the order of the text; they get one.
    others : list of Quantity
        The numbers in brackets behind them.
    notes : list of Note
        What a reader should know is appended.

    Returns
    -------
    list of Quantity
        Those of `others` that convert nothing and stand for themselves.
    """
    if any(q.unit is None for q in open_) or any(q.unit is None for q in others):
        _infer(open_, others, notes)
    left: list[DimensionQuantity] = []
    for kind in ("length", "mass"):
        theirs = [q for q in others if q.kind == kind]
        if theirs:
            left += _pair([q for q in open_ if q.kind == kind], theirs, kind, notes)
    for b in others:
        if b.unit is None:
            notes.append(DimensionNote("missing_unit", "a conversion without a unit; left out", b.start, b.end))
    strange = [q for q in left if not any(q.kind == ours.kind for ours in open_)]
    if strange and open_:
        what = " and ".join(sorted({"a mass" if q.kind == "mass" else "a length" for q in strange}))
        message = f"{what} in brackets is no conversion of what stands before it; kept as it is"
        place = len(others) == len(open_) > 1
        notes.append(
            DimensionNote("contradiction" if place else "ambiguous", message, strange[0].start, strange[-1].end)
        )
    return left


def _pair(
    ours: list[DimensionQuantity], theirs: list[DimensionQuantity], kind: str, notes: list[DimensionNote]
) -> list[DimensionQuantity]:
    """Pair numbers of one kind; return those that only the brackets give."""
    if not ours:
        for b in theirs:
            b.run = -1  # not joined to what stands before it
        return theirs
    matches = _matches(ours, theirs, kind)
    for a, b in matches:
        a.other = b
        a.dimension = a.dimension or b.dimension
        if a.unit is not None and a.unit.name == "oz":
            ounce = units()["oz t"]
            if abs(a.num * ounce.num / (a.den * ounce.den) - b.si()) < abs(a.si() - b.si()):
                troy(a, notes)
    against = [(a, b) for a, b in matches if not agree(a.si(), b.si(), kind)]
    if against and not _swapped(matches, notes):
        for a, b in against:
            _judge(a, b, notes)
    left = []
    for b in theirs:
        if any(b is other for _, other in matches):
            continue
        if len(matches) == len(ours) and b.start > matches[-1][1].start:
            b.run = ours[-1].run
            left.append(b)
            notes.append(DimensionNote("conversion", "stands only in the conversion; kept", b.start, b.end))
        else:
            notes.append(
                DimensionNote("conversion", "converts none of the numbers before it; left out", b.start, b.end)
            )
    return left


def _matches(
    ours: list[DimensionQuantity], theirs: list[DimensionQuantity], kind: str
) -> list[tuple[DimensionQuantity, DimensionQuantity]]:
    if len(ours) == len(theirs):
        return list(zip(ours, theirs, strict=True))
    out, at = [], 0
    for b in theirs:
        for index in range(at, len(ours)):
            if agree(ours[index].si(), b.si(), kind):
                out.append((ours[index], b))
                at = index + 1
                break
    return out


def _infer(open_: list[DimensionQuantity], others: list[DimensionQuantity], notes: list[DimensionNote]) -> None:
    """Give numbers without a unit the one with which at least half of them agree with their partners, if any."""
    for bare, known in ((open_, others), (others, open_)):
        lengths = [q for q in known if q.kind == "length"]
        unknown = [q for q in bare if q.unit is None]
        if not unknown or len(bare) > len(lengths) or len(lengths) != len(known):
            continue
        system = lengths[0].unit.system if lengths[0].unit else ""
        partner = {id(a): b for a, b in zip(bare, lengths, strict=False)}
        for name in _GUESSES[system] + _GUESSES[""]:
            unit = units()[name]
            near = [q for q in unknown if agree(q.num * unit.num / (q.den * unit.den), partner[id(q)].si(), "length")]
            if 2 * len(near) >= len(unknown):  # one of them may have a slip of its own, which its note then tells
                for q in unknown:
                    q.unit = unit
                message = f"no unit is written; {name} agrees with the number beside it"
                notes.append(DimensionNote("unit", message, unknown[0].start, unknown[-1].end))
                break


def _judge(a: DimensionQuantity, b: DimensionQuantity, notes: list[DimensionNote]) -> None:
    """Two readings contradict each other: find the likely slip, believe one, and say why."""
    si, kind = b.si(), a.kind
    sign = "m" if kind == "length" else "kg"
    shown = f"{figures(a.si(), 4)} {sign} against {figures(si, 4)} {sign}"
    reason = ""
    glued = _unglued(a, si)
    if kind == "length" and not a.written and a.unit is not None:
        for name in ("in", "ft", "cm", "mm", "m"):
            unit = units()[name]
            if _near(a.num * unit.num / (a.den * unit.den), si):
                message = f"no unit is written here; {name} and not {a.unit.name} agrees with the number in brackets"
                a.unit = unit
                notes.append(DimensionNote("unit", message, a.start, a.end))
                return
    if glued:
        a.repaired = glued
        reason = "read with the blank that is missing before its fraction, which agrees with the other"
    elif (
        kind == "length" and " " not in a.unit_text and any(_near(a.si() * factor, si) for factor in (12.0, 1.0 / 12.0))
    ):
        a.repaired = _exact(b)
        reason = "the marks of feet and inches are confused; the other reading is believed"
    elif any(u.name != _name(b) and _near(b.num * u.num / (b.den * u.den), a.si()) for u in _of(kind)):
        reason = "the second has the wrong unit; the first is believed"
    elif any(_near(si * factor, a.si()) for factor in (0.01, 0.1, 10.0, 100.0)):
        reason = "the second has its decimal mark in the wrong place; the first is believed"
    elif kind == "length" and not _plausible(a.si()) and _plausible(si):
        a.repaired = _exact(b)
        reason = "the first is no museum object's size; the second is believed"
    else:
        reason = "the first is believed, as the one that was measured; the second is usually its conversion"
    notes.append(DimensionNote("contradiction", f"{shown}: {reason}", a.start, b.end))


def _swapped(matches: list[tuple[DimensionQuantity, DimensionQuantity]], notes: list[DimensionNote]) -> bool:
    """Say whether the numbers agree with each other's conversions: one of the two readings is in another order."""
    ours, theirs = sorted(a.si() for a, _ in matches), sorted(b.si() for _, b in matches)
    kind = matches[0][0].kind
    if len(matches) < 2 or not all(agree(one, two, kind) for one, two in zip(ours, theirs, strict=True)):
        return False
    message = "the same numbers in another order: the order of the first is believed"
    notes.append(DimensionNote("contradiction", message, matches[0][0].start, matches[-1][1].end))
    return True


def _unglued(a: DimensionQuantity, si: float) -> tuple[int, int] | None:
    """Return 881/2 read as 88 1/2, in SI, where that agrees with the other reading."""
    above, slash, below = a.word.partition("/")
    if not (slash and above.isdigit() and below.isdigit() and a.unit):
        return None
    for cut in (1, 2):
        if len(above) > cut:
            num = int(above[:-cut]) * int(below) + int(above[-cut:])
            if _near(a.scaled(num, int(below)), si):
                return num * a.unit.num, int(below) * a.unit.den
    return None


def _exact(b: DimensionQuantity) -> tuple[int, int]:
    if b.unit is None:
        raise ValueError("a quantity without a unit has no value")
    return b.num * b.unit.num, b.den * b.unit.den


def _name(b: DimensionQuantity) -> str:
    return b.unit.name if b.unit else ""


def _of(kind: str) -> list[LexiconUnit]:
    # Nobody writes decimetres by mistake: what agrees in them has its decimal mark in the wrong place.
    return [unit for unit in units().values() if unit.kind == kind and unit.name != "dm"]


@cache
def _limits() -> tuple[float, float]:
    row = plausible()["height_m"]
    return row.low, row.high


def _plausible(si: float) -> bool:
    low, high = _limits()
    return low <= si <= high
