"""Units that stand before their numbers: "Hauteur en cm 17", "cm 42 x 35", "Dimensions (cm): H. 23, l. 12"."""

from __future__ import annotations

from pipeline.collection.dimensions.lexicon import LexiconUnit
from pipeline.collection.dimensions.tokens import (
    BREAK,
    CLOSE,
    COLON,
    COMMA,
    DASH,
    DIMENSION,
    DOT,
    END,
    JOIN,
    NUMBER,
    OPEN,
    OTHER,
    UNIT,
    WORD,
    Token,
)

_NAMES = frozenset({"mm", "cm", "dm", "m", "g", "kg"})
"""Units that are written before numbers: inches never are, and "in" is a word."""
_SPELLED = frozenset({"inches", "inch", "zoll"})
"""Words that are nothing else, behind a legend or in brackets: "34 x 21 x 18 (HxWxD) (inches)"."""
_ANNOUNCING = frozenset({"en", "in", "misu"})
_UNIT_NAMES = frozenset(
    {"misu", "unità", "unit", "units", "einheit", "unité", "unidad", "unidade", "eenheid", "μοναδα"}
)
"""What stands before a colon and the unit of all that follows, as catalogues in columns print it."""
_BETWEEN = frozenset({DOT, COLON, CLOSE, OPEN, DASH, WORD, DIMENSION, JOIN, COMMA, OTHER})
_ENDS = frozenset({END, BREAK, COMMA, CLOSE, OPEN, JOIN, DASH, DOT, DIMENSION, COLON, OTHER})
_FARTHEST = 12
"""Tokens between a unit and the first number that it is the unit of."""


def units_behind(tokens: list[Token]) -> list[Token]:
    """Return the tokens with every unit behind the numbers that it is of.

    Parameters
    ----------
    tokens : list of Token
        Of the text.

    Returns
    -------
    list of Token
        A unit that was moved stands behind each of its numbers, without characters of its own.
    """
    moved: dict[int, LexiconUnit] = {}
    gone: set[int] = set()
    ahead: dict[str, tuple[LexiconUnit, str]] = {}
    last = -1  # the unit's token that was met last
    for at, token in enumerate(tokens):
        if token.unit is not None and token.type != DIMENSION and _is_ahead(tokens, at, moved):
            start = _announced(tokens, at)
            gone.update(range(start, at + 1))
            if tokens[at + 1].type == DOT:
                gone.add(at + 1)
            ahead[token.unit.kind] = (token.unit, token.word)
            last = at
            if _closes(tokens, at):
                _carry_back(tokens, start, token.unit, moved)
        elif token.type == NUMBER and ahead:
            kind = "mass" if _weighs(tokens, at) else "length"
            direct = all(one.type in (DOT, COLON, CLOSE) for one in tokens[last + 1 : at])
            if not (_is_bare(tokens, at) or (direct and tokens[at + 1].unit is None)):
                continue
            joined = at > 1 and tokens[at - 1].type in (JOIN, DASH) and at - 2 in moved
            if kind in ahead and (direct or joined or _is_labelled(tokens, at)):
                moved[at] = ahead[kind][0]
            elif direct and len(ahead) == 1:
                moved[at] = next(iter(ahead.values()))[0]
    if not moved:
        return tokens
    out: list[Token] = []
    for at, token in enumerate(tokens):
        if at not in gone:
            out.append(token)
        if at in moved:
            unit = moved[at]
            out.append(Token(UNIT, token.end, token.end, unit.name, None, unit))
    return out


def _is_ahead(tokens: list[Token], at: int, moved: dict[int, LexiconUnit]) -> bool:
    """Whether a unit belongs to no number before it, and there is one that it may belong to."""
    unit = tokens[at].unit
    named = unit is not None and (unit.name in _NAMES or tokens[at].word in _SPELLED)
    if unit is None or not named or not tokens[at].word.strip("."):
        return False
    legend = at - 1 if at and tokens[at - 1].type == CLOSE else at
    if legend > 1 and tokens[legend - 1].type == DIMENSION and tokens[legend - 2].type == JOIN:
        # "34 x 21 x 18 HxWxD cm"
        return tokens[_dotted(tokens, at)].type in (END, BREAK)
    back = at - 1
    while back >= 0 and tokens[back].type in (DOT, OPEN, DIMENSION, CLOSE):
        back -= 1
    announced = tokens[at - 1].word in _ANNOUNCING or tokens[at - 2].word in _UNIT_NAMES if at else False
    if (
        back >= 0
        and tokens[back].type == NUMBER
        and back not in moved
        and not announced
        and tokens[at - 1].type != OPEN
    ):
        return False
    if announced:
        return True
    if at > 1 and tokens[at - 1].type == OPEN and tokens[_dotted(tokens, at)].type == CLOSE:
        # "(g)" alone numbers a component.
        return unit.name in ("mm", "cm", "dm", "kg", "in") or tokens[at - 2].type == DIMENSION
    if unit.name not in _NAMES:
        return False
    behind = _dotted(tokens, at)
    if tokens[behind].type == COLON:
        behind += 1
    if tokens[behind].type != NUMBER:
        return False
    # A g alone numbers a component; "gr. 250" is a mass, but "Gr. 250 g" a label.
    return unit.name != "g" or _weighs(tokens, behind) or (tokens[at].word == "gr" and tokens[behind + 1].unit is None)


def _dotted(tokens: list[Token], at: int) -> int:
    """Return the token behind a unit and its full stop."""
    return at + 2 if tokens[at + 1].type == DOT else at + 1


def _announced(tokens: list[Token], at: int) -> int:
    """Return the first token of "en cm" and "MISU: cm"."""
    if at and tokens[at - 1].word in _ANNOUNCING:
        return at - 1
    if at > 1 and tokens[at - 2].word in _UNIT_NAMES:
        return at - 2
    return at


def _closes(tokens: list[Token], at: int) -> bool:
    """Whether no number follows that the unit could be of, as in "A 45, L 30 (cm)"."""
    return not any(one.type == NUMBER for one in tokens[at : at + _FARTHEST])


def _carry_back(tokens: list[Token], at: int, unit: LexiconUnit, moved: dict[int, LexiconUnit]) -> None:
    for back in range(at - 1, -1, -1):
        one = tokens[back]
        if one.unit is not None and one.type == UNIT and one.unit.kind == unit.kind:
            return
        weighs = one.type == NUMBER and _weighs(tokens, back)
        named = tokens[back + 1].meaning is not None
        if (
            one.type == NUMBER
            and back not in moved
            and (named or _is_bare(tokens, back))
            and weighs == (unit.kind == "mass")
        ):
            moved[back] = unit


def _is_bare(tokens: list[Token], at: int) -> bool:
    """Whether a number has no unit, and what follows does not say that it counts something."""
    return tokens[at + 1].type in _ENDS and tokens[at + 1].unit is None


def _weighs(tokens: list[Token], at: int) -> bool:
    for back in range(at - 1, max(at - 6, -1), -1):
        one = tokens[back]
        if one.type in (NUMBER, BREAK):
            return False
        if one.type == DIMENSION and one.meaning:
            return one.meaning[1] == "weight"
    return False


def _is_labelled(tokens: list[Token], at: int) -> bool:
    """Whether a label stands before a number, in the same clause."""
    for back in range(at - 1, max(at - _FARTHEST, -1), -1):
        one = tokens[back]
        if one.type == DIMENSION:
            return True
        if one.type not in _BETWEEN and (one.type != UNIT or tokens[back - 1].type == NUMBER):
            return False
    return False
