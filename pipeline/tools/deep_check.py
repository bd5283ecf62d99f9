"""Everything that Kouros keeps compared with what was written: database, cache and last report; nothing is changed."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pipeline.cache import Cache
from pipeline.collection.database import database_url, open_for_reading, verify_file
from pipeline.errors import KourosError
from pipeline.operations.secrets import hider
from pipeline.records import Progress
from pipeline.report.files.manifest import verify_report
from pipeline.settings import Settings
from pipeline.store import migrate
from pipeline.store.verifying import tables, verify_columns, verify_table


@dataclass(frozen=True)
class Rot:
    """Something kept that is not what was written.

    Attributes
    ----------
    what
        "database", "cache" or "report".
    where
        The file, or the table and the row.
    why
        What is wrong with it; "" where the seal says no more than that.
    remedy
        What mends it.
    """

    what: str
    where: str
    why: str
    remedy: str


def examine(settings: Settings, progress: Progress) -> Iterator[Rot]:
    """Compare everything kept with what was written.

    Parameters
    ----------
    settings : Settings
        Of the museum.
    progress : Progress
        Told how far it is.

    Yields
    ------
    Rot
        For each thing that is damaged, as it is found.

    Raises
    ------
    StoreError
        For a database of another version of Kouros, which is to be brought up to date first.
    """
    yield from _database(settings, progress)
    progress.step("cache", 0, 1)
    for damage in Cache(settings.kept).verify():
        yield Rot("cache", str(damage.file), damage.why, "the next night that wants it makes it again")
    progress.step("cache", 1, 1)
    latest = settings.path(settings.report.folder) / "latest"
    if latest.exists():
        progress.step("report", 0, 1)
        for file, why in verify_report(latest.resolve()):
            yield Rot("report", str(file), why, "the next night makes it again")
        progress.step("report", 1, 1)


def _database(settings: Settings, progress: Progress) -> Iterator[Rot]:
    url = database_url(settings.database)
    hide, shown = hider(settings), url.render_as_string(hide_password=True)
    if url.get_backend_name() == "sqlite" and not Path(str(url.database)).is_file():
        return
    engine = open_for_reading(url)
    looks = ["file", "columns", *tables()]
    try:
        migrate.require_head(engine)
        for at, look in enumerate(looks):
            progress.step("database", at, len(looks))
            if look == "file":
                verify_file(engine, whole=True)
            else:
                for one in verify_columns(engine) if look == "columns" else verify_table(engine, look):
                    yield Rot("database", f"{shown}, table {one.table}: {one.row}", "", one.remedy)
        progress.step("database", len(looks), len(looks))
    except KourosError as problem:
        if type(problem) is migrate.OtherVersionError:
            raise
        yield Rot("database", shown, hide(str(problem)), "restore it from a backup, and see whether the disk is sound")
