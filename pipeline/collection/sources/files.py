"""Files of a source, and what is said where one cannot be read."""

from __future__ import annotations

import gzip
import zlib
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO

from pipeline.collection.errors import CollectionError

GZIP = b"\x1f\x8b"
"""How a file begins that was packed by gzip, whatever its name is."""

RATIO_LIMIT = 200
"""Bytes unpacked for one byte packed, of more than RATIO_FROM bytes: tables of objects reach about 50."""

RATIO_FROM = 16 << 20

_PIECE = 1 << 20


def stream_of(source: str | Path | BinaryIO, file: str, stack: ExitStack) -> BinaryIO:
    """Return a stream of a source's bytes.

    Parameters
    ----------
    source : str, Path or binary stream
        A stream comes back as it is; a file is opened.
    file : str
        Its name in messages.
    stack : ExitStack
        With which an opened file is closed.

    Returns
    -------
    binary stream
        At the file's beginning, or where it was.

    Raises
    ------
    CollectionError
        For a file that cannot be opened.
    """
    if not isinstance(source, str | Path):
        return source
    try:
        return stack.enter_context(Path(source).open("rb"))
    except OSError as problem:
        raise unreadable(file, problem) from problem


def unreadable(file: str | Path, problem: OSError) -> CollectionError:
    """Return the error of a file that cannot be read, with the remedy.

    Parameters
    ----------
    file : str or Path
        Its name in messages.
    problem : OSError
        Why.

    Returns
    -------
    CollectionError
    """
    return CollectionError(
        f"{file}: cannot be read: {problem.strerror or problem}; see whether the path is right, the share is "
        "mounted and Kouros may read it"
    )


def head_of(path: Path, most: int) -> bytes:
    """Return how a file begins, unpacked where it was packed by gzip.

    Parameters
    ----------
    path : Path
        The file.
    most : int
        Bytes that are wanted.

    Returns
    -------
    bytes
        Fewer where the file, or what of it can be unpacked, is shorter.

    Raises
    ------
    OSError
        For a file that cannot be read.
    """
    with path.open("rb") as stream:
        head = stream.read(most)
    # Damage is told by who reads the whole.
    return zlib.decompressobj(wbits=31).decompress(head, most) if _packed(head) else head


def unpacked(binary: BinaryIO, file: str, most: int) -> BinaryIO:
    """Return a file as it is, or where it was packed by gzip what it holds, in a temporary file that goes with it.

    Parameters
    ----------
    binary : binary stream
        At the file's beginning.
    file : str
        Its name in messages.
    most : int
        Bytes that it may hold.

    Returns
    -------
    binary stream
        At its beginning.

    Raises
    ------
    CollectionError
        For a file that is damaged or cut off, holds more, or packs so much into so little that it is no table.
    """
    head = binary.read(4)
    binary.seek(0)
    if not _packed(head):
        return binary
    packed = binary.seek(0, 2)
    binary.seek(0)
    limit = min(most, max(RATIO_FROM, RATIO_LIMIT * packed))
    out = TemporaryFile()  # noqa: SIM115 - lent to the caller
    try:
        with gzip.GzipFile(fileobj=binary) as stream:
            while piece := stream.read(_PIECE):
                out.write(piece)
                if out.tell() > limit:
                    raise CollectionError(_too_much(file, packed, limit, most))
    except (EOFError, zlib.error, gzip.BadGzipFile) as problem:
        out.close()
        raise CollectionError(
            f"{file}: packed by gzip, and damaged or cut off ({problem}); export or download it again, or unpack it "
            "and name what comes of it"
        ) from problem
    except BaseException:
        out.close()
        raise
    out.seek(0)
    return out


def _packed(head: bytes) -> bool:
    # The third byte is the method, of which there is one.
    return head.startswith(GZIP + b"\x08")


def _too_much(file: str, packed: int, limit: int, most: int) -> str:
    if limit == most:
        return (
            f"{file}: unpacked more than {most:,} bytes; export fewer columns or objects, or raise [limits] megabytes"
        )
    return (
        f"{file}: its {packed:,} bytes unpack to more than {limit:,}, as no table of objects does; unpack it yourself, "
        "see what it holds, and name that"
    )
