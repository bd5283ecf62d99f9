"""Text -> tokens: numbers, words, marks.  One pass; no pattern can look at a character more than a few times."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

from pipeline.collection.dimensions.lexicon import (
    ALIKE,
    LexiconUnit,
    compounds,
    label_words,
    meanings,
    shortened,
    spelled,
    unit_words,
)

NUMBER, DOTTED, WORD, UNIT, DIMENSION, JOIN, OPEN, CLOSE, BREAK, COMMA, COLON, DASH, DOT, TIME, OTHER, END = range(16)

LONGEST_NUMBER = 24
"""Characters of a number beyond which it measures nothing."""

_VULGAR = {
    "¼": (1, 4), "½": (1, 2), "¾": (3, 4), "⅐": (1, 7), "⅑": (1, 9), "⅒": (1, 10), "⅓": (1, 3), "⅔": (2, 3),
    "⅕": (1, 5), "⅖": (2, 5), "⅗": (3, 5), "⅘": (4, 5), "⅙": (1, 6), "⅚": (5, 6), "⅛": (1, 8), "⅜": (3, 8),
    "⅝": (5, 8), "⅞": (7, 8),
}  # fmt: skip
_V = "".join(_VULGAR)
_BLANK = "[ \t\u00a0\u2009\u202f]"
# The pattern's groups: a word; a date; a time of day or a scale; a number with a fraction; a fraction; a number; one
# that begins with its decimal mark; a vulgar fraction; a mark of inches or feet; a line break; any other character.
_WORD, _DATE, _CLOCK, _MIXED_NUMBER, _FRACTION, _DECIMAL, _DOTTED, _VULGAR_ALONE, _QUOTE, _BREAK, _MARK = range(1, 12)
_TOKEN = re.compile(
    rf"[ \t\u00a0]*+(?:([^\W\d_{_V}]+|[⌀㎝✕✖])"
    rf"|(?=\d)(?:(\d{{1,2}}/\d{{1,2}}/\d{{2,4}}(?!\d))"
    rf"|(\d{{1,3}}:\d{{1,4}}(?::\d\d)?(?![\d./]|{_BLANK}{{0,3}}[x×\d]))"
    rf"|(\d[\d,]*(?:{_BLANK}{{0,3}}-{_BLANK}{{0,3}}|{_BLANK}{{1,3}})\d+{_BLANK}?[/⁄∕]{_BLANK}?\d+(?!/|\d)"
    rf"|\d[\d,]*{_BLANK}{{0,3}}-?{_BLANK}{{0,3}}[{_V}])"
    rf"|(\d+{_BLANK}?[/⁄∕]{_BLANK}?\d+(?!/|\d))"
    rf"|(\d+(?:[.,]\d+)*(?:[eE][+-]?\d+)?))"
    rf"|((?<![^\W\d_])\.\d+)"  # not the 17 of "diam.17"
    rf"|([{_V}])"
    rf"|(''|’’|‘‘|′′|[\"“”″'’‘′])"
    rf"|([\r\n;\u2028\u2029]+)"
    rf"|(\S))",
)
# Full-width letters, digits and marks; letters that are alike.
_ALIKE = {code: code - 0xFEE0 for code in range(0xFF01, 0xFF5F)} | {0x3000: 0x20, 0xFF0E: 0x2E}
_ALIKE |= ALIKE | {ord("∅"): ord("Ø")}
_ALIKE[0xB1] = _ALIKE[0x2248] = 0x20
# The digits and marks of Arabic and Persian, and the digits of Thai.
_ALIKE |= {zero + n: 0x30 + n for zero in (0x660, 0x6F0, 0xE50) for n in range(10)}
_ALIKE |= {0x66B: ord("."), 0x66C: ord(","), 0x60C: ord(","), 0x61B: ord(";")}
_EXTREMES = "max|maximum|maxi|maximal|min|minimum|overall|greatest|total|approx|ca"
# Each as long as what it replaces, so that the places of all characters stay.
_SAME_LENGTH = (
    (re.compile(r"(?i)\bw/o\b"), "sem"),
    (re.compile(r"(?i)\bw/(?=[ (]|base|frame|mount|lid|stand)"), "cu"),
    (re.compile(r"(?i)(?<![^\W_])c/(?=[ (]?[^\W\d_])"), "cu"),
    # víkem, podstavcem ...: Czech and Russian "with" is a letter that elsewhere is an English s or a label.
    (re.compile(r"(?i)(?<![^\W_])[sс](?= (?:ví[kč]|podstav|rám|sokl|подстав|крышк|рам|основан))"), "z"),
    (re.compile(r"(?i)(?<![^\W_])s/(?=[ (]?[^\W\d_])"), "ss"),
    (re.compile(r"(?:(?<=[^\W\d_]{3} )|(?<=[^\W\d_]{3}: ))c\.(?=\s*\d)"), "ca"),  # weight c. 150 kg
    (re.compile(r"(?i)\bgr\.(?=\s*(?:H|Br?|T|Dm|D|L|Höhe|Breite|Tiefe|Länge|Durchmesser)\b)"), "max"),
    (re.compile(rf"(?i)(?<=[^\W\d_]),(?=\s*(?:{_EXTREMES})\b[.:\s]*\d)"), " "),  # Height, max.: 31 cm
    (re.compile(rf"(?i)(?<=[^\W\d_]\.),(?=\s*(?:{_EXTREMES})\b[.:\s]*\d)"), " "),
    (re.compile(r"(?:(?<=\d/\d)|(?<=\d/\d\d)) / (?=\d)"), " x "),  # 5 1/2 / 3 1/4 in.
    (re.compile(r"(?i)\b(?:por|sur|per)(?=\s+\d)"), "x  "),  # 30 cm de alto por 20 de ancho
    (re.compile(r"(?i)(?:(?<=\bde )large\b|\blarge(?=\s+de\s+\d))"), "larg "),
    (re.compile(r"(?i)\bhors[ -]tout"), "horstout "),
    (re.compile(r"(?i)(?<![^\W_])[dln]['’](?=[^\W\d_]{2})"), "  "),  # l'ouverture, d'épaules
    # What a list begins its entries with: "• Maße: o Tiefe: 17,2 cm o Breite: 29,4 cm"
    (re.compile(r"[•‣▪●◦](?=\s*[^\W\d_])"), ";"),
    (re.compile(r"(?<=\s)o(?=\s+[^\W\d_]{3,}\s*:)"), ";"),
    # Of a seated figure the face is a part, where a mask is all; 〔台座〕 is a heading of what follows.
    (re.compile(r"面(?=[幅奥長].*膝張)", re.DOTALL), "顔"),
    (re.compile(r"(?<=[〕】]);"), " "),
    (re.compile(r"[〔【]"), " "),
    (re.compile(r"[〕】]"), ":"),
    (re.compile(r"(?i)(?<=\d)( ?)st(?=\.? ?\d+(?:\.\d+)? ?lbs?\b)"), r"\1ſt"),  # 12 st 4 lb
    # U: 218 G: 98 Y: 112: what a colon stands behind is a label, though it is a unit too.
    (re.compile(r"(?i)(?<=\d) (?=[gmt]\s?[:=]\s?\d)"), ";"),
    # A garment hangs as high as it is long: Length at CB: 52 in.; Length: 145cm nape to hem
    (re.compile(r"(?i)\blength(?= (?:at |of )?(?:c\.?[bf]\b|cent(?:er|re) (?:back|front)))"), "height"),
    (
        re.compile(
            r"(?i)\blength(?=[:.]? ?\d{1,4}(?:[.,]\d{1,3}| \d{1,2}/\d{1,2}|[½¼¾])? ?(?:cm|mm|in\b|\")"
            r"[^;\n\d]{0,25}\bto (?:the )?(?:hem|waist|floor)\b)"
        ),
        "height",
    ),
    # What is measured so is the whole, and no handle: W. handle to handle 12 in.
    (re.compile(r"(?i)\bhandle to handle\b"), "across across   "),
    (re.compile(r"(?i)\bhandle to spout\b"), "across across  "),
    (re.compile(r"(?<=\d)\+(?=\s*(?:[x×]|[cm]m\b|in\b|$))"), " "),  # 45+ x 20 cm: what is left of it
)
_OTHER_STATE = re.compile(
    rf"{_BLANK}?\((?=[^()]*\d)(?=[^()]*\b(?:open|opened|unfolded|extended|wings|leaves|offen|geöffnet|aufgeklappt|ouvert|"
    r"ouverte|ouverts|déplié|aperto|aperta|aperti|abierto|abierta|aberto|aberta|ανοιχτ\w*)\b)[^()]{1,40}\)"
    r"(?=\s*[x×])",
    re.IGNORECASE,
)
"""What a thing measures in another state, in the middle of its sizes: "320 x 240 (open 460) x 42 cm"."""
_COLONS = re.compile(r"(?<![\d:.,])\d+(?:[.,]\d+)?(?: ?: ?\d+(?:[.,]\d+)?){1,2}(?= ?[cm]m\b)")
"""Sizes with colons between them, "185:128:54 cm"; 1:10 is a scale."""
_LABELS_IN_BRACKETS = re.compile(r"\A\s*[\[(][^\W\d_]{1,10}\.?[\])]\s*\d")
"""A text that begins so, "[H] 45 [W] 20 cm", has each label before its number."""
_IN_BRACKETS = re.compile(r"[\[(]([^\W\d_]{1,10}\.?)[\])](?=\s*\d)")
_LISTED = re.compile(r"(?:\A|(?<=[;\n]))\s*\(?([a-h])[:.)](?=\s*\d+(?:[.,]\d+)?\s*[x×])", re.IGNORECASE)
"""What a list of things begins an entry with: "a: 45 x 20 cm; b: 44 x 20 cm"."""
_THOUSANDS = re.compile(
    rf"(?<![\d.,/'’])([1-9]\d?){_BLANK}(\d{{3}})"
    rf"(?=(?:[.,]\d+)?(?:\s*[x×]\s*[\d.,]+(?:{_BLANK}\d{{3}})?){{0,2}}\s*(?:mm|kg|g)\b)"
)
"""1 250 x 800 mm; behind a word that is no label, "vase 1 250 mm", it is two numbers."""
_SIZE = r"\d{1,4}(?:[.,]\d{1,2})?"
_SLASHED = re.compile(
    rf"(?<![\d/.,])(?<!\d{_BLANK}){_SIZE}(?:{_BLANK}?/{_BLANK}?{_SIZE}){{1,3}}"
    rf"(?={_BLANK}?(?P<unit>cm\b|mm\b|m\b(?!\.)|in(?:ch(?:es)?)?\b|[\"”″]|x{_BLANK}?\d))"
    rf"(?=(?P<beside>(?:{_BLANK}?x{_BLANK}?{_SIZE}){{1,2}}{_BLANK}?(?:[cm]m\b|in\b|inch|[\"”″]))?)",
    re.IGNORECASE,
)
"""Sizes with strokes between them, "40/30 cm", or numbers with fractions, "3/4 cm", "11/5/8 in."."""
_BEFORE = re.compile(r"(?:[/x×]\s?)?\b([^\W\d_]+)[.:\s]*\Z")
"""The word before a size, with what joins it to another."""
_PARTS = frozenset({"2", "3", "4", "5", "8"})
"""What a fraction of a metric unit has below its stroke."""
_HALVED = frozenset({"2", "4", "8", "16", "32", "64"})
"""The same of inches."""
_IN_INCHES = _HALVED | {"3", "5", "6", "10", "12", "20", "100"}
"""What a fraction of an inch may have there at all: 30/40 is none."""
FINEST = 100
"""Largest number that stands below the stroke of a fraction."""
_EXTREME = re.compile(r"(\w{1,4})(max|min)")
"""A label and its qualifier in one word: Dmax, Hmin."""
_CUT = re.compile(r"\.:?\s*\d")
"""What stands behind a word that is cut short before its number: "lev. 61 cm"."""
_MIXED = re.compile(rf"(\d[\d,]*)[^\d{_V}]*(?:(\d+)\D+(\d+)|([{_V}]))")
_MARKS = {
    "(": OPEN, "[": OPEN, "{": OPEN, "（": OPEN, "［": OPEN, ")": CLOSE, "]": CLOSE, "}": CLOSE, "）": CLOSE,
    "］": CLOSE, ",": COMMA, "、": COMMA, "，": COMMA, ":": COLON, "：": COLON, "=": COLON, "-": DASH, "–": DASH,
    "—": DASH, "~": DASH, "〜": DASH, "～": DASH, ".": DOT, "；": BREAK, "。": BREAK, "*": JOIN, "×": JOIN,
    "✕": JOIN, "✖": JOIN,
}  # fmt: skip


class Token(NamedTuple):
    """A piece of the text: its type, its characters, and what they mean.

    Attributes
    ----------
    type : int
        One of the types of this module.
    start, end : int
        Its characters.
    word : str
        In small letters.
    meaning : (str, str) or None
        Of a word its (kind, meaning) of the table, or None where it is not known.
    unit : Unit or None
        The unit that it is, if it stands behind a number.
    num, den : int
        The value of a number, exactly.
    """

    type: int
    start: int
    end: int
    word: str = ""
    meaning: tuple[str, str] | None = None
    unit: LexiconUnit | None = None
    num: int = 0
    den: int = 1


def tokens_of(text: str, decimal: str) -> list[Token]:
    """Return the tokens of a text, closed by an END.

    Parameters
    ----------
    text : str
        Any text.
    decimal : {".", ","}
        The mark that separates decimals where a number leaves it open.

    Returns
    -------
    list of Token
        In the order of the text.
    """
    out: list[Token] = []
    text = _plain(text)
    known, by_word, several = meanings(), unit_words(), compounds()
    new = tuple.__new__  # a NamedTuple's own constructor takes twice as long, and a text has fifty tokens
    for match in _TOKEN.finditer(text):
        group = match.lastindex or 0
        start, end = match.span(group)
        word = match.group(group)
        if group == _WORD:
            word = word.lower()
            if word[-1] == "x" and word[:-1] in by_word:  # 10 cmx 12 cm
                out.append(_word(word[:-1], start, end - 1, known, by_word))
                word, start = "x", end - 1
            if word in several:
                out += [_word(one, start, end, known, by_word) for one in several[word]]
            elif (extreme := _EXTREME.fullmatch(word)) and word not in known and extreme[1] in label_words():
                middle = start + extreme.end(1)
                out.append(_word(extreme[1], start, middle, known, by_word))
                out.append(_word(extreme[2], middle, end, known, by_word))
            elif "x" in word and word not in known and _is_legend(word):
                out += _legend(word, start, known, by_word)
            elif word not in known and word not in by_word and _CUT.match(text, end) and (said := shortened(word)):
                out.append(Token(DIMENSION, start, end, word, said))
            else:
                out.append(_word(word, start, end, known, by_word))
        elif _CLOCK < group < _QUOTE:
            value = number_value(word, group, decimal)
            if value is None:
                out.append(Token(OTHER, start, end, word))
            else:
                out.append(new(Token, (DOTTED if group == _DOTTED else NUMBER, start, end, word, None, None, *value)))
        elif group == _QUOTE:
            out.append(new(Token, (UNIT, start, end, word, None, by_word[word], 0, 1)))
        elif group == _MARK:
            out.append(new(Token, (_MARKS.get(word, OTHER), start, end, word, None, None, 0, 1)))
        else:
            out.append(Token(BREAK if group == _BREAK else TIME, start, end, word))
    out.append(Token(END, len(text), len(text)))
    return out


def _plain(text: str) -> str:
    """Return a text as long as before, with one character for each way to write it, and in words what is in marks."""
    text = text.translate(_ALIKE)
    if not text.isascii():
        marked, plain = spelled()
        text = marked.sub(lambda found: _respelled(found, plain), text)
    for pattern, words in _SAME_LENGTH:
        text = pattern.sub(words, text)
    if "(" in text:
        text = _OTHER_STATE.sub(lambda found: " " * len(found[0]), text)
    if ":" in text:
        text = _COLONS.sub(_unscaled, text)
    if _LABELS_IN_BRACKETS.match(text):
        text = _IN_BRACKETS.sub(lambda found: f" {found[1]} ", text)
    listed = "".join(_LISTED.findall(text)).lower()
    if len(listed) > 1 and "abcdefgh".startswith(listed):
        text = _LISTED.sub(lambda found: " " * len(found[0]), text)
    text = _THOUSANDS.sub(_joined, text)
    return _SLASHED.sub(_parted, text) if "/" in text else text


def _respelled(found: re.Match[str], plain: Mapping[str, str]) -> str:
    """Return the plain word for one with marks in it, where it is no end of a longer one."""
    word: str = found[0]
    return word if found.string[max(found.start() - 1, 0) : found.start()].isalpha() else plain.get(word.lower(), word)


def _unscaled(sizes: re.Match[str]) -> str:
    return sizes[0] if sizes[0].startswith(("1:", "1 :")) else sizes[0].replace(":", "x")


def _joined(parted: re.Match[str]) -> str:
    """Return thousands without their blank, as long as before."""
    before = _BEFORE.search(parted.string, 0, parted.start())
    whole = before is None or before[1].lower() == "x" or _is_side(before[1].lower())
    return f" {parted[1]}{parted[2]}" if whole else str(parted[0])


def _parted(slashed: re.Match[str]) -> str:
    """Return sizes that strokes part with an x between them, of one dimension with a dash; fractions as they are."""
    text: str = slashed[0]
    *before, above, below = (piece.strip() for piece in text.split("/"))
    unit = slashed["unit"].lower()
    beside = slashed["beside"] or ""
    metric = unit.endswith("m") or beside.lower().endswith("m")
    inches = unit.startswith("in") or bool(beside)
    whole = above.isdigit() and below.isdigit() and int(above) < int(below)
    if not before and inches and not metric and whole and below not in _IN_INCHES:
        metric = True  # 30/40 x 20 in. goes from 30 to 40
    if not before and (not metric or (whole and (above == "1" or below in _PARTS))):
        return text  # 3/4 cm; of inches also 71/2, which lost its blank
    if len(before) == 1 and not metric and whole and below in _HALVED and before[0].isdigit():
        return text.replace("/", " ", 1)  # 11/5/8 in. is met for 11 5/8
    if not (metric or inches):
        return text  # a date in quotes
    label = _BEFORE.search(slashed.string, 0, slashed.start())
    of_one = label is not None and _is_side(label[1].lower()) and not label[0].startswith(("/", "x", "×"))
    # "D. 10/12 cm", "30/40 x 20 cm": from one to the other.
    return text.replace("/", "-" if (of_one or bool(beside)) and not before else "x")


def _is_side(word: str) -> bool:
    return word in label_words() or meanings().get(word, ("", ""))[0] == "dimension"


def _is_legend(word: str) -> bool:
    """Whether a word such as "hxbxt" or "lxlxh" is nothing but labels joined by x."""
    pieces = word.split("x")
    if not all(pieces) or not 2 <= len(pieces) <= 4 or (len(pieces) == 2 and "h" not in pieces):
        return False
    return all(piece in label_words() for piece in pieces)


def _legend(word: str, start: int, known: dict[str, tuple[str, str]], by_word: dict[str, LexiconUnit]) -> list[Token]:
    """Return the labels of a legend and the joins between them."""
    out: list[Token] = []
    for piece in word.split("x"):
        if out:
            out.append(Token(JOIN, start, start + 1, "x"))
            start += 1
        out.append(_word(piece, start, start + len(piece), known, by_word))
        start += len(piece)
    return out


def _word(word: str, start: int, end: int, known: dict[str, tuple[str, str]], by_word: dict[str, LexiconUnit]) -> Token:
    meaning = known.get(word)
    unit = by_word.get(word)
    if meaning is not None:
        if meaning[0] == "dimension":
            return Token(DIMENSION, start, end, word, meaning, unit)
        if meaning[0] == "join":
            return Token(JOIN, start, end, word)
        return Token(WORD, start, end, word, meaning, unit)
    return Token(UNIT if unit else WORD, start, end, word, None, unit)


@lru_cache(maxsize=4096)
def number_value(text: str, group: int, decimal: str) -> tuple[int, int] | None:
    """Return a number's value as a fraction of two whole numbers.

    Parameters
    ----------
    text : str
        The characters that a group of the pattern matched.
    group : int
        Which group.
    decimal : {".", ","}
        The mark that separates decimals where the number leaves it open.

    Returns
    -------
    (int, int) or None
        None where it is too long or divides by zero.
    """
    if len(text) > LONGEST_NUMBER or "e" in text.lower():  # nobody measures 1e400 in.
        return None
    if group in (_DECIMAL, _DOTTED):
        return _decimal(text, decimal)
    if group == _VULGAR_ALONE:
        return _VULGAR[text]
    if group == _FRACTION:
        part, whole = map(int, re.split(r"\D+", text))
        # Nothing is divided into more than a hundred: "W 240/460" is from one to the other, and not half a centimetre.
        return (part, whole) if 0 < whole <= FINEST else None
    match = _MIXED.match(text)
    if match is None:
        return None
    units, above, below, vulgar = match.groups()
    num, den = _VULGAR[vulgar] if vulgar else (int(above), int(below))
    return (int(units.replace(",", "")) * den + num, den) if den else None


def _decimal(text: str, decimal: str) -> tuple[int, int] | None:
    """Return a number's value; groups of three behind the other mark are thousands, anything else are decimals.

    None for a list such as 10,12,14, which is neither.
    """
    if text.isdigit():
        return int(text), 1
    last = max(text.rfind("."), text.rfind(","))
    mark = text[last]
    tail = len(text) - last - 1
    digits = text.replace(".", "").replace(",", "")
    groups = re.split("[.,]", text)
    if len(groups) > 2 and any(len(group) != 3 for group in groups[1 : None if text.count(mark) > 1 else -1]):
        return None
    if text.count(mark) > 1 or (mark != decimal and tail == 3 and last > 0 and text[0] != "0"):
        return int(digits), 1
    return int(digits), 10**tail
