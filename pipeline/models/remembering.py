"""What is told of a motion, remembered for as long as somebody holds it.

Most motions are drawn, asked a few things and let go; a cache of the latest so many would hold those alone.
"""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

from pipeline.records import Excitation, Motion

_Shaking = TypeVar("_Shaking", Motion, Excitation)
_Told = TypeVar("_Told")


def remembered(of: Callable[[_Shaking], _Told]) -> Callable[[_Shaking], _Told]:
    """Have a function of a motion alone, or of an excitation, called once for each.

    Parameters
    ----------
    of : callable
        What it returns must not hold the motion, which would live as long then.

    Returns
    -------
    callable
        Returns the same.
    """
    known: WeakKeyDictionary[_Shaking, _Told] = WeakKeyDictionary()

    @wraps(of)
    def told(motion: _Shaking) -> _Told:
        found = known.get(motion)
        if found is None:
            found = known[motion] = of(motion)
        return found

    return told
