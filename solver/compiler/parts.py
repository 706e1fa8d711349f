"""Parts of a number: its value and, in code that is compiled with derivatives, each of these.

`dual` replaces these functions there; elsewhere a number has one part. They are for what must hold
for derivatives too, such as the end of an iteration. All else follows from arithmetic alone.
"""

from .marks import compiled


@compiled
def n_parts(x: float) -> int:
    """1, and the number of derivatives where a number has them."""
    return 1


@compiled
def part(x: float, i: int) -> float:
    """The value (i = 0) or derivative i - 1 of a number."""
    return x


@compiled
def filled_parts(x: float, value: float) -> float:
    """A number like x whose parts all are a value."""
    return value


@compiled
def larger_parts(x: float, y: float) -> float:
    """The larger of the magnitudes of two numbers, part by part."""
    return max(abs(x), abs(y))


@compiled
def largest_part(x: float) -> float:
    """The largest magnitude of the parts of a number."""
    largest = abs(part(x, 0))
    for i in range(1, n_parts(x)):
        largest = max(largest, abs(part(x, i)))
    return largest
