"""Where lines meet the facets of a surface, flat or curved."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..mesh.cells import FACET_TYPES, NODES_PER_CELL
from ..mesh.mesh import IntArray
from .facet import facet_element

MAX_OVERSHOOT = 0.05  # of a point beyond a facet, in reference coordinates
MIN_SINE_TO_FACET = 1e-3  # of a line to a facet, below which it runs beside it
STEPS_ON_FACET = 4  # of Newton's method, from flat triangles to curved facets
FACET_TRIANGLES = {
    3: [((0, 1, 2), ((0, 0), (1, 0), (0, 1)))],
    4: [((0, 1, 2), ((0, 0), (1, 0), (1, 1))), ((0, 2, 3), ((0, 0), (1, 1), (0, 1)))],
}
"""the flat triangles of facets, by their number of corners: corners, and reference coordinates"""


@dataclass(frozen=True, eq=False)
class FacetHits:
    """Where q lines along a direction meet facets: the nearest, inside rather than beyond them.

    far (q,) [m]: how far, inf for none; y (q, 3) [m]: the points, from the origin of the lines and
    facets; nodes (q, k) and N (q, k): of the facets there, filled up with zeros.
    """

    far: Array
    y: Array
    nodes: IntArray
    N: Array

    @classmethod
    def none(cls, n: int) -> "FacetHits":
        most = max(map(NODES_PER_CELL.__getitem__, FACET_TYPES))
        nodes = np.zeros((n, most), dtype=np.int64)
        return cls(np.full(n, np.inf), np.zeros((n, 3)), nodes, np.zeros((n, most)))

    @property
    def found(self) -> NDArray[np.bool_]:
        return np.isfinite(self.far)

    def add(
        self, kind: str, nodes: IntArray, X: Array, x: Array, along: Array, reach: float
    ) -> None:
        """Take the nearer points of lines x + c along, |c| < reach, on facets X (m, k, 3)."""
        facet, xi = _through_corners(X[:, : FACET_TYPES[kind].corners], x, along, reach)
        some = np.flatnonzero(facet >= 0)
        if not len(some):
            return
        element, corners = facet_element(kind), X[facet[some]]
        xi, c = xi[some].T, np.zeros(len(some))
        for _ in range(STEPS_ON_FACET):
            N, dN = (np.array(values) for values in zip(*_basis(element, xi), strict=True))
            missed = x[some] + c[:, None] * along - np.einsum("kq,qki->qi", N, corners)
            J = np.einsum("kdq,qki->qid", dN, corners)
            J = np.concatenate([J, np.broadcast_to(-along[:, None], (len(some), 3, 1))], axis=2)
            change = np.linalg.solve(J, missed[:, :, None])[:, :, 0]
            xi, c = xi + change[:, :2].T, c + change[:, 2]
        N = np.array([value for value, _ in _basis(element, xi)])
        beyond = np.maximum(-xi, xi - 1.0).max(axis=0)
        if FACET_TYPES[kind].corners == 3:
            beyond = np.maximum(beyond, xi.sum(axis=0) - 1.0)
        far = np.abs(c) + reach * np.maximum(beyond, 0.0)
        better = (beyond < MAX_OVERSHOOT) & (np.abs(c) < reach) & (far < self.far[some])
        chosen, k = some[better], X.shape[1]
        self.far[chosen] = far[better]
        self.y[chosen] = np.einsum("kq,qki->qi", N, corners)[better]
        self.nodes[chosen], self.N[chosen] = 0, 0.0
        self.nodes[chosen, :k], self.N[chosen, :k] = nodes[facet[chosen]], N.T[better]


def _basis(element: Any, xi: Array) -> Iterator[tuple[Array, Array]]:
    """Shapes (q,) and their slopes (2, q) at points xi (2, q) of a facet."""
    for i in range(len(element.doflocs)):
        value, slope = element.lbasis(xi, i)
        yield np.broadcast_to(value, xi.shape[1:]), np.broadcast_to(slope, xi.shape)


def _through_corners(X: Array, x: Array, along: Array, reach: float) -> tuple[IntArray, Array]:
    """The facet (q,), -1 for none, that each line x + c along meets first, and xi (q, 2) there.

    Of facets X (m, k, 3) as the flat triangles of their corners.
    """
    best = np.full(len(x), np.inf)
    facet, place = np.full(len(x), -1), np.zeros((len(x), 2))
    for corners, reference in FACET_TRIANGLES[X.shape[1]]:
        a, b, c = (X[:, corner] for corner in corners)
        normal = np.cross(b - a, c - a)
        size = np.linalg.norm(normal, axis=1)
        steep = normal @ along
        inside = np.abs(steep) > MIN_SINE_TO_FACET * size
        steep = np.where(inside, steep, 1.0)
        away = np.einsum("mqi,mi->mq", a[:, None] - x, normal) / steep[:, None]
        arm = x + away[..., None] * along - a[:, None]  # (m, q, 3)
        inverse = normal / np.maximum(size, np.finfo(float).tiny)[:, None] ** 2
        second = np.einsum("mqi,mi->mq", np.cross(arm, (c - a)[:, None]), inverse)
        third = np.einsum("mqi,mi->mq", np.cross((b - a)[:, None], arm), inverse)
        beyond = np.maximum(0.0, np.maximum(-np.minimum(second, third), second + third - 1.0))
        hit = inside[:, None] & (beyond < MAX_OVERSHOOT) & (np.abs(away) < reach)
        # Beyond one facet is inside its neighbor, which then has the point.
        distance = np.where(hit, np.abs(away) + reach * beyond, np.inf)
        nearest = distance.argmin(axis=0)
        q = np.arange(len(x))
        better = distance[nearest, q] < best
        best[better] = distance[nearest, q][better]
        facet[better] = nearest[better]
        r, s = second[nearest, q][better], third[nearest, q][better]
        origin, first, last = np.array(reference)
        place[better] = origin + np.outer(r, first - origin) + np.outer(s, last - origin)
    return facet, place
