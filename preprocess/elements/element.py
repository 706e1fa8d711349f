"""Solid elements on their reference domains: shapes, gradients, points of integration."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import skfem
from skfem.quadrature import get_quadrature
from skfem.refdom import Refdom, RefLine, RefTri, RefWedge

from ...superelement.validation import Array
from ..mesh.cells import SOLID_TYPES, SolidType
from ..mesh.mesh import IntArray


@dataclass(frozen=True, eq=False)
class SolidElement:
    """An isoparametric solid with shape functions of scikit-fem, its nodes in meshio's order.

    order (k,): the shape function of each node; xi (3, q) and weights (q,): points of integration;
    samples (3, s): points at which strains are sampled, one for each term of the polynomial that
    carries them to the nodes.
    """

    shapes: skfem.Element
    order: IntArray
    xi: Array
    weights: Array
    samples: Array

    @property
    def nodes(self) -> Array:
        """The nodes (3, k) in reference coordinates."""
        return np.asarray(self.shapes.doflocs, dtype=float)[self.order].T

    def N(self, xi: Array) -> Array:
        """Shapes (k, q) at points xi (3, q) in reference coordinates."""
        return np.array(
            [np.broadcast_to(self.shapes.lbasis(xi, i)[0], xi.shape[1:]) for i in self.order]
        )

    def dN(self, xi: Array) -> Array:
        """dN/dxi (k, 3, q) at points xi (3, q)."""
        return np.array(
            [np.broadcast_to(self.shapes.lbasis(xi, i)[1], xi.shape) for i in self.order]
        )

    def gradients(self, xi: Array, X: Array) -> Array:
        """dN/dx (n, k, 3, q) [1/m] at points xi (3, q) of elements with nodes X (n, k, 3)."""
        dN = self.dN(xi)
        return physical(dN, *cofactors(dN, X))


def cofactors(dN: Array, X: Array) -> tuple[Array, Array]:
    """Cofactors (n, 3, 3, q) [m^2] and determinants (n, q) [m^3] of J = dx/dxi.

    dN (k, 3, q), nodes X (n, k, 3).

    J_(id) = dx_i / dxi_d = sum_k X_ki N_k,d; its inverse is cofactors_(id) / det J as (d, i).
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


def _prism(degree: int) -> tuple[Array, Array]:
    """Triangle by line.

    scikit-fem's own rule for wedges (12.0) is no such product: its weights add up to a quarter.
    """
    triangle, areas = get_quadrature(RefTri, degree)
    line, lengths = get_quadrature(RefLine, degree)
    xi = np.vstack([np.repeat(triangle, len(lengths), axis=1), np.tile(line, (1, len(areas)))])
    return xi, np.outer(areas, lengths).ravel()


def _points(domain: type[Refdom], degree: int) -> tuple[Array, Array]:
    """Points (3, q) and weights (q,) that integrate polynomials of a degree exactly."""
    return _prism(degree) if domain is RefWedge else get_quadrature(domain, degree)


def points_of(solid: SolidType, degree: int) -> tuple[Array, Array]:
    """Points (3, q) and weights (q,) in a type of solid, exact for polynomials of a degree."""
    return _points(reference(solid).shapes.refdom, degree)


def solid_element(kind: str) -> SolidElement:
    """The reference element of a type of solid, by meshio's name."""
    return reference(SOLID_TYPES[kind])


@cache
def reference(solid: SolidType) -> SolidElement:
    """The reference element of a type of solid."""
    shapes = getattr(skfem, solid.shapes)()
    xi, weights = _points(shapes.refdom, solid.integration)
    samples, _ = _points(shapes.refdom, solid.sampling)
    return SolidElement(shapes, np.array(solid.order), xi, weights, samples)
