"""The names that Nastran gives to matrices of stiffness and mass."""

from collections.abc import Iterable

from ..errors import MatrixError

STIFFNESS_NAMES = ("KGG", "KAA", "KAAX", "KXX")
MASS_NAMES = ("MGG", "MAA", "MAAX", "MXX")
"""Of all points, of the analysis set, of that as DMIG, and of an external superelement."""


def chosen_name(names: Iterable[str], wanted: tuple[str, ...]) -> str:
    """The first wanted name that is there, else the only name, unless that is of another matrix.

    `MatrixError` lists what is there.

    >>> chosen_name(["PG", "MAA", "KAA"], STIFFNESS_NAMES)
    'KAA'
    """
    there = list(dict.fromkeys(names))
    found = [name for name in wanted if name in there]
    # A name of no meaning may be that of any matrix; KGG is not that of a mass.
    if not found and len(there) == 1 and there[0] not in (*STIFFNESS_NAMES, *MASS_NAMES):
        found = there
    if not found:
        raise MatrixError(
            f"expected a matrix {', '.join(wanted[:-1])} or {wanted[-1]}, "
            f"found {', '.join(there) or 'none'}"
        )
    return found[0]
