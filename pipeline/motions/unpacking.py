"""Packed files, unpacked within bounds: gzip, ZIP and tar, also in each other, as agencies send their records."""

from __future__ import annotations

import gzip
import tarfile
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Protocol

from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.safe_names import safe_name

LARGEST_UNPACKED = 1 << 30
"""Bytes that the packed files of one call may hold together; a hundred records of three components have a tenth."""

MOST_UNPACKED = 20_000
"""Files that they may hold together."""

_DEEPEST = 3
"""Packed in each other: a ZIP of tar files of gzip'd records."""

_STEP = 1 << 20
_TAR = slice(257, 262)


class _Bytes(Protocol):
    """What gives bytes."""

    def read(self, size: int, /) -> bytes: ...


@dataclass(frozen=True, slots=True)
class UnpackedFile:
    """A file that was packed, or one as it was.

    Attributes
    ----------
    path : Path
        Where its bytes lie.
    shown : Path
        What a person calls it: its own name beside the packed one, or below that for an archive.
    """

    path: Path
    shown: Path


@dataclass(slots=True)
class Unpacking:
    """Files being unpacked, which share their bounds.

    Attributes
    ----------
    scratch : Path
        An empty folder.
    size, count : int
        Bytes and files so far.
    """

    scratch: Path
    size: int = 0
    count: int = 0
    _places: dict[tuple[Path, int], Path] = field(default_factory=dict)

    def files_of(self, file: Path) -> list[UnpackedFile]:
        """Return what a file holds: itself where it is not packed.

        Parameters
        ----------
        file : Path
            Any file.

        Returns
        -------
        list of UnpackedFile
            In the order of the archive, without links, folders and hidden files.

        Raises
        ------
        MotionError
            Naming a file that is damaged, encrypted, or holds more than is unpacked.
        """
        return self._files_of(UnpackedFile(file, file), file, 0)

    def _files_of(self, one: UnpackedFile, outer: Path, depth: int) -> list[UnpackedFile]:
        kind = _kind(one.path, one.shown)
        if not kind:
            return [one]
        if depth == _DEEPEST:
            raise refusal(outer, "file", f"is packed more than {_DEEPEST} times", "unpack it, and name the folder")
        try:
            held = [self._kept(outer, shown, stream, depth) for shown, stream in _members(kind, one)]
        except MotionError:  # which is a ValueError as well
            raise
        # What the libraries raise for a damaged or an encrypted archive, and for one packed in a way they do not know.
        except (OSError, EOFError, zlib.error, zipfile.BadZipFile, tarfile.TarError, RuntimeError, ValueError) as error:
            wrong = f"cannot be unpacked ({kind}: {str(error)[:200]})"
            raise refusal(outer, "file", wrong, "fetch it again, or unpack it and name the folder") from error
        return [below for each in held for below in self._files_of(each, outer, depth + 1)]

    def _kept(self, outer: Path, shown: Path, stream: _Bytes, depth: int) -> UnpackedFile:
        place = self._places.get((shown.parent, depth))
        if place is None:
            place = self._places[shown.parent, depth] = Path(tempfile.mkdtemp(dir=self.scratch))
        path = place / safe_name(shown.name)
        if path.exists():
            raise refusal(outer, "file", f"holds two files {shown.name[:80]!r}", "unpack it, and name the folder")
        self.count += 1
        with path.open("wb") as out:
            chunk = stream.read(_STEP)
            while self.size + len(chunk) <= LARGEST_UNPACKED and self.count <= MOST_UNPACKED:
                if not chunk:
                    return UnpackedFile(path, shown)
                self.size += out.write(chunk)
                chunk = stream.read(_STEP)
        wrong = f"holds more than {LARGEST_UNPACKED:,} bytes or {MOST_UNPACKED:,} files, with those before it"
        raise refusal(outer, "file", wrong, "unpack it, and name the files of the records")


def _kind(path: Path, shown: Path) -> str:
    """What packed a file, "" where nothing did; a ZIP is only what is called so, because workbooks are ZIP inside."""
    with path.open("rb") as stream:
        start = stream.read(512)
    if start.startswith(b"\x1f\x8b"):
        return "gzip"
    if start.startswith(b"PK\x03\x04") and shown.suffix.lower() == ".zip":
        return "ZIP"
    return "tar" if start[_TAR] == b"ustar" else ""


def _members(kind: str, one: UnpackedFile) -> Iterator[tuple[Path, _Bytes]]:
    """The files of an archive, one at a time: what each is called, and its bytes."""
    if kind == "gzip":
        bare = one.shown.with_suffix("") if one.shown.suffix.lower() in {".gz", ".gzip", ".tgz"} else one.shown
        with gzip.open(one.path) as packed:
            yield bare, packed
    elif kind == "ZIP":
        with zipfile.ZipFile(one.path) as archive:
            for entry in archive.infolist():
                if not entry.is_dir() and (shown := _shown(one.shown, entry.filename)):
                    with archive.open(entry) as held:
                        yield shown, held
    else:
        with tarfile.open(one.path, "r:") as archive:
            for number, member in enumerate(archive):
                if number > 2 * MOST_UNPACKED:
                    raise tarfile.TarError("more entries than are looked at")
                stream = archive.extractfile(member) if member.isreg() else None
                if stream is not None and (shown := _shown(one.shown, member.name)):
                    with closing(stream):
                        yield shown, stream


def _shown(archive: Path, name: str) -> Path | None:
    """What a member is called; nothing is ever written there, so that its name can lead nowhere."""
    parts = [part for part in PurePosixPath(name.replace("\\", "/")).parts if part not in {"/", "..", "."}]
    hidden = not parts or any(part.startswith(".") or part == "__MACOSX" for part in parts)
    return None if hidden else archive.joinpath(*parts)
