"""Makes what both workers of `make test` would else make at once: bytecode of the tests, and the compiled kernels.

It runs beside the check of types, while the other core has nothing to do; where both are there it takes seconds.
"""

import sys

import pytest

from pipeline.cli.console import Console
from pipeline.verification.extremes import shaking
from pipeline.verification.self_measurement import CASES
from pipeline.verification.tradeoff import measure

if __name__ == "__main__":
    # Every model, in all of its directions, coarse and fine; then its charts, bounds and turned motions.
    for case in CASES:
        case.measure()
    measure([shaking()], [], Console(quiet=True), objects=2)
    sys.exit(pytest.main(["--collect-only", "--quiet", "--quiet"]))
