"""Agency files, unpacked, and obspy with its plugins."""

from __future__ import annotations

import gzip
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

with warnings.catch_warnings():
    # obspy looks up its plugins in a deprecated way on some versions of Python.
    warnings.simplefilter("ignore")
    import obspy  # noqa: F401

RECORDS = Path(__file__).parents[2] / "data" / "motions"


@pytest.fixture(scope="session")
def agency_file(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Unpack a file of tests/data/motions by its name; the same path on every call."""
    folder = tmp_path_factory.mktemp("records")

    def unpack(name: str) -> Path:
        if not (folder / name).exists():
            (folder / name).write_bytes(gzip.decompress((RECORDS / f"{name}.gz").read_bytes()))
        return folder / name

    return unpack
