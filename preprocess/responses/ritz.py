"""Modes of a body in a space of displacements, by Ritz's method."""

import numpy as np
from scipy.linalg import eigh

from ...superelement.validation import Array
from ..assembly.structure import RIGID_DOFS, Structure
from ..errors import MeshError
from .basis import Basis
from .shapes import Shapes

MIN_RESOLVED_EIGENVALUE = 1e-6
"""Eigenvalues, relative to the largest, that drown in its rounding: they are found anew from
displacements.
"""
ZERO_EIGENVALUE = 1e-14  # relative to the largest: only rounding keeps it from zero


def ritz_modes(structure: Structure, V: Array, stiffness: Array) -> tuple[Array, Array]:
    """omega (m,) [rad/s], ascending, and Q (r, m): V^T K V Q = Q diag(omega^2), Q^T Q = I.

    V (n_u, r) with V^T M V = I and V^T M U = 0; stiffness (r, r): V^T K V, of which the upper half
    is read. `MeshError` if a motion of V has no frequency. Source: W. Ritz, J. reine angew. Math.
    135 (1909).
    """
    if not len(stiffness):
        return np.zeros(0), np.zeros((0, 0))
    agreed = structure.processes.agreed
    squares, Q = agreed(lambda: eigh(stiffness, lower=False))
    low = squares < MIN_RESOLVED_EIGENVALUE * squares[-1]
    if low.any():
        shapes = V @ Q[:, low]
        smaller = structure.total(shapes.T @ (structure.K @ shapes))
        squares[low], turn = agreed(lambda: eigh(smaller))
        Q[:, low] = Q[:, low] @ turn
    if squares[0] <= ZERO_EIGENVALUE * squares[-1]:
        raise MeshError(
            "expected six zero modes, found "
            f"{RIGID_DOFS + int((squares <= ZERO_EIGENVALUE * squares[-1]).sum())}: the body is a "
            f"mechanism, eigenvalues {squares[:8].tolist()}"
        )
    return np.sqrt(squares), Q


def space_shapes(basis: Basis, Q: Array) -> Shapes:
    """V Q (n_u, m), with V the columns of the basis after its six rigid modes."""
    return Shapes(basis.V[:, RIGID_DOFS : RIGID_DOFS + len(Q)], Q, basis.processes)
