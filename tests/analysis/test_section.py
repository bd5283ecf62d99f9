"""The critical section of an object."""

from math import pi

import pytest

from pipeline.analysis.section import Section, section_properties
from pipeline.records import Estimate


@pytest.mark.parametrize(
    ("shape", "width", "depth", "count", "wall", "area", "modulus"),
    [
        ("round", 0.1, 0.1, 1, 0.0, pi * 0.05**2, pi * 0.1**3 / 32),
        ("round", 0.1, 0.1, 2, 0.0, 2 * pi * 0.05**2, 2 * pi * 0.1**3 / 32),
        ("round", 0.1, 0.1, 1, 0.01, pi * (0.05**2 - 0.04**2), pi * (0.1**4 - 0.08**4) / (32 * 0.1)),
        ("rectangle", 0.2, 0.1, 1, 0.0, 0.02, 0.2 * 0.1**2 / 6),
        ("rectangle", 0.1, 0.2, 1, 0.0, 0.02, 0.2 * 0.1**2 / 6),
        ("rectangle", 0.2, 0.1, 1, 0.01, 0.02 - 0.18 * 0.08, (0.2 * 0.1**3 - 0.18 * 0.08**3) / (6 * 0.1)),
        ("ring", 0.01, 0.1, 1, 0.1, pi * (0.05**2 - 0.04**2), pi * (0.1**4 - 0.08**4) / (32 * 0.1)),
    ],
)
def test_section_properties(
    shape: str, width: float, depth: float, count: int, wall: float, area: float, modulus: float
) -> None:
    """Textbook: A and S of circle, tube, rectangle and box; the weaker axis counts; equal legs bend side by side."""
    assert section_properties(shape, width, depth, count, wall) == pytest.approx((area, modulus), rel=1e-12)


def test_an_unknown_section_is_refused() -> None:
    with pytest.raises(ValueError, match="section_shape 'star' is not known"):
        section_properties("star", 0.1, 0.1, 1, 0.0)


@pytest.mark.parametrize(
    ("shape", "width", "depth", "count", "wall", "inertia"),
    [
        ("round", 0.1, 0.1, 2, 0.0, 2 * pi * 0.1**4 / 64),
        ("hollow round", 0.1, 0.1, 1, 0.01, pi * (0.1**4 - 0.08**4) / 64),
        ("rectangle", 0.2, 0.1, 4, 0.0, 4 * 0.2 * 0.1**3 / 12),
        ("rectangle", 0.1, 0.2, 1, 0.01, (0.2 * 0.1**3 - 0.18 * 0.08**3) / 12),
        ("ring", 0.01, 0.1, 1, 0.1, pi * (0.1**4 - 0.08**4) / 64),
    ],
)
def test_second_moment_of_area(shape: str, width: float, depth: float, count: int, wall: float, inertia: float) -> None:
    """Textbook: of circle, tube, rectangle and box, about the weaker axis."""
    section = Section(shape, Estimate.measured(width, "m"), Estimate.measured(depth, "m"), count, wall, "")
    assert section.inertia("value") == pytest.approx(inertia, rel=1e-12)
