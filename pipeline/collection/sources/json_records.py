"""The values of JSON files, one by one: an array, one value a line, one alone, or the files of a folder."""

from __future__ import annotations

import codecs
import json
import re
from abc import abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path
from typing import Any, BinaryIO, ClassVar

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Opened, Request
from pipeline.collection.sources.delimited import RECORD_LIMIT
from pipeline.collection.sources.folders import Folder, files_in, line_of
from pipeline.collection.sources.rows import Row, TypedNumber

FILES = ("*.json", "*.jsonld", "*.jsonl", "*.ndjson")
"""What counts in a folder."""

Values = Callable[[], Iterator[tuple[int, Any]]]
"""Gives the lines and values of a source from its beginning, as often as it is asked."""

_BLOCK = 1 << 16


def _all_said(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return an object in which a name that stands twice has a list of what both say, so that neither is lost."""
    out: dict[str, Any] = {}
    for name, value in pairs:
        out[name] = [out[name], value] if name in out else value
    return out


_EXACT = json.JSONDecoder(parse_float=TypedNumber, parse_int=str, parse_constant=str, object_pairs_hook=_all_said)
_SPACE = re.compile(r"[\s\ufeff]*")


def read_values(stream: BinaryIO, file: str, *, exact: bool = False) -> Iterator[tuple[int, Any]]:
    """Yield the values of a file with the line where each begins; those of an array, or of several one by one.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning, as UTF-8.
    file : str
        Its name in messages.
    exact : bool
        Whether numbers are texts with the characters that they have in the file: 1913.20 stays 1913.20.

    Yields
    ------
    (int, object)
        The line, from 1, and the value.

    Raises
    ------
    CollectionError
        For what is no JSON, a value beyond RECORD_LIMIT characters, or one that is nested too deeply.
    """
    reader = _Reader(stream, file, exact=exact)
    reader.skip()
    if reader.at_end():
        raise CollectionError(f"{file}: empty; export it again")
    array = reader.take("[")
    while True:
        reader.skip()
        if reader.at_end() and not array:
            return
        if array and reader.take("]"):
            reader.skip()
            if not reader.at_end():
                raise CollectionError(
                    f"{file}, line {reader.line}: something stands behind the end of the list, and would be left out "
                    "unsaid; put each list into a file of its own, or write one record a line"
                )
            return
        yield reader.line, reader.value()
        reader.skip()
        reader.take(",")


def files_of(folder: Path, *, deep: bool = False) -> list[Path]:
    """Return the JSON files of a folder: see `folders.files_in`."""
    return files_in(folder, FILES, deep=deep)


class JsonSource(FileSource):
    """A JSON file, or a folder of such files: who extends it writes ``records``."""

    exact: ClassVar[bool] = False
    """Whether numbers keep their characters."""
    deep: ClassVar[bool] = False
    """Whether the folders of a folder are read."""

    patterns: ClassVar[tuple[str, ...]] = FILES
    """Names of the files that count in a folder."""

    def values_of(self, binary: BinaryIO, file: str) -> Iterator[tuple[int, Any]]:
        """Yield the lines and values of a file.

        Parameters
        ----------
        binary : binary stream
            The file, at its beginning.
        file : str
            Its name in messages.
        """
        return read_values(binary, file, exact=self.exact)

    @abstractmethod
    def records(self, values: Values, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the rows.

        Parameters
        ----------
        values : callable
            Gives the lines and values.
        file : str
            The name of the source, for messages.
        request : Request
            What is asked for.
        """

    @contextmanager
    def open(self, request: Request) -> Iterator[Opened]:
        """Open the file, or all files of the folder in the order of their names."""
        path = Path(request.where)
        if not path.is_dir():
            with super().open(request) as opened:
                yield opened
            return
        folder = Folder(path, self.patterns, request.limits.bytes, deep=self.deep)

        def values() -> Iterator[tuple[int, Any]]:
            for name, binary in folder.each():
                for number, value in self.values_of(binary, name):
                    yield line_of(name, number), value

        yield Opened(path.name, self.records(values, path.name, request), folder.digest)

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the objects.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.
        """

        def values() -> Iterator[tuple[int, Any]]:
            binary.seek(0)
            return self.values_of(binary, file)

        return self.records(values, file, request)


class _Reader:
    def __init__(self, stream: BinaryIO, file: str, *, exact: bool) -> None:
        self._stream = stream
        self._file = file
        self._decoder = codecs.getincrementaldecoder("utf-8")()
        self._json = _EXACT if exact else json.JSONDecoder()
        self._text = ""
        self._at = 0
        self._ended = False
        self.line = 1

    def _more(self, least: int) -> None:
        try:
            block = self._stream.read(least)
            self._text = self._text[self._at :] + self._decoder.decode(block, final=not block)
        except UnicodeDecodeError as problem:
            raise CollectionError(
                f"{self._file}, near line {self.line}: not UTF-8: {problem.reason}; save it as UTF-8"
            ) from problem
        except OSError as problem:
            raise CollectionError(
                f"{self._file}, near line {self.line}: reading stopped: {problem.strerror or problem}; see whether the "
                "disk or the network share is there and import again"
            ) from problem
        self._at = 0
        self._ended = not block

    def _pass(self, to: int) -> None:
        self.line += self._text.count("\n", self._at, to)
        self._at = to

    def at_end(self) -> bool:
        return self._ended and self._at >= len(self._text)

    def skip(self) -> None:
        """Pass over white space."""
        while True:
            space = _SPACE.match(self._text, self._at)
            self._pass(space.end() if space else self._at)
            if self._at < len(self._text) or self._ended:
                return
            self._more(_BLOCK)

    def take(self, sign: str) -> bool:
        """Pass over a sign, if it is the next one."""
        if not self._text.startswith(sign, self._at):
            return False
        self._pass(self._at + 1)
        return True

    def value(self) -> Any:
        """Return the next value, of which more is read until it is whole."""
        while True:
            try:
                value, end = self._json.raw_decode(self._text, self._at)
                # A number may go on in what was not read yet.
                if end < len(self._text) or self._ended:
                    self._pass(end)
                    return value
            except json.JSONDecodeError as problem:
                if self._ended:
                    line = self.line + self._text.count("\n", self._at, problem.pos)
                    raise CollectionError(
                        f"{self._file}, line {line}: not JSON: {problem.msg}; export the file again, and see whether "
                        "it was cut off on its way"
                    ) from problem
            except RecursionError as problem:
                raise CollectionError(
                    f"{self._file}, line {self.line}: nested too deeply to be a record; see whether this is the right "
                    "file"
                ) from problem
            known = len(self._text) - self._at
            if known > RECORD_LIMIT:
                raise CollectionError(
                    f"{self._file}, line {self.line}: {RECORD_LIMIT:,} characters without a whole value; see whether "
                    "this is the right file, or write one record a line"
                )
            # Each time as much again, so that no character is decoded often.
            self._more(max(_BLOCK, known))
