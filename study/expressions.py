"""Arithmetic of study files: numbers, names of parameters, dotted keys, and few functions.

2 * mass        sqrt(k / bodies.hub.mass)        inertia[2] / 2        loads[0].signal.amplitude
"""

import ast
import math
import operator
import warnings
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

from ..inputs import quoted
from .errors import StudyError

Number = int | float
LookUp = Callable[[str], Any]
"""the value of a name or of a dotted key; `StudyError` if there is none"""


def _power(base: Number, exponent: Number) -> Number:
    """A power, by floating point: integers that fill the memory are none; integer where exact."""
    power = float(base) ** exponent
    if isinstance(power, complex):
        raise ValueError("a root of a negative number")
    is_exact = isinstance(base, int) and isinstance(exponent, int) and abs(power) < 2**53
    return int(power) if is_exact and exponent >= 0 else power


BINARY_OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: _power,
}
UNARY_OPERATORS: dict[type[ast.unaryop], Callable[[Any], Number]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}
NAMED_CONSTANTS = {"pi": math.pi}
NAMED_FUNCTIONS: dict[str, Callable[..., Number]] = {
    function.__name__: function
    for function in (
        *(math.sqrt, math.exp, math.log, math.log10, math.hypot, math.radians, math.degrees),
        *(math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.atan2),
        *(abs, min, max, round, math.floor, math.ceil),
    )
}
# Characters; formulas that people write are far shorter.
MAX_EXPRESSION_LENGTH = 1000
# Integers of TOML have 64 bits.
MAX_TOML_INTEGER = 2**63 - 1
# They cannot be names of parameters.
RESERVED_WORDS = frozenset({*NAMED_CONSTANTS, *NAMED_FUNCTIONS})
# What an operator can raise on numbers, a deep tree and a huge power included.
ARITHMETIC_FAULTS = (ArithmeticError, ValueError, TypeError, RecursionError, MemoryError)


def evaluate(text: str, look_up: LookUp) -> Any:
    """The number that an expression is, or the value of a name or key that it is alone.

    `StudyError` for anything but arithmetic, and for what has no finite value.
    """
    tree = _parsed(text)
    try:
        if (key := _key(tree)) is not None and key not in NAMED_CONSTANTS:
            return look_up(key)
        value = _value(tree, look_up)
    except StudyError as error:
        raise StudyError(f"{error}, in {quoted(text)}") from error
    except ARITHMETIC_FAULTS as error:
        raise StudyError(f"expected arithmetic, found {quoted(text)}: {error}") from error
    if not (abs(value) <= MAX_TOML_INTEGER if isinstance(value, int) else math.isfinite(value)):
        raise StudyError(f"expected a finite number, found {quoted(value)} of {quoted(text)}")
    return value


def names_in(text: str) -> Iterator[str]:
    """The names that an expression asks for, of dotted keys the first part."""
    for node in ast.walk(_parsed(text)):
        if isinstance(node, ast.Name) and node.id not in RESERVED_WORDS:
            yield node.id


def arguments_of(text: str, function: str) -> list[str]:
    """The arguments of a call of a function, where an expression is that alone; else the whole."""
    tree = _parsed(text)
    if isinstance(tree, ast.Call) and _key(tree.func) == function and not tree.keywords:
        return [ast.unparse(argument) for argument in tree.args]
    return [text]


@lru_cache(maxsize=1000)
def _parsed(text: str) -> ast.expr:
    if len(text) > MAX_EXPRESSION_LENGTH:
        raise StudyError(f"expected at most {MAX_EXPRESSION_LENGTH} characters, found {len(text)}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)  # of code that is no arithmetic anyway
            # Parsed, never evaluated by Python: study files may come from others.
            return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, *ARITHMETIC_FAULTS) as error:
        reason = getattr(error, "msg", str(error))
        raise StudyError(f"expected arithmetic, found {quoted(text)}: {reason}") from error


def _value(node: ast.expr, look_up: LookUp) -> Number:
    if isinstance(node, ast.Constant):
        constant: Any = node.value
        return _number(constant, "")
    if isinstance(node, ast.BinOp) and type(node.op) in BINARY_OPERATORS:
        return BINARY_OPERATORS[type(node.op)](
            _value(node.left, look_up), _value(node.right, look_up)
        )
    if isinstance(node, ast.UnaryOp) and type(node.op) in UNARY_OPERATORS:
        return UNARY_OPERATORS[type(node.op)](_value(node.operand, look_up))
    if isinstance(node, ast.Call) and not node.keywords:
        return _called(node, look_up)
    if (key := _key(node)) is None:
        raise StudyError(f"expected numbers, names, + - * / ** and functions, found {_shown(node)}")
    return NAMED_CONSTANTS[key] if key in NAMED_CONSTANTS else _number(look_up(key), f"{key} = ")


def _called(call: ast.Call, look_up: LookUp) -> Number:
    name = _key(call.func)
    if name not in NAMED_FUNCTIONS:
        raise StudyError(
            f"no function {_shown(call.func)}; there are: {', '.join(NAMED_FUNCTIONS)}"
        )
    arguments = [_value(argument, look_up) for argument in call.args]
    return NAMED_FUNCTIONS[name](*arguments)


def _key(node: ast.expr) -> str | None:
    """A name, or a dotted key as attributes and numbers in brackets; None for anything else."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        table = _key(node.value)
        return None if table is None else f"{table}.{node.attr}"
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
        table, entry = _key(node.value), node.slice.value
        is_number = isinstance(entry, int) and not isinstance(entry, bool)
        return f"{table}.{entry!r}" if table is not None and is_number else None
    return None


def _number(value: Any, what: str) -> Number:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise StudyError(f"expected a number, found {what}{quoted(value)}")
    return value


def _shown(node: ast.expr) -> str:
    return quoted(ast.unparse(node))
