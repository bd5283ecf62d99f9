"""Makes what both workers of `make test` would else make at once: bytecode of the tests, and every compiled kernel.

It runs beside the check of types, while the other core has nothing to do; where both are there it takes seconds.
"""

import sys

import pytest

from pipeline.verification.self_measurement import CASES

if __name__ == "__main__":
    # The cases of the self-test run every model, in all of its directions, coarse and fine.
    for case in CASES:
        case.measure()
    sys.exit(pytest.main(["--collect-only", "--quiet", "--quiet", "--quiet"]))
