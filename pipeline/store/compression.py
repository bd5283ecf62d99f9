"""Compression of results: zlib with a dictionary of texts that they share, so that each row holds what is its own.

A dictionary is a file in `dictionaries`, named by its Adler-32 checksum, which zlib writes into what it compresses:
what was compressed with an earlier one is read as long as that one's file is there, what was compressed with none
always.  A file is never changed: `python -m tests.benchmarks.dictionary` makes a new one.
"""

import zlib
from functools import cache
from pathlib import Path

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
