"""The versions of the inventory: one for each import, each sheet laid over it and each return to an earlier one."""

from __future__ import annotations

from dataclasses import dataclass, fields

from sqlalchemy import Engine, RowMapping, func, select

from pipeline.collection.inventory.tables import IMPORT_BATCH
from pipeline.collection.sealing import require_sound


@dataclass(frozen=True, slots=True)
class ImportInfo:
    """One version: when (ISO 8601, UTC), from which source by which mapping, how its rows were accounted for."""

    id: int
    imported_at: str
    source: str
    sha256: str
    mapping: str
    museum: str
    credit: str
    rows: int
    items: int
    rejected: int
    kind: str
    returned_to: int | None
    added: int
    removed: int
    changed: int


def versions(engine: Engine) -> list[ImportInfo]:
    """Return all versions of the inventory, the newest first.

    Raises
    ------
    DamagedRowsError
        Where what is noted of one of them is not what was written.
    """
    with engine.connect() as connection:
        require_sound(connection, IMPORT_BATCH)
        rows = connection.execute(select(IMPORT_BATCH).order_by(IMPORT_BATCH.c.id.desc())).mappings()
        return [_info(row) for row in rows]


def latest_import(engine: Engine) -> ImportInfo | None:
    """Return the newest version, or None where nothing was imported yet.

    Raises
    ------
    DamagedRowsError
        As `versions`.
    """
    last = select(func.max(IMPORT_BATCH.c.id)).scalar_subquery()
    with engine.connect() as connection:
        require_sound(connection, IMPORT_BATCH, IMPORT_BATCH.c.id == last)
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == last)).mappings().one_or_none()
    return None if row is None else _info(row)


def held(engine: Engine, sha256: str) -> int | None:
    """Return the version that a person went back to from this very source, or None: a night must not undo that.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    sha256 : str
        Of the source as it is now; once the source has changed, it is read again.

    Returns
    -------
    int or None
        The version that was returned to.
    """
    known = versions(engine)
    if not known or known[0].returned_to is None:
        return None
    back = known[0].returned_to
    left = {info.sha256 for info in known if info.id > back and info.kind == "import"}
    return back if sha256 in left else None


def _info(row: RowMapping) -> ImportInfo:
    told = {field.name: row[field.name] for field in fields(ImportInfo)}
    return ImportInfo(**{**told, "rejected": len(row["rejected"])})
