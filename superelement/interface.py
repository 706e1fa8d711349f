"""Interfaces: the frames that connect a superelement to others."""

from dataclasses import dataclass

from ..files.arrays import Array
from .validation import SuperelementError, checked


@dataclass(frozen=True, eq=False)
class Interface:
    """A point of the body that carries loads and joints.

    X (3,) is its position from the center of mass in body axes [m]. With `rotations` it has six
    dofs, three displacements [m] and three small rotations [rad], all in body axes; without, the
    displacements alone.
    """

    name: str
    X: Array
    rotations: bool = True

    def __post_init__(self) -> None:
        if not (self.name and self.name.isprintable()) or "/" in self.name or "." in self.name:
            raise SuperelementError(
                f"interface name: expected one line without '/' and '.', found {self.name!r}"
            )
        object.__setattr__(self, "X", checked(f"interface {self.name!r}: X", self.X, (3,)))

    @property
    def n_dofs(self) -> int:
        return 6 if self.rotations else 3
