"""Objects may be recorded with the polygon that they stand on, and with a tilt test."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the columns; nothing is recorded of them yet."""
    for name in ("contact_polygon", "contact_polygon_least"):
        op.add_column("item", sa.Column(name, sa.JSON(), nullable=False, server_default="[]"))
    op.add_column("item", sa.Column("tilt_angle_deg", sa.Double(), nullable=True))


def downgrade() -> None:
    """Refuse: going back would drop measurements."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
