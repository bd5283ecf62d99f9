"""What the reader sees of a number; the truth is the definition of each unit."""

from math import inf, nan, pi

import pytest

from pipeline.report import ReportError, Units
from pipeline.report.units import by_hand, ratio


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.14, "m", "14\u202fcm"),
        (0.1234, "m", "12.3\u202fcm"),
        (-0.02, "m", "−2\u202fcm"),
        (0.7 * 9.80665, "m/s2", "0.7\u202fg"),
        (pi / 4, "rad", "45°"),
        (7.0e6, "Pa", "7\u202fMPa"),
        (0.5, "Hz", "0.5\u202fHz"),
        (0.62, "m/s", "62\u202fcm/s"),
        (2.5e-4, "m2", "2.5\u202fcm²"),
        (640.0, "N", "640\u202fN"),
        (1.234, "-", "1.2"),
        (0.0, "m", "0\u202fcm"),
        (inf, "m", "no limit (∞)"),
        (nan, "m", "not a number"),
        (None, "m", "not known"),
    ],
)
def test_numbers_in_the_readers_units(value: float | None, unit: str, text: str) -> None:
    assert Units().text(value, unit) == text


@pytest.mark.parametrize(
    ("metres", "up", "text"),
    [
        (0.0004, False, "0.04\u202fcm"),
        (0.0151, False, "1.5\u202fcm"),
        (0.336, False, "33.5\u202fcm"),
        (0.3351, True, "34\u202fcm"),
        (0.33503, True, "33.5\u202fcm"),
        (0.712, False, "71\u202fcm"),
        (1.424, False, "142\u202fcm"),
        (1.421, True, "143\u202fcm"),
    ],
)
def test_lengths_are_told_as_a_tape_is_read(metres: float, up: bool, text: str) -> None:
    """To a millimetre below 10 cm, half a centimetre below 1 m, a centimetre beyond; never less than was asked for."""
    assert by_hand(Units())("clearance" if up else "height", metres, "m") == text


def test_inches() -> None:
    assert Units("in").text(0.254, "m") == "10\u202fin"
    # 1 lbf is 4.448 N, 1 lbf ft 1.356 N m, 1 psi 6,895 Pa, by their definitions.
    assert Units("in").text(77.4, "N") == "17.4\u202flbf"
    assert Units("ft").text(20.8, "N m") == "15.3\u202flbf ft"
    assert Units("in").text(532e3, "Pa") == "77.2\u202fpsi"
    with pytest.raises(ReportError, match="furlong"):
        Units("furlong")


@pytest.mark.parametrize(
    ("low", "high", "text"),
    [
        (4.4e-10, 0.437, "0 to 43.7\u202fcm"),
        (5e-5, 0.53, "0 to 53\u202fcm"),
        (1e-5, 2e-5, "0.001 to 0.002\u202fcm"),
        (0.05, 60.0, "5 to 6000\u202fcm"),
    ],
)
def test_the_low_end_of_a_range_of_lengths_is_no_number_of_many_noughts(low: float, high: float, text: str) -> None:
    assert Units().pair(low, high, "m") == text
    assert Units().bare(low, high, "m") == text.removesuffix("\u202fcm")


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1.0, "1"), (2.0, "2"), (1.967, "2.0"), (1.02, "1.02"), (0.996, "0.996"), (123.4, "120")],
)
def test_a_ratio_never_hides_on_which_side_of_one_it_lies(value: float, text: str) -> None:
    assert ratio(value) == text


@pytest.mark.parametrize(("value", "side"), [(1 + 1e-9, "above"), (1 - 1e-9, "below")])
def test_a_ratio_a_hair_from_one_says_so_in_words(value: float, side: str) -> None:
    assert ratio(value) == f"just {side} 1"


def test_placeholders_are_filled_and_doubled_braces_kept() -> None:
    values = {"demand": (0.118, "m"), "capacity": (inf, "m")}
    filled = Units().fill("{{x}} slides {demand} of {capacity}", values, "here")
    assert filled == "{x} slides 11.8\u202fcm of no limit (∞)"


@pytest.mark.parametrize(
    "sentence",
    ["{other}", "{demand.__class__}", "{demand[0]}", "{demand!r}", "{demand:>99}", "{demand", "demand}", "{}", "{0}"],
)
def test_a_sentence_that_asks_for_anything_else_is_refused_by_name(sentence: str) -> None:
    with pytest.raises(ReportError, match="object 12"):
        Units().fill(sentence, {"demand": (1.0, "m")}, "object 12")
