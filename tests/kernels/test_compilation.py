"""The kernels as a package: they run without the compiler too, and their cache follows their sources."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline import kernels, respond
from pipeline.kernels import kernel_version

SOURCES = sorted(Path(kernels.__file__).parent.glob("*.py"))

SCRIPT = """
import json
import numpy as np
from pipeline import Motion, respond
t = np.arange(60) * 0.02
a = np.vstack([4.0 * np.sin(9.0 * t), 3.0 * np.sin(7.0 * t + 1.0), 2.0 * np.sin(11.0 * t)])
motion = Motion(0.02, a)
cases = {
    "rocking": {"half_width": 0.1, "cg_height": 0.5, "tail": 0.2},
    "sliding": {"friction_static": 0.1},
    "swing": {"length": 0.5, "damping": 0.02},
    "swing_3d": {"length": 0.5, "damping": 0.02},
    "oscillator": {"frequency": 2.0, "damping": 0.02},
    "unhooking": {"hook_height": 0.2, "hook_offset": 0.02, "gyration": 0.3, "restitution": 0.3},
    "horizontal_isolator": {"frequency": 1.0, "damping": 0.3, "friction": 0.1, "directions": 1},
}
print(json.dumps({name: float(respond(name, motion, **p).iloc[0, 0]) for name, p in cases.items()}))
"""


def run(script: str, **environment: str) -> dict[str, float]:
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
        cwd=Path(kernels.__file__).parents[2],
    )
    out: dict[str, float] = json.loads(done.stdout)
    return out


def test_the_kernels_run_without_the_compiler(tmp_path: Path) -> None:
    """NUMBA_DISABLE_JIT=1 gives what the machine code gives, fused multiply-adds excepted (1e-9)."""
    plain, compiled = run(SCRIPT, NUMBA_DISABLE_JIT="1"), run(SCRIPT)
    for name, value in compiled.items():
        assert plain[name] == pytest.approx(value, rel=1e-9), name


ONCE = """
import json
import numpy as np
from pipeline import Motion, respond
from pipeline.kernels import friction_line, friction_plane, oscillator, quiet, rocking
from pipeline.motions.spectra import response_spectra
t = np.arange(300) * 0.02
motion = Motion(0.02, np.vstack([4.0 * np.sin(9.0 * t), 3.0 * np.sin(7.0 * t), 2.0 * np.sin(11.0 * t)]))
respond("rocking", motion, half_width=0.1, cg_height=[0.3, 0.5, 0.7])
respond("sliding", motion, friction_static=[0.1, 0.2])
respond("sliding", motion, friction_static=[0.1, 0.2], directions=1)
respond("oscillator", motion, frequency=[2.0, 5.0], damping=0.02)
response_spectra(motion, [0.1, 1.0], 0.05, "xz")
kernels = (
    rocking.rocking_batch,
    friction_line.friction_line_batch,
    friction_plane.friction_plane_batch,
    oscillator.oscillator_batch,
    quiet.block_maxima,
)
print(json.dumps({k.__name__: len(k.signatures) for k in kernels}))
"""


def test_each_kernel_is_compiled_once() -> None:
    """Rows of a motion cannot be written and scaled ones can: for numba two types, of which it is shown one."""
    for name, count in run(ONCE).items():
        assert count == 1, name


def test_the_version_is_of_the_sources_and_of_nothing_else() -> None:
    assert re.fullmatch(r"[0-9a-f]{12}", kernel_version())
    assert kernel_version() == kernel_version() == kernels.KERNEL_VERSION


def test_kernels_know_nothing() -> None:
    """No pandas, no units, no files: they import numpy, numba, math and each other."""
    for source in SOURCES:
        text = source.read_text(encoding="utf-8")
        if source.name == "__init__.py":
            continue
        roots = set(re.findall(r"^(?:from|import) ([\w.]+)", text, flags=re.MULTILINE))
        allowed = {"math", "numpy", "pipeline.kernels", "pipeline.quantities"}
        if source.name == "compiler.py":
            allowed = {"typing", "numba", "numba.core", "numba.core.targetconfig"}
        assert all(r in allowed or r.startswith("pipeline.kernels.") for r in roots), (source.name, roots)
        assert "fastmath" not in text


def test_respond_is_importable_from_the_package() -> None:
    assert callable(respond)
