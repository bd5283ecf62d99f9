"""Outcome of a case of the self-test."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """What a case gave: result is not above limit where ok; problem is what stopped it.

    Attributes
    ----------
    what, truth : str
        The extreme, and what it is held against.
    result : float or None
        A relative error where the truth says nothing else; None where no number came out.
    limit : float
        The largest result that is accepted.
    ok : bool
        Whether the case passed.
    seconds : float
        What it took.
    problem : str
        What stopped it; "" where nothing did.
    """

    what: str
    truth: str
    result: float | None
    limit: float
    ok: bool
    seconds: float
    problem: str = ""
