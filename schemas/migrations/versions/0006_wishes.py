"""What is worth measuring is kept with the run that asked."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


_TEXTS = ("object_number", "gallery", "title", "field", "unit")


def upgrade() -> None:
    """Add the wishes of a run."""
    op.create_table(
        "run_wish",
        sa.Column("run_id", sa.Text(), nullable=False),
        sa.Column("position", sa.BigInteger(), autoincrement=False, nullable=False),
        *(
            sa.Column(name, sa.Text(), nullable=False)
            for name in ("object_number", "gallery", "title", "field", "unit")
        ),
        *(sa.Column(name, sa.Double(), nullable=True) for name in ("low", "best", "high")),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("open", sa.BigInteger(), nullable=False),
        sa.Column("settles", sa.Double(), nullable=False),
        sa.Column("unlocks", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["run_id"], ["run.run_id"], name="fk_run_wish_run_id_run", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", "position", name="pk_run_wish"),
    )
    op.create_index("ix_run_wish_run_id_object_number", "run_wish", ["run_id", "object_number"])


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
