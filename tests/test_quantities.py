"""Numbers are written as people write them."""

import pytest

from pipeline.quantities import figures


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1000.0, 3, "1000"),
        (2734.6, 3, "2730"),
        (12345.6, 4, "12350"),
        (999.96, 4, "1000"),
        (0.12345, 3, "0.123"),
        (42.0, 3, "42"),
        (-12345.0, 3, "-12300"),
        (1e12, 3, "1e+12"),
        (float("inf"), 3, "inf"),
    ],
)
def test_figures_have_no_exponent_where_people_write_none(value: float, digits: int, text: str) -> None:
    assert figures(value, digits) == text
