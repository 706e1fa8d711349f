"""Functions of users in compiled code, which calls them by their address.

They are compiled by themselves, by numba's public interface, and the code of the time step stays as
it is. An address is a whole number below 2^53, which fits into a float.
"""

from collections.abc import Callable
from typing import Any

from ..arrays import Array
from .marks import compiled

Four = tuple[float, float, float, float]
FUNCTION_AT: dict[int, Callable[..., Any]] = {}
"""by address; of each there is one for as long as Python runs"""


@compiled
def call_by_address(
    address: float, parameters: Array, memory: Array, h: float, c: float, rate: float
) -> Four:
    """Call the function at an address; the numbers that it returns, or any if it returns none.

    Compilers replace this by a call of machine code (calls.py).
    """
    results = FUNCTION_AT[int(address)](parameters, memory, h, c, rate)
    return (0.0, 0.0, 0.0, 0.0) if results is None else results


def address_of(function: Callable[..., Any], returns: bool) -> int:
    """The address of the machine code of a function (parameters, memory, h, c, rate).

    returns: it returns four numbers, else none. `ForeignError` where it does not compile.
    """
    from .calls import machine_code

    called, address = machine_code(function, returns)
    address = address or len(FUNCTION_AT) + 1
    FUNCTION_AT[address] = called
    return address
