"""A record's size held against what its magnitude and its distance let expect: what is far off is doubted."""

from __future__ import annotations

from math import exp, hypot, log, sqrt

import numpy as np

from pipeline.motions.attenuation import PGA, PGV, expected
from pipeline.motions.doubts import UNLIKE
from pipeline.motions.intensity import integrate
from pipeline.motions.record import Record
from pipeline.quantities import Array, G
from pipeline.records import Motion

FAR = 3.0
"""Standard deviations from which a peak is doubted.

Of 902 records of NGA-West2 that have 0.002 g none has more, and of 3,334 of Ridgecrest 2019 in gmprocess's flatfile
1.4 %, most of them of small shocks in whose window a larger one fell.  Of the same a factor of 9.81 is told in 57 and
62 %, of 1/9.81 in 36 and 41 %, of 100 in all, of 1/100 in 98 % and more.
"""

GROUND = (400.0, 0.3)
"""m/s and natural logarithm: shear-wave speed of a ground of which nothing is known, and what it adds to the spread."""

MAGNITUDES, FARTHEST, DEEPEST = (3.0, 8.5), 400.0, 50.0
"""Magnitudes, and distance and depth in km, for which it is known what to expect: below are earthquakes of slabs."""

USUAL_DEPTH = 20.0
"""km of an earthquake of which nobody says it (judgement): it counts only against records that are too weak."""

_MISTAKEN = (
    ("g", "m/s2", G), ("m/s2", "cm/s2", 100.0), ("g", "cm/s2", 100.0 * G), ("m/s2", "mm/s2", 1000.0),
    ("g", "mg", 1000.0),
)  # fmt: skip
"""Units that are taken one for the other, the larger first, and the factor between them."""


def unlike(motion: Motion, velocity: Array | None, record: Record) -> str | None:
    """Say that a record is far stronger or weaker than its magnitude and distance let expect; None where it is not.

    The distance that a record tells is mostly that from the epicentre.  What is too strong is held against the distance
    from the end of a rupture that begins there and runs towards the station, and what is too weak against that from the
    hypocentre: a distance from the rupture is between them.

    Parameters
    ----------
    motion : Motion
        On the ground, before it is scaled.
    velocity : array, shape (3, n), or None
        In m/s as its agency computed it.
    record : Record
        Of the manifest, with its earthquake and its distance.

    Returns
    -------
    str or None
        None also where magnitude or distance are not known, or outside of what the model was made for.

    References
    ----------
    Wells, D. L. and Coppersmith, K. J. (1994), BSSA 84, 974-1002: length of the rupture below ground, log10 L = -2.44 +
    0.59 M, for the distance; `attenuation.expected` for the peaks.
    """
    event, distance = record.event, record.distance_km
    if event is None or event.magnitude is None or distance is None or not motion.acceleration[:2].any():
        return None
    magnitude, depth = event.magnitude, USUAL_DEPTH if event.depth_km is None else max(event.depth_km, 0.0)
    if not MAGNITUDES[0] <= magnitude <= MAGNITUDES[1] or distance > FARTHEST or depth > DEEPEST:
        return None
    v = integrate(motion)[0] if velocity is None else velocity
    near, far = max(0.0, distance - 10.0 ** (0.59 * magnitude - 2.44)), hypot(distance, depth)
    worst, told = 0.0, ("", "", 0.0)
    # The model is of the median over all directions, which the geometric mean of two is close to.
    for name, unit, rows, of in (
        ("PGA", "g", motion.acceleration / G, PGA),
        ("PGV", "cm/s", 100.0 * v, PGV),
    ):
        peak = sqrt(float(np.prod(np.abs(rows[:2]).max(axis=1))))
        if peak <= 0.0:
            continue
        for sign, where in ((1.0, near), (-1.0, far)):
            median, spread = expected(of, magnitude, where, GROUND[0])
            off = sign * log(peak / median) / hypot(spread, GROUND[1])
            if off > worst:
                middle = (
                    f"{name} of {peak:.2g} {unit}",
                    f"{'at most' if sign > 0.0 else 'at least'} {median:.2g} {unit}",
                )
                worst, told = off, (*middle, log(peak / median))
    if worst <= FAR:
        return None
    what, usual, ratio = told
    side = "above" if ratio > 0.0 else "below"
    return (
        f"its {what} is {worst:.1f} standard deviations {side} what shallow earthquakes of magnitude {magnitude:g} "
        f"make {distance:g} km away (on average {usual}; Boore et al. 2014){_guessed(ratio)}{UNLIKE}"
    )


def _guessed(ratio: float) -> str:
    """Which unit that was taken for another brings a peak nearest to what is expected; "" where none does."""
    taken = min(_MISTAKEN, key=lambda one: abs(abs(ratio) - log(one[2])))
    if abs(abs(ratio) - log(taken[2])) > 1.2:
        return ""
    (was, called), factor = (taken[:2][::-1] if ratio > 0.0 else taken[:2]), exp(-np.sign(ratio) * log(taken[2]))
    return f", as {was} called {called} are: times {factor:.3g} it would be near it"
