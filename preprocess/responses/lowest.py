"""An upper bound of the first elastic frequency, from polynomials in space."""

from itertools import combinations_with_replacement

import numpy as np
from scipy.linalg import eigh

from ...superelement.validation import Array
from ..assembly.structure import RIGID_DOFS, Structure
from ..errors import MeshError
from ..mesh.nodes import Nodes

MIN_FIELD_EIGENVALUE = 1e-9
"""Eigenvalue of the scaled mass matrix of the fields below which a field is a combination of
others.
"""
MIN_FIELD_MASS = 1e-12
"""Mass that moves with a field, relative to the largest, below which the body has no such motion: a
straight beam none that grows across it.
"""


def first_square(structure: Structure) -> float:
    """An upper bound of the first elastic omega^2 [1/s^2], by Ritz's method.

    The fields are all displacements of second degree in the coordinates: they bend, stretch and
    twist a homogeneous body much as its first mode does. Six of them are rigid, so that by
    Courant's principle the value after these bounds that of the mesh. `MeshError` where nothing but
    rounding is left of the body's elastic motion.
    """
    rigid, processes = structure.rigid, structure.processes
    size = float(np.sqrt(np.trace(rigid.J_rot) / rigid.mass))
    V = _quadratic_fields(structure.nodes, rigid.center, size)
    K, M = (structure.total(V.T @ (matrix @ V)) for matrix in (structure.K, structure.M))
    squares = processes.agreed(lambda: _squares(K, M))
    if len(squares) <= RIGID_DOFS or not 0.0 < squares[RIGID_DOFS] < np.inf:
        raise MeshError(
            "the first frequency of the body cannot be told from rounding: expected a body that "
            "is neither a mechanism nor made of materials of many orders of magnitude"
        )
    return float(squares[RIGID_DOFS])


def _squares(K: Array, M: Array) -> Array:
    """omega^2 (m,), ascending, of what is independent among the fields."""
    moving = M.diagonal() > MIN_FIELD_MASS * M.diagonal().max()
    return independent_squares(*(matrix[np.ix_(moving, moving)] for matrix in (K, M)))


def independent_squares(K: Array, M: Array) -> Array:
    """omega^2 (m,), ascending, of a few fields with K and M (n, n), combinations left out."""
    # Fields of unit mass: those that depend on others are then told by small eigenvalues.
    scale = 1.0 / np.sqrt(M.diagonal())
    mass, vectors = eigh(M * np.outer(scale, scale))
    independent = mass > MIN_FIELD_EIGENVALUE
    basis = scale[:, None] * vectors[:, independent] / np.sqrt(mass[independent])
    return np.asarray(eigh(basis.T @ K @ basis, eigvals_only=True))


def _quadratic_fields(nodes: Nodes, center: Array, size: float) -> Array:
    """V (n_u, 30): the dofs under 1, x, y, z, x^2, xy, ... along each axis, x in units of size.

    Nodes with rotations turn as the field does, by half its curl.
    """
    x = np.column_stack([np.ones(len(nodes.points)), (nodes.points - center) / size])
    turning = nodes.rotations
    fields = []
    for i, j in combinations_with_replacement(range(4), 2):
        value = x[:, i] * x[:, j]
        slope = np.zeros((turning.sum(), 3))
        for a, b in ((i, j), (j, i)):
            if a > 0:
                slope[:, a - 1] += x[turning, b] / size
        for axis in np.eye(3):
            field = np.zeros(nodes.n_dofs)
            field[nodes.displacements] = value[:, None] * axis
            field[nodes.first[turning][:, None] + np.arange(3, 6)] = 0.5 * np.cross(slope, axis)
            fields.append(field)
    return np.column_stack(fields)
