"""What people found of objects after an earthquake."""

import sqlalchemy as sa
from alembic import op

revision = "0020"
down_revision = "0019"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "event_report",
        sa.Column("id", sa.Integer(), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("event", "object_number", "state")),
        sa.Column("moved_m", sa.Double(), nullable=True),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("note", "who", "recorded")),
        sa.Column("seal", sa.Text(), nullable=False, server_default=""),
        sa.PrimaryKeyConstraint("id", name="pk_event_report"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_event_report_event", "event_report", ["event"])


def downgrade() -> None:
    """Refuse: going back would drop what people said."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
