"""Any museum's records -> Item: mappings, reading, and Kouros's own inventory.

Only `database` and `inventory` import SQLAlchemy, so that a dry run of an import does without.
"""
