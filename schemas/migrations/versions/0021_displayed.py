"""How an object is displayed, in the museum's words."""

import sqlalchemy as sa
from alembic import op

revision = "0021"
down_revision = "0020"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the words to the records of objects; what was recorded before has none."""
    op.add_column("item", sa.Column("displayed", sa.Text(), nullable=False, server_default=""))


def downgrade() -> None:
    """Refuse: going back would drop what was recorded."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
