"""Parts that the three models on dry friction share: sliding, the friction isolator, the horizontal isolator."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pipeline.errors import InputError
from pipeline.kernels import SENSITIVE, UNRESOLVED
from pipeline.kernels.bounds import slip_bounds_batch
from pipeline.kernels.friction_line import CAP, friction_line_batch
from pipeline.kernels.friction_plane import friction_plane_batch
from pipeline.models.common import (
    ROUNDING,
    Quiet,
    after_record,
    contact_lost,
    lift_ratios,
    magnified,
    pushes,
    shared,
)
from pipeline.quantities import Array, G
from pipeline.records import Bounds, Columns, Excitation

FREE, SPRUNG = 1e-3, 3e-10
"""Tolerance of a step of the two-directional kernel at `history`, without and with a spring.

A free body forgets: friction takes the error of its velocity away, so that the displacement is right to 1e-4.  A spring
remembers, and a stroke is wanted to 1e-8.
"""
TIGHTEST = 1e-12
"""Tolerance below which rounding would decide."""
GLANCED = 1e-5
"""Tolerance of a step with a spring where it is the coarsest, which only draws.

Not that of a stop, which has to be that of `history`: a stop that is taken in one step at 1e-6 moved a peak of what is
passed on, which is felt as a body stops, by 0.2 to 4 % in one of 70 isolators.
"""
DRIFT = 1e-15
"""Relative error that a step of a spring's closed form leaves in what swings on: it remembers each of them.

Of 1,900 isolators, written on twice and three times the samples, none was off by more than a fifth of it a step.
"""
PROMISED = 5e-6
"""Relative error of the two-directional `reference`, by which a bound is looser: it holds for what is computed too."""

Steps = tuple[float, float, float]
"""Tolerances of a step and of a stop of the two-directional kernel, and its longest step in sample intervals."""


def stick_slip(
    motion: Excitation, w: Array, zeta: Array, mu_s: Array, mu_k: Array, refine: int, estimate: bool
) -> Columns:
    """Run n bodies on dry friction, with a spring and a dashpot where w > 0.

    Parameters
    ----------
    motion : Excitation
        Along one direction, which is solved in closed form, or in two, which is integrated.
    w, zeta, mu_s, mu_k : ndarray, shape (n,)
        Natural frequency [rad/s], damping ratio, friction at rest and while slipping [-].
    refine : int
        How much finer than the coarsest step two directions are integrated.
    estimate : bool
        Whether errors are estimated, by another pass; else those of two directions are NaN.

    Returns
    -------
    Columns
        displacement, residual, path_length [m], acceleration [m/s2], error of the displacement [m],
        acceleration_error [m/s2] and note, (n,) each.
    """
    shaking, times = magnified(motion)
    quiet = Quiet(shaking)
    arrays = [np.ascontiguousarray(p, dtype=np.float64) for p in (w, zeta, times * mu_s, times * mu_k)]
    results = np.empty((arrays[0].size, 7))
    if motion.y is None:
        _line(quiet, arrays, quiet.tail, results[:, :5], np.empty((0, 2)))
        drift = DRIFT * quiet.x.size * np.where(w > 0.0, 1.0 + w * quiet.dt, 0.0)
        error = ROUNDING * np.maximum(results[:, 0], results[:, 2]) + drift * results[:, 0]
        felt = (ROUNDING + drift) * results[:, 3]
    else:
        coarse = np.full_like(results, np.nan)
        tolerance, stopping, longest = steps = _steps(w, refine)
        passes = (((10.0 * tolerance, 10.0 * stopping, 2.0 * longest), coarse), (steps, results))
        for one, out in passes if estimate else passes[1:]:
            _plane(quiet, arrays, quiet.tail, one, out, np.empty((0, 4)))
        # Both passes may err alike, at a stop that both take in one step: what each step may have been off by, summed
        # up, sees that.
        apart = np.abs(results - coarse)
        error = np.maximum(2.0 * apart[:, :3].sum(axis=1), results[:, 5]) + ROUNDING * results[:, 2]
        # What is passed on is read off at single instants: of 960 under pieces of a real record two were off by 1.2
        # times of what the displacement's own rule grants.
        felt = 2.0 * np.maximum(2.0 * apart[:, 3], results[:, 6]) + ROUNDING * results[:, 3]
    results[:, [0, 1, 2, 3]] /= times
    error, felt = error / times, felt / times
    note = results[:, 4].astype(np.int64)
    lost = (note & UNRESOLVED) > 0
    if lost.any():
        results[lost, :4] = _most(motion, w[lost], zeta[lost], mu_s[lost])
        error, felt = np.where(lost, results[:, 0], error), np.where(lost, results[:, 3], felt)
    if estimate:
        # Whether it moves at all: just above its friction, a thousandth of a displacement is a millionth of the motion.
        note |= np.where(_moves(motion, 0.99, mu_s) != _moves(motion, 1.01, mu_s), SENSITIVE, 0)
    return {
        "displacement": results[:, 0],
        "residual": results[:, 1],
        "path_length": results[:, 2],
        "acceleration": results[:, 3],
        "error": error,
        "acceleration_error": felt,
        "note": note.astype(np.float64),
    }


def _most(motion: Excitation, w: Array, zeta: Array, mu_s: Array) -> Array:
    # Upper bounds (n, 4) of displacement, residual, path and acceleration, without integration: friction and dashpot
    # only take energy away, so that neither |u'| nor w |u| exceeds the integral of |a|.
    push = pushes(motion)
    speed = float(push.sum()) * motion.dt
    path = speed * (push.size * motion.dt + (CAP if motion.tail is None else motion.tail))
    away = np.minimum(path, np.divide(speed, w, out=np.full_like(w, np.inf), where=w > 0.0))
    weight = max(G, float(np.max(G + motion.z)))
    felt = np.maximum(float(push.max()), w * (1.0 + 2.0 * zeta) * speed + mu_s * weight)
    return np.column_stack([away, away, np.full_like(w, path), felt])


def _line(quiet: Quiet, bodies: Sequence[Array], tail: float, results: Array, history: Array) -> None:
    # bodies: w, zeta, mu_s, mu_k
    friction_line_batch(
        quiet.x, quiet.z, quiet.ratio, quiet.maxima, quiet.pushes, quiet.dt, *bodies, tail, results, history
    )


def _plane(quiet: Quiet, bodies: Sequence[Array], tail: float, steps: Steps, results: Array, history: Array) -> None:
    # bodies: w, zeta, mu_s, mu_k;  steps: as from _steps
    def follow(part: slice) -> None:
        friction_plane_batch(
            quiet.x,
            quiet.y,
            quiet.z,
            quiet.ratio,
            quiet.maxima,
            quiet.push,
            quiet.pushes,
            quiet.dt,
            quiet.peak,
            *(one[part] for one in bodies),
            tail,
            *steps,
            results[part],
            history,
        )

    shared(follow, results.shape[0], quiet.x.size, together=1)


def _moves(motion: Excitation, times: float, mu_s: Array) -> Array:
    scaled = replace(motion, x=times * motion.x, y=None if motion.y is None else times * motion.y, z=times * motion.z)
    return np.asarray(max(lift_ratios(scaled)) > mu_s)


def _steps(w: Array, refine: int) -> Steps:
    sprung = np.max(w) > 0.0
    if sprung and refine == 1:
        return GLANCED, SPRUNG, 1.0
    tolerance = max(TIGHTEST, (SPRUNG if sprung else FREE) * (2.0 / refine) ** 6)
    return tolerance, tolerance, 1.0 / refine


def slip_bounds(motion: Excitation, mu_s: Array, mu_k: Array, *outputs: str) -> Bounds:
    """Return guaranteed bounds of what n bodies without a spring do on dry friction (the proof is in kernels.bounds).

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.
    mu_s, mu_k : ndarray, shape (n,)
        Friction at rest and while slipping [-], mu_k <= mu_s.
    *outputs : str
        Those wanted of displacement, residual, path_length [m] and acceleration [m/s2].

    Returns
    -------
    Bounds
        Of each of them; exactly 0 where nothing slips, and infinite above where nothing stops it.
    """
    quiet = Quiet(motion)
    # Bodies differ in more than these: each friction is bounded once.
    frictions, place = np.unique(np.column_stack([mu_s, mu_k]), axis=0, return_inverse=True)
    results = np.empty((frictions.shape[0], 4))
    slip_bounds_batch(
        quiet.x,
        quiet.y,
        quiet.z,
        quiet.push,
        quiet.ratio,
        quiet.maxima,
        quiet.pushes,
        quiet.dt,
        *np.ascontiguousarray(frictions.T),
        quiet.tail,
        results,
    )
    results = results[place.reshape(-1)]
    margin = ROUNDING if motion.y is None else PROMISED
    low, high = results[:, 0] * (1.0 - margin), results[:, 1] * (1.0 + margin)
    bounds = {
        "displacement": (low, high),
        "residual": (np.zeros_like(low), high),
        "path_length": (low, high),
        "acceleration": (results[:, 2] * (1.0 - ROUNDING), results[:, 3] * (1.0 + ROUNDING)),
    }
    return Bounds({name: bounds[name] for name in outputs}, contact_lost(motion, mu_s.size))


def stick_slip_trace(motion: Excitation, w: float, zeta: float, mu_s: float, mu_k: float) -> Columns:
    """Return the time history of one body at the samples.

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.
    w, zeta, mu_s, mu_k : float
        As in `stick_slip`.

    Returns
    -------
    Columns
        u_x, u_y [m] against its support and the absolute accelerations a_x, a_y [m/s2], (n,) each.
    """
    quiet = Quiet(motion)
    arrays = [np.array([p]) for p in (w, zeta, mu_s, mu_k)]
    results, samples = np.empty((1, 7)), quiet.x.size + after_record(motion)
    if motion.y is None:
        line = np.zeros((samples, 2))
        _line(quiet, arrays, 0.0, results, line)
        return {"u_x": line[:, 0], "u_y": np.zeros(samples), "a_x": line[:, 1], "a_y": np.zeros(samples)}
    plane = np.zeros((samples, 4))
    _plane(quiet, arrays, 0.0, _steps(arrays[0], 2), results, plane)
    return {"u_x": plane[:, 0], "u_y": plane[:, 1], "a_x": plane[:, 2], "a_y": plane[:, 3]}


def kinetic(parameters: Mapping[str, Array]) -> Array:
    """Return the kinetic friction: the static one where none is given.

    Parameters
    ----------
    parameters : mapping of str to ndarray, shape (n,)
        friction_static and friction_kinetic [-]; NaN for what is not given.

    Returns
    -------
    ndarray, shape (n,)
        [-].

    Raises
    ------
    InputError
        Where the kinetic friction is above the static one: such a body could neither slip nor stick.
    """
    mu_s, mu_k = parameters["friction_static"], parameters["friction_kinetic"]
    above = np.flatnonzero(mu_k > mu_s)
    if above.size:
        at = int(above[0])
        raise InputError(f"friction_kinetic ({mu_k[at]:g}) is above friction_static ({mu_s[at]:g}) (entry {at})")
    return np.where(np.isnan(mu_k), mu_s, mu_k)
