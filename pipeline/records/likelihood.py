"""How likely an object comes to harm at a level of shaking: probabilities of states, and the words for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

CLASS = "class"
"""What is asked where it is not certain what an object is: role of the draws, and what `Likelihood.open_for` says."""


class Harm(StrEnum):
    """State that an object may reach: it shifts, leaves its place or hits something, rocks, falls, breaks."""

    SHIFTS = "shifts"
    LEAVES = "leaves"
    ROCKS = "rocks"
    FALLS = "falls"
    BREAKS = "breaks"


class Band(StrEnum):
    """Word for a probability."""

    ALMOST_CERTAIN = "almost certain"
    LIKELY = "likely"
    POSSIBLE = "possible"
    UNLIKELY = "unlikely"
    VERY_UNLIKELY = "very unlikely"


@dataclass(frozen=True, slots=True)
class Sampling:
    """How probabilities are found, and which words are used for them.

    Attributes
    ----------
    samples : int
        Joint samples of everything that is uncertain, at most; a power of two.
    certainty : float
        Probability that the word for a probability is the right one, from which on no more samples are taken.
    edges : tuple of float
        Probabilities from which on something is almost certain, likely, possible and unlikely, falling.
    """

    samples: int = 512
    certainty: float = 0.9
    edges: tuple[float, float, float, float] = (0.9, 0.5, 0.1, 0.01)

    def band(self, probability: float) -> Band:
        """Return the word for a probability."""
        return next(
            (word for word, edge in zip(Band, self.edges, strict=False) if probability >= edge), tuple(Band)[-1]
        )

    def deciding(self, target: float) -> Sampling:
        """Return the same for one question alone: whether a probability is a target at least."""
        return replace(self, edges=(4.0, 3.0, 2.0, target))

    def ends(self, probability: float) -> tuple[float, float]:
        """Return the probabilities between which the same word is used."""
        all_edges = (max(1.0, *self.edges), *self.edges, 0.0)
        at = tuple(Band).index(self.band(probability))
        return all_edges[at + 1], all_edges[at]


@dataclass(frozen=True, slots=True)
class IfClass:
    """How likely harm is if an object is of one of the classes that it may be of.

    Attributes
    ----------
    classes : tuple of str
        The class, or several for which the same is computed.
    chance : float
        How likely it is of that, of the classes that are weighed.
    probability : float or None
        Of being harmed if it is; None where no sample had it be that.
    samples : int
        How many had it be that.
    band : Band or None
        The word for the probability.
    """

    classes: tuple[str, ...]
    chance: float
    probability: float | None
    samples: int
    band: Band | None

    def at_least(self, target: float) -> bool:
        """Say whether harm is as likely as that if it is; of no samples nobody knows it, and it counts as likely."""
        return self.probability is None or self.probability >= target


@dataclass(frozen=True, slots=True)
class Likelihood:
    """How likely an object comes to harm at a level of shaking, its measures and the motions of the level being drawn.

    Attributes
    ----------
    level : str
        Name of the level.
    probability : float
        Of being harmed in any way.
    error : float
        Standard error of it, by the number of samples; that of having these motions and no others is not in it.
    samples : int
        How many were taken.
    band : Band
        The word for the probability.
    harm : str
        The state of harm that is likeliest, rocking without a fall; "" where no sample came to any.
    states : mapping of str to float
        By `Harm`, the probability of each state that it can reach; those that do it no harm as well.
    open_for : str
        The parameter whose measurement alone may change what is decided about it, or "class": what it is; "" for none.
    worth : float
        By how much that measurement lowers the expected loss, in units of the loss by harm.
    moves : float
        Probability that it is measured where something else is decided than now.
    classes : tuple of IfClass
        What it may be, of which all this is the mixture, the class that it is taken for first; () where that is certain
        or makes no difference.
    """

    level: str
    probability: float
    error: float
    samples: int
    band: Band
    harm: str = ""
    states: Mapping[str, float] = field(default_factory=dict)
    open_for: str = ""
    worth: float = 0.0
    moves: float = 0.0
    classes: tuple[IfClass, ...] = ()

    @property
    def expected(self) -> float:
        """The probability to be expected (Jeffreys's): of few samples of which none harmed, harm is not excluded."""
        return (self.probability * self.samples + 0.5) / (self.samples + 1.0)
