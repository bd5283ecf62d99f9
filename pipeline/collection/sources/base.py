"""Contract that each source of records keeps, Kouros's own and those of other packages."""

from __future__ import annotations

import hashlib
import json
import stat
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, cast

from pydantic import BaseModel, ConfigDict, Field, model_validator

from pipeline.collection.errors import CollectionError
from pipeline.collection.limits import Limits
from pipeline.collection.sources.files import unpacked, unreadable
from pipeline.collection.sources.folders import Folder, line_of
from pipeline.collection.sources.rows import Row
from pipeline.errors import InputError

Name = Annotated[str, Field(min_length=1)]

HEAD = 4096
"""Bytes of the beginning of a file by which a source may recognise it."""


class LongSide(BaseModel):
    """A column of one side of parts, in a source in long form."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    column: Name = Field(description="The column with its numbers.")
    kind: Name = Field(description="What it is, such as height.")
    unit: str = Field(default="", description="Unit of the numbers that name none.")


class LongAgain(BaseModel):
    """Further columns of measurements, in a source in long form."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    type: Name | None = Field(
        default=None, description="The column that says what was measured; left out where it is that of the first ones."
    )
    value: Name = Field(description="The column with the numbers.")
    unit: Name | None = Field(default=None, description="The column with their units.")
    part: Name | None = Field(default=None, description="The column that says of which part.")


class LongForm(BaseModel):
    """A source in long form: several rows an object, each with one of its measurements, or with one of its parts."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    object: Name = Field(description="The column with the object's number; an empty cell is of the object above.")
    type: Name | None = Field(
        default=None, description="The column that says what was measured, such as height or Breite."
    )
    value: Name | None = Field(default=None, description="The column with the numbers.")
    unit: Name | None = Field(default=None, description="The column with their units.")
    part: Name | None = Field(default=None, description="The column that says of which part, such as whole or frame.")
    again: tuple[LongAgain, ...] = Field(
        default=(),
        description="Further columns: of other measurements, where a row has several (Measurement 2 type), or of the "
        "same in other units, of which those that contradict the first ones are refused.",
    )
    separator: str = Field(
        default="",
        max_length=3,
        description="What parts several measurements in one cell, height$width beside 120$97.5, as exports of Axiell "
        'do; "" where each has a row of its own.',
    )
    sides: tuple[LongSide, ...] = Field(
        default=(), description="In place of type and value: columns of the sides of a part, where each has a row."
    )
    called: Name | None = Field(
        default=None, description="The column with the name of the object: a part that is called so is the object."
    )

    @model_validator(mode="after")
    def _either(self) -> Self:
        if bool(self.sides) == (self.type is not None or self.value is not None):
            raise InputError("[source.long] takes either type and value, or sides")
        if not self.sides and (self.type is None or self.value is None):
            raise InputError("[source.long] has only one of type and value; add the other")
        return self


class SourceSettings(BaseModel):
    """The section [source] of a mapping: what every source takes; each adds fields of its own in a subclass."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: str = Field(description="The kind of source.")
    decimal: Literal[".", ","] = Field(default=".", description="The decimal mark of numbers that stand in texts.")
    thousands: bool = Field(
        default=False,
        description="Whether thousands of numbers in cells of their own are parted by the other of comma and point.",
    )
    unmapped_columns: Literal["ignore", "refuse"] = Field(
        default="ignore", description="What to do with a column that no field is mapped to."
    )
    long: LongForm | None = Field(
        default=None,
        description="Where each measurement has a row of its own: which columns tell it. They become the columns "
        '"height", "width", "depth", "diameter", "weight" and others, "base height", "frame width", with their units '
        "as written.",
    )


@dataclass(frozen=True)
class Request:
    """What is asked of a source.

    Attributes
    ----------
    where : str
        Path of a file, or an address.
    settings : SourceSettings
        Of the source's own kind.
    columns, optional : tuple of str
        The columns that are read, and those that may be lacking; a source may give more, in any order.
    key_column : str
        The column with the object numbers: a source without an order of its own sorts by it.
    limits : Limits
        Bytes and seconds that are accepted; rows are counted by who reads them.
    texts : tuple of str
        The columns that hold texts: what looks like a number there is a name, and keeps its characters.
    """

    where: str
    settings: Any
    columns: tuple[str, ...]
    optional: tuple[str, ...]
    key_column: str
    limits: Limits
    texts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Opened:
    """A source that is open.

    Attributes
    ----------
    name : str
        For messages, without secrets.
    rows : iterator of Row
        The header first.
    digest : callable
        Returns the SHA-256 of a file's bytes, or of all rows; called when the rows are read.
    """

    name: str
    rows: Iterator[Row]
    digest: Callable[[], str]


class Source(ABC):
    """A kind of source, such as CSV files: one file of code, and one name in `sources.registry`.

    Another package offers one under the entry point group ``kouros.sources``.  The contract:

    1.  ``name`` is what a mapping says as [source] format; no other source has it.  ``title`` is the kind of source in
        words, with its article, for messages: "a workbook".
    2.  ``Settings`` is the subclass of `SourceSettings` with the source's own keys of [source]: types, limits and
        descriptions.  Kouros validates a mapping by it, and passes it on as ``request.settings``.
    3.  ``recognises`` says of a path or an address, and the first bytes of a file, whether it surely is of this kind.
        It must not claim what another kind may be as well: plain text is claimed by none.
    4.  ``open`` is a context manager that yields an `Opened`, and frees what it opened when it is left, also before the
        last row.  A kind of file extends `FileSource` and writes ``rows`` alone.
    5.  The first row is the header, number 0: the names of the columns.  All others follow in the order of the source,
        numbered from 1, with as many cells as the header; blank rows are left out.  ``line`` is where a person finds
        the row.
    6.  Cells are texts, by `rows.as_text`: the same number is the same text in every source.  Nothing is stripped,
        translated or converted; that is the mapping's.
    7.  Rows are given one by one, so that memory does not grow with the source; the same source gives the same rows.
    8.  A row or a cell that cannot be used has a fault with a remedy, see `rows.Row`, and the others go on.
    9.  ``digest`` is of all that the rows came from: two sources with one digest have the same rows.
    10. What ends the reading is a `CollectionError` that names the source without its secrets, the row that was
        reached, and the remedy.  The source is only read.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    Settings: ClassVar[type[SourceSettings]]
    is_file: ClassVar[bool] = False
    """Whether it is one file, whose bytes say whether it changed."""

    @abstractmethod
    def recognises(self, where: str, head: bytes) -> bool:
        """Say whether a source surely is of this kind.

        Parameters
        ----------
        where : str
            Path of a file, or an address.
        head : bytes
            How the file begins, HEAD bytes at least where it has them; empty for an address.
        """

    @abstractmethod
    def open(self, request: Request) -> AbstractContextManager[Opened]:
        """Open the source.

        Raises
        ------
        CollectionError
            For a source that cannot be opened; its rows raise the same while they are read.
        """


class FileSource(Source):
    """A kind of file: opening, unpacking (gzip), its limit of bytes and its digest are done; ``rows`` reads it."""

    is_file = True
    folder: ClassVar[tuple[str, ...]] = ()
    """Names of the files that count in a folder of such files, as patterns; (): no folder is one."""

    @abstractmethod
    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the rows of a file.

        Parameters
        ----------
        binary : BufferedReader
            The file, at its beginning.
        file : str
            Its name, for messages.
        request : Request
            What is asked for.
        """

    def rows_of(self, folder: Folder, request: Request) -> Iterator[Row]:
        """Yield the header and the rows of all files of a folder, whose headers are the same.

        Parameters
        ----------
        folder, request : Folder, Request
            The files, and what is asked for.

        Yields
        ------
        Row
            First the header.

        Raises
        ------
        CollectionError
            For a file with another header.
        """
        head: list[str] | None = None
        number = 0
        for name, binary in folder.each():
            rows = self.rows(cast(BufferedReader, binary), name, request)
            first = next(rows)
            if head is None:
                head = first.cells
                yield first
            elif first.cells != head:
                raise CollectionError(f"{name}: has other columns than the files before it; read it by itself")
            for row in rows:
                number += 1
                yield row._replace(number=number, line=line_of(name, row.line))

    @contextmanager
    def open(self, request: Request) -> Iterator[Opened]:
        """Open the file, or all files of the folder."""
        path = Path(request.where)
        if self.folder and path.is_dir():
            folder = Folder(path, self.folder, request.limits.bytes)
            yield Opened(path.name, self.rows_of(folder, request), folder.digest)
            return
        with ExitStack() as stack:
            packed = stack.enter_context(_open(path, request.limits.bytes))
            digest = _digest(packed, path.name)
            binary = stack.enter_context(cast(BufferedReader, unpacked(packed, path.name, request.limits.bytes)))
            yield Opened(path.name, self.rows(binary, path.name, request), lambda: digest)


def digested(name: str, rows: Iterator[Row]) -> Opened:
    """Return rows that are no file's as an open source: its digest is of all rows that were read.

    Parameters
    ----------
    name : str
        Of the source, in messages.
    rows : iterator of Row
        The header, then the rows.

    Returns
    -------
    Opened
        To be read once.
    """
    digest = hashlib.sha256()

    def told() -> Iterator[Row]:
        for row in rows:
            digest.update(json.dumps([row.cells, sorted(row.faults.items())], ensure_ascii=True).encode())
            yield row

    return Opened(name, told(), digest.hexdigest)


def _open(path: Path, most: int) -> BufferedReader:
    try:
        state = path.stat()
        if not stat.S_ISREG(state.st_mode):
            raise CollectionError(f"{path}: not a file; name the museum's export itself")
        if state.st_size > most:
            raise CollectionError(
                f"{path}: {state.st_size:,} bytes, more than {most:,}; export fewer columns or objects, "
                "or raise [limits] megabytes"
            )
        if not state.st_size:
            raise CollectionError(
                f"{path}: empty collection, a file of 0 bytes: the export has failed, or is not written yet; export "
                "it again, or run again when it is there"
            )
        return path.open("rb")
    except OSError as problem:
        raise unreadable(path, problem) from problem


def _digest(binary: BufferedReader, file: str) -> str:
    try:
        digest = hashlib.file_digest(binary, "sha256").hexdigest()
        binary.seek(0)
    except OSError as problem:
        raise CollectionError(
            f"{file}: reading stopped: {problem.strerror or problem}; see whether the disk or network share is there"
        ) from problem
    return digest
