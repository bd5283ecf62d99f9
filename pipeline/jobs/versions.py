"""What a verdict rests on besides its object and its motion, as short texts that are kept with a run."""

import hashlib
from functools import cache
from pathlib import Path

import pipeline
from pipeline.settings import Settings

_ELSEWHERE = frozenset({"cli", "collection", "execute", "jobs", "kernels", "motions", "records", "report", "store"})
"""Folders of the package that verdicts do not rest on, or whose result is kept itself: items, motions, kernels."""


@cache
def code_digest() -> str:
    """Return a digest of the code and the tables that turn items and motions into verdicts."""
    home = Path(pipeline.__file__).parent
    digest = hashlib.sha256()
    for file in sorted(home.rglob("*")):
        if file.suffix in (".py", ".csv") and file.relative_to(home).parts[0] not in _ELSEWHERE:
            digest.update(file.relative_to(home).as_posix().encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:12]


def rules_digest(settings: Settings) -> str:
    """Return a digest of the museum's own rules of classification; "" where it has none."""
    own = settings.collection.rules
    return hashlib.sha256(settings.path(own).read_bytes()).hexdigest()[:12] if own else ""
