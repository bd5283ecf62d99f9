"""A night that finds only what changed equals a night from nothing, whatever changed, in whatever order."""

import os
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from random import Random

import numpy as np
import pytest

from pipeline.execute.pool import pool
from pipeline.motions import site
from pipeline.motions.pulses import WaveletPulse, shahi_baker_pulse
from pipeline.night import scheduler, staff
from pipeline.night.context import RunContext
from pipeline.night.unit_tasks import Assessments, UnitTask, assess_units
from pipeline.night.units import paged
from tests.night.changing import Changing, exported, leave_out_pages

pytestmark = pytest.mark.slow_file

LONG = pytest.mark.long("test_a_night_that_finds_only_what_changed_equals_one_from_nothing")

SOAK = "KOUROS_SEQUENCES" in os.environ
SEQUENCES = int(os.environ.get("KOUROS_SEQUENCES", "7"))
DAILY = 1
FIRST = int(os.environ.get("KOUROS_FIRST", "0"))
EDITS = int(os.environ.get("KOUROS_EDITS", "8" if SOAK else "4"))
"""Changes of each sequence: of all seven each kind once at least, in a `make soak` any at any time."""


@cache
def pulse(velocity: bytes, dt: float) -> WaveletPulse:
    return shahi_baker_pulse(np.frombuffer(velocity).reshape(3, -1), dt)


class Killed(BaseException):
    """The night's process is gone."""


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages of five objects and batches of four, in this process, stored as they come.

    What costs most and is not compared is left out: HTML, sheets, the workbook.  A motion's pulse is found once.
    """
    for module in (scheduler, staff):
        monkeypatch.setattr(module, "FEW", 4)
    monkeypatch.setattr(staff, "SHOWN", 4)
    monkeypatch.setattr(scheduler, "BATCH", 4)
    monkeypatch.setattr(scheduler, "_SECONDS", 0.0)
    monkeypatch.setattr(staff, "pool", lambda **_: pool())
    monkeypatch.setattr(scheduler, "paged", partial(paged, most=5))
    leave_out_pages(monkeypatch)
    monkeypatch.setattr(site, "shahi_baker_pulse", lambda velocity, dt: pulse(velocity.tobytes(), dt))


def cut_off(museum: Changing, monkeypatch: pytest.MonkeyPatch) -> None:
    """A night of a changed museum that ends at its second batch, and is taken up again."""
    museum.other_scale()
    museum.change_row()
    done = []

    def work(context: RunContext, task: UnitTask) -> Assessments:
        done.append(task)
        if len(done) > 1:
            raise Killed
        return assess_units(context, task)

    with monkeypatch.context() as patch:
        patch.setattr(scheduler, "assess_units", work)
        try:
            museum.night()
        except Killed:
            pass
        else:
            return
    museum.night(resume=True)


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(seed, marks=[LONG] if at >= DAILY else [])
        for at, seed in enumerate(range(FIRST, FIRST + SEQUENCES))
    ],
)
def test_a_night_that_finds_only_what_changed_equals_one_from_nothing(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    museum = Changing.of(tmp_path / "museum", seed)
    museum.night()
    history = []
    edits: list[Callable[[], None]] = [*museum.edits(), partial(cut_off, museum, monkeypatch)]
    order = Random(20261122).sample(range(len(edits)), len(edits))
    for number in range(EDITS):
        change = museum.random.choice(edits) if SOAK else edits[order[(seed * EDITS + number) % len(edits)]]
        history.append(getattr(change, "__name__", "cut_off"))
        change()
        after = exported(museum.night())
        # Every day what is wrong after one change is looked for after the last: a night from nothing is dear.
        if not SOAK and number < EDITS - 1:
            continue
        fresh = exported(museum.from_nothing(tmp_path / f"fresh-{number}"))
        for name, rows in fresh.items():
            assert after[name] == rows, (name, history)
