"""What workers compile ahead is what the night runs, and not something else beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.model_runs import prepare
from pipeline.analysis.response import respond
from pipeline.kernels import is_kept
from pipeline.kernels.bounds import slip_bounds_batch
from pipeline.kernels.hung_plate import hung_plate_batch
from pipeline.kernels.resultant import resultant_batch
from pipeline.kernels.spherical import spherical_batch
from pipeline.kernels.standing import standing_batch
from pipeline.models import model_named
from pipeline.motions.synthesis import sine
from pipeline.night.staff import compile_ahead, to_compile

KERNELS = {
    "standing.standing_batch": standing_batch,
    "resultant.resultant_batch": resultant_batch,
    "bounds.slip_bounds_batch": slip_bounds_batch,
    "spherical.spherical_batch": spherical_batch,
    "hung_plate.hung_plate_batch": hung_plate_batch,
}


def test_it_compiles_what_a_museum_needs_and_nothing_beside_it() -> None:
    for name in KERNELS:
        compile_ahead(None, name)
    signatures = {name: list(kernel.signatures) for name, kernel in KERNELS.items()}
    assert all(signatures.values())
    shaking = sine(3.0, 1.0, 4.0)
    respond("standing", shaking, half_width=0.1, cg_height=0.4, friction_static=0.5)
    respond("standing", shaking, half_width=[0.1, 0.2], cg_height=0.4, friction_static=0.3, angle=None)
    bending = model_named("flexible_stress")
    bent = prepare(bending, {name: low for name, (low, _) in bending.trials.ranges.items()})
    assert bending.bound is not None
    bending.bound(shaking.excitation(None), bent)
    respond("sliding", shaking, fidelity="bound", friction_static=[0.1, 0.2])
    respond("swing_3d", shaking, length=[0.5, 1.0], damping=0.01)
    respond("unhooking", shaking, hook_height=0.3, hook_offset=0.03, gyration=0.3, restitution=0.3)
    assert {name: list(kernel.signatures) for name, kernel in KERNELS.items()} == signatures


def test_it_compiles_what_is_not_kept_and_of_what_some_need_only_what_they_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in KERNELS:
        compile_ahead(None, name)
    assert not to_compile(["swing_3d", "unhooking"])
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    assert not is_kept("standing.standing_batch")
    assert to_compile(["swing_3d", "unhooking", "rocking"]) == tuple(KERNELS)
    assert to_compile(["unhooking"]) == tuple(name for name in KERNELS if "spherical" not in name)
    assert to_compile() == tuple(KERNELS)[:3]
