"""The surface of the mesh, with the displacements and stresses of modes there."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..files.arrays import Array, IntArray
from .cells import checked_cells
from .validation import SuperelementError, checked


@dataclass(frozen=True, eq=False)
class Recovery:
    """Fields of the surface mesh from modal coordinates: u = phi eta, sigma = stress eta.

    Parameters
    ----------
    points : (p, 3) [m]
        From the center of mass, in body axes.
    cells : (n, k) of int
        Rows of point indices; -1 fills short rows. The type follows from the number of points, in
        meshio's order: 2 line, 3 triangle, 4 quad, 6 triangle6, 8 quad8, 9 quad9.
    phi : (p, 3, m) [1/sqrt(kg)]
    stress : (p, 6, m) [Pa/(m sqrt(kg))], optional
        In the order xx, yy, zz, yz, xz, xy.
    phi_rotation : (p, 3, m), optional
        Small rotations of nodes of beams.
    nodes : (p,) of int, optional
        The number that the mesh file gives to the node of each point.

    Raises
    ------
    SuperelementError
        For arrays that do not fit each other.

    Examples
    --------
    >>> import numpy as np
    >>> line = Recovery(np.zeros((2, 3)), np.array([[0, 1]]), phi=np.ones((2, 3, 1)))
    >>> line.displacement(np.array([0.5])).tolist()
    [[0.5, 0.5, 0.5], [0.5, 0.5, 0.5]]
    """

    points: Array
    cells: IntArray
    phi: Array
    stress: Array | None = None
    phi_rotation: Array | None = None
    nodes: IntArray | None = None

    def __post_init__(self) -> None:
        points = checked("recovery: points", self.points, ("p", 3))
        phi = checked("recovery: phi", self.phi, (len(points), 3, "m"))
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", checked_cells("recovery: cells", self.cells, len(points)))
        object.__setattr__(self, "phi", phi)
        if self.stress is not None:
            stress = checked("recovery: stress", self.stress, (len(points), 6, phi.shape[2]))
            object.__setattr__(self, "stress", stress)
        if self.phi_rotation is not None:
            shape = (len(points), 3, phi.shape[2])
            turns = checked("recovery: phi_rotation", self.phi_rotation, shape)
            object.__setattr__(self, "phi_rotation", turns)
        if self.nodes is not None:
            object.__setattr__(self, "nodes", _checked_nodes(self.nodes, len(points)))

    def displacement(self, eta: Array) -> Array:
        """u = phi eta (..., p, 3) [m] in body axes, from modal coordinates (..., m)."""
        return _superpose(self.phi, eta)

    def rotation(self, eta: Array) -> Array:
        """theta = phi_rotation eta (..., p, 3) [rad]; `SuperelementError` without rotations."""
        if self.phi_rotation is None:
            raise SuperelementError("recovery: no rotations, which only nodes of beams have")
        return _superpose(self.phi_rotation, eta)

    def stresses(self, eta: Array) -> Array:
        """sigma = stress eta (..., p, 6) [Pa], body axes; `SuperelementError` without stresses."""
        return _superpose(self.stress_modes, eta)

    @property
    def stress_modes(self) -> Array:
        """`stress`; `SuperelementError` without stresses."""
        if self.stress is None:
            raise SuperelementError(
                "recovery: no stress modes, which only solids have and [recovery] stress asks for"
            )
        return self.stress


def von_mises(stress: Array) -> Array:
    """The equivalent stress of von Mises.

        sqrt(((xx - yy)^2 + (yy - zz)^2 + (zz - xx)^2) / 2 + 3 (yz^2 + xz^2 + xy^2))

    Parameters
    ----------
    stress : (..., 6) [Pa]
        In the order xx, yy, zz, yz, xz, xy.

    Returns
    -------
    (...) [Pa]

    Examples
    --------
    >>> import numpy as np
    >>> float(von_mises(np.array([100.0, 0.0, 0.0, 0.0, 0.0, 0.0])))
    100.0
    """
    # The order yz, xz, xy of the shear stresses does not matter here.
    xx, yy, zz, *shear = np.moveaxis(stress, -1, 0)
    square = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * sum(
        s * s for s in shear
    )
    equivalent: Array = np.sqrt(square)
    return equivalent


def _checked_nodes(value: Any, n_points: int) -> IntArray:
    nodes = np.array(value)
    if nodes.shape != (n_points,) or not np.issubdtype(nodes.dtype, np.integer):
        raise SuperelementError(
            f"recovery: nodes: expected {n_points} integers, found {nodes.dtype} {nodes.shape}"
        )
    nodes = nodes.astype(np.int64)
    nodes.flags.writeable = False
    return nodes


def _superpose(shapes: Array, eta: Array) -> Array:
    """Sum over modes (..., p, k) of shapes (p, k, m) times modal coordinates eta (..., m)."""
    p, k, m = shapes.shape
    field: Array = eta @ shapes.reshape(p * k, m).T
    return field.reshape(*eta.shape[:-1], p, k)
