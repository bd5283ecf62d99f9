"""Files that somebody has to be made a site of: which are records, and which say something of records."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pipeline.motions.candidates import MOST, Unusable
from pipeline.motions.catalogues import Catalogues
from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.formats.record_text import OtherQuantityError
from pipeline.motions.manifest import MANIFEST, NO_RECORDS
from pipeline.motions.parts import LARGEST
from pipeline.motions.peer_search import SearchRow, read_search
from pipeline.motions.reading import open_traces
from pipeline.motions.safe_names import one_line
from pipeline.motions.unknown import is_prose, is_workbook
from pipeline.motions.unpacking import UnpackedFile, Unpacking

_NO_ACCELERATION = {".VT2": "velocity", ".DT2": "displacement"}
"""Endings of PEER's other files."""

_BESIDE = 1000
"""Files beside those that were named in which a StationXML is looked for."""


@dataclass(eq=False)
class GatheredFiles:
    """What files hold.

    Attributes
    ----------
    paths : dict of str to Path
        Where each file is, by the name that it has in `traces`: a number for its folder, and its own.
    traces : list of (str, list of obspy.Trace)
        The records' files.
    catalogues : Catalogues
        Earthquakes and stations.
    searches : dict of str to SearchRow
        PEER's tables.
    unusable : list of Unusable
        What is no record, or cannot be read, and why.
    passed_over : list of str
        What was not looked into: words about records, and links.
    """

    paths: dict[str, Path] = field(default_factory=dict)
    traces: list[tuple[str, list[Any]]] = field(default_factory=list)
    catalogues: Catalogues = field(default_factory=Catalogues)
    searches: dict[str, SearchRow] = field(default_factory=dict)
    unusable: list[Unusable] = field(default_factory=list)
    passed_over: list[str] = field(default_factory=list)


def gather(given: Sequence[Path], leave: frozenset[Path] = frozenset(), scratch: Path | None = None) -> GatheredFiles:
    """Read files, and those of folders with what is below them.

    A StationXML that lies beside a file that was named counts as well.

    Parameters
    ----------
    given : sequence of Path
        Files and folders.
    leave : set of Path
        Resolved paths that are left out: what a site has already.
    scratch : Path or None
        An empty folder, where packed files are unpacked to and stay as long as their records are needed; None unpacks
        none, and refuses them.

    Returns
    -------
    GatheredFiles

    Raises
    ------
    MotionError
        For a path at which there is nothing.
    """
    made = GatheredFiles()
    files = _files(given, made)
    folders: dict[Path, int] = {}
    responses: set[Path] = set()
    unpacking = None if scratch is None else Unpacking(scratch)
    for file in files:
        if file.resolve() in leave:
            continue
        folders.setdefault(file.parent, len(folders))
        try:
            every = [UnpackedFile(file, file)] if unpacking is None else unpacking.files_of(file)
        except (MotionError, OSError) as problem:
            made.unusable.append(Unusable(one_line(str(file)), _why(file, problem)))
            continue
        for one in every:
            name = f"{folders.setdefault(one.shown.parent, len(folders))}/{one.path.name}"
            try:
                if not _take_other(one, made):
                    made.paths[name] = one.path
                    made.traces.append((name, open_traces(one.path, [])))
                elif one.path in made.catalogues.inventories:
                    responses.add(one.path.resolve())
            except (MotionError, OSError) as problem:
                if one.shown not in given and isinstance(problem, MotionError) and is_prose(one.path):
                    made.passed_over.append(f"{one.shown}: words")
                    made.paths.pop(name, None)
                else:
                    other = isinstance(problem, OtherQuantityError)
                    made.unusable.append(Unusable(one_line(str(one.shown)), _why(one.path, problem), chosen=other))
    for folder in folders:
        _take_responses(folder, responses, made)
    return made


def _files(given: Sequence[Path], made: GatheredFiles) -> list[Path]:
    files: dict[Path, None] = {}
    for path in given:
        if not path.exists():
            raise refusal(path, "file", "there is nothing of this name", "name the files of a record, or their folder")
        if not path.is_dir():
            files[path] = None
            continue
        found = sorted(below for below in path.rglob("*") if below.is_file())
        for one in found[:MOST]:
            inside = one.relative_to(path).parts
            if one.is_symlink() or any((path / Path(*inside[:n])).is_symlink() for n in range(1, len(inside))):
                made.passed_over.append(f"{one}: a link")
            elif not any(part.startswith(".") for part in inside) and one.name != MANIFEST:
                files[one] = None
        if len(found) > MOST:
            made.unusable.append(Unusable(str(path), f"holds {len(found):,} files, of which {MOST:,} are looked at"))
    return list(files)


def _take_other(one: UnpackedFile, made: GatheredFiles) -> bool:
    """Take in what is no record, and say whether it is none."""
    file = one.path
    if not file.is_file():
        raise refusal(file, "file", "is no file of its own", "name a file of a record")
    if made.catalogues.take(file):
        return True
    rows = read_search(file)
    if rows is not None:
        made.searches |= rows
        return True
    kind = _NO_ACCELERATION.get(file.suffix.upper())
    if kind:
        made.passed_over.append(f"{one.shown}: a {kind}; the acceleration is what is read")
    elif file.suffix.lower() in NO_RECORDS:
        made.passed_over.append(f"{one.shown}: words or pictures")
    else:
        return False
    return True


def _why(file: Path, problem: MotionError | OSError) -> str:
    if isinstance(problem, OSError):
        return f"cannot be read: {problem.strerror or problem}"
    words = str(problem).removeprefix(f"{file}: ")
    if file.stat().st_size <= LARGEST and zipfile.is_zipfile(file) and not is_workbook(file):
        return "is an archive: unpack it, and name the folder"
    return words


def _take_responses(folder: Path, known: set[Path], made: GatheredFiles) -> None:
    """Take in the StationXML files that lie in a folder, up to `_BESIDE` files of it."""
    found = sorted(path for path in folder.glob("*") if path.suffix.lower() == ".xml")
    for file in found[:_BESIDE]:
        if file.resolve() in known or file.is_symlink() or not file.is_file():
            continue
        known.add(file.resolve())
        beside = Catalogues()
        try:
            beside.take(file)
        except (MotionError, OSError):
            continue  # nobody named it
        for inventory in beside.inventories:
            made.catalogues.inventories[inventory] = beside.inventories[inventory]
        for code, station in beside.stations.items():
            made.catalogues.stations.setdefault(code, station)
