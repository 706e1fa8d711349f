"""Impulse responses from all elastic modes."""

import numpy as np
from scipy.linalg import eigh

from ...superelement import Modes
from ..assembly.rigid import project
from ..assembly.structure import Structure
from ..body.damping import Damping
from ..errors import MeshError, MethodError
from .damping import damped_modes
from .shapes import Shapes

FULL_MODAL_UNKNOWNS = 1000  # up to which all modes are as quick as some
MODAL_LIMIT = 4000
"""Unknowns up to which all modes are computed; beyond, the dense eigenproblem takes minutes and
gigabytes.
"""


def elastic_shapes(structure: Structure, damping: Damping) -> tuple[Modes, Shapes]:
    """All modes but the six rigid ones, K phi = omega^2 M phi: at the interfaces, and wherever
    asked.

    `MethodError` above `MODAL_LIMIT` unknowns.
    """
    if structure.n_u > MODAL_LIMIT:
        raise MethodError(
            f"impulse.method modal takes up to {MODAL_LIMIT} unknowns, found {structure.n_u}: "
            "use method krylov"
        )
    values, vectors = eigh(
        structure.K.toarray(), structure.M.toarray(), overwrite_a=True, overwrite_b=True
    )
    if values[6] <= 1e-13 * values[-1]:
        raise MeshError(
            f"expected six zero modes, found {int((values <= 1e-13 * values[-1]).sum())}: the "
            f"body is a mechanism, eigenvalues {values[:8].tolist()}"
        )
    shapes = project(vectors[:, 6:], structure.U, structure.M)
    # The solver's eigenvalues carry rounding of the size of the largest; Rayleigh's quotient, of
    # their own size.
    squares = np.einsum("im,im->m", shapes, structure.K @ shapes) / np.einsum(
        "im,im->m", shapes, structure.M @ shapes
    )
    omega = np.sqrt(squares)
    modes = damped_modes(damping, omega, structure.P_C @ shapes)
    return modes, Shapes(shapes)
