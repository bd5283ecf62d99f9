"""What is too long for every day: `make soak` takes all of it, `make test` a sample."""

import os
from collections.abc import Iterable
from random import Random
from typing import TypeVar

import pytest

Case = TypeVar("Case")

SOAK = bool(os.environ.get("KOUROS_SOAK"))
"""Whether all cases are taken."""

soaked = pytest.mark.skipif(not SOAK, reason="long, and others of its kind are tried every day: make soak")
"""Marks a test, or a case of one, that only `make soak` takes."""


def some(cases: Iterable[Case], daily: int) -> list[Case]:
    """Return as many of some cases, the same every day: the first, the last, and of the others a seeded sample.

    All of them where `make soak` asks for all.
    """
    every = list(cases)
    if SOAK or len(every) <= daily:
        return every
    between = Random(20261127).sample(range(1, len(every) - 1), daily - 2)
    return [every[at] for at in (0, *sorted(between), len(every) - 1)]


def examples(soak: int) -> int:
    """Return how many examples of a property are tried: every day the same sixth, other ones at each `make soak`."""
    return soak if SOAK else max(10, soak // 6)
