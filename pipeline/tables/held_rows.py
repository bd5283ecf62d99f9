"""Rows of held_words.csv: how a thing is held and what it stands on, by the words that museums have for its display."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Annotated

from pydantic import BeforeValidator

from pipeline.records import Anchorage, Furniture, Hanging, Mount, Support
from pipeline.tables import table
from pipeline.tables.rows import BUT_NOT, SOME_WORDS, UNSEEN, Entries, TableRow, Text, checked

CASES = (
    *(
        "case",
        "cases",
        "S/C",
        "sh",
        "Schrank",
        "kast",
        "Vit",
        "Vitr",
        "προθ",
        "ケース",
        "armoire",
        "armadio",
        "armario",
        "armário",
        "dolap",
    ),
    *("skab", "skåp", "skap", "kaappi", "szafa", "шкаф", "skříň", "ormar", "dulap", "szekrény", "ντουλάπα", "armari"),
)
"""Words that name a case where a number follows them, or in a field for cases: else they may be of furniture."""

_BREAKS = ",;，、；"
"""What parts the pieces of a text, one of which may be a word alone: "floor, not fixed"."""

_STEM = r"\w{0,10}"
"""What ~ stands for in these words: the ending of a stem, or what is written together with it."""

_PAIR = " + "

_NOT_BEHIND = re.compile(
    r"\s*(?:değil|(?:され|し)てい(?:な|ませ)|されず|せず|なし|안|(?:되|하)?(?:어|여)? ?있지|(?:되|하)?지 ?않|없"
    r"|نشده|نیست|nincs|missing)",
    re.IGNORECASE,
)
"""Behind what is not done, in languages that deny there."""

_NOT_WITHIN = re.compile(r"m[ae]m[ıi]ş|[ae]tl[ae]n\b", re.IGNORECASE)
"""In a stem's ending that denies it: sabitlenmemiş, rögzítetlen."""

_WALL_CASE = re.compile(
    r"wall[ -](?:show)?case|Wandvitrine|vitrine murale|vetrina (?:a muro|a parete|murale)|vitrina (?:de pared|mural)"
    r"|壁面(?:展示)?ケース|壁付?き?ケース|壁柜|壁櫃|벽부장|벽면 ?진열장",
    re.IGNORECASE,
)
"""A case on or in a wall: what is in it does not hang on that."""
_NUMBERED = re.compile(rf"(?<!\w)(?:{'|'.join(CASES)})\s?(?:no\.?|nr\.?|n°)?\s?\d", re.IGNORECASE)
_ALONE = "judgement: a wall alone is what it hangs on"
_UNCASED = "judgement: what is shown in the open is in no case"
_ENCLOSED = (Furniture.SHOWCASE, Furniture.SHELF)

_NEAR = 40
"""Characters between two words that belong together."""

_REACHES = re.compile(r"to\b", re.IGNORECASE)
"""How words for the floor begin where a thing only reaches down to it."""

_PATTERNED = frozenset("~+/")
"""Signs of entries that are more than words and gaps between them."""

_NEVER = r"(?!)"
"""What matches nothing: the pattern of no words, which as an empty one would be found in every text."""

_JOINED = re.compile("[\u0e00-\u0eff\u2e80-\u30ff\u3400-\u9fff\uac00-\ud7af]")


def _nothing(cell: object) -> object:
    return None if cell == "" else cell


class HeldWords(TableRow):
    """A row of held_words.csv: what some words tell; what they leave open is empty.

    Attributes
    ----------
    words : tuple of str
        One of which stands in the text; * is up to three words, and = before one that it is the whole text, or a whole
        piece of it.  ~ is how a stem may go on or begin; a/b + c/d are one of the first and one of the others, in
        either order, near each other.
    support, hanging, furniture, anchorage, mount
        What they tell.
    source : str
        Who says so.
    """

    words: Entries
    support: Annotated[Support | None, BeforeValidator(_nothing)]
    hanging: Annotated[Hanging | None, BeforeValidator(_nothing)]
    furniture: Annotated[Furniture | None, BeforeValidator(_nothing)]
    anchorage: Annotated[Anchorage | None, BeforeValidator(_nothing)]
    mount: Annotated[Mount | None, BeforeValidator(_nothing)]
    source: Text


@dataclass(frozen=True, slots=True)
class HeldAs:
    """What a text tells of how a thing is displayed; None for what it leaves open."""

    support: Support | None = None
    hanging: Hanging | None = None
    furniture: Furniture | None = None
    anchorage: Anchorage | None = None
    mount: Mount | None = None


@dataclass(frozen=True, slots=True)
class _OneRow:
    """A row, ready to match: what finds its words, and what finds two that belong together, each with the first."""

    number: int
    row: HeldWords
    words: re.Pattern[str]
    pairs: tuple[tuple[tuple[str, ...], re.Pattern[str]], ...]

    def found(self, text: str) -> Iterator[re.Match[str]]:
        """Yield where the words of the row stand in a text."""
        # Most texts have none of them: to look for a part of each is cheap.
        if self.number in _perhaps(text):
            yield from self.words.finditer(text)
        folded = text.casefold() if self.pairs else ""
        for first, pattern in self.pairs:
            if any(one in folded for one in first):
                yield from pattern.finditer(text)

    def says(self, text: str) -> bool:
        """Whether a text says what the row tells; where it is not so, or only meant to be, nothing holds a thing."""
        holds = self.row.support in (Support.FASTENED, Support.HUNG, Support.SUSPENDED, Support.ISOLATED)
        return any(not (holds and _denied(text, one)) for one in self.found(text))

    def denies(self, text: str) -> bool:
        """Whether a text says that a thing is not made fast: "not bolted", "sabitlenmemiş"."""
        return self.row.support is Support.FASTENED and any(_denied(text, one) for one in self.found(text))


def _denied(text: str, said: re.Match[str]) -> bool:
    # Of two words that belong together the other one may be denied: "tegen de wand, niet verankerd".
    _, comma, between = said.group().rpartition(" ")[0].rpartition(",")
    return bool(
        BUT_NOT.search(text[: said.start()])
        or (comma and BUT_NOT.search(f"{between} "))
        or _NOT_BEHIND.match(text[said.end() :])
        or _NOT_WITHIN.search(said.group())
    )


@cache
def _rows() -> tuple[_OneRow, ...]:
    out: list[_OneRow] = []
    for row in checked(HeldWords, table("held_words"), "held_words.csv", named="words"):
        pairs = [word for word in row.words if _PAIR in word]
        alone = re.compile(_any([word for word in row.words if word not in pairs]), re.IGNORECASE)
        both = tuple((_first(word), re.compile(_both(word), re.IGNORECASE)) for word in pairs)
        out.append(_OneRow(len(out), row, alone, both))
    return tuple(out)


@cache
def _parts() -> Mapping[str, tuple[tuple[str, frozenset[int]], ...]]:
    """Return a part of every word that stands alone, with the rows it is of, by its first two letters."""
    of_rows: dict[str, set[int]] = {}
    for one in _rows():
        for word in one.row.words:
            if _PAIR not in word:
                for part in _first(_folded(word)):
                    of_rows.setdefault(part, set()).add(one.number)
    out: dict[str, list[tuple[str, frozenset[int]]]] = {}
    for part, rows in of_rows.items():
        out.setdefault(part[:2], []).append((part, frozenset(rows)))
    return {begins: tuple(some) for begins, some in out.items()}


@lru_cache(maxsize=256)
def _perhaps(text: str) -> frozenset[int]:
    """Return the rows of which a part of a word is in a text, where their words may be; those of others are not."""
    folded, parts = _folded(text), _parts()
    begins = {folded[at : at + length] for length in (0, 1, 2) for at in range(len(folded))} & parts.keys()
    return frozenset().union(*(rows for one in begins for part, rows in parts[one] if part in folded))


def _folded(text: str) -> str:
    """Return a text in which a word is wherever a pattern that ignores case finds it: to that each i is one."""
    return text.replace("ı", "i").replace("İ", "i").casefold()


def _any(words: Sequence[str]) -> str:
    alone = [re.escape(word[1:]) for word in words if word.startswith("=")]
    whole = [rf"(?:^|(?<=[{_BREAKS}]))\s*(?:{'|'.join(alone)})\s*(?=$|[{_BREAKS}])"] if alone else []
    some = [
        (word, re.escape(word).replace(r"\*", SOME_WORDS).replace(r"\~", _STEM)) for word in words if word[0] != "="
    ]
    # Chinese, Japanese and Korean part no words from each other; of the others one boundary is looked for, not each.
    joined = [inner for word, inner in some if _JOINED.search(word)]
    parted = [inner for word, inner in some if not _JOINED.search(word)]
    return "|".join((*whole, *joined, *([rf"(?<!\w)(?:{'|'.join(parted)})(?!\w)"] if parted else []))) or _NEVER


def _both(word: str) -> str:
    one, other = (f"(?:{_any(side.split('/'))})" for side in word.split(_PAIR))
    return rf"(?:{one}[^;]{{0,{_NEAR}}}?{other}|{other}[^;]{{0,{_NEAR}}}?{one})"


def _first(word: str) -> tuple[str, ...]:
    """Return the longest part of each of the words one of which must be there."""
    ones = word.split(_PAIR, maxsplit=1)[0].split("/")
    return tuple(max(re.split(r"[\s*=~]+", one), key=len).casefold() for one in ones)


def hangs_above(text: str) -> bool:
    """Whether a text tells from what a thing hangs above; of most titles no row need be asked, which costs 0.7 ms.

    A title that only says suspended is a name: Suspended Ball.
    """
    folded = text.casefold()
    if not any(word in folded for word in _above()):
        return False
    told = told_by(text)
    return told.support is Support.SUSPENDED and told.furniture is Furniture.RAIL


@cache
def _above() -> frozenset[str]:
    """Return the longest part of each of the words for hanging from above: without it the words are not there."""
    words = (word for told in _rows() if told.row.furniture is Furniture.RAIL for word in told.row.words)
    return frozenset(one for word in words for one in _first(word))


@lru_cache(maxsize=4096)
def told_by(text: str) -> HeldAs:
    """Return what a text tells of how a thing is displayed.

    Parameters
    ----------
    text : str
        In the museum's words.

    Returns
    -------
    HeldAs
        Of each thing that which the first row of the table says whose words are there.
    """
    text = _WALL_CASE.sub("showcase", UNSEEN.sub("", text.replace("\u200c", " ")))
    found = [told.row for told in _rows() if told.says(text)] if text.strip() else []
    if _NUMBERED.search(text) or any(row.furniture in _ENCLOSED for row in found):
        # "East, wall, case 3": what is in a case does not hang on the wall for a word alone.
        found = [row for row in found if row.source != _ALONE]
    if any(row.source == _UNCASED for row in found):
        found = [row for row in found if row.furniture not in _ENCLOSED]
    # "Hors vitrine" tells of no case, and of what else holds a thing nothing.
    found.sort(key=lambda row: row.source == _UNCASED)
    support = next((row.support for row in found if row.support is not None), None)
    if support is None and any(told.denies(text) for told in _rows()):
        return replace(_of(found), support=Support.FREESTANDING)
    if support in (Support.HUNG, Support.SUSPENDED):
        # "On the wall over the sideboard": what hangs stands on nothing.
        found = [row for row in found if row.support in (None, support)]
    elif support is Support.FREESTANDING:
        # On a wire stand nothing hangs by a wire.
        found = [row if row.hanging is None else row.model_copy(update={"hanging": None}) for row in found]
    return _of(found)


_OF_FIELDS = {"furniture_anchorage": "anchorage"}
"""Field of how a thing is held -> what the words for displays tell of it, where that has another name."""


def meant_of(field: str, text: str) -> str:
    """Return what a text means of a field's words for how things are held: "two_hooks"; "" where it says none.

    Parameters
    ----------
    field : str
        Of the record: support, hanging, furniture or furniture_anchorage.
    text : str
        In the museum's words: "two hooks or D-rings".
    """
    found = getattr(told_by(text), _OF_FIELDS.get(field, field), None)
    return "" if found is None else str(found.value)


@lru_cache(maxsize=4096)
def in_no_case(text: str) -> bool:
    """Whether a text tells that a thing is shown in the open: "hors vitrine", "open display".

    Parameters
    ----------
    text : str
        In the museum's words.
    """
    return any(told.row.source == _UNCASED and told.says(text) for told in _rows())


def _of(found: Sequence[HeldWords]) -> HeldAs:
    names = ("support", "hanging", "furniture", "anchorage", "mount")
    return HeldAs(
        **{name: next((one for row in found if (one := getattr(row, name)) is not None), None) for name in names}
    )


def stands_or_hangs(text: str) -> bool:
    """Whether a text tells how a thing is held, or that it is on the floor, not only what it stands in.

    Parameters
    ----------
    text : str
        In the museum's words.
    """
    told = told_by(text)
    return told.support is not None or told.furniture is Furniture.FLOOR


@lru_cache(maxsize=4096)
def stands_too(text: str) -> bool:
    """Whether a text that tells that a thing hangs also tells that it stands on the floor, not that it reaches there.

    Parameters
    ----------
    text : str
        In the museum's words.
    """
    if told_by(text).support not in (Support.HUNG, Support.SUSPENDED):
        return False
    floors = (told for told in _rows() if told.row.furniture is Furniture.FLOOR)
    return any(not _REACHES.match(one.group()) for told in floors for one in told.found(text))


def words_for(furniture: Furniture) -> tuple[str, ...]:
    """Return the whole words that tell of a thing what it stands in or on, and nothing else.

    Parameters
    ----------
    furniture : Furniture
        Which.
    """
    alone = [
        row
        for row in (told.row for told in _rows())
        if row.furniture is furniture and (row.support, row.hanging, row.anchorage, row.mount) == (None,) * 4
    ]
    return tuple(word for row in alone for word in row.words if word[0] != "=" and not _PATTERNED & set(word))
