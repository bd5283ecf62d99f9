"""Any museum's records -> Item: mappings, reading, and Kouros's own inventory.

Only `database`, `inventory` and, for a museum's own database, `sources.sql` and `sources.address` import SQLAlchemy, so
that a dry run of a file's import does without.
"""
