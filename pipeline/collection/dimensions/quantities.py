"""A number on its way to a part: what stands around it is still being read, so that it can change."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from pipeline.collection.dimensions.lexicon import LexiconUnit, units
from pipeline.collection.dimensions.result import DimensionNote


@dataclass(slots=True, eq=False)
class DimensionQuantity:
    """A number [num / den of its unit], perhaps a range that ends there, with where it stands.

    Attributes
    ----------
    num, den : int
        The number, exactly.
    start, end : int
        The characters of the text that hold it.
    word : str
        The number as written.
    unit : Unit or None
        None where none is known.
    unit_text : str
        The unit as written.
    written : bool
        The unit stands behind this number itself.
    first : (int, int) or None
        Of a range, where it begins, as num and den.
    dimension : str
        Which dimension it is, "" where that is open.
    assumed : bool
        The dimension is not written but follows from the order.
    run : int
        Numbers joined by "x" share it.
    other : Quantity or None
        The same measure in the text's other system.
    repaired : (int, int) or None
        SI value (num, den) that was judged to be meant.
    """

    num: int
    den: int
    start: int
    end: int
    word: str = ""
    unit: LexiconUnit | None = None
    unit_text: str = ""
    written: bool = False
    first: tuple[int, int] | None = None
    dimension: str = ""
    assumed: bool = False
    run: int = 0
    other: DimensionQuantity | None = None
    repaired: tuple[int, int] | None = None

    @property
    def kind(self) -> str:
        """The kind of its unit, or "" where it has none yet."""
        return self.unit.kind if self.unit else ""

    def si(self) -> float:
        """Return the value in SI, rounded once: Python divides two whole numbers correctly rounded.

        Returns
        -------
        float
            In m or kg.

        Raises
        ------
        ValueError
            Where it has no unit.
        """
        if self.repaired:
            return self.repaired[0] / self.repaired[1]
        return self.scaled(self.num, self.den)

    def scaled(self, num: int, den: int) -> float:
        """Return another number of this quantity's unit in SI.

        Parameters
        ----------
        num, den : int
            The number, as a fraction.

        Returns
        -------
        float
            In m or kg, rounded once.

        Raises
        ------
        ValueError
            Where it has no unit.
        """
        if self.unit is None:
            raise ValueError("a quantity without a unit has no value")
        return (num * self.unit.num) / (den * self.unit.den)

    def add(self, smaller: DimensionQuantity) -> None:
        """Add the inches to the feet, the pennyweights to the ounces.

        The sum keeps the unit that the field quotes: of lengths the smaller (87 in.), of masses the larger (3.1 oz).

        Parameters
        ----------
        smaller : Quantity
            What is added; it stands behind this one.

        Raises
        ------
        ValueError
            Where one of them has no unit.
        """
        if self.unit is None or smaller.unit is None:
            raise ValueError("only quantities with units can be added")
        ratio = Fraction(self.unit.num * smaller.unit.den, self.unit.den * smaller.unit.num)
        total = Fraction(self.num, self.den) * ratio + Fraction(smaller.num, smaller.den)
        if self.unit.kind == "length":
            self.unit = smaller.unit
        else:
            total /= ratio
        self.num, self.den, self.end = total.numerator, total.denominator, smaller.end
        self.unit_text = f"{self.unit_text} {smaller.unit_text}".strip()


@dataclass(slots=True, eq=False)
class Group:
    """Numbers that belong to one part of the object, in one place of the text."""

    name: str
    words: str
    qualifiers: set[str]
    quantities: list[DimensionQuantity] = field(default_factory=list)
    aside: bool = False
    """One dimension of a part, "diam. at rim": what follows without a name is not said of that part."""

    def named(self) -> set[str]:
        """Return the dimensions that it has, diameters aside: of these it may have several."""
        return {q.dimension for q in self.quantities if q.dimension} - {"diameter"}


def fill_units(run: list[DimensionQuantity]) -> None:
    """Give the numbers of a run without a unit that of the next number that has one, else of the one before."""
    unit: LexiconUnit | None = None
    for quantity in reversed(run):
        if quantity.unit is None:
            quantity.unit = unit
        else:
            unit = quantity.unit
    if unit is not None and run[-1].unit is None:
        for quantity in run:
            if quantity.unit is None:
                quantity.unit = unit
            else:
                unit = quantity.unit


def troy(quantity: DimensionQuantity, notes: list[DimensionNote] | None = None) -> None:
    """Read a quantity in ounces as troy ounces.

    Parameters
    ----------
    quantity : Quantity
        Changed in place.
    notes : list of Note, or None
        Where it is told, if anywhere.
    """
    quantity.unit = units()["oz t"]
    if notes is not None:
        message = "ounces are read as troy ounces, which the grams beside them bear out"
        notes.append(DimensionNote("unit", message, quantity.start, quantity.end))
