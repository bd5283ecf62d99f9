"""The class that an object is taken for: decided by a person, else the likeliest by all that its record says."""

from functools import lru_cache
from typing import NamedTuple

from pipeline.analysis.evidence import FIELDS, POSSIBLE, Chance, chances_of, taken_of
from pipeline.analysis.rule_table import RuleTable
from pipeline.analysis.rules import Readings, readings
from pipeline.records import Item


class TakenClass(NamedTuple):
    """What an object is taken for: its class, why it is that, and the classes that are likely at all."""

    name: str
    words: str
    chances: tuple[tuple[str, float], ...] = ()


def class_of(item: Item, rules: RuleTable | None = None, decided: tuple[str, str] | None = None) -> TakenClass:
    """Return what an object is taken for.

    rules   : the table that decides it; None for Kouros's own
    decided : the class that a person gave it, and their words, in place of the rules
    """
    if decided is not None:
        return TakenClass(*decided)
    read = readings(item, rules)
    chances = chances_of(item, read, rules)
    taken = taken_of(item, read, chances)
    if taken is None:
        return _open(read, _told(chances))
    words = _why(read, taken)
    if taken is not chances[0]:
        words = "title alone: nothing but its title speaks, which may name what a picture shows"
    return TakenClass(taken.object_class, words, _told(chances))


def _open(read: Readings, chances: tuple[tuple[str, float], ...]) -> TakenClass:
    """Return what a record that names no class is taken for: what is left, with the chance that the others leave."""
    name = read.decided.rule.object_class
    others = tuple(pair for pair in chances if pair[0] != name)
    words = f"{read.decided.words}; its record names no class"
    if not others:
        return TakenClass(name, words)
    words += f", {others[0][0]} is the likeliest ({others[0][1]:.2f})"
    left = (name, round(1.0 - sum(chance for _, chance in others), 2))
    return TakenClass(name, words, tuple(sorted((*others, left), key=lambda pair: -pair[1])))


@lru_cache(maxsize=65536)
def _told(chances: tuple[Chance, ...]) -> tuple[tuple[str, float], ...]:
    """Return the classes that are likely at all, with their probability to the hundredth."""
    return tuple((one.object_class, round(one.probability, 2)) for one in chances if one.probability >= POSSIBLE)


WEIGHED = "all that its record says, weighed together"
"""Why an object is of a class that none of its words names."""


def _why(read: Readings, taken: Chance) -> str:
    """Return why an object is of a class: the rule that says so, of those of each part of its record."""
    if read.decided.rule.object_class == taken.object_class:
        return read.decided.words
    found = (one for field in FIELDS if (one := getattr(read, field)) is not None)
    for one in found:
        if one.rule.object_class == taken.object_class:
            return str(one.words)
    return f"evidence: {WEIGHED}"
