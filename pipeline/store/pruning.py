"""Runs that nobody needs any longer leave the database, and with them what no other run holds."""

from collections.abc import Iterable

from sqlalchemy import Engine, delete, select

from pipeline.store.pages import fetch_members
from pipeline.store.results import forget
from pipeline.store.tables import PAGE, RESULT, RUN, RUN_PAGE


def remove_runs(engine: Engine, run_ids: Iterable[str]) -> None:
    """Remove runs, each in a transaction of its own, and then the pages and the results that no run holds.

    run_ids : one that is not there is passed by

    What an interrupted run found belongs to no run, and is lost here: a good run came after it.  The space is used
    again by later runs; an SQLite file does not become smaller by itself.
    """
    for run_id in run_ids:
        with engine.begin() as connection:
            connection.execute(delete(RUN).where(RUN.c.run_id == run_id))
    with engine.begin() as connection:
        connection.execute(delete(PAGE).where(PAGE.c.key.not_in(select(RUN_PAGE.c.key))))
    used: set[str] = set()
    with engine.connect() as connection:
        # Page by page: a page names a thousand results.
        for key in connection.execute(select(PAGE.c.key)).scalars().all():
            members, _ = fetch_members(connection, key)
            used.update([] if members is None else members.wanted)
        there = set(connection.execute(select(RESULT.c.key)).scalars())
    forget(engine, there - used)
