"""What a run found is kept sheet by sheet, under the digest of what it depends on, so that nights share it."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

_GONE = ("spacing", "fragility", "run_wish", "recommendation", "finding", "run_scene")


def upgrade() -> None:
    """Make the tables of the sheets.  Runs of before are dropped: the next night finds everything anew.

    Their reports are files and stay; so do the inventory, its versions and the decisions.
    """
    op.execute("DELETE FROM run")
    for name in _GONE:
        op.drop_table(name)
    op.create_table(
        "result",
        sa.Column("key", sa.Text(), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("run_id", "made", "counts", "tally")),
        *(sa.Column(name, sa.LargeBinary(), nullable=False) for name in ("outline", "found")),
        sa.PrimaryKeyConstraint("key", name="pk_result"),
    )
    op.create_table(
        "run_sheet",
        sa.Column("run_id", sa.Text(), nullable=False),
        sa.Column("position", sa.BigInteger(), autoincrement=False, nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("key", "gallery")),
        sa.Column("on_display", sa.Boolean(), nullable=False),
        *(sa.Column(name, sa.Integer(), nullable=False) for name in ("number", "of")),
        sa.ForeignKeyConstraint(["key"], ["result.key"], name="fk_run_sheet_key_result"),
        sa.ForeignKeyConstraint(["run_id"], ["run.run_id"], name="fk_run_sheet_run_id_run", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", "position", name="pk_run_sheet"),
    )
    op.create_index("ix_run_sheet_key", "run_sheet", ["key"])


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
