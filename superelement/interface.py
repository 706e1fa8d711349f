"""Interfaces: the frames that connect a superelement to others."""

from dataclasses import dataclass

from ..files.arrays import Array
from .validation import check_name, checked


@dataclass(frozen=True, eq=False)
class Interface:
    """A point of an elastic body that carries loads, joints and contacts.

    Parameters
    ----------
    name : str
        One line without '/' and '.'.
    X : (3,) [m]
        Position from the center of mass, in body axes.
    rotations : bool
        With rotations it has six dofs, three displacements [m] and three small rotations [rad], all
        in body axes; without, the displacements alone.

    Raises
    ------
    SuperelementError
        For a name or a position that is not one.

    Examples
    --------
    >>> import numpy as np
    >>> Interface("tip", X=np.array([0.5, 0.0, 0.0])).n_dofs
    6
    """

    name: str
    X: Array
    rotations: bool = True

    def __post_init__(self) -> None:
        check_name("interface", self.name)
        object.__setattr__(self, "X", checked(f"interface {self.name!r}: X", self.X, (3,)))

    @property
    def n_dofs(self) -> int:
        """The number of its degrees of freedom, 6 or 3."""
        return 6 if self.rotations else 3
