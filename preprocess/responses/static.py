"""Responses at rest: static compliance and initial accelerations of the interfaces."""

from itertools import islice
from typing import Any

import numpy as np
from scipy.linalg import qr

from ...superelement.validation import Array
from ..assembly.rigid import project
from ..assembly.structure import Structure
from ..errors import MeshError
from ..solving.factor import Solve, factorize
from ..solving.gradients import Columns, descend
from .basis import Basis

MAX_REFINEMENT_CHANGE = 1e-3
"""Change of the compliance by one step of refinement, relative to its largest entries, that says it
is rounding.
"""
MAX_MASS_STEPS = 200  # of gradients: meshes of solids take 60 or so, whatever their size
MASS_RESIDUAL = 1e-14
MAX_SLOW_BLOCKS = 5
"""Blocks of slow responses at most: up to half the first frequency each leaves a sixteenth of the
error.
"""


def compliance(structure: Structure) -> Array:
    """P_C P K^+ P^T P_C^T (n_c, n_c) [m/N, rad/N, rad/(N m)]: displacements with inertia relief.

    Errors are those of `attachment_modes`, which it is the part at the interfaces of.
    """
    return _symmetric(structure.P_C @ attachment_modes(structure))


def attachment_modes(structure: Structure) -> Array:
    """P K^+ P^T P_C^T (n_u, n_c): static displacements under unit loads, with inertia relief."""
    return static_shapes(structure)[:, : structure.P_C.shape[0]]


def static_shapes(structure: Structure) -> Array:
    """P K^+ P^T [P_C^T, F] (n_u, n_c + 6): those of interfaces, and of rotation if asked for.

    One step of refinement takes out most of the rounding, which a slender body has much of.
    `MeshError` if that step changes the displacements of the interfaces: K has more zero modes than
    the six rigid ones.
    """
    solve, f = static_solver(structure), np.hstack([structure.loads, structure.inertia_loads])
    u = solve(f)
    correction = solve(f - structure.K @ u)
    change = structure.P_C @ correction[:, : structure.P_C.shape[0]]
    _check_determined(structure.P_C @ u[:, : len(change)] + change, change)
    return np.asarray(u + correction)


def static_solver(structure: Structure) -> Solve:
    """f -> u = P K^+ f (n_u, k), for loads that balance themselves.

        u = P K_c^-1 f,    K_c: K with six statically determinate dofs held

    Nothing reacts where dofs are held, so any six will do. Source: docs/theory.md, Interfaces.
    """
    K = structure.K.tocsr()
    free = np.setdiff1d(np.arange(structure.n_u), _determinate_dofs(structure))
    name = "the stiffness with six dofs held"
    solve = factorize(K[free][:, free], name, solvers=structure.solvers)

    def response(loads: Array) -> Array:
        if not loads.size:
            return loads
        u = np.zeros_like(loads)
        u[free] = solve(loads[free])
        return project(u, structure.U, structure.M)

    return response


def refined(structure: Structure, solve: Solve, f: Array) -> Array:
    """A static response with one step of refinement."""
    u = solve(f)
    return np.asarray(u + solve(f - structure.K @ u))


def slow_chain(structure: Structure, solve: Solve | None = None) -> list[Array]:
    """P K^+ F, P K^+ M K^+ F, ...: up to `MAX_SLOW_BLOCKS` blocks (n_u, 6), for loads of rotation.

    In a space with k of them the changes d = F^T u of inertia under loads F s are right in their
    first 2 k terms in powers of the squared frequency, the first of which is the response at rest.
    solve: that of `static_solver`, where there is one already.
    """
    if structure.inertia is None:
        return []
    solve = solve or static_solver(structure)
    most = structure.U.shape[1] + MAX_SLOW_BLOCKS * structure.inertia_loads.shape[1]
    basis = Basis(structure, most)
    basis.extend(structure.U)
    blocks = [refined(structure, solve, structure.inertia_loads)]
    while len(blocks) < MAX_SLOW_BLOCKS and (new := basis.extend(blocks[-1])):
        blocks.append(solve(structure.M @ basis.V[:, basis.columns - new :]))
    return blocks


def _check_determined(H: Array, change: Array) -> None:
    """`MeshError` for a compliance that one step of refinement changes."""
    scale = np.sqrt(np.abs(np.diag(H)))
    if (found := np.max(np.abs(change) / np.outer(scale, scale))) > MAX_REFINEMENT_CHANGE:
        raise MeshError(
            "the static compliance of the body is not determined: one step of refinement changes "
            f"it by {found:.1e}, expected {MAX_REFINEMENT_CHANGE:g} at most: the body is a "
            "mechanism, or far too slender for its mesh"
        )


def accelerance(structure: Structure) -> Array:
    """P_C M^-1 P^T P_C^T (n_c, n_c) [1/kg, 1/(kg m), 1/(kg m^2)]: initial accelerations.

    Elastic ones, under unit loads on the interfaces at rest.
    """
    return _symmetric(structure.P_C @ initial_accelerations(structure))


def initial_accelerations(structure: Structure) -> Array:
    """M^-1 P^T P_C^T (n_u, n_c), elastic accelerations of all dofs under unit loads at rest.

    By conjugate gradients, for a mass matrix divided by its diagonal is well conditioned on any
    mesh of solids; by factorization where it is not, as with beams of little polar inertia that run
    askew to the axes of the mesh. Source: A. J. Wathen, IMA Journal of Numerical Analysis 7 (1987)
    449-457.
    """
    M, loads = structure.M.tocsr(), structure.loads
    solution = _solved_by_gradients(M, loads)
    if solution is not None:
        return solution
    return factorize(M, "the mass matrix", solvers=structure.solvers)(loads)


def _solved_by_gradients(A: Any, B: Array) -> Array | None:
    """A^-1 B for B (n, k), with Jacobi's preconditioner; None after `MAX_MASS_STEPS`."""
    inverse = 1.0 / A.diagonal()[:, None]
    small = MASS_RESIDUAL * np.linalg.norm(B, axis=0)
    X, R = np.zeros_like(B), B.copy()
    for _ in islice(descend(Columns(A.__matmul__, lambda R: inverse * R), R, X), MAX_MASS_STEPS):
        if (np.linalg.norm(R, axis=0) <= small).all():
            return X
    return None


def _determinate_dofs(structure: Structure) -> Array:
    """Six dofs whose rigid motions are as independent as can be: the pivots of a QR of A^T."""
    scale = np.sqrt(np.trace(structure.rigid.J_rot) / structure.rigid.mass)
    A = structure.rigid.A / np.array([1.0, 1.0, 1.0, scale, scale, scale])
    # A rotation [rad] counts as the displacement that it makes at the radius of gyration.
    turning = structure.nodes.first[structure.nodes.rotations][:, None] + np.arange(3, 6)
    A[turning] *= scale
    _, pivots = qr(A.T, mode="r", pivoting=True)
    return np.asarray(pivots[:6])


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + matrix.T)
