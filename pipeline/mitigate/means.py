"""What a museum can do: the table of measures and the catalogue of isolators, Kouros's own or the museum's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import isfinite
from pathlib import Path
from string import Formatter

import numpy as np

from pipeline.models import model_named
from pipeline.tables import Row, TableError, number, read_table, table

KINDS = ("friction_isolator", "horizontal_isolator", "rotational_isolator")


@dataclass(frozen=True)
class Terms:
    """What a measure's row must and may say.

    gives  : numbers that its sentence may ask for
    limits : how many limits it needs
    unit   : that of the limit
    """

    gives: tuple[str, ...]
    limits: int = 0
    unit: str = ""


HOLDS = ("force", "moment")

TERMS: Mapping[str, Terms] = {
    "clearance": Terms(("clearance", "movement"), 2, "m"),
    "rubber_pads": Terms(("damping", "movement"), 1, "-"),
    "surface": Terms(("friction", "movement", "surface"), 1, "-"),
    "grip_pad": Terms(("friction", "movement"), 1, "-"),
    "wax": Terms(("area", *HOLDS), 1, "-"),
    "ballast": Terms(("mass", "height", "cg_height"), 2, "-"),
    "wide_base": Terms(("width", "clearance", *HOLDS), 2, "-"),
    "fasten": Terms(HOLDS),
    "restrain": Terms(("force",)),
    "friction_isolator": Terms(("friction", "clearance", "movement"), 1, "m"),
    "horizontal_isolator": Terms(("frequency", "damping", "friction", "stroke", "acceleration", "what", "how"), 1, "m"),
    "rotational_isolator": Terms(("frequency", "damping", "rotation", "rotation_limit", "acceleration"), 1, "rad"),
    "strengthen": Terms(("enlargement", "section_modulus", *HOLDS), 1, "-"),
    "remove": Terms(()),
}
"""The measures that Kouros knows how to run."""

LAST = "remove"

STORED = "store_lower"
"""What takes the place of LAST for an object that is not on display, and cannot be taken off it."""

STORED_TITLE = "Store it lower, or make it fast"

STORED_SENTENCE = (
    "Store it lower, or make it fast on its shelf: none of the measures tried is enough, and there is no model of "
    "shelves here that says more."
)


@dataclass(frozen=True, slots=True)
class Measure:
    """A row of measures.csv.

    limit, limit_high : SI; None where the measure has none
    classes           : of objects that it suits; empty: all
    """

    name: str
    order: float
    title: str
    limit: float
    limit_high: float
    classes: frozenset[str]
    sentence: str
    source: str


@dataclass(frozen=True, slots=True)
class Isolator:
    """A row of isolators.csv; ``stroke`` is its own in m, infinite where it is as long as its place allows."""

    name: str
    kind: str
    frequency: float
    damping: float
    friction: float
    stroke: float
    source: str


@dataclass(frozen=True)
class Means:
    """The measures, least intrusive first, and the isolators."""

    measures: tuple[Measure, ...]
    isolators: tuple[Isolator, ...]

    def of(self, kind: str) -> list[Isolator]:
        """Return the isolators of one kind, in the order of their table."""
        return [isolator for isolator in self.isolators if isolator.kind == kind]


@cache
def own_means() -> Means:
    """Return Kouros's own tables."""
    return Means(read_measures(table("measures"), "measures.csv"), read_isolators(table("isolators"), "isolators.csv"))


def means(measures: Path | None = None, catalogue: Path | None = None) -> Means:
    """Return the means of a museum.

    measures  : a CSV file with the columns of tables/measures.csv, whose rows replace Kouros's of the same name
    catalogue : a CSV file with the columns of tables/isolators.csv, which takes the place of that table
    raises    : TableError naming file, line, column and remedy; FileNotFoundError
    """
    own = own_means()
    listed, isolators = own.measures, own.isolators
    if measures is not None:
        rows = _columns(read_table(measures), table("measures")[0], measures.name)
        theirs = {measure.name: measure for measure in read_measures(rows, measures.name)}
        listed = _ordered([theirs.get(measure.name, measure) for measure in own.measures], measures.name)
    if catalogue is not None:
        rows = _columns(read_table(catalogue), table("isolators")[0], catalogue.name)
        isolators = read_isolators(rows, catalogue.name)
    return Means(listed, isolators)


def _columns(rows: Sequence[Row], wanted: Row, file: str) -> Sequence[Row]:
    if not rows:
        raise TableError(f"{file} has no rows; give it at least one, or leave its setting empty")
    for column in wanted:
        if column not in rows[0]:
            raise TableError(f"{file}: there is no column {column!r}; it must have {', '.join(wanted)}")
    for column in rows[0]:
        if column not in wanted:
            raise TableError(f"{file}: column {column!r} is not known; it must have {', '.join(wanted)}")
    return rows


def read_measures(rows: Sequence[Row], file: str) -> tuple[Measure, ...]:
    """Return the rows of a table of measures, least intrusive first.

    raises : TableError naming file, line, column and remedy
    """
    found: dict[str, Measure] = {}
    for line, row in enumerate(rows, start=2):
        name = row["measure"].strip()
        where = f"{file}, line {line}, measure {name!r}"
        if name not in TERMS:
            raise TableError(f"{where}: nothing is known of such a measure; use one of {', '.join(TERMS)}")
        if name in found:
            raise TableError(f"{where}: it has a row already; keep one")
        found[name] = _measure(name, row, where)
    return _ordered(list(found.values()), file)


def _ordered(measures: Sequence[Measure], file: str) -> tuple[Measure, ...]:
    ordered = tuple(sorted(measures, key=lambda measure: measure.order))
    removal = next((measure for measure in ordered if measure.name == LAST), None)
    if removal is not None and removal is not ordered[-1]:
        raise TableError(f"{file}: measure {LAST!r}: column 'order' must be the largest of all: nothing comes after it")
    return ordered


def _measure(name: str, row: Row, where: str) -> Measure:
    terms = TERMS[name]
    known = frozenset(each["class"] for each in table("classes"))
    classes = frozenset(text.strip() for text in row["classes"].split("|") if text.strip())
    strange = sorted(classes - known)
    if strange:
        raise TableError(f"{where}: column 'classes': there is no class {strange[0]!r}; see kouros's classes.csv")
    limits = [0.0, 0.0]
    for at, column in enumerate(("limit", "limit_high")[: terms.limits]):
        limits[at] = _above_zero(row, column, where)
    if terms.unit and row["limit_unit"] != terms.unit:
        raise TableError(f"{where}: column 'limit_unit' must be {terms.unit!r}, not {row['limit_unit']!r}")
    order = number(row, "order", where)
    if not isfinite(order):
        raise TableError(f"{where}: column 'order' must be a finite number, not {row['order']!r}")
    for column in ("title", "sentence", "source"):
        if not row[column].strip():
            raise TableError(f"{where}: column {column!r} is empty; the report needs it")
    _check_sentence(row["sentence"], terms, where)
    return Measure(name, order, row["title"], limits[0], limits[1], classes, row["sentence"], row["source"])


def _check_sentence(sentence: str, terms: Terms, where: str) -> None:
    try:
        pieces = list(Formatter().parse(sentence))
    except ValueError as problem:
        raise TableError(f"{where}: column 'sentence' has a stray brace ({problem}); write {{{{ or }}}}") from problem
    for _, name, spec, conversion in pieces:
        if name is None:
            continue
        if name not in terms.gives or spec or conversion:
            listed = ", ".join(f"{{{known}}}" for known in terms.gives) or "no number"
            raise TableError(f"{where}: column 'sentence' asks for {{{name}}}; there is {listed}")


def read_isolators(rows: Sequence[Row], file: str) -> tuple[Isolator, ...]:
    """Return the rows of a catalogue of isolators.

    raises : TableError naming file, line, column and remedy
    """
    out: list[Isolator] = []
    for line, row in enumerate(rows, start=2):
        name = row["name"].strip()
        where = f"{file}, line {line}, isolator {name!r}"
        if not name or any(name == other.name for other in out):
            raise TableError(f"{where}: column 'name' must be a name of its own")
        kind = row["kind"].strip()
        if kind not in KINDS:
            raise TableError(f"{where}: column 'kind' is {kind!r}; use one of {', '.join(KINDS)}")
        if not row["source"].strip():
            raise TableError(f"{where}: column 'source' is empty; say who says so")
        out.append(_isolator(name, kind, row, where))
    return tuple(out)


def _isolator(name: str, kind: str, row: Row, where: str) -> Isolator:
    needed = {"friction_static": "friction"} if kind == "friction_isolator" else {}
    own = {q.name: q for q in model_named(kind).needs}
    values = {"frequency": 0.0, "damping": 0.0, "friction": 0.0}
    for column in tuple(values):
        quantity = next((own[n] for n in own if needed.get(n, n) == column), None)
        if quantity is None:
            if row[column].strip():
                raise TableError(f"{where}: column {column!r} must be empty: a {kind} has none")
            continue
        value = number(row, column, where)
        try:
            quantity.check(np.array([value]))
        except ValueError as problem:
            allowed = quantity.allowed()
            raise TableError(f"{where}: column {column!r} must be {allowed}, not {row[column]!r}") from problem
        values[column] = value
    stroke = _above_zero(row, "stroke", where) if row["stroke"].strip() else float("inf")
    if kind == "rotational_isolator" and isfinite(stroke):
        raise TableError(f"{where}: column 'stroke' must be empty: it turns, and has none")
    return Isolator(name, kind, values["frequency"], values["damping"], values["friction"], stroke, row["source"])


def _above_zero(row: Row, column: str, where: str) -> float:
    value = number(row, column, where)
    if not (isfinite(value) and value > 0.0):
        raise TableError(f"{where}: column {column!r} must be a finite number above 0, not {row[column]!r}")
    return value
