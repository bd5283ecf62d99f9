"""What a worker compiles ahead is what the night runs, and not something else beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.response import respond
from pipeline.kernels import is_kept
from pipeline.kernels.standing import standing_batch
from pipeline.motions.synthesis import sine
from pipeline.night.staff import compile_ahead, to_compile


def test_it_compiles_what_a_body_that_stands_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compile_ahead(None, None)
    signatures = list(standing_batch.signatures)
    respond("standing", sine(3.0, 1.0, 4.0), half_width=0.1, cg_height=0.4, friction_static=0.5)
    respond("standing", sine(3.0, 1.0, 4.0), half_width=[0.1, 0.2], cg_height=0.4, friction_static=0.3, angle=None)
    assert signatures
    assert list(standing_batch.signatures) == signatures
    assert not to_compile()
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    assert to_compile()
    assert not is_kept("standing.standing_batch")
