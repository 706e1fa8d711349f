"""Masses lumped at interfaces, nodes and groups of the mesh."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import block_diag

from ..body.body import Body, PointMass
from ..body.selection import Selection
from ..errors import InterfaceError


def mass_selections(body: Body) -> dict[str, Selection]:
    """The selections of the masses that are not on an interface, by name."""
    return {name: mass for name, mass in body.masses.items() if mass.interface is None}


def lumped_mass(
    body: Body, interfaces: Mapping[str, Any], selected: Mapping[str, Any], n_u: int
) -> Any:
    """The mass matrix (n_u, n_u), sparse, of rigid pieces: sum rows^T diag(m I, J) rows.

    `interfaces` and `selected` have rows (3 or 6, n_u) by the names of interfaces, and of the other
    masses. With the averaged motion of facets, rows = D, a mass m D^T D resists the mean motion of
    the facets alone. As D is exact for rigid motion, so are mass, center of mass and inertia.
    `InterfaceError` for an inertia where nothing rotates.
    """
    # Sparse throughout: the averaged rows of a large surface fill a dense matrix of their own.
    total = sp.csc_array((n_u, n_u))
    for name, mass in body.masses.items():
        rows = selected[name] if mass.interface is None else interfaces[mass.interface]
        total = total + rows.T @ sp.csr_array(_block(name, mass, rows.shape[0])) @ rows
    return total


def _block(name: str, mass: PointMass, n_rows: int) -> Any:
    """diag(m I, J) (n_rows, n_rows)."""
    inertia = np.array(mass.inertia)
    if n_rows == 6:
        return block_diag(mass.mass * np.eye(3), inertia)
    if inertia.any():
        raise InterfaceError(
            f"masses.{name}: the node of a solid has three dofs and carries no inertia, found "
            f"{inertia.tolist()}; use a group of facets"
        )
    return mass.mass * np.eye(3)
