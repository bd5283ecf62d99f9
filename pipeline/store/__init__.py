"""Runs, findings and recommendations in SQL: `migrate` makes the tables, `runs` writes and reads them.

Results are kept in Kouros's own database, next to the inventory (see `pipeline.collection.database`).
"""
