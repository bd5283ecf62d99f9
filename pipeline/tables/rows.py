"""Rows of tables checked by models: each table has one class that says what its columns may hold."""

import re
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from functools import cache
from types import MappingProxyType
from typing import Annotated, TypeVar
from unicodedata import category, normalize

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from pipeline.errors import InputError
from pipeline.tables import Range, Row, TableError, table

Model = TypeVar("Model")
RowOfWay = TypeVar("RowOfWay", bound="TableRow")
Way = TypeVar("Way", bound=StrEnum)

_DENIED = (
    r"not|never|without|no longer|isn't|aren't|formerly|previously|once|to be|should be|must be|will be|can be"
    r"|needs? to be|nicht|ohne|keine?|früher|ehemals|muss|müsste|soll|sollte|wird|non|pas|sans|jamais|autrefois"
    r"|doit être|sera|senza|già|deve essere|sarà|no|sin|nunca|antes|debe ser|será|niet|zonder|moet|wordt|δεν|χωρίς"
    r"|πρέπει να|não|sem|nu|fără|inte|ej|utan|ikke|uden|uten|ei|nie|bez|ne|není|nejsou|nije|nisu|ni|nem|nincs"
    r"|не|нет|без|μη|μην|لا|غير|ليس|بدون|לא|אינו|אינה|ללא"
    r"|taken down|taken off|removed|abgenommen|abgehängt von|décrochée?|tolt[oa]|rimoss[oa]|descolgad[oa]|retirad[oa]"
)
NO = re.compile(rf"\b(?:{_DENIED})\s+(?:\w+\s+)?$", re.IGNORECASE)
"""Before a thing that then is not there: "without felt", "no rubber"."""

BUT_NOT = re.compile(rf"(?:\b(?:{_DENIED})\s+(?:\w+\s+){{0,3}}|\bun|[无無未不非没沒]有?)$", re.IGNORECASE)
"""Before what then is not done: "not bolted", "must be clamped", "nicht an der Wand befestigt"."""

SOME_WORDS = r"(?:\w+\W+){0,3}"
"""What * stands for in the words of a table: up to three words."""

UNSEEN = re.compile("[\u00ad\u200b-\u200f\u202a-\u202e\u2060-\u2069\ufeff]")
"""Signs that show nothing: soft hyphens, marks of direction, what parts the letters of a Persian word."""


def unmarked(text: str) -> str:
    """Return a text decomposed (NFKD), without the marks of its letters and without what shows nothing.

    Of scripts whose vowels are marks, such as Devanagari and Thai, the consonants are left: enough to tell words by.
    """
    if text.isascii():
        return text
    return "".join(one for one in normalize("NFKD", UNSEEN.sub("", text)) if category(one)[0] != "M")


UNPARTED = re.compile("[\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af]")

UNSPACED = re.compile("[\u0e00-\u0eff]")
"""Letters of Thai and Lao, which put no spaces between words either, and the name of a thing before what it is of."""

_SHOWN = 80
"""Characters of a cell that a message repeats."""


def _entries(cell: object) -> object:
    return tuple(filter(None, map(str.strip, cell.split("|")))) if isinstance(cell, str) else cell


def _yes(cell: object) -> object:
    return {"yes": True, "no": False}.get(cell, cell) if isinstance(cell, str) else cell


def _filled(cell: str) -> str:
    if not cell.strip():
        raise InputError("is empty; every row needs it")
    return cell


Number = Annotated[float, Field(allow_inf_nan=False)]
"""A cell that holds a finite number."""

Optional = Annotated[Number | None, BeforeValidator(lambda cell: None if cell == "" else cell)]
"""A cell that holds a finite number or nothing."""

Entries = Annotated[tuple[str, ...], BeforeValidator(_entries)]
"""A cell whose entries are parted by `|`; empty ones do not count."""

Text = Annotated[str, AfterValidator(_filled)]
"""A cell that holds words."""

YesNo = Annotated[bool, BeforeValidator(_yes)]
"""A cell that says yes or no."""


class TableRow(BaseModel):
    """A row all of whose columns are known; what stands around the words of a cell does not count."""

    model_config = ConfigDict(frozen=True, extra="forbid", str_strip_whitespace=True)


class RangeRow(TableRow):
    """A row that states one value with its range, and who says so."""

    value: Number
    low: Number
    high: Number
    source: Text

    @field_validator("high")
    @classmethod
    def _in_order(cls, high: float, info: ValidationInfo) -> float | None:
        return in_order(high, info, "low", "value")

    @property
    def range(self) -> Range:
        """Value, low and high, in the unit of the row."""
        return Range(self.value, self.low, self.high, self.source)


def in_order(high: float | None, info: ValidationInfo, low: str, value: str) -> float | None:
    """Return the high end of a range.

    Parameters
    ----------
    high : float or None
        None for a range that is left out.
    info : ValidationInfo
        Of its validator; it holds the fields before it.
    low, value : str
        Names of the other two fields.

    Returns
    -------
    float or None
        The same.

    Raises
    ------
    ValueError
        Where the three are not in order.
    """
    three = (info.data.get(low), info.data.get(value), high)
    # What was refused already is not there, and has its own message.
    if None not in three and not three[0] <= three[1] <= high:  # type: ignore[operator]
        shown = " ".join(f"{one:g}" for one in three if one is not None)
        raise InputError(f"{low} <= {value} <= {info.field_name} does not hold ({shown}); put them in order")
    return high


def share_in_order(high: float, info: ValidationInfo, low: str, value: str, whole: str) -> float | None:
    """Return the high end of a range of shares of a whole, as `in_order` does: above 0, and at most all of it."""
    least = info.data.get(low)
    if high > 1.0 or (least is not None and least <= 0.0):
        raise InputError(f"is a share of the {whole}: low must be above 0 and high at most 1")
    return in_order(high, info, low, value)


def checked(
    model: type[Model],
    rows: Sequence[Row],
    file: str,
    *,
    named: str = "",
    context: Mapping[str, object] | None = None,
) -> tuple[Model, ...]:
    """Return the rows of a table as instances of its model.

    Parameters
    ----------
    model : type
        A dataclass or a pydantic model whose fields, or their aliases, are columns; other columns are left aside.
    rows : sequence of Row
        As `pipeline.tables.read_table` returns them: the first is line 2 of the file.
    file : str
        Its name, for messages.
    named : str
        The column by which messages name a row besides its line; "" for none.
    context : mapping, optional
        What validators of the model ask for.

    Returns
    -------
    tuple
        In the order of the file.

    Raises
    ------
    TableError
        For the first row that does not hold what the model says: file, line, column, value and what it must be.
    """
    adapter = TypeAdapter(model)
    return tuple(_one(adapter, row, f"{file}, line {line}", named, context) for line, row in enumerate(rows, start=2))


def _one(adapter: TypeAdapter[Model], row: Row, where: str, named: str, context: Mapping[str, object] | None) -> Model:
    try:
        return adapter.validate_python(dict(row), context=context)
    except ValidationError as problem:
        first = problem.errors(include_url=False)[0]
        column = str(first["loc"][0]) if first["loc"] else ""
        name = f", {named} {_short(row.get(named))}" if named else ""
        own = first.get("ctx", {}).get("error")
        if first["type"] == "missing":
            said = "there is no such column"
        elif first["type"] == "extra_forbidden":
            said = "no column is called so; correct its name, or remove it"
        elif own is not None:
            said = str(own)
        else:
            said = f"{first['msg'][:1].lower()}{first['msg'][1:]}, not {_short(row.get(column))}"
        # Not chained: pydantic would repeat the whole row.
        raise TableError(f"{where}{name}: column {column!r}: {said}") from None


def _short(cell: object) -> str:
    shown = repr(cell)
    return shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."


def any_of(words: Iterable[str]) -> re.Pattern[str]:
    """Return what finds any of the words of a table, one at least, in small letters or capitals.

    Parameters
    ----------
    words : iterable of str
        Whole words or phrases, in which * stands for up to three words; Chinese, Japanese and Korean ones, which
        nothing parts from each other, are found within others.
    """
    escaped = [(word, re.escape(word).replace(r"\*", SOME_WORDS)) for word in words]
    within = [pattern for word, pattern in escaped if UNPARTED.match(word)]
    parted = [pattern for word, pattern in escaped if not UNPARTED.match(word)]
    # One boundary for all: to look for it before each word took four times as long.
    # A Thai word may end with a sign that is no letter, behind which \b sees no end.
    return re.compile(
        "|".join([*within, *([rf"(?<!\w)(?:{'|'.join(parted)})(?!\w)"] if parted else [])]), re.IGNORECASE
    )


class NamedRange(RangeRow):
    """A row of a table of numbers, each called by its name."""

    name: Text


@cache
def named_ranges(kind: type[NamedRange], name: str) -> Mapping[str, Range]:
    """Return the numbers of a table by their names.

    Parameters
    ----------
    kind : type of NamedRange
        Of its rows.
    name : str
        Of the table.

    Raises
    ------
    TableError
        Naming the line of the table.
    """
    file = f"{name}.csv"
    rows = checked(kind, table(name), file, named="name")
    once((row.name for row in rows), "name", file)
    return MappingProxyType({row.name: row.range for row in rows})


def once(values: Iterable[str], column: str, file: str) -> None:
    """Refuse a value that stands in a column twice.

    Parameters
    ----------
    values : iterable of str
        Of the column, the first on line 2.
    column, file : str
        For the message.

    Raises
    ------
    TableError
        Naming file, both lines and the column.
    """
    seen: dict[str, int] = {}
    for line, value in enumerate(values, start=2):
        if value in seen:
            raise TableError(
                f"{file}, line {line}, {column} {_short(value)}: column {column!r}: line {seen[value]} has this name; "
                "give each row its own"
            )
        seen[value] = line


def one_each(rows: Sequence[RowOfWay], ways: type[Way], column: str, file: str, way: str) -> dict[Way, RowOfWay]:
    """Return rows by the way that each is about, of which there is one for every way.

    Parameters
    ----------
    rows : sequence of TableRow
        Of the table, the first on line 2.
    ways : type of StrEnum
        All that there are.
    column, file : str
        What names the way, and for messages.
    way : str
        What a message calls one.

    Raises
    ------
    TableError
        For a way with two rows, and for one without.
    """
    found: dict[Way, RowOfWay] = {getattr(row, column): row for row in rows}
    once([getattr(row, column) for row in rows], column, file)
    missing = [one.value for one in ways if one not in found]
    if missing:
        raise TableError(f"{file}: there is no row for {', '.join(missing)}; give each {way} one")
    return found
