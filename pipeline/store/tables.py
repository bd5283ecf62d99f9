"""The tables of the results, one column for each field of the record that a row keeps."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from enum import StrEnum
from math import isnan
from operator import index
from types import NoneType
from typing import Any, SupportsIndex, get_args, get_type_hints

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    Dialect,
    Double,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    Table,
    Text,
    UniqueConstraint,
)
from sqlalchemy.types import TypeDecorator, TypeEngine

from pipeline.collection.database import METADATA
from pipeline.collection.inventory import IMPORT_BATCH, ITEM
from pipeline.collection.inventory.local_measurements import SUPPLEMENT
from pipeline.collection.inventory.reading_report import READING
from pipeline.collection.inventory.source_rows import SOURCE_ROW, SOURCE_STATE
from pipeline.collection.sealing import seal_column
from pipeline.records import Chart, Decision, DecisionStatus, MotionSummary
from pipeline.store import codec

# The inventory's tables are handed on so that METADATA is whole wherever this module is imported.
__all__ = [
    "ACCOUNT",
    "DECISION",
    "ERRAND_WORD",
    "EVENT_REPORT",
    "IMPORT_BATCH",
    "ITEM",
    "METADATA",
    "PAGE",
    "PICTURE",
    "READING",
    "RESULT",
    "RUN",
    "RUN_CHART",
    "RUN_DECISION",
    "RUN_MOTION",
    "RUN_PAGE",
    "SESSION",
    "SOURCE_ROW",
    "SOURCE_STATE",
    "SUPPLEMENT",
]


class _Coded(TypeDecorator[Any]):
    """Text in the database that stands for a value: a kind of column says how to write one and read it back."""

    impl = Text
    cache_ok = True

    def write(self, value: Any) -> str:
        """Return the text that is kept."""
        raise NotImplementedError

    def read(self, text: str) -> Any:
        """Return the value that was kept."""
        raise NotImplementedError

    def process_bind_param(self, value: Any | None, dialect: Dialect) -> str | None:  # noqa: ARG002
        """Write, for every database alike."""
        return None if value is None else self.write(value)

    def process_result_value(self, value: Any | None, dialect: Dialect) -> Any:  # noqa: ARG002
        """Read, from every database alike."""
        return None if value is None else self.read(value)


class WordsColumn(_Coded):
    """Any Unicode text, whatever is in it (see `codec.escape`)."""

    cache_ok = True

    def write(self, value: str) -> str:
        """Make the text one that every database can hold."""
        return codec.escape(value)

    def read(self, text: str) -> str:
        """Give the text back as it was."""
        return codec.unescape(text)


class ChoiceColumn(_Coded):
    """A member of an enumeration, kept as its text."""

    cache_ok = True

    def __init__(self, kind: type[StrEnum]) -> None:
        super().__init__()
        self.kind = kind

    def write(self, value: StrEnum) -> str:
        """Put the member's text.

        Raises
        ------
        ValueError
            For a text that is no member.
        """
        return self.kind(value).value

    def read(self, text: str) -> StrEnum:
        """Give the member.

        Raises
        ------
        ValueError
            For a text that is no member.
        """
        return self.kind(text)


class JsonColumn(_Coded):
    """A nested record as JSON text; ``column::json`` reads it in PostgreSQL, ``json_extract`` in SQLite."""

    cache_ok = True

    def __init__(self, hint: Any) -> None:
        super().__init__()
        self.hint = hint

    def write(self, value: Any) -> str:
        """Write the value by its type.

        Raises
        ------
        StoreError
            (see `codec.to_json`).
        """
        return codec.to_json(self.hint, value)

    def read(self, text: str) -> Any:
        """Read the value by its type.

        Raises
        ------
        StoreError
            (see `codec.of_json`).
        """
        return codec.of_json(self.hint, text)


class SettingsColumn(_Coded):
    """Settings, which have no type, as JSON text (see `codec`)."""

    cache_ok = True

    def write(self, value: Mapping[str, Any]) -> str:
        """Write the settings.

        Raises
        ------
        StoreError
            (see `codec.settings_to_json`).
        """
        return codec.settings_to_json(value)

    def read(self, text: str) -> dict[str, Any]:
        """Read the settings."""
        return codec.settings_from_json(text)


class NumberColumn(TypeDecorator[float]):
    """A double of any value.  SQLite turns NaN into NULL, so that there it is kept as the text "NaN".

    Both databases sort NaN above every number, and both keep infinities.
    """

    impl = Double
    cache_ok = True

    def bind_processor(self, dialect: Dialect) -> Callable[[Any], Any] | None:
        """Put "NaN" for NaN where the database is SQLite, past the type below, which would make a float of it again."""
        return _nan_as_text if dialect.name == "sqlite" else super().bind_processor(dialect)

    def process_result_value(self, value: Any | None, dialect: Dialect) -> float | None:  # noqa: ARG002
        """Give a float, NaN included."""
        return None if value is None else float(value)


class WholeColumn(TypeDecorator[int]):
    """A whole number; numpy's are made Python's, for SQLite would keep their bytes."""

    impl = BigInteger
    cache_ok = True

    def process_bind_param(self, value: SupportsIndex | None, dialect: Dialect) -> int | None:  # noqa: ARG002
        """Put an int.

        Raises
        ------
        TypeError
            For what is no whole number.
        """
        return None if value is None else index(value)


def _nan_as_text(value: float | None) -> float | str | None:
    if value is None:
        return None
    return "NaN" if isnan(value) else float(value)


def _column_type(hint: Any) -> TypeEngine[Any]:
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        return ChoiceColumn(hint)
    plain: dict[Any, TypeEngine[Any]] = {str: WordsColumn(), float: NumberColumn(), int: WholeColumn(), bool: Boolean()}
    return plain.get(hint) or JsonColumn(hint)


def _columns(record: type[Any], *names: str) -> list[Column[Any]]:
    """Return a column for each of the named fields of a record (default: all), typed by the field's type hint."""
    hints = get_type_hints(record)
    columns: list[Column[Any]] = []
    for name in names or tuple(field.name for field in fields(record)):
        options = [part for part in get_args(hints[name]) if part is not NoneType]
        optional = NoneType in get_args(hints[name])
        columns.append(Column(name, _column_type(options[0] if optional else hints[name]), nullable=optional))
    return columns


def _of_run() -> Column[Any]:
    return Column("run_id", WordsColumn(), ForeignKey("run.run_id", ondelete="CASCADE"), primary_key=True)


def _position() -> Column[Any]:
    # The order in which the run had them; part of no record, but equal records come back in equal order.
    return Column("position", BigInteger(), primary_key=True, autoincrement=False)


RUN = Table(
    "run",
    METADATA,
    Column("run_id", WordsColumn(), primary_key=True),
    Column("started", WordsColumn(), nullable=False),
    Column("finished", WordsColumn(), nullable=False),
    Column("version", WordsColumn(), nullable=False),
    Column("site", WordsColumn(), nullable=False),
    Column("museum", WordsColumn(), nullable=False),
    Column("level_notes", JsonColumn(tuple[str, ...]), nullable=False),
    Column("settings", SettingsColumn(), nullable=False),
    Column("demonstration", Boolean(), nullable=False),
    Column("status", WordsColumn(), nullable=False),
    Column("counts", JsonColumn(dict[str, int]), nullable=False),
    seal_column(),
    Index(None, "status", "started"),
)
"""One row a run; status is "finished", or "unfinished" for a run without a time of finishing."""

RUN_MOTION = Table("run_motion", METADATA, _of_run(), _position(), *_columns(MotionSummary), seal_column())
"""The motions of a run; measures, steps and series as JSON."""

RUN_CHART = Table(
    "run_chart",
    METADATA,
    _of_run(),
    Column("key", WordsColumn(), primary_key=True),
    Column("position", BigInteger(), nullable=False),
    Column("chart", JsonColumn(Chart), nullable=False),
    seal_column(),
)
"""The charts of a run by key; the chart itself as JSON."""

RESULT = Table(
    "result",
    METADATA,
    Column("key", WordsColumn(), primary_key=True),
    Column("run_id", WordsColumn(), nullable=False),
    Column("made", WordsColumn(), nullable=False),
    Column("outline", WordsColumn(), nullable=False),
    Column("found", LargeBinary(), nullable=False),
    Column("seal", Text(), nullable=False),
)
"""What was found about a unit, one object or all in one case, under the digest of everything that it depends on.

run_id  : the run that found it, which may be gone;  made : when, ISO 8601, UTC
outline : of each object what comparisons need, JSON;  found : everything, compressed JSON (see `results`)
seal    : of all the others (see `collection.sealing`)
"""

PAGE = Table(
    "page",
    METADATA,
    Column("key", WordsColumn(), primary_key=True),
    Column("run_id", WordsColumn(), nullable=False),
    Column("made", WordsColumn(), nullable=False),
    Column("members", LargeBinary(), nullable=False),
    Column("seal", Text(), nullable=False),
)
"""The objects of a page, under the digest of their numbers, places, records and results; never changed.

run_id, made : of the newest of their results
members      : their records, and the keys of their results, compressed JSON (see `pages`)
"""

RUN_PAGE = Table(
    "run_page",
    METADATA,
    _of_run(),
    _position(),
    Column("key", WordsColumn(), ForeignKey("page.key"), nullable=False),
    Column("gallery", WordsColumn(), nullable=False),
    Column("on_display", Boolean(), nullable=False),
    Column("number", Integer(), nullable=False),
    Column("of", Integer(), nullable=False),
    seal_column(),
    Index(None, "key"),
)
"""The pages of a run; an unchanged one is that of an earlier run."""

DECISION = Table(
    "decision",
    METADATA,
    Column("id", Integer(), primary_key=True),
    *_columns(Decision, *(field.name for field in fields(Decision) if field.name != "id")),
    seal_column(),
    UniqueConstraint("withdraws"),
    Index(None, "object_number"),
    sqlite_autoincrement=True,
)
"""One row a decision of a person; rows are only ever added, and no run or import touches them."""

RUN_DECISION = Table(
    "run_decision",
    METADATA,
    _of_run(),
    _position(),
    Column("object_number", WordsColumn(), nullable=False),
    *_columns(DecisionStatus),
    seal_column(),
    Index(None, "run_id", "object_number"),
)
"""The decisions that were in force when a run was made, as they stood, with what was then to be doubted."""

ACCOUNT = Table(
    "desk_account",
    METADATA,
    Column("name", WordsColumn(), primary_key=True),
    Column("role", WordsColumn(), nullable=False),
    Column("secret", WordsColumn(), nullable=False),
    Column("made", WordsColumn(), nullable=False),
)
"""People who may sign in; secret: Argon2 of the password, never the password."""

SESSION = Table(
    "desk_session",
    METADATA,
    Column("token", WordsColumn(), primary_key=True),
    Column("name", WordsColumn(), nullable=False, index=True),
    Column("ends", Integer(), nullable=False),
)
"""Who is signed in; token: SHA-256 of what the browser holds; ends: seconds since 1970."""

ERRAND_WORD = Table(
    "errand_word",
    METADATA,
    Column("id", Integer(), primary_key=True),
    Column("errand", WordsColumn(), nullable=False, index=True),
    Column("kind", WordsColumn(), nullable=False),
    Column("whose", WordsColumn(), nullable=False),
    Column("note", WordsColumn(), nullable=False),
    Column("who", WordsColumn(), nullable=False),
    Column("recorded", WordsColumn(), nullable=False),
    seal_column(),
    sqlite_autoincrement=True,
)
"""What was said of errands: that somebody takes one, gives it to somebody, has done it, or puts it back."""

PICTURE = Table(
    "mount_picture",
    METADATA,
    Column("id", Integer(), primary_key=True),
    Column("object_number", WordsColumn(), nullable=False, index=True),
    Column("note", WordsColumn(), nullable=False),
    Column("who", WordsColumn(), nullable=False),
    Column("recorded", WordsColumn(), nullable=False),
    Column("image", LargeBinary(), nullable=False),
    seal_column(),
    sqlite_autoincrement=True,
)
"""Photographs of mounts, as JPEG that Kouros itself wrote."""

EVENT_REPORT = Table(
    "event_report",
    METADATA,
    Column("id", Integer(), primary_key=True),
    Column("event", WordsColumn(), nullable=False, index=True),
    Column("object_number", WordsColumn(), nullable=False),
    Column("state", WordsColumn(), nullable=False),
    Column("moved_m", Double()),
    Column("note", WordsColumn(), nullable=False),
    Column("who", WordsColumn(), nullable=False),
    Column("recorded", WordsColumn(), nullable=False),
    seal_column(),
    sqlite_autoincrement=True,
)
"""What people found of objects after an earthquake, which is known by the name of its folder."""
