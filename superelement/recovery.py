"""The surface of the mesh and how modes move it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .validation import Array, SuperelementError, checked


@dataclass(frozen=True, eq=False)
class Recovery:
    """Displacements and stresses of the surface mesh from modal coordinates eta: u = phi eta, sigma = stress eta.

    points (p, 3) from the centre of mass in body axes [m]; cells (n, k) rows of point indices (-1 fills short rows);
    phi (p, 3, m); stress (p, 6, m) in the order xx, yy, zz, yz, xz, xy, or None.
    """

    points: Array
    cells: NDArray[np.int64]
    phi: Array
    stress: Array | None = None

    def __post_init__(self) -> None:
        points = checked("recovery: points", self.points, ("p", 3))
        phi = checked("recovery: phi", self.phi, (len(points), 3, "m"))
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", _checked_cells(self.cells, len(points)))
        object.__setattr__(self, "phi", phi)
        if self.stress is not None:
            stress = checked("recovery: stress", self.stress, (len(points), 6, phi.shape[2]))
            object.__setattr__(self, "stress", stress)


def _checked_cells(value: Any, n_points: int) -> NDArray[np.int64]:
    cells = np.array(value, order="C")
    if cells.ndim != 2 or not np.issubdtype(cells.dtype, np.integer):
        raise SuperelementError(
            f"recovery: cells: expected integers of shape (n, k), found {cells.dtype} {cells.shape}"
        )
    if cells.size and (cells.min() < -1 or cells.max() >= n_points):
        raise SuperelementError(
            f"recovery: cells: expected point indices from -1 to {n_points - 1}, found {cells.min()} to {cells.max()}"
        )
    cells = cells.astype(np.int64)
    cells.flags.writeable = False
    return cells
