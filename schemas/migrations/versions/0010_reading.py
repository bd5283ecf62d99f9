"""What reading refused and doubts is kept with the version that it led to."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table; of the versions of before it is not known, and reports say so until the next import."""
    op.create_table(
        "reading",
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("told", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(
            ["version"], ["import_batch.id"], name="fk_reading_version_import_batch", ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("version", name="pk_reading"),
    )


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
