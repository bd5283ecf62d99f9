"""What became of the rows behind a version of the inventory, as it was noted with it and stands with its objects."""

from __future__ import annotations

from collections.abc import Iterator

from sqlalchemy import Engine, func, select

from pipeline.collection import noting
from pipeline.collection.inventory import IMPORT_BATCH, ITEM, doubted
from pipeline.records import Account, Doubt
from pipeline.records.reading import DOUBTFUL, REFUSED, SHEET, SOURCE


def account(engine: Engine, version: int | None = None) -> Account | None:
    """Return what became of the rows behind a version; None where that was not noted, as before an upgrade.

    version : None for the newest
    """
    with engine.connect() as connection:
        number = connection.execute(select(func.max(IMPORT_BATCH.c.id))).scalar() if version is None else version
        known = None if number is None else noting.told(connection, number)
        if known is None or known["base"] is None:
            return None
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == known["base"])).mappings().one()
    return Account(
        source=row["source"],
        rows=row["rows"],
        refused=len(row["rejected"]),
        doubtful=known["doubtful"],
        sheets=len(known["sheets"]),
        suspicions=tuple((field, message, remedy) for field, message, remedy in known["suspicions"]),
        flagged=known["flagged"],
    )


def doubts(engine: Engine, version: int) -> Iterator[Doubt]:
    """Yield everything that was refused or is doubted of a version; nothing where that was not noted.

    What is of the whole source comes first, then rows refused, then sheets, then objects by number.
    """
    with engine.connect() as connection:
        known = noting.told(connection, version)
        if known is None or known["base"] is None:
            return
        for field, message, remedy in known["suspicions"]:
            yield Doubt(SOURCE, None, None, "", field, message, remedy)
        rejected = select(IMPORT_BATCH.c.rejected).where(IMPORT_BATCH.c.id == known["base"])
        for row in connection.execute(rejected).scalar_one():
            # Its place is told besides.
            message = row["message"].removeprefix(f"{row['file']}, row {row['row']} (line {row['line']}): ")
            yield Doubt(REFUSED, row["row"], row["line"], "", row["field"], message, row["remedy"])
        for sheet, at, line, number, field, message, remedy in known["sheets"]:
            yield Doubt(SHEET, at or None, line or None, number, field, f"{sheet}: {message}", remedy)
        wanted = select(ITEM.c.object_number, ITEM.c.problems).where(doubted(version)).order_by(ITEM.c.object_number)
        for number, problems in connection.execution_options(yield_per=1_000).execute(wanted):
            place, below = known["places"].get(number, (None, None))
            for problem in problems:
                yield Doubt(DOUBTFUL, place, below, number, problem["field"], problem["message"], problem["remedy"])
