"""The text of record files: read within limits, as lines that messages name by their numbers."""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from pipeline.motions.errors import MotionError

MAX_BYTES = 64_000_000
"""Largest text file that is opened; the longest records of many-channel buildings have a quarter of it."""

MAX_LINES = 5_000_000
"""Most lines; with MAX_BYTES it keeps a file made of line ends below 1 GB of memory (60 bytes a line)."""

MAX_LINE = 10_000
"""Most characters in a line, of which numbers are made at once."""

HEAD = 8192
"""Bytes that deciding on a format may read."""

NUMBER = r"-?(?:\d{1,7}\.?\d{0,6}|\.\d{1,6})"
"""A number in the text of a header, as a pattern; always one that float() takes."""

_PADDING = re.compile(rb"\A(?:[ \t]*\n)+")

Source = str | Path | IO[bytes]


class FormatError(MotionError):
    """A record file that does not hold what its format promises.

    The message names the file, the line, what is wrong or was expected, and what to do.
    """


class OtherQuantityError(FormatError):
    """A file of a velocity, a displacement or a spectrum: beside the accelerations of a record it is left out."""


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines of a record file without their ends; line numbers in messages start at 1, indices at 0.

    Attributes
    ----------
    file : str
        What messages call the file.
    lines : list of bytes
        Without line ends.
    skipped : int
        Blank lines of the file before the first of them, which messages count.
    """

    file: str
    lines: list[bytes]
    skipped: int = 0

    def __len__(self) -> int:
        return len(self.lines)

    def error(self, index: int, wrong: str, remedy: str = "fetch the file again, or mend the line") -> FormatError:
        """Return the error at a line.

        Parameters
        ----------
        index : int
            The line, from 0.
        wrong : str
            What is wrong there.
        remedy : str
            What mends it.

        Returns
        -------
        FormatError
        """
        return FormatError(f"{self.file}: line {index + 1 + self.skipped}: {wrong}; {remedy}")

    def other(self, index: int, wrong: str, remedy: str = "give the file of the acceleration") -> OtherQuantityError:
        """Return the error of a file that holds no acceleration, at the line that says so; as `error`."""
        return OtherQuantityError(f"{self.file}: line {index + 1 + self.skipped}: {wrong}; {remedy}")

    def text(self, index: int, expected: str = "a line") -> str:
        """Return a line as printable text without trailing blanks.

        Parameters
        ----------
        index : int
            The line, from 0.
        expected : str
            What the message says was expected there.

        Returns
        -------
        str
            The line.

        Raises
        ------
        FormatError
            If the file ends before it.
        """
        if index >= len(self.lines):
            raise self.error(len(self.lines), f"the file ends where {expected} was expected", "fetch the file again")
        return printable(self.lines[index])

    def match(self, index: int, pattern: re.Pattern[str], expected: str) -> re.Match[str]:
        """Return the match of a pattern anywhere in a line.

        Parameters
        ----------
        index : int
            The line, from 0.
        pattern : re.Pattern
            What is looked for.
        expected : str
            What the message says was expected there.

        Returns
        -------
        re.Match
            The first one.

        Raises
        ------
        FormatError
            That says what was expected and what is there.
        """
        text = self.text(index, expected)
        found = pattern.search(text)
        if found is None:
            raise self.error(index, f"expected {expected}, found {shown(text)}")
        return found

    def blank_until_end(self, index: int) -> bool:
        """Whether nothing but blanks, NUL bytes and end-of-file marks follows."""
        return all(not line.strip(b" \t\0\x1a") for line in self.lines[index:])


def printable(raw: bytes) -> str:
    """Return bytes of a header as text: Latin-1, control characters as blanks, no trailing blanks."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", " ", raw.decode("latin-1")).rstrip()


def shown(text: str) -> str:
    """Quote a piece of a file for a message, shortened."""
    return repr(text[:60] + ("..." if len(text) > 60 else ""))


def head(source: Source) -> str:
    """Return the first 8 kB of a source as text, "" for what cannot be read as bytes; a stream keeps its position."""
    return first_lines(source)[0]


def first_lines(source: Source) -> tuple[str, bool]:
    """Return the first 8 kB of a source as text, and whether that is all of it.

    Parameters
    ----------
    source : str, Path or binary stream
        What is looked at; a stream keeps its position.

    Returns
    -------
    (str, bool)
        The text, with one kind of line ends and so shorter than what was read; "" for what cannot be read as bytes.
    """
    try:
        if isinstance(source, (str, Path)):
            with Path(source).open("rb") as stream:
                raw = stream.read(HEAD)
        else:
            position = source.tell()
            raw = source.read(HEAD)
            source.seek(position)
    except OSError:
        return "", True
    # A text may end in NUL bytes or end-of-file marks; in front of anything else they mean that it is no text.
    if not isinstance(raw, bytes) or b"\0" in raw.rstrip(b"\0\x1a\r\n "):
        return "", True
    return _unpadded(_plain(raw)).decode("latin-1"), len(raw) < HEAD


def parted(text: str) -> list[str]:
    """Return the lines of a text of `head`: its letters may hold bytes that str.splitlines takes for line ends."""
    return text.removesuffix("\n").split("\n") if text else []


def _plain(raw: bytes) -> bytes:
    """A text without the mark that editors put before UTF-8, and with one kind of line ends."""
    return raw.removeprefix(codecs.BOM_UTF8).replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def _unpadded(raw: bytes) -> bytes:
    """The same without the blank lines that mails and editors put before the first."""
    return _PADDING.sub(b"", raw)


def open_lines(source: Source) -> Lines:
    """Read a text file with any line ends.

    Parameters
    ----------
    source : str, Path or binary stream
        The file.

    Returns
    -------
    Lines
        Its lines, without an empty last one.

    Raises
    ------
    FormatError
        For a file that is larger than MAX_BYTES, has more than MAX_LINES lines, or a line of more than MAX_LINE
        characters.
    OSError
        For a file that cannot be read.
    """
    if isinstance(source, (str, Path)):
        file = str(source)
        with Path(source).open("rb") as stream:
            raw = stream.read(MAX_BYTES + 1)
    else:
        file = str(getattr(source, "name", "stream"))
        raw = source.read(MAX_BYTES + 1)
    if len(raw) > MAX_BYTES:
        raise FormatError(f"{file}: line 1: is larger than {MAX_BYTES} bytes; split it into one file a channel")
    raw = _plain(raw)
    count = raw.count(b"\n") + 1
    if count > MAX_LINES:
        raise FormatError(f"{file}: line {MAX_LINES}: has {count} lines, more than a record; split it by channels")
    kept = _unpadded(raw)
    lines, skipped = kept.split(b"\n"), raw.count(b"\n") - kept.count(b"\n")
    long = next((i for i, line in enumerate(lines) if len(line) > MAX_LINE), None)
    if long is not None:
        wrong = f"has {len(lines[long])} characters, which no line of a record has"
        raise Lines(file, lines, skipped).error(long, wrong, "fetch the file again")
    if not lines[-1].strip(b"\0\x1a "):
        lines.pop()
    return Lines(file, lines, skipped)


def reader(traces: Callable[[Lines, bool], list[Any]]) -> Callable[..., Any]:
    """Return the reader of a format as obspy's plugins have it.

    Parameters
    ----------
    traces : callable
        Makes traces of the lines of a file, and of whether the headers alone are wanted, by `trace_headers.make_trace`,
        which tells what a header holds.  It raises FormatError, naming file and line.
    """

    def read_format(source: Source, headonly: bool = False, **_: Any) -> Any:
        """Return the traces of a file.

        Parameters
        ----------
        source : str, Path or binary stream
            The file.
        headonly : bool
            Whether the headers alone are wanted.
        **_ : Any
            What obspy hands to every reader; not used.

        Returns
        -------
        obspy.Stream
            In the unit that its format or the file itself says.

        Raises
        ------
        FormatError
            Naming file and line.
        """
        from obspy import Stream

        return Stream(traces(open_lines(source), headonly))

    return read_format


def one_after_other(lines: Lines, read: Callable[[int, int], tuple[Any, int]]) -> list[Any]:
    """Return what stands one after the other in a file, until nothing but blanks is left.

    Parameters
    ----------
    lines : Lines
        Of the file.
    read : callable
        Given the index of its first line and its number, from 1, returns one of them, and the index behind it.
    """
    found: list[Any] = []
    index = 0
    while not found or not lines.blank_until_end(index):
        one, index = read(index, len(found) + 1)
        found.append(one)
    return found


class Keys(dict[str, tuple[int, str]]):
    """What the lines 'KEY: value' of a header say: of each key the index of its line, and its value.

    Attributes
    ----------
    lines : Lines
        Of the file.
    end : int
        Index of the first line behind the header.
    """

    def __init__(self, lines: Lines) -> None:
        super().__init__()
        self.lines, self.end = lines, 0

    def add(self, index: int, key: str, value: str) -> None:
        """Take what a line says.

        Raises
        ------
        FormatError
            For a key that another line has given.
        """
        if key in self:
            raise self.lines.error(index, f"{key} is given twice")
        self[key] = index, value

    def said(self, key: str) -> tuple[int, str]:
        """Return what has to be there.

        Raises
        ------
        FormatError
            Where it is not.
        """
        if key not in self:
            raise self.lines.error(self.end, f"the header ends without {key}", "fetch the file again")
        return self[key]
