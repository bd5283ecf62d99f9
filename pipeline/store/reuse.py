"""What an earlier run was: whole or of a part, and the keys of its settings that tell what its results rest on."""

from sqlalchemy import Engine, select

from pipeline.store.sound import damaged_heads, runs_but
from pipeline.store.tables import RUN

KERNELS = "kernels"
"""Key of a run's settings under which the version of the compiled models is kept."""


CODE = "code"
"""The same of the version of all code and tables that verdicts rest on besides the kernels."""


RULES = "rules"
"""Key of a run's settings under which the hash of the museum's own rules of classification is kept; "" for none."""


TABLES = "tables"
"""The same of the hashes of its own rows of what is assumed, by table."""


HOUSE = "house"
HOUSE_RULES = "house_rules"
"""The same of its house rules, in one hash."""


LEVELS = "levels"
"""Key of a run's settings under which it is kept how each level combines its motions."""


DISPLAY = "display"
"""Key of a run's settings under which it is kept whether what is not on display was assessed."""


SELECTION = "selection"
"""Key of a run's settings that is true for a run of a part of the collection."""


def whole_runs(engine: Engine) -> list[str]:
    """Return the finished runs of the whole collection, the newest first."""
    with engine.connect() as connection:
        sound = runs_but(damaged_heads(connection))
        finished = select(RUN.c.run_id, RUN.c.settings).where(RUN.c.status == "finished", sound)
        finished = finished.order_by(RUN.c.started.desc())
        return [row.run_id for row in connection.execute(finished) if not row.settings.get(SELECTION)]
