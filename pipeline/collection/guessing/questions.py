"""What a person may choose otherwise than it was guessed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pipeline.collection.guessing.units import usual_unit
from pipeline.collection.record import units_of


@dataclass(frozen=True)
class Question:
    """What a person may decide.

    Attributes
    ----------
    key : str
        By which the choice is given: ``--choose key=...``.
    text : str
        The question.
    options : tuple of str
        What may be chosen; the first ones are the likeliest.
    taken : str
        What is taken where nobody answers.
    """

    key: str
    text: str
    options: tuple[str, ...]
    taken: str

    def without(self, name: str) -> Question | None:
        """Return the question without an option, where it leaves something to choose."""
        options = tuple(option for option in self.options if option != name)
        return replace(self, options=options) if options not in ((), (self.taken,)) else None


def asked_unit(names: Sequence[str], numbers: Sequence[str], doubts: list[str], questions: list[Question]) -> str:
    """Return the unit of lengths that tell none, by what numbers in it look like; say so and ask.

    Parameters
    ----------
    names : sequence of str
        Of their columns.
    numbers : sequence of str
        As written.
    doubts, questions : list
        What is said and asked goes there.
    """
    unit, why = usual_unit(numbers)
    told = ", ".join(map(repr, names))
    doubts.append(f"no unit is told for {told}: {why}; --choose unit=mm (cm, in, ...) takes another")
    questions.append(Question("unit", f"in which unit are {told}?", tuple(units_of("height_m")), unit))
    return unit
