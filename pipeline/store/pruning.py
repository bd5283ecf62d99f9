"""Runs that nobody needs any longer leave the database."""

from collections.abc import Iterable

from sqlalchemy import Engine, delete

from pipeline.store.tables import RUN


def remove_runs(engine: Engine, run_ids: Iterable[str]) -> None:
    """Remove runs with all that was stored for them, each in a transaction of its own.

    run_ids : one that is not there is passed by

    The space is used again by later runs; an SQLite file does not become smaller by itself.
    """
    for run_id in run_ids:
        with engine.begin() as connection:
            connection.execute(delete(RUN).where(RUN.c.run_id == run_id))
