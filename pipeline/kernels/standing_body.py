r"""What a standing body is, where it is, and which way it moves on: the modes of a rigid body on a rough surface.

It rests, slides, rocks about an edge, rocks about an edge that slips, or flies.  At rest on its base it stays while

.. math::

    |a| \le \mu_s n, \qquad -s a \le n \tan \alpha_s, \qquad n \ge 0

with a [m/s2] the push, n = g + a_z [m/s2] the weight per mass, mu_s [-] the friction at rest and alpha_s [rad] the
slenderness towards the edge of side s = +1 or -1.  What slides on its base does not tilt while mu_k <= tan(alpha_s), s
the direction of the slip; what rocks does not slip while ``|F|`` <= mu_s N, F and N [m/s2] the forces on the edge.

References
----------
Shenton, H. W. (1996). Criteria for initiation of slide, rock, and slide-rock rigid-body modes. Journal of Engineering
Mechanics 122, 690-693.
Taniguchi, T. (2002). Non-linear response analyses of rectangular rigid bodies subjected to horizontal and vertical
ground motion. Earthquake Engineering and Structural Dynamics 31, 1481-1500.
"""

import math

from pipeline.kernels import fused, inner
from pipeline.kernels.corner_impact import held, impulse
from pipeline.kernels.rocking import COUNTED, OVERTURNED, SETTLING
from pipeline.quantities import Array, G

# A body.  Of what there are two the first is of the edge towards +axis, the second of the other: slenderness [rad], its
# sine, cosine and tangent, R / (rho^2 + R^2) [1/m], R [m], distance of the edge from the centre of gravity along the
# base [m], and what the rate after a landing from that edge is multiplied by, beside Housner's, and taken of the rate
# before where Housner's is 0 [-].
ALPHA, SINE, COSINE, TANGENT, INVERSE, ARM, HALF, GAIN, DIRECT = 0, 2, 4, 6, 8, 10, 12, 14, 16
RHO2, HEIGHT, MU_S, MU_K, SLOW, LOSS = range(18, 24)
"""Radius of gyration squared [m2], height of the centre of gravity [m], frictions [-], the smaller p alpha [rad/s], and
1 less the product of both restitutions [-]."""
BODY = 24
"""Numbers of a body."""

# Where it is: mode, side of the edge, rotation about it [rad] and its rate [rad/s], sine and cosine of alpha - phi, how
# far the edge has slipped [m], its velocity [m/s] and direction.  In flight side +1, and the centre of gravity from
# where it stood [m], its height, and their rates [m/s].  Whether friction is taken to hold for a step.  How long the
# impacts that a rest cut off would go on, and until when [s].
MODE, SIDE, PHI, RATE, SN, CS, U, V, WAY, X, Y, VX, VY, HOLD, LINGERS, UNTIL = range(16)
STATE = 16
"""Numbers of a state."""

RESTS, SLIDES, ROCKS, SLIDE_ROCKS, FLIES = 0.0, 1.0, 2.0, 3.0, 4.0

RATIO, FELL, FELL_AT, LIFTED_AT, IMPACTS, FLAGS, LAST_NEAR, RESTED, AWAY, RESIDUAL = range(10)
"""What is found: as of a rocking body; the largest displacement of the middle of the base and, with its
sign, the last [m]."""
FOUND = 10

FALLING = 1.2
"""Rotation [rad] from which on the base is not followed: what it does then is the fall's."""

EDGEWISE = 1.0 + 1e-9
"""How much more than tan(alpha) a friction must be to tilt what slides: equal ones, rounded, must not."""

JAM = 0.1
"""Share of its inertia from which on a slipping edge jams (Painleve): friction then presses it down without a limit.
It takes a friction above 4/3 for a rectangle."""


@inner
def stand_on(state: Array, s: float, body: Array) -> None:
    """Put a body that is flat on the edge of a side.

    Parameters
    ----------
    state, body : ndarray
        As above.
    s : float
        The side.
    """
    i = 0 if s > 0.0 else 1
    state[SIDE], state[PHI] = s, 0.0
    state[SN], state[CS] = body[SINE + i], body[COSINE + i]


@fused
def spare_friction(
    rate: float, sn: float, cs: float, a: float, n: float, s: float, c: float, arm: float, mu: float
) -> tuple[float, float]:
    """Return how much more friction a rocking edge has than it needs, and the direction in which it would slip.

    Parameters
    ----------
    rate, sn, cs, a, n, s
        As in `pipeline.kernels.slip_phase.slip_accelerations`.
    c, arm : float
        R / (rho^2 + R^2) [1/m] and R [m] of the edge.
    mu : float
        Friction at rest [-].

    Returns
    -------
    tuple of float
        In m/s2, and 1 or -1.
    """
    turn, square = -c * (n * sn + s * a * cs), rate * rate
    along = a + s * arm * (cs * turn + sn * square)
    normal = n + arm * (sn * turn - cs * square)
    return mu * normal - abs(along), (-1.0 if along > 0.0 else 1.0)


@inner
def jams(state: Array, way: float, body: Array) -> bool:
    """Say whether an edge cannot slip in a direction, because friction would press it down without a limit.

    Parameters
    ----------
    state, body : ndarray
        As above.
    way : float
        The direction.

    Returns
    -------
    bool
        See JAM.
    """
    i = 0 if state[SIDE] > 0.0 else 1
    q = state[SN] - state[SIDE] * way * body[MU_K] * state[CS]
    return 1.0 + body[ARM + i] * body[ARM + i] * state[SN] * q / body[RHO2] < JAM


@inner
def jam(state: Array, body: Array) -> None:
    """Stop the slip of an edge at once.

    Parameters
    ----------
    state, body : ndarray
        As above.
    """
    s = state[SIDE]
    i = 0 if s > 0.0 else 1
    rx, ry = s * body[ARM + i] * state[SN], -body[ARM + i] * state[CS]
    px, py = held(state[V], 0.0, rx, ry, body[RHO2])
    state[RATE] += s * (ry * px - rx * py) / body[RHO2]
    state[V], state[WAY], state[MODE], state[HOLD] = 0.0, 0.0, ROCKS, 1.0


@inner
def fly(state: Array, body: Array) -> None:
    """Let a body go that stands on an edge, or flat.

    Parameters
    ----------
    state, body : ndarray
        As above.
    """
    s, r = state[SIDE], state[RATE]
    i = 0 if s > 0.0 else 1
    arm = body[ARM + i]
    state[X], state[Y] = state[U] + s * (body[HALF + i] - arm * state[SN]), arm * state[CS]
    state[VX], state[VY] = state[V] + s * arm * state[CS] * r, arm * state[SN] * r
    state[MODE], state[SIDE], state[PHI], state[RATE] = FLIES, 1.0, s * state[PHI], s * r


@inner
def go_on_flat(state: Array, a: float, n: float, body: Array) -> None:
    """Choose how a body moves on that is flat on the surface and does not turn.

    Parameters
    ----------
    state, body : ndarray
        As above; the state has U, V, and WAY where what holds a resting body is just exceeded, else 0.
    a, n : float
        Push and weight per mass, m/s2.
    """
    v, way = state[V], state[WAY]
    beyond = v == 0.0 and way != 0.0
    if not beyond:
        way = (1.0 if v > 0.0 else -1.0) if v != 0.0 else (-1.0 if a > 0.0 else 1.0)
    stand_on(state, way, body)
    state[RATE], state[WAY] = 0.0, way
    i = 0 if way > 0.0 else 1
    tips = body[TANGENT + i] * EDGEWISE
    if n < 0.0:
        fly(state, body)
    elif v != 0.0 and body[MU_K] > tips and jams(state, way, body):
        jam(state, body)
    elif v != 0.0:
        state[MODE] = SLIDE_ROCKS if body[MU_K] > tips else SLIDES
    elif not beyond and abs(a) <= min(body[TANGENT + i], body[MU_S]) * n:
        state[MODE], state[WAY] = RESTS, 0.0
    elif body[MU_S] <= tips:
        state[MODE] = SLIDES
    else:
        spare, _way = spare_friction(0.0, state[SN], state[CS], a, n, way, body[INVERSE + i], body[ARM + i], body[MU_S])
        if spare >= 0.0 or jams(state, way, body):
            state[MODE] = ROCKS
        else:
            state[MODE] = SLIDE_ROCKS if body[MU_K] > tips else SLIDES


@inner
def go_on_tilted(state: Array, a: float, n: float, body: Array) -> None:
    """Choose how a body moves on that stands on an edge.

    Parameters
    ----------
    state, body : ndarray
        As above.
    a, n : float
        Push and weight per mass, m/s2.
    """
    i = 0 if state[SIDE] > 0.0 else 1
    way = 1.0 if state[V] > 0.0 else -1.0
    if state[V] == 0.0:
        spare, way = spare_friction(
            state[RATE], state[SN], state[CS], a, n, state[SIDE], body[INVERSE + i], body[ARM + i], body[MU_S]
        )
        if spare >= 0.0 or jams(state, way, body):
            state[MODE], state[WAY] = ROCKS, 0.0
            return
    state[MODE], state[WAY] = SLIDE_ROCKS, way


@inner
def stopped(v: float, py: float, body: Array) -> float:
    """Return the velocity along the surface that an impulse on the whole base leaves.

    Parameters
    ----------
    v : float
        Velocity before, m/s.
    py : float
        The impulse that presses the base down, per mass, m/s.
    body : ndarray
        As above.

    Returns
    -------
    float
        In m/s.
    """
    if abs(v) <= body[MU_S] * py:
        return 0.0
    return math.copysign(max(0.0, abs(v) - body[MU_K] * max(0.0, py)), v)


@inner
def hit(state: Array, a: float, n: float, body: Array, out: Array) -> None:
    """Let the edge of the state's side hit the surface after a flight, in the position and with the rates of the state.

    Parameters
    ----------
    state, body, out : ndarray
        As above; PHI and RATE are of the edge.
    a, n : float
        Push and weight per mass, m/s2.
    """
    s, r = state[SIDE], state[RATE]
    i = 0 if s > 0.0 else 1
    rx, ry = s * body[ARM + i] * state[SN], -body[ARM + i] * state[CS]
    cx, cy = state[VX] + s * r * ry, state[VY] - s * r * rx
    if -cy >= COUNTED * body[SLOW] * (body[HALF] + body[HALF + 1]):
        out[IMPACTS] += 1.0
    flat = r == 0.0 and state[PHI] == 0.0
    if flat:
        # A flat base comes down as a whole, unless friction tips it over its leading edge.
        s = -1.0 if cx < 0.0 else 1.0
        i = 0 if s > 0.0 else 1
        stand_on(state, s, body)
        grip = abs(cx) if abs(cx) <= -body[MU_S] * cy else -body[MU_K] * cy
        rx, flat = s * body[HALF + i], grip <= -body[TANGENT + i] * EDGEWISE * cy
    if flat:
        cx = stopped(cx, -cy, body)
    elif cy < 0.0:
        px, py, cx = impulse(cx, cy, rx, ry, body[RHO2], body[MU_S], body[MU_K])
        state[RATE] = r + s * (ry * px - rx * py) / body[RHO2]
    state[V], state[WAY] = cx, 0.0
    if state[PHI] == 0.0 and state[RATE] <= 0.0:
        go_on_flat(state, a, n, body)
    else:
        go_on_tilted(state, a, n, body)


@inner
def land(state: Array, a: float, n: float, rest: float, body: Array, out: Array) -> None:
    """Let a rocking body, back at phi = 0 with a rate below 0, land on its other edge.

    Parameters
    ----------
    state, body, out : ndarray
        As above.
    a, n : float
        Push and weight per mass, m/s2.
    rest : float
        Rate, as a share of the smaller p alpha, below which it is taken to turn no more.
    """
    s, r, v = state[SIDE], min(0.0, state[RATE]), state[V]
    i, j = (0, 1) if s > 0.0 else (1, 0)
    height = body[HEIGHT]
    if -r >= COUNTED * body[SLOW]:
        out[IMPACTS] += 1.0
    rate, slip = 0.0, v
    if r < 0.0:
        width = body[HALF + i] + body[HALF + j]
        rx = -s * body[HALF + j]
        px, py, slip = impulse(v, width * r, rx, -height, body[RHO2], body[MU_S], body[MU_K])
        # About the other edge it turns on: with the opposite sign of phi.
        rate = -r - s * (-height * px - rx * py) / body[RHO2]
        rate = body[GAIN + i] * rate - body[DIRECT + i] * r
        if rate <= 0.0:
            # The edge that it turned about holds it too: the whole base stops.
            vx, py = v + s * height * r, -body[HALF + i] * r
            slip = stopped(vx, py, body)
    stand_on(state, -s, body)
    state[V], state[WAY] = slip, 0.0
    if rate < rest * body[SLOW]:
        # A hop takes twice its rate over what pulls the body down, and each is shorter by the same share.
        down = body[INVERSE + j] * (n * state[SN] - s * a * state[CS]) * body[LOSS]
        state[LINGERS] = SETTLING * 4.0 * rate / down if down > 0.0 else math.inf
        state[RATE] = 0.0
        go_on_flat(state, a, n, body)
    else:
        state[RATE] = rate
        go_on_tilted(state, a, n, body)


@inner
def sway(state: Array, body: Array) -> float:
    """Return the velocity of the middle of the base against the edge that the body turns about.

    Parameters
    ----------
    state, body : ndarray
        As above.

    Returns
    -------
    float
        In m/s.
    """
    i = 0 if state[SIDE] > 0.0 else 1
    sine = body[SINE + i] * state[CS] - body[COSINE + i] * state[SN]
    return state[SIDE] * 0.5 * (body[HALF] + body[HALF + 1]) * sine * state[RATE]


@inner
def drift(state: Array, body: Array) -> float:
    """Return the velocity of the middle of the base against the centre of gravity of a body that flies.

    Parameters
    ----------
    state, body : ndarray
        As above.

    Returns
    -------
    float
        Along the surface, m/s.
    """
    middle, phi = 0.5 * (body[HALF] - body[HALF + 1]), state[PHI]
    return -(middle * math.sin(phi) + body[HEIGHT] * math.cos(phi)) * state[RATE]


@inner
def lies(at: float, alpha: float, out: Array) -> None:
    """Note that a body fell.

    Parameters
    ----------
    at : float
        When, s.
    alpha : float
        Its slenderness towards that side, rad.
    out : ndarray
        As above.
    """
    out[RATIO] = max(out[RATIO], OVERTURNED / alpha)
    out[FELL], out[FELL_AT] = 1.0, at


@inner
def track(state: Array, body: Array, out: Array) -> float:
    """Note how far the middle of the base is from where it stood, and return it with its sign [m].

    Parameters
    ----------
    state, body, out : ndarray
        As above.

    Returns
    -------
    float
        In m.
    """
    if state[MODE] == FLIES:
        middle, phi = 0.5 * (body[HALF] - body[HALF + 1]), state[PHI]
        place = state[X] - middle * (1.0 - math.cos(phi)) - body[HEIGHT] * math.sin(phi)
        if abs(phi) > max(FALLING, body[ALPHA]) * EDGEWISE:
            return place
    else:
        s = state[SIDE]
        i = 0 if s > 0.0 else 1
        cosine = body[COSINE + i] * state[CS] + body[SINE + i] * state[SN] if state[PHI] != 0.0 else 1.0
        place = state[U] + s * 0.5 * (body[HALF] + body[HALF + 1]) * (1.0 - cosine)
        if state[PHI] > max(FALLING, body[ALPHA + i]) * EDGEWISE:
            return place
    out[AWAY] = max(out[AWAY], abs(place))
    out[RESIDUAL] = place
    return place


@inner
def calm(state: Array, near: float, body: Array) -> bool:
    """Say whether, left alone, a body stays below a ratio: its speed would lift it by no more than that.

    Parameters
    ----------
    state, body : ndarray
        As above.
    near : float
        The ratio [-].

    Returns
    -------
    bool
        Never in flight.
    """
    i = 0 if state[SIDE] > 0.0 else 1
    alpha, c = body[ALPHA + i], body[INVERSE + i]
    slow = state[RATE] * state[RATE] <= 2.0 * near * alpha * alpha * c * G
    return state[MODE] != FLIES and state[PHI] <= near * alpha and slow
