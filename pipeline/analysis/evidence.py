"""Evidence for the class of an object: what each part of its record says, weighed, as a probability of every class.

A multinomial logistic model (Hastie, Tibshirani and Friedman 2009, The elements of statistical learning, sec. 4.4):

.. math:: P(c) \\propto \\exp \\left( b_c + \\sum_f a_f [v_f = c] + \\sum_s w_{s,c} \\right)

with v_f the class that field f by itself says (by the rules of `pipeline.analysis.rules`), a_f how far fields are to be
believed, and w the weights of signs s: the class and the rule of each field, materials, words of parts and of the
department (which stands for the gallery where an export tells no other), and measures in steps.  A floor under all
classes stands for museums that mean other things by their words.  tables/class_weights.csv holds a, b and w;
`pipeline.verification.class_fit` finds them from labelled objects.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import starmap
from math import log
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from pipeline.analysis.rule_table import RuleMatch, RuleTable, fold, stuff, words_of
from pipeline.analysis.rules import PICTURES, Readings, as_classed, readings, without_name
from pipeline.analysis.shapes import SHAPES, faceless
from pipeline.collection.dimensions.lexicon import words_for
from pipeline.records import Item
from pipeline.tables import table
from pipeline.tables.assumed_rows import WHEN_HELD
from pipeline.tables.rows import Text, checked, once

BIAS = "any"
"""The sign that every object has."""
AGREES = "says so"
"""After the name of a field: that it says the class itself."""
FIELDS = ("name", "classification", "medium", "title")
"""The parts of `Readings` that say a class."""
BESIDE = "title beside a name"
"""What a title says where an object name says what the thing is: it counts for less."""
ALONE = "title alone"
"""What a title says where nothing else speaks: it may as well name what a picture shows."""
NOTHING = "nothing"
"""What decides where no part of the record says a class."""
SAYING = (*FIELDS, BESIDE, ALONE, *(f"decided by {field}" for field in (*FIELDS, NOTHING)))
"""What has a say: each part, and the rule that decides, by the part that it comes from."""
POSSIBLE = 0.02
"""Probability from which a class is likely at all."""
GALLERY = "gallery"
"""Field of signs that count only where there are any: most galleries are rooms, whose names say nothing."""
SILENT = "silent"
"""What a part of a record says that names no class."""
IDENTIFIED = 0.97
"""Probability of a class that an identifier of the Getty AAT gives: records hold those of parts too (judgement)."""
SIZES = (0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0)
"""Steps of the largest dimension [m]."""
HEIGHTS = (0.15, 0.5, 0.75, 1.0, 1.8, 4.0, 9.0)
"""Steps of the height over the larger plan dimension."""
DEPTHS = (0.05, 0.12, 0.25, 0.5)
"""Steps of the smallest dimension over the middle one."""
LONG = (2, 3, 4, 6)
"""Steps of the number of words of a title that stands alone."""
FORMS: Mapping[str, re.Pattern[str]] = {
    "digits": re.compile(r"\d"),
    "behind a comma": re.compile(r"[,:;]"),
    "in brackets": re.compile(r"[(\[]"),
    "quoted": re.compile('["\u201c\u201e\u00ab]'),
    "begins with an article": re.compile(
        r"(?:the|der|die|das|le|la|les|il|lo|gli|el|los|las|os|as|de|het)\s|l['\u2019]"
    ),
}
"""How a title may be formed that stands alone, folded."""
PICTURED = 0.03
"""Probability of a picture from which a title alone does not make a thing that stands: it leaves 1 of 500 pictures."""
FACE = 0.5
"""Depth over the smaller side of its face up to which a thing may be a picture in its frame (judgement)."""
SURE = 0.5
"""Probability from which materials and measures alone say a class, or that a thing is a sculpture or the like."""
UNNAMED_SURE = 0.8
"""The same where nothing but a name is said, which the rules do not know: what may stand is held to (judgement)."""
RATHER = 0.35
"""The same of a body that is the likeliest class beside a bare material and a free title."""
FACED = 0.3
"""Smaller side of a face [m] from which a slab of a bare material hangs on a wall (guide of the labels)."""
BODIES = ("statue", "standing_figure", "figurine", "object")
"""Classes of what a title such as "Dancer" names beside a bare material; all of them stand."""
FLOOR = 0.02
"""Chance that a museum means by its words what no labelled museum means: shared alike by all classes.

It is what the scatter between museums that were left out leaves over: see pipeline.verification.class_scores.
"""
SEVERAL, FIRST = 2, 2.0
"""Things from which an object name names several, and what the first of them counts for (judgement)."""
BARE: Mapping[str, Any] = {"object_name": "?", "gallery": "", "height_m": None, "width_m": None, "depth_m": None}
"""What a record says that has nothing but an object name, of which nothing is known."""
_AND = re.compile(r"[;|\n]")
"""What parts several names of things in one cell."""
_READ = 400
"""Characters of a text that are searched."""
_WORD = re.compile(r"[^\W\d_]+")


@cache
def _pictured_parts() -> re.Pattern[str]:
    """Return what finds what is measured of pictures alone: a frame, a sheet, an image, a canvas."""
    words = sorted(words_for("framed", "frame", "unframed", "sheet", "image", "sight"), key=len, reverse=True)
    return re.compile(rf"\b(?:support\s*:|(?:{'|'.join(map(re.escape, words))})\b)", re.IGNORECASE)


class _UnknownName(BaseModel):
    name: Annotated[Text, Field(alias="class")]
    share: Annotated[float, Field(gt=0.0, lt=1.0)]
    source: Text


@dataclass(frozen=True)
class Chance:
    """Probability of one class."""

    object_class: str
    probability: float


@dataclass(frozen=True)
class _Sign:
    name: str
    field: str
    pattern: re.Pattern[str]


@cache
def _signs() -> tuple[_Sign, ...]:
    return tuple(_Sign(row["sign"], row["field"], words_of(row["words"].split("|"))) for row in table("class_signs"))


@lru_cache(maxsize=65536)
def _signs_in(field: str, text: str) -> tuple[str, ...]:
    found = tuple(
        f"{field}: {sign.name}" for sign in _signs() if sign.field == field and sign.pattern.search(text[:_READ])
    )
    if found or field in (GALLERY, ALONE):
        return found
    return (f"{field}: nothing known",) if text.strip() else (f"{field}: none",)


def _step(value: float, steps: tuple[float, ...]) -> str:
    at = bisect_right(steps, value)
    if at == 0:
        return f"below {steps[0]:g}"
    return f"{steps[at - 1]:g} to {steps[at]:g}" if at < len(steps) else f"from {steps[-1]:g}"


def _measures(item: Item) -> tuple[str, ...]:
    sizes = sorted(size for size in (item.height_m, item.width_m, item.depth_m) if size)
    if not sizes:
        return ("sizes: none",)
    out = [f"sizes: {len(sizes)}", f"largest: {_step(sizes[-1], SIZES)}"]
    plan = max(item.width_m or 0.0, item.depth_m or 0.0)
    if item.height_m and plan:
        out.append(f"height over plan: {_step(item.height_m / plan, HEIGHTS)}")
    if len(sizes) == 3:
        out.append(f"thinnest: {_step(sizes[0] / sizes[1], DEPTHS)}")
    return tuple(out)


def _title_alone(item: Item, read: Readings) -> tuple[str, ...]:
    """Return how a title is formed beside which nothing says what the thing is, and how many sizes there are."""
    title = fold(item.title[:_READ])
    words = _WORD.findall(title)
    sizes = sum(size is not None for size in (item.height_m, item.width_m, item.depth_m))
    out = [f"{ALONE}: words {_step(len(words), LONG)}", f"{ALONE}: sizes {sizes}"]
    if read.title is not None and words:
        name = read.title.word.removeprefix("*").split()
        out.append(f"{ALONE}: {'ends' if name[-1] in words[-1] else 'goes on behind'} with its name")
        out.append(f"{ALONE}: beside its name {_step(len(words) - len(name), LONG)}")
    out += (f"{ALONE}: {form}" for form, pattern in FORMS.items() if pattern.search(title))
    return (*out, *(sign for sign in _signs_in(ALONE, title)))


def is_alone(item: Item, read: Readings) -> bool:
    """Say whether nothing but a title says what a thing is, and it may as well be what a picture shows."""
    return read.name is None and not any((item.object_name, item.classification, item.material, item.medium))


def is_unknown(item: Item, read: Readings) -> bool:
    """Say whether a record has an object name of which neither rules nor signs know a word, and no other words."""
    if not read.silent or any((item.title, item.classification, item.material, item.medium)):
        return False
    return _signs_in("title", fold(item.object_name)) == ("title: nothing known",)


def signs_of(item: Item, read: Readings) -> tuple[str, ...]:
    """Return the signs that an object shows: what the model weighs."""
    out, decisive = [BIAS], NOTHING
    item = as_classed(item)
    alone = is_alone(item, read)
    # A name that only repeats the classification, such as sculpture, leaves the title its say.
    named = read.name is not None and fold(item.object_name) != fold(item.classification)
    for field in FIELDS:
        one: RuleMatch | None = getattr(read, field)
        part = field
        if field == "title":
            part = ALONE if alone else BESIDE if named else field
        if one is None:
            out.append(f"{part}: {SILENT}")
        else:
            out += (f"{part}: {one.rule.object_class}", f"rule of {part}: {one.rule.name}")
            decisive = field if one is read.decided else decisive
    if alone:
        out += _title_alone(item, read)
    else:
        out.append(f"decided by {decisive}: {read.decided.rule.object_class}")
    out += _signs_in("medium", stuff(item.material, item.medium))
    out += _signs_in("title", fold(item.title or item.object_name))
    out += _signs_in(GALLERY, fold(item.gallery))
    out += _measures(item)
    return tuple(out)


@dataclass(frozen=True, eq=False)
class Weights:
    """The weights of tables/class_weights.csv.

    Attributes
    ----------
    classes : tuple of str
        Their names.
    of_sign : Mapping[str, NDArray[np.float64]]
        By sign, the weight for each class.
    agreeing : mapping of str to float
        By field, the weight of the class that it says.
    """

    classes: tuple[str, ...]
    of_sign: Mapping[str, NDArray[np.float64]]
    agreeing: Mapping[str, float]

    def scores(self, signs: tuple[str, ...]) -> NDArray[np.float64]:
        """Return the score of each class: the logarithm of its probability but for a constant."""
        return np.asarray(np.add.reduce([self.weight(sign) for sign in signs]))

    def weight(self, sign: str) -> NDArray[np.float64]:
        """Return what one sign says for each class."""
        return _weight(self, sign)


@lru_cache(maxsize=65536)
def _weight(of: Weights, sign: str) -> NDArray[np.float64]:
    out = np.array(of.of_sign.get(sign, np.zeros(len(of.classes))))
    field, _, named = sign.partition(": ")
    if named in of.classes and field in of.agreeing:
        out[of.classes.index(named)] += of.agreeing[field]
    return out


def read_weights(rows: tuple[Mapping[str, str], ...], classes: tuple[str, ...]) -> Weights:
    """Return the rows of a table of weights, ready to use."""
    of_sign: dict[str, NDArray[np.float64]] = {}
    agreeing: dict[str, float] = {}
    for row in rows:
        if row["class"] == AGREES:
            agreeing[row["sign"]] = float(row["weight"])
        else:
            of_sign.setdefault(row["sign"], np.zeros(len(classes)))[classes.index(row["class"])] = float(row["weight"])
    return Weights(classes, of_sign, agreeing)


@cache
def weights() -> Weights:
    """Return Kouros's own weights."""
    return read_weights(table("class_weights"), tuple(row["class"] for row in table("classes")))


def shares_of(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the probabilities of scores (along the last axis), with the floor that every class keeps."""
    shares = np.exp(scores - scores.max(axis=-1, keepdims=True))
    shares /= shares.sum(axis=-1, keepdims=True)
    return np.asarray((1.0 - FLOOR) * shares + FLOOR / scores.shape[-1])


@lru_cache(maxsize=65536)
def _chances(signs: tuple[str, ...]) -> tuple[Chance, ...]:
    of = weights()
    shares = shares_of(of.scores(signs))
    order = np.argsort(-shares, kind="stable")
    return tuple(Chance(of.classes[at], float(shares[at])) for at in order)


@cache
def _unknown() -> NDArray[np.float64]:
    """Return how often things whose name the rules do not know are of each class."""
    rows = checked(_UnknownName, table("unknown_names"), "unknown_names.csv", named="class")
    once((row.name for row in rows), "class", "unknown_names.csv")
    shares = {row.name: row.share for row in rows}
    return np.array([shares[name] for name in weights().classes])


@lru_cache(maxsize=4096)
def _of_unknown_name(signs: tuple[str, ...], bare: tuple[str, ...]) -> tuple[Chance, ...]:
    """Return the chances of a thing of which nothing is said but a name that the rules do not know.

    That is how often such things are of each class, times what its measures and department say.

    signs, bare : the signs of the object, and of its name alone
    """
    of = weights()
    shares = shares_of(np.log(_unknown()) + of.scores(signs) - of.scores(bare))
    order = np.argsort(-shares, kind="stable")
    return tuple(Chance(of.classes[at], float(shares[at])) for at in order)


def chances_of(item: Item, read: Readings, among: RuleTable | None = None) -> tuple[Chance, ...]:
    """Return the probability of each class, the likeliest first.

    One class alone where an identifier or a rule of the museum's own decides; none where the record names nothing.  An
    object name that names several things, parted by semicolons, is each of them with a share.

    Parameters
    ----------
    among : RuleTable or None, optional
        The table of rules by which the record was read; None for Kouros's own.

    Returns
    -------
    tuple of Chance
    """
    if read.silent and not any((item.title, item.object_name, item.classification, item.material, item.medium)):
        return ()
    if read.outright:
        certain = IDENTIFIED if read.decided.evidence.startswith("AAT") else 1.0
        return (Chance(read.decided.rule.object_class, certain),)
    if is_unknown(item, read):
        return _of_unknown_name(signs_of(item, read), signs_of(replace(item, **BARE), read))
    shares = _several(item, read, among) or _believed(item, read, among)
    if not shares:
        return _chances(signs_of(item, read))
    found: dict[str, float] = {}
    for share, signs in shares:
        for one in _chances(signs):
            found[one.object_class] = found.get(one.object_class, 0.0) + share * one.probability
    return tuple(sorted(starmap(Chance, found.items()), key=lambda one: -one.probability))


def _believed(item: Item, read: Readings, among: RuleTable | None) -> list[tuple[float, tuple[str, ...]]]:
    """Return the signs with and without a name that is only akin to a known word, with the share of each."""
    share = 1.0 if read.name is None else read.name.share
    if share == 1.0:
        return []
    return [(share, signs_of(item, read)), (1.0 - share, signs_of(item, without_name(read, among)))]


def _several(item: Item, read: Readings, among: RuleTable | None) -> list[tuple[float, tuple[str, ...]]]:
    """Return the signs of each of several things that an object name names, with its share; [] where it names one.

    The first counts for two of the others.  Where the title names one of them, that is meant.
    """
    names = [name for name in _AND.split(item.object_name[:_READ]) if name.strip()]
    if len(names) < SEVERAL or (read.title is not None and read.name is read.title):
        return []
    each = [replace(item, object_name=name) for name in dict.fromkeys(names)]
    said = [(one, told) for one in each if (told := readings(one, among)).name is not None]
    if len({told.name.rule.object_class for _, told in said if told.name is not None}) < SEVERAL:
        return []
    parts = [FIRST, *(1.0 for _ in said[1:])]
    return [(part / sum(parts), signs_of(one, told)) for part, (one, told) in zip(parts, said, strict=True)]


def taken_of(item: Item, read: Readings, chances: Sequence[Chance]) -> Chance | None:
    """Return what an object is taken for among the chances of its classes; None where its record names no class.

    That is the likeliest class, but where nothing but a title speaks, and no depth says that it is a body. A title may
    as well name what a picture shows, and what is taken for a picture is then not held to stand. Where the title names
    nothing either, the face of a picture must be there, two sizes far larger than any depth: one size, or none,
    is no sign of a picture, nor is a block of any size.  Where the frame or the sheet was measured, it is one.
    """
    if not chances:
        return None
    first = chances[0]
    if is_alone(item, read) and not read.outright and SHAPES["panel"](item) and not faceless(item):
        flat = next(one for one in chances if one.object_class in PICTURES)
        if _pictured_parts().search(item.dimensions[:_READ]):
            return flat
        faced = item.height_m and item.width_m and (item.depth_m or 0.0) <= FACE * min(item.height_m, item.width_m)
        if item.title and (faced or not read.silent):
            return flat if first.object_class in _standing() and flat.probability >= PICTURED else first
    if not read.silent or first.probability >= (UNNAMED_SURE if is_unknown(item, read) else SURE):
        return first
    if item.object_name or item.classification or not (item.material or item.medium):
        return None
    if SHAPES["slab"](item) and min(item.height_m or 0.0, item.width_m or 0.0) >= FACED:
        # No more than a face of a bare material, which cannot stand on so thin an edge.
        return next(one for one in chances if one.object_class == "relief")
    # A free title beside a bare material, as works of sculpture have: bronze, "Dancer".
    body = sum(one.probability for one in chances if one.object_class in BODIES)
    return first if first.object_class in BODIES and body >= RATHER else None


@cache
def _standing() -> frozenset[str]:
    """Return the classes of what stands by itself."""
    return frozenset(
        row["class"] for row in table("classes") if row["support"] == "freestanding" and row["models"] != WHEN_HELD
    )


def leaning(item: Item, read: Readings, first: str, second: str) -> tuple[tuple[str, float], ...]:
    """Return what a decision leans on: signs, and by how much each speaks for the first class against the second.

    That is the natural logarithm of the odds; the strongest first.
    """
    of = weights()
    at, to = of.classes.index(first), of.classes.index(second)
    said = ((sign, float((one := of.weight(sign))[at] - one[to])) for sign in signs_of(item, read))
    return tuple(sorted((pair for pair in said if abs(pair[1]) >= log(1.05)), key=lambda pair: -abs(pair[1])))
