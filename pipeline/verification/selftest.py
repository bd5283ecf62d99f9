"""The last numerical self-test of a workspace, kept for its reports."""

import json
import os
import platform
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from pipeline import __version__
from pipeline.cache import SELF_TESTS, Cache, CacheEntry
from pipeline.quantities import counted
from pipeline.settings import Settings
from pipeline.verification.outcome import Outcome

LAST = "last"
"""Key under which the last self-test lies for the reports."""


@dataclass(frozen=True)
class SelfTest:
    """A whole self-test.

    Attributes
    ----------
    when : str
        ISO 8601, UTC.
    version, kernels : str
        What was tested.
    machine : str
        What the kernels were compiled for.
    cases : sequence of Outcome
        All of them.
    """

    when: str
    version: str
    kernels: str
    machine: str
    cases: Sequence[Outcome]

    def plain(self) -> dict[str, Any]:
        """Return it as a run's settings keep it."""
        return asdict(replace(self, cases=list(self.cases)))


def machine() -> str:
    """Return what the kernels are compiled for, without the machine's name: reports are handed around."""
    cores = counted(os.cpu_count() or 1, "core")
    return f"{platform.system()} {platform.machine()}, {cores}, Python {platform.python_version()}"


def self_test(settings: Settings | None) -> Iterator[Outcome]:
    """Run the self-test, yield each outcome, and keep the whole for the next reports.

    Parameters
    ----------
    settings : Settings or None
        Of the workspace that keeps it; None keeps nothing.

    Yields
    ------
    Outcome
        Of each case.
    """
    from pipeline.kernels import KERNEL_VERSION
    from pipeline.verification.self_measurement import outcomes

    done = []
    for outcome in outcomes():
        done.append(outcome)
        yield outcome
    if settings is not None:
        now = datetime.now(UTC).isoformat(timespec="seconds")
        keep(SelfTest(now, __version__, KERNEL_VERSION, machine(), done), settings.kept)


def keep(test: SelfTest, folder: Path) -> None:
    """Keep a self-test for the next reports, in place of the last one.

    Parameters
    ----------
    test : SelfTest
        What is kept.
    folder : Path
        Of the cache.
    """
    Cache(folder).put(SELF_TESTS, LAST, CacheEntry(test.plain()), lasting=True)


def kept(folder: Path) -> SelfTest | None:
    """Return the last self-test, whatever kernels it ran.

    Parameters
    ----------
    folder : Path
        Of the cache.

    Returns
    -------
    SelfTest or None
        None: never run, damaged, or of another form.
    """
    found = Cache(folder).get(SELF_TESTS, LAST, lasting=True)
    try:
        return None if found is None else TypeAdapter(SelfTest).validate_json(json.dumps(found.said), strict=True)
    except ValueError:
        return None
