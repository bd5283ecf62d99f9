"""The kernels beside a C program of the same algorithm, compiled here by gcc -O3 -march=native."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from pipeline.analysis.model_runs import prepare
from pipeline.kernels import standing_body
from pipeline.kernels.pendulum import substeps
from pipeline.models import model_named
from pipeline.models.common import Quiet, shaken
from pipeline.models.rigid_body import bodies
from pipeline.models.standing import standing_bodies
from pipeline.quantities import Array
from pipeline.records import Excitation
from tests.benchmarks.common import OBJECTS, SEED, fastest, level, shaking, strongest
from tests.benchmarks.models import parameters

SLOWER = 1.6
"""How much slower than C a kernel may be."""

FUSED = "gcc fuses products and sums, which this kernel does not (C without fusing: {})"

REASONS = {
    "isolator 1-D": FUSED.format("1.27") + "; gcc melts all phases into one loop",
    "oscillator": FUSED.format("1.13"),
    "standing": "gcc melts the steps about an edge into what takes them, which are calls here",
}
"""Why a kernel is above 1.2 times C."""


@contextmanager
def compiled() -> Iterator[ctypes.CDLL | None]:
    """Give the C program, compiled into a temporary folder; None where there is no gcc."""
    gcc = shutil.which("gcc")
    if gcc is None:
        yield None
        return
    with TemporaryDirectory() as folder:
        library = Path(folder) / "native.so"
        sources = [str(source) for source in sorted((Path(__file__).parent / "c").glob("*.c"))]
        # One program, as numba links one: what one file holds may melt into another.
        options = ["-O3", "-march=native", "-flto", "-shared", "-fPIC"]
        subprocess.run([gcc, *options, "-o", str(library), *sources, "-lm"], check=True)
        yield ctypes.CDLL(str(library))


def pointer(values: Array) -> ctypes.c_void_p:
    """Return where an array of float64 begins; the caller keeps the array."""
    if values.dtype != np.float64 or not values.flags.c_contiguous:
        raise ValueError("the C program reads contiguous float64")
    return ctypes.c_void_p(values.ctypes.data)


IN_C = {
    "overturned": standing_body.FELL,
    "impacts": standing_body.IMPACTS,
    "rotation_ratio": standing_body.RATIO,
    "displacement": standing_body.AWAY,
    "residual": standing_body.RESIDUAL,
}
"""Outputs of `standing` -> columns of C's results, which are those of the kernel."""

Pair = tuple[Callable[[], Array], Callable[[], Array]]


def friction(program: ctypes.CDLL, motion: Excitation, mu: Array, frequency: Array | None = None) -> Pair:
    """Return C's and our run of sliding in one direction, or of isolators with 2 % damping; (2, n).

    frequency : Hz, below 1 / (13 dt), or None: a free body
    Both give max |u| [m], and the path [m] or, of an isolator, the largest acceleration passed on [m/s2].
    """
    quiet = Quiet(motion)
    arrays = (quiet.x, quiet.z, quiet.ratio, quiet.maxima, quiet.pushes)
    samples, step, count = ctypes.c_long(quiet.x.size), ctypes.c_double(quiet.dt), ctypes.c_long(mu.size)
    out = np.empty((mu.size, 3))
    if frequency is None:
        model, given, names = "sliding", {"friction_static": mu}, ("displacement", "path_length")
        w, zeta, second = np.zeros_like(mu), np.zeros_like(mu), 1
    else:
        w, zeta, second = 2.0 * np.pi * frequency, np.full(mu.size, 0.02), 2
        given = {"frequency": frequency, "damping": zeta, "friction": mu}
        model, names = "horizontal_isolator", ("displacement", "acceleration")
    ours_is = model_named(model)
    values = prepare(ours_is, {**given, "directions": 1.0})

    def theirs() -> Array:
        program.friction(
            *map(pointer, arrays), samples, step, pointer(w), pointer(zeta), pointer(mu), count, pointer(out)
        )
        return out[:, [0, second]].T

    def ours() -> Array:
        found = ours_is.run(motion, values, 2, False)
        return np.stack([found[name] for name in names])

    return theirs, ours


def rocking(program: ctypes.CDLL, motion: Excitation, half_width: Array, cg_height: Array) -> Pair:
    """Return C's and our run of rocking rectangles; both give the ratio, and whether overturned, (2, n)."""
    quiet = Quiet(motion)
    arrays = (quiet.x, quiet.z, quiet.ratio, quiet.maxima)
    model = model_named("rocking")
    values = prepare(model, {"half_width": half_width, "cg_height": cg_height})
    body, out = bodies(values), np.empty((half_width.size, 3))
    samples, count, refine = (ctypes.c_long(number) for number in (quiet.x.size, half_width.size, 2))
    step, peak = ctypes.c_double(quiet.dt), ctypes.c_double(quiet.peak)

    def theirs() -> Array:
        program.rocking(*map(pointer, arrays), samples, step, peak, pointer(body), count, refine, pointer(out))
        return out[:, :2].T

    def ours() -> Array:
        found = model.run(motion, values, 2, False)
        return np.stack([found["rotation_ratio"], found["overturned"]])

    return theirs, ours


def standing(
    program: ctypes.CDLL,
    motion: Excitation,
    given: Mapping[str, Array],
    outputs: Sequence[str] = ("overturned", "rotation_ratio", "displacement"),
) -> Pair:
    """Return C's and our run of standing bodies within the record; both give the outputs named, (k, n).

    given   : parameters of the model
    outputs : of `IN_C`; how often what hardly moves lands, and where it ends, hang on rounding
    """
    quiet = Quiet(motion)
    arrays = (quiet.x, quiet.z, quiet.ratio, quiet.maxima)
    model = model_named("standing")
    values = prepare(model, given)
    body = standing_bodies(values)
    out = np.empty((body.shape[0], standing_body.FOUND))
    samples, count, refine = (ctypes.c_long(number) for number in (quiet.x.size, body.shape[0], 2))
    step, peak = ctypes.c_double(quiet.dt), ctypes.c_double(quiet.peak)
    columns = [IN_C[name] for name in outputs]

    def theirs() -> Array:
        program.standing(*map(pointer, arrays), samples, step, peak, pointer(body), count, refine, pointer(out))
        return np.abs(out[:, columns].T)

    def ours() -> Array:
        found = model.run(motion, values, 2, False)
        return np.stack([found[name] for name in outputs])

    return theirs, ours


def swing(program: ctypes.CDLL, motion: Excitation, length: Array) -> Pair:
    """Return C's and our run of pendulums of 2 % damping; both give the largest angle [rad], (1, n).

    length : m, a multiple of 16 of them, which all take as many steps a sample as the first
    """
    x, z = np.ascontiguousarray(motion.x), np.ascontiguousarray(motion.z)
    zeta, out = np.full(length.size, 0.02), np.empty(length.size)
    model = model_named("swing")
    values = prepare(model, {"length": length, "damping": zeta})
    pieces = ctypes.c_long(2 * substeps(length[0], 0.02, shaken(motion), motion.dt))

    def theirs() -> Array:
        samples, step, count = ctypes.c_long(x.size), ctypes.c_double(motion.dt), ctypes.c_long(length.size)
        program.pendulums(
            pointer(x), pointer(z), samples, step, pointer(length), pointer(zeta), pieces, count, pointer(out)
        )
        return out[None, :]

    def ours() -> Array:
        return model.run(motion, values, 2, False)["rotation"][None, :]

    return theirs, ours


def oscillator(program: ctypes.CDLL, motion: Excitation, frequency: Array) -> Pair:
    """Return C's and our run of oscillators of 5 % damping; both give max |u| [m] and |a + u''| [m/s2], (2, n).

    frequency : Hz, a multiple of 16 of them, of which none takes more than one step a sample
    """
    w, zeta = 2.0 * np.pi * frequency, np.full(frequency.size, 0.05)
    x = np.ascontiguousarray(motion.x)
    out = np.empty((2, w.size))
    model = model_named("oscillator")
    values = prepare(model, {"frequency": frequency, "damping": zeta})

    def theirs() -> Array:
        samples, step, count = ctypes.c_long(x.size), ctypes.c_double(motion.dt), ctypes.c_long(w.size)
        program.oscillators(
            pointer(x), samples, step, pointer(w), pointer(zeta), count, pointer(out[0]), pointer(out[1])
        )
        return out

    def ours() -> Array:
        found = model.run(motion, values, 2, False)
        return np.stack([found["displacement"], found["absolute_acceleration"]])

    return theirs, ours


def pairs(program: ctypes.CDLL) -> dict[str, Pair]:
    """Return the works that both do, along the record's strongest direction and with its vertical component."""
    motion = Excitation(shaking().dt, strongest(), None, shaking().acceleration[2], 0.0)
    rng = np.random.default_rng(SEED)
    slope, height = rng.uniform(0.1, 1.5, OBJECTS), rng.uniform(0.1, 2.0, OBJECTS)
    friction_low, frequency = rng.uniform(0.05, 0.2, OBJECTS), rng.uniform(0.3, 3.0, OBJECTS)
    return {
        "sliding 1-D": friction(program, motion, rng.uniform(0.1, 0.6, OBJECTS)),
        "isolator 1-D": friction(program, motion, friction_low, frequency),
        "rocking": rocking(program, motion, 0.5 * slope * height, 0.5 * height),
        "standing": standing(program, motion, parameters()["standing"][1]),
        "swing": swing(program, motion, rng.uniform(1.0, 3.0, OBJECTS)),
        "oscillator": oscillator(program, level(), rng.uniform(0.5, 20.0, OBJECTS)),
    }


def native() -> None:
    """Print what each kernel costs beside the C program."""
    with compiled() as program:
        if program is None:
            print("beside C: skipped, there is no gcc on this machine")
            return
        samples = shaking().samples
        print(
            f"{'beside C (gcc -O3 -march=native)':<34}{'ns in C':>10}{'ns ours':>10}{'ratio':>8}   largest difference"
        )
        for name, (theirs, ours) in pairs(program).items():
            apart = float(np.max(np.abs(ours() - theirs()) / np.maximum(np.abs(theirs()), 1e-300)))
            # In turns, so that both meet the machine as it is.
            rounds = [(fastest(ours, 1), fastest(theirs, 1)) for _ in range(10)]
            slow, fast = (1e9 * least_of / OBJECTS / samples for least_of in np.min(rounds, axis=0))
            ratio = slow / fast
            note = f"{'too slow! ' if ratio > SLOWER else ''}{REASONS.get(name, '') if ratio > 1.2 else ''}"
            print(f"{name:<34}{fast:>10.2f}{slow:>10.2f}{ratio:>8.2f}   {apart:.0e}   {note}".rstrip())
