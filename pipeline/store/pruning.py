"""Runs that nobody needs any longer leave the database, and with them what no other run holds."""

from collections.abc import Iterable

from sqlalchemy import Engine, delete, select

from pipeline.store.tables import RESULT, RUN, RUN_SHEET


def remove_runs(engine: Engine, run_ids: Iterable[str]) -> None:
    """Remove runs, each in a transaction of its own, and then the results that no run holds.

    run_ids : one that is not there is passed by

    What an interrupted run found belongs to no run, and is lost here: a good run came after it.  The space is used
    again by later runs; an SQLite file does not become smaller by itself.
    """
    for run_id in run_ids:
        with engine.begin() as connection:
            connection.execute(delete(RUN).where(RUN.c.run_id == run_id))
    with engine.begin() as connection:
        connection.execute(delete(RESULT).where(RESULT.c.key.not_in(select(RUN_SHEET.c.key))))
