"""Compiled functions, the response models above all: SI arrays in, arrays out; no units, no defaults, no pandas.

Each file holds the scalar integration of one object and the batch driver beside it.  Run with ``NUMBA_DISABLE_JIT=1``
for coverage and debuggers.
"""

import functools
import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core import event

from pipeline.kernels.compiler import hasten
from pipeline.quantities import Array
from pipeline.records.protocols import tell_of_compiling

FIRST = np.int64(0)
"""An index to begin with: for a literal number or truth value as an argument numba compiles the callee once more."""


def samples(values: Array) -> Array:
    """Return samples of a motion as the kernels take them: contiguous and writable, a copy where they are not.

    For an array that may not be written numba compiles each kernel once more, a third of a first rocking body.

    Parameters
    ----------
    values : ndarray, shape (n,)
        In any unit, which stays.

    Returns
    -------
    ndarray, shape (n,)
        Of float64, in the order of C.
    """
    return np.require(values, np.float64, ["C", "W"])


def kernel_version() -> str:
    """Return a hash of all kernel sources and of the compiler: the version that a stored result depends on.

    Returns
    -------
    str
        Twelve hexadecimal digits of SHA-256.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:12]


def user_cache(name: str) -> Path:
    """Return a folder of this name in the user's cache, made where it is missing; a temporary one if none can be.

    Parameters
    ----------
    name : str
        Of the folder itself, below ``kouros`` in KOUROS_CACHE, XDG_CACHE_HOME or ~/.cache.

    Returns
    -------
    Path
        A folder that the user can write and nobody else can.
    """
    home = os.environ.get("KOUROS_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    for base in (
        Path(home) / "kouros",
        Path(tempfile.gettempdir()) / f"kouros-{os.getuid() if os.name == 'posix' else 0}",
    ):
        folder = base / name
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        except OSError:
            continue
        if os.access(folder, os.W_OK) and _own(base) and _own(folder):
            return folder
    return Path(tempfile.mkdtemp(prefix=f"kouros-{name}-"))


def _own(folder: Path) -> bool:
    """Whether nobody else can put files there: compiled code is loaded from it, and in /tmp anybody makes folders."""
    if os.name != "posix":
        return True
    state = folder.stat()
    return state.st_uid == os.getuid() and not state.st_mode & 0o022


KERNEL_VERSION = kernel_version()
"""Hash of the sources of the compiled models."""

_CONFIG: Any = numba.config
if "NUMBA_CACHE_DIR" not in os.environ:
    # numba serves an edited kernel stale when a cached driver imports it, so every state of the sources gets its own
    # folder.
    _CONFIG.CACHE_DIR = str(user_cache(f"kernels-{KERNEL_VERSION}"))


def cache_folder() -> str:
    """Return the folder of the compiled code."""
    return str(_CONFIG.CACHE_DIR)


def is_kept(name: str) -> bool:
    """Return whether machine code is kept of a function, so that no process need compile it.

    Parameters
    ----------
    name : str
        Its file and its own, such as "standing.standing_batch".
    """
    return any(Path(cache_folder()).glob(f"**/{name}-*.nbi"))


class _Compilations(event.Listener):
    """Counts what is compiled: numba compiles one function at a time, whatever thread wants it."""

    def __init__(self) -> None:
        self._begun = self._ended = 0

    def on_start(self, event: Any) -> None:  # noqa: ARG002 - as numba calls it
        self._begun += 1
        tell_of_compiling(self._ended, self._begun)

    def on_end(self, event: Any) -> None:  # noqa: ARG002
        self._ended += 1
        tell_of_compiling(self._ended, self._begun)


hasten()
_register: Any = event.register  # numba has no types
_register("numba:compile", _Compilations())

# error_model="numpy": a division by zero gives inf, as in the arrays around it.  Nothing is reordered: the order of
# operations decides overturning.  No code of C calls a kernel.
_compiled: Any = functools.partial(numba.njit, cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)

kernel: Callable[..., Any] = _compiled()
"""Decorator of a compiled function that makes arrays, or that Python calls."""

# Arrays are counted references, and a call that hands one on adds and subtracts atomically: without this option of
# numba's own libraries that took up to half of a kernel's time.
bare: Callable[..., Any] = _compiled(_nrt=False)
"""Decorator of a compiled function that makes no array: it counts no references to those that it is given."""

inner: Callable[..., Any] = _compiled(_nrt=False, no_cpython_wrapper=True)
"""Decorator of such a function that only kernels call: the entries for others took a quarter of the compilation."""

# Of what fastmath allows only this: a product and a sum are rounded once instead of twice, as compilers of C do without
# being asked, which makes long Runge-Kutta steps a fifth faster and closed forms no faster.  The order of operations
# stays as it is written.  A processor that cannot fuse gives other last digits.
fused: Callable[..., Any] = _compiled(_nrt=False, no_cpython_wrapper=True, fastmath={"contract"})
"""Decorator of such a function that may fuse products and sums."""

inlined: Callable[..., Any] = _compiled(inline="always")
"""Decorator of a function that must melt into the loop around it for the loop to be vectorised."""


CONTACT_LOST = 1
"""The vertical acceleration went below -g: no weight, no friction; flight and landing are not modelled."""
CUT = 2
"""Still moving when the tail or its cap ended."""
EVENT_CAP = 4
"""More events in one sample interval than are followed: the body was put to rest until the next sample."""
SENSITIVE = 8
"""An event that hangs on less than the error of the integration: a body that just stops, or just does not."""
UNRESOLVED = 128
"""More steps than are taken: not followed.  Without a cap a body too fast for its motion would be followed for ever."""
