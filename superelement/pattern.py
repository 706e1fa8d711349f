"""Load patterns: loads that are spread over a body, each with one amplitude."""

from dataclasses import dataclass

from ..files.arrays import Array
from .validation import SuperelementError, checked


@dataclass(frozen=True, eq=False)
class Pattern:
    """A distribution of loads in body axes, which a signal multiplies.

    force (3,) and moment (3,) about the center of mass: the resultants of the pattern at the
    amplitude 1, in body axes [N, N m]. What deforms the body is among its `Channels`.
    """

    name: str
    force: Array
    moment: Array

    def __post_init__(self) -> None:
        check_name("pattern", self.name)
        for key in ("force", "moment"):
            vector = checked(f"pattern {self.name!r}: {key}", getattr(self, key), (3,))
            object.__setattr__(self, key, vector)


def check_name(kind: str, name: str) -> None:
    """`SuperelementError` for a name that is not one line without '/' and '.'."""
    if not (name and name.isprintable()) or "/" in name or "." in name:
        raise SuperelementError(
            f"{kind} name: expected one line without '/' and '.', found {name!r}"
        )
