"""Where an object's photograph is, and who is to be credited for it."""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the photograph and its credit line to the records of objects; what was recorded before names none."""
    op.add_column("item", sa.Column("image", sa.Text(), nullable=False, server_default=""))
    op.add_column("item", sa.Column("image_credit", sa.Text(), nullable=False, server_default=""))


def downgrade() -> None:
    """Refuse: going back would drop what was recorded."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
