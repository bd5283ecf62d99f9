"""What is at stake with an object; what was recorded before says nothing of it."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add its value in money, whether it is irreplaceable and whether it is on loan to the records of objects."""
    op.add_column("item", sa.Column("value", sa.Double(), nullable=True))
    op.add_column("item", sa.Column("irreplaceable", sa.Boolean(), nullable=True))
    op.add_column("item", sa.Column("on_loan", sa.Boolean(), nullable=True))


def downgrade() -> None:
    """Refuse: going back would drop what was recorded."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
