"""Shape functions of facets and points of integration on them.

Nodes as meshio numbers them: corners, midsides, center. Quadrilaterals have 3 x 3 points of Gauss,
exact to degree 5; triangles the six points of Strang and Fix, exact to degree 4.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from ..arrays import Array

NUMBERED_FACETS = "triangle", "quad", "triangle6", "quad8", "quad9"
"""types of facets, in the order of their numbers in compiled code"""
SMOOTH_TYPES = {"triangle": "triangle6", "quad": "quad8"}
"""types of linear facets with middle nodes on arcs"""
MOST_NODES = 9
"""nodes of a facet, the most of all types"""
MOST_CORNERS = 4
"""corners of a facet, likewise"""
TRIANGLE_POINTS = ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))
"""coordinate and weight of two sets of three points, of which the weights sum to 1"""


class RuleOfFacets(NamedTuple):
    """Points of integration on a type of facets."""

    weights: Array
    """(points,) in reference coordinates"""
    functions: Array
    """(points, nodes) shape functions"""
    slopes: Array
    """(points, 2, nodes) their derivatives by the reference coordinates"""
    corner_functions: Array
    """(points, corners) linear shape functions of the corners"""

    @property
    def n_nodes(self) -> int:
        return int(self.functions.shape[1])

    @property
    def n_corners(self) -> int:
        return int(self.corner_functions.shape[1])


@cache
def rule_of(facet_type: str) -> RuleOfFacets:
    """The rule of a type of facets: "triangle", "quad", "triangle6", "quad8" or "quad9"."""
    shape = SHAPE_FUNCTIONS[facet_type]
    triangular = facet_type.startswith("triangle")
    points, weights = _triangle_rule() if triangular else _quadrilateral_rule()
    functions = np.array([shape(x, y) for x, y in points])
    corners = SHAPE_FUNCTIONS["triangle" if triangular else "quad"]
    step = 1e-3  # central differences are exact for polynomials of degree two in each direction
    slopes = np.array(
        [
            [
                (shape(x + step, y) - shape(x - step, y)) / (2.0 * step),
                (shape(x, y + step) - shape(x, y - step)) / (2.0 * step),
            ]
            for x, y in points
        ]
    )
    corner_functions = np.array([corners(x, y) for x, y in points])
    return RuleOfFacets(weights, functions, slopes, corner_functions)


def _triangle_rule() -> tuple[Array, Array]:
    points, weights = [], []
    for a, weight in TRIANGLE_POINTS:
        b = 1.0 - 2.0 * a
        points += [(a, a), (a, b), (b, a)]
        # The area of the reference triangle is a half.
        weights += [0.5 * weight] * 3
    return np.array(points), np.array(weights)


def _quadrilateral_rule() -> tuple[Array, Array]:
    x, w = np.polynomial.legendre.leggauss(3)
    points = np.array([(a, b) for a in x for b in x])
    return points, np.array([a * b for a in w for b in w])


def _triangle(x: float, y: float) -> Array:
    return np.array([1.0 - x - y, x, y])


def _triangle6(x: float, y: float) -> Array:
    L = _triangle(x, y)
    pairs = np.array([L[0] * L[1], L[1] * L[2], L[2] * L[0]])
    return np.concatenate([L * (2.0 * L - 1.0), 4.0 * pairs])


QUAD_NODES = ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0))
"""reference coordinates of the nodes of quadrilaterals"""


def _quad(x: float, y: float) -> Array:
    return np.array([0.25 * (1.0 + a * x) * (1.0 + b * y) for a, b in QUAD_NODES[:4]])


def _quad8(x: float, y: float) -> Array:
    corners = [
        0.25 * (1.0 + a * x) * (1.0 + b * y) * (a * x + b * y - 1.0) for a, b in QUAD_NODES[:4]
    ]
    sides = [
        0.5 * ((1.0 - x * x) * (1.0 + b * y) if a == 0 else (1.0 + a * x) * (1.0 - y * y))
        for a, b in QUAD_NODES[4:8]
    ]
    return np.array(corners + sides)


def _quad9(x: float, y: float) -> Array:
    def along(t: float, a: int) -> float:
        return 1.0 - t * t if a == 0 else 0.5 * t * (t + a)

    return np.array([along(x, a) * along(y, b) for a, b in QUAD_NODES])


SHAPE_FUNCTIONS: dict[str, Callable[[float, float], Array]] = {
    "triangle": _triangle,
    "quad": _quad,
    "triangle6": _triangle6,
    "quad8": _quad8,
    "quad9": _quad9,
}
"""shape functions of the types of facets"""
