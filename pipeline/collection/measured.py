"""Texts in which dimensions stand -> the fields of one record, with the characters that each number came from."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from pipeline.collection.cells import Cells
from pipeline.collection.dimensions import Choice, Chosen, DimensionNote, Dimensions, agree, choose, doubts, parse
from pipeline.collection.dimensions.choice import HANGS
from pipeline.collection.dimensions.lexicon import unit_words
from pipeline.collection.dimensions.orders_ahead import behind_orders
from pipeline.collection.dimensions.parts import FRAMED
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.mapping import ColumnMap
from pipeline.collection.mapping_parts import Texts
from pipeline.collection.measured_cell import written
from pipeline.collection.record import TEXT_LIMIT
from pipeline.records import Origin, Problem, Provenance
from pipeline.records import phrases as say

FIELDS: Mapping[str, tuple[str, ...]] = {
    "height": ("height_m",),
    "width": ("width_m",),
    "depth": ("depth_m",),
    "diameter": ("width_m", "depth_m"),
    "base_width": ("base_width_m",),
    "base_depth": ("base_depth_m",),
    "mass": ("mass_kg",),
}
"""What a text says -> the fields that it fills, in the order in which they are filled."""

_NUMERALS = (
    "half|one|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|fifteen|twenty|thirty|forty|fifty|sixty|"
    "seventy|eighty|ninety|hundred|"
    "ein|eine|einen|zwei|drei|vier|fünf|sechs|sieben|acht|neun|zehn|zwölf|halber|anderthalb|"
    "un|une|deux|trois|quatre|cinq|sept|huit|neuf|dix|douze|vingt|trente|demi|"
    "uno|una|due|tre|quattro|cinque|sei|sette|otto|nove|dieci|mezzo|"
    "dos|tres|cuatro|cinco|seis|siete|ocho|nueve|diez|medio|um|uma|dois|duas|três|quatro|sete|oito|dez|meio|"
    "een|twee|drie|vijf|zes|zeven|negen|tien|unu|doi|două|trei|patru|cinci|șase|șapte|opt|nouă|zece"
)
_SPELLED_NUMBERS = frozenset(_NUMERALS.split("|"))
_WORDS = re.compile(r"[^\W\d_]+")
_NO_UNIT = frozenset({"in", "ins", "once", "oncia"})
"""Words of units that are other words as often."""


@cache
def _spelled() -> re.Pattern[str]:
    """Match a number in words with a unit behind it: such texts are not read, and must not pass for none."""
    known = (word for word, unit in unit_words().items() if unit.kind in ("length", "mass") and len(word) > 1)
    units = "|".join(sorted((re.escape(w) for w in known if w.isalpha() and w not in _NO_UNIT), key=len, reverse=True))
    more = rf"(?:[\s-]+(?:and|a|an|quarter|und|et|y|e|și|{_NUMERALS}))*"
    return re.compile(rf"(?i)\b(?:{_NUMERALS}){more}[\s-]+(?:{units})\b")


_SHELF_MARK = re.compile(r"\s*[^\W\d_a-z]{1,4}\.?\s\d[\d.,/-]*[a-z]?\s*")
"""Capitals and a number, as inventories count: M 45 is no 45 m."""
_PART = "weight of a part"
"""How the reason of a weight begins that is not the whole object's."""

_LANGUAGE = 'say it in the mapping, [dimensions] language = "...", or write the word out'

_NAMING = ("object_name", "title", "classification", "medium")
"""Fields whose words name the object."""

_WORTH_A_WORD = {
    "contradiction": "measure it again, and correct the text in the museum's database",
    "conversion": "measure it again, and correct the text in the museum's database",
    "missing_unit": 'write the unit into the text, or say it in the mapping, [dimensions] unit = "..."',
    "shared_unit": "write the unit behind each number, or behind the last one",
    "ambiguous": say.NAME_NUMBERS(),
    "label": _LANGUAGE,
    "unused": say.WHOSE_IS_IT(),
    "part": "measure the whole object, or write which size is whose, such as Overall: H 10 x W 5 cm",
    "remainder": "write it as in H 10 x W 5 x D 3 cm, or see that nothing in it matters",
    "truncated": "shorten it in the museum's database",
}
"""Notes on a text that a person should mend, and how."""


@cache
def _joined(columns: tuple[str, ...]) -> ColumnMap:
    return ColumnMap(columns=columns, separator="; ")


def fill(
    values: dict[str, Any],
    cells: Cells,
    mapping: Texts,
    texts: Sequence[str],
    decimal: str,
    *,
    names: Sequence[str] = (),
    texts_hold: bool = False,
) -> None:
    """Fill what no column gives from the texts of a row; where both speak, say whether they agree.

    Parameters
    ----------
    values : dict
        Of the record so far, in SI; changed in place, as are the cells' provenance and problems.
    cells : Cells
        Of the row.
    mapping : Texts
        What the mapping says of its texts.
    texts : sequence of str
        Of the mapping's columns, in its order; the first that says something counts.
    decimal : {".", ","}
        The source's decimal mark.
    names : sequence of str
        The columns that the texts are of, where the source lacks some of the mapping's.
    texts_hold : bool
        Whether a text holds where a column says something else; else the column does.
    """
    names = names or mapping.columns
    prose = [name in mapping.prose for name in names]
    sized = any(values.get(field) is not None for field in _SIDES)
    told = sized or any(text.strip() for text, sentences in zip(texts, prose, strict=True) if not sentences)
    texts = ["" if told and sentences else plain_text(text) for text, sentences in zip(texts, prose, strict=True)]
    texts = behind_orders(texts)
    # Lines are how such texts are written, and no fault of theirs.
    lines = ["; ".join(filter(None, (line.strip() for line in text.splitlines()))) for text in texts]
    values["dimensions"] = cells.text("dimensions", _joined(tuple(names)), lines, limit=TEXT_LIMIT)
    given = {field: values[field] for field in FIELDS_FILLED if values.get(field) is not None}
    for text, sentences in zip(texts, prose, strict=True):
        if text.strip():
            read = parse(
                text,
                default_unit=mapping.unit,
                decimal=decimal,
                language=mapping.language,
                order=mapping.order,
                prose=sentences,
            )
            _fill_from(values, given, cells, read, mapping, texts_hold)


_SIDES = ("height_m", "width_m", "depth_m")

FIELDS_FILLED = tuple(dict.fromkeys(field for fields in FIELDS.values() for field in fields))


def _fill_from(
    values: dict[str, Any],
    given: Mapping[str, float],
    cells: Cells,
    read: Dimensions,
    mapping: Texts,
    texts_hold: bool,
) -> None:
    chosen = choose(read, hung=mapping.framed)
    unframed = _unframed(given, chosen, read)
    found = False
    for what, fields in FIELDS.items():
        choice: Choice | None = getattr(chosen, what)
        if choice is None:
            continue
        # A base alone says no size of what stands on it.
        found = found or not what.startswith("base")
        if what == "mass" and choice.why.startswith(_PART):
            cells.problems.append(Problem("mass_kg", say.ONLY_PART_WEIGHED(mass=choice.value), say.WEIGH_WHOLE()))
            continue
        for field in fields:
            if field in unframed:
                # The column tells the work and the text its frame too, which is what hangs.
                cells.pairs.append((field, given[field], unframed[field]))
                values[field] = choice.value
                cells.provenance = [of for of in cells.provenance if of.field != field]
                cells.provenance.append(_provenance(field, what, choice, read))
            elif field in given:
                cells.pairs.append((field, given[field], choice.value))
                if _differs(field, given[field], choice, cells, texts_hold) and texts_hold:
                    values[field] = choice.value
                    cells.provenance = [of for of in cells.provenance if of.field != field]
                    cells.provenance.append(_provenance(field, what, choice, read))
            elif values.get(field) is None and cells.plausible(
                field, choice.value, read.text[choice.start : choice.end]
            ):
                values[field] = choice.value
                cells.provenance.append(_provenance(field, what, choice, read))
    about = " ".join(str(values.get(field) or "") for field in _NAMING)
    _tell(cells, read, (*read.notes, *doubts(read, chosen, about)), found, sized=bool(given))


def _unframed(given: Mapping[str, float], chosen: Chosen, read: Dimensions) -> dict[str, float]:
    """Return what a text says of the work without its frame, where columns say the same and the frame was chosen.

    Field -> number [m]; none where any of the columns says something else than the text does of the work.
    """
    sides = {field: what for what, (field, *_) in FIELDS.items() if what in ("height", "width", "depth")}
    out: dict[str, float] = {}
    for field in sides.keys() & given.keys():
        choice: Choice | None = getattr(chosen, sides[field])
        if choice is None or not choice.why.endswith(HANGS):
            return {}
        own = [p.value for p in read.parts if p.dimension == sides[field] and not FRAMED.intersection(p.name.split())]
        same = next((value for value in own if value is not None and agree(given[field], value, "length")), None)
        if same is None:
            return {}
        out[field] = same
    return out


def _tell(cells: Cells, read: Dimensions, notes: Sequence[DimensionNote], found: bool, *, sized: bool) -> None:
    """Make problems of what a person should see of a text: the doubts, what was not understood, or all of it.

    sized : whether columns give sizes
    """
    words = _WORDS.findall(read.text.casefold())
    spelled = [] if _SPELLED_NUMBERS.isdisjoint(words) else list(_spelled().finditer(read.text))
    worth = [
        note
        for note in notes
        if note.kind in _WORTH_A_WORD
        and not (note.kind == "remainder" and any(note.start <= s.start() < note.end for s in spelled))
    ]
    problems = [Problem("dimensions", note.message, _WORTH_A_WORD[note.kind]) for note in worth]
    for found_words in spelled:
        message = f"a number in words is not read: {found_words[0][:80]!r}"
        problems.append(Problem("dimensions", message, "write it in digits, such as 2 ft"))
    only = len(problems) == sum(note.kind == "remainder" for note in worth)
    if not found and only and not any(note.kind in ("left_out", "variable") for note in notes):
        problems = []
        # Words alone beside sizes in columns, such as "Objektmass", say nothing and hide nothing.
        if any(c.isalnum() for c in read.text) and not (sized and not any(map(str.isnumeric, read.text))):
            what = "says no size of the object itself" if read.parts else "holds no dimension that can be read"
            message = f"the text {read.text[:80]!r} {what}"
            problems = [Problem("dimensions", message, "write it as in H 10 x W 5 x D 3 cm, or leave it empty")]
    cells.problems += problems


def _differs(field: str, value: float, choice: Choice, cells: Cells, texts_hold: bool) -> bool:
    """Note a text that says something else than the field's own column, the first time."""
    if any(p.field == field and p.message.startswith("the text says") for p in cells.problems):
        return False
    if agree(value, choice.value, "mass" if field == "mass_kg" else "length"):
        return False
    differs = say.TEXT_WEIGHS_OTHERWISE if field == "mass_kg" else say.TEXT_DIFFERS
    used = say.TEXT_USED if texts_hold else say.COLUMN_USED
    message = f"{differs(text=choice.value, reasons=choice.why, column=value)}; {used()}"
    cells.problems.append(Problem(field, message, say.WHICH_IS_RIGHT()))
    return True


def _provenance(field: str, what: str, choice: Choice, read: Dimensions) -> Provenance:
    part = next(p for p in read.parts if (p.start, p.end) == (choice.start, choice.end))
    derived = what == "diameter" or field.removesuffix("_m") not in (part.dimension, f"base_{part.dimension}")
    derived = derived and field != "mass_kg" and not part.assumed
    origin = Origin.DERIVED if derived else Origin.MEASURED
    why = f"its {what}, {choice.why}" if what == "diameter" else choice.why
    return Provenance(field, origin, written(part, read), f"{why}; characters {choice.start + 1} to {choice.end}")


def is_dimension(text: str) -> bool:
    """Whether a text that should name an object is a dimension: a line of another cell that became a row."""
    return not _SHELF_MARK.fullmatch(text) and any(part.unit_text for part in parse(text).parts)
