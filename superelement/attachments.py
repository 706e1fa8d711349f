"""Residual attachments: static responses of modes to loads, without those of the lowest modes."""

import numpy as np

from ..files.arrays import Array, IntArray
from .modes import Modes

MIN_ATTACHMENT_EIGENVALUE = 1e-10
"""Eigenvalue of the scaled mass matrix of attachments below which one is a sum of others."""


def attachments(modes: Modes, low: IntArray, loaded: IntArray) -> tuple[Array, Array]:
    """Residual attachments of loaded interface dofs, orthonormal in mass, orthogonal in stiffness.

        psi = (diag(1 / omega^2) without the rows `low`) phi_loaded^T

    Parameters
    ----------
    modes : Modes
    low : (n,) of int
        Modes that are kept beside them, and have no part in them.
    loaded : (k,) of int
        Rows of `modes.phi`.

    Returns
    -------
    shapes : (m, a)
        Modal coordinates; a is at most k, less where attachments are sums of others.
    squares : (a,) [rad^2/s^2]
        Their stiffnesses, the squares of their frequencies, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> modes = Modes(np.array([1.0, 2.0, 4.0]), np.zeros(3), phi=np.ones((1, 3)))
    >>> shapes, squares = attachments(modes, low=np.array([0]), loaded=np.array([0]))
    >>> shapes.round(3).T.tolist(), squares.round(3).tolist()
    ([[0.0, 0.97, 0.243]], [4.706])
    """
    c = modes.phi[loaded] / modes.omega**2
    # Residual: what the modes that are kept carry already must not be there twice.
    c[:, low] = 0.0
    scale = 1.0 / np.sqrt(np.maximum((c * c).sum(axis=1), np.finfo(float).tiny))
    c = scale[:, None] * c
    mass, Z = np.linalg.eigh(c @ c.T)
    independent = mass > MIN_ATTACHMENT_EIGENVALUE * mass.max(initial=0.0)
    c = (Z[:, independent] / np.sqrt(mass[independent])).T @ c
    squares, z = np.linalg.eigh((c * modes.omega**2) @ c.T)
    return c.T @ z, squares
