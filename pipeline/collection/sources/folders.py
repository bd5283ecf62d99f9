"""Folders whose files are one source: a file for each object, or several parts of an export."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.files import unreadable


class Line(int):
    """A line, with the file of a folder that it stands in."""

    file = ""


def line_of(file: str, line: int) -> Line:
    """Return a line of a file of a folder."""
    out = Line(line)
    out.file = file
    return out


def files_in(folder: Path, patterns: Sequence[str], *, deep: bool = False) -> list[Path]:
    """Return the files of a folder by name, with those of its own folders where it is read deeply.

    Parameters
    ----------
    folder : Path
        That exists.
    patterns : sequence of str
        Which names count, such as ``*.json``.
    deep : bool
        Whether its folders count; hidden ones never do.

    Returns
    -------
    list of Path

    Raises
    ------
    CollectionError
        For a folder that cannot be read.
    """
    look = folder.rglob if deep else folder.glob
    try:
        found = {path for pattern in patterns for path in look(pattern) if path.is_file()}
    except OSError as problem:
        raise unreadable(folder, problem) from problem
    return sorted(path for path in found if not any(part.startswith(".") for part in path.relative_to(folder).parts))


class Folder:
    """The files of a folder, read as one source as often as it is asked.

    Parameters
    ----------
    path : Path
        The folder.
    patterns : sequence of str
        Which names count.
    deep : bool
        Whether its folders count.
    most : int
        Bytes that all of them may have.

    Raises
    ------
    CollectionError
        For a folder without such a file, one that cannot be read, and for more bytes.
    """

    def __init__(self, path: Path, patterns: Sequence[str], most: int, *, deep: bool = False) -> None:
        self.path = path
        self.files = files_in(path, patterns, deep=deep)
        self._sums: dict[str, bytes] = {}
        if not self.files:
            raise CollectionError(f"{path}: a folder without {', '.join(patterns)}; name the museum's export itself")
        try:
            size = sum(file.stat().st_size for file in self.files)
        except OSError as problem:
            raise unreadable(path, problem) from problem
        if size > most:
            raise CollectionError(
                f"{path}: {size:,} bytes, more than {most:,}; export fewer objects, or raise [limits] megabytes"
            )

    def each(self) -> Iterator[tuple[str, BinaryIO]]:
        """Yield the name of each file and the file, at its beginning; what it held when first read counts as it."""
        for path in self.files:
            name = path.relative_to(self.path).as_posix()
            try:
                with path.open("rb") as binary:
                    if name not in self._sums:
                        self._sums[name] = hashlib.file_digest(binary, "sha256").digest()
                        binary.seek(0)
                    yield name, binary
            except OSError as problem:
                raise unreadable(name, problem) from problem

    def digest(self) -> str:
        """Return the SHA-256 of the names and contents of all files, called when they were read."""
        whole = b"".join(f"{name}\0".encode("utf-8", "surrogatepass") + one for name, one in self._sums.items())
        return hashlib.sha256(whole).hexdigest()
