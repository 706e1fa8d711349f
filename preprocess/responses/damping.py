"""Damping: ratios or a chain for modes, a matrix for marching."""

from typing import Any

import numpy as np

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.damping import Damping
from ..errors import MethodError


def damped_modes(damping: Damping, omega: Array, phi: Array, h_min: float = 0.0) -> Modes:
    """Modes of frequencies omega (m,) [rad/s] and phi (n_c, m), with ratios or a chain."""
    return Modes(omega, damping_ratios(damping, omega), phi, h_min, damping.chain)


def damping_ratios(damping: Damping, omega: Array) -> Array:
    """Ratios zeta (m,) of modes with omega (m,) [rad/s], from the table or from Rayleigh's.

    Rayleigh's: (mass / omega + stiffness omega) / 2.
    """
    if damping.modal is not None:
        return np.interp(omega / (2.0 * np.pi), damping.modal.frequencies, damping.modal.ratios)
    if damping.rayleigh is not None:
        mass, stiffness = damping.rayleigh.coefficients
        return 0.5 * (mass / omega + stiffness * omega)
    return np.zeros_like(omega)


def damping_matrix(damping: Damping, structure: Structure) -> Any | None:
    """C (n_u, n_u), sparse, or None without damping; `MethodError` for modal ratios."""
    if damping.modal is not None:
        raise MethodError(
            "impulse.method march takes no modal damping, for that needs modes: "
            "use method krylov or modal, or damping.rayleigh = {mass = ..., stiffness = ...}"
        )
    if damping.rayleigh is not None:
        mass, stiffness = damping.rayleigh.coefficients
        return mass * structure.M + stiffness * structure.K
    return None
