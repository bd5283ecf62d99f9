"""What a run assumed, and why measures were passed over, in the reader's units and language.

See `pipeline.records.phrase`: a run stores both in English.
"""

import re
from collections.abc import Iterable, Mapping
from functools import cache

from pipeline.analysis.classify import object_classes
from pipeline.quantities import LENGTHS
from pipeline.records.phrase import Clause, Number
from pipeline.records.phrases import PHRASES, SENTENCES, STANDS_AS
from pipeline.records.picture import CHART_WORDS
from pipeline.report.language import _, local, parted, said
from pipeline.report.text import bare
from pipeline.report.units import Units, inches

TABLES = tuple(
    f"{name}.csv"
    for name in (
        "bending", "classes", "contacts", "damping", "efforts", "fills", "fixings", "friction", "furniture",
        "hangings", "isolators", "limits", "materials", "measures", "mounts", "proportions", "slender", "stakes",
        "usual_furniture", "usual_hangings", "usual_materials",
    )
)  # fmt: skip
"""Files that sources name; a catalogue says what each is about."""

SOURCES = ("judgement", "handbook tables of dry friction", "strengths: fixings.csv", "classes by judgement",
           "limits by judgement", "limit by judgement", "the measure itself",
           "share of the footing by judgement")  # fmt: skip
"""What sources say in one clause, besides what they cite."""

CITED = frozenset({"rule", "case", "words", "aside", "shape", "number", "sheet", "recorded", "filled"})
"""Places of phrases for what the museum, or somebody else, wrote: it stays as it is."""

RECORDED = frozenset({"recorded", "filled"})
"""Places for what was measured: with inches in eighths, as it was read off."""

REFUSAL = "refusal"
"""The place for a clause within a clause."""

REASONS = "reasons"
"""The place for why a number of a text was taken: clauses that commas part."""

ERRORS = "errors"
"""The place for how far off the lines of a chart are, each with the name of its line."""

MASSES_OF = frozenset({"kg", "kg/m2", "kg/m3"})
"""Units of masses, of an area and of a volume."""

_SENTENCE = re.compile(r"(?<=[.!?]) ")
_ERROR = re.compile(r"([\d.e+-]+) %|(?<=\()[^()]+")
_PLACE = re.compile(r"\{(\w+)\}")
_PRINTED = re.compile(r"\bTable (\d+)\b(?!-)")
_TABLE = re.compile(r"(?P<file>\b[a-z_]+\.csv)(?:, (?P<row>\w[\w ]*\w))?")
_JUDGED = re.compile(r"(\A|; |[(])judgement\b")
_RULE = re.compile(
    r"""(?P<name>.*?):[ ](?P<why>.*?)(?:[ ]\((?:named[ ](?P<word>['"].*['"])|(?P<cited>AAT[ ]\w+))\))?"""
    r"""(?P<open>;[ ]its[ ]record[ ]names[ ]no[ ]class"""
    r"""(?:,[ ](?P<kind>\w+)[ ]is[ ]the[ ]likeliest[ ]\((?P<chance>[\d.]+)\))?)?""",
    re.DOTALL | re.VERBOSE,
)
_DECIDED = re.compile(r"decided by (?P<who>.*) on (?P<date>\d{4}-\d\d-\d\d): (?P<why>.*)", re.DOTALL)
_THIN = "\u202f"
_SI_OF = {"cm/s": "m/s", "MPa": "Pa", "GPa": "Pa"}
_SIGNS = {"": "", "°": "°", "%": "\u00a0%", "kg/m2": f"{_THIN}kg/m²", "kg/m3": f"{_THIN}kg/m³"}


def assumed(text: str, units: Units) -> str:
    """Say what was assumed, or where a number comes from.

    Parameters
    ----------
    text : str
        As the run stored it, clauses parted by "; "; what no phrase of Kouros wrote stays as it is.

    Returns
    -------
    str
    """
    return parted(_clause(clause, units) for clause in text.split("; "))


def happening(text: str, units: Units) -> str:
    """Say what the sentences of a finding say, as the run stored them: with numbers of a motion, or placeholders."""
    told: list[str] = []
    plain: list[str] = []
    for part in _SENTENCE.split(text):
        found = next(((one, places) for one in SENTENCES if (places := one.places(part)) is not None), None)
        if found is None:
            plain.append(part)
            continue
        # What stands together in a catalogue is looked up together.
        told += [said(" ".join(plain))] if plain else []
        told.append(_told(*found, units))
        plain = []
    return " ".join([*told, said(" ".join(plain))] if plain else told)


def pictured(text: str, units: Units) -> str:
    """Say what stands on a chart or under it, as the run stored it: words, and behind them one phrase with numbers."""
    parts = _SENTENCE.split(text)
    for at in range(len(parts)):
        rest = " ".join(parts[at:])
        found = next(((one, places) for one in CHART_WORDS if (places := one.places(rest)) is not None), None)
        if found is not None:
            return " ".join([*([said(" ".join(parts[:at]))] if at else []), _told(*found, units)])
    return said(text)


def rejected(text: str, units: Units) -> str:
    """Say which measure was passed over and why, as the run stored it: its title, a colon, and clauses."""
    title, colon, why = text.partition(": ")
    return f"{said(title)}{colon}{assumed(why, units)}" if colon else said(text)


def together(told: Iterable[str]) -> list[str]:
    """Return what `rejected` says of several measures, those of the same reason in one text."""
    alike: dict[str, list[str]] = {}
    for text in told:
        title, colon, why = text.partition(": ")
        alike.setdefault(f"{colon}{why}", []).append(title)
    return [f"{', '.join(titles)}{why}" for why, titles in alike.items()]


def rule_words(rule: str) -> str:
    """Return by which rule an object is of its class: the rule's name, and in the reader's language why."""
    rule, *stands = rule.split(STANDS_AS, 1)
    found = _RULE.fullmatch(rule)
    if found is None:
        return STANDS_AS.join([rule, *stands])
    told = f"{found['name']}: {said(found['why'])}"
    if found["word"]:
        told += " (" + _("named %(word)s") % {"word": found["word"]} + ")"
    elif found["cited"]:
        told += f" ({found['cited']})"
    if found["open"]:
        told = parted((told, _("its record names no class")))
    if found["kind"]:
        likeliest = {
            "kind": class_words(found["kind"]),
            "chance": local(found["chance"]),
        }
        told += ", " + _("%(kind)s is the likeliest (%(chance)s)") % likeliest
    for words in stands:
        decided = _DECIDED.fullmatch(words)
        how = words if decided is None else _("decided by %(who)s, %(date)s: %(why)s") % decided.groupdict()
        told = parted((told, _("it stands as %(words)s") % {"words": how}))
    return told


def reason_words(why: str) -> str:
    """Return why an object is of its class as `rule_words` does, without the name of the rule."""
    return rule_words(f"_: {why}").removeprefix("_: ")


def sourced(text: str) -> str:
    """Return where a number or a measure comes from, its tables by their names in the reader's language.

    What is cited, and the reasons of a judgement, stay as they are written.
    """
    text = "; ".join(map(said, text.split("; ")))
    text = _TABLE.sub(_table, text)
    text = _JUDGED.sub(lambda one: one[1] + _("judgement"), text)
    return _PRINTED.sub(lambda one: _("Table {number}").format(number=one[1]), text)


def _table(found: re.Match[str]) -> str:
    row = found["row"]
    told = said(found[1])
    return told if row is None else f"{told}, {class_words(row)}"


def class_words(row: str) -> str:
    """Say what a class is called, or else a material."""
    title = object_classes().get(row, row)
    return _words(title[:1].lower() + title[1:])


def _clause(clause: str, units: Units) -> str:
    for phrase in _beginning(clause[:1]):
        places = phrase.places(clause)
        if places is not None:
            return _told(phrase, places, units)
    return said(clause)


@cache
def _beginning(letter: str) -> tuple[Clause, ...]:
    """Return the phrases that a clause may be of which begins with a letter, in their order."""
    return tuple(one for one in PHRASES if one.asked[:1] in (letter, "{"))


def _told(phrase: Clause, places: Mapping[str, str | Number], units: Units) -> str:
    written = {name: _filled(name, found, units) for name, found in places.items()}
    # Not by `format`: what was found may have braces, and a catalogue is checked for the names that it asks for.
    return _PLACE.sub(lambda place: written[place[1]], _(phrase.asked))


def _filled(name: str, found: str | Number, units: Units) -> str:
    """Say what stands in a place of a phrase."""
    if isinstance(found, Number):
        in_eighths = name in RECORDED and found.unit == "m" and units.pounds
        return inches(found.si[0], up=False) if in_eighths else _number(found, units)
    if name in CITED:
        return found
    if name == REASONS:
        return ", ".join(_clause(one, units) for one in found.split(", "))
    if name == ERRORS:
        return _ERROR.sub(lambda one: f"{local(one[1])}\u00a0%" if one[1] else pictured(one[0], units), found)
    return _clause(found, units) if name == REFUSAL else _words(found)


def _number(found: Number, units: Units) -> str:
    of = _SI_OF.get(found.unit, "m" if found.unit in LENGTHS else found.unit)
    if of in ("m", "m/s") or (units.pounds and (of in MASSES_OF or of == "Pa")):
        value, *ends = found.si
        return units.text(value, of) + (f" ({units.bare(ends[0], ends[1], of)})" if ends else "")
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
