"""Matrices of solid elements, all at once, from the shape functions of scikit-fem."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from skfem import (
    CellBasis,
    Element,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementTetP1,
    ElementTetP2,
    MappingIsoparametric,
    MeshHex1,
    MeshHex2,
    MeshTet1,
    MeshTet2,
)
from skfem.quadrature import get_quadrature

from ..superelement.validation import Array
from .errors import MeshError
from .material import Material
from .mesh import Mesh

FLAT = 1e-10
"""The Jacobian of an element, relative to the cube of its diameter, below which it counts as degenerate."""


@dataclass(repr=False)
class MeshHexS2(MeshHex1):  # type: ignore[misc]
    """A hexahedral mesh with curved edges, which scikit-fem has the element for."""

    elem: type[Element] = field(default=ElementHexS2)


# scikit-fem numbers the nodes of a hexahedron from (1, 1, 1); this is a turn, not a reflection, of meshio's numbering.
_HEX = [4, 0, 7, 5, 3, 1, 6, 2, 16, 15, 12, 11, 8, 19, 14, 17, 13, 10, 9, 18, 20, 25, 22, 23, 24, 21, 26]


@dataclass(frozen=True)
class Kind:
    """How scikit-fem sees a solid: mesh, element, its nodes as places in meshio's order, order of integration."""

    mesh: type[Any]
    element: type[Element]
    order: list[int]
    intorder: int


# Integration is exact for stiffness and mass on straight-sided simplices and on parallelepipeds.
KINDS = {
    "tetra": Kind(MeshTet1, ElementTetP1, list(range(4)), 2),
    "tetra10": Kind(MeshTet2, ElementTetP2, list(range(10)), 4),
    "hexahedron": Kind(MeshHex1, ElementHex1, _HEX[:8], 5),
    "hexahedron20": Kind(MeshHexS2, ElementHexS2, _HEX[:20], 5),
    "hexahedron27": Kind(MeshHex2, ElementHex2, _HEX, 5),
}


def solid_matrices(mesh: Mesh, name: str, materials: list[Material]) -> tuple[Array, Array]:
    """Stiffness and consistent mass (n, 3k, 3k) of the solids of a type; three displacements to a node, meshio's order.

        K_(ia)(jb) = int lambda N_i,a N_j,b + mu N_i,b N_j,a + mu delta_ab N_i,c N_j,c dV     (Hooke, isotropic)
        M_(ia)(jb) = int rho delta_ab N_i N_j dV

    `materials` has one material per element. `MeshError` for an inverted or degenerate element.
    """
    kind, cells = KINDS[name], mesh.cells[name]
    _check_jacobians(mesh, name, _jacobians(mesh.points[cells], kind))
    N, dN, dV = _shapes(mesh.points[cells], kind)
    n, k, _, _ = dN.shape
    rows = dN.reshape(n, 3 * k, -1)
    G = ((rows * dV[:, None]) @ rows.transpose(0, 2, 1)).reshape(n, k, 3, k, 3)
    identity = np.eye(3)[:, None, :]
    lam = np.array([m.E * m.nu / ((1.0 + m.nu) * (1.0 - 2.0 * m.nu)) for m in materials])[:, None, None, None, None]
    mu = np.array([m.E / (2.0 * (1.0 + m.nu)) for m in materials])[:, None, None, None, None]
    rho = np.array([m.rho for m in materials])[:, None, None, None, None]
    K = lam * G + mu * G.swapaxes(2, 4) + mu * np.einsum("eicjc->eij", G)[:, :, None, :, None] * identity
    M = rho * ((N * dV[:, None]) @ N.transpose(0, 2, 1))[:, :, None, :, None] * identity
    return K.reshape(n, 3 * k, 3 * k), M.reshape(n, 3 * k, 3 * k)


def _shapes(corners: Array, kind: Kind) -> tuple[Array, Array, Array]:
    """Shapes N (n, k, q), their gradients (n, k, 3, q) and volumes dV (n, q) at integration points, meshio's order."""
    # Elements are handed over apart, each with nodes of its own, so that nothing rests on how shared ones are numbered.
    n, k, _ = corners.shape
    grid = kind.mesh(corners[:, kind.order].reshape(-1, 3).T, np.arange(n * k).reshape(n, k).T)
    mapping = MappingIsoparametric(grid, kind.element())
    basis = CellBasis(grid, kind.element(), mapping, intorder=kind.intorder, disable_doflocs=True)
    fields = [basis.basis[i][0] for i in np.argsort(kind.order)]
    N = np.stack([np.broadcast_to(np.asarray(field), basis.dx.shape) for field in fields], axis=1)
    dN = np.stack([field.grad.transpose(1, 0, 2) for field in fields], axis=1)
    return N, dN, basis.dx


def _jacobians(corners: Array, kind: Kind) -> Array:
    """det dx/dxi (n, q) of every element at its integration points [m^3]."""
    element = kind.element()
    xi, _ = get_quadrature(element.refdom, kind.intorder)
    gradients = np.array([np.broadcast_to(element.lbasis(xi, i)[1], xi.shape) for i in range(len(kind.order))])
    jacobians: Array = np.linalg.det(np.einsum("kdq,nki->nqid", gradients, corners[:, kind.order]))
    return jacobians


def _check_jacobians(mesh: Mesh, kind: str, jacobians: Array) -> None:
    """Every element must keep its orientation and volume at all integration points; jacobians (n, q)."""
    diameter = np.linalg.norm(np.ptp(mesh.points[mesh.cells[kind]], axis=1), axis=1)
    worst = jacobians.min(axis=1) / diameter**3
    bad = np.flatnonzero(worst <= FLAT)
    if bad.size:
        element = int(bad[0])
        state = "inverted" if worst[element] < -FLAT else "degenerate"
        groups = [name for name, g in mesh.groups.items() if element in g.cells.get(kind, ())]
        place = mesh.points[mesh.cells[kind][element]].mean(axis=0)
        raise MeshError(
            f"{mesh.name}: {kind} element {element} of group {', '.join(groups) or '(none)'} is {state}: "
            f"its Jacobian falls to {jacobians[element].min():.3e} m^3 near {place.tolist()}; "
            f"{bad.size} of {len(worst)} elements are inverted or degenerate"
        )
