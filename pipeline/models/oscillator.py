r"""The damped oscillator: response spectra, flexible plinths, and the core of two models.

.. math::

    u'' + 2 \zeta \omega u' + \omega^2 u = -a

by the recursion that is exact for an excitation that is linear between its samples.

References
----------
Nigam, N. C. and Jennings, P. C. (1969). Calculation of response spectra from strong-motion earthquake records. Bulletin
of the Seismological Society of America 59.
"""

from collections.abc import Mapping

import numpy as np

from pipeline.errors import InputError
from pipeline.kernels import samples
from pipeline.kernels.oscillator import oscillator_batch, oscillator_history
from pipeline.kernels.resultant import resultant_batch
from pipeline.models.common import N_, ROUNDING, after_record, curve, grid, shared
from pipeline.models.horizontal_isolator import DAMPING, FREQUENCY
from pipeline.quantities import Array, Quantity
from pipeline.records import Axis, Bounds, Chart, Columns, Excitation, Figure, Model, Motion, Scene, Trials
from pipeline.records import picture as on_chart

MOST_PHASE = 2e6
"""Radians of an oscillator's own, its damping counted in, in a sample interval from which on it is refused."""

PROMISED = 1e-9
"""Relative error that the recursion promises; a bound is looser by it."""

OSCILLATES = "its recursion is exact and fast, its spectrum so jagged that a chart takes thousands of analyses"
"""Why what follows a response spectrum is not tabulated."""

EXTREMES = grid(frequency=[0.02, 1.0, 20.0, 500.0], damping=[0.0, 1.0, 2.0])


def oscillate(motion: Excitation, w: Array, zeta: Array, share: Array) -> tuple[Array, Array]:
    """Return the largest |u| and |a + share u''| of n oscillators.

    Parameters
    ----------
    motion : Excitation
        Along one direction.
    w, zeta, share : ndarray, shape (n,)
        Natural frequency [rad/s], damping ratio [-], share of u'' that is felt [-].

    Returns
    -------
    displacement, acceleration : ndarray, shape (n,)
        [m], [m/s2].

    Raises
    ------
    InputError
        For an oscillator that turns more than MOST_PHASE in a sample interval.
    """
    _check_phase(motion, w, zeta)
    max_u, max_y = np.empty(w.size), np.empty(w.size)
    tail = -1.0 if motion.tail is None else float(motion.tail)
    arrays = [np.ascontiguousarray(p, dtype=np.float64) for p in (w, zeta, share)]
    x = samples(motion.x)

    def run(part: slice) -> None:
        oscillator_batch(x, motion.dt, *(p[part] for p in arrays), tail, max_u[part], max_y[part])

    shared(run, w.size, x.size)
    return max_u, max_y


def oscillate_any(motion: Excitation, w: Array, zeta: Array) -> Array:
    """Return the largest displacement of n oscillators, shaken in two directions the longest resultant (RotD100).

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.
    w, zeta : ndarray, shape (n,)
        As in `oscillate`.

    Returns
    -------
    ndarray, shape (n,)
        [m].

    Raises
    ------
    InputError
        As `oscillate`.
    """
    if motion.y is None:
        return oscillate(motion, w, zeta, np.ones_like(w))[0]
    _check_phase(motion, w, zeta)
    most, angle = np.empty(w.size), np.empty(w.size)
    tail = -1.0 if motion.tail is None else float(motion.tail)
    arrays = [np.ascontiguousarray(p, dtype=np.float64) for p in (w, zeta)]
    x, y = samples(motion.x), samples(motion.y)

    def run(part: slice) -> None:
        resultant_batch(x, y, motion.dt, *(p[part] for p in arrays), tail, most[part], angle[part])

    shared(run, w.size, x.size)
    return most


def _check_phase(motion: Excitation, w: Array, zeta: Array) -> None:
    phase = w * (1.0 + 2.0 * zeta) * motion.dt
    if phase.max(initial=0.0) > MOST_PHASE:
        at = int(np.argmax(phase))
        raise InputError(
            f"frequency {w[at] / (2.0 * np.pi):g} Hz at a damping of {zeta[at]:g} is too high for a time step of "
            f"{motion.dt:g} s (entry {at}): what lies between two samples would be searched for ever"
        )


Between = tuple[Array, Array]


def oscillate_bounds(motion: Excitation, w: Array, zeta: Array, share: Array) -> tuple[Between, Between]:
    """Return what the largest |u| and |a + share u''| of n oscillators lie between.

    The oscillator is linear: shaken along any direction it answers with the components of its answers to x and to y, so
    that their peaks' resultant bounds every direction, for the cost of two.  Along one direction both bounds are the
    answer itself.

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.
    w, zeta, share : ndarray, shape (n,)
        As in `oscillate`.

    Returns
    -------
    displacement, acceleration : tuple of two ndarray, shape (n,)
        Low and high [m], [m/s2].
    """
    peaks = oscillate(motion, w, zeta, share)
    if motion.y is None:
        low, high = peaks, peaks
    else:
        across = Excitation(motion.dt, motion.y, None, motion.z, motion.tail)
        others = oscillate(across, w, zeta, share)
        low = (np.zeros_like(w), np.zeros_like(w))
        high = (np.hypot(peaks[0], others[0]), np.hypot(peaks[1], others[1]))
    down, up = 1.0 - PROMISED, 1.0 + PROMISED
    return (down * low[0], up * high[0]), (down * low[1], up * high[1])


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    w = 2.0 * np.pi * parameters["frequency"]
    displacement, absolute = oscillate_bounds(motion, w, parameters["damping"], np.ones_like(w))
    pseudo = (w**2 * displacement[0], w**2 * displacement[1])
    bounds = {"displacement": displacement, "pseudo_acceleration": pseudo, "absolute_acceleration": absolute}
    return Bounds(bounds, np.zeros_like(w))


def _run(
    motion: Excitation,
    parameters: Mapping[str, Array],
    refine: int,  # noqa: ARG001
    estimate: bool,  # noqa: ARG001
) -> Columns:
    w = 2.0 * np.pi * parameters["frequency"]
    displacement, absolute = oscillate(motion, w, parameters["damping"], np.ones_like(w))
    return {
        "displacement": displacement,
        "pseudo_acceleration": w**2 * displacement,
        "absolute_acceleration": absolute,
        "error": ROUNDING * displacement,
        "note": np.zeros_like(w),
    }


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    history = np.zeros((motion.x.size + after_record(motion), 2))
    w = 2.0 * np.pi * parameters["frequency"]
    oscillator_history(samples(motion.x), motion.dt, w, parameters["damping"], 1.0, history)
    # history holds a + u'' with the sign of the base's acceleration.
    return {"u_x": history[:, 0], "a_x": history[:, 1]}


def _applies(_scene: Scene) -> str:
    return N_("a building block of other models and of response spectra, not an object")


SPECTRUM_FREQUENCIES = np.round(np.geomspace(0.2, 50.0, 96), 4)


def _spectrum(key: str, motion: Motion) -> Chart:
    curves = []
    for label, angle in ((on_chart.EAST, 0.0), (on_chart.NORTH, 90.0)):
        for damping in (0.02, 0.05):
            given = {"frequency": SPECTRUM_FREQUENCIES, "damping": np.full_like(SPECTRUM_FREQUENCIES, damping)}
            felt = _run(motion.excitation(angle), given, 1, False)["pseudo_acceleration"]
            curves.append(curve(label(damping=damping), SPECTRUM_FREQUENCIES, felt))
    return Chart(
        key,
        N_("Acceleration felt by a flexible object"),
        N_("Pseudo-acceleration of an oscillator; a rigid object (33 Hz and more) feels the peak acceleration."),
        Axis(N_("Natural frequency"), "Hz", "log"),
        Axis(N_("Pseudo-acceleration"), "m/s2"),
        tuple(curves),
        source="Agbabian et al. 1991, sec. 2.5; Nigam and Jennings 1969",
    )


OSCILLATOR = Model(
    name="oscillator",
    title="Oscillator",
    kind="flexible",
    source="Nigam and Jennings 1969 (exact for piecewise-linear input)",
    equation="u'' + 2 zeta w u' + w^2 u = -a",
    needs=(FREQUENCY, DAMPING),
    gives=(
        Quantity("displacement", "m", "largest |u|"),
        Quantity("pseudo_acceleration", "m/s2", "w^2 times the displacement"),
        Quantity("absolute_acceleration", "m/s2", "largest |a + u''|"),
    ),
    directions=1,
    run=_run,
    trace=_trace,
    bound=_bound,
    uncharted=OSCILLATES,
    demand="displacement",
    capacity="clearance",
    applies=_applies,
    sentence="It moves {demand} against its base; there is room for {capacity}.",
    fails="moves too far",
    trials=Trials(
        ranges={"frequency": (0.5, 20.0), "damping": (0.01, 0.1)},
        extremes=EXTREMES,
        sample={"frequency": 100.0, "damping": 0.02},
        promised=1e-9,
    ),
    pictures=(Figure("spectrum", _spectrum),),
)
