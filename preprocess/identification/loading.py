"""Masses that were mounted on a part in its test, taken away from its modes."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from ...superelement.validation import Array


@dataclass(frozen=True, eq=False)
class FreeModes:
    """omega (m,), zeta (m,), shapes (q, m) [1/sqrt(kg)] of the coordinates of a measurement."""

    omega: Array
    zeta: Array
    shapes: Array


def without_masses(
    modes: FreeModes, rigid: Array, M: Array, motions: Array, mass_of_each: float
) -> FreeModes:
    """The modes of a part without equal masses m, of which A (n, q) are the motions.

    In rigid and modal coordinates the mass is diag(M, I) - m [U Psi]^T A^T A [U Psi], of which the
    elastic motions are those that are orthogonal to the rigid ones. rigid (q, 6): U; M (6, 6): of
    the part with the masses. ValueError where no mass would be left.
    """
    m = len(modes.omega)
    # Modes are orthogonal with the masses, and are no longer without them.
    all_shapes = np.hstack([rigid, modes.shapes])
    carried = motions @ all_shapes
    mass = scipy.linalg.block_diag(M, np.eye(m)) - mass_of_each * carried.T @ carried
    if not np.linalg.eigvalsh(mass)[0] > 0.0:
        raise ValueError("no mass would be left")
    # Elastic motions with the rigid one that their free motion has.
    T = np.vstack([-np.linalg.solve(mass[:6, :6], mass[:6, 6:]), np.eye(m)])
    stiffness = np.diag(modes.omega**2)
    squares, own = scipy.linalg.eigh(stiffness, T.T @ mass @ T)
    omega = np.sqrt(squares)
    # Damping couples the new modes a little; its diagonal is what real modes have.
    damping = np.einsum("im,i,im->m", own, 2.0 * modes.zeta * modes.omega, own)
    return FreeModes(omega, damping / (2.0 * omega), all_shapes @ T @ own)
