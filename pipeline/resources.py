"""The files that travel with Kouros, in a checkout and in a wheel alike: where they are, and of which version.

A file or folder that is being written has a name of its own until it is whole (`aside_of`), and what a process that
died left under such a name is removed later (`sweep`).
"""

import errno
import hashlib
import os
import re
import shutil
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from threading import get_ident

from pipeline.extensions import extension_versions

SMALL = 8 << 20
"""Bytes of a file that a person writes: settings, a mapping, a manifest."""

BUNDLED = ("demo", "demo_suite")
"""Names of the sites that come with Kouros: one record as it was, and the demonstration's suite of eleven motions."""

_PACKAGE = Path(__file__).resolve().parent


_ELSEWHERE = frozenset(
    {"cli", "desk", "event", "images", "meshes", "operations", "planning", "report", "tools", "verification"}
)
"""Rooms that no stored result depends on: they ask for results, show and compare them, or fill in records."""

_SOURCES = frozenset({".py", ".csv", ".toml"})
"""Endings of the files that are code, or tables that code reads."""

LIBRARIES = ("numba", "llvmlite", "numpy", "scipy", "obspy", "pywavelets", "openpyxl", "lxml", "pyyaml")
"""What computes results, and reads what they are computed of, besides the package and Python."""

PRINTERS = ("jinja2", "markupsafe", "babel", "pyarrow", "reportlab", "python-bidi", "arabic-reshaper", "matplotlib")
"""What draws pages and writes exports of results besides."""


def code_files() -> list[Path]:
    """Return the files of the package that results depend on: code and tables of every room that computes."""
    return [file for file in _package_files() if file.relative_to(_PACKAGE).parts[0] not in _ELSEWHERE]


def page_files() -> list[Path]:
    """Return the files that pages and exports depend on: all code and tables, and the templates."""
    return [*_package_files(), *sorted(file for file in resource("templates").rglob("*") if file.is_file())]


@cache
def code_version() -> str:
    """Return the one version of everything that computes, which every kept result depends on.

    Returns
    -------
    str
        SHA-256 in hexadecimal of the names and contents of `code_files`, and of the versions of Python and `LIBRARIES`.
    """
    return _digest(code_files(), LIBRARIES)


@cache
def page_version() -> str:
    """Return the one version of everything that computes or draws, which every page and export depends on.

    Returns
    -------
    str
        SHA-256 in hexadecimal of `page_files`, and of the versions of Python, `LIBRARIES` and `PRINTERS`.
    """
    return _digest(page_files(), (*LIBRARIES, *PRINTERS))


def _package_files() -> list[Path]:
    found = (file for file in _PACKAGE.rglob("*") if file.suffix in _SOURCES and file.is_file())
    # What a wheel carries beside the code is not the package's own.
    return sorted(file for file in found if file.relative_to(_PACKAGE).parts[0] != "_resources")


def _installed(library: str) -> str:
    from importlib.metadata import version

    return version(library)


def _digest(files: Iterable[Path], libraries: Iterable[str]) -> str:
    versions = [
        f"python {sys.version_info.major}.{sys.version_info.minor}",
        *(f"{name} {_installed(name)}" for name in libraries),
    ]
    # What other packages have installed as parts of Kouros is such code too.
    versions += map(repr, extension_versions())
    digest = hashlib.sha256("\n".join(versions).encode())
    for file in files:
        within = _PACKAGE if file.is_relative_to(_PACKAGE) else _PACKAGE.parent
        content = file.read_bytes()
        # With its length, so that no byte can pass from one file to the next.
        digest.update(f"\0{file.relative_to(within).as_posix()}\0{len(content)}\0".encode() + content)
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


def small_text(file: Path) -> str:
    """Return the text (UTF-8) of a file that a person writes.

    Raises
    ------
    OSError
        For a file that cannot be read, and for one of more than SMALL bytes.
    UnicodeDecodeError
    """
    with file.open("rb") as stream:
        data = stream.read(SMALL + 1)
    if len(data) > SMALL:
        raise OSError(errno.EFBIG, f"more than {SMALL:,} bytes", str(file))
    return data.decode("utf-8").replace("\r\n", "\n")


def resource(*parts: str) -> Path:
    """Return the path of a bundled file or folder, such as ``resource("templates", "gallery.html")``.

    A wheel carries ``schemas``, ``templates``, ``site_motions`` and the units of systemd inside the package; a checkout
    has them beside it.

    Raises
    ------
    FileNotFoundError
        Naming both places looked in.
    """
    installed = _PACKAGE.joinpath("_resources", *parts)
    if installed.exists():
        return installed
    checkout = _PACKAGE.parent.joinpath(*parts)
    if checkout.exists():
        return checkout
    raise FileNotFoundError(f"{'/'.join(parts)} is neither in {installed} nor in {checkout}; reinstall kouros")
