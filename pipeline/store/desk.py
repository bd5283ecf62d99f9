"""What the desk keeps besides decisions and measurements: accounts, sessions, words on errands, pictures of mounts.

Words on errands and pictures are only ever added; the newest word counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

from sqlalchemy import Engine, Table, delete, func, insert, select, update

from pipeline.collection.inventory.tables import IMPORT_BATCH
from pipeline.collection.sealing import require_sound, sound_rows, write_seals
from pipeline.store.tables import ACCOUNT, DECISION, ERRAND_WORD, PICTURE, SESSION

# Built once: SQLAlchemy takes longer to put a statement together than SQLite to answer it.
_NEWEST = select(
    *(
        select(func.coalesce(func.max(table.c.id), 0)).scalar_subquery()
        for table in (DECISION, ERRAND_WORD, PICTURE, IMPORT_BATCH)
    )
)


@dataclass(frozen=True, slots=True)
class DeskAccount:
    """Somebody who may sign in: name, role ("reader" or "editor"), Argon2 of the password, when it was made."""

    name: str
    role: str
    secret: str
    made: str


@dataclass(frozen=True, slots=True)
class ErrandWord:
    """A row of the table errand_word; ``kind`` is "take", "give", "done" or "back", ``whose`` the person it is with."""

    id: int
    errand: str
    kind: str
    whose: str
    note: str
    who: str
    recorded: str


@dataclass(frozen=True, slots=True)
class Picture:
    """A row of the table mount_picture without the image itself."""

    id: int
    object_number: str
    note: str
    who: str
    recorded: str


_PICTURES = select(*(PICTURE.c[field.name] for field in fields(Picture))).order_by(PICTURE.c.id)


def account_named(engine: Engine, name: str) -> DeskAccount | None:
    """Return an account, None where there is none of that name."""
    with engine.connect() as connection:
        row = connection.execute(select(ACCOUNT).where(ACCOUNT.c.name == name)).one_or_none()
    return None if row is None else DeskAccount(*row)


def accounts(engine: Engine) -> tuple[DeskAccount, ...]:
    """Return all accounts by name."""
    with engine.connect() as connection:
        return tuple(DeskAccount(*row) for row in connection.execute(select(ACCOUNT).order_by(ACCOUNT.c.name)))


def put_account(engine: Engine, account: DeskAccount) -> None:
    """Make an account, or give the one of that name another role and password; its sessions end."""
    values = {field.name: getattr(account, field.name) for field in fields(DeskAccount)}
    with engine.begin() as connection:
        connection.execute(delete(SESSION).where(SESSION.c.name == account.name))
        changed = connection.execute(update(ACCOUNT).where(ACCOUNT.c.name == account.name).values(values))
        if not changed.rowcount:
            connection.execute(insert(ACCOUNT).values(values))


def remove_account(engine: Engine, name: str) -> bool:
    """Remove an account and its sessions; say whether there was one."""
    with engine.begin() as connection:
        connection.execute(delete(SESSION).where(SESSION.c.name == name))
        return bool(connection.execute(delete(ACCOUNT).where(ACCOUNT.c.name == name)).rowcount)


def begin_session(engine: Engine, token: str, name: str, *, now: int, ends: int) -> None:
    """Keep that somebody is signed in, and forget all sessions that have ended."""
    with engine.begin() as connection:
        connection.execute(delete(SESSION).where(SESSION.c.ends <= now))
        connection.execute(insert(SESSION).values(token=token, name=name, ends=ends))


def session_of(engine: Engine, token: str, now: int) -> DeskAccount | None:
    """Return whose session it is, None where it has ended or never began."""
    mine = (SESSION.c.token == token) & (SESSION.c.ends > now)
    with engine.connect() as connection:
        query = select(ACCOUNT).select_from(SESSION.join(ACCOUNT, SESSION.c.name == ACCOUNT.c.name)).where(mine)
        row = connection.execute(query).one_or_none()
    return None if row is None else DeskAccount(*row)


def end_session(engine: Engine, token: str) -> None:
    """Forget a session."""
    with engine.begin() as connection:
        connection.execute(delete(SESSION).where(SESSION.c.token == token))


def add_errand_word(engine: Engine, word: ErrandWord) -> None:
    """Write down what was said of an errand."""
    _add(engine, ERRAND_WORD, word, {})


def errand_words(engine: Engine, errands: Sequence[str] | None = None) -> dict[str, tuple[ErrandWord, ...]]:
    """Return what was said of errands, in the order in which it was said.

    Parameters
    ----------
    errands : sequence of str or None, optional
        Only these; None for all.

    Returns
    -------
    dict[str, tuple[ErrandWord, ...]]

    Raises
    ------
    DamagedRowsError
        Where any of it is not what was written.
    """
    wanted = [column for column in ERRAND_WORD.c if column.name != "seal"]
    query = select(*wanted).order_by(ERRAND_WORD.c.id)
    if errands is not None:
        query = query.where(ERRAND_WORD.c.errand.in_(errands))
    found: dict[str, tuple[ErrandWord, ...]] = {}
    with engine.connect() as connection:
        require_sound(connection, ERRAND_WORD)
        for row in connection.execute(query):
            word = ErrandWord(*row)
            found[word.errand] = (*found.get(word.errand, ()), word)
    return found


def add_picture(engine: Engine, picture: Picture, image: bytes) -> None:
    """Keep a photograph of a mount."""
    _add(engine, PICTURE, picture, {"image": image})


def pictures_of(engine: Engine, object_number: str) -> tuple[Picture, ...]:
    """Return the photographs of an object's mount, the oldest first, without the images."""
    query = _PICTURES.where(PICTURE.c.object_number == object_number)
    with engine.connect() as connection:
        return tuple(Picture(*row) for row in connection.execute(query))


def picture_image(engine: Engine, number: int) -> bytes | None:
    """Return a photograph as it was kept, None where there is none or it is not what was written."""
    with engine.connect() as connection:
        rows, _ = sound_rows(connection, PICTURE, PICTURE.c.id == number)
        return bytes(rows[0].image) if rows else None


def newest_ids(engine: Engine) -> tuple[int, ...]:
    """Return the newest ids of decisions, words on errands, photographs of mounts and versions of the inventory.

    Where these are as before, nobody has added anything.
    """
    with engine.connect() as connection:
        return tuple(connection.execute(_NEWEST).one())


def _add(engine: Engine, table: Table, row: Any, more: dict[str, Any]) -> None:
    values = {field.name: getattr(row, field.name) for field in fields(row) if field.name != "id"} | more
    with engine.begin() as connection:
        made: int = connection.execute(insert(table).values(values).returning(table.c.id)).scalar_one()
        write_seals(connection, table, table.c.id == made)
