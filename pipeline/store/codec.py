"""Records <-> what a column of a database can hold, decided here and nowhere else.

- A nested record (an Estimate, a Chart, a tuple of Checks) is kept as JSON text, written and read by its type hints.
  JSON knows no infinity: such a float becomes the string "Infinity", "-Infinity" or "NaN", and a float again when read.
- Settings have no type hints.  What JSON cannot say is tagged: ``{"$float": "inf"}``, ``{"$tuple": [...]}``; a key of
  the settings that itself begins with "$" gets a second one.
- PostgreSQL's text cannot hold the character NUL, which a spreadsheet can: it is kept as SUB "0", and SUB itself as
  SUB "1" (SUB is U+001A), in every database alike, so that one can be copied into the other.

Compression of results: zlib with a dictionary of texts that they share, so that each row holds what is its own.

A dictionary is a file in `dictionaries`, named by its Adler-32 checksum, which zlib writes into what it compresses:
what was compressed with an earlier one is read as long as that one's file is there, what was compressed with none
always.  A file is never changed: `python -m tests.benchmarks.dictionary` makes a new one.
"""

import json
import math
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, TypeAdapter
from pydantic_core import PydanticSerializationError, from_json
from sqlalchemy import Engine
from sqlalchemy.exc import IntegrityError, SQLAlchemyError

from pipeline.errors import InputError

_SUB = "\x1a"
_TAGS = {"$float": float, "$tuple": tuple}
NOT_FINITE = ("Infinity", "-Infinity", "NaN")
"""The JSON strings that stand for a float that is not finite."""


class StoreError(InputError):
    """The store cannot do what it was asked to; the message says why and what mends it."""


@cache
def adapter(hint: Any) -> TypeAdapter[Any]:
    """Return what writes and reads values of one type hint; None is allowed too.

    Parameters
    ----------
    hint : Any
        A dataclass of `pipeline.records`, or a tuple or Mapping of such, or a plain type.

    Returns
    -------
    TypeAdapter[Any]
    """
    # The union is what makes room for a configuration: pydantic takes none for a bare dataclass.
    return TypeAdapter(hint | None, config=ConfigDict(ser_json_inf_nan="strings"))


def to_json(hint: Any, value: Any) -> str:
    """Write a value of that type as JSON text that is the same for equal values.

    Raises
    ------
    StoreError
        Where the value is not of the type, or holds text that is not Unicode (a lone surrogate).
    """
    try:
        # The fallback only lets pydantic go on to the warning, which names the field where the error would not.
        return adapter(hint).dump_json(value, warnings="error", fallback=repr).decode()
    except PydanticSerializationError as error:
        why = str(error).removeprefix("Pydantic serializer warnings:\n").strip()
        raise StoreError(f"{why}; correct the value where it was made or imported") from error


def of_json(hint: Any, text: str) -> Any:
    """Read what `to_json` wrote; tuples, enumerations and records come back as such.

    Raises
    ------
    StoreError
        Where the text is not JSON of that type.
    """
    try:
        return adapter(hint).validate_json(text)
    except ValueError as error:
        raise StoreError(f"not a stored {hint}: {error}; the database was changed by hand or is damaged") from error


def settings_to_json(settings: Mapping[str, Any]) -> str:
    """Write settings (text, numbers, truth values, None, and tuples, lists and mappings of them) as JSON text.

    Raises
    ------
    StoreError
        Naming the setting that is anything else.
    """
    return json.dumps(_tagged(settings, "settings"), allow_nan=False)


def settings_from_json(text: str) -> dict[str, Any]:
    """Read what `settings_to_json` wrote, tuples and infinities included."""
    settings: dict[str, Any] = json.loads(text, object_hook=_untagged)
    return settings


def _tagged(value: Any, where: str) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else {"$float": str(float(value))}
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, tuple):
        return {"$tuple": [_tagged(v, f"{where}[{i}]") for i, v in enumerate(value)]}
    if isinstance(value, list):
        return [_tagged(v, f"{where}[{i}]") for i, v in enumerate(value)]
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        return {f"${k}" if k.startswith("$") else k: _tagged(v, f"{where}.{k}") for k, v in value.items()}
    kind = "a mapping whose keys are not text" if isinstance(value, Mapping) else f"a {type(value).__name__}"
    raise StoreError(f"{where} is {kind}, which the store does not keep; make it text, a number, a list or a mapping")


def _untagged(read: dict[str, Any]) -> Any:
    if len(read) == 1:
        key, value = next(iter(read.items()))
        if key in _TAGS:
            return _TAGS[key](value)
    return {k.removeprefix("$"): v for k, v in read.items()}


def escape(text: str) -> str:
    """Return text that every database can hold.

    Raises
    ------
    StoreError
        For text that is not Unicode (a lone surrogate).
    """
    if not text.isascii():
        try:
            text.encode()
        except UnicodeEncodeError as error:
            raise StoreError(f"{text!a} is not Unicode text ({error.reason}); correct it where it came in") from error
    if "\0" in text or _SUB in text:
        return text.replace(_SUB, f"{_SUB}1").replace("\0", f"{_SUB}0")
    return text


def unescape(text: str) -> str:
    """Return the text that `escape` was given."""
    return text.replace(f"{_SUB}0", "\0").replace(f"{_SUB}1", _SUB) if _SUB in text else text


def plain(hint: Any, value: Any) -> Any:
    """Return a value as plain dictionaries and lists, to see which parts of two records differ.

    Raises
    ------
    StoreError
        As `to_json`.
    """
    return from_json(to_json(hint, value))


def check_type(where: str, hint: Any, value: Any) -> None:
    """Refuse a value that is not of a type, saying where it is.

    Raises
    ------
    StoreError
    """
    try:
        to_json(hint, value)
    except StoreError as error:
        raise StoreError(f"{where}: {error}") from error


@contextmanager
def explained(engine: Engine, what: str) -> Iterator[None]:
    """Turn what the database says, but for a clash of keys, into a StoreError that says what failed and where."""
    try:
        yield
    except IntegrityError:
        raise
    except SQLAlchemyError as error:
        if isinstance(getattr(error, "orig", None), StoreError):
            raise error.orig from error  # type: ignore[attr-defined]  # a StatementError around what a column's type said
        remedy = "make its tables with `kouros init`, and see that it can be reached and written"
        raise StoreError(
            f"{what}: {where_is(engine)} says {getattr(error, 'orig', None) or error}; {remedy}"
        ) from error


def where_is(engine: Engine) -> str:
    """Return the database in words, without its password."""
    return f"the database {engine.url.render_as_string(hide_password=True)}"


NEWEST = "4a3daa34"
"""Dictionary that is written with."""

_FOLDER = Path(__file__).with_name("dictionaries")

_LEVEL = 4
"""Of compression: 5 and 6 take a quarter and half as long again for 2 and 3 % less, of 11 kB each."""

_NAMED = 0x20
"""Bit of the second byte of what zlib wrote with a dictionary; its checksum follows (RFC 1950, 2.2)."""


def deflated(content: bytes) -> bytes:
    """Compress a result."""
    packer = _packer().copy()
    return packer.compress(content) + packer.flush()


def inflated(content: bytes) -> bytes:
    """Return what `deflated` compressed.

    Raises
    ------
    zlib.error
        Where it is damaged, or was compressed with a dictionary that this version does not have.
    """
    named = len(content) > 6 and content[1] & _NAMED
    unpacker = zlib.decompressobj(zdict=_dictionary(content[2:6].hex())) if named else zlib.decompressobj()
    found = unpacker.decompress(content) + unpacker.flush()
    if not unpacker.eof or unpacker.unused_data:
        raise zlib.error("it does not end where it should")
    return found


def joined(text: str) -> bytes:
    """Return the dictionary of a file: its lines, one behind the other."""
    return text.replace("\n", "").encode()


@cache
def _dictionary(name: str) -> bytes:
    try:
        return joined(_FOLDER.joinpath(f"{name}.txt").read_text(encoding="utf-8"))
    except FileNotFoundError as problem:
        raise zlib.error(f"there is no dictionary {name}: a newer Kouros wrote it") from problem


@cache
def _packer() -> "zlib._Compress":
    # Copied for each result: to read the dictionary takes longer than to compress one.
    return zlib.compressobj(_LEVEL, zdict=_dictionary(NEWEST))
