"""The surface of the mesh, with the displacements and stresses of modes there."""

from dataclasses import dataclass, replace

import numpy as np

from ..files.arrays import Array, IntArray
from .cells import checked_cells
from .validation import SuperelementError, checked, checked_integers


@dataclass(frozen=True, eq=False)
class SurfaceRest:
    """What forces f of contacts on nodes of surfaces add to the fields of modes.

        u = phi eta + displacement f,      sigma = stress_modes eta + stress f

    The static responses beyond those of the modes, by the rows of `Surfaces`.

    Parameters
    ----------
    displacement : (p, 3, 3 n) [m/N]
    stress : (p, 6, 3 n) [Pa/N], optional

    Raises
    ------
    SuperelementError
        For arrays that do not fit each other.

    Examples
    --------
    >>> import numpy as np
    >>> SurfaceRest(displacement=np.ones((2, 3, 9))).displacement.shape
    (2, 3, 9)
    """

    displacement: Array
    stress: Array | None = None

    def __post_init__(self) -> None:
        u = checked("recovery: rest: displacement", self.displacement, ("p", 3, "3 n"))
        object.__setattr__(self, "displacement", u)
        if self.stress is not None:
            stress = checked("recovery: rest: stress", self.stress, (len(u), 6, u.shape[2]))
            object.__setattr__(self, "stress", stress)


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
    rest : SurfaceRest, optional
        What forces on surfaces add.

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
    rest: SurfaceRest | None = None

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
            nodes = checked_integers("recovery: nodes", self.nodes, (len(points),))
            object.__setattr__(self, "nodes", nodes)
        if self.rest is not None:
            self._check_rest(self.rest)

    def _check_rest(self, rest: SurfaceRest) -> None:
        if len(rest.displacement) != len(self.points):
            raise SuperelementError(
                f"recovery: rest: expected {len(self.points)} points, found "
                f"{len(rest.displacement)}"
            )
        if (rest.stress is None) != (self.stress is None):
            raise SuperelementError("recovery: rest: expected stresses where the modes have some")

    def with_loads(self, rows: IntArray) -> "Recovery":
        """The same with forces on these rows of `Surfaces` as coordinates behind those of modes."""
        if self.rest is None:
            raise SuperelementError("recovery: no static rest of its surfaces")
        phi = np.concatenate([self.phi, self.rest.displacement[..., rows]], axis=2)
        stress = None
        if self.stress is not None and self.rest.stress is not None:
            stress = np.concatenate([self.stress, self.rest.stress[..., rows]], axis=2)
        return replace(self, phi=phi, stress=stress, rest=None)

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
                "recovery: no stress modes, which only solids have: give stress = true in "
                "[recovery] of the body file, and make the superelement and the run anew"
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


def _superpose(shapes: Array, eta: Array) -> Array:
    """Sum over modes (..., p, k) of shapes (p, k, m) times modal coordinates eta (..., m)."""
    p, k, m = shapes.shape
    field: Array = eta @ shapes.reshape(p * k, m).T
    return field.reshape(*eta.shape[:-1], p, k)
