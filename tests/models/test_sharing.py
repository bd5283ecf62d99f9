"""The sets of one call, shared by threads: bit for bit what one thread finds, and an error is not lost."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import numpy as np
import pandas as pd
import pytest
from parameters import VALID
from shaking import random_motion

from pipeline import respond
from pipeline.models import common


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    before = common._threads
    yield
    common.share_among(before)


@pytest.mark.parametrize("name", ["standing", "oscillator", "swing_3d", "friction_isolator", "sliding", "rocking"])
def test_any_number_of_threads_finds_the_same_bits(name: str) -> None:
    """150 objects, which no number of threads divides into equal parts, and some that are nearly alike."""
    spread = np.linspace(0.5, 1.5, 150)
    many = {key: value * spread if key != "damping" else value for key, value in VALID[name].items()}
    motion = random_motion(3, n=2_000)
    found = {}
    for threads in (1, 2, 3, 8):
        common.share_among(threads)
        found[threads] = respond(name, motion, **many)
    for threads in (2, 3, 8):
        pd.testing.assert_frame_equal(found[threads], found[1], check_exact=True)


def test_every_set_is_done_once_by_several_threads_and_none_is_left_behind() -> None:
    common.share_among(4)
    done = np.zeros(1_001, dtype=int)
    ran = set()
    meeting = threading.Barrier(2, timeout=30.0)

    def run(part: slice) -> None:
        if len(ran) < 2 and threading.get_ident() not in ran:
            ran.add(threading.get_ident())
            meeting.wait()  # Two are at work at once, else this breaks.
        done[part] += 1

    common.shared(run, done.size, common.WORTH)
    assert (done == 1).all()
    assert not [one for one in threading.enumerate() if one.name.startswith("kernel")]


@pytest.mark.parametrize("at", [0, 500, 1_000])
def test_what_goes_wrong_in_a_thread_is_raised(at: int) -> None:
    common.share_among(3)

    def run(part: slice) -> None:
        if part.start <= at < part.stop:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        common.shared(run, 1_001, common.WORTH)
