"""Rigid modes: mass properties, and the projector that removes them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular

from ...superelement.checks import MAX_RELATIVE_DEVIATION
from ...superelement.validation import Array
from ..errors import MeshError
from ..mesh.nodes import Nodes
from ..processes import ONE_PROCESS, Processes


@dataclass(frozen=True, eq=False)
class RigidModes:
    """The six rigid modes of a finite element model about its own center of mass.

    A (n_u, 6): dofs under unit translations along, and unit small rotations about, the mesh axes
    through `center`; U (n_u, 6): a basis of the same space with U^T M U = I. mass [kg], center (3,)
    [m] and J_rot (3, 3) [kg m^2] are those of the finite element mass matrix, A^T M A = diag(mass
    I, J_rot), so that they, the projector and the kernels agree to rounding.
    """

    A: Array
    U: Array
    mass: float
    center: Array
    J_rot: Array


def rigid_modes(nodes: Nodes, M: Any, processes: Processes = ONE_PROCESS) -> RigidModes:
    """Center of mass, mass properties and rigid modes from the mass matrix M (n_u, n_u), sparse.

    nodes: those of this process.
    `MeshError` if the inertia is not positive definite, as that of beams in a line without polar
    inertia.
    """
    # Any point near the body would do; far from it the moments would cancel.
    middle = processes.agreed(lambda: nodes.points.mean(axis=0))
    A = nodes.rigid_motion(middle)
    moments = processes.total(A.T @ (M @ A))
    mass = float(np.trace(moments[:3, :3])) / 3.0
    # A point moves by -(X - middle)~ theta: the translation-rotation block is -mass (center -
    # middle)~.
    block = moments[:3, 3:]
    offset = (
        0.5
        / mass
        * np.array(
            [block[1, 2] - block[2, 1], block[2, 0] - block[0, 2], block[0, 1] - block[1, 0]]
        )
    )
    center = middle + offset

    A = nodes.rigid_motion(center)
    moments = processes.total(A.T @ (M @ A))
    # About the center of mass, where nothing couples translation and rotation any more.
    J_rot = 0.5 * (moments[3:, 3:] + moments[3:, 3:].T)
    principal = np.linalg.eigvalsh(J_rot)
    if not (mass > 0.0 and principal[0] > 1e-14 * principal[-1]):
        raise MeshError(
            "expected a positive mass and inertia, "
            f"found {mass} kg and principal inertias {principal}"
        )
    if principal[2] > (1.0 + MAX_RELATIVE_DEVIATION) * (principal[0] + principal[1]):
        raise MeshError(
            "expected principal inertias of which two are no less than the third, found "
            f"{', '.join(f'{value:.4g}' for value in principal)} kg m^2: no rigid body has such "
            "polar and rotary inertias of sections, or inertias of masses"
        )
    # By a factor of the moments: the basis is orthonormal in M, whatever the unit of length.
    U = solve_triangular(np.linalg.cholesky(moments), A.T, lower=True).T
    return RigidModes(A, U, mass, center, J_rot)


def project(w: Array, U: Array, M: Any, processes: Processes = ONE_PROCESS) -> Array:
    """Remove the rigid part of displacements, P w = w - U U^T M w, eq. (49).

    w (n_u, k); U (n_u, 6) with U^T M U = I; M (n_u, n_u) -> (n_u, k)
    """
    return np.asarray(w - U @ processes.total(U.T @ (M @ w)))


def relieve(f: Array, U: Array, M: Any, processes: Processes = ONE_PROCESS) -> Array:
    """Remove the inertia relief from loads, P^T f = f - M U U^T f, eq. (49) transposed.

    The loads that are left deform the body without accelerating it as a whole.

    f (n_u, k); U (n_u, 6) with U^T M U = I; M (n_u, n_u) -> (n_u, k)
    """
    return np.asarray(f - M @ (U @ processes.total(U.T @ f)))
