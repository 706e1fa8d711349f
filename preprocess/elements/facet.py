"""Shapes and normals of facets in space, at points of integration."""

from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..mesh.cells import FACET_TYPES
from ..mesh.mesh import IntArray

FACET_QUADRATURE_DEGREE = 5  # of polynomials that are integrated exactly on flat facets


def facet_element(kind: str) -> Any:
    """The element of scikit-fem with the shapes of a type of facet."""
    # Bodies of beams do without scikit-fem, which takes its time to import.
    import skfem

    return getattr(skfem, FACET_TYPES[kind].shapes)()


def facet_shapes(points: Array, kind: str, facets: IntArray) -> tuple[Array, Array, Array]:
    """Shapes N (k, q), weights (q,) and normals x,1 x x,2 (n, q, 3) of facets (n, k) of a type."""
    from skfem.quadrature import get_quadrature

    element = facet_element(kind)
    xi, weights = get_quadrature(element.refdom, FACET_QUADRATURE_DEGREE)
    values = [element.lbasis(xi, i) for i in range(facets.shape[1])]
    N = np.array([np.broadcast_to(value, weights.shape) for value, _ in values])
    dN = np.array([np.broadcast_to(gradient, xi.shape) for _, gradient in values])
    tangents = np.einsum("kdq,fki->dfqi", dN, points[facets])
    return N, weights, np.cross(tangents[0], tangents[1])
