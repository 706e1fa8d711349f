"""Damping: ratios for modes, a matrix for marching."""

from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.body import Damping
from ..errors import MethodError


def damping_ratios(damping: Damping, omega: Array) -> Array:
    """Ratios zeta (m,) of modes with omega (m,) [rad/s], from the table or from Rayleigh's.

    Rayleigh's: (mass / omega + stiffness omega) / 2.
    """
    if damping.modal is not None:
        return np.interp(omega / (2.0 * np.pi), damping.modal.frequencies, damping.modal.ratios)
    if damping.rayleigh is not None:
        return 0.5 * (damping.rayleigh.mass / omega + damping.rayleigh.stiffness * omega)
    return np.zeros_like(omega)


def damping_matrix(damping: Damping, structure: Structure) -> Any | None:
    """C (n_u, n_u), sparse, or None without damping; `MethodError` for modal ratios."""
    if damping.modal is not None:
        raise MethodError(
            "impulse.method march takes no modal damping, for that needs modes: "
            "use method krylov or modal, or damping.rayleigh = {mass = ..., stiffness = ...}"
        )
    if damping.rayleigh is not None:
        return damping.rayleigh.mass * structure.M + damping.rayleigh.stiffness * structure.K
    return None
