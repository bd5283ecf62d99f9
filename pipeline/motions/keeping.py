"""Processed motions kept between nights: an unchanged record is not read and processed again."""

import hashlib
import json
import os
from importlib.metadata import version
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from pipeline.motions.manifest import Record
from pipeline.records import Motion

Processed = tuple[Motion, dict[str, float]]
"""A motion and its measures."""


def key_of(record: Record) -> str:
    """Return the identity of all that a processed motion depends on.

    The manifest's record (with the hashes of its files, which loading the manifest has checked), the sources of this
    package, and the versions of the libraries that read and filter.
    """
    digest = hashlib.sha256(record.model_dump_json().encode())
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(source.read_bytes())
    for library in ("obspy", "scipy", "numpy"):
        digest.update(version(library).encode())
    return digest.hexdigest()


def recall(folder: Path, record: Record) -> Processed | None:
    """Return what an earlier night kept of this very record, or None; a damaged file counts as none."""
    try:
        with np.load(folder / f"{key_of(record)}.npz", allow_pickle=False) as kept:
            said = json.loads(str(kept["said"]))
            motion = Motion(float(kept["dt"]), kept["acceleration"], said["name"], said["steps"], said["source"])
        return (motion, said["measures"]) if motion.hash == said["hash"] else None
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None


def keep(folder: Path, record: Record, processed: Processed) -> None:
    """Keep a processed motion, atomically; a folder that cannot be written only costs the next night its time."""
    motion, measured = processed
    said = {"name": motion.name, "steps": motion.steps, "source": motion.source, "hash": motion.hash}
    aside = folder / f".{os.getpid()}.npz"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        np.savez(
            aside,
            dt=np.float64(motion.dt),
            acceleration=motion.acceleration,
            said=np.array(json.dumps({**said, "measures": measured})),
        )
        aside.replace(folder / f"{key_of(record)}.npz")
    except OSError:
        aside.unlink(missing_ok=True)
