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
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from math import log

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.rules import Readings, RuleMatch, fold, stuff, words_of
from pipeline.records import Item
from pipeline.tables import table

BIAS = "any"
"""The sign that every object has."""
AGREES = "says so"
"""After the name of a field: that it says the class itself."""
FIELDS = ("name", "classification", "medium", "title")
"""The parts of `Readings` that say a class."""
BESIDE = "title beside a name"
"""What a title says where an object name says what the thing is: it counts for less."""
NOTHING = "nothing"
"""What decides where no part of the record says a class."""
SAYING = (*FIELDS, BESIDE, *(f"decided by {field}" for field in (*FIELDS, NOTHING)))
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
FLOOR = 0.02
"""Chance that a museum means by its words what no labelled museum means: shared alike by all classes.

It is what the scatter between museums that were left out leaves over: see pipeline.verification.class_scores.
"""
_READ = 400
"""Characters of a text that are searched."""


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
    if found or field == GALLERY:
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


def signs_of(item: Item, read: Readings) -> tuple[str, ...]:
    """Return the signs that an object shows: what the model weighs."""
    out, decisive = [BIAS], NOTHING
    # A name that only repeats the classification, such as sculpture, leaves the title its say.
    named = read.name is not None and fold(item.object_name) != fold(item.classification)
    for field in FIELDS:
        one: RuleMatch | None = getattr(read, field)
        part = BESIDE if field == "title" and named else field
        if one is None:
            out.append(f"{part}: {SILENT}")
        else:
            out += (f"{part}: {one.rule.object_class}", f"rule of {part}: {one.rule.name}")
            decisive = field if one is read.decided else decisive
    out.append(f"decided by {decisive}: {read.decided.rule.object_class}")
    out += _signs_in("medium", stuff(item.material, item.medium))
    out += _signs_in("title", fold(item.title or item.object_name))
    out += _signs_in(GALLERY, fold(item.gallery))
    out += _measures(item)
    return tuple(out)


@dataclass(frozen=True, eq=False)
class Weights:
    """The weights of tables/class_weights.csv.

    classes : their names
    of_sign : by sign, the weight for each class
    agreeing : by field, the weight of the class that it says
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


def chances_of(item: Item, read: Readings) -> tuple[Chance, ...]:
    """Return the probability of each class, the likeliest first.

    One class alone where an identifier or a rule of the museum's own decides; none where the record names nothing.
    """
    if read.silent and not any((item.title, item.object_name, item.classification, item.material, item.medium)):
        return ()
    if read.outright:
        certain = IDENTIFIED if read.decided.evidence.startswith("AAT") else 1.0
        return (Chance(read.decided.rule.object_class, certain),)
    return _chances(signs_of(item, read))


def leaning(item: Item, read: Readings, first: str, second: str) -> tuple[tuple[str, float], ...]:
    """Return what a decision leans on: signs, and by how much each speaks for the first class against the second.

    That is the natural logarithm of the odds; the strongest first.
    """
    of = weights()
    at, to = of.classes.index(first), of.classes.index(second)
    said = ((sign, float((one := of.weight(sign))[at] - one[to])) for sign in signs_of(item, read))
    return tuple(sorted((pair for pair in said if abs(pair[1]) >= log(1.05)), key=lambda pair: -abs(pair[1])))
