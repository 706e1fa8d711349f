"""Open sets of compiled functions: one function that calls the member of a number."""

from collections.abc import Callable, Sequence
from typing import Any

from .marks import compiled


def dispatcher(
    name: str, arguments: str, members: Sequence[Callable[..., Any]], otherwise: str
) -> Callable[..., Any]:
    """A compiled function of a number and the arguments, with a branch for each member.

    otherwise: the expression that it returns for any other number. Compiled code has no tables of
    functions, through which nothing could be optimized.
    """
    lines = [f"def {name}(number, {arguments}):"]
    for number in range(len(members)):
        lines += [f"    if number == {number}:", f"        return member_{number}({arguments})"]
    lines.append(f"    return {otherwise}")
    names: dict[str, Any] = {f"member_{n}": member for n, member in enumerate(members)}
    names["__name__"] = members[0].__module__
    exec("\n".join(lines), names)
    return compiled(names[name])  # type: ignore[no-any-return]
