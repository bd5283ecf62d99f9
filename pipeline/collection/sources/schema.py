"""Tables of a museum's database, their columns, and which column refers to which table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pipeline.collection.sources.sql import inspected

_OWN_SCHEMAS = ("information_schema", "pg_", "mysql", "performance_schema", "sys", "INFORMATION_SCHEMA", "db_", "guest")
"""How the schemas begin that a server keeps for itself."""


@dataclass(frozen=True)
class DatabaseTable:
    """A table or a view.

    Attributes
    ----------
    schema : str or None
        None for the default one.
    name : str
        Without its schema.
    columns : tuple of str
        In the database's order.
    key : tuple of str
        Columns of the primary key.
    refers : mapping of str to (str, str)
        Column -> the table, as `shown`, and its column, that a declared foreign key names.
    """

    schema: str | None
    name: str
    columns: tuple[str, ...]
    key: tuple[str, ...] = ()
    refers: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    @property
    def shown(self) -> str:
        """As a mapping names it."""
        return self.name if self.schema is None else f"{self.schema}.{self.name}"


def tables_of(url: str, *, environment: Mapping[str, str] | None = None) -> tuple[DatabaseTable, ...]:
    """Return the tables and views that a museum's database lists.

    Parameters
    ----------
    url : str
        As of `sql.read_database`.
    environment : mapping of str to str, or None
        Where ${NAME} is looked up, the process's own unless given.

    Returns
    -------
    tuple of DatabaseTable
        Of the default schema by name, then the others.

    Raises
    ------
    CollectionError
        As `sql.read_database`.
    """
    found: list[DatabaseTable] = []
    with inspected(url, environment=environment) as inspector:
        schemas: list[str | None] = [None]
        if inspector.dialect.name != "sqlite":
            own = inspector.default_schema_name
            schemas += [s for s in sorted(inspector.get_schema_names()) if s != own and not s.startswith(_OWN_SCHEMAS)]
        for schema in schemas:
            for name in sorted({*inspector.get_table_names(schema), *inspector.get_view_names(schema)}):
                columns = tuple(str(one["name"]) for one in inspector.get_columns(name, schema=schema))
                key = inspector.get_pk_constraint(name, schema=schema).get("constrained_columns") or ()
                refers = {}
                for foreign in inspector.get_foreign_keys(name, schema=schema):
                    if len(foreign["constrained_columns"]) == len(foreign["referred_columns"]) == 1:
                        there = foreign["referred_schema"]
                        other = str(foreign["referred_table"])
                        shown = other if there in (None, inspector.default_schema_name) else f"{there}.{other}"
                        refers[str(foreign["constrained_columns"][0])] = (shown, str(foreign["referred_columns"][0]))
                found.append(DatabaseTable(schema, name, columns, tuple(map(str, key)), refers))
    return tuple(found)
