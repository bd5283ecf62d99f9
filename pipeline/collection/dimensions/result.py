"""Result of reading a dimension text: parts with their values, notes on what was judged, and the object's extents."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DimensionPart:
    """One measured number of a text.

    Attributes
    ----------
    name : str
        Which part of the object, normalised: "overall", "base", "with base", "frame", "sheet"; "overall" too where the
        text names none.
    words : str
        The words as written, or "" where the text names no part.
    dimension : str
        height, width, depth, diameter, length, circumference, thickness, weight, or unlabelled.
    value : float or None
        In SI (m or kg), rounded once; of a range the larger end; None where no unit is known.
    unit : str
        As understood ("in", "oz t"); of a sum the smaller length (8' 3") or the larger mass (3 oz. 2 dwt.); "" where
        none is known.
    unit_text : str
        As written behind the number, "" where it stands elsewhere or nowhere.
    low, high : float or None
        The ends of a range, in SI; both equal to value where there is no range.
    alternative : float or None
        The same measure as the text's other system gives it, in SI; None where it stands once.
    qualifiers : tuple of str
        Sorted, of each, approximate, irregular, variable, sight, maximum, minimum.
    assumed : bool
        The dimension is not written but follows from the order, height x width x depth.
    group : int
        Numbers that stand together share it, counted from 0 in the order of the text.
    start, end : int
        The characters of the text that hold the number.
    """

    name: str
    words: str
    dimension: str
    value: float | None
    unit: str
    unit_text: str
    low: float | None
    high: float | None
    alternative: float | None
    qualifiers: tuple[str, ...]
    assumed: bool
    group: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class DimensionNote:
    """Something that a reader of the text should know.

    Attributes
    ----------
    kind : str
        contradiction (two readings differ by more than 3 mm and 3 %), conversion (a reading that pairs with none),
        order (the order was assumed), unit (a unit was assumed or inferred), shared_unit (it is that of a number
        before), missing_unit, ambiguous, left_out (a duration, a date, a scale), variable, remainder (characters not
        understood), truncated.
    message : str
        The same in words.
    start, end : int
        The characters of the text that it is about.
    """

    kind: str
    message: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Dimensions:
    """A text's measured parts in the order of the text, and the notes."""

    text: str
    parts: tuple[DimensionPart, ...] = ()
    notes: tuple[DimensionNote, ...] = ()

    def having(self, kind: str) -> tuple[DimensionNote, ...]:
        """Return the notes of one kind."""
        return tuple(note for note in self.notes if note.kind == kind)

    def written(self, part: DimensionPart) -> str:
        """Return the characters that a part came from."""
        return self.text[part.start : part.end]


@dataclass(frozen=True, slots=True)
class Choice:
    """One extent of the object [m or kg], the characters of the text that it came from, and why it was taken."""

    value: float
    start: int
    end: int
    why: str


@dataclass(frozen=True, slots=True)
class Chosen:
    """The object's extents [m] and mass [kg]; None where the text does not say."""

    height: Choice | None = None
    width: Choice | None = None
    depth: Choice | None = None
    base_width: Choice | None = None
    base_depth: Choice | None = None
    diameter: Choice | None = None
    mass: Choice | None = None
