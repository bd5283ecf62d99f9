r"""Generic models 3 and 6: stress at a critical section, rigid and flexible.

With the mass m above a section of area A_s and modulus S, and the lever l from it to the centre of gravity,

.. math::

    \sigma = K \frac{m A\, l}{S} \mp \frac{m g}{A_s}, \qquad \tau = \frac{m A}{A_s}

where A is the peak acceleration of a rigid object, and of a flexible one the pseudo-acceleration of its oscillator,
PSA(f, zeta); of a frequency that is known as a range the largest over that.  A factor K multiplies the bending where a
held base concentrates it.  The static tilt with the same effect is arcsin(A / g).

Where the section is assumed to be solid and the thing may be hollow (sheet, a casting), its section shrinks with its
mass: below m_s, the mass of the thing with that section solid, m / A_s and m / S stay what they are at m_s.  A tube
bears up to twice that; thin walls buckle and tear at joins, so none of it is counted.

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.3, 2.5 and 2.6.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from pipeline.models.band import MISSED, OVER, band_accelerations, pseudo_accelerations
from pipeline.models.common import N_, NO_TILT, ROUNDING, largest_push, needs, smallest_push
from pipeline.models.horizontal_isolator import DAMPING, FREQUENCY
from pipeline.models.oscillator import OSCILLATES, PROMISED
from pipeline.quantities import Array, G, Quantity
from pipeline.records import Bounds, Columns, Excitation, Item, Model, Scene, Support, Trials
from pipeline.records import phrases as say

RIGID_PERIOD = 0.06
"""Period [s] up to which ASCE 7 calls a component rigid."""

RIGID_FREQUENCY = 33.0
"""Frequency [Hz] at which charts show a rigid object: the response spectrum has come down to A_max there."""

_SECTION = (
    Quantity("mass", "kg", "of the part above the critical section", 0.0, exclusive=True),
    Quantity("lever", "m", "from the section to the centre of gravity of that part", 0.0),
    Quantity("area", "m2", "of the critical section", 0.0, exclusive=True),
    Quantity("section_modulus", "m3", "of the critical section", 0.0, exclusive=True),
    Quantity(
        "solid_mass",
        "kg",
        "below which the section shrinks as the mass does: hollow things",
        0.0,
        optional=True,
        default=0.0,
    ),
    Quantity(
        "concentration", "-", "largest over nominal bending stress, at a held base", 1.0, optional=True, default=1.0
    ),
)
_HIGHEST = Quantity(
    "frequency_high", "Hz", "upper end of the band that is searched, from the frequency on", 0.0, exclusive=True,
    optional=True,
)  # fmt: skip
_STRESSES = (
    Quantity("tension", "Pa", "largest tensile stress: bending less self-weight"),
    Quantity("compression", "Pa", "largest compressive stress: bending plus self-weight"),
    Quantity("shear", "Pa", "average over the section"),
    Quantity("tilt", "deg", "static tilt with the same effect: sin(tilt) = A_max / g"),
)


_AXES = ({"section_modulus": "section_modulus_width"}, {"section_modulus": "section_modulus_depth"})


def section_stresses(push: Array, parameters: Mapping[str, Array]) -> Columns:
    """Return the stresses and the equivalent tilt under a horizontal acceleration.

    Parameters
    ----------
    push : ndarray, shape (n,) or float
        [m/s2].
    parameters : mapping of str to ndarray, shape (n,)
        mass and solid_mass [kg], lever [m], area [m2], section_modulus [m3] and concentration [-].

    Returns
    -------
    Columns
        tension, compression, shear and error [Pa], tilt [deg], note, (n,) each; the tilt is NaN from 1 g on, where none
        reproduces the acceleration.
    """
    mass, area = np.maximum(parameters["mass"], parameters["solid_mass"]), parameters["area"]
    bending = parameters["concentration"] * mass * push * parameters["lever"] / parameters["section_modulus"]
    weight = mass * G / area
    share = push / G
    too_much = share >= 1.0
    tilt = np.degrees(np.arcsin(np.where(too_much, 0.0, share)))
    tension, compression = bending - weight, bending + weight
    return {
        "tension": tension,
        "compression": compression,
        "shear": mass * push / area,
        "tilt": np.where(too_much, np.nan, tilt),
        # Tension is a difference: its error is of the size of what is subtracted.
        "error": ROUNDING * compression,
        "note": np.where(too_much, float(NO_TILT), 0.0),
    }


def _run(
    motion: Excitation,
    parameters: Mapping[str, Array],
    refine: int,  # noqa: ARG001
    estimate: bool,  # noqa: ARG001
) -> Columns:
    return section_stresses(parameters["amplification"] * largest_push(motion), parameters)


def _pushes(motion: Excitation, parameters: Mapping[str, Array]) -> tuple[Array, Array]:
    """Return the least and the largest pseudo-acceleration [m/s2], (n,) each: of one frequency the same.

    In two directions those of the worst of all.
    """
    low, high, zeta = (parameters[name] for name in ("frequency", "frequency_high", "damping"))
    # What is known as one frequency, if only as the best estimate of a range, is run at that.
    banded = high > low
    least, most = np.empty_like(low), np.empty_like(low)
    least[~banded] = most[~banded] = pseudo_accelerations(motion, low[~banded], zeta[~banded])
    least[banded], most[banded] = band_accelerations(motion, low[banded], high[banded], zeta[banded])
    return least, most


def _run_flexible(
    motion: Excitation,
    parameters: Mapping[str, Array],
    refine: int,  # noqa: ARG001
    estimate: bool,  # noqa: ARG001
) -> Columns:
    least, push = _pushes(motion, parameters)
    out = section_stresses(push, parameters)
    error, note = out.pop("error"), out.pop("note")
    error += np.where(parameters["frequency_high"] > parameters["frequency"], OVER * out["compression"], 0.0)
    lowest = section_stresses(least, parameters)["tension"]
    return {**out, "pseudo_acceleration": push, "tension_least": lowest, "error": error, "note": note}


def _screen(motion: Excitation, parameters: Mapping[str, Array]) -> Columns:
    return _run(motion, parameters, 1, False)


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    # Along one direction both pushes are the same and the bound is the stress itself.
    least, most = (
        section_stresses(parameters["amplification"] * push(motion), parameters)
        for push in (smallest_push, largest_push)
    )
    return Bounds({q.name: (least[q.name], most[q.name]) for q in _STRESSES}, most["note"])


def _bound_flexible(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    # Along one direction the bound is the stress itself, and of all directions it is the worst of them.
    single = ~(parameters["frequency_high"] > parameters["frequency"])
    sides = 1.0 - np.where(single, PROMISED, OVER), 1.0 + np.where(single, PROMISED, MISSED)
    least, most = _pushes(motion, parameters)
    low, high = (section_stresses(side * most, parameters) for side in sides)
    ends = {q.name: (low[q.name], high[q.name]) for q in _STRESSES}
    lowest, highest = (section_stresses(side * least, parameters)["tension"] for side in sides)
    ends |= {"tension_least": (lowest, highest), "pseudo_acceleration": (sides[0] * most, sides[1] * most)}
    if motion.y is None:
        return Bounds(ends, high["note"])
    none = section_stresses(np.zeros_like(most), parameters)
    anyhow = {name: (none.get(name, np.zeros_like(most)), up) for name, (_, up) in ends.items()}
    anyhow["tension_least"] = (none["tension"], highest)
    return Bounds(anyhow, high["note"], {name: low for name, (low, _) in ends.items()})


def _say(row: Mapping[str, float], _parameters: Mapping[str, float]) -> str:
    if np.isnan(row["tilt"]):
        return say.NO_TILT()
    return say.TILT_TEST(tilt=row["tilt"])


def _mark(frequency: float, parameters: Mapping[str, float], tension: float) -> tuple[str, float, float] | None:
    # The acceleration behind a tension: the inverse of section_stresses; none where nothing is above the section.
    mass = max(parameters["mass"], parameters["solid_mass"])
    moment = parameters["concentration"] * mass * parameters["lever"]
    if moment <= 0.0:
        return None
    weight = mass * G / parameters["area"]
    return "spectrum", frequency, (tension + weight) * parameters["section_modulus"] / moment


def _holds(scene: Scene, flexible: bool) -> str:
    if scene.support in (Support.HUNG, Support.SUSPENDED):
        return N_("it hangs: its own weight is all that its section bears")
    missing = needs(scene, "mass", "lever", "area", "section_modulus", "allowable_stress")
    if missing:
        return f"its critical section is not known ({missing})"
    frequency = scene.parameters.get("frequency")
    # Where it may be either, the flexible one has both: over the whole range of its frequency.
    bends = frequency is not None and frequency.low < 1.0 / RIGID_PERIOD
    if flexible and not bends:
        return N_("it is rigid: no natural period above 0.06 s is known or estimated")
    if not flexible and bends:
        return N_("it is flexible: the dynamic stress model takes its place")
    return ""


def _stands(_item: Item, _object_class: str, models: Sequence[str]) -> bool:
    # Its frequency, recorded, stated or estimated, says which of the two it is (see _holds).
    return "sliding" in models or STRESS.name in models


_RANGES = {
    "mass": (1.0, 100.0),
    "lever": (0.05, 1.0),
    "area": (1e-4, 1e-2),
    "section_modulus": (1e-6, 1e-3),
}

_LOOSE = N_("it is free to move instead")

_BENDS = (
    "Its base taken as held while it bends, its critical section reaches {demand} ({low} to {high}); {capacity} is "
    "allowed."
)

_SENTENCE = "Held at its base, its critical section reaches {demand} ({low} to {high}); {capacity} is allowed."

STRESS = Model(
    name="stress",
    title="Stress",
    kind="rigid",
    source="Agbabian et al. 1991, sec. 2.3",
    equation="F = m A_max; sigma = K M/S -/+ N/A",
    needs=(*_SECTION, Quantity("amplification", "-", "of A_max", 0.0, optional=True, default=1.0)),
    gives=_STRESSES,
    directions=1,
    axes=_AXES,
    run=_run,
    screen=_screen,
    say_screen=_say,
    bound=_bound,
    certificate=lambda motion, parameters: _run(motion, parameters, 1, False)["tension"],
    exact=True,
    uncharted="its closed form costs less than a lookup",
    mark=lambda parameters, demand: _mark(RIGID_FREQUENCY, parameters, demand),
    demand="tension",
    capacity="allowable_stress",
    applies=lambda scene: _holds(scene, flexible=False),
    sentence=_SENTENCE,
    fails="breaks",
    trials=Trials(ranges=_RANGES),
    listed="Table 1, Rigid: Stress, static",
    supports=(Support.FASTENED, Support.ISOLATED),
    unasked=_LOOSE,
)

FLEXIBLE_STRESS = Model(
    name="flexible_stress",
    title="Dynamic stress",
    kind="flexible",
    source="Agbabian et al. 1991, sec. 2.5",
    equation="sigma = K M/S -/+ N/A under F = m PSA(f, zeta), the largest over the range of f",
    needs=(*_SECTION, FREQUENCY, DAMPING, _HIGHEST),
    gives=(
        *_STRESSES,
        Quantity("pseudo_acceleration", "m/s2", "peak of the damped oscillator that takes A_max's place"),
        Quantity("tension_least", "Pa", "least over the band of frequencies of what the tension is the largest of"),
    ),
    searched={"frequency": "frequency_high"},
    least="tension_least",
    directions=1,
    resultant=True,
    axes=_AXES,
    run=_run_flexible,
    bound=_bound_flexible,
    say_screen=_say,
    mark=lambda parameters, demand: _mark(parameters["frequency"], parameters, demand),
    uncharted=OSCILLATES,
    demand="tension",
    capacity="allowable_stress",
    applies=lambda scene: _holds(scene, flexible=True),
    sentence=_BENDS,
    at_most=(
        "Its base taken as held while it bends, its critical section reaches at most {demand} (at most {high}, its "
        "measures being uncertain); {capacity} is allowed."
    ),
    fails="breaks",
    trials=Trials(ranges={**_RANGES, "frequency": (1.0, 16.0), "damping": (0.01, 0.05)}),
    listed="Table 1, Flexible: Stress, dynamic",
    supports=(Support.FASTENED, Support.ISOLATED),
    joins=_stands,
)
