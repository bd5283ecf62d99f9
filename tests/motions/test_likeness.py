"""Peaks that magnitude and distance let expect, against published values; and records that are far from them."""

import re
from math import exp, hypot, log

import numpy as np
import pytest

from pipeline.motions.attenuation import PGA, PGV, expected
from pipeline.motions.doubts import doubts
from pipeline.motions.likeness import FAR, unlike
from pipeline.motions.record import EventTable, Record
from pipeline.motions.site import motions_of
from pipeline.quantities import G
from pipeline.records import Motion
from tests.motions.conftest import tone


@pytest.mark.parametrize(
    ("magnitude", "distance", "speed", "pgv", "pga"),
    [
        (3.0, 0.0, 200.0, 0.263499, 0.0148493),
        (3.0, 100.0, 760.0, 0.000854192, 3.85392e-05),
        (4.0, 20.0, 200.0, 0.360322, 0.00931869),
        (4.0, 75.0, 250.0, 0.0459132, 0.0010789),
        (7.0, 0.0, 600.0, 51.0217, 0.494074),
        (7.0, 20.0, 250.0, 25.092, 0.211924),
        (8.0, 0.0, 200.0, 105.612, 0.496188),
        (8.0, 50.0, 400.0, 18.7777, 0.153627),
        (8.0, 100.0, 760.0, 5.90656, 0.0548791),
    ],
)
def test_medians_are_those_that_the_authors_program_prints(magnitude, distance, speed, pgv, pga):
    # As OpenQuake keeps them for its own test of the model with an unspecified mechanism (BSSA_2014_NOSOF_MEAN.csv).
    assert expected(PGV, magnitude, distance, speed)[0] == pytest.approx(pgv, rel=1e-5)
    assert expected(PGA, magnitude, distance, speed)[0] == pytest.approx(pga, rel=1e-5)


def test_the_spread_is_that_of_the_spreadsheet_of_nga_west2():
    # Of both of its cases, 6.0 at 1 km on 300 m/s and 7.1 at 2 km on 450 m/s.
    assert expected(PGA, 6.0, 1.0, 300.0)[1] == pytest.approx(0.6050859443087403, rel=1e-12)
    assert expected(PGA, 7.1, 2.0, 450.0)[1] == pytest.approx(0.6050859443087403, rel=1e-12)
    # Equations 13 to 17 by hand: at 300 km all of the far term, on 200 m/s all of that of soft ground.
    assert expected(PGA, 7.0, 300.0, 200.0)[1] == pytest.approx(hypot(0.348, 0.495 + 0.1 - 0.07), rel=1e-12)
    assert expected(PGV, 4.0, 50.0, 760.0)[1] == pytest.approx(hypot(0.401, 0.644), rel=1e-12)


def record(magnitude, distance, depth=8.0):
    event = EventTable(magnitude=magnitude, depth_km=depth)
    return Record.model_construct(event=event, distance_km=distance)


def shaking(pga, frequency=3.0):
    row = pga / np.abs(tone(frequency=frequency)).max() * tone(frequency=frequency)
    return Motion(0.01, [row, row, 0.5 * row])


USUAL = expected(PGA, 6.0, 40.0, 400.0)[0] * G


@pytest.mark.parametrize("factor", [1 / 3, 1.0, 3.0])
def test_what_is_as_strong_as_its_earthquake_makes_it_passes(factor):
    assert unlike(shaking(factor * USUAL), None, record(6.0, 40.0)) is None


@pytest.mark.parametrize(
    ("factor", "side", "guess"),
    [
        (100.0, "above", "as cm/s2 called m/s2 are: times 0.01 "),
        (0.01, "below", "as m/s2 called cm/s2 are: times 100 "),
        (981.0, "above", "as cm/s2 called g are: times 0.00102 "),
    ],
)
def test_a_wrong_unit_is_doubted_with_what_it_may_be(factor, side, guess):
    said = unlike(shaking(factor * USUAL), None, record(6.0, 40.0))
    assert said is not None
    assert f"standard deviations {side} what shallow earthquakes of magnitude 6 make 40 km away" in said
    assert guess in said
    assert "--unit of `kouros motions add`" in said
    assert doubts([said]) == (said,)


def test_how_far_off_it_is_follows_from_the_model():
    said = unlike(shaking(50.0 * USUAL), None, record(6.0, 40.0))
    far = [float(found) for found in re.findall(r"is (\d+\.\d) standard deviations", said or "")]
    # The nearest place of its rupture, 12.6 km long (Wells and Coppersmith), with the spread of an unknown ground.
    median, spread = expected(PGA, 6.0, 40.0 - 10.0 ** (0.59 * 6.0 - 2.44), 400.0)
    of_pga = log(50.0 * USUAL / G / median) / hypot(spread, 0.3)
    assert far == [pytest.approx(of_pga, abs=0.05)]
    assert of_pga > FAR


def test_a_factor_of_981_is_doubted_where_the_record_is_not_by_chance_on_the_other_side():
    strong = 9.81 * exp(0.3) * USUAL
    said = unlike(shaking(strong), None, record(6.0, 40.0))
    assert said is not None
    assert "as m/s2 called g are: times 0.102 " in said


@pytest.mark.parametrize(
    "known",
    [record(None, 40.0), record(6.0, None), record(6.0, 40.0, 90.0), record(6.0, 900.0), record(2.0, 40.0)],
    ids=["no magnitude", "no distance", "slab", "far", "small"],
)
def test_nothing_is_said_where_nothing_is_known(known):
    assert unlike(shaking(100.0 * USUAL), None, known) is None
    assert unlike(shaking(100.0 * USUAL), None, Record.model_construct(event=None, distance_km=10.0)) is None


def test_the_doubt_stands_among_the_steps_of_a_sites_motion_and_is_of_what_was_recorded(three, write_manifest):
    three()
    told = {"event": {"magnitude": 5.0, "depth_km": 10}, "distance_km": 150.0, "scale": 0.01}
    (motion,) = motions_of(write_manifest(**told))
    # Velocities of 1 and 2 m/s2 at 1 Hz before they are scaled: 16 and 32 cm/s, whose geometric mean is 22.5.
    assert any("its PGV of 22 cm/s is " in doubt or "its PGV of 23 cm/s is " in doubt for doubt in doubts(motion.steps))
