"""Whether furniture is fastened; what was recorded before says nothing of it."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add it to the records of objects."""
    op.add_column("item", sa.Column("furniture_anchorage", sa.Text(), nullable=True))


def downgrade() -> None:
    """Refuse: going back would drop what was recorded."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
