"""Short labels such as L., l. and A: what they mean is settled by the language of the text, which its words tell."""

from __future__ import annotations

from collections.abc import Iterator

from pipeline.collection.dimensions.lexicon import LabelLanguage, label_words, languages
from pipeline.collection.dimensions.phrases import is_label_letter
from pipeline.collection.dimensions.result import DimensionNote
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

_LONGEST_LABEL = 4
_EVIDENCE = 3
"""Weight of a word that only one language has, against that of one label that fits."""
_ARTICLES = frozenset("aeicgsnfp")
"""Letters that are words or number components as well: in small letters they are labels only before a mark."""
_UPRIGHT = frozenset({"縦", "縱", "纵", "竪", "세로"})
"""Japanese, Chinese, Korean: the height of a picture, but the depth of a box whose height (高) is given too."""
_UPRIGHT_AND_WIDE = frozenset("hl")
_DEEP = frozenset("ps")
"""Profondità, profondeur, profundidad; spessore: beside h and l."""
_COMPONENTS = frozenset("ab")
"""A text that has both numbers its components with letters."""
_NUMBERING = frozenset("abcdefg")
_TURKISH = frozenset({"boy", "yükseklik", "yük", "derinlik"})
"""Beside one of these "en" is the width, and no preposition."""
_ROUND = ("en", "nl", "de")
"""Languages whose D is the depth or thickness, but beside no width the diameter."""
_IN_PLAN = frozenset({"width", "depth", "length", "thickness"})


def labelled(tokens: list[Token], text: str, language: str, notes: list[DimensionNote]) -> list[Token]:
    """Return the tokens with their short labels as the text's language means them.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    text : str
        The text itself.
    language : str
        That of the source, "" where it is not told: then the words and labels of the text decide.
    notes : list of DimensionNote
        What a reader should know is appended.

    Returns
    -------
    list of Token
        As many as before.
    """
    tokens = _upright(tokens)
    places = _labels_in(tokens, text)
    if not places:
        return tokens
    best = [languages()[language]] if language else _spoken(tokens, text, places)
    if not best:
        return tokens
    chosen = best[0]
    out = list(tokens)
    told: set[str] = set()
    upright = any(tokens[at].word == "h" for at in places)
    for at in places:
        token = tokens[at]
        written = text[token.start : token.end]
        meaning = chosen.meaning(written)
        if (
            chosen.name in _ROUND
            and meaning in ("depth", "thickness")
            and token.word == "d"
            and _is_diameter(tokens, places)
        ):
            message = f"{written!r} without a width beside it is taken as the diameter"
            notes.append(DimensionNote("round", message, token.start, token.end))
            return tokens
        if not meaning or (chosen.name == "en" and token.meaning == ("dimension", meaning)):
            continue
        if written.lower() == "a" and meaning == "height" and upright:
            meaning = "width"  # ancho, where the height is H
            notes.append(DimensionNote("label", f"{written!r} beside H is taken as the width", token.start, token.end))
            told.add(written)
        others = {other.meaning(written) for other in best[1:]} - {"", meaning}
        if written not in told and ("height" in others or (meaning == "height" and others)):
            message = f"{written!r} is taken as the {meaning}; in another language it is the {min(others)}"
            notes.append(DimensionNote("label", message, token.start, token.end))
            told.add(written)
        out[at] = Token(DIMENSION, token.start, token.end, token.word, ("dimension", meaning), token.unit)
    return out


def labels_in(tokens: list[Token], text: str) -> tuple[frozenset[str], tuple[str, ...]]:
    """Return the short labels of a text, and the languages that explain them best.

    Parameters
    ----------
    tokens : list of Token
        Of the text.
    text : str
        The text itself.

    Returns
    -------
    (frozenset of str, tuple of str)
        As they are written; names of languages, none where none explains them.
    """
    places = _labels_in(tokens, text)
    labels = frozenset(text[tokens[at].start : tokens[at].end] for at in places)
    return labels, tuple(one.name for one in _spoken(tokens, text, places)) if places else ()


def _labels_in(tokens: list[Token], text: str) -> list[int]:
    places = list(_places(tokens, text))
    if _UPRIGHT_AND_WIDE.issubset({tokens[at].word for at in places}):
        # "h 48, l 32, p 14": beside two sides the third is no page.
        deep = (at for at, one in enumerate(tokens[:-1]) if one.word in _DEEP and tokens[at + 1].type == NUMBER)
        places = sorted({*places, *deep})
    if not _TURKISH.intersection(token.word for token in tokens):
        places = [at for at in places if tokens[at].word != "en"]
    if _COMPONENTS.issubset({token.word for token in tokens}):
        places = [at for at in places if tokens[at].word not in _NUMBERING]
    return places


def _spoken(tokens: list[Token], text: str, places: list[int]) -> list[LabelLanguage]:
    words = {token.word for token in tokens if token.type in (WORD, DIMENSION)}
    return _likeliest({text[tokens[at].start : tokens[at].end] for at in places}, words)


def _upright(tokens: list[Token]) -> list[Token]:
    """Return the tokens with the upright side of a flat thing as its depth where the text gives a height as well."""
    heights = {token.word for token in tokens if token.meaning == ("dimension", "height")}
    if not heights & _UPRIGHT or heights <= _UPRIGHT:
        return tokens
    depth = ("dimension", "depth")
    return [token._replace(meaning=depth) if token.word in _UPRIGHT else token for token in tokens]


def _likeliest(labels: set[str], words: set[str]) -> list[LabelLanguage]:
    """Return the languages that explain a text's labels best, the first of them first; none where none does."""
    scored: list[tuple[int, LabelLanguage]] = []
    for one in languages().values():
        meanings = [one.meaning(label) for label in labels]
        known = [meaning for meaning in meanings if meaning]
        spoken = len(one.words & words)
        if len(known) < len(meanings) and not spoken:
            continue
        if one.name != "en" and not spoken and not _sized(known):
            continue
        score = _EVIDENCE * spoken + 2 * len(known) - len(meanings) - (len(known) - len(set(known)))
        scored.append((score, one))
    most = max((score for score, _ in scored), default=0)
    return [one for score, one in scored if score == most]


def _sized(meanings: list[str]) -> bool:
    """Whether labels alone, without a word, make a size: a height, and something in plan."""
    plan = _IN_PLAN.intersection(meanings)
    return len(plan) + len({"height", "diameter"}.intersection(meanings)) > 1


def _is_diameter(tokens: list[Token], places: list[int]) -> bool:
    """Whether a D stands beside no width, length or unlabelled number, as the depth of a box would."""
    labels = {tokens[at].word for at in places}
    inside = 0
    for at, token in enumerate(tokens):
        inside += (token.type == OPEN) - (token.type == CLOSE)
        if token.type == JOIN and inside < 1 and NUMBER in (tokens[0].type, tokens[at + 1].type):
            return False
    spoken = {token.meaning[1] for token in tokens if token.type == DIMENSION and token.meaning}
    return labels <= {"h", "d", "ht"} and spoken <= {"height", "depth", "weight"}


def _places(tokens: list[Token], text: str) -> Iterator[int]:
    """Yield the tokens that stand where labels do: before a number, or in a legend such as H x W x D."""
    known = label_words()
    for at, token in enumerate(tokens):
        if token.type not in (WORD, DIMENSION, UNIT) or token.end - token.start > _LONGEST_LABEL:
            continue
        if token.word not in known or is_label_letter(tokens, at, text):
            continue
        before = tokens[at - 1] if at else tokens[-1]
        if before.type == NUMBER and token.unit is not None and token.type != DIMENSION:
            continue
        inside = before.type == OPEN and tokens[at + 1].type == CLOSE and tokens[at - 2].type in (UNIT, NUMBER)
        if inside or _before_number(tokens, at, text) or _in_legend(tokens, at):
            yield at


def _before_number(tokens: list[Token], at: int, text: str) -> bool:
    token, mark = tokens[at], tokens[at + 1]
    if token.word in _NUMBERING and (text[token.start - 1 : token.start].isalnum() or _heads_run(tokens, at)):
        return False
    small = text[token.start : token.end].islower() and token.word in _ARTICLES
    if small and mark.type not in (COLON, DOT):
        return False
    at += 1
    for _ in range(4):  # "H. totale: 12", "D disc = 33", "L max. 5"
        after = tokens[at]
        if after.type == NUMBER:
            return True
        if after.type not in (DOT, COLON, DASH, WORD, UNIT) or (after.type == DASH and small):
            return False
        at += 1
    return tokens[at].type == NUMBER


def _heads_run(tokens: list[Token], at: int) -> bool:
    """Whether "a:" heads "10 x 12 cm": then it is the name of a component."""
    at += 1
    if tokens[at].type != COLON or tokens[at + 1].type != NUMBER:
        return False
    at += 2
    while tokens[at].type in (UNIT, DOT):
        at += 1
    return tokens[at].type == JOIN


def _in_legend(tokens: list[Token], at: int) -> bool:
    before = tokens[at - 1] if at else tokens[-1]
    after = tokens[at + 1]
    if after.type == DOT:
        after = tokens[at + 2]
    edges = (OPEN, COLON, END, BREAK, COMMA, WORD, CLOSE, OTHER)
    if before.type == JOIN:
        return after.type in (*edges, JOIN, UNIT, NUMBER)
    return after.type == JOIN and before.type in edges
