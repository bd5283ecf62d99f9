"""How an object hangs, and what it stands on; what was recorded before says nothing of either."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add both to the records of objects."""
    for name in ("hanging", "furniture"):
        op.add_column("item", sa.Column(name, sa.Text(), nullable=True))


def downgrade() -> None:
    """Refuse: going back would drop what was recorded."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
