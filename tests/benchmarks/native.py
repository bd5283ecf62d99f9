"""The kernels beside a C program of the same algorithm, compiled here by gcc -O3 -march=native."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from pipeline.models import model_named
from pipeline.models.common import Quiet
from pipeline.quantities import Array
from pipeline.records import Excitation
from pipeline.response import prepare
from tests.benchmarks.common import OBJECTS, SEED, least, shaking

SLOWER = 1.6
"""How much slower than C a kernel may be."""

REASONS = {
    "sliding 1-D": "the kernel is the isolator's too: series and iterated roots for what C does by a quadratic",
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
        source = Path(__file__).with_name("native.c")
        subprocess.run(
            [gcc, "-O3", "-march=native", "-shared", "-fPIC", "-o", str(library), str(source), "-lm"], check=True
        )
        yield ctypes.CDLL(str(library))


def pointer(values: Array) -> ctypes.c_void_p:
    """Return where an array of float64 begins; the caller keeps the array."""
    if values.dtype != np.float64 or not values.flags.c_contiguous:
        raise ValueError("the C program reads contiguous float64")
    return ctypes.c_void_p(values.ctypes.data)


Pair = tuple[Callable[[], Array], Callable[[], Array]]


def sliding(program: ctypes.CDLL, motion: Excitation, mu: Array) -> Pair:
    """Return C's and our run of sliding in one direction; both give max |u| and the path [m], (2, n)."""
    quiet = Quiet(motion)
    out = np.empty((mu.size, 3))
    arrays = [pointer(a) for a in (quiet.x, quiet.z, quiet.ratio, quiet.maxima, quiet.pushes)]
    model = model_named("sliding")
    values = prepare(model, {"friction_static": mu, "directions": 1.0})

    def theirs() -> Array:
        samples, step = ctypes.c_long(quiet.x.size), ctypes.c_double(quiet.dt)
        program.sliding(*arrays, samples, step, pointer(mu), ctypes.c_long(mu.size), pointer(out))
        return out[:, :2].T

    def ours() -> Array:
        found = model.run(motion, values, 2, False)
        return np.stack([found["displacement"], found["path_length"]])

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
    """Return the works that both do, under the record's x component and, for sliding, its vertical one."""
    x, _, z = shaking().acceleration
    rng = np.random.default_rng(SEED)
    return {
        "sliding 1-D": sliding(program, Excitation(shaking().dt, x, None, z, 0.0), rng.uniform(0.1, 0.3, OBJECTS)),
        "oscillator": oscillator(
            program, Excitation(shaking().dt, x, None, np.zeros_like(x), 0.0), rng.uniform(0.5, 13.0, OBJECTS)
        ),
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
            apart = float(np.max(np.abs(ours() / theirs() - 1.0)))
            slow, fast = (1e9 * least(work, 5) / OBJECTS / samples for work in (ours, theirs))
            ratio = slow / fast
            note = f"{'too slow! ' if ratio > SLOWER else ''}{REASONS[name] if ratio > 1.2 else ''}"
            print(f"{name:<34}{fast:>10.2f}{slow:>10.2f}{ratio:>8.2f}   {apart:.0e}   {note}".rstrip())
