"""How good the elements of a mesh are."""

from dataclasses import dataclass

TETRAHEDRON_VOLUME = 2.0**0.5 / 12.0  # of edges of length 1


@dataclass(frozen=True)
class Quality:
    """Of the elements of a mesh, 1 at best each.

    shape: the radius of the inscribed over that of the circumscribed sphere, times 3, the worst and
    the mean; jacobian: the smallest over the largest Jacobian within an element, the worst.
    """

    elements: int
    worst_shape: float
    mean_shape: float
    worst_jacobian: float

    def __str__(self) -> str:
        return (
            f"{self.elements} tetrahedra, shape {self.worst_shape:.2g} at worst and "
            f"{self.mean_shape:.2g} in the mean, Jacobian {self.worst_jacobian:.2g} at worst"
        )
