"""The log of what people decided: rows are added, never changed and never removed."""

from collections.abc import Mapping
from dataclasses import fields, replace

from sqlalchemy import Engine, insert, select
from sqlalchemy.exc import IntegrityError

from pipeline.collection.sealing import require_sound, write_seals
from pipeline.records import Basis, Decision, in_force
from pipeline.store.codec import StoreError
from pipeline.store.pages import load_members, load_page
from pipeline.store.tables import DECISION, RUN_PAGE

_BASIS = tuple(field.name for field in fields(Basis))
_NAMES = tuple(field.name for field in fields(Decision))


def add_decision(engine: Engine, decision: Decision) -> Decision:
    """Write one decision down.

    Parameters
    ----------
    engine : Engine
        From `collection.database.open_database`, brought to head by `migrate.upgrade`.

    Returns
    -------
    Decision
        The decision with its id.

    Raises
    ------
    DamagedRowsError
        Where the log so far is not what was written.
    StoreError
        For a withdrawal of what is withdrawn already, and for text that is not Unicode.
    """
    values = {name: getattr(decision, name) for name in _NAMES if name != "id"}
    try:
        with engine.begin() as connection:
            require_sound(connection, DECISION)
            made: int = connection.execute(insert(DECISION).values(values).returning(DECISION.c.id)).scalar_one()
            write_seals(connection, DECISION, DECISION.c.id == made)
    except IntegrityError as error:
        raise StoreError(
            f"decision {decision.withdraws} is withdrawn already; `kouros decide --list` shows what is in force"
        ) from error
    return replace(decision, id=made)


def read_decisions(engine: Engine, object_number: str | None = None) -> tuple[Decision, ...]:
    """Return the log, of one object or of all, in the order in which it was written.

    Raises
    ------
    DamagedRowsError
        Where any of it is not what was written: nobody knows then whom it is about.
    """
    wanted = select(*(DECISION.c[name] for name in _NAMES)).order_by(DECISION.c.id)
    with engine.connect() as connection:
        require_sound(connection, DECISION)
        found = [Decision(*row) for row in connection.execute(wanted)]
    # Found by reading all of them: an index that is damaged would leave some out.
    return tuple(one for one in found if object_number in (None, one.object_number))


InForce = Mapping[str, tuple[Decision, ...]]
"""Decisions by object number."""


def decisions_in_force(engine: Engine) -> InForce:
    """Return the decisions in force, by object number."""
    found: dict[str, tuple[Decision, ...]] = {}
    for decision in in_force(read_decisions(engine)):
        found[decision.object_number] = (*found.get(decision.object_number, ()), decision)
    return found


def looked_at(engine: Engine, run_id: str, object_number: str, gallery: str = "") -> tuple[Basis, ...]:
    """Return what a run found of an object, as a decision remembers it; nothing where the run has no such object.

    Parameters
    ----------
    gallery : str, optional
        Where it stood, so that those pages are looked at first.

    Returns
    -------
    tuple of Basis
    """
    order = RUN_PAGE.c.gallery != gallery
    with engine.connect() as connection:
        query = select(RUN_PAGE.c.key).where(RUN_PAGE.c.run_id == run_id).order_by(order, RUN_PAGE.c.position)
        for key in connection.execute(query).scalars().all():
            if object_number in load_members(connection, key).column("object_number"):
                found = load_page(connection, key)
                mine = next(a for a in found.assessments if a.scene.item.object_number == object_number)
                return tuple(Basis(*(getattr(f, name) for name in _BASIS)) for f in mine.findings)
    return ()
