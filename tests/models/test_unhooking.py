"""Works flush with their wall against closed forms, an independent integration, and the proof of the bound."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar
from shaking import along_x, random_motion, turned

from pipeline import Motion, respond, trace
from pipeline.kernels import samples
from pipeline.kernels.hung_plate import hung_plate_batch
from pipeline.models import model_named
from pipeline.models.unhooking import rise_share
from pipeline.quantities import Array, G

BODY = {"hook_height": 0.2, "hook_offset": 0.02, "gyration": 0.3, "restitution": 0.3}
UNHOOKING = model_named("unhooking")


def vertical(z: Array, dt: float) -> Motion:
    return Motion(dt, np.vstack([np.zeros_like(z), np.zeros_like(z), z]))


@pytest.mark.parametrize(("times", "seconds"), [(1.5, 0.05), (2.0, 0.1), (3.0, 0.04)])
def test_a_pulse_downwards_lifts_it_as_newmarks_block_slides(times: float, seconds: float) -> None:
    """A (A - g) t^2 / (2 g): exact for a rectangle; the two ramps of 1e-4 s are 2e-4 / t of it at most, 1 %."""
    dt, a = 1e-4, times * G
    z = np.zeros(round(0.6 / dt))
    z[100 : 100 + round(seconds / dt)] = -a
    row = respond("unhooking", vertical(z, dt), **BODY).iloc[0]
    assert row["lift"] == pytest.approx(a * (a - G) * seconds**2 / (2.0 * G), rel=1e-2)
    assert row["opening"] == 0.0


def test_under_less_than_g_downwards_nothing_lifts_it() -> None:
    """A vertical shaking that never reaches g lifts no work that stays shut: 0.999 g does not, 1.01 g does."""
    t = np.arange(2000) * 1e-3
    for times, lifts in ((0.999, False), (1.01, True)):
        motion = vertical(times * G * np.sin(20.0 * t), 1e-3)
        assert (respond("unhooking", motion, **BODY)["lift"].iloc[0] > 0.0) == lifts
        told = UNHOOKING.certificate
        assert told is not None
        given = {name: np.array([value]) for name, value in {**BODY, "hooks_open": 1.0}.items()}
        assert (told(motion.excitation(None), given)[0] > 0.0) == lifts


@pytest.mark.parametrize("times", [1.2, 2.0])
def test_one_cycle_of_a_sine_lifts_it_as_a_ball_on_a_table(times: float) -> None:
    """It leaves where A sin(w t) = -g and is free: a parabola less the sine; (w dt)^2 = 4e-4."""
    a, w, dt = times * G, 20.0, 1e-3
    t = np.arange(round(1.2 / dt)) * dt
    cycle = np.where(t <= 2.0 * np.pi / w, a * np.sin(w * t), 0.0)
    begin = (np.pi + np.arcsin(G / a)) / w

    def height(at: float) -> float:
        s = at - begin
        return -0.5 * G * s**2 + a / w**2 * (np.sin(w * at) - np.sin(w * begin)) - a / w * np.cos(w * begin) * s

    # The peak lies within the cycle, where the height is this.
    top = minimize_scalar(lambda at: -height(at), bounds=(begin, 2.0 * np.pi / w), method="bounded")
    expected = -top.fun
    late = 2.0 * np.pi / w
    speed = (height(late) - height(late - 1e-7)) / 1e-7
    expected = max(expected, height(late) + max(speed, 0.0) ** 2 / (2.0 * G))
    lift = respond("unhooking", vertical(cycle, dt), **BODY)["lift"].iloc[0]
    assert lift == pytest.approx(expected, rel=2e-3)


def test_it_opens_where_the_push_overcomes_its_lean_and_no_sooner() -> None:
    """|a| L > g c: just below it rests exactly."""
    limit = G * BODY["hook_offset"] / BODY["hook_height"]
    for times, opens in ((0.999, False), (1.001, True)):
        row = respond("unhooking", along_x(np.full(50, times * limit), 0.01), tail=0.0, **BODY).iloc[0]
        assert (row["opening"] > 0.0) == opens


@pytest.mark.parametrize("times", [0.2, 0.5, 0.9])
def test_a_sudden_push_opens_it_as_far_as_energy_says(times: float) -> None:
    """a (x - c) = g (z + L) at the farthest, x and z of the centre of gravity: no speed, nothing lost before; 1e-5."""
    a, length, offset = times * G, BODY["hook_height"], BODY["hook_offset"]

    def balance(theta: float) -> float:
        out = offset * np.cos(theta) + length * np.sin(theta) - offset
        up = offset * np.sin(theta) - length * np.cos(theta) + length
        return float(a * out - G * up)

    expected = brentq(balance, 1e-3, 3.0)
    row = respond("unhooking", along_x(np.full(801, a), 2e-3), tail=0.0, **BODY).iloc[0]
    assert row["opening"] == pytest.approx(expected, rel=1e-5)
    assert row["lift"] == 0.0


def test_a_blow_on_the_wall_is_as_fast_as_energy_says() -> None:
    """Held open by a steady push and let go, it comes back with what it fell: K w^2 / 2 = g (z + L); slow ramp, 1 %."""
    a, dt = 0.5 * G, 5e-3
    t = np.arange(round(60.0 / dt)) * dt
    push = np.where(t < 55.0, a * np.minimum(t / 50.0, 1.0), 0.0)
    row = respond("unhooking", along_x(push, dt), **BODY).iloc[0]
    length, offset, k = BODY["hook_height"], BODY["hook_offset"], BODY["gyration"]
    # At rest the plumb line leans by a / g.
    theta = np.arctan(a / G) - np.arctan(offset / length)
    up = offset * np.sin(theta) - length * np.cos(theta) + length
    speed = np.sqrt(2.0 * G * up / (k**2 + length**2 + offset**2))
    assert row["slap"] == pytest.approx(speed * (length + np.sqrt(3.0) * k), rel=1e-2)


# ----- An independent integration: the plate as two point masses, its equations from their positions alone.


def _places(q: Array) -> Array:
    # Of two halves of the mass, k above and below the centre of gravity: x from the wall, z up.
    theta, h = q
    down = np.array([np.sin(theta), -np.cos(theta)])
    out = np.array([np.cos(theta), np.sin(theta)])
    centre = np.array([0.0, h]) + BODY["hook_height"] * down + BODY["hook_offset"] * out
    return np.concatenate([centre + BODY["gyration"] * down, centre - BODY["gyration"] * down])


def _jacobian(q: Array) -> Array:
    step = 1e-5
    return np.column_stack([(_places(q + step * e) - _places(q - step * e)) / (2.0 * step) for e in np.eye(2)])


def _free(q: Array, v: Array, a: float, n: float) -> tuple[Array, Array]:
    """Return mass matrix and generalised force, from d'Alembert's principle."""
    j, step = _jacobian(q), 1e-4
    turn = (_places(q + step * v) - 2.0 * _places(q) + _places(q - step * v)) / step**2
    pulled = np.array([-a, -n, -a, -n]) - turn
    return 0.5 * j.T @ j, 0.5 * j.T @ pulled


def _follow(motion: Motion, dt: float) -> tuple[float, float]:
    """Return largest lift and opening: contacts as stops, solved as a complementarity problem for every little step.

    Time stepping of Moreau and Jean: impulses over a step of dt, which knows no events.
    """
    t = np.arange(round(motion.duration / dt)) * dt
    grid = np.arange(motion.samples) * motion.dt
    x, z = np.interp(t, grid, motion.acceleration[0]), G + np.interp(t, grid, motion.acceleration[2])
    q, v = np.zeros(2), np.zeros(2)
    most = np.zeros(2)
    for a, n in zip(x, z, strict=True):
        middle = q + 0.5 * dt * v
        mass, force = _free(middle, v, a, n)
        inverse = np.linalg.inv(mass)
        closed = [i for i in range(2) if middle[i] <= 0.0]
        smooth = v + dt * inverse @ force
        new = smooth
        if closed:
            new = min(
                (_with(inverse, smooth, v, some) for some in _subsets(closed)),
                key=lambda pair: pair[1],
            )[0]
        q = middle + 0.5 * dt * new
        v = new
        most = np.maximum(most, q)
    return float(most[1]), float(most[0])


def _subsets(closed: list[int]) -> list[list[int]]:
    return [[], *[[i] for i in closed], *([closed] if len(closed) > 1 else [])]


def _with(inverse: Array, smooth: Array, before: Array, some: list[int]) -> tuple[Array, float]:
    # Speeds after the step with impulses at some contacts; and by how much that breaks the rules of contact.
    e = BODY["restitution"]
    wanted = -e * np.minimum(before, 0.0)
    impulse = np.zeros(2)
    if some:
        impulse[some] = np.linalg.solve(inverse[np.ix_(some, some)], (wanted - smooth)[some])
    after = smooth + inverse @ impulse
    return after, float(np.maximum(-impulse, 0.0).sum() + np.maximum(wanted - after, 0.0).sum())


@pytest.mark.parametrize("seed", [4, 10, 13])
def test_an_independent_integration_agrees(seed: int) -> None:
    """Time stepping on two point masses, of first order: steps of 2e-4 s are 1 % of 20 ms; 1 % granted."""
    motion = random_motion(seed, n=45, dt=0.01, pga=14.0, vertical=1.0)
    results = np.empty((1, 4))
    body = [np.array([BODY[name]]) for name in ("hook_height", "hook_offset", "gyration", "restitution")]
    x, z = samples(motion.acceleration[0]), samples(motion.acceleration[2])
    hung_plate_batch(x, z, motion.dt, 20.0, *body, 0.0, 4, results, np.empty((0, 2)))
    lift, opening = _follow(motion, 2e-4)
    assert lift > 1e-3
    assert results[0, 0] == pytest.approx(lift, rel=0.01)
    assert results[0, 1] == pytest.approx(opening, rel=0.01)


def test_the_plate_in_flight_is_free() -> None:
    """Once off hooks and wall, it falls freely: an independent integrator from a state of the trace."""
    z = np.zeros(400)
    z[20:60] = -2.0 * G
    push = np.zeros(400)
    push[:60] = 0.8 * G
    motion = Motion(1e-3, np.vstack([-push, 0.0 * push, z]))
    seen = trace("unhooking", motion, **BODY)
    theta, h = seen["opening"].to_numpy(), seen["lift"].to_numpy()
    off = np.flatnonzero((theta > 1e-3) & (h > 1e-4))
    a, b = int(off[5]), int(off[5]) + 20
    q = np.array([theta[a], h[a]])
    v = np.array([theta[a + 1] - theta[a - 1], h[a + 1] - h[a - 1]]) / (2.0 * motion.dt)

    def rates(t: float, y: Array) -> Array:
        at = np.clip(t / motion.dt, 0, motion.samples - 1)
        x, up = (np.interp(at, np.arange(motion.samples), motion.acceleration[row]) for row in (0, 2))
        mass, force = _free(y[:2], y[2:], float(x), G + float(up))
        return np.concatenate([y[2:], np.linalg.solve(mass, force)])

    end = solve_ivp(rates, (a * motion.dt, b * motion.dt), [*q, *v], rtol=1e-8, atol=1e-10, max_step=1e-3).y[:2, -1]
    # The speeds at the start are differences of samples: (1e-3 s)^2 / 6 of a jerk of g in 0.1 s, times 20 ms.
    assert end == pytest.approx([theta[b], h[b]], rel=2e-3, abs=2e-5)


# ----- The bound.


def test_the_share_of_the_push_is_the_largest_of_all_openings() -> None:
    """mu = max over psi of lambda sin cos / (1 - lambda sin^2), on a grid of 1e-5 rad."""
    psi = np.linspace(0.0, 0.5 * np.pi, 150_001)
    for length, offset, k in ((0.2, 0.02, 0.3), (0.5, 0.0, 0.5 / np.sqrt(3.0)), (0.1, 0.05, 0.1)):
        share = (length**2 + offset**2) / (length**2 + offset**2 + k**2)
        every = share * np.sin(psi) * np.cos(psi) / (1.0 - share * np.sin(psi) ** 2)
        given = {"hook_height": length, "hook_offset": offset, "gyration": k}
        mu = rise_share({name: np.array([value]) for name, value in given.items()})
        assert mu[0] == pytest.approx(every.max(), rel=1e-8)
    # From the upper edge of a thin frame, H / 2 and H / sqrt(12): 3/4.
    edge = {"hook_height": np.array([0.5]), "hook_offset": np.array([0.0]), "gyration": np.array([1.0 / np.sqrt(12.0)])}
    assert rise_share(edge)[0] == pytest.approx(0.75, rel=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_nothing_that_the_certificate_lets_pass_is_lifted(seed: int) -> None:
    """Integrated all the same: a lift of exactly nothing."""
    rng = np.random.default_rng(seed)
    n = 60
    height = rng.uniform(0.2, 2.0, n)
    bodies = {
        "hook_height": height * rng.uniform(0.05, 0.5, n),
        "hook_offset": rng.uniform(0.0, 0.05, n),
        "gyration": height / np.sqrt(12.0),
        "restitution": rng.uniform(0.0, 0.9, n),
        "hooks_open": np.ones(n),
    }
    motion = random_motion(seed, n=300, dt=0.02, pga=rng.uniform(4.0, 16.0), vertical=(0.3, 0.6)[seed % 2])
    told = UNHOOKING.certificate
    assert told is not None
    stays = told(motion.excitation(None), bodies) == 0.0
    lift = UNHOOKING.run(motion.excitation(0.0), bodies, 1, False)["lift"]
    assert stays.any()
    assert (lift[stays] == 0.0).all()


def test_a_strong_push_across_the_wall_lifts_what_no_bound_holds() -> None:
    """The bound is not idle: at 2 g across and 0.9 g down a work hung from its edge rises."""
    t = np.arange(600) * 0.01
    motion = Motion(0.01, np.vstack([2.0 * G * np.sin(6.0 * t), 0.0 * t, 0.9 * G * np.sin(9.0 * t)]))
    edge = {**BODY, "hook_height": 0.5, "gyration": 0.29}
    assert respond("unhooking", motion, **edge)["lift"].iloc[0] > 0.0
    assert respond("unhooking", motion, hooks_open=0.0, **edge)["lift"].iloc[0] == 0.0


# ----- The load on its hangers.


def test_the_load_is_weight_and_inertia() -> None:
    """1 + a_z / g under a vertical push, sqrt(1 + (a / g)^2) under one sideways, whichever way that points."""
    up = np.array([0.0, 0.5 * G, 0.0])
    assert respond("hanger_load", vertical(up, 0.1))["load"].iloc[0] == pytest.approx(1.5)
    side = along_x(up, 0.1)
    for degrees in (0.0, 30.0, 135.0):
        load = respond("hanger_load", turned(side, degrees), amplification=2.0)["load"].iloc[0]
        assert load == pytest.approx(2.0 * np.hypot(1.0, 0.5), rel=1e-12)


def test_what_stays_on_its_hooks_pulls_hardly_more_than_the_closed_form() -> None:
    """The range of the table: of plates under 0.5 g the pull, from the trace, is 0.9 to 1.5 times the closed form."""
    motion = random_motion(11, n=600, dt=0.005, pga=5.0, vertical=0.5)
    closed = respond("hanger_load", Motion(motion.dt, motion.acceleration * np.array([[1.0], [0.0], [1.0]])))
    for share in (0.1, 0.3, 0.5):
        body = {**BODY, "hook_height": share, "gyration": 1.0 / np.sqrt(12.0)}
        theta = trace("unhooking", motion, **body)["opening"].to_numpy()
        rate = np.gradient(theta, motion.dt)
        a, n = motion.acceleration[0], G + motion.acceleration[2]
        length, offset = share, BODY["hook_offset"]
        out = length * np.cos(theta) - offset * np.sin(theta)
        up = length * np.sin(theta) + offset * np.cos(theta)
        turn = -(a * out + n * up) / (length**2 + offset**2 + 1.0 / 12.0)
        open_ = theta > 1e-3
        pull = np.hypot(a + out * turn - up * rate**2, n + up * turn + out * rate**2)[open_].max() / G
        assert pull <= 1.5 * closed["load"].iloc[0]
