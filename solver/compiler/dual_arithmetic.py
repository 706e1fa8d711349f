"""Arithmetic of numbers with derivatives: dual numbers, for which `build` compiles functions too.

    x + sum_i dx_i e_i,   e_i e_j = 0,   so that   f(x) + sum_i f'(x) dx_i e_i

Comparisons and roundings take values alone, so that a run branches as it does without derivatives;
only `==` and `!=` compare derivatives too, since what is skipped as zero must be zero with all of
them. Where a function has a kink, at 0 of `abs` and `sqrt`, its derivative is the mean of those of
both sides. To import this file tells numba. Source: docs/theory.md, Derivatives by dual numbers.
"""

import math
import operator
from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typing import signature
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import intrinsic

from .dual import DOUBLE, LANE, NUMBER_TYPES, Dual, Number, gathered, joined, lane_of, lanes, split
from .parts import filled_parts, larger_parts, n_parts, part

INTEGER_WORD = ir.IntType(64)
MAX_ARGUMENTS = 4
"""of `max` and `min`"""


def _constant(k: int, value: float) -> Any:
    one = ir.Constant(DOUBLE, value)
    return one if k == 1 else ir.Constant(lanes(k), [one] * k)


def _spread(builder: Any, x: Any, like: Any) -> Any:
    """A number in every lane."""
    if like.type == DOUBLE:
        return x
    none = ir.Constant(like.type, ir.Undefined)
    first = builder.insert_element(none, x, LANE(0))
    return builder.shuffle_vector(
        first, none, ir.Constant(ir.VectorType(LANE, like.type.count), [0] * like.type.count)
    )


def _times(builder: Any, slope: Any, dx: Any) -> Any:
    """slope dx; None where dx is."""
    return None if dx is None else builder.fmul(_spread(builder, slope, dx), dx)


def _sum(builder: Any, dx: Any, dy: Any) -> Any:
    if dx is None or dy is None:
        return dy if dx is None else dx
    return builder.fadd(dx, dy)


def _negative(builder: Any, dx: Any) -> Any:
    return None if dx is None else builder.fneg(dx)


def _number(context: Any, builder: Any, type_: Any, value: Any) -> Number:
    if isinstance(type_, Dual):
        return split(builder, value)
    return context.cast(builder, value, type_, types.float64), None


# Operations of two numbers, of which one or both have derivatives


def _add(builder: Any, a: Number, b: Number) -> Number:
    return builder.fadd(a[0], b[0]), _sum(builder, a[1], b[1])


def _subtract(builder: Any, a: Number, b: Number) -> Number:
    if a[1] is not None and b[1] is not None:
        return builder.fsub(a[0], b[0]), builder.fsub(a[1], b[1])
    return builder.fsub(a[0], b[0]), _sum(builder, a[1], _negative(builder, b[1]))


def _multiply(builder: Any, a: Number, b: Number) -> Number:
    dx = _sum(builder, _times(builder, b[0], a[1]), _times(builder, a[0], b[1]))
    return builder.fmul(a[0], b[0]), dx


def _divide(builder: Any, a: Number, b: Number) -> Number:
    quotient = builder.fdiv(a[0], b[0])
    inverse = builder.fdiv(DOUBLE(1.0), b[0])
    change = _subtract(builder, (quotient, a[1]), (quotient, _times(builder, quotient, b[1])))[1]
    return quotient, _times(builder, inverse, change)


def _power(builder: Any, a: Number, b: Number) -> Number:
    """x^y; by y only where x > 0: elsewhere it has no derivative, or 0."""
    if isinstance(b[0], ir.Constant) and b[0].constant == 2.0:
        return builder.fmul(a[0], a[0]), _times(builder, builder.fmul(DOUBLE(2.0), a[0]), a[1])
    value = _call(builder, "pow", a[0], b[0])
    by_x = by_y = None
    if a[1] is not None:
        below = _call(builder, "pow", a[0], builder.fsub(b[0], DOUBLE(1.0)))
        by_x = _times(builder, builder.fmul(b[0], below), a[1])
    if b[1] is not None:
        positive = builder.fcmp_ordered(">", a[0], DOUBLE(0.0))
        logarithm = _call(builder, "log", builder.select(positive, a[0], DOUBLE(1.0)))
        by_y = _times(builder, builder.fmul(value, logarithm), b[1])
    return value, _sum(builder, by_x, by_y)


def _arctangent(builder: Any, a: Number, b: Number) -> Number:
    """atan2(y, x): (x dy - y dx) / (x^2 + y^2)"""
    square = builder.fadd(builder.fmul(a[0], a[0]), builder.fmul(b[0], b[0]))
    inverse = builder.fdiv(DOUBLE(1.0), square)
    by_y = _times(builder, builder.fmul(b[0], inverse), a[1])
    by_x = _times(builder, builder.fmul(a[0], inverse), b[1])
    value = _of_library(builder, "atan2", a[0], b[0])
    return value, _sum(builder, by_y, _negative(builder, by_x))


def _of_library(builder: Any, name: str, *arguments: Any) -> Any:
    """What a function of the C library gives."""
    kind = ir.FunctionType(DOUBLE, [DOUBLE] * len(arguments))
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), arguments)


def _call(builder: Any, name: str, *arguments: Any) -> Any:
    kind = ir.FunctionType(DOUBLE, [DOUBLE] * len(arguments))
    function = builder.module.declare_intrinsic(f"llvm.{name}", [DOUBLE], kind)
    return builder.call(function, arguments)


def _pairs() -> Iterator[tuple[Any, Any]]:
    yield Dual, Dual
    for other in NUMBER_TYPES:
        yield Dual, other
        yield other, Dual


def _dual_of(args: Any) -> Any:
    """The type with derivatives among numbers; None where there is none, or no number."""
    found = next((one for one in args if isinstance(one, Dual)), None)
    return found if all(isinstance(one, (Dual, *NUMBER_TYPES)) for one in args) else None


def _declare(function: Any, n: tuple[int, ...], result: Callable[[Any], Any]) -> None:
    """Let numba know the type of a function of n numbers of which some have derivatives."""

    class _Template(AbstractTemplate):  # type: ignore[misc]
        key = function

        def generic(self, args: Any, kws: Any) -> Any:
            kind = _dual_of(args) if len(args) in n else None
            return None if kind is None else signature(result(kind), *args)

    infer_global(function, types.Function(_Template))


def _implement_pair(function: Any, rule: Callable[[Any, Number, Number], Number]) -> None:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_number(context, builder, *one) for one in zip(sig.args, args, strict=True))
        return joined(builder, *rule(builder, a, b))

    _declare(function, (2,), lambda kind: kind)
    for pair in _pairs():
        lower_builtin(function, *pair)(lower)


for _functions, _rule in {
    (operator.add, operator.iadd): _add,
    (operator.sub, operator.isub): _subtract,
    (operator.mul, operator.imul): _multiply,
    (operator.truediv, operator.itruediv): _divide,
    (operator.pow, operator.ipow): _power,
    (math.atan2,): _arctangent,
}.items():
    for _function in _functions:
        _implement_pair(_function, _rule)


# Comparisons: of values, and of equality in all parts


def _implement_comparison(function: Any, sign: str) -> None:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_number(context, builder, *one) for one in zip(sig.args, args, strict=True))
        if sign == "!=":
            return builder.not_(_are_equal(builder, a, b, _dual_of(sig.args).k))
        if sign == "==":
            return _are_equal(builder, a, b, _dual_of(sig.args).k)
        return builder.fcmp_ordered(sign, a[0], b[0])

    _declare(function, (2,), lambda kind: types.boolean)
    for pair in _pairs():
        lower_builtin(function, *pair)(lower)


def _are_equal(builder: Any, a: Number, b: Number, k: int) -> Any:
    found = builder.fcmp_ordered("==", a[0], b[0])
    dx, dy = (_constant(k, 0.0) if one[1] is None else one[1] for one in (a, b))
    for i in range(k):
        same = builder.fcmp_ordered("==", lane_of(builder, dx, i), lane_of(builder, dy, i))
        found = builder.and_(found, same)
    return found


for _function, _sign in {
    operator.lt: "<",
    operator.le: "<=",
    operator.gt: ">",
    operator.ge: ">=",
    operator.eq: "==",
    operator.ne: "!=",
}.items():
    _implement_comparison(_function, _sign)


def _implement_extreme(function: Any, sign: str) -> None:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        kind = _dual_of(sig.args)
        given = [
            context.cast(builder, value, type_, kind)
            for type_, value in zip(sig.args, args, strict=True)
        ]
        found = given[0]
        for other in given[1:]:
            x, y = (builder.extract_value(one, 0) for one in (found, other))
            found = builder.select(builder.fcmp_ordered(sign, y, x), other, found)
        return found

    counts = range(2, MAX_ARGUMENTS + 1)
    _declare(function, tuple(counts), lambda kind: kind)
    for n in counts:
        for combination in product((Dual, *NUMBER_TYPES), repeat=n):
            if Dual in combination:
                lower_builtin(function, *combination)(lower)


_implement_extreme(max, ">")
_implement_extreme(min, "<")


# Functions of one number


def _slope(rule: Callable[[Any, Any], tuple[Any, Any]]) -> Callable[..., Any]:
    """What returns a number, of a rule that gives value and slope."""

    def number(context: Any, builder: Any, x: Any, dx: Any) -> Any:
        value, slope = rule(builder, x)
        return joined(builder, value, _times(builder, slope, dx))

    return number


def _absolute(builder: Any, x: Any) -> tuple[Any, Any]:
    below = builder.fcmp_ordered("<", x, DOUBLE(0.0))
    above = builder.fcmp_ordered(">", x, DOUBLE(0.0))
    sign = builder.select(below, DOUBLE(-1.0), builder.select(above, DOUBLE(1.0), DOUBLE(0.0)))
    return _call(builder, "fabs", x), sign


def _root(builder: Any, x: Any) -> tuple[Any, Any]:
    root = _call(builder, "sqrt", x)
    at_zero = builder.fcmp_ordered("==", x, DOUBLE(0.0))
    slope = builder.fdiv(DOUBLE(0.5), root)
    return root, builder.select(at_zero, DOUBLE(0.0), slope)


def _sine(builder: Any, x: Any) -> tuple[Any, Any]:
    return _call(builder, "sin", x), _call(builder, "cos", x)


def _cosine(builder: Any, x: Any) -> tuple[Any, Any]:
    return _call(builder, "cos", x), builder.fneg(_call(builder, "sin", x))


def _exponential(builder: Any, x: Any) -> tuple[Any, Any]:
    value = _call(builder, "exp", x)
    return value, value


def _logarithm(builder: Any, x: Any) -> tuple[Any, Any]:
    return _call(builder, "log", x), builder.fdiv(DOUBLE(1.0), x)


def _tangent(builder: Any, x: Any) -> tuple[Any, Any]:
    value = _of_library(builder, "tan", x)
    return value, builder.fadd(DOUBLE(1.0), builder.fmul(value, value))


def _arctangent_of_one(builder: Any, x: Any) -> tuple[Any, Any]:
    square = builder.fadd(DOUBLE(1.0), builder.fmul(x, x))
    return _of_library(builder, "atan", x), builder.fdiv(DOUBLE(1.0), square)


def _hyperbolic_sine(builder: Any, x: Any) -> tuple[Any, Any]:
    return _of_library(builder, "sinh", x), _of_library(builder, "cosh", x)


def _hyperbolic_cosine(builder: Any, x: Any) -> tuple[Any, Any]:
    return _of_library(builder, "cosh", x), _of_library(builder, "sinh", x)


def _hyperbolic_tangent(builder: Any, x: Any) -> tuple[Any, Any]:
    value = _of_library(builder, "tanh", x)
    return value, builder.fsub(DOUBLE(1.0), builder.fmul(value, value))


def _implement(function: Any, result: Callable[[Any], Any], rule: Callable[..., Any]) -> None:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return rule(context, builder, *split(builder, args[0]))

    _declare(function, (1,), result)
    lower_builtin(function, Dual)(lower)


WITH_SLOPES: dict[Any, Callable[[Any, Any], tuple[Any, Any]]] = {
    abs: _absolute,
    math.sqrt: _root,
    math.sin: _sine,
    math.cos: _cosine,
    math.exp: _exponential,
    math.log: _logarithm,
    math.fabs: _absolute,
    math.tan: _tangent,
    math.atan: _arctangent_of_one,
    math.sinh: _hyperbolic_sine,
    math.cosh: _hyperbolic_cosine,
    math.tanh: _hyperbolic_tangent,
    np.abs: _absolute,
    np.sqrt: _root,
    np.sin: _sine,
    np.cos: _cosine,
    np.exp: _exponential,
    np.log: _logarithm,
    np.tanh: _hyperbolic_tangent,
}
for _name, _with_slope in WITH_SLOPES.items():
    _implement(_name, lambda kind: kind, _slope(_with_slope))


def _to_integer(context: Any, builder: Any, x: Any, dx: Any) -> Any:
    return builder.fptosi(x, INTEGER_WORD)


def _to_nearest(context: Any, builder: Any, x: Any, dx: Any) -> Any:
    return builder.fptosi(_call(builder, "rint", x), INTEGER_WORD)


def _is_no_number(context: Any, builder: Any, x: Any, dx: Any) -> Any:
    return builder.fcmp_unordered("uno", x, x)


def _same(context: Any, builder: Any, x: Any, dx: Any) -> Any:
    return joined(builder, x, dx)


def _opposite(context: Any, builder: Any, x: Any, dx: Any) -> Any:
    return joined(builder, builder.fneg(x), builder.fneg(dx))


_implement(operator.neg, lambda kind: kind, _opposite)
_implement(operator.pos, lambda kind: kind, _same)
_implement(float, lambda kind: kind, _same)
_implement(int, lambda kind: types.int64, _to_integer)
_implement(round, lambda kind: types.int64, _to_nearest)
_implement(math.isnan, lambda kind: types.boolean, _is_no_number)


def _widened(context: Any, builder: Any, from_: Any, to: Any, value: Any) -> Any:
    number = context.cast(builder, value, from_, types.float64)
    return joined(builder, number, _constant(to.k, 0.0))


for _kind in NUMBER_TYPES:
    lower_cast(_kind, Dual)(_widened)


# Parts of numbers (parts.py)


@intrinsic  # type: ignore[untyped-decorator]
def _n_parts(typing: Any, x: Any) -> Any:
    n = 1 + x.k if isinstance(x, Dual) else 1
    return types.int64(x), lambda context, builder, sig, args: INTEGER_WORD(n)


@intrinsic  # type: ignore[untyped-decorator]
def _part(typing: Any, x: Any, i: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if not isinstance(x, Dual):
            return context.cast(builder, args[0], x, types.float64)
        value, dx = split(builder, args[0])
        found = value
        for lane in range(x.k):
            chosen = builder.icmp_signed("==", args[1], INTEGER_WORD(1 + lane))
            found = builder.select(chosen, lane_of(builder, dx, lane), found)
        return found

    return types.float64(x, types.int64), generate


@intrinsic  # type: ignore[untyped-decorator]
def _filled_parts(typing: Any, x: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        number = context.cast(builder, args[1], value, types.float64)
        if not isinstance(x, Dual):
            return number
        return joined(builder, number, _spread(builder, number, _constant(x.k, 0.0)))

    return (x if isinstance(x, Dual) else types.float64)(x, value), generate


@intrinsic  # type: ignore[untyped-decorator]
def _larger_parts(typing: Any, x: Any, y: Any) -> Any:
    kind = _dual_of((x, y)) or types.float64

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (
            context.cast(builder, value, type_, kind)
            for type_, value in zip((x, y), args, strict=True)
        )
        if not isinstance(kind, Dual):
            return _larger(builder, a, b)
        (a, da), (b, db) = split(builder, a), split(builder, b)
        found = [
            _larger(builder, lane_of(builder, da, i), lane_of(builder, db, i))
            for i in range(kind.k)
        ]
        return joined(builder, _larger(builder, a, b), gathered(builder, found))

    return kind(x, y), generate


def _larger(builder: Any, x: Any, y: Any) -> Any:
    x, y = _call(builder, "fabs", x), _call(builder, "fabs", y)
    return builder.select(builder.fcmp_ordered(">", y, x), y, x)


DUAL_INTRINSICS: dict[Any, Any] = {
    n_parts: _n_parts,
    part: _part,
    filled_parts: _filled_parts,
    larger_parts: _larger_parts,
}
"""what stands for functions of parts.py"""
