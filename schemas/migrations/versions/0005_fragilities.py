"""From what shaking on each object fails, and how near neighbours stand."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the fragility curves and the spacings of a run."""
    curve = (
        *(_text(name) for name in ("object_number", "model", "title")),
        *(_number(name) for name in ("median", "low", "high")),
        _text("bound"),
        *(_number(name) for name in ("dispersion", "record")),
        sa.Column("stated", sa.Boolean(), nullable=False),
        *(_number(name) for name in ("inputs", "modelling")),
        sa.Column("motions", sa.BigInteger(), nullable=False),
        sa.Column("returns", sa.Boolean(), nullable=False),
        *(_number(name, nullable=True) for name in ("annual_rate", "rate_low", "rate_high")),
        *(_text(name) for name in ("note", "published")),
        _number("published_median", nullable=True),
    )
    pair = (
        *(_text(name) for name in ("gallery", "level", "first", "second")),
        _number("gap"),
        *(_number(name, nullable=True) for name in ("needed", "low", "high", "radial")),
        _number("together"),
        *(_text(name) for name in ("verdict", "decided_by", "motion", "note")),
    )
    for table, columns, by in (("fragility", curve, "object_number"), ("spacing", pair, "gallery")):
        op.create_table(
            table,
            sa.Column("run_id", sa.Text(), nullable=False),
            sa.Column("position", sa.BigInteger(), autoincrement=False, nullable=False),
            *columns,
            sa.ForeignKeyConstraint(["run_id"], ["run.run_id"], name=f"fk_{table}_run_id_run", ondelete="CASCADE"),
            sa.PrimaryKeyConstraint("run_id", "position", name=f"pk_{table}"),
        )
        op.create_index(f"ix_{table}_run_id_{by}", table, ["run_id", by])


def _text(name: str) -> sa.Column[str]:
    return sa.Column(name, sa.Text(), nullable=False)


def _number(name: str, *, nullable: bool = False) -> sa.Column[float]:
    return sa.Column(name, sa.Double(), nullable=nullable)


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")
