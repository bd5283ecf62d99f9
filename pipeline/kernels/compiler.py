"""The compiler asks itself the same things many times over: here it is answered sooner, and answered the same.

Most of what a kernel takes to compile is numba's own Python, not LLVM.  A fifth of it compares the options that
functions are compiled with, two dictionaries of forty properties whenever an overload is looked up; another finds out
anew, at each ``+`` of two numbers, that they are neither arrays nor lists.  The machine code is the same without this.

What is replaced is numba's own and may be otherwise in its next version: any but the one that this was tried with
compiles as it does, in half as long again.
"""

from typing import Any

import numba
from numba.core import types
from numba.core.targetconfig import TargetConfig

_TRIED = "0.68."
"""Version of numba whose inner ways are known."""
_SIMPLE = (types.Number, types.Boolean, types.Array)

# numba has no types.
_Options: Any = TargetConfig
_Function: Any = types.Function
_ask: Any = _Function.get_call_type

_known: dict[tuple[Any, ...], Any] = {}


def same_options(one: Any, other: Any) -> Any:
    """Say whether two sets of options are equal, as ``TargetConfig.__eq__`` does, by those alone that either sets.

    Parameters
    ----------
    one, other : TargetConfig
        What is not set has its default.

    Returns
    -------
    bool
        NotImplemented where other is something else.
    """
    if not isinstance(other, _Options):
        return NotImplemented
    if type(one) is not type(other):
        return one.values() == other.values()
    here, there = one._values, other._values
    return here == there or all(getattr(one, name) == getattr(other, name) for name in here.keys() | there.keys())


def hash_of_options(one: Any) -> int:
    """Return a hash that is the same for all options of a kind, as numba's own is: that sorts their names each time."""
    return hash(type(one))


def call_type(function: Any, context: Any, args: Any, kws: Any) -> Any:
    """Return the signature of a call of one of numba's own functions; of numbers and arrays it is found once.

    Parameters
    ----------
    function : Function
        Its templates, which are tried in turn, never change.
    context : BaseContext
        What types are resolved in.
    args, kws
        Types of the arguments.

    Returns
    -------
    Signature
        As ``Function.get_call_type`` does.
    """
    if kws or not all(isinstance(arg, _SIMPLE) for arg in args):
        return _ask(function, context, args, kws)
    asked = function, context, tuple(args)
    found = _known.get(asked)
    if found is None:
        found = _ask(function, context, args, kws)
        # What is itself compiled, an overload, is compiled by the options of who calls it.
        if function._impl_keys[found.args] == function.typing_key:
            _known[asked] = found
    else:
        function._impl_keys[found.args] = function.typing_key
    return found


def hasten() -> None:
    """Have numba answer sooner in this process, where it is the version that this is known of."""
    if not numba.__version__.startswith(_TRIED):
        return
    _Options.__eq__, _Options.__hash__ = same_options, hash_of_options
    _Function.get_call_type = call_type
