"""Stars in the names of quantities: `acceleration:*:z` stands for all that there are."""

from collections.abc import Callable, Iterable
from fnmatch import fnmatchcase
from itertools import product
from typing import TypeVar

from .errors import QuantityError
from .quantities import KINDS_BY_NAME, names_in_role
from .results import Results
from .transforms import check, parse

WILDCARD_STAR = "*"
Made = TypeVar("Made")


def named(results: Results, text: str) -> list[str]:
    """The text, or with `*` in the names of its quantity all that it stands for.

    A star stands for anything, but for no colon: "force:arm.*", "srs(acceleration:*:z)". One in the
    place of the axis stands for all axes. Of what is listed some may not be there, as sensors of
    another kind. `QuantityError` where nothing has such a name.
    """
    quantity, _ = parse(text)
    if WILDCARD_STAR not in quantity:
        return [text]
    found = _matching(results, quantity)
    if not found:
        raise QuantityError(f"{text}: found no {quantity}")
    return [text.replace(quantity, one) for one in found]


def of_all(names: Iterable[str], made: Callable[[str], Iterable[Made]]) -> list[Made]:
    """What is made of all of the names that have it, as sensors of a kind.

    `QuantityError` of the last one where none has it.
    """
    found: list[Made] = []
    lacking: QuantityError | None = None
    for name in names:
        try:
            found += made(name)
        except QuantityError as error:
            lacking = error
    # Of a mixed list it is enough that some have it; an error is for none.
    if lacking is not None and not found:
        raise lacking
    return found


def _matching(results: Results, pattern: str) -> list[str]:
    kind_name, *names = pattern.split(":")
    if kind_name not in KINDS_BY_NAME:
        check(results, pattern)
    roles = KINDS_BY_NAME[kind_name].names
    axis = (
        []
        if names[len(roles) :] == [WILDCARD_STAR] and KINDS_BY_NAME[kind_name].axes
        else names[len(roles) :]
    )
    choices = [_owners(results, role, name) for role, name in zip(roles, names, strict=False)]
    return [":".join([kind_name, *chosen, *axis]) for chosen in product(*choices)]


def _owners(results: Results, role: str, pattern: str) -> list[str]:
    """The owners in a role, as "BODY|FRAME", that a pattern stands for."""
    if WILDCARD_STAR not in pattern:
        return [pattern]
    names: list[str] = []
    for word in role.split("|"):
        names += names_in_role(results, word)
    return matching(names, pattern)


def matching(names: Iterable[str], pattern: str) -> list[str]:
    """The names that a pattern with stars stands for, each once.

    The star alone is special: brackets and question marks are letters of names.
    """
    escaped = "".join(f"[{letter}]" if letter in "[?" else letter for letter in pattern)
    return [name for name in dict.fromkeys(names) if fnmatchcase(name, escaped)]
