"""Decisions of people about an object: who, when, why, and on which findings each rested."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from pipeline.records.result import Verdict


class DecisionKind(StrEnum):
    """Kind of a decision; a withdrawal ends an earlier decision."""

    ACCEPT = "accept"
    INSTALLED = "installed"
    CLASS = "class"
    VERDICT = "verdict"
    WITHDRAW = "withdraw"


@dataclass(frozen=True, slots=True)
class Basis:
    """A finding that a decision rested on, as it was when the decision was made.

    Attributes
    ----------
    model, title, level : str
        Of the finding.
    demand, capacity : float or None
        In ``unit``.
    unit : str
        Of both.
    utilisation : float or None
        Demand over capacity [-].
    verdict : Verdict
        What it said.
    motion, motion_hash : str
        Name and hash of the motion that governed it.
    """

    model: str
    title: str
    level: str
    demand: float | None
    capacity: float | None
    unit: str
    utilisation: float | None
    verdict: Verdict
    motion: str
    motion_hash: str


@dataclass(frozen=True, slots=True)
class Decision:
    """One row of the log of decisions, which is only ever added to.

    Attributes
    ----------
    id : int
        Counts up; 0 before it is stored.
    object_number : str
        The object that it is about.
    kind : DecisionKind
        What is decided.
    who, why : str
        The person, and the reason.
    date : str
        The day it was made (ISO 8601), as the person says.
    recorded : str
        When it was written down, UTC.
    model, level : str
        What is accepted or overruled; "" for all of them.
    until : str
        The last day on which an accepted risk is accepted; "" for no end.
    measure : str
        Row of tables/measures.csv that is installed.
    parameters : mapping of str to float
        Of that measure, SI.
    units : mapping of str to str
        Of the parameters.
    product : str
        What was installed, by its name.
    object_class : str
        Row of tables/classes.csv that an object is said to be.
    verdict : Verdict or None
        What takes the place of the computed one in the person's eyes; the computed one stays.
    withdraws : int or None
        Id of the decision that this one ends.
    run, digest : str
        The run that was looked at, and the digest of the object's record.
    basis : tuple of Basis
        The findings that it rested on.
    """

    id: int
    object_number: str
    kind: DecisionKind
    who: str
    date: str
    why: str
    recorded: str
    model: str = ""
    level: str = ""
    until: str = ""
    measure: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    product: str = ""
    object_class: str = ""
    verdict: Verdict | None = None
    withdraws: int | None = None
    run: str = ""
    digest: str = ""
    basis: tuple[Basis, ...] = ()

    def concerns(self, model: str, level: str) -> bool:
        """Say whether an accepted risk or an overruled verdict is about this model at this level."""
        return self.model in ("", model) and self.level in ("", level)

    @property
    def matter(self) -> str:
        """What was decided, in short: "installed clearance (clearance 0.1 m)"."""
        what = {
            DecisionKind.ACCEPT: "risk accepted",
            DecisionKind.INSTALLED: f"installed {self.measure}",
            DecisionKind.CLASS: f"class {self.object_class}",
            DecisionKind.VERDICT: f"verdict {self.verdict}",
            DecisionKind.WITHDRAW: f"withdrawal of {self.withdraws}",
        }[self.kind]
        return what + self.about

    @property
    def about(self) -> str:
        """What follows of the matter: " (clearance 0.1 m)", a product, until when."""
        found = ", ".join(text for text in (self.model, self.level and f"level {self.level}") if text)
        given = ", ".join(
            f"{name} {value:g} {self.units[name]}".removesuffix(" -") for name, value in self.parameters.items()
        )
        told = f" ({found or given})" if found or given else ""
        told += f", {self.product}" if self.product else ""
        return told + (f" until {self.until}" if self.until else "")

    @property
    def by(self) -> str:
        """Who decided, when and why, in one phrase."""
        return f"decided by {self.who} on {self.date}: {self.why}"


@dataclass(frozen=True, slots=True)
class DecisionStatus:
    """A decision in force at the time of a run.

    Attributes
    ----------
    decision : Decision
        The decision itself.
    doubts : tuple of str
        Why it must be looked at again, if it must.
    """

    decision: Decision
    doubts: tuple[str, ...] = ()

    def covers(self, model: str, level: str) -> bool:
        """Say whether it settles a failure of this model at this level: accepted or overruled, and not in doubt."""
        decision = self.decision
        settles = decision.kind is DecisionKind.ACCEPT or decision.verdict is Verdict.PASS
        return settles and not self.doubts and decision.concerns(model, level)


def in_force(log: Iterable[Decision]) -> tuple[Decision, ...]:
    """Return the decisions of a log that are neither withdrawn nor replaced by a later one of the same matter.

    A decision that was replaced stays so: the withdrawal of the later one does not bring it back.

    Parameters
    ----------
    log : iterable of Decision
        In the order of the ids.

    Returns
    -------
    tuple of Decision
        In the order of the ids.
    """
    rows = list(log)
    withdrawn = {row.withdraws for row in rows}
    latest = {
        (row.object_number, row.kind, row.measure, row.model, row.level): row
        for row in rows
        if row.kind is not DecisionKind.WITHDRAW
    }
    return tuple(sorted((row for row in latest.values() if row.id not in withdrawn), key=lambda row: row.id))
