"""Responses at rest: static compliance and initial accelerations of the interfaces."""

import numpy as np
from scipy.linalg import qr

from ..superelement.validation import Array
from .factor import factorize
from .rigid import project
from .structure import Structure


def compliance(structure: Structure) -> Array:
    """P_C P K^+ P^T P_C^T (n_c, n_c): displacements under unit loads with inertia relief [m/N, rad/N, rad/(N m)].

        u = P K_c^-1 P^T P_C^T,    K_c: K with six statically determinate dofs held

    The loads balance themselves, so nothing reacts where dofs are held, and any six will do. Source: methods 5.1.
    """
    free = np.setdiff1d(np.arange(structure.n_u), _determinate_dofs(structure))
    u = np.zeros_like(structure.loads)
    u[free] = factorize(structure.K[free][:, free])(structure.loads[free])
    return _symmetric(structure.P_C @ project(u, structure.U, structure.M))


def mobility(structure: Structure) -> Array:
    """P_C M^-1 P^T P_C^T (n_c, n_c): elastic accelerations under unit loads at rest [1/kg, 1/(kg m), 1/(kg m^2)]."""
    return _symmetric(structure.P_C @ factorize(structure.M)(structure.loads))


def _determinate_dofs(structure: Structure) -> Array:
    """Six dofs whose rigid motions are as independent as can be: the pivots of a QR of A^T."""
    scale = np.sqrt(np.trace(structure.rigid.J_rot) / structure.rigid.mass)
    A = structure.rigid.A / np.array([1.0, 1.0, 1.0, scale, scale, scale])
    # A rotation [rad] counts as the displacement that it makes at the radius of gyration.
    turning = structure.nodes.first[structure.nodes.rotations][:, None] + np.arange(3, 6)
    A[turning] *= scale
    _, _, pivots = qr(A.T, mode="economic", pivoting=True)
    return np.asarray(pivots[:6])


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + matrix.T)
