"""The words around the numbers: which part they name, which dimensions, which qualifiers."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import permutations

from pipeline.collection.dimensions.tokens import (
    BREAK,
    CLOSE,
    COLON,
    COMMA,
    DIMENSION,
    DOT,
    DOTTED,
    JOIN,
    NUMBER,
    OPEN,
    TIME,
    UNIT,
    WORD,
    Token,
)

_GLUE = frozenset(("", "-", ".", "&", "'", "’", "/", "-.", "+"))

_LEGENDS = {
    "".join(order): tuple(sides[letter] for letter in order)
    for sides in (
        {"h": "height", "w": "width", "d": "depth"},
        {"h": "height", "w": "width", "l": "length"},
        {"h": "height", "b": "width", "t": "depth"},
        {"h": "height", "b": "width", "l": "length"},
        {"h": "height", "l": "width", "p": "depth"},
    )
    for order in permutations(sides)
}
"""Sides by their first letters, written together: "87 x 54 x 57 cm (hwd)"."""

_ON = frozenset({"on", "sur", "su", "sobre", "op", "på", "na"})
"""Ahead of a base, behind a number: "62 cm on socle" is the height with it."""
_BASES = (("part", "base"), ("part", "pedestal"))
_BODIES = frozenset({"body", "belly", "bowl", "shoulder", "shoulders", "waist", "cuerpo", "corpo", "corps", "körper"})
"""Where a vessel is widest, of which a diameter is the thing's own."""

_IN_POLISH = frozenset({"ramie", "oprawie"})
"""Words behind a Polish "w" that is no width: "w ramie", in its frame."""


@dataclass(slots=True)
class Phrase:
    """What a stretch of words says.

    Attributes
    ----------
    name : str
        The part, normalised; "" where none is named.
    known : bool
        Every word of the name is in the table, so that it may also stand behind the numbers.
    dimensions : list of str
        The dimensions named, in their order.
    joined : bool
        They are joined by "x", as in "height x width x depth".
    qualifiers : set of str
        As of `result.DimensionPart`.
    on : bool
        On a base, as what was measured before stands: "62 cm on socle".
    start, end : int
        The characters of the text that hold it.
    """

    name: str = ""
    known: bool = True
    dimensions: list[str] = field(default_factory=list)
    joined: bool = False
    qualifiers: set[str] = field(default_factory=set)
    on: bool = False
    start: int = 0
    end: int = 0


def is_label_letter(tokens: list[Token], at: int, text: str) -> bool:
    """Say whether a letter such as the d of ".d", "(b, lid)" or "b) H. 3 cm" numbers a component, and is no short word.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    at : int
        The letter's token.
    text : str
        The text itself.

    Returns
    -------
    bool
        Whether it numbers a component.
    """
    token = tokens[at]
    if token.end - token.start != 1:
        return False
    before = text[token.start - 1] if token.start else ""
    if before in ("-", "&") or (before == "." and not text[token.start - 2 : token.start - 1].isalnum()):
        return True
    following = tokens[at + 1].type
    ahead = tokens[at - 1].type if at else BREAK
    if following == CLOSE and ahead in (BREAK, CLOSE, COMMA, DOT) and tokens[at + 2].type in (DIMENSION, NUMBER, WORD):
        return True
    opened = ahead == OPEN
    return opened and (following == COMMA or (following == CLOSE and tokens[at + 2].type in (COLON, DOT)))


def _dimension(tokens: list[Token], at: int, indices: list[int]) -> str:
    """Return the dimension that a token names, if it is one of some; else ""."""
    kind, meaning = tokens[at].meaning or ("", "")
    return meaning if kind == "dimension" and at in indices else ""


def phrase_of(tokens: list[Token], indices: list[int], text: str) -> Phrase:
    """Return what some tokens say together.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    indices : list of int
        Those that count.
    text : str
        The text itself.

    Returns
    -------
    Phrase
        With the characters from the first to the last of them.
    """
    out = Phrase()
    if not indices:
        return out
    kept: list[tuple[str, Token]] = []
    joins = legends = 0
    for at in indices:
        token = tokens[at]
        kind, meaning = token.meaning or ("", "")
        legend = _LEGENDS.get(token.word, ()) if token.type == WORD else ()
        if legend:
            out.dimensions += legend
            legends += 1
        elif token.word == "w" and at + 1 in indices and tokens[at + 1].word in _IN_POLISH:
            pass
        elif token.word in _ON and at + 1 in indices and tokens[at + 1].meaning in _BASES:
            out.on = True
        elif token.word in _BODIES and "diameter" in (*out.dimensions[-1:], _dimension(tokens, at + 1, indices)):
            out.qualifiers.add("maximum")
        elif token.type == DIMENSION:
            if is_label_letter(tokens, at, text):
                kept.append((token.word, token))
                out.known = False
            else:
                out.dimensions.append(meaning)
        elif token.type == JOIN:
            joins += 1
            kept.append((token.word, token))
        elif kind == "qualifier":
            out.qualifiers.add(meaning)
        elif kind in ("with", "without", "part"):
            kept.append((meaning or kind, token))
        elif token.word == "outer" and at + 1 in indices and tokens[at + 1].meaning == ("part", "frame"):
            pass
        elif kind == "filler":
            if token.word == "and" and kept:
                kept.append(("and", token))
        elif token.type in (NUMBER, DOTTED, TIME, WORD) or (token.type == UNIT and token.word.isalpha()):
            kept.append((token.word.strip(".,") or token.word, token))
            out.known = False
    out.joined = joins + legends > 0 and len(out.dimensions) > 1
    if out.joined:
        kept = [(word, token) for word, token in kept if token.type != JOIN]
    while kept and kept[0][1].type == JOIN:
        del kept[0]
    while kept and kept[-1][0] == "and":
        kept.pop()
    out.name = _normal(_glued(kept, text))
    out.start, out.end = tokens[indices[0]].start, tokens[indices[-1]].end
    return out


def _glued(kept: list[tuple[str, Token]], text: str) -> str:
    """Join words by blanks, and by what stood between them where no blank did: "ex-libris", "b&w", "1a"."""
    name = ""
    last = -1
    for word, token in kept:
        between = text[last : token.start] if last >= 0 else ""
        name += (between[:1] if between in _GLUE else " ") + word if name else word
        last = token.end
    return name


def _normal(name: str) -> str:
    for preposition, framed in (("with", "framed"), ("without", "unframed")):
        bare = name.removeprefix("overall ")
        if bare.startswith(preposition + " "):
            if bare.rsplit(" ", 1)[-1] in ("frame", "framing", "framed"):
                return framed
            return f"{preposition} base" if bare.endswith(" base") else bare
    return name
