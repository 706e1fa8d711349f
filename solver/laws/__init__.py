"""Force laws of one coordinate, an open set: every file of this folder may hold some.

law.py defines laws, and how one is added. Compiled code calls all of them by
`evaluate_law(number, parameters, c, rate)`.
"""

from collections.abc import Callable
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from ..arrays import Array
from ..compiler.marks import compiled
from .law import LAWS, Evaluation

for _module in sorted(module.name for module in iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")


def _dispatcher() -> Callable[[int, Array, float, float], Evaluation]:
    """A compiled function that calls the law of a number: a branch for each."""
    lines = ["def evaluate_law(number, parameters, c, rate):"]
    for law in LAWS:
        call = f"law_{law.number}(parameters, c, rate)"
        lines += [f"    if number == {law.number}:", f"        return {call}"]
    lines.append("    return 0.0, 0.0, 0.0, 0.0")
    names: dict[str, Any] = {f"law_{law.number}": law.evaluate for law in LAWS}
    names["__name__"] = __name__
    exec("\n".join(lines), names)
    function: Callable[[int, Array, float, float], Evaluation] = names["evaluate_law"]
    return compiled(function)


evaluate_law = _dispatcher()
