"""Where the files that travel with Kouros are, in a checkout and in a wheel alike, and how files are read."""

import errno
import hashlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import RLock
from typing import Any

import numpy as np

SMALL = 8 << 20
"""Bytes of a file that a person writes: settings, a mapping, a manifest."""

_PACKAGE = Path(__file__).resolve().parent


def digest_of(*parts: str, kinds: Iterable[str] = (".py",), but: Iterable[str] = ()) -> str:
    """Return the SHA-256 of files of the package, names included: what is kept depends on the code that made it.

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
    return digest.hexdigest()


@contextmanager
def replacing(file: Path) -> Iterator[Path]:
    """Yield the path of a file to be written; it takes the place of another when it is whole, and is else removed."""
    aside = file.with_name(f".{file.name}.{os.getpid()}")
    try:
        yield aside
        aside.replace(file)
    finally:
        aside.unlink(missing_ok=True)


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
