"""What the three models on dry friction share: sliding, the friction isolator, the horizontal isolator."""

from collections.abc import Mapping

import numpy as np

from pipeline.kernels.friction_line import friction_line_batch, friction_line_one
from pipeline.kernels.friction_plane import friction_plane_batch, friction_plane_one
from pipeline.models.common import ROUNDING, Quiet, after_record
from pipeline.quantities import Array
from pipeline.records import Columns, Excitation

PLANE_TOLERANCE = 1e-6
"""Velocity tolerance of the two-directional kernel at `history`; the result is taken at a tenth of it."""


def stick_slip(
    motion: Excitation, w: Array, zeta: Array, mu_s: Array, mu_k: Array, refine: int, estimate: bool
) -> Columns:
    """Run n bodies on dry friction, with a spring and a dashpot where w > 0.

    w [rad/s], zeta, mu_s, mu_k [-] : (n,)
    returns : displacement, residual, path [m], acceleration [m/s2], error [m], note; (n,) each
    """
    quiet = Quiet(motion)
    arrays = [np.ascontiguousarray(p, dtype=np.float64) for p in (w, zeta, mu_s, mu_k)]
    results = np.empty((arrays[0].size, 5))
    if motion.y is None:
        friction_line_batch(
            quiet.x, quiet.z, quiet.ratio, quiet.maxima, quiet.pushes, quiet.dt, *arrays, quiet.tail, refine, results
        )
        error = ROUNDING * np.maximum(results[:, 0], results[:, 2])
    else:
        coarse = np.full_like(results, np.nan)
        tolerance = PLANE_TOLERANCE / (refine / 2.0) ** 4
        runs = ((tolerance, coarse), (0.1 * tolerance, results)) if estimate else ((tolerance, results),)
        for rtol, out in runs:
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
                *arrays,
                quiet.tail,
                rtol,
                out,
            )
        # The pair's own error does not shrink exactly with its tolerance: ten times the difference covers it.
        error = 10.0 * (np.abs(results[:, 0] - coarse[:, 0]) + ROUNDING * results[:, 2])
    return {
        "displacement": results[:, 0],
        "residual": results[:, 1],
        "path_length": results[:, 2],
        "acceleration": results[:, 3],
        "error": error,
        "note": results[:, 4],
    }


def stick_slip_trace(motion: Excitation, w: float, zeta: float, mu_s: float, mu_k: float) -> Columns:
    """Return u_x, u_y [m] and the absolute accelerations a_x, a_y [m/s2] of one body at the samples, (n,) each."""
    quiet = Quiet(motion)
    out = np.empty(4)
    if motion.y is None:
        line = np.zeros((quiet.x.size + after_record(motion), 2))
        friction_line_one(
            quiet.x, quiet.z, quiet.ratio, quiet.maxima, quiet.pushes, quiet.dt, w, zeta, mu_s, mu_k, 0.0, 1, out, line
        )
        still = np.zeros(line.shape[0])
        return {"u_x": line[:, 0], "u_y": still, "a_x": line[:, 1], "a_y": still}
    plane = np.zeros((quiet.x.size + after_record(motion), 4))
    friction_plane_one(
        quiet.x,
        quiet.y,
        quiet.z,
        quiet.ratio,
        quiet.maxima,
        quiet.push,
        quiet.pushes,
        quiet.dt,
        quiet.peak,
        w,
        zeta,
        mu_s,
        mu_k,
        0.0,
        0.1 * PLANE_TOLERANCE,
        out,
        plane,
    )
    return {"u_x": plane[:, 0], "u_y": plane[:, 1], "a_x": plane[:, 2], "a_y": plane[:, 3]}


def kinetic(parameters: Mapping[str, Array]) -> Array:
    """Return the kinetic friction: the static one where none is given.

    raises : ValueError where the kinetic friction is above the static one: such a body could neither slip nor stick
    """
    mu_s, mu_k = parameters["friction_static"], parameters["friction_kinetic"]
    above = np.flatnonzero(mu_k > mu_s)
    if above.size:
        at = int(above[0])
        raise ValueError(f"friction_kinetic ({mu_k[at]:g}) is above friction_static ({mu_s[at]:g}) (entry {at})")
    return np.where(np.isnan(mu_k), mu_s, mu_k)
