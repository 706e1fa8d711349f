"""Force laws of one coordinate, an open set: each is a class that says what it is and what it does.

A law gives the force against a coordinate c with the rate dc/dt, its two derivatives, and the energy
that it stores: force, dforce/dc, dforce/drate, energy. What it needs are `parameters`, numbers that
it lays out itself. `@force_law` registers a class and compiles its function; rows name it by number.
"""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Protocol, TypeVar

from ..arrays import Array
from ..compiler.marks import compiled

Evaluation = tuple[float, float, float, float]


class ForceLaw(Protocol):
    """A law of one coordinate."""

    kind: ClassVar[int]
    """its number in compiled code, given by `force_law`"""

    def parameters(self) -> Sequence[float]:
        """What `evaluate` reads."""

    @staticmethod
    def evaluate(parameters: Array, c: float, rate: float) -> Evaluation:
        """Force, its derivatives by c and by the rate, and stored energy; compiled."""


LAWS: list[Any] = []
"""registered classes by number"""
Class = TypeVar("Class", bound=type)


def force_law(cls: Class) -> Class:
    """Register a class of laws."""
    cls.kind = len(LAWS)  # type: ignore[attr-defined]
    compiled(cls.evaluate)  # type: ignore[attr-defined]
    LAWS.append(cls)
    return cls


@force_law
class TabulatedLaw:
    """Linear between points (coordinate, force), and so beyond the last ones."""

    def __init__(self, coordinate: Sequence[float], force: Sequence[float]) -> None:
        self.coordinate, self.force = coordinate, force

    def parameters(self) -> Sequence[float]:
        return [*self.coordinate, *self.force]

    @staticmethod
    def evaluate(parameters: Array, c: float, rate: float) -> Evaluation:
        n = len(parameters) // 2
        energy, k = 0.0, 0
        while k + 2 < n and c > parameters[k + 1]:
            width = parameters[k + 1] - parameters[k]
            energy += 0.5 * (parameters[n + k] + parameters[n + k + 1]) * width
            k += 1
        start, force = parameters[k], parameters[n + k]
        slope = (parameters[n + k + 1] - force) / (parameters[k + 1] - start)
        value = force + slope * (c - start)
        return value, slope, 0.0, energy + 0.5 * (force + value) * (c - start)


def _dispatcher() -> Callable[[int, Array, float, float], Evaluation]:
    """A compiled function that calls the law of a number: one branch for each."""
    lines = ["def evaluate_law(kind, parameters, c, rate):"]
    for law in LAWS:
        lines += [
            f"    if kind == {law.kind}:",
            f"        return law_{law.kind}(parameters, c, rate)",
        ]
    lines.append("    return 0.0, 0.0, 0.0, 0.0")
    names: dict[str, Any] = {f"law_{law.kind}": law.evaluate for law in LAWS}
    names["__name__"] = __name__
    exec("\n".join(lines), names)
    function: Callable[[int, Array, float, float], Evaluation] = names["evaluate_law"]
    return compiled(function)


evaluate_law = _dispatcher()
NO_LAW = -1
