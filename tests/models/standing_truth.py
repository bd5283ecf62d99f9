"""A standing body by another method: Cartesian coordinates, forces from a linear system, DOP853 with located events.

``python -m tests.models.standing_truth`` writes tests/data/golden/standing.json anew (some minutes).
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from pipeline.quantities import Array, G

RTOL, ATOL = 1e-12, 1e-15
FILE = Path(__file__).resolve().parents[1] / "data" / "golden" / "standing.json"
FALLING = 1.2


@dataclass
class Block:
    """A body with corners at (b1, -h) and (-b2, -h) from its centre of gravity; theta is positive towards +x."""

    b1: float
    b2: float
    h: float
    mu_s: float
    mu_k: float
    factor: float = 1.0
    mode: str = "flat"
    way: float = 0.0
    state: Array = field(default_factory=lambda: np.zeros(6))  # x, y, theta and their rates
    most: float = 0.0
    away: float = 0.0
    last: float = 0.0
    impacts: int = 0
    fell: float | None = None

    def __post_init__(self) -> None:
        """Stand still."""
        self.rho2 = (self.b1**2 + self.h**2) / 3.0
        self.state[1] = self.h
        self.alpha = (math.atan2(self.b1, self.h), math.atan2(self.b2, self.h))
        paces = [math.sqrt(G * math.hypot(b, self.h) / (self.rho2 + b * b + self.h**2)) for b in (self.b1, self.b2)]
        self.slow = min(p * a for p, a in zip(paces, self.alpha, strict=True))

    def corner(self, side: float, theta: float) -> tuple[float, float]:
        """Return where a corner is from the centre of gravity: theta turns clockwise."""
        x, y = (self.b1 if side > 0 else -self.b2), -self.h
        return x * math.cos(theta) + y * math.sin(theta), -x * math.sin(theta) + y * math.cos(theta)

    def middle(self, y: Array) -> float:
        """Return how far the middle of the base is from where it stood."""
        m = 0.5 * (self.b1 - self.b2)
        return float(y[0] + m * math.cos(y[2]) - self.h * math.sin(y[2]) - m)

    def forces(self, y: Array, a: float, n: float) -> tuple[Array, float, float]:
        """Return accelerations and the forces F, N of the present mode."""
        if self.mode == "air":
            return np.array([-a, -n, 0.0]), 0.0, 0.0
        if self.mode in ("flat", "slide"):
            f = a if self.mode == "flat" else -self.way * self.mu_k * n
            return np.array([f - a, 0.0, 0.0]), f, n
        side = 1.0 if self.mode.endswith("+") else -1.0
        rx, ry = self.corner(side, y[2])
        w2 = y[5] ** 2
        # Unknown: x'', y'', theta'', F, N.
        matrix = np.array(
            [
                [1.0, 0.0, 0.0, -1.0, 0.0],
                [0.0, 1.0, 0.0, 0.0, -1.0],
                [0.0, 0.0, self.rho2, -ry, rx],
                [0.0, 1.0, -rx, 0.0, 0.0],
                [1.0, 0.0, ry, 0.0, 0.0]
                if self.mode.startswith("rock")
                else [0.0, 0.0, 0.0, 1.0, self.way * self.mu_k],
            ]
        )
        right = np.array([-a, -n, 0.0, w2 * ry, w2 * rx if self.mode.startswith("rock") else 0.0])
        solved = np.linalg.solve(matrix, right)
        return solved[:3], float(solved[3]), float(solved[4])

    def slip(self, y: Array, side: float) -> float:
        """Return the velocity of a corner along the surface."""
        return float(y[3] + y[5] * self.corner(side, y[2])[1])

    def choose(self, a: float, n: float) -> None:
        """Choose the mode of a body that touches with one corner, or lies flat, from the laws of friction."""
        y = self.state
        if self.mode in ("flat", "slide"):
            v = y[3]
            if n < 0.0:
                self.mode = "air"
                return
            if v == 0.0:
                s = -1.0 if a > 0.0 else 1.0
                b = self.b1 if s > 0 else self.b2
                lifts, slides = abs(a) * self.h - n * b, abs(a) - self.mu_s * n
                if max(lifts, slides) <= 1e-12 * n:
                    self.mode = "flat"
                elif b / self.h < self.mu_s:
                    self.mode, self.way = ("rock+" if s > 0 else "rock-"), 0.0
                    _acc, f, normal = self.forces(y, a, n)
                    if abs(f) > self.mu_s * normal:
                        self.mode, self.way = ("slip+" if s > 0 else "slip-"), s
                        if self.mu_k * self.h <= b:
                            self.mode = "slide"
                else:
                    self.mode, self.way = "slide", s
                return
            s = math.copysign(1.0, v)
            b = self.b1 if s > 0 else self.b2
            self.way = s
            self.mode = ("slip+" if s > 0 else "slip-") if self.mu_k * self.h > b * (1.0 + 1e-9) else "slide"
            return
        side = 1.0 if self.mode.endswith("+") else -1.0
        v = self.slip(y, side)
        mark = self.mode[-1]
        if abs(v) <= 1e-13:
            self.mode = "rock" + mark
            _acc, f, normal = self.forces(y, a, n)
            if abs(f) <= self.mu_s * normal:
                return
            v = -f
        self.mode, self.way = "slip" + mark, math.copysign(1.0, v)

    def hit(self, side: float) -> None:
        """Let a corner hit the surface: Routh's impulse in the plane of (along, across), no rebound."""
        y = self.state
        rx, ry = self.corner(side, y[2])
        # Rows: what an impulse along and across does to the corner's velocity.
        turn = np.array([ry, -rx])
        inverse = np.eye(2) + np.outer(turn, turn) / self.rho2
        v, total = np.array([y[3] + y[5] * ry, y[4] - y[5] * rx]), np.zeros(2)
        for _phase in range(3):
            if v[1] >= -1e-15:
                break
            if abs(v[0]) > 1e-13:
                d = np.array([-math.copysign(self.mu_k, v[0]), 1.0])
                rate = inverse @ d
                amount = -v[1] / rate[1] if rate[1] > 0 else math.inf
                if rate[0] * v[0] < 0.0:
                    amount = min(amount, -v[0] / rate[0])
            else:
                v[0] = 0.0
                d = np.array([-inverse[0, 1] / inverse[0, 0], 1.0])
                if abs(d[0]) > self.mu_s:
                    d = np.array([math.copysign(self.mu_k, d[0]), 1.0])
                rate = inverse @ d
                amount = -v[1] / rate[1]
            total, v = total + amount * d, v + amount * rate
        y[3], y[4] = y[3] + total[0], y[4] + total[1]
        y[5] += float(turn @ total) / self.rho2
        if abs(v[0]) <= 1e-13:
            # It sticks: no rounding is left of its velocity.
            y[3] = -y[5] * ry

    def land(self, a: float, n: float) -> None:
        """Let the other corner of a rocking body land at theta = 0."""
        side = 1.0 if self.mode.endswith("+") else -1.0
        before, y = self.state.copy(), self.state
        y[2], y[1] = 0.0, self.h
        rate = abs(y[5])
        self.impacts += rate >= 1e-3 * self.slow
        slip = self.slip(y, -side)
        self.hit(-side)
        onwards = y[5] * before[5] > 0.0
        if onwards:
            v = self.slip(y, -side)
            y[5] *= self.factor
            y[3] = v + y[5] * self.h
            y[4] = y[5] * (self.b1 if -side > 0 else -self.b2)
        if not onwards:
            push = abs(before[4])
            y[3] = before[3]
            y[3] = 0.0 if abs(y[3]) <= self.mu_s * push else math.copysign(max(0.0, abs(y[3]) - self.mu_k * push), y[3])
        if not onwards or abs(y[5]) < 1e-4 * self.slow:
            if onwards:
                y[3] = self.slip(y, -side)
            y[4] = y[5] = 0.0
            self.mode = "slide"
            if slip == 0.0 and abs(y[3]) < 1e-13:
                y[3] = 0.0
        else:
            self.mode = "rock" + ("+" if side < 0 else "-")
        self.choose(a, n)

    def touch(self, side: float, a: float, n: float) -> None:
        """Let a corner of a flying body come down."""
        y = self.state
        rx, ry = self.corner(side, y[2])
        y[1] = -ry
        self.impacts += -(y[4] - y[5] * rx) >= 1e-3 * self.slow * (self.b1 + self.b2)
        if y[2] == 0.0 and y[5] == 0.0:
            s = -1.0 if y[3] < 0 else 1.0
            b, push = (self.b1 if s > 0 else self.b2), -y[4]
            stops = abs(y[3]) <= self.mu_s * push
            # What friction takes away along the surface must tip it over an edge.
            if (abs(y[3]) if stops else self.mu_k * push) * self.h <= b * push:
                y[3] = 0.0 if stops else math.copysign(max(0.0, abs(y[3]) - self.mu_k * push), y[3])
                y[4], self.mode = 0.0, "slide"
                self.choose(a, n)
                return
            side = s
        self.hit(side)
        self.mode = "rock" + ("+" if side > 0 else "-")
        self.choose(a, n)

    def note(self, y: Array) -> None:
        """Note the largest rotation and displacement."""
        self.most = max(self.most, y[2] / self.alpha[0], -y[2] / self.alpha[1])
        if abs(y[2]) <= max(FALLING, *self.alpha) * (1.0 + 1e-9):
            self.last = self.middle(y)
            self.away = max(self.away, abs(self.last))


def events(body: Block, pushes: Any) -> list[tuple[str, Any, float, bool]]:
    """Return what may happen in the present mode: name, function of (t, y), direction of its zero, whether it ends."""
    mode, side = body.mode, (1.0 if body.mode.endswith("+") else -1.0)
    listed: list[tuple[str, Any, float, bool]] = [
        ("turn", lambda _t, y: y[5], 0.0, False),
        (
            "sway",
            lambda _t, y: y[3] - y[5] * (0.5 * (body.b1 - body.b2) * math.sin(y[2]) + body.h * math.cos(y[2])),
            0.0,
            False,
        ),
        ("falls", lambda _t, y: abs(y[2]) - max(FALLING, *body.alpha), 1.0, False),
        ("lies", lambda _t, y: abs(y[2]) - 0.5 * math.pi, 1.0, True),
    ]
    if mode == "flat":
        for s, b in ((1.0, body.b1), (-1.0, body.b2)):
            hold = min(body.mu_s, b / body.h)
            listed.append(("go", lambda t, _y, s=s, hold=hold: -s * pushes(t)[0] - hold * pushes(t)[1], 1.0, True))
    elif mode == "slide":
        listed += [("stop", lambda _t, y: body.way * y[3], -1.0, True), ("up", lambda t, _y: pushes(t)[1], -1.0, True)]
    elif mode == "air":
        for s in (1.0, -1.0):
            listed.append((f"down{s:+.0f}", lambda _t, y, s=s: y[1] + body.corner(s, y[2])[1], -1.0, True))
    else:
        listed.append(("land", lambda _t, y: side * y[2], -1.0, True))
        if mode.startswith("rock"):

            def spare(t: float, y: Array) -> float:
                _acc, f, n = body.forces(y, *pushes(t))
                return body.mu_s * n - abs(f)

            listed.append(("slip", spare, -1.0, True))
        else:
            listed.append(("stop", lambda _t, y: body.way * body.slip(y, side), -1.0, True))
            listed.append(("up", lambda t, y: body.forces(y, *pushes(t))[2], -1.0, True))
    return listed


def follow(body: Block, x: Array, z: Array, dt: float, tail: float) -> Block:
    """Follow a body through a polygon of samples and a tail of nothing, until it lies."""
    ends = [i * dt for i in range(x.size)] + [(x.size - 1) * dt + 0.05 * k for k in range(1, round(tail / 0.05) + 1)]
    last = (x.size - 1) * dt

    for begin, end in pairwise(ends):
        i = min(x.size - 2, round(begin / dt)) if begin < last - 1e-9 else None

        def pushes(t: float, i: int | None = i) -> tuple[float, float]:
            if i is None:
                return 0.0, G
            share = t / dt - i
            return x[i] + share * (x[i + 1] - x[i]), G + z[i] + share * (z[i + 1] - z[i])

        t = begin
        if body.mode != "air":
            body.choose(*pushes(t))
        for _ in range(500):
            if t >= end - 1e-14 * max(1.0, end):
                break
            listed = events(body, pushes)
            functions = []
            for _name, call, direction, ends_it in listed:
                # A root at the very beginning is what has just happened.
                def guarded(now: float, y: Array, call: Any = call, t: float = t, past: float = -direction) -> float:
                    return float(call(now, y)) if now > t or past == 0.0 else past * 1e-300

                guarded.terminal, guarded.direction = ends_it, direction  # type: ignore[attr-defined]
                functions.append(guarded)

            def rates(now: float, y: Array) -> Array:
                return np.concatenate([y[3:], body.forces(y, *pushes(now))[0]])

            part = solve_ivp(
                rates, (t, end), body.state, method="DOP853", rtol=RTOL, atol=ATOL, events=functions, max_step=0.5 * dt
            )
            for row in part.y_events[:3]:
                for y in row:
                    body.note(y)
            t, body.state = float(part.t[-1]), part.y[:, -1].copy()
            body.note(body.state)
            if part.status != 1:
                break
            name = next(n for (n, _c, _d, stop), at in zip(listed, part.t_events, strict=True) if stop and at.size)
            a, n = pushes(t)
            if name == "lies":
                body.fell = t
                return body
            act(body, name, a, n)
    return body


def act(body: Block, name: str, a: float, n: float) -> None:
    """Do what an event asks for."""
    y = body.state
    if name == "land":
        body.land(a, n)
    elif name.startswith("down"):
        body.touch(float(name[4:]), a, n)
    elif name == "up":
        body.mode = "air"
    elif name == "go":
        # Just beyond what holds it.
        s = -1.0 if a > 0.0 else 1.0
        b = body.b1 if s > 0 else body.b2
        body.way = s
        if n <= 0.0:
            body.mode = "air"
        elif b / body.h < body.mu_s:
            body.mode = "rock" + ("+" if s > 0 else "-")
        else:
            body.mode = "slide"
    elif name == "stop" and body.mode == "slide":
        y[3] = 0.0
        body.choose(a, n)
    elif name == "stop":
        side = 1.0 if body.mode.endswith("+") else -1.0
        y[3] = -y[5] * body.corner(side, y[2])[1]
        body.choose(a, n)
    else:
        side = 1.0 if body.mode.endswith("+") else -1.0
        _acc, f, _n = body.forces(y, a, n)
        body.mode, body.way = "slip" + ("+" if side > 0 else "-"), -math.copysign(1.0, f)


def drawn(seed: int) -> dict[str, Any]:
    """Return a case: a body and a record of some tenths of g at 0.7 to 4 Hz, from a fixed seed."""
    rng = np.random.default_rng(seed)
    h = float(np.exp(rng.uniform(np.log(0.05), np.log(1.0))))
    slope = float(rng.uniform(0.12, 0.6))
    mu = float(slope * rng.uniform(0.8, 2.2))
    case: dict[str, Any] = {
        "name": f"standing_{seed}",
        "half_width": slope * h,
        "cg_height": h,
        "friction_static": mu,
        "friction_kinetic": mu * (1.0 if seed % 3 else 0.8),
        "half_width_other": slope * h * (1.0 if seed % 4 else float(rng.uniform(0.8, 1.3))),
        "restitution_factor": 1.0 if seed % 5 else 0.9,
    }
    f, n, dt = float(rng.uniform(0.7, 4.0)), 61, 0.02
    t = dt * np.arange(n)
    strength = G * min(slope, mu) * float(rng.uniform(1.0, 3.5))
    x = strength * np.sin(2.0 * np.pi * f * t + float(rng.uniform(0.0, 6.0)))
    lift = G * (0.0 if seed % 2 else (1.3 if seed % 8 == 0 else 0.4))
    z = lift * np.sin(2.0 * np.pi * 1.7 * f * t + 1.0)
    return case | {"dt": dt, "tail": 1.0, "x": [round(v, 6) for v in x], "z": [round(v, 6) for v in z]}


def solved(case: dict[str, Any], times: float = 1.0) -> Block:
    """Return the body of a case after its record."""
    body = Block(
        case["half_width"],
        case["half_width_other"],
        case["cg_height"],
        case["friction_static"],
        case["friction_kinetic"],
        case["restitution_factor"],
    )
    return follow(body, times * np.array(case["x"]), times * np.array(case["z"]), case["dt"], case["tail"])


def answered(case: dict[str, Any]) -> dict[str, Any]:
    """Return a case with its answer, and how much a part in ten million of the motion changes it."""
    body, nudged = solved(case), solved(case, 1.0 + 1e-7)
    apart = [
        abs(one - other) / (1e-7 * abs(one)) if one else 0.0
        for one, other in ((body.most, nudged.most), (body.away, nudged.away))
    ]
    return case | {
        "rotation_ratio": body.most if body.fell is None else None,
        "displacement": body.away,
        "residual": abs(body.last),
        "overturned": body.fell is not None,
        "impacts": int(body.impacts),
        "condition": max(apart) if (body.fell is None) == (nudged.fell is None) else math.inf,
    }


if __name__ == "__main__":
    rows = [answered(drawn(seed)) for seed in range(24)]
    FILE.write_text(
        json.dumps(rows, indent=None, separators=(",", ":")).replace("},{", "},\n{") + "\n", encoding="utf-8"
    )
