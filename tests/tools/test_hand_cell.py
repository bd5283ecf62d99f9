"""Numbers as people write them: what each says is arithmetic with fractions, and what may be two is refused."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.collection.hand_cell import of_hand
from pipeline.errors import InputError

METRES = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "in": Fraction(254, 10_000),
          "ft": Fraction(3048, 10_000)}  # fmt: skip
KILOGRAMS = {"kg": Fraction(1), "g": Fraction(1, 1000), "lb": Fraction(45_359_237, 10**8)}
SIGNS = {"in": ('"', " in", " in.", "in", " inches"), "ft": ("'", " ft", " ft."), "cm": ("cm", " cm"),
         "mm": ("mm", " mm"), "m": (" m", "m"), "kg": ("kg", " kg"), "g": (" g",), "lb": (" lb", " lbs")}  # fmt: skip
VULGAR = {"½": Fraction(1, 2), "¼": Fraction(1, 4), "¾": Fraction(3, 4), "⅛": Fraction(1, 8), "⅞": Fraction(7, 8)}
ABOUT = ("", "about ", "ca. ", "c. ", "~", "≈ ", "circa ", "approx. ")


@st.composite
def numbers(draw: st.DrawFn) -> tuple[str, Fraction]:
    """A number as somebody writes it, and what it is."""
    kind = draw(st.sampled_from(["whole", "decimal", "fraction", "vulgar", "bare"]))
    whole = draw(st.integers(1, 900))
    if kind == "whole":
        return str(whole), Fraction(whole)
    if kind == "decimal":
        # Three figures behind a comma may be thousands.
        figures = draw(st.integers(0, 99))
        return f"{whole}{draw(st.sampled_from('.,'))}{figures:02d}", whole + Fraction(figures, 100)
    if kind == "vulgar":
        sign, part = draw(st.sampled_from(list(VULGAR.items())))
        return f"{whole}{draw(st.sampled_from(['', ' ']))}{sign}", whole + part
    below = draw(st.sampled_from([2, 4, 8, 16, 32]))
    above = draw(st.integers(1, below - 1))
    bar = draw(st.sampled_from("/⁄"))
    if kind == "bare":
        return f"{above}{bar}{below}", Fraction(above, below)
    return f"{whole}{draw(st.sampled_from([' ', '-']))}{above}{bar}{below}", whole + Fraction(above, below)


@given(numbers(), st.sampled_from(sorted(METRES | KILOGRAMS)), st.sampled_from(ABOUT), st.sampled_from(["", " ?"]))
def test_a_number_without_a_unit_is_in_that_of_the_cell(
    number: tuple[str, Fraction], unit: str, about: str, doubt: str
) -> None:
    text, value = number
    found = of_hand(f"{about}{text}{doubt}", unit)
    assert found.value == float(value * (METRES | KILOGRAMS)[unit])
    assert (found.about, found.named) == (bool(about or doubt), False)


@given(numbers(), st.data(), st.sampled_from(ABOUT))
def test_a_number_with_a_unit_is_in_its_own(number: tuple[str, Fraction], data: st.DataObject, about: str) -> None:
    text, value = number
    kind = data.draw(st.sampled_from([METRES, KILOGRAMS]))
    unit, cell = (data.draw(st.sampled_from(sorted(kind))) for _ in range(2))
    found = of_hand(f"{about}{text}{data.draw(st.sampled_from(SIGNS[unit]))}", cell)
    # Rounded once more than exact arithmetic, at most.
    assert found.value == pytest.approx(float(value * kind[unit]), rel=1e-15, abs=0.0)
    assert (found.about, found.named) == (bool(about), True)


@given(numbers(), st.sampled_from(["-", "deg", "Hz"]))
def test_what_is_neither_a_length_nor_a_mass_is_that_number(number: tuple[str, Fraction], unit: str) -> None:
    assert of_hand(number[0], unit).value == float(number[1])


@given(numbers(), numbers(), st.sampled_from([" ", ", ", "; ", "/", "-", " - ", " x ", " to ", " or ", "..", " + "]),
       st.sampled_from(["in", "cm", "kg", "-", "deg"]))  # fmt: skip
def test_two_numbers_are_never_one(
    one: tuple[str, Fraction], other: tuple[str, Fraction], between: str, unit: str
) -> None:
    """Whatever parts them, unless both together are a whole number and its fraction."""
    mixed = one[1].denominator == 1 and other[1] < 1 and between in (" ", "-", "/")
    ratio = between == "/" and one[0].isdigit() and other[0].isdigit()
    if mixed or ratio:
        return
    with pytest.raises(InputError):
        of_hand(f"{one[0]}{between}{other[0]}", unit)


@pytest.mark.parametrize(
    "text",
    ["", " ", "x", "30/40", "30/40 cm", "40/30 cm", "3/2 in",
     "1/0", "8 1/0", "8 17/16", "1/2/3", "8 1/2 1/4", "3..5", "3,,5", "1,234", "12,345 mm", "1 234",
     "1'000", "1’000 mm", "1.000.000", "1.000,5", "-3", "−3", "about -3", "10-12", "1e3", "inf", "nan", "3²", "³",
     '"8"', '12" x', "30 x 20", "(3)", "3 pcs", "3' 14\"", "1 m 250 cm", "3 lb 17 oz", "30 cm 20", "5 kg", "TRUE",
     "2031-05-01", "2031-05-01 00:00:00", "08:30", "=8", "8_000", "0x10", "30 \u200bcm", "9" * 61],
)  # fmt: skip
def test_what_may_be_something_else_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        of_hand(text, "in")


@given(st.text(max_size=70), st.sampled_from(["in", "kg", "-", "deg", "Hz", "Pa"]))
def test_whatever_stands_in_a_cell_is_a_finite_number_or_refused(text: str, unit: str) -> None:
    try:
        found = of_hand(text, unit)
    except InputError:
        return
    assert 0.0 <= found.value < float("inf")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [("30 %", "-", 0.3), ("12 MPa", "Pa", 12e6), ("250 kPa", "Pa", 250e3), ("8,5°", "deg", 8.5), ("2.5 Hz", "Hz", 2.5),
     ("5' 2 1/2\"", "in", 1.5875), ("1 m 20 cm", "in", 1.2), ("7 7/16 in. (18.9 cm)", "cm", 0.1889125),
     ("2/16cm", "m", 0.00125), ("3/4 in. ", "cm", 0.01905),
     ("0", "cm", 0.0), ("0 in", "cm", 0.0), ("٣ cm", "in", 0.03), ("１２", "cm", 0.12)],
)  # fmt: skip
def test_units_of_a_cell(text: str, unit: str, value: float) -> None:
    assert of_hand(text, unit).value == value


def test_a_negative_number_only_where_one_may_be_meant() -> None:
    assert of_hand("-30 cm", "m", signed=True).value == -0.3
    assert of_hand("−1/2", "deg", signed=True).value == -0.5
