"""Solid elements on their reference domains: shapes, gradients, points of integration."""

from dataclasses import dataclass

import numpy as np
from skfem import (
    Element,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementTetP1,
    ElementTetP2,
    ElementWedge1,
)
from skfem.quadrature import get_quadrature
from skfem.refdom import RefHex, RefLine, RefTet, RefTri

from ...superelement.validation import Array
from ..mesh.mesh import IntArray


@dataclass(frozen=True, eq=False)
class SolidElement:
    """An isoparametric solid with shape functions of scikit-fem, its nodes in meshio's order.

    place (k,): the shape function of each node; xi (3, q) and weights (q,): points of integration.
    """

    shapes: Element
    place: IntArray
    xi: Array
    weights: Array

    @property
    def nodes(self) -> Array:
        """The nodes (3, k) in reference coordinates."""
        return np.asarray(self.shapes.doflocs, dtype=float)[self.place].T

    def N(self, xi: Array) -> Array:
        """Shapes (k, q) at points xi (3, q) in reference coordinates."""
        return np.array(
            [np.broadcast_to(self.shapes.lbasis(xi, i)[0], xi.shape[1:]) for i in self.place]
        )

    def dN(self, xi: Array) -> Array:
        """dN/dxi (k, 3, q) at points xi (3, q)."""
        return np.array(
            [np.broadcast_to(self.shapes.lbasis(xi, i)[1], xi.shape) for i in self.place]
        )

    def gradients(self, xi: Array, X: Array) -> Array:
        """dN/dx (n, k, 3, q) [1/m] at points xi (3, q) of elements with nodes X (n, k, 3): what
        strains are made of.
        """
        dN = self.dN(xi)
        return physical(dN, *cofactors(dN, X))


def cofactors(dN: Array, X: Array) -> tuple[Array, Array]:
    """Of J = dx/dxi at the points of dN (k, 3, q), for nodes X (n, k, 3): cofactors (n, 3, 3, q)
    and det J (n, q).

    J_(id) = dx_i / dxi_d = sum_k X_ki N_k,d; its inverse is cofactors_(id) / det J as (d, i). [m^2]
    and [m^3].
    """
    k, _, q = dN.shape
    J = (X.transpose(0, 2, 1) @ dN.reshape(k, 3 * q)).reshape(-1, 3, 3, q)
    a, b, c = J[:, :, 0], J[:, :, 1], J[:, :, 2]
    cof = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=2)
    return cof, np.sum(a * cof[:, :, 0], axis=1)


def physical(dN: Array, cof: Array, det: Array) -> Array:
    """dN/dx (n, k, 3, q) = J^-T dN/dxi from dN (k, 3, q), cofactors and determinants of J."""
    inverse = cof / det[:, None, None]
    gradients: Array = inverse[:, None, :, 0] * dN[:, 0, None]
    for d in (1, 2):
        gradients += inverse[:, None, :, d] * dN[:, d, None]
    return gradients


def _cross(a: Array, b: Array) -> Array:
    """Cross products along the second of three axes; numpy's own is several times slower."""
    (a0, a1, a2), (b0, b1, b2) = a.swapaxes(0, 1), b.swapaxes(0, 1)
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], axis=1)


def _prism(order: int) -> tuple[Array, Array]:
    """Triangle by line; scikit-fem's own rule for wedges (12.0) is not one of them: its weights add
    up to a quarter.
    """
    (triangle, areas), (line, lengths) = (
        get_quadrature(RefTri, order),
        get_quadrature(RefLine, order),
    )
    xi = np.vstack([np.repeat(triangle, len(lengths), axis=1), np.tile(line, (1, len(areas)))])
    return xi, np.outer(areas, lengths).ravel()


# scikit-fem numbers the nodes of a hexahedron from (1, 1, 1); this is a turn, not a reflection, of
# meshio's numbering.
_HEX = np.argsort(
    [
        4,
        0,
        7,
        5,
        3,
        1,
        6,
        2,
        16,
        15,
        12,
        11,
        8,
        19,
        14,
        17,
        13,
        10,
        9,
        18,
        20,
        25,
        22,
        23,
        24,
        21,
        26,
    ]
)

# All weights are positive. Stiffness and mass are exact on straight-sided simplices and wedges and
# on parallelepipeds.
ELEMENTS = {
    "tetra": SolidElement(ElementTetP1(), np.arange(4), *get_quadrature(RefTet, 2)),
    "tetra10": SolidElement(ElementTetP2(), np.arange(10), *get_quadrature(RefTet, 5)),
    "hexahedron": SolidElement(ElementHex1(), _HEX[:8], *get_quadrature(RefHex, 5)),
    "hexahedron20": SolidElement(ElementHexS2(), _HEX[:20], *get_quadrature(RefHex, 5)),
    "hexahedron27": SolidElement(ElementHex2(), _HEX, *get_quadrature(RefHex, 5)),
    "wedge": SolidElement(ElementWedge1(), np.arange(6), *_prism(4)),
}
"""The solids by meshio's names."""
