"""Errors of databases, in words that say what failed, where, and what mends it."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Engine
from sqlalchemy.exc import IntegrityError, SQLAlchemyError

from pipeline.store.codec import StoreError


@contextmanager
def explained(engine: Engine, what: str) -> Iterator[None]:
    """Turn what the database says, but for a clash of keys, into a StoreError that says what failed and where."""
    try:
        yield
    except IntegrityError:
        raise
    except SQLAlchemyError as error:
        if isinstance(getattr(error, "orig", None), StoreError):
            raise error.orig from error  # type: ignore[attr-defined]  # a StatementError around what a column's type said
        remedy = "make its tables with `kouros init`, and see that it can be reached and written"
        raise StoreError(
            f"{what}: {where_is(engine)} says {getattr(error, 'orig', None) or error}; {remedy}"
        ) from error


def where_is(engine: Engine) -> str:
    """Return the database in words, without its password."""
    return f"the database {engine.url.render_as_string(hide_password=True)}"
