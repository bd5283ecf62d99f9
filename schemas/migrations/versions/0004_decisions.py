"""What people decide is kept in a log of its own, and with each run what was in force."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

_TEXTS = ("object_number", "kind", "who", "date", "why", "recorded", "model", "level", "until", "measure")
_MORE = ("parameters", "units", "product", "object_class")


def upgrade() -> None:
    """Add the log of decisions, and those that were in force at a run."""
    op.create_table(
        "decision",
        sa.Column("id", sa.Integer(), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in (*_TEXTS, *_MORE)),
        sa.Column("verdict", sa.Text(), nullable=True),
        sa.Column("withdraws", sa.BigInteger(), nullable=True),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("run", "digest", "basis")),
        sa.PrimaryKeyConstraint("id", name="pk_decision"),
        sa.UniqueConstraint("withdraws", name="uq_decision_withdraws"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_decision_object_number", "decision", ["object_number"])
    op.create_table(
        "run_decision",
        sa.Column("run_id", sa.Text(), nullable=False),
        sa.Column("position", sa.BigInteger(), autoincrement=False, nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("object_number", "decision", "doubts")),
        sa.ForeignKeyConstraint(["run_id"], ["run.run_id"], name="fk_run_decision_run_id_run", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", "position", name="pk_run_decision"),
    )
    op.create_index("ix_run_decision_run_id_object_number", "run_decision", ["run_id", "object_number"])


def downgrade() -> None:
    """Refuse: going back would drop decisions."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
