"""Small sites made by hand: real files of real formats, written with obspy."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

with warnings.catch_warnings():
    # obspy looks up its plugins in a deprecated way on some versions of Python.
    warnings.simplefilter("ignore")
    import obspy

DT = 0.01
Write = Callable[..., Path]


def tone(n: int = 4000, amplitude: float = 1.0, frequency: float = 1.0, dt: float = DT) -> np.ndarray:
    """A tone in a smooth envelope: at rest at both ends."""
    t = np.arange(n) * dt
    return amplitude * np.sin(np.pi * t / t[-1]) ** 2 * np.sin(2 * np.pi * frequency * t)


def toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{toml(k)} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    if isinstance(value, str):
        return json.dumps(value)  # the escapes of JSON are escapes of TOML
    return repr(value)


@pytest.fixture
def write_trace(tmp_path: Path) -> Write:
    def write(name: str, data: np.ndarray, channel: str = "HNE", form: str = "MSEED", **header: Any) -> Path:
        stats = {"network": "XX", "station": "TEST", "channel": channel, "sampling_rate": 1.0 / DT} | header
        obspy.Trace(np.ascontiguousarray(data), stats).write(str(tmp_path / name), format=form)
        return tmp_path / name

    return write


@pytest.fixture
def write_manifest(tmp_path: Path) -> Write:
    """Write a manifest of three MiniSEED files in m/s2; keywords change or (None) remove keys of the record."""

    def write(extra: str = "", level: str = "", **changes: Any) -> Path:
        record: dict[str, Any] = {
            "name": "hand-made",
            "files": ["e.mseed", "n.mseed", "z.mseed"],
            "components": {
                "e.mseed": {"axis": "x", "orientation": 90},
                "n.mseed": {"axis": "y", "orientation": 0},
                "z.mseed": {"axis": "z", "orientation": "up"},
            },
            "units": "m/s2",
            "processed": True,
            "source": "made by hand",
            "licence": "none needed",
        } | changes
        record = {key: value for key, value in record.items() if value is not None}
        if "sha256" not in record:
            record["sha256"] = {
                name: hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()
                for name in record["files"]
                if (tmp_path / name).is_file()
            }
        lines = ["[site]", 'name = "test"', "latitude = 34.0", "longitude = -118.0", ""]
        lines += ["[[level]]", 'name = "design"', 'combine = "max"', level, "", "[[level.record]]"]
        lines += [f"{key} = {toml(value)}" for key, value in record.items()]
        (tmp_path / "manifest.toml").write_text("\n".join(lines) + "\n" + extra + "\n", encoding="utf-8")
        return tmp_path

    return write


@pytest.fixture
def three(write_trace: Write) -> Callable[..., None]:
    """Write e.mseed, n.mseed and z.mseed; keywords x, y, z replace the tones."""

    def write(x: Any = None, y: Any = None, z: Any = None, **header: Any) -> None:
        for name, channel, data, amplitude in (("e", "HNE", x, 1.0), ("n", "HNN", y, 2.0), ("z", "HNZ", z, 0.5)):
            write_trace(f"{name}.mseed", tone(amplitude=amplitude) if data is None else data, channel, **header)

    return write
