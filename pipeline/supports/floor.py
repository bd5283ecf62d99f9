"""A floor of a building: how it carries a motion up, by a code's factor or by the modes of a beam."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from pipeline.errors import InputError
from pipeline.kernels import samples
from pipeline.kernels.oscillator import oscillator_history
from pipeline.quantities import Array
from pipeline.records import Motion
from pipeline.supports.refining import resampled

MODE_POINTS = 20
"""Corners of a computed floor's polygon in one period of its highest mode: a peak between two is 1.2 % low at most."""

MOST_REFINED = 16
"""Most samples of a computed floor's motion for one of the ground's that its modes alone ask for."""

_SHEAR_LIMIT = 650.0
_SETTLED = 0.01


def carried(
    motion: Motion,
    height_ratio: float,
    period: float | None = None,
    damping: float | None = None,
    stiffness_ratio: float | None = None,
    modes: int | None = None,
    refine: int = 1,
) -> Motion:
    """Return a motion of the ground as a floor feels it: by modes where they are given, else by the code's factor.

    Parameters
    ----------
    motion : Motion
        Of the ground.
    height_ratio, period, damping : float
        As `floor_motion`.
    stiffness_ratio : float, optional
        alpha0 of `beam_modes` [-].
    modes : int, optional
        How many; by modes where damping, stiffness_ratio and modes are given.
    refine : int
        Samples of the output for each that it has at least: those of the ground, and by modes MODE_POINTS in a period
        of the highest.

    Returns
    -------
    Motion
        By the factor without an error; by modes see `floor_motion`, and `refined` for how finely an error asks for.

    Raises
    ------
    InputError
        For a parameter outside its range, or where the method is only half described.

    References
    ----------
    ASCE/SEI 7-22 as `floor_factor`, or Miranda and Taghavi (2005) as `beam_modes`.
    """
    given = [value is not None for value in (damping, stiffness_ratio, modes)]
    if not any(given):
        return scale_to_floor(resampled(motion, refine), height_ratio, period)
    if period is None or damping is None or stiffness_ratio is None or modes is None:
        raise InputError("a floor by its modes needs period, damping, stiffness_ratio and modes, all four")
    shortest = period * float(beam_modes(stiffness_ratio, modes).period_ratios[-1])
    least = min(MOST_REFINED, max(1, ceil(MODE_POINTS * motion.dt / shortest)))
    return floor_motion(
        resampled(motion, least * refine), height_ratio, period, damping=damping, alpha0=stiffness_ratio, modes=modes
    )


def floor_factor(height_ratio: float, period: float | None = None) -> float:
    r"""Return the amplification of the ground's horizontal acceleration at a height in a building.

    .. math::

        H_f = 1 + a_1 \frac{z}{h} + a_2 \left(\frac{z}{h}\right)^{10}, \qquad
        a_1 = \min\left(\frac{1}{T_a}, 2.5\right), \quad a_2 = \max\left(0, 1 - \left(\frac{0.4}{T_a}\right)^2\right)

    and 1 + 2.5 z/h where the period is unknown.

    Parameters
    ----------
    height_ratio : float
        z/h, 0 at the base to 1 at the roof.
    period : float, optional
        T_a, the building's approximate fundamental period, s; None where it is unknown.

    Returns
    -------
    float
        H_f, dimensionless.

    Raises
    ------
    InputError
        For a ratio outside 0 to 1 or a period that is not above 0.

    References
    ----------
    ASCE/SEI 7-22, Minimum design loads and associated criteria for buildings and other structures, 13.3.1.1.
    """
    if not 0.0 <= height_ratio <= 1.0:
        raise InputError(f"height_ratio must be from 0 (base) to 1 (roof), not {height_ratio!r}")
    if period is None:
        return 1.0 + 2.5 * height_ratio
    _positive("period", period)
    a1 = min(1.0 / period, 2.5)
    a2 = max(0.0, 1.0 - (0.4 / period) ** 2)
    return 1.0 + a1 * height_ratio + a2 * height_ratio**10


def scale_to_floor(motion: Motion, height_ratio: float, period: float | None = None) -> Motion:
    """Return the motion of a floor by the factor method: horizontals times `floor_factor`, the vertical as it is.

    Parameters
    ----------
    motion : Motion
        Of the ground.
    height_ratio, period : float
        As `floor_factor`.

    Returns
    -------
    Motion
        Exact by the code; the factor is in its last step.

    Raises
    ------
    InputError
        As `floor_factor`.

    References
    ----------
    ASCE/SEI 7-22, as `floor_factor`.
    """
    factor = floor_factor(height_ratio, period)
    known = "unknown" if period is None else f"{period:g} s"
    step = (
        f"floor at z/h {height_ratio:g}, building period {known}: horizontals times {factor:.4g} (ASCE 7-22, 13.3.1.1)"
        f", vertical unchanged; exact"
    )
    by = np.array([factor, factor, 1.0])
    data = motion.acceleration * by[:, None]
    v_max = None if motion.v_max is None else factor * motion.v_max
    return Motion(motion.dt, data, motion.name, (*motion.steps, step), motion.source, by * motion.start, v_max)


@dataclass(frozen=True, eq=False)
class BeamModes:
    """Modes of a uniform cantilever that bends and shears (Miranda and Taghavi 2005).

    Attributes
    ----------
    alpha0 : float
        H sqrt(GA/EI) [-], 0 pure bending, above 20 nearly pure shear.
    gamma : ndarray, shape (m,)
        Eigenvalues [-].
    period_ratios : ndarray, shape (m,)
        Period of each mode over that of the first [-].
    participation : ndarray, shape (m,)
        Gamma_i for the shapes of `shapes` [-].
    """

    alpha0: float
    gamma: Array
    period_ratios: Array
    participation: Array

    def shapes(self, height_ratio: float | Array) -> Array:
        """Return the mode shapes.

        Parameters
        ----------
        height_ratio : float or ndarray, shape (k,)
            z/h.

        Returns
        -------
        ndarray, shape (m, k)
            With the top at 1.
        """
        return _shapes(self.alpha0, self.gamma, np.atleast_1d(np.asarray(height_ratio, dtype=np.float64)))


def beam_modes(alpha0: float, modes: int) -> BeamModes:
    r"""Return the first modes of a shear-flexural cantilever of uniform mass and stiffness.

    .. math::

        \phi'''' - \alpha_0^2 \phi'' = \lambda \phi

    fixed at the base, free at the top, x = z/h, is solved by

    .. math::

        \phi = \sin \gamma x - \frac{\gamma}{\beta} \sinh \beta x + \eta (\cosh \beta x - \cos \gamma x), \qquad
        \beta^2 = \gamma^2 + \alpha_0^2, \quad
        \eta = \frac{\gamma^2 \sin\gamma + \gamma \beta \sinh\beta}{\gamma^2 \cos\gamma + \beta^2 \cosh\beta}

    with the eigenvalues gamma from

    .. math::

        2 + \left(2 + \frac{\alpha_0^4}{\gamma^2 \beta^2}\right) \cos\gamma \cosh\beta
        + \frac{\alpha_0^2}{\gamma \beta} \sin\gamma \sinh\beta = 0, \qquad
        \frac{T_i}{T_1} = \frac{\gamma_1 \beta_1}{\gamma_i \beta_i}

    Parameters
    ----------
    alpha0 : float
        0 to 650, stiffness ratio [-]: up to 1.5 a building bends (shear walls), 5 to 20 is braced or dual, above it
        deflects in shear (moment-resisting frames).
    modes : int
        1 to 30.

    Returns
    -------
    BeamModes
        Eigenvalues to 1e-12; participation factors to 1e-10 (Gauss-Legendre quadrature of smooth shapes).

    Raises
    ------
    InputError
        For values outside these.

    References
    ----------
    Miranda, E. and Taghavi, S. (2005). Approximate floor acceleration demands in multistory buildings, I: formulation.
    Journal of Structural Engineering 131, 203-211.
    """
    from scipy.optimize import brentq

    if not 0.0 <= alpha0 <= _SHEAR_LIMIT:
        raise InputError(f"alpha0 must be from 0 (bending) to {_SHEAR_LIMIT:g} (shear), not {alpha0!r}")
    if isinstance(modes, bool) or not isinstance(modes, int) or not 1 <= modes <= 30:
        raise InputError(f"modes must be a whole number from 1 to 30, not {modes!r}")

    def missing(g: float) -> float:
        # Divided by cosh(b), which would overflow.
        b = float(np.hypot(g, alpha0))
        k = alpha0**2 / (g * b)
        return float(
            4.0 * np.exp(-b) / (1.0 + np.exp(-2.0 * b)) + (2.0 + k * k) * np.cos(g) + k * np.sin(g) * np.tanh(b)
        )

    # At whole multiples of pi the cosine term outweighs the rest, with alternating sign: one root lies between two.
    gamma = np.array([brentq(missing, max(1e-3, i * np.pi), (i + 1) * np.pi, xtol=1e-14) for i in range(modes)])
    beta = np.hypot(gamma, alpha0)
    # The base of a stiff frame bends within 1 / alpha0 of the ground: panels grow from there.
    edges = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 40)])
    nodes, weights = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(edges)
    x = (edges[:-1, None] + half[:, None] * (nodes + 1.0)).ravel()
    phi = _shapes(alpha0, gamma, x)
    dx = (half[:, None] * weights).ravel()
    participation = (phi @ dx) / ((phi * phi) @ dx)
    return BeamModes(alpha0, gamma, gamma[0] * beta[0] / (gamma * beta), participation)


def floor_motion(
    motion: Motion,
    height_ratio: float,
    period: float,
    *,
    damping: float,
    alpha0: float,
    modes: int,
    tail: float | None = None,
) -> Motion:
    r"""Return the motion of a floor by modal analysis.

    .. math::

        a_{floor} = a_{ground} + \sum_i \Gamma_i \phi_i(z/h) u_i''

    with u_i [m] the displacement of an oscillator of the period and the damping of mode i on the ground.

    Parameters
    ----------
    motion : Motion
        Of the ground.
    height_ratio : float
        z/h, 0 to 1.
    period : float
        Of the first mode, s.
    damping : float
        Ratio, of every mode [-].
    alpha0, modes : float, int
        As `beam_modes`.
    tail : float, optional
        Seconds that the building goes on swinging after the record; None: until its first mode has decayed to 1 %.

    Returns
    -------
    Motion
        Both horizontals alike, the vertical as on the ground.  Exact in time at the samples for the ground's polygon
        (which goes to zero in one step after the record where a tail is added); what is left out above the last mode
        moves with the ground.  Between the samples the floor is taken as a polygon, whose error falls with the square
        of the step: resample the ground first (`resampled`), as `refined` does until an error is met.

    Raises
    ------
    InputError
        For a parameter outside its range.

    References
    ----------
    Miranda and Taghavi (2005), as `beam_modes`.
    """
    if not 0.0 <= height_ratio <= 1.0:
        raise InputError(f"height_ratio must be from 0 (base) to 1 (roof), not {height_ratio!r}")
    _positive("period", period)
    if not 0.0 < damping < 1.0:
        raise InputError(f"damping must be above 0 and below 1, not {damping!r}")
    after = float(-np.log(_SETTLED) * period / (2.0 * np.pi * damping)) if tail is None else tail
    if not (np.isfinite(after) and after >= 0.0):
        raise InputError(f"tail must be at least 0 s, not {tail!r}")
    beam = beam_modes(alpha0, modes)
    effect = beam.participation * beam.shapes(height_ratio)[:, 0]
    ground = motion.acceleration
    if after > 0.0:
        ground = np.pad(ground, ((0, 0), (0, int(np.ceil(after / motion.dt)))))
    base = Motion(motion.dt, ground)
    out = np.array(ground)
    for ratio, share in zip(beam.period_ratios, effect, strict=True):
        w = 2.0 * np.pi / (period * float(ratio))
        for row in range(2):
            history = np.zeros((base.samples, 2))
            oscillator_history(samples(ground[row]), motion.dt, w, damping, 1.0, history)
            out[row] += share * (history[:, 1] - ground[row])
    step = (
        f"floor at z/h {height_ratio:g} of a shear-flexural beam (Miranda and Taghavi 2005): alpha0 {alpha0:g}, period "
        f"{period:g} s, damping {damping:.3g}, {modes} modes, {after:.3g} s of free vibration; vertical unchanged"
    )
    return Motion(motion.dt, out, motion.name, (*motion.steps, step), motion.source)


def _shapes(alpha0: float, gamma: Array, x: Array) -> Array:
    g = gamma[:, None]
    b = np.hypot(g, alpha0)
    # eta = g/b + rest; the rest multiplies cosh(bx) and is tiny where that is huge, so both are divided by cosh(b).
    numerator = g * g * np.sin(g) - g**3 / b * np.cos(g) - g * b * np.exp(-b)
    double = 1.0 + np.exp(-2.0 * b)
    lifted = 2.0 * np.exp(-b) / double  # 1 / cosh(b)
    scaled = numerator / (g * g * np.cos(g) * lifted + b * b)
    cosh_ratio = (np.exp(b * (x - 1.0)) + np.exp(-b * (x + 1.0))) / double
    eta = g / b + scaled * lifted
    phi = np.sin(g * x) - eta * np.cos(g * x) + g / b * np.exp(-b * x) + scaled * cosh_ratio
    top = np.sin(g) - eta * np.cos(g) + g / b * np.exp(-b) + scaled
    return np.asarray(phi / top, dtype=np.float64)


def _positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(f"{name} must be a number above 0, not {value!r}")
