"""Choice among a text's numbers: the object's own extents, its base and its mass (`choose`)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import hypot, pi

from pipeline.collection.dimensions.parts import DETAILS, FRAMED, MOUTHS, is_base, is_bore, is_detail
from pipeline.collection.dimensions.result import Choice, Chosen, DimensionPart, Dimensions
from pipeline.quantities import figures

USUAL = ("height", "width", "depth")
"""The order of numbers that nothing labels, where their source writes no other."""

_FACES = {"mount": 4, "mat": 4, "sheet": 5, "page": 5, "image": 6, "composition": 6, "plate": 6, "block": 6}
HANGS = "framed, as it hangs"
"""How the reason ends of what is said of a frame that counts."""
_RAISING = frozenset({"stand", "cover", "finial", "plinth", "pedestal", "halo", "crown"})
"""What a thing stands with: "H. 45 cm, with cover 53 cm"."""
_LAST = 9
_LABELLED = frozenset({"height", "width", "depth", "diameter", "length", "thickness", "weight"})
_SAME_HEIGHT = 0.1
"""Difference of two heights up to which both are the thing's, with and without a finial or a foot."""
_OPEN = 1.0
"""Diameter of a mouth over the height from which a vessel is a bowl, and its mouth the widest of it."""
_IN_PLAN = "beside a height with a label, and so in plan"
"""How the reason ends of what is said of two bare numbers: "H. 180 cm, 60 x 50 cm"."""
_FLAT = 0.5
"""First number of a base over its second from which both lie in plan; below it the first is the base's own height."""


def choose(dimensions: Dimensions, *, hung: bool = False) -> Chosen:
    """Choose the object's extents and mass among a text's parts.

    The whole object goes before its parts: "with base", then "overall" and what no part is named for, then framed,
    other named parts, mount, sheet, image.  Of several alike the largest is taken, never the height of one with the
    width of another, but where a height stands alone beside nearly the same one with its sides.  What is said of a base
    or foot is the base's.

    Parameters
    ----------
    dimensions : Dimensions
        What was read of the text.
    hung : bool
        The object hangs on a wall, so that its frame comes first.

    Returns
    -------
    Chosen
        Extents in m, mass in kg, each with the characters it came from and the reason; ranges by their larger end.
    """
    groups: dict[int, list[DimensionPart]] = {}
    for part in dimensions.parts:
        if part.value is not None and part.value > 0.0:
            groups.setdefault(part.group, []).append(part)
    groups = _oval({at: _in_plan(group) for at, group in groups.items()})
    bodies = [g for g in groups.values() if not is_base(g[0].name) and any(p.dimension != "weight" for p in g)]
    out: dict[str, Choice] = {}
    chosen: list[DimensionPart] = []
    best = min((_rank(g, hung) for g in bodies), default=_LAST)
    alike = [g for g in bodies if _rank(g, hung) == best < _LAST]
    if alike and not _is_lost(dimensions, alike):
        chosen = _upright_and_round(alike) or max(_telling(alike), key=_size)
        if dimensions.having("round"):
            chosen = [replace(part, dimension="diameter") if part.dimension == "depth" else part for part in chosen]
        out = _extents(chosen, _reason(chosen, len(alike), hung and best == 0))
        if chosen[0].name.startswith("with ") and len(out) == 1:  # "height with base" beside width and depth without
            own = [
                g
                for g in bodies
                if g[0].name.startswith(("overall", "without ")) and all(p.dimension in _LABELLED for p in g)
            ]
            out = _extents(max(own, key=_size), "of the object itself") | out if own else out
        elif len(out) == 1 and "height" in out:
            # A height alone, and the same thing with all its sides: "H.: 31.5 cm; 30.5 x 28.9 x 14.3 cm".
            whole = [g for g in alike if g[0].name == chosen[0].name and _has_height(g, out["height"].value)]
            sides = max((_extents(g, _reason(g, 1, False)) for g in whole), key=len, default=out)
            out = sides | out
            pairs = [g for g in alike if len(g) == 2 and g[0].name == chosen[0].name and all(p.assumed for p in g)]
            if len(out) == 1 and len(pairs) == 1:
                out = _extents(_in_plan([*chosen, *pairs[0]]), _IN_PLAN) | out
    if "height" not in out:
        # A figure's height beside the width over its knees, each a group of its own.
        figures = [
            one for g in bodies if g[0].name == "figure" and "height" in (one := _extents(g, _reason(g, 1, False)))
        ]
        out |= {"height": max((one["height"] for one in figures), key=lambda one: one.value)} if figures else {}
    if "height" in out and not {"width", "depth", "diameter"} & out.keys():
        out |= _open_mouth(groups.values(), out["height"].value)
    bases = [g for g in groups.values() if is_base(g[0].name)]
    if bases:
        out |= _base(max(bases, key=_size))
        out = _at_its_feet(bases, out) | out
    mass = _mass(dimensions, chosen)
    if mass is not None:
        out["mass"] = mass
    return Chosen(**out)


def _has_height(group: list[DimensionPart], height: float) -> bool:
    """Whether a group says nearly the same height, and other sides beside it."""
    said = next((p.value for p in group if p.dimension == "height" and p.value), None)
    return said is not None and len(group) > 1 and abs(said / height - 1.0) <= _SAME_HEIGHT


def _oval(groups: dict[int, list[DimensionPart]]) -> dict[int, list[DimensionPart]]:
    """Return groups in which what is taken for a height behind a diameter is not, where another one has a label.

    "H. 6.7 cm, diam. of mouth 23 x 16.4 cm": the mouth is oval, and beside it a depth is that of the inside.
    """
    upright = next((at for at, g in groups.items() if any(p.dimension == "height" and not p.assumed for p in g)), None)
    if upright is None:
        return groups
    out = dict(groups)
    for at, group in groups.items():
        said = [(part.dimension, part.assumed) for part in group]
        if at != upright and said == [("diameter", False), ("height", True)] and not is_base(group[0].name):
            sides = [
                replace(part, dimension=side, assumed=False)
                for part, side in zip(group, ("width", "depth"), strict=True)
            ]
            own = [part for part in out[upright] if part.dimension not in ("width", "depth", "diameter")]
            out[upright] = [*own, *sides]
            del out[at]
    return out


def _in_plan(group: list[DimensionPart]) -> list[DimensionPart]:
    """Return a group in which two bare numbers beside a labelled height lie in plan: "60 x 50 cm, H. 180 cm"."""
    bare = [p for p in group if p.assumed]
    labelled = {p.dimension: p.value for p in group if not p.assumed and p.dimension in _LABELLED - {"weight"}}
    high = labelled.get("height")
    if len(bare) != 2 or set(labelled) != {"height"} or not high or _has_height(bare, high):
        return group
    turned = {id(part): side for part, side in zip(bare, ("width", "depth"), strict=True)}
    return [replace(p, dimension=turned[id(p)], assumed=False) if id(p) in turned else p for p in group]


def _telling(alike: list[list[DimensionPart]]) -> list[list[DimensionPart]]:
    """Return the groups that say a height, if they are not far smaller than others; else those that say most."""
    largest = max(map(_size, alike))
    upright = [
        g for g in alike if any(p.dimension == "height" and not p.assumed for p in g) and 2.0 * _size(g) >= largest
    ]
    if upright:
        return upright
    said = [{p.dimension for p in g} - {"unlabelled", "weight"} for g in alike]
    if any(said):
        # "Sword: overall length 98 cm, case: 103 cm": a bare number of a named part says less than a labelled one.
        kept = [(g, one) for g, one in zip(alike, said, strict=True) if one or len(g) > 1 or not g[0].words]
        alike, said = [g for g, _ in kept], [one for _, one in kept]
    if not any("height" in one or len(one) > 1 for one in said):
        return alike
    return [g for g, one in zip(alike, said, strict=True) if one]


def _upright_and_round(alike: list[list[DimensionPart]]) -> list[DimensionPart]:
    """Return height and diameter of "Diameter: 20 cm; Overall: 9 cm", where each is a group of one number; else none.

    One number "overall" beside a diameter is the other extent of the same thing.
    """
    if len(alike) != 2 or any(len(group) != 1 for group in alike):
        return []
    tall, wide = sorted((group[0] for group in alike), key=lambda part: part.dimension == "diameter")
    if (tall.dimension, wide.dimension, tall.name, wide.name) != ("unlabelled", "diameter", "overall", "overall"):
        return []
    return [replace(tall, dimension="height"), wide] if tall.words else []


def _is_lost(dimensions: Dimensions, alike: list[list[DimensionPart]]) -> bool:
    """Whether the size of the object itself stands there without a unit: then a number of a part is none."""
    if any(part.dimension != "unlabelled" or part.name == "overall" for group in alike for part in group):
        return False
    own = [p for p in dimensions.parts if p.name == "overall" and not p.words and p.dimension != "weight"]
    return bool(own) and all(p.value is None for p in own)


def _rank(group: list[DimensionPart], hung: bool) -> int:
    """Return the place of a group in the order of preference, 0 first."""
    name = group[0].name
    words = name.replace("/", " ").split()  # "image/plate" is an image, and no word that nobody knows
    if "sight" in group[0].qualifiers:
        return 6
    if FRAMED.intersection(words) and "without" not in words:  # "Teil (ohne Rahmen)" is no frame
        return 0 if hung else 3
    if name == "net":  # what is left of it without lid, stand or mouldings
        return 5
    if name == "with base" or (name.startswith("with ") and (DETAILS | _RAISING).intersection(words)):
        return 1
    if is_detail(name):
        return _LAST
    if name.startswith("overall"):
        return 2
    if name.startswith("without "):
        return 4
    faces = [_FACES[word] for word in words if word in _FACES]
    return min(faces) if faces else 3


def _size(group: list[DimensionPart]) -> float:
    return hypot(*(p.value for p in group if p.value is not None and p.dimension != "weight"))


def _reason(group: list[DimensionPart], alike: int, framed: bool) -> str:
    part = group[0]
    if framed:
        return HANGS
    what = f"of {part.words!r}" if part.words else "of the object itself"
    if alike > 1:
        what += f", the largest of {alike} alike"
    return what


def _extents(group: list[DimensionPart], reason: str) -> dict[str, Choice]:
    out: dict[str, Choice] = {}

    def take(field: str, part: DimensionPart, how: str, factor: float = 1.0) -> None:
        if field not in out and part.value is not None:
            said = ", as" if part.qualifiers else ""
            if part.low is not None and part.low != part.value:
                how += f", the larger end of {figures(part.low, 4)} to {figures(part.value, 4)} m"
            why = f"{how}, {reason}{said} {', '.join(part.qualifiers)}".rstrip()
            out[field] = Choice(part.value * factor, part.start, part.end, why)

    widest = [p for p in group if p.dimension == "diameter"]
    if len(widest) > 1:
        take("diameter", max(widest, key=lambda p: p.value or 0.0), f"diameter, the largest of {len(widest)}")
    for side in ("height", "length"):
        same = [p for p in group if p.dimension == side and not p.assumed]
        if len(same) > 1:  # "L 35 cm (body), L 59 cm (overall)"
            all_of_it = max(same, key=lambda p: p.value or 0.0)
            group = [one for one in group if one not in same or one is all_of_it]
    assumed = tuple(part.dimension for part in group if part.assumed)
    usual = "length" not in assumed and (len(assumed) < len(USUAL) or assumed == USUAL)
    by = f", by the order {' x '.join(USUAL if usual else assumed)}"
    for part in group:
        if part.dimension in ("height", "width", "depth", "diameter"):
            take(part.dimension, part, f"{part.dimension}{by * part.assumed}")
    for part in group:
        if part.dimension == "length":
            take("depth" if "width" in out else "width", part, f"length, which lies in plan{by * part.assumed}")
        elif part.dimension == "thickness" and not {"height", "diameter"} <= set(out):  # of a round wall
            take("depth", part, "thickness")
        elif part.dimension == "circumference":
            take("diameter", part, "circumference divided by pi", 1.0 / pi)
    if not out or set(out) == {"diameter"}:
        bare = [p for p in group if p.dimension == "unlabelled" and (not out or p.start < out["diameter"].start)]
        largest = max(bare, key=lambda p: p.value or 0.0, default=None)
        if largest is not None:
            take("height", largest, "a number without a label, taken as the height")
    return out


def _open_mouth(groups: Iterable[list[DimensionPart]], height: float) -> dict[str, Choice]:
    """Return the diameter of a mouth as that of a bowl, which is widest there; none of what is higher than wide."""
    mouths = [p for g in groups if MOUTHS.intersection(g[0].name.split()) for p in g if p.dimension == "diameter"]
    wide = [p for p in mouths if p.value is not None and p.value >= _OPEN * height]
    if not wide:
        return {}
    part = max(wide, key=lambda p: p.value or 0.0)
    return {
        "diameter": Choice(part.value or 0.0, part.start, part.end, "diameter of its mouth, where a bowl is widest")
    }


def _at_its_feet(bases: Iterable[list[DimensionPart]], out: dict[str, Choice]) -> dict[str, Choice]:
    """Return the side of a foot where of a thing's two sides in plan only the other is said: "Depth: 62 cm feet"."""
    if "height" not in out or "diameter" in out or ("width" in out) == ("depth" in out):
        return {}
    side = "depth" if "width" in out else "width"
    said = [p for g in bases for p in g if len(g) == 1 and p.dimension == side and p.value]
    if not said:
        return {}
    part = max(said, key=lambda p: p.value or 0.0)
    return {side: Choice(part.value or 0.0, part.start, part.end, f"{side} at its foot, for it has no other")}


def _base(group: list[DimensionPart]) -> dict[str, Choice]:
    """Return width and depth of a base; they win over the object's largest width where it stands."""
    by_name = {part.dimension: part for part in reversed(group)}
    width, depth = by_name.get("width"), by_name.get("depth")
    how = "of the base"
    height = by_name.get("height")
    if height and width and not depth and height.assumed and (height.value or 0.0) >= _FLAT * (width.value or 0.0):
        width, depth = height, width
        how = "of the base, whose first number is too large to be its height: both lie in plan"
    if width is None:
        width = by_name.get("diameter") or by_name.get("length") or by_name.get("unlabelled")
        how = f"of the base, its {width.dimension} in both directions" if width else how
    depth = depth or width
    if width is None or depth is None or width.value is None or depth.value is None:
        return {}
    if depth is width and "directions" not in how:
        how = "of the base, taken as deep as it is wide"
    return {
        "base_width": Choice(width.value, width.start, width.end, f"width {how}"),
        "base_depth": Choice(depth.value, depth.start, depth.end, f"depth {how}"),
    }


def _mass(dimensions: Dimensions, chosen: list[DimensionPart]) -> Choice | None:
    masses = [p for p in dimensions.parts if p.dimension == "weight" and p.value is not None and p.value > 0.0]
    masses = [p for p in masses if not is_bore(p.name)]  # a gun of ten pounds shoots as much
    if not masses:
        return None
    group = chosen[0].group if chosen else -1
    # "c. 400 kg" is about as much, and no part c where there are no parts a and b.
    about = not {"a", "b"} & {p.name for p in dimensions.parts}
    own = [p for p in masses if p.group == group]
    own = own or [p for p in masses if p.name == "overall" or (about and p.name == "c")]
    heaviest = max(own or masses, key=lambda p: p.value or 0.0)
    why = "weight of the object itself" if own else "weight of a part, the heaviest given"
    return Choice(heaviest.value or 0.0, heaviest.start, heaviest.end, why)
