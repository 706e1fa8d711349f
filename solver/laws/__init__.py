"""Force laws of one coordinate, an open set: every file of this folder may hold some.

law.py defines laws, and how one is added. Compiled code calls all of them by
`evaluate_law(number, parameters, memory, h, c, rate)`, `remember_law` of the same arguments, and
`permanent_of_law(number, parameters, memory, c)`.
"""

from collections.abc import Callable
from importlib import import_module
from pkgutil import iter_modules

from ..arrays import Array
from ..compiler.dispatch import dispatcher
from .law import LAW_KINDS, Evaluation

for _module in sorted(module.name for module in iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")


LAW_ARGUMENTS = "parameters, memory, h, c, rate"

evaluate_law: Callable[[int, Array, Array, float, float, float], Evaluation] = dispatcher(
    "evaluate_law",
    LAW_ARGUMENTS,
    [law.evaluate for law in LAW_KINDS],
    otherwise="0.0, 0.0, 0.0, 0.0",
)
remember_law: Callable[[int, Array, Array, float, float, float], None] = dispatcher(
    "remember_law", LAW_ARGUMENTS, [law.remember for law in LAW_KINDS], otherwise="None"
)
permanent_of_law: Callable[[int, Array, Array, float], float] = dispatcher(
    "permanent_of_law",
    "parameters, memory, c",
    [law.permanent for law in LAW_KINDS],
    otherwise="0.0",
)
