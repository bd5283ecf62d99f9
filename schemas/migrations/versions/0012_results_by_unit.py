"""Results are kept for each unit, one object or all in one case; pages say which objects they show."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables anew.  Runs of before are dropped: the next night finds everything anew.

    Their reports are files and stay; so do the inventory, its versions and the decisions.
    """
    op.execute("DELETE FROM run")
    op.drop_table("run_sheet")
    op.drop_table("result")
    op.create_table(
        "result",
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("key", "run_id", "made", "outline")),
        sa.Column("found", sa.LargeBinary(), nullable=False),
        sa.Column("seal", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("key", name="pk_result"),
    )
    op.create_table(
        "page",
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("key", "run_id", "made")),
        sa.Column("members", sa.LargeBinary(), nullable=False),
        sa.Column("seal", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("key", name="pk_page"),
    )
    op.create_table(
        "run_page",
        sa.Column("run_id", sa.Text(), nullable=False),
        sa.Column("position", sa.BigInteger(), autoincrement=False, nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("key", "gallery")),
        sa.Column("on_display", sa.Boolean(), nullable=False),
        *(sa.Column(name, sa.Integer(), nullable=False) for name in ("number", "of")),
        sa.ForeignKeyConstraint(["key"], ["page.key"], name="fk_run_page_key_page"),
        sa.ForeignKeyConstraint(["run_id"], ["run.run_id"], name="fk_run_page_run_id_run", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", "position", name="pk_run_page"),
    )
    op.create_index("ix_run_page_key", "run_page", ["key"])


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
