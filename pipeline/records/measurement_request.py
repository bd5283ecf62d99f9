"""A measurement that a survey asks for: a quantity of one object that is missing or assumed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MeasurementRequest:
    """A quantity of one object that nobody recorded, and what recording it would do.

    Attributes
    ----------
    object_number, gallery, title : str
        The object.
    field : str
        Of the object record, such as friction.
    unit : str
        Of the values.
    low, best, high : float or None
        What is assumed instead, in ``unit``; None where nothing can be assumed.
    reason : str
        What is assumed and by which source, or that it is not recorded.
    open : int
        Verdicts that are undetermined now and that it takes part in, or levels at which it may change what is decided.
    settles : float
        How many of them it would settle: of verdicts the mean over its being measured as low, best and high.
    unlocks : int
        Models that cannot be run without it.
    drawn : bool
        Whether ``settles`` is the probability that something else is decided once it is measured, from joint samples.
    """

    object_number: str
    gallery: str
    title: str
    field: str
    unit: str
    low: float | None
    best: float | None
    high: float | None
    reason: str
    open: int
    settles: float
    unlocks: int
    drawn: bool = False

    @property
    def gain(self) -> float:
        """What measuring it brings: what it would settle, and models that it would make possible."""
        return self.settles + self.unlocks

    @property
    def settles_nothing(self) -> bool:
        """Whether measuring it alone would settle nothing, wherever in its range it lies."""
        return not self.gain
