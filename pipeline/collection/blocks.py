"""Rows in blocks, so that what has not changed since the last reading is not read again.

A block ends where the beginning of a row says so, so that rows more or less move no other block.  What became of the
rows of a block is kept in a file of JSON lines; a block that comes again, cell by cell the same, need only be counted.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING

from pipeline.collection.suspicion import Evidence

if TYPE_CHECKING:
    from pipeline.collection.sources.rows import Row

_ENDS = 128
"""One row in so many ends a block."""

_FIRST = 200
"""Characters of a row that say whether it ends a block; the digest of a block is of all."""

MOST = 1_024
"""Rows of a block at most."""

_CHARACTERS = 4 << 20
"""Characters of a block after which it ends, whatever its rows say."""

Noted = tuple[int, str, str, str, str]
"""A problem of an object: the place of its row in the block, object number, field, message, remedy."""


@dataclass(frozen=True, slots=True)
class Block:
    """What became of the rows of a block.

    digest   : of its rows; "" where one of them was refused: whether it is again may hang on others
    numbers  : of its objects, in the order of the rows
    noted    : the problems of its objects
    evidence : what it says about the units of the whole source
    """

    digest: str
    numbers: tuple[str, ...]
    noted: tuple[Noted, ...]
    evidence: Evidence

    def line(self) -> str:
        """Return it as a line of JSON."""
        return json.dumps([self.digest, self.numbers, self.noted, self.evidence.plain()], separators=(",", ":"))

    @classmethod
    def of_line(cls, line: str) -> Block:
        """Read what `line` wrote.

        raises : ValueError or TypeError for anything else
        """
        digest, numbers, noted, evidence = json.loads(line)
        told = tuple((int(at), str(number), str(of), str(what), str(how)) for at, number, of, what, how in noted)
        if not all(0 <= one[0] < len(numbers) for one in told):
            raise ValueError("a problem of no row of its block")
        return cls(str(digest), tuple(map(str, numbers)), told, Evidence.of_plain(evidence))


def cut(rows: Iterable[Row], header: Sequence[str]) -> Iterator[tuple[list[Row], str]]:
    """Yield the rows in blocks, each with its digest ("" where a row cannot be used as it stands).

    header : the names of the columns, on which the meaning of each cell rests
    """
    named = _told([header], ["\0".join(header)])
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
            yield block, _digest(block, named, joined)
            block, joined, size = [], [], 0
    if block:
        yield block, _digest(block, named, joined)


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
