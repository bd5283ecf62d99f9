"""The manifest of a report, by which no file can change unnoticed, and the one lasting name for the newest.

``.pages.json`` is written last and sealed by a digest of its own content.  Of an earlier report only what is still as
it was written is used again; `verify_report` looks at all of it.
"""

import hashlib
import warnings
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from html import escape
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

from pydantic import ConfigDict, TypeAdapter, ValidationError

from pipeline.records import Tally
from pipeline.report.errors import ReportError, ReportWarning
from pipeline.report.files.exports import PARTS_OF_PAGE
from pipeline.report.files.walk_sheet import sheet_file
from pipeline.report.pages.views import Entry
from pipeline.resources import aside_of, replacing

MANIFEST = ".pages.json"
PARTS = "parts"
"""Folder of a report with the exports of each page."""

_REMEDY = (
    "it is made again; `kouros check --deep` names every damaged file: look after the disk, and at who writes there"
)


class FileSum(NamedTuple):
    """What a file was when it was written: its bytes, and their SHA-256."""

    size: int
    sha256: str


@dataclass(frozen=True, slots=True)
class KeptPage:
    """A page of a report: the key of all that it depends on, what the index says of it, what it adds to the totals.

    Attributes
    ----------
    images : tuple of str
        Files with pictures of its objects.
    turn : str
        What it has in its room for the pages before and behind it, see `turning`.
    """

    key: str
    entry: Entry
    tally: Tally
    images: tuple[str, ...] = ()
    turn: str = ""

    @property
    def files(self) -> tuple[str, ...]:
        """The page, its parts of the exports, its pictures, and of a gallery the sheet to walk with."""
        page = self.entry.page.file
        return page, *part_files(page), *((sheet_file(page),) if self.entry.on_display else ()), *self.images


@dataclass(frozen=True, slots=True)
class ReportManifest:
    """What a report consists of.

    Attributes
    ----------
    pages : tuple of KeptPage
        In their order.
    reading : str
        Key of all that the page and the list of what reading refused depend on, "" where there are none.
    files : mapping of str to FileSum
        Every file of the report but the manifest, by name.
    plan : str
        Key of all that the plan depends on, "" where there is none.
    """

    pages: tuple[KeptPage, ...] = ()
    reading: str = ""
    files: Mapping[str, FileSum] = field(default_factory=dict)
    plan: str = ""


class ReportDamage(NamedTuple):
    """A file of a report that is not as it was written: damaged, missing or additional."""

    file: Path
    why: str


def part_files(page: str) -> tuple[str, ...]:
    """Return the files with a page's part of each export, in the order of `PARTS_OF_PAGE`."""
    return tuple(f"{PARTS}/{page.removesuffix('.html')}.{name}" for name in PARTS_OF_PAGE)


def sum_of(file: Path) -> FileSum:
    """Return size and checksum of a file.

    Raises
    ------
    OSError
    """
    with file.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256")
        return FileSum(stream.tell(), digest.hexdigest())


@cache
def _adapter() -> TypeAdapter[ReportManifest | None]:
    # The union is what makes room for a configuration: pydantic takes none for a bare dataclass.
    return TypeAdapter(ReportManifest | None, config=ConfigDict(ser_json_inf_nan="strings"))


_SEALED = b'{"sha256":"%b","report":%b}\n'
_AT = len(_SEALED % (b"0" * 64, b"")) - 2
"""Where the content of a sealed manifest begins."""


def write_manifest(folder: Path, manifest: ReportManifest) -> None:
    """Seal the manifest of a report and write it."""
    content = _adapter().dump_json(manifest)
    (folder / MANIFEST).write_bytes(_sealed(content))


def _sealed(content: bytes) -> bytes:
    return _SEALED % (hashlib.sha256(content).hexdigest().encode(), content)


def read_manifest(folder: Path) -> ReportManifest:
    """Return the manifest of a report.

    Raises
    ------
    OSError
        Where it cannot be read.
    ValueError
        Where it is damaged, or is not understood.
    """
    whole = (folder / MANIFEST).read_bytes()
    content = whole[_AT:-2]
    if whole != _sealed(content):
        raise ValueError("is damaged: it is not what was written")
    try:
        return _adapter().validate_json(content) or ReportManifest()
    except ValidationError as error:
        raise ValueError("was written by another version of Kouros") from error


class PreviousReport:
    """An earlier report, as far as it can be used again; what is not as it was written is said, and is not there.

    folder : the report's
    pages  : the keys of its pages, in their order
    """

    def __init__(self, folder: Path, manifest: ReportManifest | None = None) -> None:
        self.folder = folder
        self.manifest = manifest or ReportManifest()
        self.pages = [page.key for page in self.manifest.pages]
        self._by_key = {page.key: page for page in self.manifest.pages}
        self._sound: dict[str, bool] = {}
        self._begun: dict[str, Future[str | None]] = {}

    @classmethod
    def read(cls, folder: Path) -> "PreviousReport":
        """Return a report; one without pages where there is none, or none that can be understood, which is said."""
        folder = folder.resolve()
        if not (folder / MANIFEST).exists():
            return cls(folder)
        try:
            found = cls(folder, read_manifest(folder))
        except (OSError, ValueError) as problem:
            _say(folder / MANIFEST, f"{problem}; nothing of this report is used again")
            return cls(folder)
        # The manifest of one report in the folder of another knows another index.
        return found if found.has("index.html") else cls(folder)

    def get(self, key: str) -> KeptPage | None:
        """Return a page, if all its files are as they were written."""
        page = self._by_key.get(key)
        return page if page is not None and self.has(*page.files) else None

    def has(self, *names: str) -> bool:
        """Say whether the report has files, all as they were written; each that was changed is said."""
        sound = [self._is_sound(name) for name in names]
        return all(sound)

    @contextmanager
    def looking(self) -> Iterator[None]:
        """Compare the files of all pages with what was written beside what is done in the block, as far as one gets.

        Of a large report that takes seconds, and far more where they have to come from the disk.
        """
        with ThreadPoolExecutor(1, thread_name_prefix="kouros-look") as pool:
            for page in self.manifest.pages:
                self._begun |= {name: pool.submit(self._damage, name) for name in page.files}
            try:
                yield
            finally:
                pool.shutdown(wait=False, cancel_futures=True)

    def look(self, keys: Iterable[str]) -> None:
        """Compare all files of some pages with what was written, on all cores, where `looking` did not come to it."""
        pages = (self._by_key[key] for key in keys if key in self._by_key)
        names = [name for page in pages for name in page.files if name not in self._sound]
        with ThreadPoolExecutor() as pool:
            for name, why in zip(names, pool.map(self._why, names), strict=True):
                self._note(name, why)

    def _is_sound(self, name: str) -> bool:
        if name not in self._sound:
            self._note(name, self._why(name))
        return self._sound[name]

    def _why(self, name: str) -> str | None:
        begun = self._begun.get(name)
        return self._damage(name) if begun is None or begun.cancel() else begun.result()

    def _damage(self, name: str) -> str | None:
        """Say what is wrong with a file, "" for nothing; None for a file that the report never had."""
        written = self.manifest.files.get(name)
        return None if written is None else _damage(self.folder / name, written)

    def _note(self, name: str, why: str | None) -> None:
        if why:
            _say(self.folder / name, why)
        self._sound[name] = why == ""


def _say(file: Path, why: str) -> None:
    warnings.warn(f"{file}: {why}; {_REMEDY}", ReportWarning, stacklevel=3)


def _damage(file: Path, written: FileSum) -> str:
    """Say what is wrong with a file, "" for nothing."""
    try:
        found = sum_of(file)
    except FileNotFoundError:
        return "is missing"
    except OSError as problem:
        return f"cannot be read ({problem.strerror})"
    if found.size != written.size:
        return f"has {found.size:,} bytes instead of {written.size:,}"
    return "" if found == written else "is damaged: its checksum is not that of what was written"


def verify_report(folder: Path) -> Iterator[ReportDamage]:
    """Compare every file of a report with what was written.

    Parameters
    ----------
    folder : Path
        The report's.

    Yields
    ------
    ReportDamage
        For every file that is damaged, missing or additional; where the manifest itself cannot be used, for it alone.
    """
    try:
        manifest = read_manifest(folder)
    except (OSError, ValueError) as problem:
        yield ReportDamage(folder / MANIFEST, str(problem))
        return
    for name, written in manifest.files.items():
        why = _damage(folder / name, written)
        if why:
            yield ReportDamage(folder / name, why)
    known = {folder / MANIFEST, *(folder / name for name in manifest.files)}
    for file in sorted(folder.rglob("*")):
        if file not in known and not file.is_dir():
            yield ReportDamage(file, "is not of this report")


LINK, PAGE = "latest", "latest.html"

_POLICY = "default-src 'none'; base-uri 'none'; form-action 'none'"


def publish(folder: Path, root: Path) -> Path:
    """Point ``root/latest`` at a whole report, atomically; earlier reports stay where they are.

    Parameters
    ----------
    folder : Path
        A rendered report inside root.
    root : Path
        The folder that holds all reports.

    Returns
    -------
    Path
        Root/latest, or root/latest.html on a file system without symbolic links.

    Raises
    ------
    FileNotFoundError
        If the folder holds no report.
    ReportError
        If it lies outside root or the name "latest" is taken by something that Kouros did not make.
    """
    folder, root = folder.resolve(), root.resolve()
    if not (folder / "index.html").is_file():
        raise FileNotFoundError(f"{folder} holds no index.html; render the report first")
    if not folder.is_relative_to(root) or folder == root:
        raise ReportError(f"{folder} is not inside {root}; render reports into a folder below it")
    link = root / LINK
    if link.exists() and not link.is_symlink():
        raise ReportError(f"{link} is not a link that Kouros made; move it away, then publish again")
    target = folder.relative_to(root)
    page = root / PAGE
    if lasting_name(root) == page:
        return _redirect(target, page)
    with replacing(link) as aside:
        aside.symlink_to(target, target_is_directory=True)
    if page.exists():
        _redirect(target, page)  # A page left by an earlier system would go on showing an old report.
    return link


def lasting_name(root: Path) -> Path:
    """Return what `publish` gives, before it is done: a report tells it, and is whole before it is shown.

    Parameters
    ----------
    root : Path
        The folder that holds all reports, which exists.

    Returns
    -------
    Path
    """
    link = root / LINK
    if link.is_symlink():
        return link
    aside = aside_of(link)
    try:
        aside.symlink_to(PAGE)
    except (OSError, NotImplementedError):
        # Windows without the privilege, and some network drives, refuse symbolic links; a page can be replaced instead.
        return root / PAGE
    aside.unlink()
    return link


def _redirect(target: Path, page: Path) -> Path:
    address = escape(quote(target.as_posix()) + "/index.html", quote=True)
    with replacing(page) as aside:
        aside.write_text(
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"/>'
            f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}"/><title>Latest report</title>'
            f'<meta http-equiv="refresh" content="0; url={address}"/></head>'
            f'<body><p><a href="{address}">The latest report</a></p></body></html>\n',
            encoding="utf-8",
        )
    return page
