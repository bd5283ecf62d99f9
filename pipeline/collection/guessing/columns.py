"""Columns of a source with what they hold, and which of them is which field."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from statistics import median

from pipeline.collection.cells import unspaced
from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.structured import plain_text
from pipeline.collection.guessing.frames import frame_counts
from pipeline.collection.guessing.names import (
    DESCRIPTION,
    LENGTH,
    TEXTS,
    ColumnMeaning,
    called,
    complements,
    is_code,
    is_length,
    named,
    plain,
    tells_material,
    unit_in,
)
from pipeline.collection.guessing.short_heads import short_heads
from pipeline.collection.hand_cell import of_hand
from pipeline.collection.image_names import first_of, is_image_name
from pipeline.collection.sources.measurement_terms import kind_within, unit_of
from pipeline.collection.sources.measurements import IN_WORDS, OTHER
from pipeline.errors import InputError

_RECORDS = frozenset(
    {
        "object",
        "objects",
        "museum object",
        "artwork",
        "artworks",
        "item",
        "items",
        "record",
        "records",
        "humanmadeobject",
        "feature",
    }
    | {"accession number", "inventory number", "object number", "registration number"}
)
"""What interfaces of programs call all that they list, or its numbers, and no kind of things."""
NUMBER = re.compile(r"[+-]?\d+([.,]\d+)?", re.ASCII)
"""A cell that holds a number and nothing else."""

_SIZE = re.compile(r"\d.*[^\W\d]|[^\W\d].*\d|\d\s*[×*]\s*\d|\d\s*/\s*\d+[.,]?\d*\s*/\s*[\d–-]", re.DOTALL)
BOTH = 0.05
"""How many objects with both of two sizes there may be for each that has one alone (judgement)."""

_NAMED = ("height", "width", "depth", "diameter", "length")

FEWEST = 10
"""Cells that must hold the same before a column is taken to tell nothing."""

FEWEST_TOLD = 3
"""Objects whose sizes sentences alone tell, from which these are read (judgement)."""

_LONGEST = 40
"""Characters up to which a text is rather the number of an object than a sentence (judgement)."""

_OF_MACHINE = re.compile(
    r"(?:https?|oai|urn|info|hdl):\S+$|[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}$", re.IGNORECASE
)
_CODED = re.compile(r"[A-Z]{1,5}[ .-]?\d[\d.,/-]*[a-z]?")
_MOSTLY = 0.9
"""Share of the texts of a column that must be of programs (judgement)."""
_IN_WORDS = frozenset(("title", "object_name", "classification", "medium", "gallery", DESCRIPTION))

_SOME = 200
"""Cells from which it is told what a column holds."""


@dataclass(eq=False)
class Column:
    """A column, whole when it is asked about.

    Attributes
    ----------
    name : str
        Of the head.
    values : list of str
        Its cells.
    """

    name: str
    values: list[str] = field(default_factory=list)

    @cached_property
    def filled(self) -> list[str]:
        """The cells that hold anything."""
        return [value.strip() for value in self.values if value.strip()]

    @cached_property
    def numbers(self) -> list[str]:
        """Those that hold a number alone."""
        return [number for value in self.filled if NUMBER.fullmatch(number := unspaced(value))]

    @cached_property
    def by_hand(self) -> float:
        """Share of its texts that are one number as people write it with a tape measure at hand: 8 1/2, 12", 0,3."""
        some = self.filled[:_SOME]
        return sum(map(_of_hand, some)) / len(some) if some else 0.0

    @cached_property
    def distinct(self) -> list[str]:
        """What it holds, each once, in order."""
        return list(dict.fromkeys(self.filled))

    @cached_property
    def dimensional(self) -> float:
        """Share of its texts that hold a dimension with a unit."""
        some = self.filled[:_SOME]
        return sum(any(p.unit for p in parse(plain_text(text)).parts) for text in some) / len(some) if some else 0.0

    @cached_property
    def told(self) -> float:
        """Share of its texts that say of a size which it is, somewhere in their sentences: 12 cm high."""
        some = self.filled[:_SOME]
        named = (any(p.unit and p.dimension in _NAMED and not p.assumed for p in parse(text).parts) for text in some)
        return sum(named) / len(some) if some else 0.0

    @cached_property
    def captioned(self) -> float:
        """Share of its texts that tell two sides at least, or one by its name: "Olio su tela, cm 174 x 77"."""
        some = self.filled[:_SOME]
        sides = ([p for p in parse(plain_text(text)).parts if p.unit] for text in some)
        return (
            sum(len(of) > 1 or any(p.dimension in _NAMED and not p.assumed for p in of) for of in sides) / len(some)
            if some
            else 0.0
        )

    @cached_property
    def sized(self) -> float:
        """Share of its texts that hold a number and a word: a size, perhaps in words that are not understood."""
        some = self.filled[:_SOME]
        return sum(bool(_SIZE.search(text)) for text in some) / len(some) if some else 0.0

    @cached_property
    def pictured(self) -> float:
        """Share of its texts that name photographs."""
        some = self.filled[:_SOME]
        return sum(is_image_name(first_of(text)) for text in some) / len(some) if some else 0.0

    @cached_property
    def kinds(self) -> float:
        """Share of its texts that name a kind of measurement."""
        return _share(self.filled, kind_within)

    @cached_property
    def units(self) -> float:
        """Share of its texts that name a unit."""
        return _share(self.filled, unit_of)

    @cached_property
    def numbering(self) -> bool:
        """Whether most of its texts may be numbers of objects: short, with a digit, neither sizes nor addresses."""
        some = self.filled[:_SOME]
        short = sum(len(text) <= _LONGEST and any(map(str.isdigit, text)) and "://" not in text for text in some)
        # "GR 1873.8-20.1" weighs no grams.
        coded = sum(bool(_CODED.fullmatch(text)) for text in some)
        return bool(some) and short >= 0.9 * len(some) and (self.dimensional < 0.5 or coded >= 0.5 * len(some))

    @cached_property
    def blanks(self) -> tuple[str, ...]:
        """What it says again and again in place of a number: "Sem registro", "s/n"."""
        often = Counter(text for text in self.filled if not any(map(str.isdigit, text)))
        return tuple(text for text, times in often.items() if times > 1)

    @cached_property
    def length(self) -> float:
        """Characters of its texts in the middle."""
        return median(map(len, self.filled)) if self.filled else 0.0

    @cached_property
    def of_machine(self) -> bool:
        """Whether most of its texts are addresses, or numbers by which only programs know an object."""
        some = self.filled[:_SOME]
        return bool(some) and sum(bool(_OF_MACHINE.match(text)) for text in some) > _MOSTLY * len(some)

    @property
    def prose(self) -> bool:
        """Whether it holds sentences, and its name does not say that they are of sizes."""
        what = named(self.name)
        return self.length > _LONGEST and (what is None or what.field != TEXTS)

    @property
    def of_records(self) -> bool:
        """Whether it tells of all that they are records of objects, and not of what kind."""
        return bool(self.filled) and {text.strip().casefold() for text in self.distinct} <= _RECORDS

    @property
    def says_one(self) -> bool:
        """Whether it says the same of many objects, and so tells none from another."""
        return len(self.filled) >= FEWEST and len(self.distinct) == 1

    @property
    def numeric(self) -> bool:
        """Whether most of what it holds are numbers."""
        return bool(self.filled) and len(self.numbers) >= 0.5 * len(self.filled)

    @property
    def measured(self) -> bool:
        """Whether most of what it holds are numbers, as a program or a person writes them."""
        return self.numeric or self.by_hand >= 0.5


def _of_hand(text: str) -> bool:
    try:
        of_hand(text, "m")
    except InputError:
        return False
    return True


def _share(texts: Sequence[str], known: object) -> float:
    some = texts[:_SOME]
    return sum(known(text) is not None for text in some) / len(some) if some else 0.0  # type: ignore[operator]


def columns_of(header: Iterable[str], rows: Iterable[Sequence[str]]) -> list[Column]:
    """Return the columns of some rows; those without a name are left out."""
    out = [Column(cell.strip()) for cell in header]
    for row in rows:
        for column, cell in zip(out, row, strict=False):
            column.values.append(cell)
    return [column for column in out if column.name]


_NORTH = frozenset(["lat", "latitude", "latitud", "latitudine"])


def is_longitude(name: str, header: Iterable[str]) -> bool:
    """Say whether "long" is where on the earth something is, which a column of latitudes tells, and no length.

    Parameters
    ----------
    name : str
        Of a column.
    header : iterable of str
        The names of all columns beside it.
    """
    return plain(name).split()[-1:] == ["long"] and any(_NORTH.intersection(plain(other).split()) for other in header)


def candidates(columns: Sequence[Column]) -> dict[str, list[Column]]:
    """Return the columns that may be a field, by field, the likeliest first.

    Of two, the one that is filled much more is meant (twice as often), and not one that says the same everywhere; else
    the one whose name stands first in the table: an accession number before that of a database, a current location
    before a usual one.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.

    Returns
    -------
    dict of str to list of Column
        Fields of the record, `names.TEXTS` among them.
    """
    header = [column.name for column in columns]
    columns = [column for column in columns if not is_longitude(column.name, header)]
    said = {id(column): named(column.name) for column in columns}
    open_ = {id(column): column.name for column in columns if said[id(column)] is None and column.measured}
    said.update(short_heads(open_, {what.field for what in said.values() if what is not None}))
    found: dict[str, list[tuple[ColumnMeaning, Column]]] = {}
    for column in columns:
        what = said[id(column)]
        # A column called "media" may hold pictures, or their numbers.
        pictures = what is not None and what.field == "medium" and (column.numeric or column.pictured > 0.5)
        # An address names nothing in words.
        if what is not None and what.field in ("object_name", "classification") and column.of_records:
            continue
        if what is not None and not pictures and not (what.field in _IN_WORDS and column.of_machine):
            found.setdefault(what.field, []).append((what, column))
    out: dict[str, list[Column]] = {}
    for name, able in found.items():
        most = max(len(column.filled) for _, column in able)
        # An empty column tells nothing where another one tells something; and no place, which all objects have.
        pairs = [pair for pair in able if pair[1].filled or not (most or (name == "gallery" and pair[1].values))]
        if not pairs:
            continue
        out[name] = [
            column
            for _, column in sorted(
                pairs,
                key=lambda pair: (
                    2 * len(pair[1].filled) <= most and most > 0,
                    pair[1].says_one,
                    name == "object_number" and pair[1].of_machine,
                    pair[0].internal,
                    pair[0].rank,
                    is_code(pair[1].name),
                ),
            )
        ]
    for column in out.pop(LENGTH, []):
        free = next((name for name in ("width_m", "depth_m") if name not in out), None)
        if free is not None:
            out[free] = [column]
    return out


def length_beside(columns: Sequence[Column], depth: Column | None) -> Column | None:
    """Return the column of lengths that tells what the column of depths leaves open, of boats what of chests it does.

    None where many objects have both, for these are three sides in plan.
    """
    said = (column for column in columns if column.numeric and is_length(column.name) and column is not depth)
    column = next(said, None)
    if column is None or depth is None or unit_in(column.name)[1] != unit_in(depth.name)[1]:
        return None
    pairs = [(bool(tells(one)), bool(tells(other))) for one, other in zip(column.values, depth.values, strict=False)]
    alone, both = pairs.count((True, False)), pairs.count((True, True))
    return column if alone and both <= BOTH * alone else None


def tells(text: str) -> bool:
    """Whether a cell says a number other than nought."""
    return bool(text.strip(" 0.,"))


def usual_place(columns: Sequence[Column], found: dict[str, Column]) -> Column | None:
    """Return the column of usual places, where that of places now tells only what is elsewhere, which is then taken.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : dict of str to Column
        Field -> its column; that of the gallery becomes the one of places now.

    Returns
    -------
    Column or None
        None where one column tells of all objects where they are, or no other one does.
    """
    able = [(what, one) for one in columns if one.filled and (what := named(one.name)) and what.field == "gallery"]
    usual = next((one for what, one in able if what.internal), None)
    now = min(((what.rank, at) for at, (what, _) in enumerate(able) if not what.internal), default=None)
    if usual is None or now is None or len(able[now[1]][1].filled) >= len(usual.filled):
        return None
    found["gallery"] = able[now[1]][1]
    return usual


def material_and_technique(able: Sequence[Column]) -> tuple[Column, ...]:
    """Return the likeliest column of a medium and the one that completes it, that of materials first.

    Parameters
    ----------
    able : sequence of Column
        That may be the medium, the likeliest first.

    Returns
    -------
    tuple of Column
        Empty where one column tells both, or no other one tells what is missing.
    """
    other = next((one for one in able[1:] if complements(able[0].name, one.name) and one.filled), None)
    return () if other is None else tuple(sorted((able[0], other), key=lambda one: not tells_material(one.name)))


def internal(column: Column) -> bool:
    """Whether a column's name is that of a number that only a database knows."""
    what = named(column.name)
    return what is not None and what.internal


def untaken(columns: Sequence[Column], used: Iterable[Column]) -> list[Column]:
    """Return the columns that are none of those in use, in the order of the source."""
    taken = {id(column) for column in used}
    return [column for column in columns if id(column) not in taken]


def texts_of_dimensions(columns: Sequence[Column], used: Iterable[Column]) -> list[Column]:
    """Return the columns called dimensions that hold some; else the one whose texts are mostly such.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.

    Returns
    -------
    list of Column
        In the order of the source, but that of sizes with frames first.
    """
    free = [c for c in untaken(columns, used) if c.name != OTHER and not c.of_machine]
    so_called = [c for c in free if called(c.name, TEXTS) and c.sized > 0.2]
    words = [c for c in free if c.name.rpartition(".")[2] == IN_WORDS and c.filled]
    if so_called or words:
        # With its frame a picture hangs: what such a column leaves empty is told by another.
        return sorted(so_called, key=lambda column: frame_counts(column.name) is not True) or words
    # "42.2 cm" of a column of lengths would be read as a number without a label, and so as a height.
    free = [column for column in free if not any(map(is_length, (column.name, *plain(column.name).split())))]
    texts = [c for c in free if len(c.filled) > 0.2 * len(c.values) and len(c.numbers) < 0.5 * len(c.filled)]
    best = max(texts, key=lambda c: c.dimensional, default=None)
    return [best] if best is not None and best.dimensional > 0.6 else []


def captions_of_dimensions(columns: Sequence[Column]) -> Column | None:
    """Return the column, a field already or none, that tells sizes behind what it is for, as captions do.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.

    Returns
    -------
    Column or None
        None where none tells the sizes of one object in ten.
    """
    able = [column for column in columns if not column.prose]
    return _telling_most(able, lambda column: column.captioned)


def prose_of_dimensions(columns: Sequence[Column], used: Iterable[Column]) -> Column | None:
    """Return the column of a file without any for sizes whose sentences tell the most of them.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.

    Returns
    -------
    Column or None
        None where none tells the sizes of one object in ten.
    """
    able = [column for column in untaken(columns, used) if column.prose]
    return _telling_most(able, lambda column: column.told)


def sentences_of_dimensions(columns: Sequence[Column], told: Sequence[Column], used: Iterable[Column]) -> Column | None:
    """Return the column whose sentences tell the sizes of objects of which the columns for sizes tell none.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    told : sequence of Column
        That are for sizes; without any nothing is beside them.
    used : iterable of Column
        Those that are fields already.

    Returns
    -------
    Column or None
        None where there are fewer than `FEWEST_TOLD` such objects, or they are less than a tenth of those without.
    """
    able = [one for one in untaken(columns, (*told, *used)) if one.prose or called(one.name, DESCRIPTION)]
    if not told or not able:
        return None
    bare = [not any(tells(cell) for cell in cells) for cells in zip(*(one.values for one in told), strict=True)]
    often = [
        (sum(_tells_sides(text) for text, alone in zip(column.values, bare, strict=True) if alone), column)
        for column in able
    ]
    most, column = max(often, key=lambda pair: pair[0])
    return column if most >= FEWEST_TOLD and most >= 0.1 * sum(bare) else None


def _tells_sides(text: str) -> bool:
    """Whether sentences name a side and its size: one with a unit, or two without."""
    sides = [p for p in parse(text, prose=True).parts if p.dimension in _NAMED and not p.assumed]
    return any(p.unit for p in sides) or len(sides) > 1


def _telling_most(columns: Sequence[Column], share: Callable[[Column], float]) -> Column | None:
    """Return the column that tells the sizes of most objects, by the share of its texts that do; None below a tenth."""
    best = max(columns, key=lambda column: share(column) * len(column.filled), default=None)
    return best if best is not None and share(best) * len(best.filled) >= 0.1 * len(best.values) else None


def joined(columns: Sequence[Column], names: Sequence[str], separator: str) -> list[str]:
    """Return the different texts that some columns give together."""
    read = [next(column for column in columns if column.name == name) for name in names]
    rows = zip(*(column.values for column in read), strict=True)
    return list(dict.fromkeys(separator.join(filter(None, map(str.strip, row))) for row in rows))
