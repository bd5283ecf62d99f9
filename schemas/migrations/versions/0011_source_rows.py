"""Rows of the museum's source are known by their digests, and every record by what its assessment rests on."""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

from pipeline.collection.record import KINDS, assessment_digest_of, digest_of, to_items

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None

_AT_ONCE = 1_000
"""Records that are read at a time."""


def upgrade() -> None:
    """Make the tables, and fill in the digests of all records.

    A record that cannot be read keeps none: the next reading of the source writes it anew.
    """
    op.create_table(
        "source_row",
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("object_number", sa.Text(), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=True) for name in ("noted", "evidence")),
        sa.Column("checksum", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("digest", name="pk_source_row"),
        sqlite_with_rowid=False,
    )
    op.create_table(
        "source_state",
        sa.Column("id", sa.Integer(), autoincrement=False, nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("source", "sha256", "mapping", "code", "limits")),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("rows", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_source_state"),
    )
    op.add_column("item", sa.Column("assessment_digest", sa.Text(), nullable=False, server_default=""))
    op.drop_column("item", "kind")
    _fill_in()


def _fill_in() -> None:
    connection = op.get_bind()
    # The record may have got fields since, of which this table knows nothing; what is left out has its default.
    there = {column["name"] for column in sa.inspect(connection).get_columns("item")}
    lists = [name for name, kind in KINDS.items() if kind == "list" and name in there]
    fields = [name for name in KINDS if name in there]
    flags = [name for name, kind in KINDS.items() if kind == "flag" and name in there]
    item = sa.table("item", *(sa.column(name) for name in (*fields, "since", "digest", "assessment_digest")))
    mine = (item.c.object_number == sa.bindparam("number")) & (item.c.since == sa.bindparam("version"))
    told = sa.update(item).where(mine).values(digest=sa.bindparam("whole"), assessment_digest=sa.bindparam("assessed"))
    columns = [sa.cast(item.c[name], sa.Text).label(name) if name in lists else item.c[name] for name in fields]
    rows = connection.execute(sa.select(*columns, item.c.since, item.c.digest)).mappings().all()
    for start in range(0, len(rows), _AT_ONCE):
        found = [one for row in rows[start : start + _AT_ONCE] if (one := _digests(dict(row), lists, flags))]
        if found:
            connection.execute(told, found)


def _digests(row: dict[str, Any], lists: list[str], flags: list[str]) -> dict[str, Any] | None:
    whole, since = row.pop("digest"), row.pop("since")
    try:
        row |= {name: json.loads(row[name]) for name in lists}
        row |= {name: bool(row[name]) for name in flags if row[name] is not None}
        (record,) = to_items([row])
    except (ValueError, TypeError):
        return None
    # A digest that is there was written with the record, and says whether it is still what it was.
    return {
        "number": record.object_number,
        "version": since,
        "whole": whole or digest_of(record),
        "assessed": assessment_digest_of(record),
    }


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
