"""${message}.

Revision ${up_revision} follows ${down_revision}.
"""

import sqlalchemy as sa
from alembic import op
${imports if imports else ""}
revision = ${repr(up_revision)}
down_revision = ${repr(down_revision)}
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Change the tables forward."""
    ${upgrades if upgrades else "pass"}


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
