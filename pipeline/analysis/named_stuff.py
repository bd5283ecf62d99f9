"""What a name or a title says that its thing is made of, where no column does: "Longcase, mahogany".

A title may name a material and mean another thing: The Iron Duke, Silver Lake, Mr Stone, an opener of tins.  So it is
read in four forms alone: as all that stands in a part ("Silver, London 1812"); behind a small word of the name of the
thing ("busto in marmo"); beside that name ("Bronze figure", "dzban cynowy"); and as the beginning of a compound
("Zinnkrug", "木造阿弥陀如来坐像").  Of flat works nothing is read.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from pipeline.analysis.akin import known
from pipeline.analysis.rule_table import BREAK, IDEOGRAPH, WORD, RuleTable, fold, rules
from pipeline.records import Item
from pipeline.tables.assumed import AssumedValues
from pipeline.tables.material_words import is_material, material_words

FLAT = ("framed", "wall_painting", "installation", "model")
"""Classes of what shows other things, or is no one body: their names say what is shown (a model of an iron bridge)."""
_SHOWING = ("statue", "standing_figure", "figurine", "bust", "relief", "chandelier")
"""Classes of what may show what its title names: an Iron Horse of wood."""
_CALLED_BY_KIND = re.compile(
    r"(?:figur\w*|statu\w*|estatu\w*|bust\w*|buest\w*|head|kopf|tete|testa|cabeza|cabeca|kop|torso\w*|relief\w*|rilievo"
    r"|relieve|relevo|plaque|group|gruppe|groupe|gruppo|grupo|groep|sculptur\w*|skulptur\w*|scultur\w*|escultur\w*"
    r"|carving|beeld\w*|rzezb\w*|sosk\w*|soch\w*|скульптур\w*|стату\w*|бюст\w*|αγαλμα\w*|ειδωλι\w*|crucifix\w*|kruzifix"
    r"|crocifisso|crucifijo|kruis\w*|imagem|imagen|mobile|chandelier|kronleuchter|lustre)"
)
"""What sculpture is called by its kind, folded: there the word beside it is what it is made of."""
_PARTS = re.compile(r"[,;:()\[\]|/]|\s[-\u2013\u2014]\s")
_IN = re.compile(r"\b(?:in|en|aus|de|di|of|from|em|van|uit|z|ze|из|από|απο|made of|made from)\s+(?:(?:an?|der|d)\s+)?$")
"""Words ahead of what a thing is made of, folded."""
_PROPER = re.compile(r"\b(?:of|from|de|di|van|z|ze)\s+$")
"""Those behind which a capital begins a name: Man of Steel, Wood Street."""
_WORKS_ON = re.compile(
    r"wood stove|crystal (?:radio|set)|(?:\w+ )?(?:"
    r"\w*(?:cutter|opener|cracker|winder|spinner|saw|knife|scales?|balance|press|comb|gin|plane|burner|loom|mill|drill"
    r"|grinder|polisher|trap|waage|sage|messer|presse|kamm|muhle|schere|haspel|schrank|vitrine|bohrer|hobel)"
    r"|machine|tools?|shears|bench|tray|eyes?|board|jubilee|works|maker|street|road|medal|lake|duck)"
)
"""What works on, holds or is called by a material, folded: a bone saw, a Goldwaage, a Glasschrank, a wood stove."""
_WORKED = frozenset(
    {
        *("paper", "ash", "cane", "cotton", "wool", "silk", "straw", "lace", "cloth", "wire", "cork", "carton", "bein"),
        *("textile", "textiles", "fabric", "tissu", "papier", "bark"),
    }
)
"""Materials, folded, that the name of a standing thing has beside it for what it is used for: a paper cabinet."""
_SOFT = ("mounted", "relief", "small_flat")
"""Classes of what is worn or hangs, which those do make: a silk gown."""
_THINGS = frozenset({"tin", "horn", "shell", "cane", "coral", "lead", "reed", "pelt", "canvas", "crystal"})
"""Names of things, folded, that are also materials: a tin of needles is of no tin, and a horn of brass."""
_BEFORE, _HEAD = 3, 3
"""Words up to which a material stands ahead of the name of its thing, and letters that its compound leaves."""
_STONEWARE = ("stein", "vessel")
"""Material and class of a compound that says another: a Steinkrug is of stoneware."""
_STUFFED = re.compile(
    r"\bstuffed (?!with)|\b(?:ausgestopft|empaille|naturalise|impagliat|imbalsamat|disecad|empalhad|vycpan|wypchan"
    r"|чучел|uppstoppa|udstoppe|kitomot)|剥制|剥製|박제"
)
_TOY = re.compile(r"\b(?:toys?|dolls?|teddy|plush|cushions?|pillows?|chair|seat|armchair|sofa|fabric|cloth)\b")
"""What says that an animal is, and what says that a thing is not."""
_TAXIDERMY = "taxidermy"
_READ = 400
"""Characters of a name or title that are searched."""
_DIGIT = re.compile(r"\d")
_COUNTED = re.compile(
    r"(?:an?\s+)?(?:pair|set|paar|paire|coppia|pareja|par|stel)\s+(?:of\s+|de\s+|di\s+|von\s+|d['\u2019])?"
)
"""What stands before the name of things that are several, folded."""


@dataclass(frozen=True)
class _Of:
    """What a name or title is of: the class of the thing, the rules, the words of its name, and whether it is that."""

    object_class: str
    table: RuleTable
    kinds: frozenset[str]
    named: bool

    @property
    def showing(self) -> bool:
        """Whether a title may say what is shown."""
        return self.object_class in _SHOWING and not self.named

    def shown(self, words: list[tuple[int, str]], things: list[int]) -> bool:
        """Whether none of the names of things is of a kind of sculpture, or what the thing itself is called."""
        return not any(_CALLED_BY_KIND.fullmatch(words[at][1]) or words[at][1] in self.kinds for at in things)

    def names(self, word: str) -> bool:
        """Whether a word names a thing by itself."""
        return any(not before for before, _ in known(self.table, word))


def as_made(item: Item, object_class: str, of: RuleTable | None = None) -> Item:
    """Return a record with what its name or title says that it is made of, where nothing else says that.

    Parameters
    ----------
    item : Item
        The record.
    object_class : str
        What it is taken for.
    of : RuleTable, optional
        The table of rules; None for Kouros's own.

    Returns
    -------
    Item
        The same where nothing is told.
    """
    if item.material.strip() or item.medium.strip() or object_class in FLAT:
        return item
    table = of or rules()
    kinds = frozenset(WORD.findall(fold(item.object_name[:_READ])))
    said = _told(item.object_name[:_READ], _Of(object_class, table, kinds, named=True)) or _told(
        item.title[:_READ], _Of(object_class, table, kinds, named=False)
    )
    return item if said is None else _with(item, said, table.values)


def _with(item: Item, said: str, values: AssumedValues) -> Item:
    return replace(item, material=said) if values.material_in(said) is not None else item


def _told(text: str, of: _Of) -> str | None:
    """Return the words for what a thing is made of that its name or title has; None where it has none."""
    if _STUFFED.search(fold(text)) and not _TOY.search(fold(text)):
        return _TAXIDERMY
    parts = [part for part in _PARTS.split(text) if part.strip()]
    for at, part in enumerate(parts):
        bare = is_material(part)
        if at == 0 and bare and not of.named and (of.object_class in _SHOWING or not _dated(parts)):
            continue  # A title that is "Iron", or "Ash, or the end of the world".
        found = part if bare else _beside(part, of) if at == 0 else None
        if found is not None:
            return found.strip()
    return None


def _dated(parts: list[str]) -> bool:
    """Whether what stands behind the first part says a year, or is nothing: "Silver, London 1812"."""
    return len(parts) == 1 or any(_DIGIT.search(part) for part in parts[1:])


def _beside(part: str, of: _Of) -> str | None:
    """Return the material in the first part of a name: behind a small word, beside its thing or within it."""
    folded = fold(part)
    if len(folded) != len(part):
        part = folded  # the places of the words of both are alike only so
    words = [(found.start(), found.group()) for found in WORD.finditer(folded)]
    things = [at for at, (_, word) in enumerate(words) if of.names(word)]
    counted = _COUNTED.match(folded)
    begins = 0 if counted is None else counted.end()
    for at, (start, word) in enumerate(words):
        if word not in material_words():
            continue
        proper = part[start].isupper() and not of.named
        if proper and at > 0 and at + 1 < len(words) and part[words[at + 1][0]].isupper():
            continue
        if _IN.search(folded[:start]) and start > begins:
            ahead = [one for one in things if one < at]
            if (
                ahead
                and not (proper and _PROPER.search(folded[:start]))
                and not (of.showing and of.shown(words, ahead))
            ):
                return part[start : start + len(word)]
        elif not BREAK.search(folded[begins:start] + " ") and _is_beside(words, at, things, of, proper=proper):
            return part[start : start + len(word)]
    return _within([words[at] for at in things] if things else words[:1], of)


def _is_beside(words: list[tuple[int, str]], at: int, things: list[int], of: _Of, *, proper: bool) -> bool:
    """Whether a material stands beside the name of its thing: just ahead of it, just behind it, or as it."""
    word = words[at][1]
    if any(_WORKS_ON.fullmatch(f"{word} {other}") for _, other in words[at + 1 :]):
        return False
    if (word in _WORKED and of.object_class not in _SOFT) or (proper and at == 1 and words[0][1] == "the"):
        return False
    ahead = [one for one in things if at < one <= at + _BEFORE]
    if of.showing and of.shown(words, ahead):
        return False
    return bool(ahead) or (of.named and at in things and word not in _THINGS) or (at - 1 in things and not proper)


def _within(words: list[tuple[int, str]], of: _Of) -> str | None:
    """Return the material with which a compound begins whose rest names a thing: Zinnkrug, 白磁壺."""
    for _, word in words:
        signs = IDEOGRAPH.search(word) is not None
        for long in range(len(word) - 1, 0 if signs else _HEAD, -1):
            stuff, rest = word[:long], word[long:] if signs else word[long:].removeprefix("n")
            worked = stuff in _WORKED and of.object_class not in _SOFT
            if stuff not in material_words() or worked or (stuff, of.object_class) == _STONEWARE:
                continue
            if signs:
                thing = len(stuff) > 1 or of.names(rest)
            else:
                thing = len(rest) >= _HEAD and of.names(rest) and not _WORKS_ON.fullmatch(rest)
                thing = thing and not (of.object_class in _SHOWING and not _CALLED_BY_KIND.fullmatch(rest))
            if thing:
                return stuff
    return None
