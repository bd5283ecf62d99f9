"""A museum's own database as a source: one SELECT, a table or a view (`sources.sql` reads it)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal, Self

from pydantic import Field, model_validator

from pipeline.collection.sources.base import Name, Opened, Request, Source, SourceSettings, digested
from pipeline.errors import InputError

TIMEOUT = 600.0
"""Seconds that a database may take, where the mapping says nothing."""


class QuerySettings(SourceSettings):
    """What is asked of several tables."""

    query: Name | None = Field(default=None, description="One SELECT; or name a table instead.")
    table: Name | None = Field(default=None, description='A table or view, such as "tms.objects".')
    timeout_seconds: float | None = Field(
        default=None, gt=0.0, le=86400.0, description="How long the database may take for it; 600."
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.query is None) == (self.table is None):
            raise InputError('a source of several tables needs either query = "SELECT ..." or table = "name"')
        return self


class DatabaseSettings(QuerySettings):
    """How a database is read."""

    format: Literal["sql"] = Field(description="The kind of source.")


class Database(Source):
    """A database that SQLAlchemy speaks to."""

    name = "sql"
    title = "a database"
    Settings = DatabaseSettings

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether it is an address."""
        return "://" in where

    @contextmanager
    def open(self, request: Request) -> Iterator[Opened]:
        """Open the database; its rows are read in one snapshot that cannot write."""
        # Only here: whoever reads a file does without SQLAlchemy.
        from pipeline.collection.sources.address import expand_secrets
        from pipeline.collection.sources.sql import read_database

        wanted = request.settings
        rows = read_database(
            request.where,
            query=wanted.query,
            table=wanted.table,
            columns=request.columns if wanted.table and wanted.long is None else None,
            optional=request.optional,
            order_by=request.key_column if wanted.table else None,
            timeout_seconds=min(wanted.timeout_seconds or TIMEOUT, request.limits.seconds),
        )
        yield digested(expand_secrets(request.where).shown, rows)
