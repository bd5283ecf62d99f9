"""Parts that other packages bring, found by their entry points: loaded when first asked for, checked, or left out.

A package offers a part under a group such as ``kouros.models``, in its own pyproject.toml::

    [project.entry-points."kouros.models"]
    toppling = "kouros_toppling:TOPPLING"

What cannot be used is said in a warning that names package, entry point and remedy, and left out: a broken package
never stops a night.
"""

import hashlib
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Protocol, TypeVar, overload

from pipeline.errors import InputError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

PREFIX = "kouros."
"""How the groups of entry points begin that Kouros looks at."""


class ExtensionWarning(UserWarning):
    """A part that another package offers cannot be used; it is left out."""


class ExtensionVersion(NamedTuple):
    """What is installed under an entry point.

    Attributes
    ----------
    distribution, version : str
        Of the package that brings it.
    code : str
        Digest of its source: a version often stays the same while somebody works on it.
    """

    group: str
    name: str
    distribution: str
    version: str
    code: str


class Named(Protocol):
    """A part of a registry."""

    @property
    def name(self) -> str:
        """What it is asked for by, different from that of all others."""
        ...


Part = TypeVar("Part", bound=Named)


class Registry(Sequence[Part], Generic[Part]):
    """Kouros's own parts of one kind, in their order, and after them those of other packages, by name.

    Those of other packages are loaded when the registry is first read, so that a module of theirs may import Kouros.

    Parameters
    ----------
    group : str
        Group of entry points, such as "kouros.models".
    own : sequence of Part
        Kouros's own parts; none of another package takes the name of one.
    check : callable
        ``check(value) -> Part``: returns what an entry point names as a part, and raises an InputError that says what
        is wrong with it and what mends it.
    """

    def __init__(self, group: str, own: Sequence[Part], check: Callable[[object], Part]) -> None:
        self.group, self.own = group, tuple(own)
        self._check = check
        self._parts: tuple[Part, ...] | None = None
        self._problems: tuple[str, ...] = ()
        self._lock, self._loading = RLock(), False

    @property
    def parts(self) -> tuple[Part, ...]:
        """All parts that can be used; Kouros's own alone for a module of another package that is being loaded."""
        if self._parts is not None:
            return self._parts
        with self._lock:
            if self._parts is None and not self._loading:
                self._loading = True
                try:
                    self._load()
                finally:
                    self._loading = False
            return self.own if self._parts is None else self._parts

    @property
    def problems(self) -> tuple[str, ...]:
        """What was left out: package, entry point, what is wrong and what mends it."""
        return self._problems if self.parts else ()

    def _load(self) -> None:
        parts, problems = list(self.own), []
        for entry in _entries(self.group):
            try:
                part = self._check(entry.load())
                if any(part.name == other.name for other in parts):
                    raise InputError(f"there is a part called {part.name!r} already; give it another name")
            except (Exception, SystemExit) as problem:  # noqa: BLE001 - whatever a package raises stops no night
                problems.append(_words(entry, problem))
            else:
                parts.append(part)
        self._parts, self._problems = tuple(parts), tuple(problems)
        for words in problems:
            warnings.warn(words, ExtensionWarning, stacklevel=2)

    @overload
    def __getitem__(self, at: int) -> Part: ...
    @overload
    def __getitem__(self, at: slice) -> Sequence[Part]: ...
    def __getitem__(self, at: int | slice) -> Part | Sequence[Part]:
        """Return a part by its place, or several."""
        return self.parts[at]

    def __len__(self) -> int:
        """Return how many parts there are."""
        return len(self.parts)

    def __iter__(self) -> Iterator[Part]:
        """Yield each part."""
        return iter(self.parts)


def _words(entry: "EntryPoint", problem: BaseException) -> str:
    distribution, version = _package(entry)
    said = str(problem) if isinstance(problem, InputError) else f"{type(problem).__name__}: {problem}"
    return (
        f"{distribution} {version} offers {entry.name!r} ({entry.group}: {entry.value}), which cannot be used and is "
        f"left out: {said.rstrip('.')}. Mend it, or uninstall {distribution}"
    )


def _package(entry: "EntryPoint") -> tuple[str, str]:
    name = version = None
    # Either is None where the package's METADATA is damaged, or asking for it fails, as who found the package likes.
    with suppress(Exception):
        name, version = (None, None) if entry.dist is None else (entry.dist.name, entry.dist.version)
    return name or "a package without a name", version or "?"


def _entries(group: str) -> "list[EntryPoint]":
    from importlib.metadata import entry_points

    return sorted(entry_points(group=group), key=lambda one: (one.name, *_package(one)))


@cache
def extension_versions() -> tuple[ExtensionVersion, ...]:
    """Return what other packages have installed, without loading any of it.

    Every key of what is kept between nights must depend on it, as it does on Kouros's own code: a result that a model
    of another version gave is not that of this one.  `pipeline.resources.digest_of` takes it in.

    Returns
    -------
    tuple of ExtensionVersion
        Of all groups that begin with PREFIX, in order; empty where nothing is installed.
    """
    from importlib.metadata import entry_points

    found = entry_points()
    groups = sorted(group for group in found.groups if group.startswith(PREFIX))
    return tuple(
        ExtensionVersion(group, entry.name, *_package(entry), _source_digest(re.split("[.:]", entry.value)[0].strip()))
        for group in groups
        for entry in _entries(group)
    )


@cache
def _source_digest(top: str) -> str:
    """Return the SHA-256 of the source of a package or a module, names included; "" where there is none."""
    digest = hashlib.sha256()
    for folder, file in sorted(_sources(top)):
        with suppress(OSError):
            digest.update(file.relative_to(folder).as_posix().encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()


def _sources(top: str) -> Iterator[tuple[Path, Path]]:
    spec: Any = None
    with suppress(ImportError, ValueError):
        spec = find_spec(top)
    if spec is None:
        return
    if spec.submodule_search_locations:
        for folder in map(Path, spec.submodule_search_locations):
            yield from ((folder, file) for file in folder.rglob("*") if file.suffix in (".py", ".csv"))
    elif spec.origin is not None and Path(spec.origin).is_file():
        yield Path(spec.origin).parent, Path(spec.origin)
