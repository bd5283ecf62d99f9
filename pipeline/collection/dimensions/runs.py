"""Numbers that stand together: 8 7/8 in., 4' 3", 10-12 cm, H. 3 x W. 4 in., 3 oz. 2 dwt."""

from __future__ import annotations

from pipeline.collection.dimensions.lexicon import LexiconUnit, unit_words, units
from pipeline.collection.dimensions.phrases import is_label_letter
from pipeline.collection.dimensions.quantities import DimensionQuantity, fill_units, troy
from pipeline.collection.dimensions.tokens import (
    BREAK,
    CLOSE,
    COLON,
    COMMA,
    DASH,
    DIMENSION,
    DOT,
    DOTTED,
    END,
    JOIN,
    NUMBER,
    OPEN,
    OTHER,
    UNIT,
    WORD,
    Token,
)

_UP_TO = frozenset({"to", "bis", "à", "a", "tot", "al", "até", "până", "から"})
_ENDS = frozenset({END, BREAK, COMMA, CLOSE, OPEN, JOIN, DASH, DOT, OTHER, DIMENSION})
_AND = frozenset({"and", "und", "et", "en", "y", "e", "și"})
_OF = frozenset({"de", "di", "in", "of", "da", "en"})
_SPACELESS = "\u3000"
"""Before the letters of the scripts that put no spaces between words."""
_POWERS = frozenset({"2", "3", "²", "³"})
_AREAS = frozenset({"sq", "square", "cubic", "cu", "quadrat"})


def unit_at(tokens: list[Token], at: int, *, weighing: bool = False) -> tuple[LexiconUnit | None, int, int]:
    """Return the unit at a token; no unit leaves the place.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    at : int
        The token.
    weighing : bool
        Whether a weight is named, so that a t is the unit and no dimension.

    Returns
    -------
    Unit or None
        The unit, if there is one.
    int
        The token behind it.
    int
        Where its characters end.
    """
    token = tokens[at]
    if token.type == DOT and tokens[at + 1].unit is not None and tokens[at + 1].type != DIMENSION:
        at += 1
        token = tokens[at]
    ounce = unit_words()["oz"]
    if token.word == "troy" and tokens[at + 1].unit is ounce:
        return units()["oz t"], at + 2, tokens[at + 1].end
    unit = token.unit
    if unit is None or (token.type == DIMENSION and token.word == "t" and not weighing):
        return None, at, token.start
    at += 1
    end = token.end
    if unit is ounce:
        behind = at + 1 if tokens[at].type == DOT else at
        if tokens[behind].word in ("troy", "t"):
            return units()["oz t"], behind + 1, tokens[behind].end
    if tokens[at].type == DOT:
        end = tokens[at].end
        at += 1
    return unit, at, end


def quantity_at(tokens: list[Token], at: int, *, joined: bool, weighing: bool) -> tuple[DimensionQuantity, int]:
    """Return the quantity whose number is at a token.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    at : int
        The token of the number.
    joined : bool
        Whether numbers that are joined by "x" stand before it.
    weighing : bool
        As of `unit_at`.

    Returns
    -------
    Quantity
        With its unit, where it has one.
    int
        The token behind it.
    """
    token = tokens[at]
    out = DimensionQuantity(token.num, token.den, token.start, token.end, token.word)
    at = _take_unit(tokens, at + 1, out, weighing)
    second = tokens[at + 1] if tokens[at].type == DASH or tokens[at].word in _UP_TO else None
    if second is not None and second.type == NUMBER:
        end = DimensionQuantity(second.num, second.den, second.start, second.end, second.word)
        behind = _take_unit(tokens, at + 2, end, weighing)
        apart = tokens[behind].type == JOIN and (joined or out.written)
        if not apart and (out.unit is None or end.unit is None or out.unit.name == end.unit.name):
            unit = end.unit or out.unit
            low, high = sorted(((out.num, out.den), (end.num, end.den)), key=lambda pair: pair[0] / pair[1])
            merged = DimensionQuantity(*high, out.start, end.end, out.word, unit, end.unit_text or out.unit_text)
            merged.first, merged.written = low, unit is not None
            return merged, behind
    while out.unit is not None and out.unit.kind in ("length", "mass"):
        smaller, behind = _smaller(tokens, at, out)
        if smaller is None:
            break
        if smaller.unit is not None and smaller.unit.name == "dwt" and out.unit.name == "oz":
            troy(out)
        out.add(smaller)
        at = behind
    return out, at


def _take_unit(tokens: list[Token], at: int, out: DimensionQuantity, weighing: bool) -> int:
    unit, behind, end = unit_at(tokens, at, weighing=weighing)
    if unit is None:
        return at
    first = tokens[at + 1] if tokens[at].type == DOT else tokens[at]
    out.unit, out.written, out.end = unit, True, end
    out.unit_text = first.word
    return behind


def _smaller(tokens: list[Token], at: int, larger: DimensionQuantity) -> tuple[DimensionQuantity | None, int]:
    """Return the inches behind feet, the pennyweights behind ounces; feet may leave the mark of the inches out."""
    comma = tokens[at].type == COMMA
    number = tokens[at + 1] if comma else tokens[at]
    if number.type != NUMBER or larger.unit is None:
        return None, at
    out = DimensionQuantity(number.num, number.den, number.start, number.end, number.word)
    behind = _take_unit(tokens, at + (2 if comma else 1), out, False)
    if out.unit is None:
        if (
            larger.unit.name == "m"
            and not comma
            and number.den == 1
            and _is_pair(number)
            and (tokens[behind].type in _ENDS or tokens[behind].word in _OF)
        ):
            out.unit = units()["cm"]  # 1 m 20
            return out, behind
        if larger.unit.name != "ft" or comma or number.num >= 12 * number.den:
            return None, at
        out.unit = units()["in"]
        return out, behind
    chain = "dwt" if larger.unit.name == "oz" else larger.unit.smaller
    if out.unit.name != chain or (comma and larger.unit.kind == "length" and larger.unit.system == "metric"):
        return None, at
    return out, behind


def _is_pair(number: Token) -> bool:
    """Whether a number is written with two digits, as the centimetres behind metres are."""
    return number.word.isdigit() and len(number.word) == 2


def run_at(tokens: list[Token], at: int, text: str) -> tuple[list[DimensionQuantity], int] | None:
    """Return the numbers joined by "x" that begin at a token.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    at : int
        The token.
    text : str
        The text itself.

    Returns
    -------
    (list of Quantity, int) or None
        The numbers, and the token behind them; None where none begin.
    """
    items: list[DimensionQuantity] = []
    before = False
    while True:
        start = at
        label = ""
        meaning = tokens[at].meaning
        if tokens[at].type == DIMENSION and meaning and not is_label_letter(tokens, at, text):
            label = meaning[1]
            at += 1
            while tokens[at].type in (DOT, COLON) or tokens[at].word == "of" or _qualifies(tokens[at]):
                at += 1
        if tokens[at].type not in (NUMBER, DOTTED):
            at = start
            break
        quantity, at = quantity_at(tokens, at, joined=bool(items), weighing=label == "weight")
        if label:
            quantity.dimension, before = label, True
        elif not before:
            at = _label_behind(tokens, at, quantity, text)
        items.append(quantity)
        following = at + 1 if tokens[at].type == DOT else at
        following = _past_qualifier(tokens, following)
        if tokens[following].type != JOIN or not _begins(tokens, following + 1):
            break
        at = following + 1
    if not items:
        return None
    fill_units(items)
    return items, at


def _past_qualifier(tokens: list[Token], at: int) -> int:
    """Return the token behind the remark of "45 (max.) x 22 cm" or "45 approx. x 22 cm", else the place itself."""
    opened = tokens[at].type == OPEN
    place = at + 1 if opened else at
    if not _qualifies(tokens[place]):
        return at
    while _qualifies(tokens[place]) or tokens[place].type == DOT:
        place += 1
    if opened:
        place = place + 1 if tokens[place].type == CLOSE else at
    return place if tokens[place].type == JOIN else at


def _qualifies(token: Token) -> bool:
    return token.meaning is not None and token.meaning[0] == "qualifier"


def _begins(tokens: list[Token], at: int) -> bool:
    """Say whether a number, or a dimension and a number, begin at a token."""
    if tokens[at].type == DIMENSION:
        at += 1
        while tokens[at].type in (DOT, COLON) or _qualifies(tokens[at]):
            at += 1
    return tokens[at].type in (NUMBER, DOTTED)


def _label_behind(tokens: list[Token], at: int, quantity: DimensionQuantity, text: str) -> int:
    """Take the H of '10 in. H' and of '10 (h) x 12 (w) in.', and a unit behind it; return the token behind all that."""
    place = at + 1 if tokens[at].type == DOT else at
    bracket = tokens[place].type == OPEN
    if bracket:
        place += 1
    if tokens[place].word in _OF and tokens[place + 1].type == DIMENSION and quantity.unit is not None:
        place += 1  # 82 cm de alto
    token = tokens[place]
    if token.type != DIMENSION or token.meaning is None or is_label_letter(tokens, place, text):
        return at
    behind = place + 1
    if tokens[behind].type == DOT:
        behind += 1
    if tokens[behind].type == JOIN and tokens[behind + 1].type == DIMENSION and not _begins(tokens, behind + 1):
        return at  # "34 x 21 x 18 HxWxD in.": a legend of all of them
    if bracket:
        if tokens[behind].type != CLOSE:
            return at
        behind += 1
    elif token.word[:1] > _SPACELESS and tokens[behind].type == NUMBER:
        return at  # "150cm 裄70cm": such labels stand before their numbers
    elif tokens[behind].type == COLON or (
        tokens[behind].type == WORD and tokens[behind].unit is None and tokens[behind].word not in _AND
    ):
        return at  # "3 in. diam. at rim" and "3 in. high back: ..." are phrases
    quantity.dimension = token.meaning[1]
    quantity.end = max(quantity.end, tokens[place].end)
    if quantity.unit is None:
        behind = _take_unit(tokens, behind, quantity, False)
    return behind


def area_at(tokens: list[Token], at: int) -> int | None:
    """Return the token behind an area or a volume ("100 sq. ft.").

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    at : int
        The token where it may begin.

    Returns
    -------
    int or None
        None where there is none.
    """
    behind = at + 1
    unit, power = tokens[behind], tokens[min(behind + 1, len(tokens) - 1)]
    raised = power.word in _POWERS and power.start == unit.end
    if raised and tokens[at].type == NUMBER and unit.unit is not None and unit.unit.system == "metric":
        return behind + 2  # 500 cm3
    if tokens[behind].word not in _AREAS:
        return None
    behind += 1
    if tokens[behind].type == DOT:
        behind += 1
    return behind + 1 if tokens[behind].word in unit_words() else None


def conversion_at(tokens: list[Token], at: int, text: str) -> tuple[list[DimensionQuantity], int] | None:
    """Return the numbers of brackets that hold nothing but numbers.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    at : int
        The token of the opening bracket.
    text : str
        The text itself.

    Returns
    -------
    (list of Quantity, int) or None
        The numbers, and the token behind the brackets; None for other brackets.
    """
    out: list[DimensionQuantity] = []
    at += 1
    run = 0
    while tokens[at].type != CLOSE:
        token = tokens[at]
        if token.type in (NUMBER, DOTTED, DIMENSION):
            found = run_at(tokens, at, text)
            if found is None:
                return None
            items, at = found
            for item in items:
                item.run = run
            out += items
            run += 1
        elif token.type in (COMMA, DOT, JOIN, DASH, COLON) or token.word in (
            ";",
            "/",
            "or",
            "and",
            "approx",
            "ca",
            "=",
        ):
            at += 1
        elif token.type == UNIT and out and token.word in ("'", '"', "”", "’"):
            at += 1  # a second mark behind a unit: (21 cm")
        elif token.type == OTHER and token.word in "?*":
            at += 1
        else:
            # Nobody closed them: the line's end does, if all that stood in them were numbers with units.
            if out and token.type not in (WORD, OPEN) and all(q.unit for q in out):
                break
            return None
    if tokens[at].type == CLOSE:
        at += 1
    if not out or (len(out) == 1 and out[0].unit is None and not out[0].dimension and out[0].den == 1):
        return None
    return out, at
