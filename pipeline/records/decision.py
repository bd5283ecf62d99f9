"""What people decided about an object: who, when, why, and on which findings it rested."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from pipeline.records.result import Verdict


class DecisionKind(StrEnum):
    """What a person may decide; a withdrawal ends an earlier decision."""

    ACCEPT = "accept"
    INSTALLED = "installed"
    CLASS = "class"
    VERDICT = "verdict"
    WITHDRAW = "withdraw"


@dataclass(frozen=True, slots=True)
class Basis:
    """A finding that a decision rested on, as it was when the decision was made; demand and capacity in ``unit``."""

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

    id           : counts up; 0 before it is stored
    date         : the day it was made (ISO 8601), as the person says;  recorded : when it was written down, UTC
    model, level : what is accepted or overruled; "" for all of them
    until        : the last day on which an accepted risk is accepted; "" for no end
    measure      : row of tables/measures.csv that is installed, with its parameters (SI), their units and its product
    object_class : row of tables/classes.csv that an object is said to be
    verdict      : what takes the place of the computed one in the person's eyes; the computed one stays
    withdraws    : id of the decision that this one ends
    run, digest, basis : the run that was looked at, the digest of the object's record, and the findings
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
        about = ", ".join(text for text in (self.model, self.level and f"level {self.level}") if text)
        end = f" until {self.until}" if self.until else ""
        given = ", ".join(
            f"{name} {value:g} {self.units[name]}".removesuffix(" -") for name, value in self.parameters.items()
        )
        about = f" ({about or given})" if about or given else ""
        what = {
            DecisionKind.ACCEPT: "risk accepted",
            DecisionKind.INSTALLED: f"installed {self.measure}",
            DecisionKind.CLASS: f"class {self.object_class}",
            DecisionKind.VERDICT: f"verdict {self.verdict}",
            DecisionKind.WITHDRAW: f"withdrawal of {self.withdraws}",
        }[self.kind]
        product = f", {self.product}" if self.product else ""
        return f"{what}{about}{product}{end}"

    @property
    def by(self) -> str:
        """Who decided, when and why, in one phrase."""
        return f"decided by {self.who} on {self.date}: {self.why}"


@dataclass(frozen=True, slots=True)
class Standing:
    """A decision in force at the time of a run; ``doubts`` say why it must be looked at again, if it must."""

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
    log : in the order of the ids
    """
    rows = list(log)
    withdrawn = {row.withdraws for row in rows}
    latest = {
        (row.object_number, row.kind, row.measure, row.model, row.level): row
        for row in rows
        if row.kind is not DecisionKind.WITHDRAW
    }
    return tuple(sorted((row for row in latest.values() if row.id not in withdrawn), key=lambda row: row.id))
