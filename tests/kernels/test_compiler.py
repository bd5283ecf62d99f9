"""What the compiler is told sooner is what it would have found itself."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from itertools import product
from typing import Any

import numba
import pytest
from numba.core import types
from numba.core.compiler import Flags
from numba.core.cpu_options import FastMathOptions
from numba.core.errors import NumbaError
from numba.core.registry import cpu_target
from numba.extending import overload

from pipeline.kernels.compiler import _ask, call_type, hash_of_options, same_options

NUMBERS = (types.boolean, types.int64, types.uint8, types.float32, types.float64, types.complex128, types.literal(0))
ARRAYS = (types.float64[::1], types.float64[:], types.Array(types.int64, 2, "C", readonly=True))
OPERATORS = ("add", "sub", "mul", "truediv", "floordiv", "pow", "lt", "eq", "and_")


def options(**chosen: Any) -> Any:
    made = Flags()
    for name, value in chosen.items():
        setattr(made, name, value)
    return made


def test_options_are_equal_where_all_of_them_are() -> None:
    kinds = [
        options(),
        options(nrt=False),  # as it is by default
        options(nrt=True),
        options(fastmath=FastMathOptions(False)),
        options(fastmath=FastMathOptions({"contract"})),
        options(nrt=True, fastmath=FastMathOptions({"contract"})),
        options(error_model="numpy"),
    ]
    for one, other in product(kinds, kinds):
        assert same_options(one, other) == (one.values() == other.values())
        assert (one == other) == (one.values() == other.values())
        if one == other:
            assert hash_of_options(one) == hash_of_options(other) == hash(one) == hash(other)
    assert kinds[0] == kinds[1] != kinds[2]
    assert kinds[0] != "options"


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        *((name, product(NUMBERS, NUMBERS)) for name in (*OPERATORS, "iadd")),
        *((name, product(ARRAYS, (*ARRAYS[:1], *NUMBERS))) for name in (*OPERATORS, "getitem")),
        ("neg", product((*NUMBERS, *ARRAYS))),
        ("setitem", product(ARRAYS, NUMBERS, (*ARRAYS[:1], types.int64, types.float64))),
    ],
)
def test_calls_are_typed_as_numba_types_them(name: str, asked: Iterable[tuple[Any, ...]]) -> None:
    context = cpu_target.typing_context
    context.refresh()
    function = context.resolve_value_type(getattr(operator, name))
    for args in asked:
        try:
            own = _ask(function, context, args, {})
        except NumbaError:
            with pytest.raises(NumbaError):
                call_type(function, context, args, {})
            continue
        key = function.get_impl_key(own)
        # Found out, and then known.
        for _ in range(2):
            told = call_type(function, context, args, {})
            assert told == own
            assert function.get_impl_key(told) == key


def product_and_sum(a: float, b: float, c: float) -> float:
    return a * b + c


@overload(product_and_sum)
def _compiled_product_and_sum(a: Any, b: Any, c: Any) -> Any:
    def written(a: Any, b: Any, c: Any) -> Any:
        return a * b + c

    return written


def test_what_is_compiled_for_a_caller_is_compiled_by_its_options() -> None:
    def called(a: float, b: float, c: float) -> float:
        return product_and_sum(a, b, c)

    def as_written(a: float, b: float, c: float) -> float:
        return a * b + c

    numbers = (0.1, 10.0, -1.0)
    fused = numba.njit(as_written, fastmath={"contract"})(*numbers)
    # Exactly: 0.1 is stored a little too large.
    assert fused in (0.0, math.ldexp(1.0, -54))
    assert numba.njit(called)(*numbers) == 0.0
    assert numba.njit(called, fastmath={"contract"})(*numbers) == fused
    assert numba.njit(called)(*numbers) == 0.0
