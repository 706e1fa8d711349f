"""Functions of users in code whose numbers have derivatives: compiled for these, called by address.

numba compiles such a function for dual numbers as for any others, so that its derivatives are exact
in all that it reads: parameters, memory, deformation and rate.
"""

from functools import cache
from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..errors import ForeignError
from . import dual_arithmetic as dual_arithmetic  # it tells numba
from .calls import KEPT_CALLS, reason_of
from .dual import DOUBLE, Dual, load, split, store
from .foreign import FUNCTION_AT

WORD, NUMBERS = ir.IntType(64), DOUBLE.as_pointer()


@cache
def address_with_derivatives(address: int, returns: bool, k: int) -> int:
    """The address of the function at another one, of numbers with k derivatives.

    `ForeignError` where numba cannot compile it for them.
    """
    inner, numbers = FUNCTION_AT[address], types.CPointer(Dual(k))
    signature = types.void(
        *(numbers, numbers, types.int64, numbers, types.int64, types.float64, numbers)
    )
    try:
        wrapped = numba.cfunc(signature)(_returning(inner) if returns else _silent(inner))
    except Exception as error:  # of many kinds
        raise ForeignError(reason_of(error)) from error
    KEPT_CALLS.append(wrapped)
    return int(wrapped.address)


def _returning(inner: Any) -> Any:
    def call(out: Any, p: Any, n_p: Any, m: Any, n_m: Any, h: Any, motion: Any) -> None:
        results, x = numba.carray(out, 4), numba.carray(motion, 2)
        results[0], results[1], results[2], results[3] = inner(
            numba.carray(p, n_p), numba.carray(m, n_m), h, x[0], x[1]
        )

    return call


def _silent(inner: Any) -> Any:
    def call(out: Any, p: Any, n_p: Any, m: Any, n_m: Any, h: Any, motion: Any) -> None:
        x = numba.carray(motion, 2)
        inner(numba.carray(p, n_p), numba.carray(m, n_m), h, x[0], x[1])

    return call


@intrinsic  # type: ignore[untyped-decorator]
def call_with_derivatives(
    typing: Any, address: Any, parameters: Any, memory: Any, h: Any, c: Any, rate: Any
) -> Any:
    """`call_by_address`; addresses and times have no derivatives."""
    kind = parameters.dtype
    results = types.UniTuple(kind, 4)

    def numbers(builder: Any, n: int) -> Any:
        return cgutils.alloca_once(builder, DOUBLE, size=n * (1 + kind.k))

    def place(builder: Any, array: Any, i: int) -> Any:
        return builder.gep(array, [WORD(i * (1 + kind.k))])

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        at, elapsed = (
            split(builder, context.cast(builder, args[i], sig.args[i], kind))[0] for i in (0, 3)
        )
        out, motion = numbers(builder, 4), numbers(builder, 2)
        for i in (0, 1):
            value = context.cast(builder, args[4 + i], sig.args[4 + i], kind)
            store(builder, value, place(builder, motion, i), kind.k)
        arrays = []
        for array in args[1:3]:
            arrays.append(builder.bitcast(builder.extract_value(array, 0), NUMBERS))
            arrays.append(builder.extract_value(array, 1))
        kinds = [NUMBERS, NUMBERS, WORD, NUMBERS, WORD, DOUBLE, NUMBERS]
        function_type = ir.FunctionType(ir.VoidType(), kinds).as_pointer()
        function = builder.inttoptr(builder.fptosi(at, WORD), function_type)
        builder.call(function, [out, *arrays, elapsed, motion])
        values = [load(builder, place(builder, out, i), kind.k) for i in range(4)]
        return context.make_tuple(builder, results, values)

    return results(address, parameters, memory, h, c, rate), generate
