"""Rows in blocks, so that what has not changed since the last reading is not read again.

A block ends where the beginning of a row says so, so that rows more or less move no other block.  What became of the
rows of a block is kept in a file of JSON lines; a block that comes again, cell by cell the same, need only be counted.
Where a source is bytes, such as a CSV file, a block of the same bytes is not even taken apart into rows.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING, NamedTuple

from pipeline.collection.suspicion import Evidence

if TYPE_CHECKING:
    from pipeline.collection.sources.opening import Opened
    from pipeline.collection.sources.rows import Row

_ENDS = 128
"""One row in so many ends a block."""

_FIRST = 200
"""Characters of a row that say whether it ends a block; the digest of a block is of all."""

MOST = 1_024
"""Rows of a block at most."""

_CHARACTERS = 4 << 20
"""Characters of a block after which it ends, whatever its rows say."""

Noted = tuple[int, int, str, str, str, str]
"""A problem of an object: the place of its row in the block, its line below those before the block, object number,
field, message, remedy."""


class Span(NamedTuple):
    """A block as it lies in a file: its bytes and lines, and the digest of its bytes; of 0 bytes where not known."""

    size: int = 0
    lines: int = 0
    digest: str = ""


UNKNOWN = Span()


@dataclass(frozen=True, slots=True)
class Block:
    """What became of the rows of a block.

    digest   : of its rows; "" where one of them was refused: whether it is again may hang on others
    numbers  : of its objects, in the order of the rows
    noted    : the problems of its objects
    evidence : what it says about the units of the whole source
    span     : its bytes
    """

    digest: str
    numbers: tuple[str, ...]
    noted: tuple[Noted, ...]
    evidence: Evidence
    span: Span = UNKNOWN

    def line(self) -> str:
        """Return it as a line of JSON."""
        told = [self.digest, self.numbers, self.noted, self.evidence.plain(), self.span]
        return json.dumps(told, separators=(",", ":"))

    @classmethod
    def of_line(cls, line: str) -> Block:
        """Read what `line` wrote.

        raises : ValueError or TypeError for anything else
        """
        digest, numbers, noted, evidence, (size, lines, content) = json.loads(line)
        told = tuple(
            (int(at), int(below), str(number), str(of), str(what), str(how))
            for at, below, number, of, what, how in noted
        )
        if not all(0 <= one[0] < len(numbers) for one in told):
            raise ValueError("a problem of no row of its block")
        span = Span(int(size), int(lines), str(content))
        if span.size < 0 or span.lines < 0:
            raise ValueError("a block of fewer bytes than none")
        return cls(str(digest), tuple(map(str, numbers)), told, Evidence.of_plain(evidence), span)


@dataclass(frozen=True, slots=True)
class Piece:
    """Rows that lie together in a source.

    rows   : none where they were passed over
    number : of its first row;  line : how many lines lie before it
    known  : what became of these rows at an earlier reading, if that holds again
    """

    rows: tuple[Row, ...]
    digest: str
    number: int
    line: int
    span: Span
    known: Block | None = None


def cut(
    source: Opened, header: Sequence[str], before: Sequence[Block], holds: Callable[[Block], bool]
) -> Iterator[Piece]:
    """Yield the rows of a source in blocks.

    source : of which the header was read;  header : the names of the columns, on which the meaning of each cell rests
    before : the blocks of an earlier reading
    holds  : says whether what became of a block holds again for the same rows
    """
    named = _told([header], ["\0".join(header)])
    spans = source.spans
    # What lies before the first row goes with the header.
    if spans is not None:
        spans.taken()
    places = {block.digest: at for at, block in enumerate(before) if block.digest}
    # The block that is to be expected: behind the one that was there last.
    at = 0
    while True:
        expected = before[at] if at < len(before) else None
        if spans is not None and expected is not None and expected.digest and expected.span.size:
            size, lines, content = expected.span
            if _content(named, spans.peek(size)) == content and holds(expected):
                piece = Piece((), expected.digest, spans.number, spans.line, expected.span, expected)
                spans.pass_over(size, len(expected.numbers), lines)
                yield piece
                at += 1
                continue
        line = 0 if spans is None else spans.line
        rows, joined, ended = _block(source.rows)
        if not rows:
            return
        digest = _digest(rows, named, joined)
        span = UNKNOWN
        if spans is not None:
            read = spans.taken()
            # What the file ends with may go on in another one, within its last row if no line ends it.
            if ended and read.endswith(b"\n"):
                span = Span(len(read), spans.line - line, _content(named, read))
        else:
            line = rows[0].line - 1
        place = places.get(digest)
        known = None if place is None else before[place]
        if known is not None and (len(known.numbers) != len(rows) or not holds(known)):
            known = None
        at = at + 1 if place is None else place + 1
        yield Piece(tuple(rows), digest, rows[0].number, line, span, known)


def _block(rows: Iterator[Row]) -> tuple[list[Row], list[str], bool]:
    """Read the rows of one block.

    returns : the rows, the cells of each as one text, and whether the block ended before the source did
    """
    block: list[Row] = []
    joined: list[str] = []
    size = 0
    for row in rows:
        text = "\0".join(row.cells)
        block.append(row)
        joined.append(text)
        size += len(text)
        ends = zlib.crc32(text[:_FIRST].encode("utf-8", "surrogatepass")) % _ENDS == 0
        if ends or len(block) >= MOST or size >= _CHARACTERS:
            return block, joined, True
    return block, joined, False


def _content(header: bytes, content: bytes) -> str:
    return blake2b(header + content, digest_size=16).hexdigest()


def _digest(block: Sequence[Row], header: bytes, joined: Sequence[str]) -> str:
    if any(row.fault[0] or row.faults for row in block):
        return ""
    return blake2b(header + _told([row.cells for row in block], joined), digest_size=16).hexdigest()


def _told(rows: Sequence[Sequence[str]], joined: Sequence[str]) -> bytes:
    text = "\0\n".join(joined)
    if text.count("\0") != sum(map(len, rows)) - 1:
        # Where the cells end must be told: JSON does it whatever they hold.
        text = json.dumps(rows)
    return f"{text}\0\n".encode("utf-8", "surrogatepass")
