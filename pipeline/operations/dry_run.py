"""A dry run: the same job on what is there, in a workspace that nothing can be written to."""

import shutil
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from pipeline.cache import THUMBNAILS
from pipeline.errors import InputError

if TYPE_CHECKING:
    from pipeline.collection.database import Database
    from pipeline.settings import Settings

NOTHING = "dry run: nothing was written"
"""The last line of every dry run."""

SCRATCH = "kouros.sqlite"
"""The database of a rehearsal where there is none yet."""


class DryRunWarning(UserWarning):
    """What the real one would do besides."""


@contextmanager
def rehearsed(settings: "Settings", dry_run: bool = True) -> Iterator["Settings"]:
    """Lend the settings of a rehearsal: the database can be read only, what is kept between nights is a copy, no log.

    What a rehearsal keeps goes into a temporary folder, and with it.  The copy is of what a night may use, so that a
    dry run takes no longer than the night: `[charts] megabytes` bounds it.

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    dry_run : bool
        False: the settings as they are, for callers that are asked for one or the other.

    Yields
    ------
    Settings
        Those to work with in the block.
    """
    if not dry_run or settings.rehearsal is not None:
        yield settings
        return
    with TemporaryDirectory(prefix="kouros-dry-run-") as name:
        folder = Path(name)
        # Without the copy a dry run only takes longer.
        with suppress(OSError, shutil.Error):
            if settings.kept.is_dir():
                # A dry run shows no photographs, and so needs none.
                left = shutil.ignore_patterns(THUMBNAILS)
                shutil.copytree(settings.kept, folder / settings.kept.name, ignore=left, copy_function=shutil.copyfile)
        logs = settings.logs.model_copy(update={"file": ""})
        yield settings.model_copy(update={"rehearsal": folder, "logs": logs})


def read_only(settings: "Settings", folder: Path, doing: str = "a dry run") -> "Database":
    """Open the database of the settings so that nothing can be written to it; where it is still empty, another one.

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    folder : Path
        Of the rehearsal; where nothing was imported yet the job may work on an empty database there, which goes with
        it.
    doing : str
        What is done with it, for messages.

    Returns
    -------
    Database
        That of the settings, to be read only, or the empty one.

    Raises
    ------
    InputError
        Where the tables are not those of this version: a dry run does not change them.

    Warns
    -----
    DryRunWarning
        Where there are no tables of Kouros yet.
    """
    from pipeline.collection.database import database_url, open_database, open_for_reading
    from pipeline.collection.inventory import latest_import
    from pipeline.store import migrate
    from pipeline.store.runs import list_runs

    url = database_url(settings.database)
    shown = url.render_as_string(hide_password=True) if "://" in settings.database else settings.database
    there = None
    if url.get_backend_name() != "sqlite" or (url.database and Path(url.database).is_file()):
        engine = open_for_reading(url)
        there = migrate.current(engine)
        if there == migrate.revisions()[-1] and (latest_import(engine) is not None or list_runs(engine)):
            return engine
    if there is None:
        warnings.warn(f"{shown} has no tables of Kouros yet: the real one makes them", DryRunWarning, stacklevel=2)
    elif there != migrate.revisions()[-1]:
        migrate.refuse_newer(engine, there, migrate.revisions())
        raise InputError(
            f"{shown} has tables of an earlier Kouros (revision {there}, this one's is {migrate.revisions()[-1]}), and "
            f"{doing} does not change them: `kouros check --migrate` brings them up to date; keep a copy of it before"
        )
    engine = open_database(folder / SCRATCH)
    migrate.upgrade(engine)
    return engine
