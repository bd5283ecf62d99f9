"""Every import is a version of the inventory; a record keeps where its numbers come from."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Give every object the version that it is of: the last import brought all that is there."""
    for name in ("added", "removed", "changed"):
        op.add_column("import_batch", sa.Column(name, sa.Integer(), nullable=False, server_default="0"))
    op.add_column("import_batch", sa.Column("kind", sa.Text(), nullable=False, server_default="import"))
    op.add_column("import_batch", sa.Column("returned_to", sa.Integer(), nullable=True))
    for name in ("aat", "dimensions", "digest"):
        op.add_column("item", sa.Column(name, sa.Text(), nullable=False, server_default=""))
    op.add_column("item", sa.Column("provenance", sa.JSON(), nullable=False, server_default="[]"))
    op.add_column("item", sa.Column("since", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("item", sa.Column("until", sa.Integer(), nullable=True))
    op.execute("UPDATE item SET since = (SELECT coalesce(max(id), 0) FROM import_batch)")
    with op.batch_alter_table("item") as item:
        item.drop_constraint("pk_item", type_="primary")
        item.create_primary_key("pk_item", ["object_number", "since"])
        for name in ("aat", "dimensions", "digest", "provenance", "since"):
            item.alter_column(name, server_default=None)
    op.create_table(
        "supplement",
        sa.Column("object_number", sa.Text(), nullable=False),
        sa.Column("since", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("until", sa.Integer(), nullable=True),
        sa.Column("source", sa.Text(), nullable=False),
        sa.Column("record", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("object_number", "since", name="pk_supplement"),
    )
    op.create_index("ix_supplement_until", "supplement", ["until"])


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
