"""Laws of users: functions of Python that the compiled time loop calls."""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from types import CodeType, FunctionType, ModuleType
from typing import Annotated, Any, ClassVar

import numpy as np

from ..arrays import Array
from ..compiler.foreign import address_of, call_by_address
from ..errors import ForeignError
from ..schema.entry import FieldSpec, entry
from ..schema.values import NO_ITEMS, Numbers
from .law import Evaluation, ForceLaw, law_number


class LawFunction:
    """A function of a user; what it computes is told apart by a digest, which repr gives."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.name = str(function.__name__)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LawFunction) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        digest = hashlib.blake2b(digest_size=8)
        for part in _parts(self.function, set()):
            digest.update(part)
        return f"{self.name} {digest.hexdigest()}"

    def address(self, returns: bool) -> float:
        return _address(self, returns)


@cache
def _address(function: LawFunction, returns: bool) -> float:
    """The same for all that compute the same."""
    return float(address_of(function.function, returns))


def _function(value: Any) -> LawFunction:
    if isinstance(value, LawFunction):
        return value
    if not isinstance(getattr(value, "py_func", value), FunctionType):
        raise TypeError
    return LawFunction(value)


AnyFunction = Annotated[
    Any, FieldSpec("a Python function, also one that numba compiles", _function)
]


@law_number
@entry(eq=True)
class UserLaw(ForceLaw):
    """A law written by a user, from Python alone: a function that numba can compile.

    Neither function may raise exceptions. `check_law` compares derivatives with differences.

    Parameters
    ----------
    function : callable
        function(parameters, memory, h, c, rate): of the parameters (an array), the memory (an
        array), the time h [s] since the memory was set, the deformation c and its rate. It returns
        the force that resists, its derivatives by c and by rate, and the stored energy [J]. At the
        start h is infinite: the law has always been at rest.
    numbers : sequence of float
        The parameters.
    memory : sequence of float
        What the law remembers before the start.
    update : callable, optional
        Of the same arguments: it sets `memory` to that at the end of a step and returns nothing.
        Then `function` must give the same force with h = 0 at the same c.

    Examples
    --------
    >>> from duhamel.solver import check_law
    >>> def cubic(parameters, memory, h, c, rate):
    ...     k = parameters[0]
    ...     return k * c**3, 3.0 * k * c**2, 0.0, 0.25 * k * c**4
    >>> check_law(UserLaw(cubic, [200.0]), deformations=[-0.1, 0.2])
    """

    function: AnyFunction
    numbers: Numbers = NO_ITEMS
    memory: Numbers = NO_ITEMS
    update: AnyFunction | None = None

    addresses: ClassVar[int] = 2

    def validate(self) -> None:
        if bool(self.memory) != (self.update is not None):
            raise self.error("memory: expected memory and update together, found one of them")
        for name, function in (("function", self.function), ("update", self.update)):
            try:
                self._address(function)
            except ForeignError as error:
                raise self.error(f"{name}: {getattr(function, 'name', '')}: {error}") from error

    def parameters(self) -> Sequence[float]:
        return [self._address(self.function), self._address(self.update), *self.numbers]

    def memories(self) -> Sequence[float]:
        return self.memory

    def _address(self, function: LawFunction | None) -> float:
        return 0.0 if function is None else function.address(returns=function is self.function)

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        numbers = parameters[2 : len(parameters)]
        return call_by_address(parameters[0], numbers, memory, h, c, rate)

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        if len(memory) > 0:
            numbers = parameters[2 : len(parameters)]
            call_by_address(parameters[1], numbers, memory, h, c, rate)


def _parts(value: Any, seen: set[int]) -> Iterator[bytes]:
    """What a function computes: its code, its constants, and the values that it takes from outside.

    Names of variables and line numbers are no part of it.
    """
    value = getattr(value, "py_func", value)
    if isinstance(value, FunctionType):
        if id(value) in seen:
            return
        seen.add(id(value))
        yield from _parts(value.__code__, seen)
        outside = [cell.cell_contents for cell in value.__closure__ or ()]
        names = _names(value.__code__)
        outside += [value.__globals__[name] for name in names if name in value.__globals__]
        yield from _parts((*outside, value.__defaults__), seen)
    elif isinstance(value, CodeType):
        yield value.co_code
        yield repr(value.co_names).encode()
        yield from _parts(value.co_consts, seen)
    elif isinstance(value, tuple):
        for item in value:
            yield from _parts(item, seen)
    elif isinstance(value, np.ndarray):
        yield repr((value.dtype.str, value.shape)).encode() + value.tobytes()
    else:
        yield (value.__name__ if isinstance(value, ModuleType) else repr(value)).encode()


def _names(code: CodeType) -> Iterator[str]:
    """The names that a function and those within it take from outside."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
