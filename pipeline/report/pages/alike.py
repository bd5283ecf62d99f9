"""What many objects of a run share is put into words once: a memory of limited size, and what a finding is known by."""

from collections.abc import Callable, Hashable
from dataclasses import fields
from operator import attrgetter
from typing import Generic, TypeVar

from pipeline.records import Finding

Made = TypeVar("Made")

MOST = 16_384
"""Things that a memory holds, of 0.2 to 3 kB: of 20,000 real objects nine findings and numbers in ten are there."""

_OWN = ("object_number", "gallery")
"""Fields of a finding that say of which object it is; nothing else of it does."""

_shared = attrgetter(*(one.name for one in fields(Finding) if one.name not in (*_OWN, "mark")))


class Memory(Generic[Made]):
    """Things by what they were made of; when there are too many it begins anew."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._made: dict[Hashable, Made] = {}

    def had(self, key: Hashable, make: Callable[[], Made]) -> Made:
        """Return what was made of a key, or make it now.

        key : everything that it depends on
        """
        found = self._made.get(key)
        if found is None:
            if len(self._made) >= self._most:
                self._made.clear()
            found = self._made[key] = make()
        return found


def finding_key(finding: Finding) -> Hashable:
    """Return what a finding says, whichever object it is of: equal only for findings that are written alike."""
    told: tuple[object, ...] = _shared(finding)
    # 0.0 equals -0.0, and is not written like it.
    return (*told, *(str(value) for value in told if value == 0.0)) if 0.0 in told else told
