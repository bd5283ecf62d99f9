"""Rules by which an object's record names its class: tables/rules.csv, read from the top; the first that holds decides.

What a row asks of a record, cell by cell (several entries of a cell are parted by `|`; an empty cell asks nothing):

aat            : one of these Getty AAT identifiers is recorded: then classification and words are not asked for
classification : the museum's classification, or a part of its object name, is one of these, in singular or plural
words          : the naming word is one of these; `*statuette` also takes words that end so (Bronzestatuette)
medium         : material or medium has one of these words; what an object stands on (a base) does not count;
                 `=oil paint` is a medium of nothing else
shape          : all of these measures hold (see `pipeline.analysis.shapes`)

The naming word is the last known word of the object name or, if it knows none, of the title, each read up to its first
"of", "with", comma and the like: a vase with a bust is a vase, a lantern vase a vase, a cup and saucer a cup.  Where
no object name is recorded, a medium may be one: porcelain charger with terra sigillata.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Annotated
from unicodedata import combining, normalize

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field, ValidationInfo

from pipeline.analysis.shapes import SHAPES
from pipeline.errors import InputError
from pipeline.records import Item
from pipeline.tables import Row, TableError, read_table, table
from pipeline.tables.assumed import AssumedValues, assumed
from pipeline.tables.rows import Entries, checked, once

_IDENTIFIER = re.compile(r"(?<!\d)300\d{6}(?!\d)")
_WORD = re.compile(r"[^\W\d_]+")
_BREAK = re.compile(
    r"[,:;|()\[\]/\"]|\s(?:of|with|for|in|from|by|and|on|showing|depicting|mit|von|aus|und|fur|zum|zur|avec|de|du|des|et|a|au|aux|pour|sur|di|da|con|per|al|alla|su|y|para|sobre|e|com|em|met|van|en|voor|op|cu|din|pe|pentru|銘)\s"
)
"""Where the name of a thing ends and its description begins."""
_INVERTED = re.compile(r"\s*((?:[^\W\d_]|[ '-])+?)\s*,\s*((?:[^\W\d_]|[ '-])+?)\s*")
"""What lists of names put behind what it is an own kind of: Desk, Drop-front; Lamp, Hanging."""
_OF_SET = re.compile(
    r"^[^:;,]*\b(?:set|service|servizio|servicio|servico|garniture|garnitur|garnitura)\s*:\s*(?=[^\W\d_])"
)
"""What stands ahead of a part of a set: Child's tea service: plate."""
_OF_MANY = re.compile(
    r"^\s*(?:ensemble|conjunto|insieme|suite|lot|lote)\s+(?:de|di|do|da|dos|das|of)\s|^\s*ensemble\s+d['’]"
)
"""What says that there are several of the things named behind it: Ensemble de tables consoles."""
_KIND = re.compile(r"\(\s*([^()]+?)\s*\)\s*$")
"""What stands in brackets at the end and may say what the thing itself is: Brasão (desenho)."""
_MARK = re.compile(r"\b(?:model|modell|modele|modello|modelo)\b\.?\s*(?:no\b|nr\b|n[°o]|#|series\b|[a-z-]*\d)")
"""What a maker calls a thing, which is no model of it: Clock Model No. 101."""
_SUPPORT = re.compile(
    r"\b(?:on|in|with|and|recessed in|auf|sur|su|sobre|op)\s[^,;]{0,40}?\b(?:base|plinth|socle|pedestal)\b"
)
"""What a medium says of the base."""
_THINGS = ("vessel", "dish", "seat", "table", "cabinet", "clock", "figurine")
_NOT_THINGS = ("plate", "glass", "block", "group", "animal", "container", "figure", "tray", "stand")
"""What a medium calls stuff, or many: silver plate, plate glass, 22 groups of cards."""
_READ = 10_000
"""Characters of a text that are searched for the name of the thing."""
PICTURES = ("framed",)
"""Classes of what hangs flat whatever its title says."""
FORMATS = ("screen", "handscroll")
"""Rules of pictures that do not hang: a title that names one says what the thing is, not what it shows."""
LIGHTS = ("candlestick", "chandelier")
"""Rules of lights that stand, among which a bare lamp is, and of those that hang."""
ANY_LIGHT = frozenset({"lamp", "light", "lampe", "lampada", "lampara", "lampa", "luminaire", "leuchte", "leuchter"})
"""Words that name a light of any kind, folded."""
LIDS = frozenset({"lid", "cover", "deckel", "couvercle", "coperchio", "tapa", "deksel", "capac", "tampa"})
"""Words of what a thing may have and be no other kind for it, folded."""
_SHOWN = 80
"""Characters of a cell that a message repeats."""
_STEM = 2
"""Letters that must precede an ending such as *statuette."""
_PLURAL = 6
"""Letters from which an e at the end may be that of a plural (Handschuhe): plane is no plan, and cane no can."""
_IDEOGRAPH = re.compile(r"[\u3040-\u30ff\u3400-\u9fff]")
"""Letters of scripts that put no spaces between words: there one letter may precede an ending."""
_PART = re.compile(
    r"[(,:]\s*(lid|cover|stopper|fragment|sherd|deckel|couvercle|coperchio|tapa|deksel|capac|tampa|fragmento|frammento)s?"
    r"\s*\)?\s*$"
)
"""What is said behind the name of a thing of which only a part is there: jar (lid)."""
_BLANK = ("", "(not assigned)", "not assigned", "unclassified", "uncategorized", "unknown", "n/a", "none", "-")
"""Classifications that say nothing."""


@lru_cache(maxsize=4096)
def fold(text: str) -> str:
    """Return a text without capitals and accents, so that Büste, buste and BUSTE are the same word."""
    if not text.isascii():
        text = "".join(c for c in normalize("NFKD", text) if not combining(c))
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
    alone = sorted({re.escape(fold(entry[1:])) for entry in entries if entry.startswith("=")}, key=len, reverse=True)
    whole = [rf"\A\s*(?:{'|'.join(alone)})s?\s*(?:[,;(.]?\D{{0,4}}\d{{4}}\b.*)?\Z"] if alone else []
    words = sorted({fold(entry) for entry in entries if entry[:1] != "="}, key=lambda word: (-len(word), word))
    within = [word for word in words if _IDEOGRAPH.search(word)]
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
    if not _WORD.search(fold(entry)) or "*" in entry[1:]:
        raise InputError(f"{entry[:_SHOWN]!r} has no word; write words, or an ending as *vase")
    return entry


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
    classification: Entries
    words: Annotated[Entries, _each(_word)]
    medium: Entries
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

    wordless, classed : those that ask for no naming word: of medium and measures only, and of the classification too
    own     : the names of the museum's own rules, which decide outright
    spanning : the phrases that a word such as "of" or "de" does not break
    aat     : every identifier that some rule names
    by_last : the known words and phrases by their last word
    endings : the known endings by their last letter, the longest first
    values  : what is assumed of the classes that the rules name
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


@dataclass(frozen=True)
class RuleMatch:
    """The rule that decided, and what in the record made it hold ("" where the row asks for no name).

    word : the naming word that it found, an ending with its asterisk
    """

    rule: Rule
    evidence: str = ""
    word: str = ""

    @property
    def words(self) -> str:
        """The decision in words: the rule's name, its reason, and the evidence."""
        said = f" ({self.evidence})" if self.evidence else ""
        return f"{self.rule.name}: {self.rule.why}{said}"


def read_rules(
    rows: tuple[Row, ...], values: AssumedValues, file: str = "rules.csv", own: Iterable[str] = ()
) -> RuleTable:
    """Return rows of a table of rules, ready to match.

    own    : the names of those that are the museum's own
    raises : TableError naming file, line, rule, column and remedy, for an unknown class or shape, a name used twice,
             an identifier that is none of the AAT's, a word that cannot match, and a last row with conditions
    """
    if not rows:
        raise TableError(f"{file}: has no rows; the last row must be a rule without conditions")
    written = checked(_RuleRow, rows, file, named="rule", context={"classes": frozenset(values.classes)})
    once((row.rule for row in written), "rule", file)
    out = [_rule(row, at) for at, row in enumerate(written)]
    if any(rows[-1][column].strip() for column in ("aat", "classification", "words", "medium", "shape")):
        raise TableError(
            f"{file}, line {len(rows) + 1}: the last row must have no conditions, so that it takes the rest"
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
        tuple(out),
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
    phrases = sorted((re.escape(word) for word in words if _BREAK.search(word)), key=lambda one: (-len(one), one))
    return re.compile(rf"(?:{'|'.join(phrases)})s?\b") if phrases else None


def _rule(row: _RuleRow, position: int) -> Rule:
    words = [(" ".join(_WORD.findall(fold(entry))), entry.startswith("*")) for entry in row.words]
    return Rule(
        position,
        row.rule,
        row.object_class,
        frozenset(row.aat),
        frozenset(_singular(fold(kind).replace("&", "and")) for kind in row.classification),
        frozenset(word for word, ends in words if not ends),
        tuple(word for word, ends in words if ends),
        words_of(row.medium) if row.medium else None,
        tuple(SHAPES[name] for name in row.shape),
        row.why,
    )


@cache
def rules() -> RuleTable:
    """Return Kouros's own table of rules.

    raises : TableError, as read_rules
    """
    return read_rules(table("rules"), assumed())


def with_own(path: Path | None, values: AssumedValues | None = None) -> RuleTable:
    """Return a museum's own rules, followed by Kouros's; a row of the same name takes the place of Kouros's.

    path   : a CSV file with the columns of tables/rules.csv; None: the museum has no rules of its own
    values : what is assumed of the classes; None: Kouros's own tables
    raises : TableError naming file, line, rule, column and remedy; FileNotFoundError
    """
    values, ours = values or assumed(), table("rules")
    if path is None:
        return read_rules(ours, values)
    own = read_table(path)
    missing = [column for column in ours[0] if own and column not in own[0]]
    if missing:
        raise TableError(f"{path.name}: there is no column {missing[0]!r}; its columns must be {', '.join(ours[0])}")
    names = {row["rule"] for row in own}
    both = (*own, *(row for row in ours if row["rule"] not in names))
    return read_rules(both, values, path.name, names)


@dataclass(frozen=True)
class Readings:
    """What each part of a record says of the class by itself; None for a part that says nothing.

    decided        : the rule that decides where the rules alone do
    outright       : whether nothing else is asked: an identifier, or a rule of the museum's own
    name, title    : the rule of the naming word of object name and title
    classification : the rule of what the museum classes it as
    medium         : the rule of what it is made of
    """

    decided: RuleMatch
    outright: bool
    name: RuleMatch | None = None
    classification: RuleMatch | None = None
    medium: RuleMatch | None = None
    title: RuleMatch | None = None

    @property
    def silent(self) -> bool:
        """Whether no part of the record says a class."""
        return not (self.outright or self.name or self.classification or self.medium or self.title)


def rule_for(item: Item, among: RuleTable | None = None) -> RuleMatch:
    """Return the first rule whose conditions hold for the object, of Kouros's table or another."""
    return readings(item, among).decided


def readings(item: Item, among: RuleTable | None = None) -> Readings:
    """Return what each part of a record says of the class, and the rule that decides among them."""
    of = among or rules()
    if item.aat:
        recorded = identifiers(item.aat) & of.aat
        for rule in of.rules if recorded else ():
            shared = rule.aat & recorded
            if shared and rule.fits(item):
                return Readings(RuleMatch(rule, f"AAT {min(shared)}"), outright=True)
    kinds = _kinds(item.classification) | _kinds(item.object_name)
    classed, made = _wordless(item, kinds, of)
    name = _named(item, item.object_name, kinds, of) if item.object_name else _made_as(item, kinds, of)
    if classed is None and item.classification:
        classed = _named(item, item.classification, kinds, of)
    title = _named(item, item.title, kinds, of)
    if name is not None and title is not None and _narrows(title, name):
        name = title
    # What is painted, drawn or printed is flat, whatever its title says that it shows, but for its own format.
    flat = made is not None and made.rule.object_class in PICTURES
    speaks = title if not flat or (title is not None and title.rule.name in FORMATS) else None
    found = [one for one in (name or speaks, classed, made) if one is not None]
    decided = min(found, key=lambda one: one.rule.position, default=RuleMatch(of.rules[-1]))
    return Readings(decided, decided.rule.name in of.own, name, classed, made, title)


def _narrows(title: RuleMatch, name: RuleMatch) -> bool:
    """Whether a title names a kind of what the object name says: a Kronleuchter is a Leuchter, and no candlestick.

    Where the name is of a light in general, a title that names one which hangs is of that kind whatever its words are.
    """
    if {title.rule.object_class, name.rule.object_class} & set(PICTURES):
        return False
    kind, thing = title.word.removeprefix("*"), name.word.removeprefix("*")
    hangs = (name.rule.name, title.rule.name) == LIGHTS and thing in ANY_LIGHT
    lidded = kind.rpartition(" ")[2] in LIDS  # a copa con tapa is a copa still, where a pahar cu picior is a goblet
    longer = kind != thing and bool(thing) and (kind.endswith(thing) or (kind.startswith(f"{thing} ") and not lidded))
    return hangs or longer


def _wordless(item: Item, kinds: frozenset[str], of: RuleTable) -> tuple[RuleMatch | None, RuleMatch | None]:
    """Return the first rule that asks for the classification and no name, and the first that asks for neither."""
    classed: RuleMatch | None = None
    for rule in of.classed if kinds else ():
        if rule.kinds & kinds and rule.fits(item):
            classed = RuleMatch(rule)
            break
    for rule in of.wordless[:-1]:
        if rule.fits(item):
            return classed, RuleMatch(rule)
    return classed, None


def _made_as(item: Item, kinds: frozenset[str], of: RuleTable) -> RuleMatch | None:
    """Return the rule of a medium that is the name of a thing: porcelain charger with terra sigillata; no list is."""
    head = [] if re.search(r"[,;\d]", item.medium) else _BREAK.split(fold(item.medium[:_READ]), maxsplit=1)[0].split()
    found = _named(item, " ".join(head), kinds, of) if 2 <= len(head) <= 4 else None
    if found is None or found.rule.object_class not in _THINGS or found.word in _NOT_THINGS:
        return None
    return found if head[-1] in (found.word, f"{found.word}s") else None


def _named(item: Item, text: str, kinds: frozenset[str], of: RuleTable) -> RuleMatch | None:
    """Return the first rule of the first naming word of a text that has one which fits."""
    if not text:
        return None
    for word in _candidates(text[:_READ], of):
        for rule in of.by_word.get(word) or of.by_ending.get(word[1:], ()):
            if (not rule.kinds or rule.kinds & kinds) and rule.fits(item):
                return RuleMatch(rule, f"named {word!r}", word)
    return None


@lru_cache(maxsize=16384)
def _candidates(text: str, of: RuleTable) -> tuple[str, ...]:
    """Return the known words and *endings of an object name or title, the likeliest name of the thing first."""
    folded = _OF_MANY.sub("", _OF_SET.sub("", _MARK.sub(" , ", fold(text))))
    parts = _BREAK.split(folded)
    # A phrase such as "montre de poche" goes over what would else break it; it must stand at the beginning.
    start = of.spanning.match(folded) if of.spanning is not None else None
    kind = _KIND.search(folded)
    out = [] if kind is None else [one for one in _spelt(of, kind.group(1).split()) if _pictures(of, one)]
    out += [] if start is None else _spelt(of, start.group().split())
    out += _inverted(folded, of)
    only = _PART.search(folded)
    if only is not None:
        out += _spelt(of, [only.group(1)])
    for part in parts:
        found = _WORD.findall(part)
        for end in range(len(found), 0, -1):
            for before, word in _known(of, found[end - 1]):
                if not before or before == tuple(found[max(0, end - 1 - len(before)) : end - 1]):
                    out.append(word)
    return tuple(out)


def _pictures(of: RuleTable, word: str) -> bool:
    """Whether a word names what hangs flat, whatever it shows."""
    return any(rule.object_class in PICTURES for rule in of.by_word.get(word, ()))


def _inverted(folded: str, of: RuleTable) -> Iterator[str]:
    """Yield the phrases that a name says in inverted order, as the nomenclature of many museums does: Clock, Wall."""
    found = _INVERTED.fullmatch(folded)
    if found is not None:
        kind, thing = _WORD.findall(found[2]), _WORD.findall(found[1])
        for before, word in _known(of, thing[-1]) if kind and thing else ():
            if before and before == tuple((*kind, *thing[:-1])[-len(before) :]):
                yield word


def _spelt(of: RuleTable, words: list[str]) -> Iterator[str]:
    """Yield a phrase as the table spells it."""
    for form in _forms(words[-1]):
        phrase = " ".join((*words[:-1], form))
        if phrase in of.by_word:
            yield phrase


@lru_cache(maxsize=65536)
def _known(of: RuleTable, word: str) -> tuple[tuple[tuple[str, ...], str], ...]:
    """Return the known words that a word may end: what must stand before it and the whole, the longest phrase first."""
    forms = _forms(word)
    whole = [(tuple(phrase.split(" ")[:-1]), phrase) for form in forms for phrase in of.by_last.get(form, ())]
    ends = [
        ((), f"*{ending}")
        for form in forms
        for ending in of.endings.get(form[-1], ())
        if form.endswith(ending) and len(form) >= len(ending) + (1 if _IDEOGRAPH.match(ending) else _STEM)
    ]
    return (*sorted(whole, key=lambda pair: -len(pair[0])), *ends)


def _forms(word: str) -> tuple[str, ...]:
    """Return a word as it stands, then as the singulars that its ending allows in the languages of the table."""
    forms = [word]
    if len(word) > 3:
        if word.endswith("ies"):
            forms.append(word[:-3] + "y")
        forms.extend(word[: -len(end)] for end in ("s", "es", "n", "en", "x") if word.endswith(end))
    if len(word) >= _PLURAL and word.endswith("e"):
        forms.append(word[:-1])
    return tuple(forms)


def _singular(kind: str) -> str:
    return kind[:-1] if kind.endswith("s") and not kind.endswith("ss") else kind


@lru_cache(maxsize=4096)
def _kinds(text: str) -> frozenset[str]:
    """Return a classification or object name, whole and in its parts, in the singular."""
    folded = fold(text).strip().replace("&", "and")
    if folded in _BLANK:
        return frozenset()
    parts = (folded, *re.split(r"[|;,/-]", folded))
    return frozenset(_singular(part.strip()) for part in parts if part.strip())
