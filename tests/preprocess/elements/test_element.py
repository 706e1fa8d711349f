"""Reference elements: nodes, rules of integration, and gradients in space."""

from math import factorial

import numpy as np
import pytest
from duhamel.preprocess.elements.element import solid_element

from ..blocks import solid_cells

# The degree of the mass of elements that are affine images: in every coordinate for hexahedra, in
# all for the others.
DEGREES = {
    "tetra": 2,
    "tetra10": 4,
    "hexahedron": 4,
    "hexahedron20": 4,
    "hexahedron27": 4,
    "wedge": 2,
}


def moment(kind, powers):
    """int x^a y^b z^c over the reference domain."""
    a, b, c = powers
    if kind.startswith("tetra"):
        return factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3)
    base = (
        factorial(a) * factorial(b) / factorial(a + b + 2)
        if kind == "wedge"
        else 1 / ((a + 1) * (b + 1))
    )
    return base / (c + 1)


def test_a_shape_is_one_at_its_node_alone(kind):
    element = solid_element(kind)
    np.testing.assert_allclose(
        element.N(element.nodes), np.eye(len(element.order)), rtol=0, atol=1e-14
    )


def test_the_nodes_are_in_the_order_of_meshio(kind):
    """Cells of a grid are images of the reference domain under affine maps, node by node, and not
    mirrored.
    """
    grid, cells = solid_cells(kind, (1, 1, 1))
    element = solid_element(kind)
    for cell in cells:
        affine = np.vstack([element.nodes, np.ones(len(element.order))]).T
        image, *_ = np.linalg.lstsq(affine, grid[cell].astype(float))
        np.testing.assert_allclose(affine @ image, grid[cell], rtol=0, atol=1e-13)
        assert np.linalg.det(image[:3]) > 0


def test_rules_are_exact_and_positive(kind):
    element, degree = solid_element(kind), DEGREES[kind]
    assert (element.weights > 0).all()
    for powers in np.ndindex(degree + 1, degree + 1, degree + 1):
        if sum(powers) <= degree or kind.startswith("hexahedron"):
            found = np.prod(element.xi.T ** np.array(powers), axis=1) @ element.weights
            assert found == pytest.approx(moment(kind, powers), rel=1e-12)


def test_gradients_of_a_linear_field(kind):
    """On elements bent out of shape: sum_k f(X_k) dN_k/dx is the gradient of a linear f."""
    element = solid_element(kind)
    rng = np.random.default_rng(1)
    X = element.nodes.T + rng.uniform(-0.03, 0.03, (5, len(element.order), 3))
    gradient = rng.normal(size=3)
    found = np.einsum("nk,nkiq->niq", X @ gradient, element.gradients(element.xi, X))
    np.testing.assert_allclose(found, np.broadcast_to(gradient[:, None], found.shape), rtol=1e-11)
