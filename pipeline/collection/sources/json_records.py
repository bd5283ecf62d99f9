"""The values of a JSON file, one by one: an array, one value a line, or one alone."""

from __future__ import annotations

import codecs
import json
import re
from collections.abc import Iterator
from typing import Any, BinaryIO

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.delimited import RECORD_LIMIT

_BLOCK = 1 << 16
_SPACE = re.compile(r"[\s\ufeff]*")


def read_values(stream: BinaryIO, file: str) -> Iterator[tuple[int, Any]]:
    """Yield the values of a file with the line where each begins; those of an array, or of several one by one.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning, as UTF-8.
    file : str
        Its name in messages.

    Yields
    ------
    (int, object)
        The line, from 1, and the value.

    Raises
    ------
    CollectionError
        For what is no JSON, a value beyond RECORD_LIMIT characters, or one that is nested too deeply.
    """
    reader = _Reader(stream, file)
    reader.skip()
    if reader.at_end():
        raise CollectionError(f"{file}: empty; export it again")
    array = reader.take("[")
    while True:
        reader.skip()
        if reader.at_end() and not array:
            return
        if array and reader.take("]"):
            return
        yield reader.line, reader.value()
        reader.skip()
        reader.take(",")


class _Reader:
    def __init__(self, stream: BinaryIO, file: str) -> None:
        self._stream = stream
        self._file = file
        self._decoder = codecs.getincrementaldecoder("utf-8")()
        self._json = json.JSONDecoder()
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
