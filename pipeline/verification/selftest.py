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
from pipeline.quantities import counted
from pipeline.resources import replacing
from pipeline.settings import Settings
from pipeline.verification.outcome import Outcome

KEPT_AS = "numerics.json"
"""File, among what is kept between nights, in which the last self-test lies for the reports."""


@dataclass(frozen=True)
class SelfTest:
    """A whole self-test: when (ISO 8601, UTC), of which version and kernels, on what machine, with all its cases."""

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
    """Run the self-test, yield each outcome, and keep the whole for the next reports; None keeps nothing."""
    from pipeline.kernels import KERNEL_VERSION
    from pipeline.verification.self_measurement import outcomes

    done = []
    for outcome in outcomes():
        done.append(outcome)
        yield outcome
    if settings is not None:
        now = datetime.now(UTC).isoformat(timespec="seconds")
        keep(SelfTest(now, __version__, KERNEL_VERSION, machine(), done), settings.kept)


def keep(test: SelfTest, folder: Path) -> Path:
    """Keep a self-test for the next reports, atomically."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / KEPT_AS
    with replacing(file) as aside:
        aside.write_text(json.dumps(test.plain(), indent=2, allow_nan=False), encoding="utf-8")
    return file


def kept(folder: Path) -> SelfTest | None:
    """Return the last self-test, whatever kernels it ran, or None: never run, or damaged."""
    try:
        return TypeAdapter(SelfTest).validate_json((folder / KEPT_AS).read_bytes(), strict=True)
    except (OSError, ValueError):
        return None
