"""Outcome of a case of the self-test."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """What a case gave: result is not above limit where ok; problem is what stopped it.

    what, truth : the extreme, and what it is held against
    result      : a relative error where the truth says nothing else; None where no number came out
    """

    what: str
    truth: str
    result: float | None
    limit: float
    ok: bool
    seconds: float
    problem: str = ""
