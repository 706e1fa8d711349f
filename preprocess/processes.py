"""The processes that the unknowns of a body are spread over: one, unless MPI has more."""

from collections.abc import Callable
from typing import TypeVar

from ..superelement.validation import Array

Found = TypeVar("Found")


class Processes:
    """One process, which holds all unknowns.

    Of several, each holds the rows of its own unknowns of K, M and of all vectors (n_u, k), and
    runs the same code. Small matrices and numbers are the same to the last bit in all of them, so
    that they decide alike: they come out of `total`, or of `agreed`.
    """

    def total(self, part: Array) -> Array:
        """The sum over all processes of what each has summed over its own unknowns."""
        return part

    def largest(self, part: float) -> float:
        """The largest of the numbers that the processes have found in their own unknowns."""
        return part

    def agreed(self, find: Callable[[], Found]) -> Found:
        """What the first process finds, in all of them, or the exception that it raises.

        Libraries may round differently on other machines, and turn the vectors of an eigenproblem
        the other way.
        """
        return find()

    def on_this_machine(self, part: int) -> int:
        """The sum over the processes that share the memory of this machine."""
        return part


ONE_PROCESS = Processes()
