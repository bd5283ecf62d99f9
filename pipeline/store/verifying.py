"""The rows of the database compared with their seals, table by table."""

from collections.abc import Iterator
from typing import NamedTuple

from sqlalchemy import Engine, inspect

from pipeline.collection.inventory import verify_inventory
from pipeline.collection.inventory.records import LostRecordsError
from pipeline.collection.inventory.source_rows import damaged_source_rows
from pipeline.collection.object_index import verify_count
from pipeline.collection.sealing import damaged_rows
from pipeline.store.tables import (
    DECISION,
    ERRAND_WORD,
    EVENT_REPORT,
    IMPORT_BATCH,
    METADATA,
    PAGE,
    PICTURE,
    READING,
    RESULT,
    RUN,
    RUN_CHART,
    RUN_DECISION,
    RUN_MOTION,
    RUN_PAGE,
    SOURCE_STATE,
    SUPPLEMENT,
)

_BACKUP = "nobody else knows what was written: restore the database from a backup"
_IMPORT = "import the museum's records again (`kouros import`)"
_NIGHT = "the next night reads or makes it again"
_HISTORY = "the run is left out of comparisons; `kouros prune` removes it"

_REMEDIES = {
    DECISION.name: _BACKUP,
    IMPORT_BATCH.name: _BACKUP,
    SUPPLEMENT.name: _BACKUP,
    ERRAND_WORD.name: _BACKUP,
    EVENT_REPORT.name: _BACKUP,
    PICTURE.name: _BACKUP,
    READING.name: _IMPORT,
    SOURCE_STATE.name: _NIGHT,
    **dict.fromkeys((RUN.name, RUN_CHART.name, RUN_DECISION.name, RUN_MOTION.name, RUN_PAGE.name), _HISTORY),
    PAGE.name: _NIGHT,
    RESULT.name: _NIGHT,
}
"""What mends each table that is sealed row by row."""


class RowDamage(NamedTuple):
    """A row that is not what was written: its table, its primary key in words, and what mends it."""

    table: str
    row: str
    remedy: str


def verify_columns(engine: Engine) -> Iterator[RowDamage]:
    """Yield every table whose columns are not those that were made.

    Parameters
    ----------
    engine : Engine
        Kouros's own database, of this version; it is only read.

    Yields
    ------
    RowDamage
    """
    looked = inspect(engine)
    there = set(looked.get_table_names())
    for table in METADATA.tables.values():
        made = {c.name: (str(c.type), bool(c.nullable), c.primary_key) for c in table.columns}
        keys = set(looked.get_pk_constraint(table.name)["constrained_columns"]) if table.name in there else set()
        found = {
            c["name"]: (str(c["type"]), bool(c["nullable"]), c["name"] in keys)
            for c in (looked.get_columns(table.name) if table.name in there else ())
        }
        if engine.dialect.name != "sqlite":
            # Servers tell the same type by another name, and do not keep it as a text that may rot.
            made, found = ({name: ("", *of[1:]) for name, of in side.items()} for side in (made, found))
        if made != found:
            names = sorted(name for name in made.keys() | found.keys() if made.get(name) != found.get(name))
            yield RowDamage(table.name, f"its columns ({', '.join(names)[:200]})", _BACKUP)


def tables() -> tuple[str, ...]:
    """Return the tables that `verify_table` looks at."""
    return tuple(name for name in METADATA.tables if name in _REMEDIES or name in ("item", "source_row"))


def verify_table(engine: Engine, name: str) -> Iterator[RowDamage]:
    """Yield every row of a table that is not what was written.

    Parameters
    ----------
    engine : Engine
        Kouros's own database; it is only read.
    name : str
        One of `tables`.

    Yields
    ------
    RowDamage
    """
    if name == "item":
        for one in verify_inventory(engine):
            remedy = _IMPORT if one.is_current else "that version cannot be returned to"
            yield RowDamage(name, f"object {one.object_number!r} of version {one.since}", remedy)
        try:
            verify_count(engine)
        except LostRecordsError as problem:
            yield RowDamage(name, str(problem), _IMPORT)
    elif name == "source_row":
        yield from (RowDamage(name, row, _NIGHT) for row in damaged_source_rows(engine))
    else:
        with engine.connect() as connection:
            for row in damaged_rows(connection, METADATA.tables[name]):
                yield RowDamage(name, row, _REMEDIES[name])
