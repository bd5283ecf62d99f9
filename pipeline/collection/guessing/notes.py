"""What is said of a guess on its way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pipeline.collection.guessing.questions import Question


@dataclass
class GuessNotes:
    """What is said of a guess on its way.

    Attributes
    ----------
    choices : mapping of str to str
        What a person has chosen.
    doubts, questions, sure : list
        As `guess.Guess` has them; they grow.
    """

    choices: Mapping[str, str]
    doubts: list[str] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    sure: list[str] = field(default_factory=list)
