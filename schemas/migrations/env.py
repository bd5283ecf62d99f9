"""Alembic's entry: migrates on the connection, and in the transaction, that `pipeline.store.migrate` hands over."""

from alembic import context

from pipeline.store.tables import METADATA

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=METADATA,
    render_as_batch=True,  # SQLite cannot alter a column: it copies the table
)
with context.begin_transaction():
    context.run_migrations()
