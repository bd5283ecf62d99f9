"""Names of parts that are not the object: what is said of them is theirs alone."""

from __future__ import annotations

FRAMED = frozenset({"framed", "frame"})
DETAILS = frozenset(
    {
        "rim",
        "seat",
        "lid",
        "top",
        "mouth",
        "handle",
        "stem",
        "neck",
        "cord",
        "label",
        "crate",
        "storage",
        "opening",
        "bore",
    }
)
BASES = frozenset({"base", "foot", "feet", "plinth", "pedestal", "bottom"})
ROUND = frozenset({"foot", "rim", "mouth", "neck", "opening"})
MOUTHS = frozenset({"rim", "mouth"})
_HOLLOW, _BORE = "inside", "bore"
_SENTENCE = 6
"""Words beyond which what stands before numbers is no name: "net dimensions exclude lid, stand and mouldings"."""
_WHOLE = ("with ", "without ")


def is_base(name: str) -> bool:
    """Say whether a name is that of a base or foot, and not of an object with or without one."""
    words = name.partition(" without ")[0].split()  # "part without base" is the thing, and no base
    return not name.startswith(_WHOLE) and bool(BASES.intersection(words))


def is_opening(name: str) -> bool:
    """Say whether a name is that of a foot, rim or mouth: of a height and a diameter only the diameter is theirs."""
    return not name.startswith(_WHOLE) and bool(ROUND.intersection(name.split()))


def is_bore(name: str) -> bool:
    """Say whether a name is that of a gun's bore, however much is said before it."""
    return name.split()[-1:] == [_BORE]


def is_detail(name: str) -> bool:
    """Say whether a name is that of a part whose size is not the object's."""
    words = name.split()
    if is_bore(name):
        return True
    if len(words) > _SENTENCE or "without" in words:  # "net dimensions, without lid" are no lid's
        return False
    return not name.startswith(_WHOLE) and (name == _HOLLOW or bool(DETAILS.intersection(words)))
