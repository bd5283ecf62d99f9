"""The last digits of a motion do not hang on how many threads BLAS has."""

from concurrent.futures import ThreadPoolExecutor

from threadpoolctl import threadpool_info, threadpool_limits

from pipeline.models.common import smallest_push
from pipeline.motions.blas import one_thread
from pipeline.motions.by_name import read_motion
from pipeline.motions.manifest import FloorTable
from pipeline.motions.site import carry, measured
from pipeline.resources import resource

FLOOR = FloorTable(name="2", height_ratio=0.6, period_s=0.5, method="modal", damping=0.05, stiffness_ratio=5.0, modes=3)


def told(threads: int) -> list[object]:
    with threadpool_limits(limits=threads, user_api="blas"):
        (ground,) = read_motion(resource("site_motions", "demo"))
        up = carry(ground, FLOOR)
        pushes = [smallest_push(motion.excitation(None)) for motion in (ground, up)]
        return [ground.hash, up.hash, *pushes, measured(ground)]


def test_a_motion_has_the_same_digits_on_one_core_and_on_two() -> None:
    """Its hash, all its measures, and what bounds rest on: the straight baseline used to differ in the last digit."""
    assert told(2) == told(1)


def threads_of_blas() -> set[int]:
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


def test_the_last_to_leave_gives_the_threads_back() -> None:
    with threadpool_limits(limits=2, user_api="blas"):
        assert threads_of_blas() == {2}
        with ThreadPoolExecutor(1) as other, one_thread():
            with one_thread():
                assert threads_of_blas() == {1}
            assert threads_of_blas() == {1}
            assert other.submit(threads_of_blas).result() == {1}
        assert threads_of_blas() == {2}
