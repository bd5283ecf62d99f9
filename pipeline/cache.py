"""The cache: results kept in files between nights, each under a key of what it depends on, sealed by a checksum.

A file is ``KIND/VERSION-KEY.kept``: a mark, the seal (BLAKE2b over all that follows), the length of a header, the
header (JSON: kind, key, code version, what was said, names, types and shapes of the arrays), the bytes of the arrays.
Nothing in it is ever run or unpickled.  What is damaged, or is not what its name says, is told by a `CacheWarning`,
removed, and counts as not there, so that it is made again.
"""

import hashlib
import json
import os
import re
import struct
import time
import warnings
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pipeline.resources import code_version, replacing

MOTIONS, CHARTS, PICTURES, HISTORIES, SPECTRA = "motions", "charts", "pictures", "histories", "spectra"
SELF_TESTS, TRADEOFFS, HOUSE, THUMBNAILS, STOCKS = "selftests", "tradeoffs", "house", "thumbnails", "stocks"
SAMPLES = "samples"
KINDS = (MOTIONS, CHARTS, PICTURES, HISTORIES, SPECTRA, SELF_TESTS, TRADEOFFS, HOUSE, THUMBNAILS, STOCKS, SAMPLES)
"""What is kept: each kind is a folder."""

LARGEST = 1 << 28
"""Bytes of a file at most: what is larger is not kept, and not read."""

DAY = 86_400.0
"""Seconds."""

_MARK = b"kouros kept 1\n"
_SEAL = 32
_LENGTH = struct.Struct("<Q")

_SUFFIX = ".kept"
_VERSION = 12
_GROUP = 16
"""Letters of the code version, and of a group, in the name of a file."""

_LASTING = "lasting"
"""What stands for the version in the name of what is kept whatever code comes after it."""

_KEY = re.compile(r"(?:(?P<group>[0-9a-z]{1,16})-)?[0-9a-z]{1,64}")

_NAME = re.compile(rf"(?P<version>[0-9a-f]{{{_VERSION}}}|{_LASTING})-(?P<key>{_KEY.pattern}){re.escape(_SUFFIX)}")

_File = tuple[os.DirEntry[str], re.Match[str]]
"""A file of the cache, and what its name says."""

_FORMER = re.compile(r"[0-9a-f-]{32,}\.npz")
"""Names of files that versions of Kouros before this cache kept."""

_UNREADABLE = (ValueError, KeyError, TypeError, IndexError, OverflowError, MemoryError, RecursionError, struct.error)
"""What is raised by bytes that nobody wrote on purpose."""


class CacheWarning(UserWarning):
    """A kept file could not be used; what was in it is made again."""


class Damage(NamedTuple):
    """A file of the cache that is not what was written, and why."""

    file: Path
    why: str


@dataclass(frozen=True)
class CacheEntry:
    """What is kept under a key.

    Attributes
    ----------
    said : dict
        What JSON can hold.
    arrays : dict of str to ndarray
        Numbers and truth values, of any shape.
    """

    said: Mapping[str, Any] = field(default_factory=dict)
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)


def key_of(*parts: object, group: str = "") -> str:
    """Return the key of a result: a digest of everything that it depends on besides the code.

    Parameters
    ----------
    *parts : object
        What JSON can hold; floats count by all their digits.
    group : str, optional
        Such as a motion's hash: what is of one group counts as used when any of it is, see `Cache.prune`.

    Returns
    -------
    str
        A key for `Cache.get` and `Cache.put`.
    """
    digest = hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:32]
    return f"{group[:_GROUP]}-{digest}" if group else digest


class Cache:
    """Results in a folder, by kind and key.

    Parameters
    ----------
    folder : Path
        It is made when something is put; that it cannot be written or read costs time and nothing else.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def get(self, kind: str, key: str, *, lasting: bool = False) -> CacheEntry | None:
        """Return what was put under a key by this very code, bit for bit, and note that it was used.

        Parameters
        ----------
        kind : str
            One of `KINDS`.
        key : str
            As `key_of` makes it.
        lasting : bool, optional
            Whatever code it was put by: what was measured, and says itself of what.

        Returns
        -------
        Kept or None
            Its arrays are the caller's own.  None where nothing is kept, or nothing that can be believed.

        Warns
        -----
        CacheWarning
            The file is damaged or foreign, and was removed; or it cannot be read.
        """
        file = self._file(kind, key, lasting)
        try:
            kept, version = _read(file)
            if not lasting and version != code_version():
                raise ValueError("it is of other code under this name")
        except FileNotFoundError:
            return None
        except OSError as problem:
            _warn(file, problem)
            return None
        except _UNREADABLE as problem:
            _remove(file)
            _warn(file, problem)
            return None
        with suppress(OSError):
            os.utime(file)
        return kept

    def put(self, kind: str, key: str, kept: CacheEntry, *, lasting: bool = False) -> None:
        """Keep a result under a key, atomically, in place of what was there.

        Parameters
        ----------
        kind, key, lasting
            As in `get`.
        kept : Kept
            Of at most `LARGEST` bytes, or it is not kept.

        Raises
        ------
        ValueError
            The key cannot be a file's name, or an array holds objects of Python.
        """
        file = self._file(kind, key, lasting)
        arrays = {name: np.asarray(values) for name, values in kept.arrays.items()}
        if any(values.dtype.hasobject for values in arrays.values()):
            raise ValueError("objects of Python are never kept")
        said = {
            "kind": kind,
            "key": key,
            "lasting": lasting,
            "code": code_version(),
            "said": dict(kept.said),
            "arrays": [[name, values.dtype.str, values.shape] for name, values in arrays.items()],
        }
        header = json.dumps(said).encode()
        body = b"".join([_LENGTH.pack(len(header)), header, *(values.tobytes() for values in arrays.values())])
        if len(body) > LARGEST - len(_MARK) - _SEAL:
            return
        with suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True)
            with replacing(file) as aside, aside.open("wb") as stream:
                stream.writelines((_MARK, _seal(body), body))

    def has(self, kind: str, key: str, *, lasting: bool = False) -> bool:
        """Say whether something is kept under a key, and note that it was used; it is not read, nor believed.

        Parameters
        ----------
        kind, key, lasting
            As in `get`.

        Returns
        -------
        bool
        """
        file = self._file(kind, key, lasting)
        with suppress(OSError):
            os.utime(file)
            return True
        return False

    def keep_only(self, kind: str, keys: Collection[str]) -> None:
        """Remove what is lasting of a kind but for some keys; `prune` never does.

        Parameters
        ----------
        kind : str
            One of `KINDS`.
        keys : collection of str
            Of what stays.
        """
        for file, name in self._files(kind):
            if name["version"] == _LASTING and name["key"] not in keys:
                _remove(Path(file.path))

    def prune(self, *, days: float = 30.0, most_bytes: int = 200_000_000, using: Collection[str] = ()) -> None:
        """Remove what other code kept, then what was not used for some days, then what was used longest ago.

        What is lasting stays, as do files of other names and what cannot be removed.

        Parameters
        ----------
        days : float, optional
            Since the last use of anything of the same group; of what has no group, of itself.
        most_bytes : int, optional
            Of each kind.
        using : collection of str, optional
            Groups in use now, whether or not anything of them was asked for: they count as used now.
        """
        for former in (*self.folder.glob("*.npz"), *self.folder.glob("*/*.npz")):
            if _FORMER.fullmatch(former.name):
                _remove(former)
        groups = {group[:_GROUP] for group in using}
        for kind in KINDS:
            _prune(self._files(kind), days * DAY, most_bytes, groups)

    def verify(self) -> Iterator[Damage]:
        """Read every file, whatever code it is of, and yield those that are damaged or foreign; none is removed.

        Yields
        ------
        Damage
        """
        for kind in KINDS:
            for entry, _ in self._files(kind):
                file = Path(entry.path)
                try:
                    _read(file)
                except FileNotFoundError:
                    continue  # Another process removed it meanwhile.
                except (OSError, *_UNREADABLE) as problem:
                    yield Damage(file, _why(problem))

    def _file(self, kind: str, key: str, lasting: bool) -> Path:
        if kind not in KINDS or not _KEY.fullmatch(key):
            raise ValueError(f"{kind!r}, {key!r}: not what a file can be called after")
        return self.folder / kind / f"{_LASTING if lasting else code_version()[:_VERSION]}-{key}{_SUFFIX}"

    def _files(self, kind: str) -> list[_File]:
        # There are thousands: a path of each, and asking each by it, takes three times as long.
        with suppress(OSError), os.scandir(self.folder / kind) as found:
            each = sorted(found, key=lambda file: file.name)
            return [(file, match) for file in each if (match := _NAME.fullmatch(file.name)) is not None]
        return []


def _prune(files: Collection[_File], seconds: float, most_bytes: int, using: set[str]) -> None:
    now, version = time.time(), code_version()[:_VERSION]
    found: list[tuple[float, os.DirEntry[str], int, str]] = []
    last: dict[str, float] = {}
    for file, name in files:
        if name["version"] == _LASTING:
            continue
        if name["version"] != version:
            _remove(Path(file.path))
            continue
        group = name["group"] or name["key"]
        with suppress(OSError):
            if group in using:
                os.utime(file.path, (now, now))
            facts = file.stat()
            found.append((facts.st_mtime, file, facts.st_size, group))
            last[group] = max(last.get(group, facts.st_mtime), facts.st_mtime)
    total = 0
    for _, file, size, group in sorted(found, key=lambda one: (-one[0], one[1].name)):
        if now - last[group] > seconds or total + size > most_bytes:
            _remove(Path(file.path))
        else:
            total += size


def _read(file: Path) -> tuple[CacheEntry, str]:
    """Return what is in a file, and the code version that put it there; else raise OSError or one of _UNREADABLE."""
    with file.open("rb") as stream:
        size = os.fstat(stream.fileno()).st_size
        if size > LARGEST:
            raise ValueError("it is too large")
        data = stream.read(size)
    body = memoryview(data)[len(_MARK) + _SEAL :]
    if not data.startswith(_MARK):
        raise ValueError("it is no file of the cache")
    if data[len(_MARK) : len(_MARK) + _SEAL] != _seal(body):
        raise ValueError("its contents are not what was written")
    (length,) = _LENGTH.unpack_from(body)
    at = _LENGTH.size + length
    header = json.loads(bytes(body[_LENGTH.size : at]))
    version = _LASTING if header["lasting"] else header["code"][:_VERSION]
    if (file.parent.name, file.name) != (header["kind"], f"{version}-{header['key']}{_SUFFIX}"):
        raise ValueError("it is another under this name")
    arrays = {}
    for name, kind, shape in header["arrays"]:
        dtype = np.dtype(kind)
        count = int(np.prod(shape, dtype=np.int64))
        # A copy of its own: aligned, and to be written to.
        arrays[name] = np.frombuffer(body, dtype, count, at).reshape(shape).copy() if count else np.empty(shape, dtype)
        at += count * dtype.itemsize
    return CacheEntry(header["said"], arrays), header["code"]


def _seal(body: bytes | memoryview) -> bytes:
    return hashlib.blake2b(body, digest_size=_SEAL).digest()


def _why(problem: BaseException) -> str:
    return str(getattr(problem, "strerror", None) or problem or type(problem).__name__)


def _warn(file: Path, problem: BaseException) -> None:
    warnings.warn(f"{file}: cannot be used ({_why(problem)}); it is made again", CacheWarning, stacklevel=4)


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink()
