"""Makes what all workers of `make test` would else make at once: bytecode of the tests, and the compiled kernels.

It runs beside the checks of types and rules, which take as long; where both are there it takes seconds.
"""

import io
import sys
from contextlib import redirect_stdout

import pytest

from pipeline.analysis.response import respond
from pipeline.cli.console import Console
from pipeline.models import MODELS
from pipeline.verification.self_measurement import shaking
from pipeline.verification.tradeoff import measure

if __name__ == "__main__":
    # Every model at every step, with its charts, bounds and turned motions; then those that run along a line too.
    measure([shaking()], [], Console(quiet=True), objects=2)
    for model in MODELS:
        if model.directions == 0:
            respond(model.name, shaking(), directions=1, **model.trials.sample)
    # Eight thousand names; who reads them wants to see what could not be collected alone.
    with redirect_stdout(io.StringIO()) as told:
        done = pytest.main(["--collect-only", "--quiet", "--quiet"])
    sys.exit(told.getvalue() if done else 0)
