"""Rows of the tables of mitigation: measures.csv and isolators.csv, Kouros's own or a museum's."""

import re
from collections.abc import Mapping, Sequence
from math import inf, isfinite
from string import Formatter
from typing import Annotated, Protocol, TypeVar

import numpy as np
from pydantic import (
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    field_validator,
)

from pipeline.models import MODELS, model_named
from pipeline.quantities import Quantity
from pipeline.tables import Row, TableError
from pipeline.tables.assumed import assumed
from pipeline.tables.rows import Entries, Number, TableRow, Text, checked, once


class Terms(Protocol):
    """What the row of a measure must and may say: see `pipeline.mitigate.measures.base.Measure`."""

    @property
    def gives(self) -> tuple[str, ...]:
        """Names that a sentence may ask for."""
        ...

    @property
    def limits(self) -> int:
        """How many limits there must be."""
        ...

    @property
    def limit_unit(self) -> str:
        """Their unit."""
        ...

    @property
    def last_resort(self) -> bool:
        """Whether nothing comes after it."""
        ...


STORED = "store_lower"
"""Name of what takes the place of removal for an object that is not on display: no row has it."""

_NAME = re.compile(r"[a-z][a-z0-9_]{0,59}")


def _empty_is(value: float) -> WrapValidator:
    """Return the validator of a cell that may be empty, which stands for a value of its own."""

    def read(cell: object, handler: ValidatorFunctionWrapHandler) -> object:
        return value if isinstance(cell, str) and not cell.strip() else handler(cell)

    return WrapValidator(read)


Above0 = Annotated[Number, Field(gt=0.0)]


class MeasureRow(TableRow):
    """A row of measures.csv: the words, limits, place and source of a measure.

    Attributes
    ----------
    name : str
        What recommendations, decisions and exports call it: the column ``measure``.
    like : str
        Name of the measure that it is a kind of; its own name where that is a measure by itself.
    order : float
        Measures are tried from the smallest to the largest.
    title : str
        What a report calls it.
    limit, limit_high : float
        In `limit_unit`, 0 for none; what they limit is said in the column ``what``.
    limit_unit : str
        SI, or "-".
    classes : tuple of str
        Classes of objects that it suits; empty for all.
    what : str
        What its limits are; for readers of the table.
    sentence : str
        What is advised; names of numbers in braces are filled in.
    source : str
        Who says so.
    """

    name: str = Field(alias="measure")
    like: str = Field(default="", validate_default=True)
    order: Number
    title: Text
    limit: Annotated[Above0, _empty_is(0.0)]
    limit_unit: str
    limit_high: Annotated[Above0, _empty_is(0.0)]
    classes: Entries
    what: str
    sentence: Text
    source: Text

    @field_validator("name")
    @classmethod
    def _plain(cls, name: str) -> str:
        if not _NAME.fullmatch(name):
            raise ValueError(f"must be a name of small letters, digits and _, such as wall_hook, not {name!r}")
        if name == STORED:
            raise ValueError(f"is {name!r}, which Kouros advises of itself; give the row another name")
        return name

    @field_validator("like")
    @classmethod
    def _known(cls, like: str, info: ValidationInfo) -> str:
        if "name" not in info.data:
            return like
        name: str = info.data["name"]
        known = _known_measures(info)
        listed = ", ".join(known)
        if name in known:
            if like not in ("", name):
                raise ValueError(f"must be empty: {name} is a measure by itself; give the row a name of its own")
            return name
        if not like:
            raise ValueError(
                f"is empty, and nothing is known of such a measure; use one of {listed}, or say here of which of them "
                "it is a kind"
            )
        if like not in known:
            raise ValueError(f"must be the measure that it is a kind of, one of {listed}, not {like!r}")
        if known[like].last_resort:
            raise ValueError(f"is {like!r}, of which there is one only; give the row {like} your own words instead")
        return like

    @field_validator("limit", "limit_high")
    @classmethod
    def _limited(cls, limit: float, info: ValidationInfo) -> float:
        terms = _terms(info)
        wanted = terms is not None and terms.limits > ("limit", "limit_high").index(info.field_name or "limit")
        if wanted and not limit:
            raise ValueError("is empty; write the number")
        return limit

    @field_validator("limit_unit")
    @classmethod
    def _in_unit(cls, unit: str, info: ValidationInfo) -> str:
        terms = _terms(info)
        if terms is not None and terms.limit_unit not in ("", unit):
            raise ValueError(f"must be {terms.limit_unit!r}, not {unit!r}")
        return unit

    @field_validator("classes")
    @classmethod
    def _of_classes(cls, classes: tuple[str, ...]) -> tuple[str, ...]:
        known = assumed().classes
        strange = next((name for name in classes if name not in known), None)
        if strange is not None:
            raise ValueError(f"names {strange!r}, which is no class; see kouros's classes.csv")
        return classes

    @field_validator("sentence")
    @classmethod
    def _fillable(cls, sentence: str, info: ValidationInfo) -> str:
        try:
            pieces = list(Formatter().parse(sentence))
        except ValueError as problem:
            raise ValueError(f"has a stray brace ({problem}); write {{{{ or }}}}") from problem
        terms = _terms(info)
        for _, name, spec, conversion in pieces:
            if terms is not None and name is not None and (name not in terms.gives or spec or conversion):
                listed = ", ".join(f"{{{known}}}" for known in terms.gives) or "no number"
                raise ValueError(f"asks for {{{name}}}; there is {listed}")
        return sentence


def _known_measures(info: ValidationInfo) -> Mapping[str, Terms]:
    known: Mapping[str, Terms] = {} if info.context is None else info.context["measures"]
    return known


def _terms(info: ValidationInfo) -> Terms | None:
    return _known_measures(info).get(info.data.get("like", ""))


class Isolator(TableRow):
    """A row of isolators.csv.

    Attributes
    ----------
    name : str
        What the catalogue calls it.
    kind : str
        Model that it is run by.
    frequency : float
        Natural frequency [Hz]; 0 where its kind has none.
    damping : float
        Ratio to critical damping [-]; 0 where its kind has none.
    friction : float
        Static friction [-]; 0 where its kind has none.
    stroke : float
        How far it can move [m]; infinite where it is as long as its place allows.
    maker : str
        Whose product it is; empty for a generic one.  A product has its maker's limits: stroke, width and load.
    platform_width : float
        Narrower side of its platform [m], which is not held down; 0 where it is to be as wide as the load asks for.
    platform_mass : float
        Mass of what moves of the isolator itself [kg]; 0 where it is not known, so that nothing is counted on.
    load_least, load_most : float
        Mass that it may carry [kg].
    source : str
        Who says so.
    """

    name: Text
    kind: str
    frequency: float
    damping: float
    friction: float
    stroke: Annotated[Above0, _empty_is(inf)]
    maker: str = ""
    platform_width: Annotated[Above0, _empty_is(0.0)] = 0.0
    platform_mass: Annotated[Above0, _empty_is(0.0)] = 0.0
    load_least: Annotated[Above0, _empty_is(0.0)] = 0.0
    load_most: Annotated[Above0, _empty_is(inf)] = inf
    source: Text

    @field_validator("kind")
    @classmethod
    def _known(cls, kind: str) -> str:
        kinds = [model.name for model in MODELS if model.kind == "isolator"]
        if kind not in kinds:
            raise ValueError(f"is {kind!r}; use one of {', '.join(kinds)}")
        return kind

    @field_validator("frequency", "damping", "friction", mode="before")
    @classmethod
    def _its_own(cls, cell: object, info: ValidationInfo) -> object:
        if "kind" not in info.data or _number_of(info) is not None:
            return cell
        if str(cell).strip():
            raise ValueError(f"must be empty: a {info.data['kind']} has none")
        return 0.0

    @field_validator("frequency", "damping", "friction")
    @classmethod
    def _allowed(cls, value: float, info: ValidationInfo) -> float:
        quantity = _number_of(info)
        if quantity is None:
            return value
        try:
            quantity.check(np.array([value]))
        except ValueError as problem:
            raise ValueError(f"must be {quantity.allowed()}, not {value:g}") from problem
        return value

    @field_validator("stroke")
    @classmethod
    def _long(cls, stroke: float, info: ValidationInfo) -> float:
        if info.data.get("kind") == "rotational_isolator" and isfinite(stroke):
            raise ValueError("must be empty: it turns, and has none")
        return stroke

    @field_validator("platform_width", "load_most")
    @classmethod
    def _of_a_product(cls, limit: float, info: ValidationInfo) -> float:
        # The cells before it were read already: a product without a stroke is told here too.
        if info.data.get("kind") != "horizontal_isolator" or not info.data.get("maker"):
            return limit
        if limit in (0.0, inf) or info.data.get("stroke") == inf:
            column = info.field_name if limit in (0.0, inf) else "stroke"
            raise ValueError(f"a product of {info.data['maker']} has its maker's limits; fill in {column}")
        return limit

    @field_validator("load_most")
    @classmethod
    def _above_the_least(cls, high: float, info: ValidationInfo) -> float:
        if high < info.data.get("load_least", 0.0):
            raise ValueError(f"must be at least load_least, {info.data['load_least']:g} kg")
        return high


def _number_of(info: ValidationInfo) -> Quantity | None:
    """Return the parameter of an isolator's model that a column holds, None where it has none."""
    kind, column = info.data.get("kind"), info.field_name
    needs = () if kind is None else model_named(kind).needs
    return next((q for q in needs if q.name == column or (q.name, column) == ("friction_static", "friction")), None)


RowT = TypeVar("RowT", bound=TableRow)


def _read(
    model: type[RowT], rows: Sequence[Row], file: str, named: str, context: Mapping[str, object] | None = None
) -> tuple[RowT, ...]:
    """Return rows held against a model, whose fields are the columns that there must and may be."""
    if not rows:
        raise TableError(f"{file} has no rows; give it at least one, or leave its setting empty")
    needed = {field.alias or name: field.is_required() for name, field in model.model_fields.items()}
    must = f"it must have {', '.join(column for column, always in needed.items() if always)}"
    for column, always in needed.items():
        if always and column not in rows[0]:
            raise TableError(f"{file}: there is no column {column!r}; {must}")
    for column in rows[0]:
        if column not in needed:
            may = ", ".join(name for name, always in needed.items() if not always)
            raise TableError(f"{file}: column {column!r} is not known; {must}{f', and may have {may}' if may else ''}")
    found = checked(model, rows, file, named=named, context=context)
    once([row[named].strip() for row in rows], named, file)
    return found


def read_measure_rows(rows: Sequence[Row], file: str, measures: Mapping[str, Terms]) -> tuple[MeasureRow, ...]:
    """Return the rows of a table of measures, in their order.

    Parameters
    ----------
    rows : sequence of Row
        Cells by column: those of `MeasureRow`.
    file : str
        Name of the file, for messages.
    measures : mapping
        The measures that a row may be of, by name.

    Raises
    ------
    TableError
        Naming file, line, column and remedy.
    """
    return _read(MeasureRow, rows, file, "measure", {"measures": measures})


def read_isolators(rows: Sequence[Row], file: str) -> tuple[Isolator, ...]:
    """Return the rows of a catalogue of isolators, in their order.

    Raises
    ------
    TableError
        Naming file, line, column and remedy.
    """
    return _read(Isolator, rows, file, "name")
