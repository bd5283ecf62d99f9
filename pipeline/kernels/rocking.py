r"""Rocking and overturning of a rigid body about two edges (Housner 1963), impacts located in time.

With s = +1 on the edge towards +axis and -1 on the other, and phi = s theta >= 0 [rad],

.. math::

    \phi'' = -c_s \left[N \sin(\alpha_s - \phi) + s a \cos(\alpha_s - \phi)\right], \qquad
    c_s = \frac{R_s}{\rho^2 + R_s^2}, \quad N = \max(0, g + a_z)

with alpha_s [rad] the slenderness towards an edge, R_s [m] its distance from the centre of gravity, rho [m] the radius
of gyration, a and a_z [m/s2] the horizontal and the vertical acceleration of the base.  At phi = 0 the body lands on
the other edge and its rate is multiplied by the restitution.  Classical Runge-Kutta steps of fourth order, which end at
every sample, lift-off and landing, so that the order holds through the impacts.
"""

import math

import numpy as np

from pipeline.kernels import CONTACT_LOST, CUT, EVENT_CAP, FIRST, fused, inner, kernel
from pipeline.kernels.quiet import next_above
from pipeline.kernels.rock_phase import ANGLE, SPEED, landing, lift_off, locate, rock_step
from pipeline.quantities import Array, G

OVERTURNED = 0.5 * math.pi
"""Rotation [rad] from which no body comes back."""

REST = 1e-4
"""Rate, as a share of the smaller p alpha, below which a landing body rests: impacts are infinite in number."""

SETTLING = 10.0
"""How much longer than under a constant push impacts that a rest cuts off may go on: near a lift-off they linger."""

COUNTED = 1e-3
"""Rate, as a share of the smaller p alpha, from which an impact is counted."""

IMPACTS_CAP = 200
"""Impacts within one sample interval after which the body is put to rest until the next sample."""

STEP = 0.2
"""Largest step of the integration times the fastest rate of the body."""

CAP = 300.0
"""Seconds after the record at which a body that still rocks is cut off."""

NEAR = 0.05
"""Ratio below which a body that has calmed down counts as far from overturning."""


@fused
def _stretch(
    state: Array,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    span: float,
    clock: float,
    parts: int,
    rest: float,
    body: Array,
    out: Array,
) -> None:
    # One stretch on which the excitation and the normal force are linear, in one step; what is left of it after a
    # lift-off or a landing in so many parts, as a hop within one step would be the same at every refinement.
    # state: s, phi, rate, sine and cosine of alpha - phi, and until when the impacts that a rest cut off would go on.
    # body: alpha1, alpha2, c1, c2, e12, e21.
    s, phi, rate, sn, cs = state[0], state[1], state[2], state[3], state[4]
    t, longest = 0.0, span
    landings = 0
    while landings <= IMPACTS_CAP:
        if s == 0.0:
            lift, edge = lift_off(a0, a1, n0, n1, t, span, math.tan(body[0]), math.tan(body[1]))
            if edge == 0.0:
                break
            t, s = lift, edge
            phi, rate = 0.0, 0.0
            sn, cs = (math.sin(body[0]), math.cos(body[0])) if s > 0.0 else (math.sin(body[1]), math.cos(body[1]))
            if out[3] < 0.0:
                out[3] = clock + t
            elif clock + t < state[5]:
                out[7] = 1.0
            if t >= span:
                break
            longest = (span - t) / parts
        h = span - t
        if h <= 1e-14 * span:
            break
        if h > 1.5 * longest:
            h = longest
        alpha, c = (body[0], body[2]) if s > 0.0 else (body[1], body[3])
        p1, r1, s1, c1 = rock_step(phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c)
        landed = -1.0
        if p1 <= 0.0 or rate < 0.0 < r1:
            landed = landing(phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c, p1, r1)
        if landed < 0.0:
            if p1 >= OVERTURNED:
                low, high = phi - OVERTURNED, p1 - OVERTURNED
                tau = locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, low, high, s, c, ANGLE, OVERTURNED)
                out[0] = max(out[0], OVERTURNED / alpha)
                out[1], out[2] = 1.0, clock + t + tau
                break
            if rate > 0.0 > r1:
                _peak(phi, rate, sn, cs, a0, a1, n0, n1, t, h, r1, s, alpha, c, out)
            out[0] = max(out[0], p1 / alpha)
            phi, rate, sn, cs = p1, r1, s1, c1
            t += h
            continue
        _p, r1, _s, _c = rock_step(phi, rate, sn, cs, a0, a1, n0, n1, t, landed, s, c)
        if rate > 0.0 > r1:
            _peak(phi, rate, sn, cs, a0, a1, n0, n1, t, landed, r1, s, alpha, c, out)
        t += landed
        # The smaller p alpha of the two edges: a mirrored body must count the same impacts.
        slow = min(math.sqrt(body[2] * G) * body[0], math.sqrt(body[3] * G) * body[1])
        if abs(r1) >= COUNTED * slow:
            out[4] += 1.0
        rate = max(0.0, -r1) * (body[4] if s > 0.0 else body[5])
        s = -s
        phi = 0.0
        sn, cs = (math.sin(body[0]), math.cos(body[0])) if s > 0.0 else (math.sin(body[1]), math.cos(body[1]))
        longest = (span - t) / parts
        landings += 1
        if landings > IMPACTS_CAP:
            out[5] = float(int(out[5]) | EVENT_CAP)
        if landings > IMPACTS_CAP or rate < rest * slow:
            # A hop takes twice its rate over what pulls the body down, and each is shorter by the same share.
            down = (body[2] if s > 0.0 else body[3]) * ((n0 + n1 * t) * sn + s * (a0 + a1 * t) * cs)
            ends = down * (1.0 - body[4] * body[5])
            state[5] = clock + t + SETTLING * 4.0 * rate / ends if ends > 0.0 else math.inf
            s, rate = 0.0, 0.0
    state[0], state[1], state[2], state[3], state[4] = s, phi, rate, sn, cs


@fused
def _peak(
    phi: float,
    rate: float,
    sn: float,
    cs: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    t: float,
    h: float,
    r1: float,
    s: float,
    alpha: float,
    c: float,
    out: Array,
) -> None:
    if (phi + h * rate) / alpha > out[0]:
        tau = locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, rate, r1, s, c, SPEED, 0.0)
        top, _r, _s, _c = rock_step(phi, rate, sn, cs, a0, a1, n0, n1, t, tau, s, c)
        out[0] = max(out[0], top / alpha)


@inner
def _calm(state: Array, body: Array) -> bool:
    # Whether, left alone, the body stays below NEAR: its speed would lift it from the ground by no more than that.
    alpha, c = (body[0], body[2]) if state[0] > 0.0 else (body[1], body[3])
    return state[1] <= NEAR * alpha and state[2] * state[2] <= 2.0 * NEAR * alpha * alpha * c * G


@inner
def _follow(
    x: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    dt: float,
    peak: float,
    body: Array,
    initial: float,
    tail: float,
    until: float,
    refine: int,
    rest: float,
    state: Array,
    out: Array,
    history: Array,
) -> None:
    # The body through the record and until it rests or lies.  state: as in _stretch.
    n = x.shape[0]
    if initial != 0.0:
        state[0], state[1] = (1.0, initial) if initial > 0.0 else (-1.0, -initial)
        lean = (body[0] if initial > 0.0 else body[1]) - state[1]
        state[3], state[4] = math.sin(lean), math.cos(lean)
        out[0] = state[1] / (body[0] if initial > 0.0 else body[1])
        if state[1] >= OVERTURNED:
            out[1], out[2] = 1.0, 0.0
            return
    fastest = math.sqrt(max(body[2], body[3]) * (G + peak))
    pieces = max(1, math.ceil(fastest * dt / STEP)) * refine
    step = dt / pieces
    parts = max(1, refine // 2)
    weakest = math.tan(min(body[0], body[1]))
    recording = history.shape[0] > 0
    i = FIRST
    while i < n - 1:
        if i * dt >= until and _calm(state, body):
            return
        if state[0] == 0.0 and not recording:
            ahead = next_above(ratio, maxima, i, weakest)
            if ahead >= n:
                break
            i = max(i, ahead - 1)
        if i < history.shape[0]:
            history[i, 0] = state[0] * state[1]
        a1, n0, n1 = (x[i + 1] - x[i]) / dt, G + z[i], (z[i + 1] - z[i]) / dt
        end = n0 + n1 * dt
        cut = -1.0
        if n0 < 0.0 or end < 0.0:
            out[5] = float(int(out[5]) | CONTACT_LOST)
            if n0 > 0.0 or end > 0.0:
                cut = -n0 / n1
        for j in range(pieces):
            t0, t1 = j * step, (j + 1) * step
            clock = i * dt + t0
            if t0 < cut < t1:
                held, after = (n1, 0.0) if n0 > 0.0 else (0.0, n1)
                _stretch(
                    state, x[i] + a1 * t0, a1, max(0.0, n0 + n1 * t0), held, cut - t0, clock, parts, rest, body, out
                )
                if out[1] == 0.0:
                    _stretch(state, x[i] + a1 * cut, a1, 0.0, after, t1 - cut, i * dt + cut, parts, rest, body, out)
            else:
                held = n1 if max(n0 + n1 * t0, n0 + n1 * t1) > 0.0 else 0.0
                _stretch(state, x[i] + a1 * t0, a1, max(0.0, n0 + n1 * t0), held, step, clock, parts, rest, body, out)
            if out[1] > 0.0:
                if i + 1 < history.shape[0]:
                    history[i + 1 :, 0] = state[0] * OVERTURNED
                return
        if state[1] > NEAR * (body[0] if state[0] > 0.0 else body[1]):
            out[6] = (i + 1) * dt
        i += 1
    if n - 1 < history.shape[0]:
        history[n - 1, 0] = state[0] * state[1]
    # After the record: free rocking until rest or overturning, the end of the tail, or the cap.
    stop = tail if tail >= 0.0 else CAP
    h = 0.8 * STEP / math.sqrt(max(body[2], body[3]) * G) / refine
    t = 0.0
    while state[0] != 0.0 and t < stop:
        clock = (n - 1) * dt + t
        if clock >= until and _calm(state, body):
            return
        now = min(h, stop - t)
        _stretch(state, 0.0, 0.0, G, 0.0, now, clock, parts, rest, body, out)
        if out[1] > 0.0:
            return
        t += now
        if state[1] > NEAR * (body[0] if state[0] > 0.0 else body[1]):
            out[6] = clock + now
    if state[0] != 0.0 and tail < 0.0:
        out[5] = float(int(out[5]) | CUT)


@kernel
def rocking_batch(
    x: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    dt: float,
    peak: float,
    bodies: Array,
    initial: Array,
    tail: float,
    until: Array,
    refine: int,
    rest: float,
    results: Array,
    history: Array,
) -> None:
    r"""Follow m rocking bodies.

    .. math::

        \phi'' = -c_s \left[N \sin(\alpha_s - \phi) + s a \cos(\alpha_s - \phi)\right], \qquad
        \phi'_+ = -e \phi'_- \text{ at each landing}

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
    bodies : ndarray, shape (m, 6)
        alpha1, alpha2 [rad], c1, c2 [1/m], e12, e21 [-]; 1 is the edge towards +axis.
    initial : ndarray, shape (m,)
        Rotation from which it is released at rest, rad.
    tail : float
        Seconds to go on after the record; below 0: until it rests or lies, or CAP.
    until : ndarray, shape (m,)
        Time after which a body that has calmed down is no longer followed, s; infinite: it always is.
    refine : int
        By what the standard step is divided; the error falls with its fourth power.
    rest : float
        REST, or less for a body whose rests matter.
    results : ndarray, shape (m, 8)
        Receives the largest phi / alpha_s [-], whether it overturned (0, 1), the times of overturning and of uplift [s]
        (-1: never), the number of impacts, the flags (`pipeline.kernels`), the last time above NEAR [s] (to a
        sample or a step), and whether (0, 1) an edge lifted again before the impacts that a rest cut off would have
        ended.
    history : ndarray, shape (k, 1)
        Receives theta = s phi [rad] of a single body at the samples, as long as it is.

    References
    ----------
    Housner, G. W. (1963). The behavior of inverted pendulum structures during earthquakes. Bulletin of the
    Seismological Society of America 53. Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991).
    Evaluation of earthquake damage mitigation methods for museum objects. Studies in Conservation 36. Sec. 2.1.
    """
    state = np.empty(6)
    for k in range(bodies.shape[0]):
        body, out = bodies[k], results[k]
        for j in range(6):
            state[j] = 0.0
        for j in range(8):
            out[j] = -1.0 if j in (2, 3) else 0.0
        _follow(x, z, ratio, maxima, dt, peak, body, initial[k], tail, until[k], refine, rest, state, out, history)
