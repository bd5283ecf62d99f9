"""The tables of the inventory and of the results, as Kouros 0.1 has them.

The columns are spelled out and not taken from the records: a migration must do the same for ever.
"""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make all tables."""
    _item()
    _import_batch()
    _run()
    _run_motion()
    _run_chart()
    _run_scene()
    _finding()
    _recommendation()


def downgrade() -> None:
    """Refuse: going back would drop results."""
    raise NotImplementedError("Kouros's tables go forward only; restore the backup of before the upgrade")


def _text(name: str, *, optional: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.Text(), nullable=optional)


def _double(name: str, *, optional: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.Double(), nullable=optional)


def _integer(name: str, *, optional: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.Integer(), nullable=optional)


def _long(name: str) -> sa.Column[Any]:
    return sa.Column(name, sa.BigInteger(), autoincrement=False, nullable=False)


def _boolean(name: str, *, optional: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.Boolean(), nullable=optional)


def _json(name: str) -> sa.Column[Any]:
    return sa.Column(name, sa.JSON(), nullable=False)


def _of_run(table: str, *key: str) -> tuple[sa.Constraint, ...]:
    return (
        sa.ForeignKeyConstraint(["run_id"], ["run.run_id"], name=f"fk_{table}_run_id_run", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", *key, name=f"pk_{table}"),
    )


def _item() -> None:
    op.create_table(
        "item",
        _text("object_number"),
        _text("gallery"),
        _text("title"),
        _text("object_name"),
        _text("classification"),
        _text("medium"),
        _text("case"),
        _double("position_x_m", optional=True),
        _double("position_y_m", optional=True),
        _double("orientation_deg", optional=True),
        _text("support", optional=True),
        _text("isolator"),
        _double("height_m", optional=True),
        _double("base_width_m", optional=True),
        _double("base_depth_m", optional=True),
        _double("width_m", optional=True),
        _double("depth_m", optional=True),
        _double("cg_height_m", optional=True),
        _double("mass_kg", optional=True),
        _text("material"),
        _text("base_material"),
        _text("surface_material"),
        _double("friction", optional=True),
        _double("frequency_hz", optional=True),
        _double("damping", optional=True),
        _double("suspension_length_m", optional=True),
        _text("wall_surface"),
        _text("back_surface"),
        _text("section_shape"),
        _double("section_width_m", optional=True),
        _double("section_depth_m", optional=True),
        _double("section_wall_m", optional=True),
        _double("section_height_m", optional=True),
        _integer("section_count", optional=True),
        _double("allowable_stress_pa", optional=True),
        _double("condition", optional=True),
        _double("clearance_m", optional=True),
        _boolean("susceptible", optional=True),
        _text("value_class"),
        _boolean("on_display"),
        _json("problems"),
        sa.PrimaryKeyConstraint("object_number", name="pk_item"),
    )


def _import_batch() -> None:
    op.create_table(
        "import_batch",
        sa.Column("id", sa.Integer(), nullable=False),
        _text("imported_at"),
        _text("source"),
        _text("sha256"),
        _text("mapping"),
        _text("museum"),
        _text("credit"),
        _integer("rows"),
        _integer("items"),
        _json("rejected"),
        sa.PrimaryKeyConstraint("id", name="pk_import_batch"),
    )


def _run() -> None:
    op.create_table(
        "run",
        _text("run_id"),
        _text("started"),
        _text("finished"),
        _text("version"),
        _text("site"),
        _text("museum"),
        _text("level_notes"),
        _text("settings"),
        _boolean("demonstration"),
        _text("status"),
        _text("counts"),
        sa.PrimaryKeyConstraint("run_id", name="pk_run"),
    )
    op.create_index("ix_run_status_started", "run", ["status", "started"])


def _run_motion() -> None:
    op.create_table(
        "run_motion",
        _text("run_id"),
        _long("position"),
        _text("name"),
        _text("hash"),
        _text("level"),
        _text("source"),
        _double("dt"),
        _long("samples"),
        _text("measures"),
        _text("steps"),
        _text("approved_by"),
        _text("approved_on"),
        _text("licence"),
        _text("series"),
        *_of_run("run_motion", "position"),
    )


def _run_chart() -> None:
    op.create_table(
        "run_chart",
        _text("run_id"),
        _text("key"),
        _long("position"),
        _text("chart"),
        *_of_run("run_chart", "key"),
    )


def _run_scene() -> None:
    op.create_table(
        "run_scene",
        _text("run_id"),
        _text("object_number"),
        _long("position"),
        _text("gallery"),
        _boolean("on_display"),
        _text("item"),
        _text("object_class"),
        _text("rule"),
        _text("support"),
        _text("models"),
        _text("parameters"),
        _text("assumptions"),
        _text("missing"),
        _text("skipped"),
        *_of_run("run_scene", "object_number"),
    )
    op.create_index("ix_run_scene_run_id_gallery", "run_scene", ["run_id", "gallery"])


def _finding() -> None:
    op.create_table(
        "finding",
        _text("run_id"),
        _long("position"),
        _text("object_number"),
        _text("gallery"),
        _text("level"),
        _text("model"),
        _text("title"),
        _text("demand_name"),
        _double("demand", optional=True),
        _text("unit"),
        _double("low", optional=True),
        _double("high", optional=True),
        _double("capacity", optional=True),
        _text("capacity_origin", optional=True),
        _double("utilisation", optional=True),
        _text("verdict"),
        _text("fidelity"),
        _double("error", optional=True),
        _text("decided_by"),
        _text("motion"),
        _text("motion_hash"),
        _text("sentence"),
        _text("screen"),
        _text("outcome"),
        _text("note"),
        _text("assumptions"),
        _text("mark", optional=True),
        _text("version"),
        *_of_run("finding", "position"),
    )
    op.create_index("ix_finding_run_id_gallery", "finding", ["run_id", "gallery"])
    op.create_index("ix_finding_run_id_object_number", "finding", ["run_id", "object_number"])


def _recommendation() -> None:
    op.create_table(
        "recommendation",
        _text("run_id"),
        _long("position"),
        _text("object_number"),
        _text("gallery"),
        _text("level"),
        _text("measure"),
        _text("title"),
        _text("sentence"),
        _text("parameters"),
        _text("units"),
        _text("checks"),
        _text("rejected"),
        _text("mark", optional=True),
        _text("source"),
        *_of_run("recommendation", "position"),
    )
    op.create_index("ix_recommendation_run_id_gallery", "recommendation", ["run_id", "gallery"])
    op.create_index("ix_recommendation_run_id_object_number", "recommendation", ["run_id", "object_number"])
