"""A record says what kind of object it is of, so that a night finds out once what holds for many."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the column; the next import fills it in, and until then each object is of a kind of its own."""
    op.add_column("item", sa.Column("kind", sa.BigInteger(), nullable=True))


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
