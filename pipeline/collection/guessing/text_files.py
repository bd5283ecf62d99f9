"""How a text file is written: encoding, delimiter, and which of its rows name the columns."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import islice
from statistics import median
from unicodedata import category

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.lexicon import meanings
from pipeline.collection.guessing.columns import NUMBER, candidates, columns_of
from pipeline.collection.guessing.names import LENGTH, TEXTS, named, outright
from pipeline.collection.record import units_of
from pipeline.collection.sources.cards import LABELLED
from pipeline.collection.sources.delimited import cut_at
from pipeline.collection.sources.heads import is_of_units, joined_heads
from pipeline.tables import table
from pipeline.tables.word_lists import names_of_things

LOOKED_AT = 40
"""Rows at the beginning among which the header is looked for."""

_DELIMITERS = ";,\t|"
_SINGLE = ("cp1252", "mac-roman", "cp1250", "cp850")
_DOUBLE = ("shift-jis", "euc-jp")
_SPOKEN = ("cp1250", "iso8859-2", "cp1251", "cp1253", "cp1254", "gb18030", "euc-kr")
"""Encodings of languages whose letters are others elsewhere, told by known words alone."""
_LETTERS = re.compile(r"[^\W\d_]{2,}")
# Letters of the eight languages beyond ASCII, and the signs that texts of museums have.
_COMMON = frozenset("äöüßàâæçéèêëîïôœùûÿìíòóúñáãõășțşţłøåÄÖÜÀÂÆÇÉÈÊËÎÏÔŒÙÛÌÍÒÓÚÑÁÃÕĂȘȚŞŢŁØÅ")
_SIGNS = frozenset("°ºª«»–—’‘“”„…©®²³½¼¾×±€£§·•¿¡\u00a0´")


def encoding_of(head: bytes) -> str:
    """Return the encoding of a text by its first bytes.

    What is no Unicode is read in each of the usual single-byte encodings; the one counts in which the most bytes
    beyond ASCII are letters of European languages in the midst of words, unless more of those words are known in an
    encoding of Central Europe, of Cyrillic, Greek or Turkish.

    Parameters
    ----------
    head : bytes
        How the file begins.

    Returns
    -------
    str
        As [source] encoding has it.
    """
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if head[1::2].count(0) > 0.4 * len(head) / 2 and not head[::2].count(0):
        return "utf-16"
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as problem:
        if problem.start < len(head) - 4:
            japanese = [name for name in _DOUBLE if _kana(head, name) > 0.1]
            likely = (
                max(japanese, key=lambda name: _kana(head, name))
                if japanese
                else max(_SINGLE, key=lambda name: _likeness(head, name))
            )
            return max((likely, *_SPOKEN), key=lambda name: _known_words(head, name))
    return "utf-8"


def _known_words(head: bytes, encoding: str) -> int:
    """Return how many of the words with letters beyond ASCII are known, of columns, of dimensions or of things."""
    words = _LETTERS.findall(head.decode(encoding, "replace").casefold())
    return sum(not word.isascii() and word in _vocabulary() for word in words)


@cache
def _vocabulary() -> frozenset[str]:
    texts = (name for row in table("column_names") for name in row["names"].split("|"))
    things = (word for _, word in names_of_things())
    words = {word for text in (*texts, *things) for word in _LETTERS.findall(text.casefold())}
    return frozenset(word for word in words | meanings().keys() if not word.isascii())


def _likeness(head: bytes, encoding: str) -> float:
    text = head.decode(encoding, "replace")
    score = 0.0
    for at, sign in enumerate(text):
        if sign < "\x80":
            continue
        before, after = text[at - 1 : at], text[at + 1 : at + 2]
        in_word = before.isalpha() or after.isalpha()
        if sign in "ãă":
            # One byte in two encodings: ã stands before o and e (Portuguese), ă elsewhere (Romanian).
            score += 1.0 if (after in ("o", "e")) == (sign == "ã") else 0.2
        elif sign in _COMMON:
            # A capital within a word is hardly one; a letter by itself, as between two numbers, neither.
            wrong = not in_word and sign not in "ØøàÀ"
            score += -1.0 if wrong or (sign.isupper() and before.islower()) else 1.0
        elif sign in _SIGNS:
            score += 0.5 if sign in "’´" or not (before.isalpha() and after.isalpha()) else -0.5
        else:
            score -= 1.0
    return score


def _kana(head: bytes, encoding: str) -> float:
    """Share of the characters beyond ASCII that are Japanese, if all can be read."""
    try:
        text = head[: len(head) - 3].decode(encoding)
    except UnicodeDecodeError as problem:
        if problem.start < len(head) - 8:
            return 0.0
        text = head[: problem.start].decode(encoding)
    beyond = [sign for sign in text if sign >= "\x80"]
    kana = sum("\u3040" <= sign <= "\u30ff" or "\u4e00" <= sign <= "\u9fff" for sign in beyond)
    half = sum("\uff61" <= sign <= "\uff9f" or category(sign) in ("Co", "Cn") for sign in beyond)
    return (kana - 2 * half) / len(beyond) if beyond else 0.0


_CUT_NUMBER = re.compile(r"\d,\d")


def delimiter_of(text: str) -> str:
    """Return what parts the cells of a text: where most rows have as many cells, and the most cells.

    Parameters
    ----------
    text : str
        How the file begins.

    Returns
    -------
    str
        One character.
    """

    def regular(delimiter: str) -> tuple[float, int]:
        widths = [len(row) for _, row in first_lines(text, delimiter, 400)[:-1] or first_lines(text, delimiter, 400)]
        if not widths:
            return 0.0, 0
        width, times = Counter(widths).most_common(1)[0]
        # "H 23,5 cm" is cut by no comma where another sign parts the cells.
        cut = len(_CUT_NUMBER.findall(text)) // max(1, len(widths)) if delimiter == "," else 0
        return (times / len(widths), width - cut) if width > 1 else (0.0, 0)

    return max(_DELIMITERS, key=regular)


_RULE = re.compile(r"[-=_]{2,}")
_WIDEST = 2000
"""Characters of a line of a printed list."""
_SEEN, _LEAST = 200, 3
"""Lines from which it is told where cells begin, and how many of them and of their columns there must be."""


def starts_of(text: str) -> tuple[int, ...]:
    """Return at which characters of each line, from 1 on, the cells of a printed list begin; () of any other text.

    A line of dashes below the head tells it, or else the places that are blank in all lines.

    Parameters
    ----------
    text : str
        How the file begins.
    """
    lines = [line.rstrip() for line in text.lstrip("\ufeff").splitlines()[:_SEEN] if line.strip()]
    if len(lines) <= _LEAST or any("\t" in line or len(line) > _WIDEST for line in lines):
        return ()
    rule = next((line for line in lines if not line.strip(" -=_+|")), "")
    told = [found.start() + 1 for found in _RULE.finditer(rule)]
    if len(told) >= _LEAST:
        return (1, *told[1:])
    width = max(map(len, lines))
    filled = [sum(at < len(line) and line[at] != " " for line in lines) for at in range(width)]
    begun = [1, *(at + 1 for at in range(1, width) if filled[at] and not filled[at - 1])]
    # What stands in one line alone, or beyond a short head, is a longer text and no column.
    head = lines[0]
    begun = [at for at in begun if at == 1 or (at <= len(head) and head[at - 1] != " " and head[at - 2] == " ")]
    return tuple(begun) if len(begun) >= _LEAST else ()


_AGAIN, _OF_LINES = 2, 0.6
"""How often each of three labels must come, and what share of the lines labels must begin (judgement)."""


def first_label(text: str) -> str:
    """Return the label with which each record begins of a text of labelled lines; "" of any other text.

    Parameters
    ----------
    text : str
        How the file begins.
    """
    lines = [line for line in text.lstrip("\ufeff").splitlines()[:-1] or text.splitlines() if line.strip()]
    found = [match for line in lines if (match := LABELLED.fullmatch(line.rstrip())) is not None]
    often = Counter(" ".join(match[1].split()) for match in found)
    labels = [label for label, times in often.items() if times >= _AGAIN]
    if len(labels) < _LEAST or sum(often[label] for label in labels) < _OF_LINES * len(lines):
        return ""
    known = {what.field for label in labels if (what := named(label)) is not None}
    # A record begins with what comes most often and first, which is its number or its name.
    most = max(often[label] for label in labels)
    first = next(label for label in labels if often[label] == most)
    # No record begins with a size: those are lines within the cells of a table.
    sized = (what := named(first)) is not None and (what.field in (TEXTS, LENGTH) or bool(units_of(what.field)))
    return first if len(known) >= _LEAST and not sized else ""


def first_lines(text: str, delimiter: str | tuple[int, ...], most: int) -> list[tuple[int, list[str]]]:
    """Return the first rows of a text that are not blank, with the line where each begins.

    Parameters
    ----------
    text : str
        How the file begins.
    delimiter : str or tuple of int
        Between two cells, or where cells begin.
    most : int
        Rows.

    Returns
    -------
    list of (int, list of str)
        Until one that cannot be read.
    """
    lines = text.lstrip("\ufeff").splitlines(keepends=True)
    if not isinstance(delimiter, str):
        cut = ((number, cut_at(delimiter, line)) for number, line in enumerate(lines, start=1))
        return list(islice(((number, cells) for number, cells in cut if any(cells)), most))
    reader = csv.reader(lines, delimiter=delimiter)
    out = []
    before = 0
    try:
        for row in islice(reader, most):
            if any(map(str.strip, row)):
                out.append((before + 1, row))
            before = reader.line_num
    except csv.Error:
        pass
    return out


_DIGITS = re.compile(r"\d+")


def is_sideways(rows: Sequence[tuple[int, list[str]]]) -> bool:
    """Say whether a table has its fields below each other and its objects side by side.

    That is where its first column names the objects' numbers and other fields, each once, and no row does.

    Parameters
    ----------
    rows : sequence of (int, list of str)
        As of `table_head`.
    """
    first = [cells[0].strip() for _, cells in rows if cells and cells[0].strip()]
    if len(set(first)) < len(first) or len(first) < _FEWEST_FIELDS:
        return False
    known = [meant.field for name in first if len(name) <= _LONGEST and (meant := named(name)) is not None]
    if "object_number" not in known or len(set(known)) < _FEWEST_FIELDS or len(known) < _MOST_OF * len(first):
        return False

    def across(cells: Sequence[str]) -> int:
        return len({what.field for cell in cells if len(cell) <= _LONGEST and (what := named(cell)) is not None})

    return all(across(cells) < _FEWEST_FIELDS for _, cells in rows)


_LONGEST = 80
"""Characters of the name of a field."""
_FEWEST_FIELDS, _MOST_OF = 3, 0.5
"""Fields that a first column must name, and what share of its texts must name some (judgement)."""


@dataclass(frozen=True)
class Head:
    """Where the columns of a table are named.

    Attributes
    ----------
    row : int
        The first row (or line) of their names; 0 where the first row that says anything is an object.
    rows : int
        How many rows name them together.
    known : int
        How many fields the names tell.
    """

    row: int
    rows: int
    known: int


def table_head(rows: Sequence[tuple[int, list[str]]]) -> Head:
    """Return where the names of columns stand: where they tell the most fields, else where the table begins.

    Parameters
    ----------
    rows : sequence of (int, list of str)
        The first rows of a table, each with its number; blank ones left out.

    Returns
    -------
    Head
        Row 1 of a table that shows none.
    """
    best: Head | None = None
    first = _first_object(rows)
    for at, (number, cells) in enumerate(rows[:first]):
        numbers = sum(bool(NUMBER.fullmatch(cell.strip())) for cell in cells)
        if sum(bool(cell.strip()) for cell in cells) < 2 or numbers > 0.2 * len(cells):
            continue
        for many in (1, 2, 3):
            taken = [row for _, row in rows[at : at + many]]
            if len(taken) < many or len(rows) <= at + many:
                continue
            below = [row for _, row in rows[at + many : at + many + 20]]
            # The rows of a head follow each other, and none of them is like those of the table.
            if many > 1 and (rows[at + many - 1][0] - number != many - 1 or _of_table(taken[-1], below)):
                break
            names = joined_heads(taken) if many > 1 else cells
            known = len(candidates(columns_of(names, below)))
            # An object may name a field in its cells, "height" or "Hall"; names of columns are no numbers.
            if best is None or known > best.known + numbers:
                best = Head(number, many, known)
    if best is not None and best.known > 1:
        at = next(at for at, (number, _) in enumerate(rows) if number == best.row) + best.rows
        # "cm" and "kg" below the names.
        more = at < len(rows) and rows[at][0] == best.row + best.rows and is_of_units(rows[at][1])
        return replace(best, rows=best.rows + more)
    known = 0 if best is None else best.known
    widths = [sum(bool(cell.strip()) for cell in cells) for _, cells in rows[:LOOKED_AT]]
    widest = max(widths, default=0)
    for (number, cells), width in zip(rows[:first], widths, strict=False):
        if width == widest > 1 and not _numbered(cells):
            return Head(number, 1, known)
    if first < len(widths) and all(width < _FULL * widths[first] for width in widths[:first]):
        return Head(0, 1, 0)
    return Head(rows[0][0] if rows else 1, 1, 0)


_FULL, _LIKE, _COMPARED = 0.8, 2, 40
"""Share of the cells of the rows below that an object fills at least, how many of its cells must be written as those
below them, and with how many rows it is compared (judgement)."""

_LETTERED = re.compile(r"[^\W\d_]+")


def _first_object(rows: Sequence[tuple[int, list[str]]]) -> int:
    """Return the index of the first row that is an object and names no columns, for those below are written as it is.

    `LOOKED_AT` where none of the first rows is one.
    """
    for at, (_, cells) in enumerate(rows[:LOOKED_AT]):
        below = [row for _, row in rows[at + 1 : at + 1 + _COMPARED]]
        filled = sum(bool(cell.strip()) for cell in cells)
        usual = median(sum(bool(cell.strip()) for cell in row) for row in below) if len(below) >= _LIKE else 0
        if filled < max(_FULL * usual, 2):
            continue
        if usual and cells not in below and _is_object(cells, below):
            return at
    return LOOKED_AT


def _is_object(cells: Sequence[str], below: Sequence[Sequence[str]]) -> bool:
    """Whether more cells are like those below them than name fields: 1921.7 above 1950.112, 12 cm above 9 cm, a room.

    What comes again below is no name of a column.
    """
    alike = known = 0
    for place, cell in enumerate(cell.strip() for cell in cells):
        under = [row[place].strip() for row in below if place < len(row) and row[place].strip()]
        if not cell or len(under) < _LIKE:
            continue
        if any(map(str.isdigit, cell)):
            same = sum(map(_shape(cell).__eq__, map(_shape, under))) >= _SAME * len(under)
            alike += same or (_measures(cell) and sum(map(_measures, under)) >= _SAME * len(under))
        else:
            # A name that stands twice may be merged over two rows of a head.
            name = len(cell) <= _LONGEST and outright(cell)
            alike += cell in under and not name
            known += name and cell not in under
    return alike >= max(_LIKE, known + 1)


def _measures(text: str) -> bool:
    return len(text) <= _LONGEST_SIZES and any(part.unit for part in parse(text).parts)


_LONGEST_SIZES = 300
_SAME = 0.3
"""Share of the texts of a column that must be written as the one above them (judgement)."""


def _shape(text: str) -> str:
    return _LETTERED.sub("a", _DIGITS.sub("0", text.strip()))


def _of_table(cells: Sequence[str], below: Sequence[Sequence[str]]) -> bool:
    """Whether a row holds numbers, texts that come again below, or such as "Inv. 12" where "Inv. 13" follows."""
    if _numbered(cells):
        return True
    for place, cell in enumerate(cells):
        texts = {row[place].strip() for row in below if place < len(row)} - {""}
        shape = _DIGITS.sub("0", cell.strip())
        if cell.strip() in texts or ("0" in shape and shape in {_DIGITS.sub("0", text) for text in texts}):
            return True
    return False


def _numbered(cells: Sequence[str]) -> bool:
    return any(NUMBER.fullmatch(cell.strip()) for cell in cells)
