"""What a text says beyond the extents that were chosen: numbers that no field holds, parts that stand for the whole."""

from __future__ import annotations

import re
from functools import cache

from pipeline.collection.dimensions.lexicon import label_words, meanings
from pipeline.collection.dimensions.parts import FRAMED, is_base, is_detail
from pipeline.collection.dimensions.result import Chosen, DimensionNote, DimensionPart, Dimensions

_CARRIERS = frozenset({
    "page", "pages", "mat", "case", "slipcase", "cover", "portfolio", "box", "book", "album", "envelope", "folder",
    "volume", "panel", "canvas", "board", "block", "part", "parts", "component", "components", "irregular", "various",
    "installation", "support", "mount", "approx", "stacked", "spread", "partial", "large",
})  # fmt: skip
"""What a work on paper or in parts is made of and kept in: such sizes are the object's, as far as the text tells."""
_IN_PLAN = frozenset({"width", "depth", "diameter"})
_NUMBERING = frozenset("abcdefg")
"""Letters that number components."""
_LETTERS = re.compile(r"[^\W\d_]+")
_MEASURED = re.compile(r"\b[^\W\d_]{1,10} \d+(?= )")
"""Within the name of a part: a label that nobody knows with its number, "qz 65 xv 130 wy" of qz. 65, xv. 130, wy. 6 cm.
"""
_SHARE_OF_HEIGHT = 0.05
"""Height of a base over that of the object from which it matters whether the one is in the other."""
_WITHIN = 0.97
"""A frame's side over that of what it holds from which it is no rounding."""
_OPEN = frozenset({"height", "width", "depth", "length", "unlabelled"})


def doubts(read: Dimensions, chosen: Chosen, about: str = "") -> tuple[DimensionNote, ...]:
    """Return what a person should see before the chosen extents are believed.

    Parameters
    ----------
    read : Dimensions
        What was read of the text.
    chosen : Chosen
        What was made of it.
    about : str
        The words that name the object: what they name is no part of it.

    Returns
    -------
    tuple of DimensionNote
        Of kind "unused" (a number of the chosen group that fills no field) and "part" (the size is that of something
        that the text names and the table of words does not know).
    """
    used = {(c.start, c.end) for name in Chosen.__slots__ if (c := getattr(chosen, name)) is not None}
    body = chosen.height or chosen.width or chosen.depth or chosen.diameter
    groups = {part.group for part in read.parts if body and (part.start, part.end) == (body.start, body.end)}
    # Where width and depth are both given, a diameter beside them fills neither.
    open_ = _OPEN | {"diameter"} if chosen.width and chosen.depth else _OPEN
    out = [
        DimensionNote("unused", f"the text also gives {_shown(part, read)}, which no field holds", part.start, part.end)
        for part in read.parts
        if part.group in groups
        and ((part.start, part.end) not in used or part.dimension == "diameter")
        and part.dimension in open_
        and part.value
    ]
    out += [
        DimensionNote("unused", f"what {part.words!r} means is not known", part.start, part.end)
        for part in read.parts
        if part.name in _labels() and part.value
    ]
    out += [*_base_beside(read, chosen), *_frame_within(read), *_without_base(read, chosen)]
    if chosen.height is None:
        out += [
            DimensionNote(
                "unused", f"whether {_shown(part, read)} is of the base or of all is not said", part.start, part.end
            )
            for part in read.parts
            if is_base(part.name) and part.dimension == "height" and not part.assumed and part.value
        ]
    if not (chosen.width or chosen.depth or chosen.diameter):
        out += [
            DimensionNote("unused", f"{_shown(part, read)} of {part.words!r} fills no field", part.start, part.end)
            for part in read.parts
            if part.group not in groups
            and part.value
            and (
                (part.dimension in _IN_PLAN and is_strange(part.name, about))
                or (part.dimension in ("width", "length") and is_detail(part.name))
            )
        ]
    if not chosen.diameter and not (chosen.width and chosen.depth):
        out += [
            DimensionNote("unused", f"what {part.words!r} means is not known", part.start, part.end)
            for part in read.parts
            if part.group not in groups
            and part.dimension == "unlabelled"
            and part.value
            and _is_foreign(part.name, about)
        ]
    out += [
        DimensionNote("unused", f"{_shown(part, read)} is taken as the height, which is not said", part.start, part.end)
        for part in read.parts
        if chosen.height and part.start == chosen.height.start and part.dimension == "unlabelled"
        and part.name.startswith("with ") and chosen.width
    ]  # fmt: skip
    for part in read.parts:
        if (
            body is not None
            and (part.start, part.end) == (body.start, body.end)
            and (is_strange(part.name, about) or _is_foreign(part.name, about))
        ):
            message = f"the size of {part.words!r} is taken for that of the whole object"
            out.append(DimensionNote("part", message, part.start, part.end))
    return tuple(out)


def _frame_within(read: Dimensions) -> list[DimensionNote]:
    """Return a doubt where a frame is smaller than what it holds: one of the two is written wrongly."""
    framed = [part for part in read.parts if FRAMED.intersection(part.name.split())]
    return [
        DimensionNote("unused", f"{_shown(frame, read)} of the frame is less than {_shown(part, read)} within it",
                      frame.start, frame.end)
        for frame in framed
        for part in read.parts
        if part not in framed and part.dimension == frame.dimension and part.dimension in ("height", "width")
        and frame.value and part.value and frame.value < _WITHIN * part.value
    ][:1]  # fmt: skip


def _without_base(read: Dimensions, chosen: Chosen) -> list[DimensionNote]:
    """Return a doubt where a size is said to be without a base that nothing else in the text measures."""
    body = chosen.height or chosen.width
    told = any(part.name == "with base" or is_base(part.name) for part in read.parts)
    return [
        DimensionNote("unused", f"{_shown(part, read)} is without the base, whose own size is not said",
                      part.start, part.end)
        for part in read.parts
        if body and not told and part.start == body.start and part.name == "without base"
    ]  # fmt: skip


def _base_beside(read: Dimensions, chosen: Chosen) -> list[DimensionNote]:
    """Return a doubt where a base is wider than the object, or has a height that the object's perhaps includes."""
    round_ = chosen.diameter
    wider = [
        DimensionNote("unused", f"the base is wider, {_shown(part, read)}, than the diameter that is taken",
                      part.start, part.end)
        for part in read.parts
        if round_ and is_base(part.name) and part.dimension == "diameter" and (part.value or 0.0) > round_.value
    ]  # fmt: skip
    if wider:
        return wider
    body = next((p for p in read.parts if chosen.height and p.start == chosen.height.start), None)
    if body is None or not body.value or (body.words and body.name.startswith(("with", "overall"))):
        return []
    whole = {part.group for part in read.parts if part.dimension == "depth"}  # three numbers, the first its height
    return [
        DimensionNote("unused", f"whether the height includes that of the base, {_shown(part, read)}, is not said",
                      part.start, part.end)
        for part in read.parts
        if is_base(part.name) and part.dimension == "height" and (not part.assumed or part.group in whole)
        and part.value and part.value >= _SHARE_OF_HEIGHT * body.value
    ]  # fmt: skip


def _shown(part: DimensionPart, read: Dimensions) -> str:
    written = read.written(part)
    shown = written if part.unit_text and part.unit_text in written.lower() else f"{written} {part.unit}".strip()
    return f"the {part.dimension} {shown!r}"


def is_strange(name: str, about: str) -> bool:
    """Say whether a part's name has a word that neither the table of words nor the object's own name has."""
    own = {_stem(word) for word in about.casefold().split()}
    return any(
        len(word) > 2 and word not in meanings() and word not in _named() and _stem(word) not in own
        for word in _LETTERS.findall(name.casefold())
    )


def _is_foreign(name: str, about: str) -> bool:
    """Whether no word of the name of a part is known, so that it may be the word of another language for a side."""
    own = {_stem(word) for word in about.casefold().split()}
    words = _LETTERS.findall(name.casefold())
    if len(_MEASURED.findall(name)) > 1:
        return True
    return (
        bool(words)
        and not is_detail(name)
        and not any(
            word in meanings() or word in _named() or word in _NUMBERING or _stem(word) in own for word in words
        )
    )


@cache
def _labels() -> frozenset[str]:
    """Return labels of some language that as the name of a part are labels that were not understood."""
    return frozenset(label for label in label_words() if len(label) < 3) - _NUMBERING


@cache
def _named() -> frozenset[str]:
    return _CARRIERS | frozenset(word for _, meaning in meanings().values() for word in meaning.split())


def _stem(word: str) -> str:
    return word.strip(".,:;()[]'\"").removesuffix("s")
