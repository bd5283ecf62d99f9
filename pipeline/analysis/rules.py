"""The rule that decides an object's class, and what each part of its record says by itself.

The naming word is the last known word of the object name or, if it knows none, of the title, each read up to its first
"of", "with", comma and the like: a vase with a bust is a vase, a lantern vase a vase, a cup and saucer a cup.  Where
no object name is recorded, a medium may be one: porcelain charger with terra sigillata.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

from pipeline.analysis.akin import akin, forms, heads_of, homographs, known
from pipeline.analysis.naming_words import ANY_LIGHT, FRAGMENTS, KINDS_ONLY, LIDS, NAMED_AFTER, OF_STUFF, SCULPTURES
from pipeline.analysis.rule_table import (
    BREAK,
    HEAD_FIRST,
    IDEOGRAPH,
    WORD,
    Rule,
    RuleMatch,
    RuleTable,
    fold,
    identifiers,
    rules,
    singular,
    stuff,
)
from pipeline.records import Item
from pipeline.tables.assumed import READ
from pipeline.tables.material_words import begins_with_material

_INVERTED = re.compile(r"\s*((?:[^\W\d_]|[ '-])+?)\s*,\s*((?:[^\W\d_]|[ '-])+?)\s*")
"""What lists of names put behind what it is an own kind of: Desk, Drop-front; Lamp, Hanging."""
_OF_SET = re.compile(
    r"^[^:;,]*\b(?:set|service|servizio|servicio|servico|garniture|garnitur|garnitura)\s*:\s*(?=[^\W\d_])"
)
"""What stands ahead of a part of a set: Child's tea service: plate."""
_OF_SERVICE = re.compile(r"\b(?:service|set|servizio|servicio|servico|garnitur)\s*\(([^()]+)\)")
"""What names in brackets a part of a set: Dinner service (soup bowl)."""
_OF_MANY = re.compile(
    r"^\s*(?:ensemble|conjunto|insieme|suite|lot|lote)\s+(?:de|di|do|da|dos|das|of)\s|^\s*ensemble\s+d['’]"
)
"""What says that there are several of the things named behind it: Ensemble de tables consoles."""
_KIND = re.compile(r"\(\s*([^()]+?)\s*\)\s*$")
"""What stands in brackets at the end and may say what the thing itself is: Brasão (desenho)."""
_MARK = re.compile(
    r"\b(?:model|modell|modele|modello|modelo)\b\.?\s*(?:no\b|nr\b|n[°o]|#|series\b|[a-z-]*\d)|\bmodell? [b-z]\b"
)
"""What a maker calls a thing, which is no model of it: Clock Model No. 101, Model T."""
_MODEL = re.compile(
    r"\s*(?:(?:an?|working|scale|small|large|sectioned|sectional|cutaway)\s+)*(modell?)\s+(?=[^\W\d_]{2,})"
)
"""How a name begins that calls its thing a model with no word between: Model hand loom."""
_IN_SMALL = re.compile(r"\bminiature\s+(?=[^\W\d_])")
"""What stands ahead of a thing made small: miniature furniture is no picture."""
_SMALL_BEHIND = re.compile(r",\s*miniature\s*$")  # inverted: a vase, miniature, is no picture
_THINGS = ("vessel", "dish", "seat", "table", "cabinet", "clock", "figurine")
_NOT_THINGS = (
    *("plate", "glass", "block", "group", "animal", "container", "figure", "tray", "stand"),
    *("earthenware", "stoneware", "case"),
)
"""What a medium calls stuff, a part, or many: silver plate, plate glass, a metal case, 22 groups of cards."""
PICTURES = ("framed",)  # what hangs flat whatever its title says
FORMATS = ("screen", "handscroll")
"""Rules of pictures that do not hang: a title that names one says what the thing is, not what it shows."""
LIGHTS = ("candlestick", "chandelier")
"""Rules of lights that stand, among which a bare lamp is, and of those that hang."""
_JOINED_LID = re.compile(rf"\s(?:and|und|et|e|y|en|og|och|cu)\s+(?:{'|'.join(sorted(LIDS))})s?\s*$")
"""What is said at the end of a name of a thing that has its lid."""
LIDDED = "lidded vessel"
_MADE_OF = re.compile(r"木造|木彫|一木造|寄木造|[銅石鉄塑]造|塑像|(?:脱活)?乾漆|金銅|鋳銅|青銅|[陶磁石木銅鉄]製")
"""What a Japanese title begins with that says what its thing is made of: no picture is called so."""
_BODIES = frozenset(
    {"vessel", "dish", "stemmed_glass", "bust", "statue", "figurine", "lamp", "cabinet", "clock", "relief"}
)
_WORDS_OF_NAME = 5  # words of which such a title has no more
_IN_FULL = re.compile(r"[^のとやにいるたなを\s]{4,}")
"""What stands before the word for the thing in its full Japanese name, and in a picture's title seldom."""
_FIGURES = ("statue", "standing_figure", "figurine")  # a picture of Kannon is a figure of Kannon too
_BESIDE = re.compile(
    r"\s*(?:with|containing|in|by|on|showing|depicting|mit|aus|auf|avec|sur|con|per|su|para|sobre|com|em|met|op|cu|din|pe"
    r"|im|z|ze|na|s|se|av|af|med|fran|fra|из|на|с|με|απο|σε)\s*"
)
"""Words behind which stands what a thing has, shows, stands on or is made of, and not what it is."""
_STUFF = re.compile(
    r"\b(?:glass|glas|glases|verre|vetro|vidrio|vidro|sticla|szkla|skla|porcelain|porzellan|porcelaine)$"
)
"""Stuff at the end of a part that is also the name of a thing."""
_ON_WALLS = frozenset({"mural", "murale", "murales", "murali", "muraux"})
"""Words that behind a relief say only where it is: a relief mural is a relief, and no wall painting."""
_PART = re.compile(
    r"[(,:]\s*(lid|cover|stopper|fragment|sherd|deckel|couvercle|coperchio|tapa|deksel|capac|tampa|fragmento|frammento)s?"
    r"\s*\)?\s*$"
)
"""What is said behind the name of a thing of which only a part is there: jar (lid)."""
_OF_TECHNIQUE = re.compile(r"\b(?:carvings?|schnitzereien?|houtsnijwerk|talla|sculpte|雕刻)\b")
"""What a museum may class things by that says only how they are made: bowls and baskets among its carvings."""
_CARVED = ("bust", "relief")
"""Classes of such kinds; a boot or a crown of marble stands as other sculpture does, and a chandelier hangs."""
_MASK = re.compile(r"\*?(?:mas[kqc]|面|仮面)")
_HALF_KNOWN = 0.7
"""How far a known word is believed that does not end its name: lantern slide, grape shot, folder (container).

Of 57 such words of names in English, 38 said the class (vocabularies of six museums and thesauri, the half of them that
was looked at); in Romance and Slavic languages, where adjectives stand behind their noun, all 23.
"""
_AFTER_ANOTHER = 0.87
"""How far one is believed that stands behind the name of another kind of thing: knife plate, dice shaker.

Of 53 such names of vocabularies 46 were of its class; of 239 without 230.
"""
_ADJECTIVE = re.compile(
    r"(?:[aoi]s?|[nk]y|ed|made|(?:ique|phe|aire|euse|eux|ante|ee|ale|elle|ien|ienne|ois|oise|ais|aise)s?|[^\x00-\x7f])$"
)
"""How an unknown word ends, folded, that may be an adjective behind its noun: vaso etrusco, masque funéraire."""
_SHORT = 2  # letters up to which an unknown word behind a noun is a number or the like: chair II
_BLANK = ("", "(not assigned)", "not assigned", "unclassified", "uncategorized", "unknown", "n/a", "none", "-")


@dataclass(frozen=True)
class Readings:
    """What each part of a record says of the class by itself; None for a part that says nothing.

    Attributes
    ----------
    decided : RuleMatch
        The rule that decides where the rules alone do.
    outright : bool
        Whether nothing else is asked: an identifier, or a rule of the museum's own.
    name, title : RuleMatch or None
        The rule of the naming word of object name and title.
    classification : RuleMatch or None
        The rule of what the museum classes it as.
    medium : RuleMatch or None
        The rule of what it is made of.
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


_TECHNIQUE = re.compile(
    r"(.{3,120}?)(?:[,;]\s+|\s+\()([^,;()]{3,60}(?:[,;]\s[^,;()]{3,40})?)\)?(?:,\s\w+)?[\s.]*", re.DOTALL
)
_CAPTION = re.compile(
    r".{3,200}?[,;]\s+(?:c\.?|ca\.?|circa|about|um|vers)?\s*"
    r"(?:\d{3,4}(?:\s?[-\u2013/]\s?\d{2,4})?s?|\d{1,2}(?:st|nd|rd|th)\s(?:c\.|cent\.|century)(?:\s?BCE?|\s?CE)?)"
    r"(?:\s?(?:BCE?|CE|AD))?[,;.]\s+([^\d]{3,120}?)\s*\.?\s*",
    re.DOTALL,
)
"""A caption with its medium behind the date: "Barye, Lion Crushing a Serpent, 1832, bronze"."""


def _with_technique(item: Item) -> Item:
    """Return a record without a medium whose name or title ends with one: "Madonna, oil on panel", or as a caption."""
    if item.medium or item.material:
        return item
    for field in ("object_name", "title"):
        caption = _CAPTION.fullmatch(getattr(item, field)[:READ])
        if caption and begins_with_material(caption[1]):
            return replace(item, medium=caption[1])
        found = _TECHNIQUE.fullmatch(getattr(item, field)[:READ])
        if found and any(rule.object_class in PICTURES for rule in _made(rules(), stuff("", found[2]))):
            return replace(item, medium=found[2])
    return item


def as_classed(item: Item) -> Item:
    """Return a record as it is classed: with the technique that its name or title ends with, where it has no medium.

    Where its object name is only a kind of things, such as ceramics, that is its classification.

    Parameters
    ----------
    item : Item
        Any.

    Returns
    -------
    Item
    """
    item = _with_technique(item)
    if item.classification or not item.title or fold(item.object_name).strip() not in KINDS_ONLY:
        return item
    return replace(item, classification=item.object_name, object_name="")


def readings(item: Item, among: RuleTable | None = None) -> Readings:
    """Return what each part of a record says of the class, and the rule that decides among them."""
    of = among or rules()
    unnamed = not item.object_name
    item = as_classed(item)
    if item.aat:
        recorded = identifiers(item.aat) & of.aat
        for rule in of.rules if recorded else ():
            shared = rule.aat & recorded
            if shared and rule.fits(item):
                return Readings(RuleMatch(rule, f"AAT {min(shared)}"), outright=True)
    kinds = _kinds(item.classification) | _kinds(item.object_name)
    classed, made = _wordless(item, kinds, of)
    title = _named(item, item.title, kinds, of)
    if title is not None and item.object_name and title.word in NAMED_AFTER:
        title = None
    bare = _is_bare(item)
    name = _named(item, item.object_name, kinds, of, alone=bare) if item.object_name else _made_as(item, kinds, of)
    # What a table of classifications knows, such as silkscreen, is no screen.
    called = _kinds(item.object_name)
    if name is None and item.object_name and not any(rule.kinds & called for rule in of.classed):
        text, share = akin(item.object_name[:READ], of)
        kin = _named(item, text, kinds, of)
        if kin is not None:
            name = replace(kin, share=share)
        elif title is None:
            # Of "Furniture and woodwork" the title "Armchair" says more.
            name = _headed(item, of)
    elif name is not None and item.object_name:
        share = _believed_at(item.object_name[:READ], name.word, of)
        name = replace(name, share=min(name.share, share, homographs().get(name.word, 1.0)))
    if classed is None and item.classification:
        classed = _named(item, item.classification, kinds, of)
        if name is title is None and classed is not None:
            # Of a minke whale the preparation, "articulated skeleton", names the thing.
            name, classed = classed, None
    if name is None and title is not None and not item.object_name and _is_full(item.title, title):
        name = title
    if name is not None and title is not None and (_narrows(title, name, item) or _one_of_types(title, item, of)):
        name = title
    # What is painted, drawn or printed is flat, whatever its title says that it shows, but for its own format.
    flat = made is not None and made.rule.object_class in PICTURES
    named_so = name is not None and name.rule.name not in of.own and name.rule.object_class in (*_FIGURES, "bust")
    if flat and named_so and fold(item.object_name).strip() not in SCULPTURES:
        # A Madonna of oil on panel is a picture, in whatever field she is named.
        name = None
    speaks = title if not flat or (title is not None and title.rule.name in FORMATS) else None
    if name is not None and name.rule.object_class in _THINGS and _OF_TECHNIQUE.search(fold(item.classification)):
        classed = None
    if classed is not None and speaks is title is not None and _is_only_called_so(title, classed, unnamed=unnamed):
        speaks = None
    called_so = name or speaks
    if called_so is not None and called_so.rule.name in FORMATS:
        # What is on a folding screen or a handscroll is painted, on paper, and classed so: it does not hang for that.
        classed, made = (None if one and one.rule.object_class in PICTURES else one for one in (classed, made))
    found = [one for one in (called_so, classed, made) if one is not None]
    decided = min(found, key=lambda one: one.rule.position, default=RuleMatch(of.rules[-1]))
    return Readings(decided, decided.rule.name in of.own, name, classed, made, title)


def _is_only_called_so(title: RuleMatch, classed: RuleMatch, *, unnamed: bool) -> bool:
    """Whether a title names what is classed as sculpture a picture, or a thing of no shape of its own: Still Life."""
    what = title.rule.object_class
    # A plaster cast of a column, which that is the name of, is a column.
    called = what in PICTURES or (unnamed and what == "object")
    return called and classed.rule.object_class in (*_FIGURES, "bust", "relief")


def without_name(read: Readings, of: RuleTable | None = None) -> Readings:
    """Return what a record says if the word that names its thing is not the one that it was taken for."""
    found = [one for one in (read.title, read.classification, read.medium) if one is not None]
    least = RuleMatch((of or rules()).rules[-1])
    return replace(read, name=None, decided=min(found, key=lambda one: one.rule.position, default=least))


def _is_full(text: str, title: RuleMatch) -> bool:
    """Whether a title is the full name of its thing: what it is made of, or in Japanese its ornament, and its name."""
    if title.rule.object_class in _BODIES and len(text.split()) <= _WORDS_OF_NAME and OF_STUFF.match(fold(text)):
        return True
    word = title.word.removeprefix("*")
    folded = fold(text)
    if not IDEOGRAPH.match(word) or not folded.endswith(word):
        return False
    ornament = title.rule.object_class not in _FIGURES and _IN_FULL.fullmatch(folded.removesuffix(word))
    return bool(ornament or _MADE_OF.match(text))


def _one_of_types(title: RuleMatch, item: Item, of: RuleTable) -> bool:
    """Whether a title names a type behind the first of several that semicolons part: "gem; ewer", of an ewer."""
    if title.rule.object_class in PICTURES or ";" not in item.object_name:
        return False
    titled = _candidates(item.title[:READ], of)
    return any(word in titled for part in item.object_name[:READ].split(";")[1:] for word in _candidates(part, of)[:1])


def _narrows(title: RuleMatch, name: RuleMatch, item: Item) -> bool:
    """Whether a title names a kind of what the object name says: a Kronleuchter is a Leuchter, and no candlestick.

    Where the name is of a light in general, a title that names one which hangs is of that kind whatever its words are.
    """
    if {title.rule.object_class, name.rule.object_class} & set(PICTURES):
        return False
    kind, thing = title.word.removeprefix("*"), name.word.removeprefix("*")
    hangs = (name.rule.name, title.rule.name) == LIGHTS and thing in ANY_LIGHT
    lidded = kind.rpartition(" ")[2] in LIDS  # a copa con tapa is a copa still, where a pahar cu picior is a goblet
    longer = kind != thing and bool(thing) and (kind.endswith(thing) or (kind.startswith(f"{thing} ") and not lidded))
    carved = fold(item.object_name).strip() in SCULPTURES and (
        title.rule.object_class in _CARVED or title.rule.name == LIGHTS[1] or bool(_MASK.match(title.word))
    )
    small = title.rule.name not in _LARGE_PIECES and kind.rpartition(" ")[2] in FRAGMENTS
    return hangs or longer or carved or (bool(thing) and small)


def _wordless(item: Item, kinds: frozenset[str], of: RuleTable) -> tuple[RuleMatch | None, RuleMatch | None]:
    """Return the first rule that asks for the classification and no name, and the first that asks for neither."""
    asked = of.classed if kinds else ()
    classed = next((RuleMatch(rule) for rule in asked if rule.kinds & kinds and rule.fits(item)), None)
    for rule in _made(of, stuff(item.material, item.medium)):
        if all(shape(item) for shape in rule.shapes):
            return classed, RuleMatch(rule)
    return classed, None


# Many objects are made of the same.
@lru_cache(maxsize=16384)
def _made(of: RuleTable, made: str) -> tuple[Rule, ...]:
    """Return the rules that ask for neither name nor classification whose medium is in a text, but for the last."""
    return tuple(rule for rule in of.wordless[:-1] if rule.medium is None or rule.medium.search(made))


def _made_as(item: Item, kinds: frozenset[str], of: RuleTable) -> RuleMatch | None:
    """Return the rule of a medium that is the name of a thing: porcelain charger with terra sigillata; no list is."""
    head = [] if re.search(r"[,;\d]", item.medium) else BREAK.split(fold(item.medium[:READ]), maxsplit=1)[0].split()
    found = _named(item, " ".join(head), kinds, of) if 2 <= len(head) <= 4 else None
    if found is None or found.rule.object_class not in _THINGS or found.word in _NOT_THINGS:
        return None
    return found if head[-1] in (found.word, f"{found.word}s") else None


def _named(item: Item, text: str, kinds: frozenset[str], of: RuleTable, *, alone: bool = False) -> RuleMatch | None:
    """Return the first rule of the first naming word of a text that has one which fits.

    alone : whether a word counts whose rules ask for more than a record says that has nothing but this name
    """
    if not text:
        return None
    large: RuleMatch | None = None
    for word in _candidates(text[:READ], of):
        rules_of = of.by_word.get(word) or of.by_ending.get(word[1:], ())
        for rule in rules_of:
            if (not rule.kinds or rule.kinds & kinds) and rule.fits(item):
                found = RuleMatch(rule, f"named {word!r}", word)
                if rule.name not in _LARGE_PIECES:
                    return found
                large = large or found
                break
        if alone:
            return RuleMatch(rules_of[-1], f"named {word!r}", word, _HALF_KNOWN)
    return large


_LARGE_PIECES = ("fragment-slab", "fragment-large")
"""Rules of large pieces of anything: what else a name says of them goes first."""


def _is_bare(item: Item) -> bool:
    """Whether a record says nothing of a thing but what it is called."""
    return not any((item.classification, item.material, item.medium, item.height_m, item.width_m, item.depth_m))


def _headed(item: Item, of: RuleTable) -> RuleMatch | None:
    """Return the rule of what things are classed as by the last word of an object name or the first."""
    words = WORD.findall(next(_parts(_plain(item.object_name[:READ])), ""))
    for word in (*words[-1:], *heads_of(words[-1]), *words[:1]) if words else ():
        classed, _ = _wordless(item, _kinds(word), of)
        if classed is not None:
            return replace(classed, evidence=f"named {word!r}", word=word, share=_HALF_KNOWN)
    return None


_DOING = re.compile(
    r"(?<=\w\w)\s(?:\w{2,}ing\s(?:a|an|the|his|her|its|their|two|three)"
    r"|(?!enfant|elephant|geant|diamant|volant|croissant|mendiant|etudiant|marchand)\w{3,}ant\s(?:une?|l[ea]s?|l|son|sa|ses|des|deux)"
    r"|che\s\w{2,}\s(?:un|una|il|lo|la|l|i|gli|le)"
    r"|(?:\w{2,}(?:ando|endo|indo)|que\s\w{2,})\s(?:una?|uno|uma?|el|la|los|las|sus?|o|a|seu|sua|il|lo|l|gli|le))\b"
)
"""What somebody does, with what is no name of the thing: "Woman holding a vase", "Venus removing her sandal"."""


@lru_cache(maxsize=16384)
def _candidates(text: str, of: RuleTable) -> tuple[str, ...]:
    """Return the known words and *endings of an object name or title, the likeliest name of the thing first."""
    folded = _plain(text)
    doing = _DOING.search(folded)
    if doing is not None:
        folded = folded[: doing.start()]
    # A phrase such as "montre de poche" goes over what would else break it; it must stand at the beginning.
    start = of.spanning.match(folded) if of.spanning is not None else None
    kind = _KIND.search(folded)
    out = [] if kind is None else [one for one in _spelt(of, kind.group(1).split()) if of.names(one, PICTURES)]
    out += [] if start is None else _spelt(of, WORD.findall(start.group()))
    small = _MODEL.match(folded)
    out += [] if small is None or BREAK.match(folded, small.end() - 1) else _spelt(of, [small.group(1)])
    piece = _OF_SERVICE.search(folded)
    for inner in () if piece is None else (BREAK.split(piece.group(1))[0], piece.group(1)):
        out += (*_spelt(of, WORD.findall(inner)), *_spelt(of, WORD.findall(inner)[-1:]))
    out += _inverted(folded, of)
    only = _PART.search(folded)
    if only is not None:
        out += _spelt(of, [only.group(1)])
    thing, _, ornament = folded.partition(" ")
    if ornament and IDEOGRAPH.match(thing) and IDEOGRAPH.match(ornament) and thing in of.by_word:
        out.append(thing)  # 硯箱 猿月取蒔絵: a Japanese catalogue may name the thing first, and then what is on it
    parts = list(_parts(folded))
    if len(parts) == 2 and _JOINED_LID.search(folded):
        # Sugarbowl and cover: the lid is no thing of its own, and what has one is a vessel where nothing else is known.
        parts, lidded = parts[:1], [LIDDED] if LIDDED in of.by_word else []
    else:
        lidded = []
    for part in parts:
        found = WORD.findall(part)
        if len(found) > 1 and found[-1] in _ON_WALLS and of.names(found[-2], ("relief",)):
            found.pop()
        said = [
            (end - 1 - len(before), word)
            for end in range(len(found), 0, -1)
            for before, word in known(of, found[end - 1])
            if not before or before == tuple(found[max(0, end - 1 - len(before)) : end - 1])
        ]
        if HEAD_FIRST.search(part):
            said.sort(key=lambda pair: (pair[0], -len(pair[1])))
        out += [word for _, word in said]
    return (*out, *lidded)


def _plain(text: str) -> str:
    """Return an object name or title, folded, without what stands ahead of the name of the thing."""
    return _IN_SMALL.sub("", _OF_MANY.sub("", _OF_SET.sub("", _MARK.sub(" , ", fold(text)))))


def _believed_at(text: str, word: str, of: RuleTable) -> float:
    """Return how far a known word is believed by where it stands in an object name: less where others are unknown."""
    folded = _plain(text)
    part, kind = _PART.search(folded), _KIND.search(folded)
    lone = " " in word or IDEOGRAPH.search(word) or re.search(r"[/;|]", folded)
    if (part and part.group(1) == word) or (kind and of.names(word, PICTURES) and kind.group(1).startswith(word)):
        return 1.0
    inner = [] if kind is None else WORD.findall(kind.group(1))
    said = [one for before, one in known(of, inner[-1]) if not before] if inner else []
    if said and of.class_of(said[0]) != of.class_of(word):
        return _HALF_KNOWN  # Sledge (hammer), Canister (shot)
    if lone:
        return 1.0
    first = next((found for one in _parts(folded) if (found := WORD.findall(one))), [])
    for at in range(len(first) - 1, -1, -1):
        if any(found == word for _, found in known(of, first[at])):
            behind = [one for one in first[at + 1 :] if len(one) > _SHORT]
            if not all(map(_ADJECTIVE.search, behind)):
                return _HALF_KNOWN
            ahead = (known_one for one in first[:at] for before, known_one in known(of, one) if not before)
            return _AFTER_ANOTHER if any(of.class_of(one) != of.class_of(word) for one in ahead) else 1.0
    return _HALF_KNOWN


def _parts(folded: str) -> Iterator[str]:
    """Yield the parts of a name in which its thing may stand; none behind a word for what it has or is made of."""
    at, behind = 0, ""
    for mark in (*BREAK.finditer(folded), None):
        part = folded[at : len(folded) if mark is None else mark.start()]
        if not (_BESIDE.fullmatch(behind) or (behind.strip().isalpha() and _STUFF.search(part))):
            yield part
        if mark is not None:
            at, behind = mark.end(), mark.group()


def _inverted(folded: str, of: RuleTable) -> Iterator[str]:
    """Yield the phrases that a name says in inverted order, as the nomenclature of many museums does: Clock, Wall."""
    found = _INVERTED.fullmatch(folded)
    if found is not None:
        kind, thing = WORD.findall(found[2]), WORD.findall(found[1])
        for before, word in known(of, thing[-1]) if kind and thing else ():
            if before and before == tuple((*kind, *thing[:-1])[-len(before) :]):
                yield word


def _spelt(of: RuleTable, words: list[str]) -> Iterator[str]:
    """Yield a phrase as the table spells it."""
    for form in forms(words[-1]) if words else ():
        phrase = " ".join((*words[:-1], form))
        if phrase in of.by_word:
            yield phrase


@lru_cache(maxsize=4096)
def _kinds(text: str) -> frozenset[str]:
    """Return a classification or object name, whole and in its parts, in the singular."""
    folded = _SMALL_BEHIND.sub("", fold(text).strip().replace("&", "and"))
    if folded in _BLANK:
        return frozenset()
    parts = (folded, *re.split(r"[|;,/-]", folded))
    return frozenset(singular(part.strip()) for part in parts if part.strip())
