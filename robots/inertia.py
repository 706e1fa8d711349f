"""Masses and inertias: of several links as one body, and those that no body has."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..files.arrays import Array
from .description import Inertial
from .poses import Pose

# A zero of a point mass, computed by rotation, may be negative by a few roundings.
INERTIA_ROUNDING = 1e-12
# [m] of gyration, below which a negative inertia of a point mass is that of rounding.
NEGLIGIBLE_RADIUS = 1e-6


def in_space(inertial: Inertial, pose: Pose) -> Inertial:
    """An inertial of a link in the axes in which the link has a pose."""
    J = pose.R @ inertial.inertia @ pose.R.T
    return Inertial(inertial.mass, pose.of(inertial.center), J)


def composite(parts: Sequence[Inertial]) -> Inertial:
    """Several parts, in the same axes, as one rigid body.

        J = sum J_i + m_i (|r_i|^2 1 - r_i r_i^T),   r_i = c_i - c

    Source: the theorem of Huygens and Steiner.
    """
    if len(parts) == 1:
        return parts[0]
    mass = sum(part.mass for part in parts)
    center: Array = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    J = np.zeros((3, 3))
    for part in parts:
        J += part.inertia + point_inertia(part.mass, part.center - center)
    return Inertial(mass, center, J)


def point_inertia(mass: float, r: Array) -> Array:
    """The inertia (3, 3) of a point mass at r (3,) about the origin."""
    inertia: Array = mass * (r @ r * np.eye(3) - np.outer(r, r))
    return inertia


def require_physical(inertial: Inertial, error: Callable[[str], Exception]) -> None:
    """Raise the `error` of a negative principal inertia; a point mass has three zeros."""
    principal = np.linalg.eigvalsh(inertial.inertia)
    rounding = max(INERTIA_ROUNDING * abs(principal).max(), inertial.mass * NEGLIGIBLE_RADIUS**2)
    if principal[0] < -rounding:
        raise error(f"inertia: expected no negative principal value, got {_listed(principal)}")


def require_positive(J: Array, error: Callable[[str], Exception]) -> None:
    """Raise the `error` of a body that would rotate without resistance."""
    principal = np.linalg.eigvalsh(J)
    if principal[0] <= INERTIA_ROUNDING * abs(principal).max():
        raise error(f"inertia: expected positive principal values, got {_listed(principal)}")


def as_of_a_body(J: Array, tolerance: float) -> tuple[Array, str]:
    """The nearest inertia that a body may have, and what was wrong in words; "" if nothing was.

    Of a body the second moments of its mass P_i = (J_j + J_k - J_i) / 2 are not negative: those
    that are become 0, which raises the two smaller principal inertias. tolerance: relative excess
    of the largest principal inertia that counts as rounding.
    """
    principal, axes = np.linalg.eigh(J)
    if principal[2] <= (1.0 + tolerance) * (principal[0] + principal[1]):
        return J, ""
    moments = np.maximum(0.5 * principal.sum() - principal, 0.0)
    nearest: Array = axes @ np.diag(moments.sum() - moments) @ axes.T
    said = (
        f"principal inertias {_listed(principal)} kg m^2, of which the largest exceeds the sum of "
        f"the others, as those of no body: {_listed(moments.sum() - moments)} taken"
    )
    return 0.5 * (nearest + nearest.T), said


def _listed(values: Any) -> str:
    return f"[{', '.join(f'{value:.6g}' for value in values)}]"
