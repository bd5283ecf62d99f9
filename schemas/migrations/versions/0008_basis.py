"""A result says what shaking, rules and code it rests on, so that a later night takes over what is still the same."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the column; of the results of before nobody knows, and they are taken over whole or not at all."""
    op.add_column("result", sa.Column("basis", sa.Text(), nullable=False, server_default=""))


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
