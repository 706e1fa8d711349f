"""A superelement in the form of Craig and Bampton: interface dofs, and modes with them held.

It is the same body in other coordinates. The free modes q = (rigid, elastic), with unit masses,
move the interfaces by u_C = B q. Constraint modes are the q of the least strain energy for unit
u_C; fixed-interface modes are those of the q with B q = 0:

    q = Psi u_C + Phi p,   B Psi = I,   B Phi = 0,   Phi^T Phi = I,   Phi^T K Phi = diag(omega^2)
    Psi^T K Phi = 0

Source: R. R. Craig, M. C. C. Bampton, Coupling of substructures for dynamic analyses, AIAA Journal
6 (1968) 1313-1319.
"""

from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from .superelement import Superelement
from .validation import SuperelementError

RIGID_MODES_COUNT = 6
MIN_INDEPENDENCE = 1e-9
"""Of the singular values of B with rows of unit length, the least over the largest."""


@dataclass(frozen=True, eq=False)
class CraigBampton:
    """K, M and C (n_c + m, n_c + m) of interface dofs, in their order, and m modal coordinates.

    K [N/m ...], M [kg ...] and viscous C [N s/m ...]; of modal coordinates K is diag(omega^2), M
    the identity. Axes are those of the mesh. omega (m,): of the modes with all interfaces held
    [rad/s], ascending.
    """

    K: Array
    M: Array
    C: Array
    omega: Array


def in_craig_bampton_form(e: Superelement) -> CraigBampton:
    """The matrices of a superelement in the form of Craig and Bampton, with all of its modes.

    `SuperelementError` for a body without modes, or whose modes do not move all interface dofs
    independently.
    """
    if e.modes is None:
        raise SuperelementError(
            f"{e.name}: expected modes, which impulse.method march does not find, found none"
        )
    modes = e.modes
    B = np.hstack([_rigid(e), modes.phi])
    # Rigid modes come first, and have no stiffness.
    squares = np.concatenate([np.zeros(RIGID_MODES_COUNT), modes.omega**2])
    damping = np.concatenate([np.zeros(RIGID_MODES_COUNT), 2.0 * modes.zeta * modes.omega])
    n_c = len(B)
    _check_independent(e, B)
    # Rows are scaled: displacements and rotations have different units.
    scale = np.linalg.norm(B, axis=1)
    Q, R = np.linalg.qr((B / scale[:, None]).T, mode="complete")
    N = Q[:, n_c:]
    fixed, vectors = np.linalg.eigh(N.T @ (squares[:, None] * N))
    Phi = N @ vectors
    particular = Q[:, :n_c] @ np.linalg.solve(R[:n_c].T, np.diag(1.0 / scale))
    Psi = particular - Phi @ ((Phi.T @ (squares[:, None] * particular)) / fixed[:, None])
    T = np.hstack([Psi, Phi])
    K = _symmetric(T.T @ (squares[:, None] * T))
    # Psi^T K Phi is zero, and the rest of K known: rounding would say otherwise.
    K[:n_c, n_c:] = K[n_c:, :n_c] = 0.0
    K[n_c:, n_c:] = np.diag(fixed)
    if n_c == RIGID_MODES_COUNT:
        # Interfaces that hold the body by no more than they must move without energy.
        K[:n_c, :n_c] = 0.0
    M = _symmetric(T.T @ T)
    M[n_c:, n_c:] = np.eye(len(fixed))
    return CraigBampton(K, M, _symmetric(T.T @ (damping[:, None] * T)), np.sqrt(fixed))


def _rigid(e: Superelement) -> Array:
    """Motions (n_c, 6) of the interfaces under rigid modes of unit mass, about the center."""
    # Principal axes make rotations independent: J = V diag(J_i) V^T.
    J, V = np.linalg.eigh(e.J_rot)
    rows = []
    for interface in e.interfaces:
        x, y, z = interface.X
        # theta x X = -X~ theta
        turning = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]) @ V / np.sqrt(J)
        rows.append(np.hstack([np.eye(3) / np.sqrt(e.mass), turning]))
        if interface.rotations:
            rows.append(np.hstack([np.zeros((3, 3)), V / np.sqrt(J)]))
    return np.vstack(rows)


def _check_independent(e: Superelement, B: Array) -> None:
    n_c, n = B.shape
    if n_c < RIGID_MODES_COUNT:
        raise SuperelementError(
            f"{e.name}: expected interfaces with {RIGID_MODES_COUNT} dofs or more, which hold the "
            f"body, found {n_c}"
        )
    scale = np.linalg.norm(B, axis=1)
    values = np.linalg.svd(B / np.where(scale, scale, 1.0)[:, None], compute_uv=False)
    rank = int((values > MIN_INDEPENDENCE * values[0]).sum())
    # Rigid motion without energy would leave the modes with interfaces held undetermined.
    held = np.linalg.svd(
        B[:, :RIGID_MODES_COUNT] / np.where(scale, scale, 1.0)[:, None], compute_uv=False
    )
    if held[-1] <= MIN_INDEPENDENCE * held[0]:
        raise SuperelementError(
            f"{e.name}: expected interfaces that hold the body when they are held, found a rigid "
            "motion that moves none of them: add an interface, or one with rotations"
        )
    if rank < n_c:
        raise SuperelementError(
            f"{e.name}: expected modes that move its {n_c} interface dofs independently, found "
            f"{rank} independent motions of {n} modes, 6 of them rigid: keep more modes, or fewer "
            "interfaces"
        )


def _symmetric(matrix: Array) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))
