"""The floor on which an object stands and on which a motion is felt; what was stored before stood on the ground."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the floor to scenes and motions."""
    for table in ("run_scene", "run_motion"):
        op.add_column(table, sa.Column("floor", sa.Text(), nullable=False, server_default=""))


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
