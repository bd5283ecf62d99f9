"""Workspace of a job: settings, database, lock."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.cache import KINDS, Cache
from pipeline.errors import InputError, KourosError
from pipeline.operations.dry_run import SCRATCH, read_only
from pipeline.resources import BUNDLED, resource, sweep

if TYPE_CHECKING:
    from pipeline.analysis.house.matching import HouseRules
    from pipeline.analysis.response_charts import ChartCache
    from pipeline.analysis.rule_table import RuleTable
    from pipeline.collection.database import Database
    from pipeline.collection.object_index import ObjectIndex
    from pipeline.mitigate import MeasureCatalogue
    from pipeline.motions.site import Site
    from pipeline.planning.plan import PlanTerms
    from pipeline.settings import Settings
    from pipeline.tables.assumed import AssumedValues


IMPORTS = "imports"
"""Folder beside the settings that holds the log of every import that changed something."""


LOCK = ".kouros.lock"
"""File beside the settings that who works there holds."""


class LockedError(KourosError):
    """Another run is at work."""

    exit_code = 6


class UsageError(InputError):
    """A wish that cannot be carried out as it was put."""


@dataclass(frozen=True)
class Workspace:
    """Open settings: the database is at the newest schema, the folders are known.

    Attributes
    ----------
    settings : Settings
        Of the museum.
    engine : Database
        Where inventory and runs are.
    """

    settings: "Settings"
    engine: "Database"

    @cached_property
    def rules(self) -> "RuleTable | None":
        """The rules of classification with what is assumed of each class, where the museum has some of its own.

        Raises
        ------
        UsageError
            For a file that is not there.
        TableError
            For one that cannot be used.
        """
        from pipeline.analysis.rule_table import with_own

        path = self._own(self.settings.collection.rules, "[collection] rules names the file of your own rules")
        own = path is not None or any(self.settings.tables.model_dump().values())
        return with_own(path, self.values) if own else None

    @cached_property
    def values(self) -> "AssumedValues":
        """What is assumed where a record is silent, with the museum's rows in place of Kouros's.

        Raises
        ------
        UsageError
            For a file that is not there.
        TableError
            For one that cannot be used.
        """
        from pipeline.models import MODELS
        from pipeline.tables.assumed import assumed, assumed_with

        own = {}
        for name, file in self.settings.tables.model_dump().items():
            path = self._own(file, f"[tables] {name} names the file of your own rows")
            if path is not None:
                own[name] = path
        return assumed_with(own, [model.name for model in MODELS]) if own else assumed()

    @cached_property
    def house(self) -> "HouseRules | None":
        """The house rules, where the museum has any.

        Raises
        ------
        UsageError
            For rules that cannot be used together.
        """
        if not self.settings.house:
            return None
        from pipeline.analysis.house.matching import HouseRules

        try:
            return HouseRules(self.settings.house, tuple(self.values.classes))
        except InputError as problem:
            raise UsageError(f"kouros.toml: {problem}") from None

    @cached_property
    def measures(self) -> "MeasureCatalogue":
        """The measures and isolators that the museum has.

        Raises
        ------
        UsageError
            For a file that is not there.
        TableError
            For one that cannot be used.
        """
        wanted = self.settings.mitigation
        from pipeline.mitigate import measure_catalogue

        return measure_catalogue(
            self._own(wanted.measures, "[mitigation] measures names the file of your own measures"),
            self._own(wanted.catalogue, "[mitigation] catalogue names the file of your own isolators"),
            self.values,
        )

    @cached_property
    def plan_terms(self) -> "PlanTerms":
        """What the plan rests on: what the museum's measures take, and what there is by its settings.

        Raises
        ------
        UsageError
            For a file that is not there.
        TableError
            For one that cannot be used.
        """
        from pipeline.planning.choice import EffortLimits
        from pipeline.planning.efforts import efforts
        from pipeline.planning.plan import PlanTerms

        wanted = self.settings.plan
        own = self._own(wanted.efforts, "[plan] efforts names the file of what measures take you")
        limits = EffortLimits(wanted.hours or None, wanted.cost or None)
        return PlanTerms(efforts(own, self.measures), limits, wanted.currency)

    def object_index(self) -> "ObjectIndex":
        """Return the objects of the inventory as it is now."""
        from pipeline.collection.object_index import object_index

        return object_index(self.engine)

    def site(self) -> "Site":
        """Read the site of the settings; its processed motions are kept for the next time.

        Returns
        -------
        Site
            With the motions of the ground.

        Raises
        ------
        MotionError
            As `pipeline.motions.site.read_site`.
        """
        from pipeline.motions.site import read_site

        settings = self.settings
        return read_site(site_folder(settings.home, settings.site.folder), kept=settings.kept)

    def _own(self, name: str, remedy: str) -> Path | None:
        if not name:
            return None
        path = self.settings.path(name)
        if not path.is_file():
            raise UsageError(f"{path} is not there; {remedy}")
        return path

    @property
    def scratch(self) -> bool:
        """Whether the database goes with the dry run that made it: then anything may be written to it."""
        home = self.settings.rehearsal
        return home is not None and self.engine.url.database == str(home / SCRATCH)

    @property
    def reports(self) -> Path:
        """The folder of all reports."""
        return self.settings.path(self.settings.report.folder)


def site_folder(home: Path, name: str) -> Path:
    """Return a site's folder.

    Parameters
    ----------
    home : Path
        The folder of the settings.
    name : str
        One of `BUNDLED`, else a folder, relative to home.

    Returns
    -------
    Path
        Whether or not it is there.
    """
    return resource("site_motions", name) if name in BUNDLED else home / Path(name).expanduser()


def open_workspace(settings: "Settings", *, keeping: int = 0) -> Workspace:
    """Open the database, bringing its tables to the newest schema; in a dry run it can only be read.

    Parameters
    ----------
    keeping : int, optional
        How many connections wait to be used again (see `open_database`).

    Returns
    -------
    Workspace
    """
    from pipeline.collection.database import open_database
    from pipeline.store import migrate

    if settings.rehearsal is not None:
        return Workspace(settings, read_only(settings, settings.rehearsal))
    engine = open_database(settings.database, keeping=keeping)
    migrate.upgrade(engine)
    return Workspace(settings, engine)


@contextmanager
def locked(settings: "Settings", *, sweeping: bool = True) -> Iterator[None]:
    """Hold the lock of this workspace: one run at a time.  A dry run where none ever was makes no file for it.

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    sweeping : bool
        Remove what processes that died left unfinished; not where nothing is to be written.

    Yields
    ------
    None

    Raises
    ------
    LockedError
        At once where another process holds it.
    """
    from filelock import FileLock, Timeout

    file = settings.home / LOCK
    if settings.rehearsal is not None and not file.is_file():
        yield
        return
    settings.home.mkdir(parents=True, exist_ok=True)
    lock = FileLock(file, timeout=0)
    try:
        lock.acquire()
    except Timeout as problem:
        raise LockedError(
            f"another run holds {lock.lock_file}; wait for it to end (the lock goes with the process that holds it)"
        ) from problem
    try:
        if sweeping and settings.rehearsal is None:
            _sweep(settings)
        yield
    finally:
        lock.release()


def _sweep(settings: "Settings") -> None:
    kept = settings.kept
    folders = [settings.home, settings.path(IMPORTS), settings.path(settings.report.folder)]
    folders += [kept, *(kept / kind for kind in KINDS)]
    if settings.site.folder not in BUNDLED:
        folders.append(site_folder(settings.home, settings.site.folder))
    for folder in dict.fromkeys(folders):
        sweep(folder)


@contextmanager
def charts_of(
    settings: "Settings | None", using: Collection[str] = (), admitted: Collection[str] | None = None
) -> Iterator["ChartCache"]:
    """Lend the cache of the workspace's response charts, and prune the cache at the end.

    Parameters
    ----------
    settings : Settings or None
        Of the workspace; None: a cache in memory only.
    using : collection of str
        Hashes of motions in use, whose charts stay although perhaps none of them is asked for.
    admitted : collection of str, or None
        See `ChartCache`.

    Yields
    ------
    ChartCache
        For the block.
    """
    from pipeline.analysis.response_charts import ChartCache

    if settings is None:
        yield ChartCache()
        return
    charts = ChartCache(settings.kept, admitted=None if admitted is None else frozenset(admitted))
    try:
        yield charts
    finally:
        tidy(settings, using)


def tidy(settings: "Settings", using: Collection[str]) -> None:
    """Remove from the cache what the settings do not keep any longer, see `pipeline.cache.Cache.prune`.

    Parameters
    ----------
    settings : Settings
        Those of ``[charts]`` count: days, and megabytes of each kind.
    using : collection of str
        Hashes of motions in use.
    """
    limits = settings.charts
    Cache(settings.kept).prune(days=limits.unused_days, most_bytes=round(1e6 * limits.megabytes), using=using)


def folder_of_site(settings: "Settings | None", site: str | None) -> Path:
    """Return the folder of a site named on the command line, or else of the settings.

    Parameters
    ----------
    settings : Settings or None
        None where there are none.
    site : str or None
        As named on the command line.

    Returns
    -------
    Path
        Whether or not it is there.

    Raises
    ------
    UsageError
        Where neither names one.
    """
    if site is not None:
        return site_folder(Path() if settings is None else settings.home, site)
    if settings is None:
        raise UsageError("name a site's folder, or 'demo'; or run this beside kouros.toml, which names one")
    return site_folder(settings.home, settings.site.folder)
