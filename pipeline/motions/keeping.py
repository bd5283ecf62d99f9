"""Processed motions kept between nights: an unchanged record is not read and processed again."""

import hashlib
import json
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from pipeline.records import Motion
from pipeline.resources import arrays, digest_of, replacing

Processed = tuple[Motion, dict[str, float]]
"""A motion and its measures."""


@cache
def _code() -> bytes:
    """What the sources that motions depend on (floors too) and the libraries that read and filter are."""
    libraries = (version(library) for library in ("obspy", "scipy", "numpy", "pywavelets"))
    return "-".join([digest_of("motions", "supports", "kernels"), *libraries]).encode()


def key_of(*parts: str) -> str:
    """Return the identity of a processed motion: of the code, and of all that it depends on besides.

    parts : such as the manifest's record (with the hashes of its files, which loading the manifest has checked)
    """
    digest = hashlib.sha256(_code())
    for part in parts:
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()


def recall(folder: Path, key: str) -> Processed | None:
    """Return what an earlier night kept under this very key, or None; a damaged file counts as none."""
    try:
        with arrays(folder / f"{key}.npz") as kept:
            said = json.loads(str(kept["said"]))
            motion = Motion(
                float(kept["dt"]),
                kept["acceleration"],
                said["name"],
                said["steps"],
                said["source"],
                said["start"],
                said["v_max"],
            )
        return (motion, said["measures"]) if motion.hash == said["hash"] else None
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile):
        return None


def keep(folder: Path, key: str, processed: Processed) -> None:
    """Keep a processed motion, atomically; a folder that cannot be written only costs the next night its time."""
    motion, measured = processed
    said = {
        "name": motion.name,
        "steps": motion.steps,
        "source": motion.source,
        "start": motion.start,
        "v_max": motion.v_max,
        "hash": motion.hash,
        "measures": measured,
    }
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(folder / f"{key}.npz") as aside, aside.open("wb") as stream:
            text = np.array(json.dumps(said))
            np.savez(stream, dt=np.float64(motion.dt), acceleration=motion.acceleration, said=text)
