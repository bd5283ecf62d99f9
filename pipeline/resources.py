"""Where the files that travel with Kouros are, in a checkout and in a wheel alike, and how files are read and written.

A file or folder that is being written has a name of its own until it is whole (`aside_of`), and what a process that
died left under such a name is removed later (`sweep`).
"""

import errno
import hashlib
import os
import re
import shutil
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import RLock, get_ident
from typing import Any

import numpy as np

from pipeline.extensions import extension_versions

SMALL = 8 << 20
"""Bytes of a file that a person writes: settings, a mapping, a manifest."""

_PACKAGE = Path(__file__).resolve().parent


def digest_of(*parts: str, kinds: Iterable[str] = (".py",), but: Iterable[str] = ()) -> str:
    """Return the SHA-256 of files of the package, names included: what is kept depends on the code that made it.

    What other packages have installed as parts of Kouros is such code too, whichever files are asked for.

    parts : files, and folders with all below them; none: the whole package
    kinds : endings of the files in folders that count
    but   : folders at the top of the package that are left out
    """
    found = {file for part in parts or ("",) for file in (_PACKAGE / part, *(_PACKAGE / part).rglob("*"))}
    left_out = set(but)
    digest = hashlib.sha256()
    for file in sorted(found):
        name = file.relative_to(_PACKAGE)
        if file.suffix in kinds and file.is_file() and name.parts[0] not in left_out:
            digest.update(name.as_posix().encode() + b"\0" + file.read_bytes())
    digest.update("".join(map(repr, extension_versions())).encode())
    return digest.hexdigest()


_BEGAN = time.time()

_ASIDE = re.compile(r"\..+\.(?P<pid>\d{1,9})-\d+\.kouros\.partial")

_STALE = 2 * 86_400.0
"""Seconds after which nobody is writing any more, whoever has the number of the process that was: two days."""


def aside_of(path: Path) -> Path:
    """Return the name under which a thread writes a file or a folder before it gives it its own name."""
    return path.with_name(f".{path.name}.{os.getpid()}-{get_ident()}.kouros.partial")


@contextmanager
def replacing(file: Path) -> Iterator[Path]:
    """Yield the path of a file to be written; it takes the place of another when it is whole, and is else removed."""
    aside = aside_of(file)
    try:
        with naming(file):
            yield aside
            aside.replace(file)
    except BaseException:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
        raise


@contextmanager
def naming(file: Path) -> Iterator[None]:
    """Let an OSError that names no file, as those of writing do not, name this one."""
    try:
        yield
    except OSError as problem:
        if problem.errno is not None and problem.filename is None:
            problem.filename = str(file)
        raise


def sweep(folder: Path) -> None:
    """Remove what processes that are gone left unfinished in a folder, but not in the folders below it.

    Nothing else is touched, and what cannot be removed stays.
    """
    try:
        inside = list(folder.iterdir())
    except OSError:
        return
    for left in inside:
        match = _ASIDE.fullmatch(left.name)
        if match is None or _being_written(left, int(match["pid"])):
            continue
        with suppress(OSError):
            if left.is_dir() and not left.is_symlink():
                shutil.rmtree(left)
            else:
                left.unlink()


def _being_written(path: Path, pid: int) -> bool:
    try:
        written = path.lstat().st_mtime
    except OSError:
        return False
    if pid == os.getpid():
        # Numbers are given again, in a container every night: what is older than this process is another's.
        return written >= _BEGAN
    if time.time() - written > _STALE:
        return False
    if os.name != "posix":
        return True  # There a signal, even 0, would end the process.
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        pass  # It is somebody else's, and alive.
    return True


_READING = RLock()


@contextmanager
def arrays(file: Path) -> Iterator[Any]:
    """Open a file of arrays (.npz) for one thread at a time; objects of Python in it are refused.

    numpy reads the head of an array by `ast.literal_eval`, which Python 3.11 does not bear in several threads at once:
    seldom, but it was seen, it ends in "AST constructor recursion depth mismatch".

    raises : what `numpy.load` raises
    """
    with _READING, np.load(file, allow_pickle=False) as kept:
        yield kept


def small_text(file: Path) -> str:
    """Return the text (UTF-8) of a file that a person writes.

    raises : OSError for a file that cannot be read, and for one of more than SMALL bytes; UnicodeDecodeError
    """
    with file.open("rb") as stream:
        data = stream.read(SMALL + 1)
    if len(data) > SMALL:
        raise OSError(errno.EFBIG, f"more than {SMALL:,} bytes", str(file))
    return data.decode("utf-8").replace("\r\n", "\n")


def resource(*parts: str) -> Path:
    """Return the path of a bundled file or folder, such as ``resource("templates", "gallery.html")``.

    A wheel carries ``schemas``, ``templates`` and ``site_motions`` inside the package; a checkout has them beside it.

    raises : FileNotFoundError, naming both places looked in
    """
    installed = _PACKAGE.joinpath("_resources", *parts)
    if installed.exists():
        return installed
    checkout = _PACKAGE.parent.joinpath(*parts)
    if checkout.exists():
        return checkout
    raise FileNotFoundError(f"{'/'.join(parts)} is neither in {installed} nor in {checkout}; reinstall kouros")
