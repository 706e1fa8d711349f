"""Calls of machine code by its address, for both compilers; numba's public interface alone."""

import re
from collections.abc import Callable
from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..errors import ForeignError

NUMBERS, WORD, DOUBLE = types.CPointer(types.float64), ir.IntType(64), ir.DoubleType()
LAW_RESULTS = types.UniTuple(types.float64, 4)
LAW_ARRAY = types.Array(types.float64, 1, "C")
TERMINAL_COLOR = re.compile("\x1b\\[[0-9;]*m")
LAW_SIGNATURE = types.void(
    NUMBERS, NUMBERS, types.int64, NUMBERS, types.int64, *[types.float64] * 3
)
"""results, parameters and memory with their lengths, h, c, rate"""


def machine_code(
    function: Callable[..., Any], returns: bool
) -> tuple[Callable[..., Any], int | None]:
    """What Python calls, and the address of the same as machine code; None where there is none."""
    inner = numba.njit(error_model="numpy")(getattr(function, "py_func", function))
    if numba.config.DISABLE_JIT:
        return inner, None
    try:
        inner.compile((LAW_ARRAY, LAW_ARRAY, *[types.float64] * 3))
        _check(inner.nopython_signatures[0].return_type, returns)
        wrapped = numba.cfunc(LAW_SIGNATURE)(_returning(inner) if returns else _silent(inner))
    except ForeignError:
        raise
    except Exception as error:  # of many kinds
        raise ForeignError(reason_of(error)) from error
    KEPT_CALLS.append(wrapped)
    return inner, wrapped.address


KEPT_CALLS: list[Any] = []
"""machine code lives as long as what made it"""


def _check(returned: Any, returns: bool) -> None:
    if not returns and returned != types.none:
        raise ForeignError("expected a function that returns nothing")
    numbers = types.Integer, types.Float, types.Boolean
    parts = list(returned) if isinstance(returned, types.BaseTuple) else []
    if returns and not (len(parts) == 4 and all(isinstance(part, numbers) for part in parts)):
        raise ForeignError("expected a function that returns four numbers")


def reason_of(error: Exception) -> str:
    """The line of numba's report that says what is wrong, without colors of a terminal."""
    report = TERMINAL_COLOR.sub("", str(error))
    lines = [line.strip() for line in report.splitlines() if line.strip()]
    reasons = [line for line in lines if not line.startswith("Failed in")]
    what = reasons[0] if reasons else type(error).__name__
    calls = [line.removeprefix(">>> ") for line in reasons if line.startswith(">>> ")]
    return f"{what} {calls[0]}" if what.endswith("signature:") and calls else what


def _returning(inner: Any) -> Any:
    def call(out: Any, p: Any, n_p: Any, m: Any, n_m: Any, h: Any, c: Any, rate: Any) -> None:
        results = numba.carray(out, 4)
        results[0], results[1], results[2], results[3] = inner(
            numba.carray(p, n_p), numba.carray(m, n_m), h, c, rate
        )

    return call


def _silent(inner: Any) -> Any:
    def call(out: Any, p: Any, n_p: Any, m: Any, n_m: Any, h: Any, c: Any, rate: Any) -> None:
        inner(numba.carray(p, n_p), numba.carray(m, n_m), h, c, rate)

    return call


def call_intrinsic(vector: Callable[[Any, Any, Any, Any], tuple[Any, Any]]) -> Any:
    """`call_by_address` as an intrinsic.

    vector(context, builder, type, value): address and length of an array.
    """

    @intrinsic  # type: ignore[untyped-decorator]
    def call(
        typing: Any, address: Any, parameters: Any, memory: Any, h: Any, c: Any, rate: Any
    ) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            pointer = DOUBLE.as_pointer()
            kinds = [pointer, pointer, WORD, pointer, WORD, DOUBLE, DOUBLE, DOUBLE]
            kind = ir.FunctionType(ir.VoidType(), kinds).as_pointer()
            function = builder.inttoptr(builder.fptosi(args[0], WORD), kind)
            out = cgutils.alloca_once(builder, DOUBLE, size=4)
            arrays = [*vector(context, builder, sig.args[1], args[1])]
            arrays += vector(context, builder, sig.args[2], args[2])
            builder.call(function, [out, *arrays, *args[3:]])
            values = [builder.load(builder.gep(out, [WORD(i)])) for i in range(4)]
            return context.make_tuple(builder, LAW_RESULTS, values)

        numbers = [types.float64] * 3
        return LAW_RESULTS(types.float64, parameters, memory, *numbers), generate

    return call
