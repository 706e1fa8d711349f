"""A given number of modes, as in other codes: the methods of Craig and Bampton, and of Rubin."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import RIGID_DOFS, Structure
from ..body.damping import Damping
from .basis import Basis
from .damping import damped_modes
from .held import HeldModes, held_modes
from .ritz import ritz_modes, space_shapes
from .shapes import Shapes
from .static import static_shapes

MIN_INTERFACE_MOTION = 1e-9  # relative to the largest; less is rounding


@dataclass(frozen=True, eq=False)
class Reduction:
    """Modes of the free reduced body, their shapes, and the highest frequency [Hz] asked for."""

    modes: Modes
    shapes: Shapes
    cutoff: float


def craig_bampton(structure: Structure, damping: Damping, count: int) -> Reduction:
    """The reduced body of constraint modes and `count` modes with the interfaces held.

        u = [Psi, Phi] y,    K Psi = P_C^T F,                         P_C Psi = I
                             K Phi + P_C^T L = M Phi diag(omega^2),   P_C Phi = 0

    Constraint modes are the rigid motions and what interface loads F that balance themselves do at
    rest. So are they made: frames on averaged facets, and interfaces that do not hold a body, need
    nothing else. It has n_c - 6 + count elastic modes, and up to six from loads of rotation.
    Source: R. R. Craig, M. C. C. Bampton, AIAA Journal 6 (1968) 1313-1319. `MethodError` for more
    modes than there are.
    """
    n_c = structure.n_c
    rigid = structure.P_C @ structure.U
    attachments, inertia = _statics(structure)
    balanced = null_space(rigid.T, rcond=MIN_INTERFACE_MOTION)
    # Interfaces that do not hold a body leave rigid motions, which are no modes to be counted.
    loose = structure.U @ null_space(rigid[:n_c], rcond=MIN_INTERFACE_MOTION)
    held = np.vstack([structure.P_C[:n_c].toarray(), (structure.M @ loose).T])
    fixed = held_modes(structure, held, count, _first_square(structure, attachments))
    return _reduced(structure, damping, fixed, np.hstack([attachments @ balanced, inertia]))


def rubin(structure: Structure, damping: Damping, count: int) -> Reduction:
    """The reduced body of the first `count` elastic modes and residual attachment modes.

        u = [U, Phi, Psi] y,    Psi = P K^+ P^T P_C^T - Phi omega^-2 Phi_C^T

    with the mass that Psi has, so that all have frequencies: n_c + count elastic modes, of which
    the first `count` are the mesh's, and whose static compliance is the mesh's. Source: S. Rubin,
    AIAA Journal 13 (1975) 995-1006. `MethodError` for more modes than there are.
    """
    attachments, inertia = _statics(structure)
    held = (structure.M @ structure.U).T
    free = held_modes(structure, held, count, _first_square(structure, attachments))
    return _reduced(structure, damping, free, np.hstack([attachments, inertia]))


def _statics(structure: Structure) -> tuple[Array, Array]:
    """Static displacements (n_u, n_c) under interface loads, and (n_u, 6 or 0) of rotation."""
    shapes = static_shapes(structure)
    n_c = structure.P_C.shape[0]
    return shapes[:, :n_c], shapes[:, n_c:]


def _reduced(structure: Structure, damping: Damping, normal: HeldModes, static: Array) -> Reduction:
    """The modes of the body in the space of its rigid, normal and static ones."""
    columns = RIGID_DOFS + normal.shapes.shape[1] + static.shape[1]
    basis = Basis(structure, min(columns, structure.n_u))
    for motions in (structure.U, normal.shapes, static):
        basis.extend(motions)
    V = basis.V[:, RIGID_DOFS:]
    omega, Q = ritz_modes(structure, V, V.T @ (structure.K @ V))
    shapes = space_shapes(basis, Q)
    modes = damped_modes(damping, omega, shapes(structure.P_C))
    return Reduction(modes, shapes, float(np.sqrt(normal.squares[-1])) / (2.0 * np.pi))


def _first_square(structure: Structure, attachments: Array) -> float:
    """About the first omega^2 [1/s^2]: the least Rayleigh quotient of an attachment mode."""
    stiffness = np.einsum("ik,ik->k", attachments, structure.K @ attachments)
    mass = np.einsum("ik,ik->k", attachments, structure.M @ attachments)
    return float((stiffness / mass).min())
