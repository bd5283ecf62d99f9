"""Parts that several generic models share: flags in words, excitations prepared once, error floors, threads.

What is told of a motion, remembered for as long as somebody holds it.

Most motions are drawn, asked a few things and let go; a cache of the latest so many would hold those alone.

The sets of one call of a kernel, shared by threads: kernels release the lock, and no set knows of another.

Parts end where lanes do, and kernels put only equals side by side: what is found is the same, bit for bit, on any
number of threads.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import wraps
from itertools import pairwise
from typing import TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from pipeline.kernels import CONTACT_LOST, CUT, EVENT_CAP, SENSITIVE, UNRESOLVED, samples
from pipeline.kernels.lanes import LANES
from pipeline.kernels.quiet import block_maxima, largest_ratio
from pipeline.quantities import Array, G
from pipeline.records import Curve, Excitation, Motion, Scene, Support

_Shaking = TypeVar("_Shaking", Motion, Excitation)
_Told = TypeVar("_Told")


def remembered(of: Callable[[_Shaking], _Told]) -> Callable[[_Shaking], _Told]:
    """Have a function of a motion alone, or of an excitation, called once for each.

    Parameters
    ----------
    of : callable
        What it returns must not hold the motion, which would live as long then.

    Returns
    -------
    callable
        Returns the same.
    """
    known: WeakKeyDictionary[_Shaking, _Told] = WeakKeyDictionary()

    @wraps(of)
    def told(motion: _Shaking) -> _Told:
        found = known.get(motion)
        if found is None:
            found = known[motion] = of(motion)
        return found

    return told


NO_VERTICAL = "the motion has no vertical component: what that would lift or load is not in this"
"""Said of what the vertical shaking loads or unloads, under a motion without any."""

NO_TILT = 16
NO_HISTORY = 32
BOUND = 64

NOTES = {
    CONTACT_LOST: "contact lost (vertical acceleration below -g); flight and landing are not modelled",
    CUT: "still moving when the tail was cut",
    EVENT_CAP: "more impacts than are followed in one sample interval",
    SENSITIVE: "sensitive: 1 % of amplitude may change the outcome, or any change is magnified 1,000 times",
    NO_TILT: "no tilt reproduces an acceleration of 1 g or more",
    NO_HISTORY: "a closed-form screen, not a response",
    BOUND: "a guaranteed upper bound, not a response",
    UNRESOLVED: "too fast for the steps that are taken: not followed; an upper bound, or empty where it has none",
}
"""What each bit of a result's note means."""

ROUNDING = 1e-12
"""Relative error granted to a closed form integrated over a long record."""

ILL = 1e3
"""Condition (relative change of the output for a relative change of amplitude) from which a result is sensitive."""

NUDGE = 1e-6
"""Relative change of amplitude by which a condition is measured."""

FAINTEST, FAINT = 1e-150, 1e-100
"""m/s2, the peak below which an excitation is magnified, and to what: far from g still, and from the end of numbers."""

SHIFT = 1e-3
"""m, from which on an object is said to have shifted: what a curator would see."""


def words(bits: float) -> str:
    """Return the note of a result in words."""
    return "; ".join(text for bit, text in NOTES.items() if int(bits) & bit)


def magnified(motion: Excitation) -> tuple[Excitation, float]:
    """Keep an excitation out of the numbers that a processor is slow with (denormals: 100 times).

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.

    Returns
    -------
    motion : Excitation
        Multiplied where its peak is below FAINTEST, where every response is in proportion to it.
    times : float
        By how much, 1 as a rule.  What holds a body, which is not multiplied here, must be.
    """
    rows = (motion.x, motion.z) if motion.y is None else (motion.x, motion.y, motion.z)
    peak = max(float(np.abs(row).max()) for row in rows)
    if not 0.0 < peak < FAINTEST:
        return motion, 1.0
    # A power of two multiplies exactly.
    factor = 2.0 ** np.floor(np.log2(FAINT) - np.log2(peak))
    y = None if motion.y is None else factor * motion.y
    return replace(motion, x=factor * motion.x, y=y), float(factor)


def pushes(motion: Excitation) -> Array:
    """Return |a_h| at the samples [m/s2], (n,).

    To the last bit the same for all who ask, so that what a certificate shows to rest rests in its history too.
    """
    # A root is ten times as fast as hypot, and along one direction none is needed.
    return np.abs(motion.x) if motion.y is None else np.sqrt(motion.x**2 + motion.y**2)


class Quiet:
    """An excitation with the arrays that let resting objects skip ahead, prepared once for all objects."""

    def __init__(self, motion: Excitation) -> None:
        self.x = samples(motion.x)
        self.y = np.zeros_like(self.x) if motion.y is None else samples(motion.y)
        self.z = samples(motion.z)
        self.dt = motion.dt
        self.push = pushes(motion)
        self.peak = float(self.push.max())
        self.pushes = block_maxima(self.push)
        self.ratio = _grip(self.push, self.z)
        self.maxima = block_maxima(self.ratio)
        self.tail = -1.0 if motion.tail is None else float(motion.tail)


def _grip(push: Array, z: Array) -> Array:
    """Return the friction that would hold an object at each sample: |a_h| / (g + a_z), infinite without contact."""
    normal = G + z
    return np.divide(push, normal, out=np.full_like(push, np.inf), where=normal > 0.0)


def shaken(motion: Excitation) -> float:
    """Return the largest acceleration of the pivot [m/s2], all directions together."""
    square = motion.x**2 + motion.z**2
    if motion.y is not None:
        square = square + motion.y**2
    return float(np.sqrt(square.max()))


def contact_lost(motion: Excitation, size: int) -> Array:
    """Return the flag of lost contact (size,) where the vertical acceleration goes below -g, else 0."""
    return np.full(size, float(CONTACT_LOST) if np.min(motion.z) < -G else 0.0)


@remembered
def largest_push(motion: Excitation) -> float:
    """Return A_max: the peak along the direction, or the peak resultant of two.

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.

    Returns
    -------
    float
        [m/s2].
    """
    return float(np.max(pushes(motion)))


_STRONGEST = 64
"""Samples that already tell most of the peaks along all directions."""


@remembered
def smallest_push(motion: Excitation) -> float:
    """Return a lower bound of A_max along any direction; along the one of the excitation it is A_max itself.

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.

    Returns
    -------
    float
        [m/s2].
    """
    if motion.y is None:
        return largest_push(motion)
    half = np.radians(0.25)
    turns = np.arange(0.0, np.pi, 2.0 * half)
    cosine, sine = np.cos(turns)[:, None], np.sin(turns)[:, None]
    radius = pushes(motion)
    strongest = np.argpartition(radius, -min(_STRONGEST, radius.size))[-_STRONGEST:]
    # Written out: a product of matrices has other last digits on another number of cores.
    least = np.abs(cosine * motion.x[strongest] + sine * motion.y[strongest]).max(axis=1).min()
    # A sample that is weaker than that is the peak along no direction.
    strong = radius >= least
    peaks = np.abs(cosine * motion.x[strong] + sine * motion.y[strong]).max(axis=1)
    # Half a step away the sample with the peak along t still pushes by its cosine, less what it pushes across t.
    across = np.sqrt(np.maximum(0.0, largest_push(motion) ** 2 - peaks**2))
    return max(0.0, float(np.min(np.cos(half) * peaks - np.sin(half) * across)))


def largest_speed(motion: Excitation) -> float:
    """Return V_max: what the manifest says, or the peak ground velocity, between the samples too.

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.

    Returns
    -------
    float
        [m/s].
    """
    if motion.v_max is not None:
        return motion.v_max
    v = _velocity(motion.x, motion.dt, motion.start[0])
    if motion.y is None:
        a = motion.x
        best = float(np.max(np.abs(v)))
        turning = np.flatnonzero(a[:-1] * a[1:] < 0.0)
        if turning.size:
            # Where the acceleration changes sign inside an interval the velocity has its peak there.
            a0, a1 = a[turning], a[turning + 1]
            inside = v[turning] + 0.5 * a0 * motion.dt * a0 / (a0 - a1)
            best = max(best, float(np.max(np.abs(inside))))
        return best
    return float(np.max(np.hypot(v, _velocity(motion.y, motion.dt, motion.start[1]))))


def _velocity(a: Array, dt: float, start: float) -> Array:
    return start + np.concatenate([[0.0], np.cumsum(0.5 * dt * (a[1:] + a[:-1]))])


def after_record(motion: Excitation) -> int:
    """Return how many samples a time history goes on after the record: those of its tail."""
    return 0 if motion.tail is None else int(np.ceil(motion.tail / motion.dt))


@remembered
def lift_ratios(motion: Excitation) -> tuple[float, float]:
    """Return the largest -a / N and a / N over time, N = max(0, g + a_z): what lifts either edge of a body of slope 1.

    Parameters
    ----------
    motion : Excitation
        Along one direction or in two.

    Returns
    -------
    to_positive, to_negative : float
        [-]; for two directions both are the largest |a_h| / N.  Infinite where contact is lost under a push.
    """
    z = samples(motion.z)
    if motion.y is not None:
        worst = largest_ratio(pushes(motion), z, 1.0)
        return worst, worst
    x = samples(motion.x)
    return largest_ratio(x, z, -1.0), largest_ratio(x, z, 1.0)


def curve(label: str, x: Sequence[float] | Array, y: Sequence[float] | Array) -> Curve:
    """Return a line of a picture, to five digits: finer than any that is drawn.

    Parameters
    ----------
    label : str
        What it is called; "" for the only one.
    x, y : array_like of float, shape (n,)
        In the units of the picture's axes.

    Returns
    -------
    Curve
        The line.
    """
    return Curve(label, tuple(map(rounded, x)), tuple(map(rounded, y)))


def rounded(value: float) -> float:
    """Return a number to the five digits that a picture is drawn with."""
    return float(f"{value:.5g}")


def broadcast(parameters: Mapping[str, Array], name: str) -> Array:
    """Return one parameter as a contiguous array."""
    return np.ascontiguousarray(parameters[name], dtype=np.float64)


def grid(**values: Sequence[float]) -> dict[str, list[float]]:
    """Return every combination of some values, as columns.

    Parameters
    ----------
    **values : sequence of float
        By name.

    Returns
    -------
    dict of str to list of float
        Columns by name, of one length.
    """
    columns = np.meshgrid(*values.values())
    return {name: column.ravel().tolist() for name, column in zip(values, columns, strict=True)}


def needs(scene: Scene, *names: str) -> str:
    """Return "" when the scene has all these parameters, else which are missing.

    Parameters
    ----------
    scene : Scene
        An object where it stands.
    *names : str
        Of parameters.

    Returns
    -------
    str
        For `Model.applies`.
    """
    missing = [n for n in names if n not in scene.parameters]
    return f"not known: {', '.join(missing)}" if missing else ""


def N_(text: str) -> str:  # noqa: N802 - as gettext has it
    """Mark a text that a report says, for the catalogue of a translation."""
    return text


def unless_free(scene: Scene) -> str:
    """Return the reason why an object that is not free on its support neither rocks nor slides; "" when it is free.

    Parameters
    ----------
    scene : Scene
        An object where it stands.

    Returns
    -------
    str
        For `Model.applies`.
    """
    reasons = {
        Support.FASTENED: N_("it is fastened to its support"),
        Support.HUNG: N_("it hangs on a wall"),
        Support.SUSPENDED: N_("it hangs from above"),
        Support.ISOLATED: N_("it is fastened to an isolator"),
    }
    return reasons.get(scene.support, "")


WORTH = 200_000
"""Sets times samples below which handing a part on may cost more than it saves: about a millisecond of work, where
threads cost a tenth of one. They live as long as the call, so that a process that is to be forked has none."""

TURNS = 4
"""Parts for each thread: some sets take far longer than others."""

_threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_among(threads: int) -> None:
    """Share the calls of this process among so many threads; 1: each runs where it was made."""
    global _threads  # noqa: PLW0603 - of the whole process, as its cores are
    _threads = max(1, threads)


def shared(run: Callable[[slice], None], sets: int, samples: int, together: int = LANES) -> None:
    """Run a kernel on all sets, in parts that threads share.

    Parameters
    ----------
    run : callable
        Runs it on some of the sets.
    sets, samples : int
        How many there are, and of how many samples the motion is.
    together : int
        How many the kernel works on side by side.
    """
    blocks = -(-sets // together)
    parts = min(TURNS * _threads, blocks)
    if _threads < 2 or parts < 2 or sets * samples < WORTH:
        run(slice(0, sets))
        return
    ends = [min(sets, together * (blocks * part // parts)) for part in range(parts + 1)]
    # Whoever is free takes the next.
    waiting = iter([slice(*pair) for pair in pairwise(ends)])

    def take() -> None:
        for part in waiting:
            run(part)

    with ThreadPoolExecutor(min(_threads, parts) - 1, thread_name_prefix="kernel") as pool:
        others = [pool.submit(take) for _ in range(min(_threads, parts) - 1)]
        take()
    for other in others:
        other.result()
