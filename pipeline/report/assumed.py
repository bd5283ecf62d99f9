"""What a run assumed, and why measures were passed over, in the reader's units and language.

See `pipeline.records.phrase`: a run stores both in English.
"""

import re
from collections.abc import Mapping

from pipeline.quantities import LENGTHS
from pipeline.records.phrase import Clause, Number
from pipeline.records.phrases import PHRASES
from pipeline.report.language import _, local, parted, said
from pipeline.report.text import bare
from pipeline.report.units import Units

CITED = frozenset({"rule", "case", "words", "aside", "shape", "number"})
"""Places of phrases for what the museum, or somebody else, wrote: it stays as it is."""

REFUSAL = "refusal"
"""The place for a clause within a clause."""

_PLACE = re.compile(r"\{(\w+)\}")
_PRINTED = re.compile(r"Table (\d+)")
_THIN = "\u202f"
_SIGNS = {"": "", "°": "°", "%": "\u00a0%", "kg/m3": f"{_THIN}kg/m³"}


def assumed(text: str, units: Units) -> str:
    """Say what was assumed, or where a number comes from.

    text : as the run stored it, clauses parted by "; "; what no phrase of Kouros wrote stays as it is
    """
    return parted(_clause(clause, units) for clause in text.split("; "))


def rejected(text: str, units: Units) -> str:
    """Say which measure was passed over and why, as the run stored it: its title, a colon, and clauses."""
    title, colon, why = text.partition(": ")
    return f"{said(title)}{colon}{assumed(why, units)}" if colon else said(text)


def rule_words(rule: str) -> str:
    """Return by which rule an object is of its class: the rule's name, and in the reader's language why."""
    name, colon, why = rule.partition(": ")
    told, bracket, found = why.rpartition(" (")
    return f"{name}{colon}{said(told)}{bracket}{found}" if bracket else f"{name}{colon}{said(why)}"


def _clause(clause: str, units: Units) -> str:
    for phrase in PHRASES:
        places = phrase.places(clause)
        if places is not None:
            return _told(phrase, places, units)
    return said(clause)


def _told(phrase: Clause, places: Mapping[str, str | Number], units: Units) -> str:
    written = {
        name: _number(found, units)
        if isinstance(found, Number)
        else found
        if name in CITED
        else _clause(found, units)
        if name == REFUSAL
        else _words(found)
        for name, found in places.items()
    }
    # Not by `format`: what was found may have braces, and a catalogue is checked for the names that it asks for.
    return _PLACE.sub(lambda place: written[place[1]], _(phrase.asked))


def _number(found: Number, units: Units) -> str:
    if found.unit in LENGTHS:
        value, *ends = found.si
        return units.text(value, "m") + (f" ({units.bare(ends[0], ends[1], 'm')})" if ends else "")
    best, *span = (local(text.replace("-", "−")) for text in found.texts)
    sign = _SIGNS.get(found.unit, f"{_THIN}{found.unit}")
    return best + sign + (" (" + _("%(low)s to %(high)s") % {"low": span[0], "high": span[1]} + ")" if span else "")


def _words(text: str) -> str:
    """Say what stands in a place: the title of a class, a material, ways to hang, or tables."""
    # Titles of classes and checks begin with a small letter here.
    title = text[:1].upper() + text[1:]
    told = _(title)
    if told != title:
        return told[:1].lower() + told[1:]
    for known in (text, text.lower(), bare(text)):
        told = _(known)
        if told != known:
            return told
    return _several(text)


def _several(text: str) -> str:
    several, last = text.rpartition(", or ")[::2]
    if several:
        return _("{several}, or {last}").format(several=", ".join(map(_, several.split(", "))), last=_(last))
    tables = [_("Table {number}").format(number=found[1]) if (found := _PRINTED.fullmatch(one)) else one
              for one in text.split(" and ")]  # fmt: skip
    return _(" and ").join(tables)
