r"""A rigid body that stands on a surface with friction: rest, slide, rock, slide-rock and flight, located in time.

With (x, y) [m] the centre of gravity from where the base is, theta [rad] its rotation towards +axis, F and N [m/s2] the
forces of the surface per mass on the corner that touches, at r = (r_x, r_y) [m] from the centre of gravity,

.. math::

    x'' = F - a, \qquad y'' = N - (g + a_z), \qquad \rho^2 \theta'' = r_y F - r_x N, \qquad |F| \le \mu N, \; N \ge 0

with a and a_z [m/s2] the horizontal and the vertical acceleration of the base and rho [m] the radius of gyration.  Each
mode has its own equations (`pipeline.kernels.standing_body`, `rock_phase`, `slip_phase`; what slides on its base or
flies does so in closed form); a corner that comes down stays down (`corner_impact`).
"""

import math

import numpy as np

from pipeline.kernels import CUT, EVENT_CAP, FIRST, UNRESOLVED, inlined, inner, kernel
from pipeline.kernels.line_phase import TERMS, Body, free_body
from pipeline.kernels.quiet import next_above
from pipeline.kernels.rocking import CAP, NEAR, STEP
from pipeline.kernels.slip_phase import Load
from pipeline.kernels.standing_body import (
    ALPHA,
    FELL,
    FELL_AT,
    FLAGS,
    FLIES,
    FOUND,
    INVERSE,
    LAST_NEAR,
    LIFTED_AT,
    LINGERS,
    MODE,
    MU_K,
    MU_S,
    PHI,
    RESIDUAL,
    RESTED,
    RESTS,
    ROCKS,
    SIDE,
    SLIDE_ROCKS,
    SLIDES,
    STATE,
    TANGENT,
    UNTIL,
    V,
    calm,
    stand_on,
    track,
)
from pipeline.kernels.standing_phases import fly_on, glide_on, rest_on, rock_on, slide_on, slide_rock_on
from pipeline.quantities import Array, G

MOST_PIECES = 50_000
"""Steps of a sample interval, at the coarsest, from which on a body is not followed."""

EVENTS = 200
"""Changes of mode within a stretch after which the body waits until the next one."""


@inner
def _stretch(
    state: Array,
    load: Load,
    span: float,
    clock: float,
    parts: int,
    rest: float,
    body: Array,
    line: Body,
    series: Array,
    out: Array,
) -> None:
    # One stretch on which push and weight are linear, in one step; what is left of it after a change of mode in so many
    # parts, as a hop within one step would be the same at every refinement.
    t, longest, end, changes = 0.0, span, span * (1.0 - 1e-14), 0
    while t < end:
        mode, side = state[MODE], state[SIDE]
        h = span - t
        if h > 1.5 * longest:
            h = longest
        before = t
        if mode == RESTS:
            t = rest_on(state, load, t, span, body)
        elif mode == SLIDES:
            t = slide_on(state, load, t, span, body, line, series, out)
        elif mode == ROCKS:
            t = rock_on(state, load, t, h, clock, rest, body, out)
        elif mode == SLIDE_ROCKS:
            t = slide_rock_on(state, load, t, h, clock, rest, body, out)
        else:
            t = fly_on(state, load, t, h, clock, body, out)
        if out[FELL] > 0.0:
            return
        if state[MODE] != mode or state[SIDE] != side or t <= before:
            _note(state, mode, clock + t, out)
            longest = (span - t) / parts
            changes += 1
            if changes > EVENTS:
                out[FLAGS] = float(int(out[FLAGS]) | EVENT_CAP)
                return


@inner
def _note(state: Array, before: float, now: float, out: Array) -> None:
    # What a change of mode tells: when an edge first lifted, and whether one did before impacts cut off had ended.
    if state[MODE] >= ROCKS and before < ROCKS:
        if out[LIFTED_AT] < 0.0:
            out[LIFTED_AT] = now
        elif now < state[UNTIL]:
            out[RESTED] = 1.0
    if state[LINGERS] > 0.0:
        state[UNTIL], state[LINGERS] = now + state[LINGERS], 0.0


@inner
def _far(state: Array, body: Array) -> bool:
    return state[MODE] >= ROCKS and abs(state[PHI]) > NEAR * min(body[ALPHA], body[ALPHA + 1])


@inlined
def _follow(
    x: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    dt: float,
    peak: float,
    body: Array,
    tail: float,
    until: float,
    refine: int,
    rest: float,
    state: Array,
    series: Array,
    out: Array,
    history: Array,
) -> None:
    # The body through the record and until it rests or lies.
    n = x.shape[0]
    stand_on(state, 1.0, body)
    fastest = math.sqrt(max(body[INVERSE], body[INVERSE + 1]) * (G + peak))
    if not fastest * dt <= STEP * MOST_PIECES:
        out[FLAGS] = float(UNRESOLVED)
        return
    pieces = max(1, math.ceil(fastest * dt / STEP)) * refine
    step = dt / pieces
    parts = max(1, refine // 2)
    line = free_body(body[MU_S], body[MU_K], dt)
    weakest = min(body[MU_S], body[TANGENT], body[TANGENT + 1])
    recording = history.shape[0] > 0
    i = FIRST
    while i < n - 1:
        if i * dt >= until and calm(state, NEAR, body):
            return
        if state[MODE] == RESTS and not recording:
            ahead = next_above(ratio, maxima, i, weakest)
            if ahead >= n:
                break
            i = max(i, ahead - 1)
        if i < history.shape[0]:
            _record(state, body, out, history, i)
        if state[MODE] == SLIDES and not recording:
            ahead = glide_on(state, x, z, dt, i, body, line, out)
            if ahead > i:
                i = ahead
                continue
        a1, n1 = (x[i + 1] - x[i]) / dt, (z[i + 1] - z[i]) / dt
        j = 0
        while j < pieces:
            t0 = j * step
            load = (x[i] + a1 * t0, a1, G + z[i] + n1 * t0, n1)
            # What rests or slides needs no steps.
            whole = state[MODE] <= SLIDES
            span, few = (dt - t0, parts * (pieces - j)) if whole else (step, parts)
            _stretch(state, load, span, i * dt + t0, few, rest, body, line, series, out)
            if out[FELL] > 0.0:
                for k in range(i + 1, history.shape[0]):
                    _record(state, body, out, history, k)
                return
            j = pieces if whole else j + 1
        if _far(state, body):
            out[LAST_NEAR] = (i + 1) * dt
        i += 1
    for k in range(n - 1, history.shape[0]):
        _record(state, body, out, history, k)
    _run_out(body, tail, until, refine, rest, state, line, series, (n - 1) * dt, out)


@inner
def _record(state: Array, body: Array, out: Array, history: Array, i: int) -> None:
    history[i, 0] = state[PHI] if state[MODE] == FLIES else state[SIDE] * state[PHI]
    track(state, body, out)
    history[i, 1] = out[RESIDUAL]


@inlined
def _run_out(
    body: Array,
    tail: float,
    until: float,
    refine: int,
    rest: float,
    state: Array,
    line: Body,
    series: Array,
    ends: float,
    out: Array,
) -> None:
    # After the record: no push and its own weight, until it rests or lies, the end of the tail, or the cap.
    stop = tail if tail >= 0.0 else CAP
    step = 0.8 * STEP / math.sqrt(max(body[INVERSE], body[INVERSE + 1]) * G) / refine
    load, parts, t = (0.0, 0.0, G, 0.0), max(1, refine // 2), 0.0
    while t < stop:
        if state[MODE] == RESTS or (state[MODE] == SLIDES and state[V] == 0.0):
            return
        if ends + t >= until and calm(state, NEAR, body):
            return
        span = min(step, stop - t)
        if state[MODE] == SLIDES:
            if body[MU_K] == 0.0 and tail < 0.0:
                break
            span = min(stop - t, 2.0 * abs(state[V]) / (body[MU_K] * G)) if body[MU_K] > 0.0 else stop - t
        _stretch(state, load, span, ends + t, parts, rest, body, line, series, out)
        if out[FELL] > 0.0:
            return
        t += span
        if _far(state, body):
            out[LAST_NEAR] = ends + t
    if state[MODE] != RESTS and tail < 0.0:
        out[FLAGS] = float(int(out[FLAGS]) | CUT)


@kernel
def standing_batch(
    x: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    dt: float,
    peak: float,
    bodies: Array,
    tail: float,
    until: Array,
    refine: int,
    rest: float,
    results: Array,
    history: Array,
) -> None:
    r"""Follow m standing bodies.

    .. math::

        x'' = F - a, \quad y'' = N - (g + a_z), \quad \rho^2 \theta'' = r_y F - r_x N, \qquad |F| \le \mu N, \; N \ge 0

    Parameters
    ----------
    x, z : ndarray, shape (n,)
        Horizontal (a) and vertical (a_z) acceleration of the base, m/s2, linear between samples.
    ratio, maxima : ndarray
        Of this very motion: |a_h| / (g + a_z), infinite where contact is lost (n,) [-], and its block maxima.
    dt : float
        Time step, s.
    peak : float
        The largest ``|x|``, m/s2.
    bodies : ndarray, shape (m, BODY)
        As `pipeline.kernels.standing_body` says.
    tail : float
        Seconds to go on after the record; below 0: until it rests or lies, or the cap of a rocking body.
    until : ndarray, shape (m,)
        Time after which a body that has calmed down is no longer followed, s; infinite: it always is.
    refine : int
        By what the standard step is divided; the error falls with its fourth power.
    rest : float
        Rate, as a share of the smaller p alpha, below which a landing body turns no more.
    results : ndarray, shape (m, FOUND)
        Receives what `pipeline.kernels.standing_body` says.
    history : ndarray, shape (k, 2)
        Receives theta [rad] and the place of the middle of the base [m] of a single body at the samples, as long as it
        is.

    References
    ----------
    Shenton, H. W. and Jones, N. P. (1991). Base excitation of rigid bodies. I: formulation. Journal of Engineering
    Mechanics 117, 2286-2306.  Housner, G. W. (1963).  The behavior of inverted pendulum structures during earthquakes.
    Bulletin of the Seismological Society of America 53.
    """
    state, series, out = np.empty(STATE), np.empty((2, TERMS)), np.empty(FOUND)
    for k in range(bodies.shape[0]):
        for j in range(STATE):
            state[j] = 0.0
        for j in range(FOUND):
            out[j] = 0.0
        out[FELL_AT], out[LIFTED_AT] = -1.0, -1.0
        _follow(x, z, ratio, maxima, dt, peak, bodies[k], tail, until[k], refine, rest, state, series, out, history)
        for j in range(FOUND):
            results[k, j] = out[j]
