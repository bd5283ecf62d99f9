"""What the desk keeps: accounts, sessions, words on errands, photographs of mounts."""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "desk_account",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("role", sa.Text(), nullable=False),
        sa.Column("secret", sa.Text(), nullable=False),
        sa.Column("made", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("name", name="pk_desk_account"),
    )
    op.create_table(
        "desk_session",
        sa.Column("token", sa.Text(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("ends", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("token", name="pk_desk_session"),
    )
    op.create_index("ix_desk_session_name", "desk_session", ["name"])
    op.create_table(
        "errand_word",
        sa.Column("id", sa.Integer(), nullable=False),
        *(
            sa.Column(name, sa.Text(), nullable=False)
            for name in ("errand", "kind", "whose", "note", "who", "recorded")
        ),
        sa.Column("seal", sa.Text(), nullable=False, server_default=""),
        sa.PrimaryKeyConstraint("id", name="pk_errand_word"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_errand_word_errand", "errand_word", ["errand"])
    op.create_table(
        "mount_picture",
        sa.Column("id", sa.Integer(), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("object_number", "note", "who", "recorded")),
        sa.Column("image", sa.LargeBinary(), nullable=False),
        sa.Column("seal", sa.Text(), nullable=False, server_default=""),
        sa.PrimaryKeyConstraint("id", name="pk_mount_picture"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_mount_picture_object_number", "mount_picture", ["object_number"])


def downgrade() -> None:
    """Refuse: going back would drop what people said."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
