"""What a verdict rests on besides its object and its motion, as short texts that are kept with a run."""

import hashlib
from functools import cache

from pipeline.resources import digest_of
from pipeline.settings import Settings

_ELSEWHERE = frozenset(
    {
        "cli",
        "collection",
        "execute",
        "kernels",
        "motions",
        "night",
        "operations",
        "records",
        "report",
        "store",
        "tools",
        "verification",
    }
)
"""Folders of the package that verdicts do not rest on, or whose result is kept itself: items, motions, kernels."""


@cache
def code_digest() -> str:
    """Return a digest of the code and the tables that turn items and motions into verdicts."""
    return digest_of(kinds=(".py", ".csv"), but=_ELSEWHERE)[:12]


def rules_digest(settings: Settings) -> str:
    """Return a digest of the museum's own rules of classification; "" where it has none."""
    own = settings.collection.rules
    return hashlib.sha256(settings.path(own).read_bytes()).hexdigest()[:12] if own else ""
