"""Names of columns, in ten languages and in Japanese -> fields of the record."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Annotated
from unicodedata import normalize

from pydantic import AfterValidator

from pipeline.collection.guessing.frames import without_frame
from pipeline.collection.guessing.name_words import (
    ABOUT,
    DENOTING,
    ELSEWHERE,
    FORMER,
    HOLDING,
    OF_CODES,
    USUAL,
)
from pipeline.collection.guessing.units import told_unit
from pipeline.collection.mapping import MAPPABLE
from pipeline.collection.record import units_of
from pipeline.collection.sources.heads import BETWEEN
from pipeline.collection.sources.measurement_terms import unit_of
from pipeline.errors import InputError
from pipeline.tables import table
from pipeline.tables.ideographs import shortened_signs
from pipeline.tables.romanization import romanized
from pipeline.tables.rows import Entries, checked, unmarked

TEXTS = "dimensions"
"""What a column of texts with dimensions is called here; it is no field of the record."""

DESCRIPTION, ARTIST = "description", "artist"
"""The same of a description, which says what a thing is where nothing else does, and of who made a picture."""

LENGTH = "length_m"
"""The same of a length: it is the width, or else the depth, whichever has no column."""

_JOINED = re.compile(r"(\w{4,}?)(mm|cm|in|ft|kg|lb|lbs|oz)", re.IGNORECASE)
"""A name of one word that ends with a unit: "HEIGHTIN", "weightKg"."""
_NUMBER_WORDS = frozenset(
    ["n", "no", "nr", "nº", "num", "numero", "number", "nummer", "numar", "αρ", "αριθμοσ", "numarasi"]
)
_NUMBER = "no"
"""What stands for each of them where names are compared."""
_STOP = frozenset(
    {
        *("of", "the", "von", "van", "der", "die", "den", "das", "de", "del", "della", "dello", "di", "du", "des"),
        *("la", "le", "il", "el", "do", "da", "dos"),
    }
)
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_ELIDED = re.compile(r"\b(?:d|l|dell|nell|all)['’]", re.IGNORECASE)
_GLUED = re.compile(r"(\w{3,}?)(?:number|nummer|num|nr|no)")
"""A name of one word that ends with a word for number: "accessionnum"."""
_GROUPED = re.compile(r"(?:Tit|Loc|Phy|Cat|Col|Obj|Acc|Ide|Dim|Mea|Reg|Tax|Cla|Spe|Sta|Dar)(?=[A-Z])")
"""Before a name: of which group of fields it is, in systems that write it so (EMu, MuseumPlus): "TitObjectNumber"."""
_FIRST = re.compile(r"(.*[^\W\d_]{2})[\s_.-]*0?1", re.DOTALL)
_TYPED = re.compile(r"(?<=[a-z])(?:Txt|Clb|Vrt|Num|Voc|Lnu)$")
"""Behind a name in MuseumPlus: of which type it is, "HeightNum", "ObjTechnicalTermClb"."""
_TABLED = re.compile(r"(?<=[^\W_])_?(?:_nesttab|_tab|NestTab)(?:_inner)?\d*$|(?<=[a-z])0$")
"""Behind a name in EMu: that there may be several, "DimHeight_tab", "MeaReading0"."""
_VALUE = re.compile(r"\.@(?:value|none|[a-z]{2})$")
"""Behind a name in linked data (JSON-LD): "dcterms:title.@value"."""
_LABELS = re.compile(r"preferred labels?")
_LABELLED = re.compile(r"(\w*[a-z])Label")
_SIGNS = re.compile(r"[\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7af]{3,}")
"""A name without blanks between its words, the last of which says what it is: 具体质量, a mass."""
_REFERENCE = re.compile(r"(?<=[a-z])(?:Ref|Grp|Tab)$")
"""Behind the name of what is told by another table."""
_SIDE = re.compile(r"([^(（\[]+)[(（\[]([^)）\]]+)[)）\]]")
"""The name of a column that says in brackets what of something it is."""
LEGEND = re.compile(
    r"(?<![^\W_])(?:(?:[^\W\d_x×]{1,2}\.?\s*[x×]\s*){1,2}[^\W\d_x×]{1,2}(?![^\W_])"
    r"|(?:[^\W\d_x×]{1,2}\.?\s*/\s*){2}[^\W\d_x×]{1,2}(?![^\W_])"
    r"|(?:[^\W\d_]+\.?(?:\s+x\s+|\s*×\s*)){1,2}[^\W\d_]+)",
    re.IGNORECASE,
)
"""What the head of a column says of the order: L x B x H, alto x ancho x fondo."""
_ABOUT = re.compile(
    r"(?<!\w)(?:approx(?:imate(?:ly)?)?|aprox(?:imad[oa])?|approssimativ[oa]|environ|env|circa|ca|est(?:imated)?|ungefähr"
    r"|geschätzt|stimat[oa]|estimad[oa]|estimé)(?!\w)\.?",
    re.IGNORECASE,
)
"""What a head says of how well all of it is known."""
_MASSES = frozenset({"masse"})
STROKES = re.compile(r"[^\W\d_]{3,}\s*/\s*[^\W\d_]{3,}(?:\s*/\s*[^\W\d_]{3,})?")
"""Words that strokes part, which may be sides: Höhe/Breite/Tiefe."""
_OTHER = re.compile(r"[^\w]+|_")
_FEWEST = 3
"""Letters of a name that a point cuts short."""
_CUT_ELSEWISE = frozenset({"dept"})
"""What is short for another word: the department."""
_SHORT = 4
"""Letters up to which an s at the end is hardly a plural's: "loss", "mass"."""
_WEAK = 1000
"""Rank of a name that is only part of what stands in the head."""

_DISPLAYED = "display "
"""Before a name: that its text is the one to be shown, as in "DISPLAY_DENOMINATION"."""

_OF_PATH = re.compile(r"__|(?<=[^\W\d_]{2}):(?=[^\W\d_]{3})|\.(?=[^\W\d_]{3}|[^\W\d_]+_)")
"""What parts the names of a path: "location.onView"."""

_STUFF = re.compile(r"mat(?:eri|ier)|soporte|suporte|werkstoff|malzeme|tworzyw|υλικ|материал|材質|素材|재질")
_CRAFT = re.compile(r"te(?:ch|k|c|h|hn)ni|τεχνικ|техник|tekniik|技法|기법")
"""Parts of the names of columns that tell what a thing is made of, and how; folded."""


_REMEMBERED = 8192
"""Names of which it is remembered what they say: a head is asked about many times over, and so are its cells."""


def is_length(name: str) -> bool:
    """Whether a column is of lengths, which no field has: the depth takes them where no other column is for it."""
    return called(name, LENGTH)


def called(name: str, field: str) -> bool:
    """Whether the name of a column says that it is of a field, or of what the module names besides: DESCRIPTION."""
    what = named(name)
    return what is not None and what.field == field


def is_side(name: str) -> bool:
    """Whether the name of a column begins as those of sizes do, "measurement_girth", or stands below that of sizes."""
    upper, between, _ = name.partition(BETWEEN)
    return bool(ABOUT.intersection(plain(name).split()[:1])) or bool(between and _says(upper) == TEXTS)


@dataclass(frozen=True, slots=True)
class ColumnMeaning:
    """What the name of a column says.

    Attributes
    ----------
    field : str
        A field of the record, TEXTS or LENGTH.
    rank : int
        How far down in the table the name stands: of two columns the lower rank is meant rather.
    internal : bool
        Whether it is the name of a number that only a database knows, or of a place that is only usual.
    """

    field: str
    rank: int
    internal: bool = False


CALLED = ("name", "nom", "nome", "nombre", "naam", "nume")
"""What a thing is called, where nothing else stands in the head: of an object it is the title."""


def _mappable(field: str) -> str:
    if field not in (*MAPPABLE, TEXTS, LENGTH, DESCRIPTION, ARTIST):
        raise InputError(f"is {field!r}, which is no field that a column can be mapped to")
    return field


@dataclass(frozen=True, slots=True)
class _ColumnNames:
    field: Annotated[str, AfterValidator(_mappable)]
    names: Entries
    internal: Entries


@cache
def column_names() -> dict[str, ColumnMeaning]:
    """Return what the names of the table mean, each as `plain` writes it."""
    rows = checked(_ColumnNames, table("column_names"), "column_names.csv", named="field")
    found: dict[str, ColumnMeaning] = {}
    for row in rows:
        for rank, name in enumerate((*row.names, *row.internal)):
            found.setdefault(plain(name), ColumnMeaning(row.field, rank, rank >= len(row.names)))
    return found


@cache
def _latin_names() -> dict[str, ColumnMeaning]:
    """Return what Greek and Cyrillic names mean where a database has Latin letters alone: "vysota_sm", "ypsos"."""
    names = column_names().items()
    return {plain(latin): what for name, what in reversed(names) for latin in romanized(name)}


@cache
def _singular_names() -> dict[str, ColumnMeaning]:
    """Return what names say in the singular, those left out that say two things then: "Matières", "object_names"."""
    found: dict[str, ColumnMeaning] = {}
    several = set()
    for name, what in column_names().items():
        one = _singular(name)
        if found.setdefault(one, what).field != what.field:
            several.add(one)
    return {name: what for name, what in found.items() if name not in several}


def _singular(name: str) -> str:
    return " ".join(word[:-1] if len(word) > _SHORT and word.endswith("s") else word for word in name.split())


@lru_cache(maxsize=_REMEMBERED)
def plain(name: str) -> str:
    """Return a name as it is compared: no capitals, accents, marks and articles, "no" for every word for number."""
    bare = unmarked(_ELIDED.sub(" ", _CAMEL.sub(" ", normalize("NFC", name.replace("#", " no ")))))
    # NFKD takes the voicing marks off Japanese signs; they are put together again.
    # In capitals nobody can tell the two i of Turkish apart.
    bare = shortened_signs(normalize("NFC", bare))
    words = _OTHER.sub(" ", bare.casefold().replace("ı", "i")).split()
    kept = [_NUMBER if word in _NUMBER_WORDS else word for word in words if word not in _STOP]
    return " ".join(kept or words)


@lru_cache(maxsize=_REMEMBERED)
def unit_in(name: str) -> tuple[str, str | None]:
    """Return a name without the unit that stands in it, and the unit: "Höhe in cm" as ("Höhe", "cm").

    Parameters
    ----------
    name : str
        Of a column.

    Returns
    -------
    (str, str or None)
        None where there is none.
    """
    upper, between, lower = name.rpartition(BETWEEN)
    if between:
        for first, second in ((upper, lower), (lower, upper)):
            rest, unit = unit_in(first)
            if unit is not None:
                return (f"{rest}{BETWEEN}{second}" if first is upper else f"{second}{BETWEEN}{rest}"), unit
        return name, None
    held = _held(path_of(name))
    for one in filter(None, (held, name)):
        rest, unit = told_unit(one)
        if unit is not None and (not held or one is name or _is_measure(rest)):
            return rest, unit
    joined = _JOINED.fullmatch(name.strip())
    if joined is not None:
        said = column_names().get(plain(joined[1]))
        unit = unit_of(joined[2])
        if said is not None and unit in units_of("height_m" if said.field == LENGTH else said.field):
            return joined[1], unit
    return name, None


def bare(name: str) -> str:
    """Return a name without its unit and without what is said of all sizes: "Maße (cm) H" as "H"."""
    rest = unit_in(name)[0].strip()
    upper, between, lower = rest.rpartition(BETWEEN)
    if between and _says(upper) == TEXTS:
        return lower.strip()
    words = rest.split()
    return " ".join(words[1:]) if len(words) > 1 and _says(words[0]) == TEXTS else rest


def _says(name: str) -> str | None:
    form = plain(unit_in(name)[0])
    found = column_names().get(form) or _latin_names().get(form)
    return None if found is None else found.field


@lru_cache(maxsize=_REMEMBERED)
def named(name: str) -> ColumnMeaning | None:
    """Return what the name of a column says; None for a name that no table has.

    Parameters
    ----------
    name : str
        As it stands in the head.

    Returns
    -------
    ColumnMeaning or None
        One letter says nothing by itself: see `columns`.
    """
    if name in MAPPABLE:
        return ColumnMeaning(name, 0)
    name = _TABLED.sub("", _VALUE.sub("", name))
    if any(ELSEWHERE.intersection(plain(above).split()) for above in path_of(name)[:-1]):
        return None
    forms = [*_forms(name)]
    forms += [form.removeprefix(_DISPLAYED) for form in forms if form.startswith(_DISPLAYED)]
    path = path_of(name)
    above = set(map(plain, path[:-1]))
    denoting = _says(path[-1]) == "title" or plain(path[-1]) in DENOTING
    if len(path) > 1 and denoting and _says(path[-2]) == "gallery":
        return column_names()[plain(path[-2])]  # what a place is called, and no thing: "Raum.bezeichnung"
    if plain(name) != _NUMBER or len(_OTHER.sub("", name)) == 1:
        forms = [form for form in forms if form != _NUMBER]  # the N of "Y/N"
    rest, unit = unit_in(name)
    rest = rest.strip(" ()")
    if _by_strokes(rest):
        return ColumnMeaning(TEXTS, _WEAK)
    for form in forms:
        found = column_names().get(form)
        if found is not None and found.field == TEXTS and form in _MASSES and unit in units_of("mass_kg"):
            return column_names()["mass"]  # "Masse (g)", which without a unit are the sizes, as the Swiss write them
        # What stands below a description is none: "Description.Material.Keyword".
        if found is not None and not (found.field == DESCRIPTION and form in above):
            return found
    for form in forms:
        found = _singular_names().get(_singular(form))
        if found is not None:
            return found
    for form in forms:
        if form in _latin_names():
            return _latin_names()[form]
    if plain(name) in CALLED:
        return ColumnMeaning("title", _WEAK)
    # "L x W x H (mm)": nothing but the order of sizes; "Max W" is none.
    legend = ColumnMeaning(TEXTS, _WEAK) if LEGEND.fullmatch(rest) and plain(rest)[:3] != "max" else None
    return legend or _cut(name) or _beside_frame(name) or _within(name)


def _by_strokes(rest: str) -> bool:
    """Whether strokes part the sides that a name without its unit tells, and not the names of one in two languages."""
    if not STROKES.fullmatch(rest):
        return False
    said = [column_names().get(plain(word)) for word in rest.split("/")]
    sides = {one.field for one in said if one is not None}
    return len(sides) == len(said) and "height_m" in sides and sides <= {*_UPRIGHT_AND_PLAN, LENGTH}


_UPRIGHT_AND_PLAN = ("height_m", "width_m", "depth_m", "diameter_m")


def _beside_frame(name: str) -> ColumnMeaning | None:
    """Return the side, or the weight, that a name tells beside whether the frame counts, which is meant rather."""
    rest, unit = unit_in(name)
    told = without_frame(rest)
    what = None if told is None else column_names().get(plain(told[0]))
    if what is None or told is None or not (what.field == LENGTH or units_of(what.field)):
        return None
    if not told[1] and unit is None:
        return None  # "Image Height" may be in pixels.
    return ColumnMeaning(what.field, what.rank if told[1] else what.rank + _WEAK)


def _cut(name: str) -> ColumnMeaning | None:
    """Return the side, or the weight, whose name alone begins as one that a point cuts short: "largh.", "lungh."."""
    word = bare(name)
    form = plain(word)
    if not word.endswith(".") or len(form) < _FEWEST or " " in form or form in _CUT_ELSEWISE:
        return None
    fields = {what.field for known, what in column_names().items() if known.startswith(form) and " " not in known}
    field = fields.pop() if len(fields) == 1 else ""
    return ColumnMeaning(field, _WEAK) if field == LENGTH or units_of(field) else None


def outright(name: str) -> bool:
    """Whether the whole of a column's name is that of a field, and not a word within it alone: "Akt. Standort"."""
    what = named(name)
    return what is not None and what.rank < _WEAK


def tells_material(name: str) -> bool:
    """Whether a column is named for materials, and perhaps for techniques too."""
    return bool(_STUFF.search(plain(name)))


def complements(name: str, other: str) -> bool:
    """Whether of two columns one is named for materials alone, and the other for techniques alone."""
    said = [(tells_material(one), bool(_CRAFT.search(plain(one)))) for one in (name, other)]
    return sorted(said) == [(False, True), (True, False)]


def is_code(name: str) -> bool:
    """Whether a column within others is of codes or dates: "location.code" beside "location.name"."""
    path = path_of(name)
    return len(path) > 1 and plain(path[-1]) in OF_CODES


def path_of(name: str) -> list[str]:
    """Return the names of which the name of a column is a path: "location.onView" as ["location", "onView"]."""
    return _OF_PATH.split(name.strip("_ ."))


def _held(path: Sequence[str]) -> str:
    """Return the name whose value the last of a path only holds: "height_cm" of "height_cm.value"; "" for none."""
    return path[-2] if len(path) > 1 and plain(path[-1]).replace(" ", "") in HOLDING else ""


def _is_measure(name: str) -> bool:
    field = _says(name)
    return field is not None and (field == LENGTH or bool(units_of(field)))


def _forms(name: str) -> Iterator[str]:
    upper, between, lower = name.rpartition(BETWEEN)
    if between and _says(upper) == TEXTS:
        # A letter below "Dimensions" is no dimension text.
        yield plain(unit_in(lower)[0])
        return
    yield plain(name)
    # What looks like two words may be one: "MoMANumber".
    yield plain(name.casefold())
    if glued := _GLUED.fullmatch(plain(name)):
        yield f"{glued[1]} no"
    yield plain(unit_in(name)[0])
    yield plain(bare(name))
    # "大きさ(高さ)", "Maße (Höhe) in cm": the side that stands in brackets behind a word for all of them.
    side = _SIDE.fullmatch(unit_in(name)[0].strip())
    if side is not None and _says(side[1]) == TEXTS and len(plain(side[2])) >= (2 if side[2].isascii() else 1):
        yield plain(side[2])
    # "Objeto/Documento", "Titel | title": what either half says; of two rows of a head the lower one first.
    halves = [half for half in re.split(r"[/|,;]| - |\n", unit_in(name)[0]) if half.strip()]
    if len(halves) > 1:
        # "Title / Description" holds titles, perhaps long ones.
        halves.sort(key=lambda half: _says(half) == DESCRIPTION)
        titled = _says(halves[0]) not in (None, DESCRIPTION) and _says(halves[-1]) == DESCRIPTION
        yield from map(plain, reversed(halves) if between and not titled else halves)
    # "heightUnitLabel": an answer to SPARQL has words for what is an address without "Label".
    labelled = _LABELLED.fullmatch(name)
    if labelled is not None:
        yield plain(labelled[1])
    # A path of names: what its last one says, "_currentLocation__onDisplay", "location.onView".
    path = path_of(name)
    if path[-1] != name:
        if _LABELS.fullmatch(plain(path[-1])):
            yield plain(path[0])  # the name of what: "ca_storage_locations.preferred_labels"
        yield plain(path[-1])
        yield plain(unit_in(path[-1])[0])
        if "(" in path[-1]:
            yield from _forms(path[-1])
    # "measurement_height", "ca_objects.dimensions.dimensions_height"
    words = plain(unit_in(path[-1])[0]).split()
    about = next((at for at, word in enumerate(words) if word not in ABOUT), 0)
    if about:
        yield " ".join(words[about:])
    # "measurements.height.value": the side itself, before the word for all of them.
    held = _held(path)
    if held and _is_measure(unit_in(held)[0]):
        yield plain(unit_in(held)[0])
    # "ca_storage_locations.hierarchy.preferred_labels.name": of no other table of words is it the first.
    if len(path) > 2:
        yield plain(path[0])
    if held:
        yield plain(held)
        yield plain(_REFERENCE.sub("", _GROUPED.sub("", held)))
    if len(path) > 1 and plain(path[-1]) == "no":
        # The number of what: "ObjectIdentity.Number".
        yield f"{plain(path[-2]).removesuffix(' identity')} no"
    typed = _TYPED.sub("", path[-1])
    if typed != path[-1]:
        yield plain(typed)
        yield plain(_GROUPED.sub("", typed))
    if _GROUPED.match(path[-1]):
        yield plain(_GROUPED.sub("", path[-1]))
        yield plain(unit_in(_GROUPED.sub("", path[-1]))[0])
    # What stands in brackets may be a language.
    outside = re.sub(r"[(\[（［].*?[)\]）］]", " ", name)
    if outside.strip() and outside != name:
        yield plain(outside)
        yield plain(unit_in(outside)[0])
    # How well it is known says nothing of what it is, as in "Peso aprox."
    exact = _ABOUT.sub(" ", name)
    if exact.strip() and exact != name:
        yield plain(exact)
        yield plain(unit_in(exact)[0])
    # "Dimensions LxWxH mm": of what order the sizes are.
    unordered = LEGEND.sub(" ", name)
    if unordered.strip() and unordered != name:
        yield plain(unit_in(unordered.strip())[0])
    # The first of several columns of one name: "Denomination_1", "Material 1".
    first = _FIRST.fullmatch(name.strip())
    if first is not None:
        yield plain(first[1])


def _within(name: str) -> ColumnMeaning | None:
    """Return what the last or the first words of a name say: "Akt. Standort"; of numbers, places and materials only."""
    words = plain(unit_in(name)[0]).split()
    if len(words) == 1 and _SIGNS.fullmatch(words[0]):
        ends = (column_names().get(words[0][at:]) for at in range(1, len(words[0]) - 1))
        last = next(filter(None, ends), None)
        return None if last is None or last.internal else ColumnMeaning(last.field, _WEAK + last.rank)
    if (
        FORMER & set(words)
        or words[-1:] in (["id"], ["lang"], ["language"])
        or words[:1] == ["is"]
        or words[:1] == ["has"]
    ):
        # "is_gallery" is answered by yes or no.
        return None
    usual = bool(USUAL & set(words))
    for many in range(min(len(words) - 1, 3), 0, -1):
        for part in (words[-many:], words[:many]):
            found = column_names().get(" ".join(part))
            if found is None or found.internal or found.field not in ("object_number", "gallery", "medium"):
                continue
            if found.field == "gallery" or not usual:
                return ColumnMeaning(found.field, _WEAK + found.rank, internal=usual)
    return None
