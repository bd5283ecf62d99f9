"""Rules by which an object's record names its class: tables/rules.csv, read from the top; the first that holds decides.

What a row asks of a record, cell by cell (several entries of a cell are parted by `|`; an empty cell asks nothing):

aat            : one of these Getty AAT identifiers is recorded: then classification and words are not asked for
classification : the museum's classification, or a part of its object name, is one of these, in singular or plural
words          : the naming word is one of these; `*statuette` also takes words that end so (Bronzestatuette)
medium         : material or medium has one of these words; what an object stands on (a base) does not count;
                 `=oil paint` is a medium of nothing else
shape          : all of these measures hold (see `pipeline.analysis.shapes`)

An entry `@sculpture` of classification, words or medium stands for all words of that list of tables/word_lists.csv.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field, ValidationInfo

from pipeline.analysis.shapes import SHAPES
from pipeline.errors import InputError
from pipeline.records import Item
from pipeline.tables import Row, TableError, read_table, table
from pipeline.tables.assumed import AssumedValues, assumed
from pipeline.tables.ideographs import shortened_signs
from pipeline.tables.rows import Entries, checked, once, unmarked
from pipeline.tables.word_lists import Listed

_IDENTIFIER = re.compile(r"(?<!\d)300\d{6}(?!\d)")
WORD = re.compile(r"[^\W\d_]+")
_SMALL_WORDS = (
    "of|with|containing|for|in|from|by|and|on|showing|depicting",
    "mit|von|aus|und|fur|zum|zur|als|der|eines|einer",
    "avec|contenant|de|du|des|et|a|au|aux|pour|sur",
    "di|da|con|per|al|alla|su|del|della|dello|dei|degli|delle|dal|dalla",
    "y|para|sobre|e|com|em|do|dos|das",
    "met|van|en|voor|op",
    "op|cu|din|pe|pentru",
    "z|ze|na|dla|w|od",
    "s|se|v|pro",
    "av|af|med|till|til|fran|fra|for|och|og|som",
    "с|из|для|на|в|от",
    "με|απο|σε|για|του|της|και",
    "dengan|dari|untuk|dan|pada|me|prej|nga",
    "من|مع|علی|فی|از|با|در|بر|و",
)
"""Words of fifteen languages, folded, that end the name of a thing: prepositions, joined articles, genitives."""
BREAK = re.compile(rf"[,:;|()\[\]{{}}/\"]|\s(?:{'|'.join(_SMALL_WORDS)}|銘)\s|\s[dl]['\u2019]")
"""Where the name of a thing ends and its description begins."""
_SUPPORT = re.compile(
    r"\b(?:on|in|with|and|recessed in|auf|sur|su|sobre|op)\s[^,;]{0,40}?\b(?:base|plinth|socle|pedestal)\b"
)
"""What a medium says of the base."""
_ELIDED = re.compile(r"(?<= )([dl]) ")
"""What is left of an article before a vowel, where the table's words are parted: cartel d applique."""
_SHOWN = 80
"""Characters of a cell that a message repeats."""
_SAME = str.maketrans("ıيىكة", "iییکه")
"""Letters that nobody can tell apart, in Turkish capitals, or that Arabic and Persian write differently."""
_COUNTED = re.compile(
    r"(?<=[\u3400-\u9fff])\s?[一二两三四五六七八九十\d]+(?:对|対|双|件|组|組|套|只|尊|座|个|個|枚|副|匹|躯|体|基)(?![\u3400-\u9fff])"
)
"""How many there are, behind the name of a thing in signs: 石狮一对."""
HEAD_FIRST = re.compile(r"[\u0590-\u06ff\u0e00-\u0eff]")
"""Letters of languages that name a thing before what it is of, with no word between: Arabic, Persian, Hebrew, Thai."""
IDEOGRAPH = re.compile(r"[\u3040-\u30ff\u3400-\u9fff]")
"""Letters of scripts that put no spaces between words: there one letter may precede an ending."""


@lru_cache(maxsize=4096)
def fold(text: str) -> str:
    """Return a text without capitals and accents, so that Büste, buste and BUSTE are the same word."""
    if not text.isascii():
        text = unmarked(text).translate(_SAME)
        text = _COUNTED.sub("", shortened_signs(text))
    return text.casefold()


@lru_cache(maxsize=65536)
def stuff(material: str, medium: str) -> str:
    """Return what a thing is made of, folded, without what is said of its base."""
    return _SUPPORT.sub(" ", fold(f"{material} {medium}"))


def words_of(entries: Iterable[str]) -> re.Pattern[str]:
    """Return what finds any of some words in what `fold` or `stuff` returns, in singular or plural, the longest first.

    Words of scripts without spaces are found within others; `=oil paint` is all that there is, but for a date.
    """
    entries = tuple(entries)
    alone = sorted(
        {re.escape(fold(entry[1:])) for entry in entries if entry[:1] == "="}, key=lambda word: (-len(word), word)
    )
    whole = [rf"\A\s*(?:{'|'.join(alone)})s?\s*(?:[,;(.]?\D{{0,4}}\d{{4}}\b.*)?\Z"] if alone else []
    words = sorted({fold(entry) for entry in entries if entry[:1] != "="}, key=lambda word: (-len(word), word))
    within = [word for word in words if IDEOGRAPH.search(word)]
    apart = [re.escape(word) for word in words if word not in within]
    bounded = [rf"\b(?:{'|'.join(apart)})s?\b"] if apart else []
    return re.compile("|".join([*whole, *bounded, *map(re.escape, within)]))


@lru_cache(maxsize=65536)
def _has(words: re.Pattern[str], text: str) -> bool:
    return words.search(text) is not None


def identifiers(text: str) -> frozenset[str]:
    """Return the Getty AAT identifiers in a text, as bare numbers: 300132254, aat:300132254 and addresses alike."""
    return frozenset(_IDENTIFIER.findall(text))


def _name(name: str) -> str:
    if not name.strip() or ":" in name:
        raise InputError("must be a name without a colon")
    return name


def _known_class(name: str, info: ValidationInfo) -> str:
    classes = (info.context or {})["classes"]
    if name not in classes:
        raise InputError(f"classes.csv has no class {name[:_SHOWN]!r}; use one of {', '.join(sorted(classes))}")
    return name


def _identifier(entry: str) -> str:
    if _IDENTIFIER.fullmatch(entry) is None:
        raise InputError(f"{entry[:_SHOWN]!r} is no AAT identifier; write nine digits, as 300132254, parted by |")
    return entry


def _word(entry: str) -> str:
    """Return a word or phrase folded, an ending with its asterisk."""
    folded = " ".join(WORD.findall(fold(entry)))
    if not folded or "*" in entry[1:]:
        raise InputError(f"{entry[:_SHOWN]!r} has no word; write words, or an ending as *vase")
    return f"*{folded}" if entry.startswith("*") else folded


def _shape(name: str) -> str:
    if name not in SHAPES:
        raise InputError(f"there is no shape {name[:_SHOWN]!r}; use some of {', '.join(SHAPES)}")
    return name


def _each(check: Callable[[str], str]) -> AfterValidator:
    return AfterValidator(lambda entries: tuple(map(check, entries)))


class _RuleRow(BaseModel):
    """A row of a table of rules, as the opening of this module says."""

    rule: Annotated[str, AfterValidator(_name)]
    object_class: Annotated[str, Field(alias="class"), AfterValidator(_known_class)]
    aat: Annotated[Entries, _each(_identifier)]
    classification: Listed
    words: Annotated[Listed, _each(_word)]
    medium: Listed
    shape: Annotated[tuple[str, ...], _each(_shape), BeforeValidator(str.split)]
    why: str


@dataclass(frozen=True)
class Rule:
    """One row of rules.csv, ready to match; ``words`` without endings, ``endings`` without their asterisk."""

    position: int
    name: str
    object_class: str
    aat: frozenset[str]
    kinds: frozenset[str]
    words: frozenset[str]
    endings: tuple[str, ...]
    medium: re.Pattern[str] | None
    shapes: tuple[Callable[[Item], bool], ...]
    why: str

    @property
    def named(self) -> bool:
        """Whether the row asks for a naming word."""
        return bool(self.words or self.endings)

    def fits(self, item: Item) -> bool:
        """Say whether the object's medium and measures are those of the row."""
        if self.medium is not None and not _has(self.medium, stuff(item.material, item.medium)):
            return False
        return all(shape(item) for shape in self.shapes)


@dataclass(frozen=True, eq=False)
class RuleTable:
    """The rules in order, and where to find those of a word.

    Attributes
    ----------
    wordless, classed : tuple of Rule
        Those that ask for no naming word: of medium and measures only, and of the classification too.
    own : frozenset of str
        The names of the museum's own rules, which decide outright.
    spanning : re.Pattern[str] or None
        The phrases that a word such as "of" or "de" does not break.
    aat : frozenset of str
        Every identifier that some rule names.
    by_last : Mapping[str, tuple[str, ...]]
        The known words and phrases by their last word.
    endings : Mapping[str, tuple[str, ...]]
        The known endings by their last letter, the longest first.
    values : AssumedValues
        What is assumed of the classes that the rules name.
    """

    rules: tuple[Rule, ...]
    by_word: Mapping[str, tuple[Rule, ...]]
    by_ending: Mapping[str, tuple[Rule, ...]]
    wordless: tuple[Rule, ...]
    classed: tuple[Rule, ...]
    own: frozenset[str]
    spanning: re.Pattern[str] | None
    aat: frozenset[str]
    by_last: Mapping[str, tuple[str, ...]]
    endings: Mapping[str, tuple[str, ...]]
    values: AssumedValues

    def class_of(self, word: str) -> str:
        """Return the class of the first rule that a known word, or ending with its asterisk, has.

        Parameters
        ----------
        word : str
            A key of `by_word`, or of `by_ending` behind an asterisk.

        Returns
        -------
        str
        """
        return (self.by_word.get(word) or self.by_ending[word[1:]])[0].object_class

    def names(self, word: str, classes: Collection[str]) -> bool:
        """Say whether a word names something of one of these classes.

        Parameters
        ----------
        word : str
            Known or not.
        classes : collection of str
            Rows of classes.csv.

        Returns
        -------
        bool
        """
        return any(rule.object_class in classes for rule in self.by_word.get(word, ()))


@dataclass(frozen=True)
class RuleMatch:
    """The rule that decided, and what in the record made it hold ("" where the row asks for no name).

    Attributes
    ----------
    word : str
        The naming word that it found, an ending with its asterisk.
    share : float
        How far it is believed: less than 1 where the record's own word is only akin to that one, names other things
        too, or has words behind it that nobody knows.
    """

    rule: Rule
    evidence: str = ""
    word: str = ""
    share: float = 1.0

    @property
    def words(self) -> str:
        """The decision in words: the rule's name, its reason, and the evidence."""
        said = f" ({self.evidence})" if self.evidence else ""
        return f"{self.rule.name}: {self.rule.why}{said}"


def read_rules(
    rows: tuple[Row, ...], values: AssumedValues, file: str = "rules.csv", own: Iterable[str] = ()
) -> RuleTable:
    """Return rows of a table of rules, ready to match.

    Parameters
    ----------
    own : iterable of str, optional
        The names of those that are the museum's own.

    Returns
    -------
    RuleTable

    Raises
    ------
    TableError
        Naming file, line, rule, column and remedy, for an unknown class or shape, a name used twice, an identifier that
        is none of the AAT's, a word that cannot match, and a last row with conditions.
    """
    return _indexed(_read(rows, values, file), values, file, own)


def _read(rows: Iterable[Row], values: AssumedValues, file: str) -> tuple[Rule, ...]:
    written = checked(_RuleRow, tuple(rows), file, named="rule", context={"classes": frozenset(values.classes)})
    once((row.rule for row in written), "rule", file)
    return tuple(_rule(row, at) for at, row in enumerate(written))


def _indexed(out: tuple[Rule, ...], values: AssumedValues, file: str, own: Iterable[str]) -> RuleTable:
    if not out:
        raise TableError(f"{file}: has no rows; the last row must be a rule without conditions")
    if (rest := out[-1]).aat or rest.kinds or rest.named or rest.medium or rest.shapes:
        raise TableError(
            f"{file}, line {len(out) + 1}: the last row must have no conditions, so that it takes the rest"
        )
    words: dict[str, list[Rule]] = {}
    endings: dict[str, list[Rule]] = {}
    for rule in out:
        for word in sorted(rule.words):
            words.setdefault(word, []).append(rule)
        for ending in rule.endings:
            endings.setdefault(ending, []).append(rule)
    by_last: dict[str, list[str]] = {}
    for word in words:
        by_last.setdefault(word.rpartition(" ")[2], []).append(word)
    return RuleTable(
        out,
        {word: tuple(found) for word, found in words.items()},
        {ending: tuple(found) for ending, found in endings.items()},
        tuple(r for r in out if not r.named and not r.kinds and (r.medium or r.shapes or r is out[-1])),
        tuple(r for r in out if not r.named and r.kinds),
        frozenset(own),
        _spanning(words),
        frozenset().union(*(rule.aat for rule in out)),
        {last: tuple(phrases) for last, phrases in by_last.items()},
        _by_last_letter(endings),
        values,
    )


def _by_last_letter(endings: Iterable[str]) -> dict[str, tuple[str, ...]]:
    out: dict[str, list[str]] = {}
    for ending in sorted(endings, key=lambda one: (-len(one), one)):
        out.setdefault(ending[-1], []).append(ending)
    return {letter: tuple(found) for letter, found in out.items()}


def _spanning(words: Iterable[str]) -> re.Pattern[str] | None:
    """Return what finds a phrase with a breaking word in it at the beginning of a text, in singular or plural."""
    # A table's words are letters and spaces alone.
    phrases = [word for word in words if BREAK.search(_ELIDED.sub(r"\1'", word))]
    written = [_ELIDED.sub("\\1['\u2019]", word) for word in sorted(phrases, key=lambda one: (-len(one), one))]
    return re.compile(rf"(?:{'|'.join(written)})s?\b") if phrases else None


def _rule(row: _RuleRow, position: int) -> Rule:
    return Rule(
        position,
        row.rule,
        row.object_class,
        frozenset(row.aat),
        frozenset(singular(fold(kind).replace("&", "and")) for kind in row.classification),
        frozenset(word for word in row.words if word[0] != "*"),
        tuple(word[1:] for word in row.words if word[0] == "*"),
        words_of(row.medium) if row.medium else None,
        tuple(SHAPES[name] for name in row.shape),
        row.why,
    )


@cache
def rules() -> RuleTable:
    """Return Kouros's own table of rules.

    Raises
    ------
    TableError
        As read_rules.
    """
    return read_rules(table("rules"), assumed())


def with_own(path: Path | None, values: AssumedValues | None = None) -> RuleTable:
    """Return a museum's own rules, followed by Kouros's; a row of the same name takes the place of Kouros's.

    Parameters
    ----------
    path : Path or None
        A CSV file with the columns of tables/rules.csv; None: the museum has no rules of its own.
    values : AssumedValues or None, optional
        What is assumed of the classes; None: Kouros's own tables.

    Returns
    -------
    RuleTable

    Raises
    ------
    TableError
        Naming file, line, rule, column and remedy.
    FileNotFoundError
    """
    values = values or assumed()
    # A museum's classes are added to Kouros's, or take their place by name: none that Kouros's rules name is missing.
    ours = rules()
    if path is None:
        return replace(ours, values=values)
    rows = read_table(path)
    columns = list(table("rules")[0])
    missing = [column for column in columns if rows and column not in rows[0]]
    if missing:
        raise TableError(f"{path.name}: there is no column {missing[0]!r}; its columns must be {', '.join(columns)}")
    own = _read(rows, values, path.name)
    names = {rule.name for rule in own}
    both = (*own, *(rule for rule in ours.rules if rule.name not in names))
    return _indexed(tuple(replace(rule, position=at) for at, rule in enumerate(both)), values, path.name, names)


def singular(kind: str) -> str:
    """Return a word of a classification in the singular."""
    return kind[:-1] if kind.endswith("s") and not kind.endswith("ss") else kind
