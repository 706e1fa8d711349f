"""Junctions of shells and solids: how the edge of a shell follows the solid that it ends on."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..errors import MeshError
from ..mesh.cells import FACET_TYPES, NODES_PER_CELL
from ..mesh.facets import Facets
from ..mesh.mesh import NO_NODES, IntArray
from ..mesh.mixed import MixedMesh
from ..mesh.nodes import spider
from ..sparse import in_columns
from .directors import Directors
from .facet import facet_element

POINTS_ALONG, POINTS_ACROSS = 3, 2
"""points of integration along a side, and between two nodes of the solid across the thickness"""
MAX_LAYERS = 24  # across the thickness; beyond, an even division does as well
MAX_SLOPE = 2.0
"""of a shell over the solid: how far along itself a fiber is followed to the face, in heights"""
MAX_OVERSHOOT = 0.05  # of a point beyond a facet, in reference coordinates
MIN_HELD = 0.1  # of the thickness on the solid, below which it holds no moment
MIN_SINE_TO_FACET = 1e-3  # of a fiber's way along the shell, below which it runs beside a facet
STEPS_ON_FACET = 4  # of Newton's method, from flat triangles to curved facets
MIN_RELATIVE_STIFFNESS = 0.02
"""of a turn that the slopes of fibers do not tell: below it the one about them is left"""
FACET_TRIANGLES = {
    3: [((0, 1, 2), ((0, 0), (1, 0), (0, 1)))],
    4: [((0, 1, 2), ((0, 0), (1, 0), (1, 1))), ((0, 2, 3), ((0, 0), (1, 1), (0, 1)))],
}
"""the flat triangles of facets, by their number of corners: corners, and reference coordinates"""


@dataclass(frozen=True, eq=False)
class _Samples:
    """Points y (q, 3) [m] of the solid under a side of a shell, from one of its ends.

    z (q,) [m]: heights in the shell; dual, weight (q,) [m^2]: areas times the dual and the plain
    shape of the end; nodes (q, k), N (q, k): of the facets there, filled up with zeros.
    """

    y: Array
    z: Array
    dual: Array
    weight: Array
    nodes: IntArray
    N: Array


def junction_rows(mesh: MixedMesh, shells: Directors, heights: Mapping[str, Array]) -> Any:
    """Rows (6 j, 3 n_s), sparse: displacement and rotation of the j joined points of shells.

    A point x + z d of the end of a shell moves by u + z w x d, as all of its points do. With the
    displacement v of the solid there, of the area A under the shell,

        int psi_i (u + z w x d - v) dA = 0,     int psi_i (z - z_i) (u + z w x d - v) dA = 0

    The dual shapes psi_i of the nodes of a side, int psi_i N_j ds = delta_ij int N_i ds, make both
    local: u_i is a mean of v, and w_i x d the mean slope of v across the thickness. So a constant
    or linear stress goes through the junction as it is. The turn about d, which no fiber tells, is
    that of the rigid motion nearest to v. Rigid motions are exact, whatever the meshes.

    Parameters
    ----------
    mesh : MixedMesh
    shells : Directors
        The directors of the shells.
    heights : by type (n, 2) [m]
        Of the lower and upper faces of the shells over their nodes.

    Raises
    ------
    MeshError
        Of a side under which less than a tenth of the thickness is on the solid.

    Source: B. I. Wohlmuth, SIAM Journal on Numerical Analysis 38 (2000) 989-1012, of dual shapes.
    """
    joined = np.flatnonzero(mesh.joined)
    number = np.full(len(mesh.joined), -1)
    number[joined] = np.arange(len(joined))
    found: list[list[_Samples]] = [[] for _ in joined]
    boundary = _Boundary.of(mesh.solids.points, mesh.facets)
    for kind, places in mesh.sides.items():
        cells = mesh.shells.cells[kind]
        for row, corner in places.tolist():
            after = (corner + 1) % cells.shape[1]
            ends = cells[row, [corner, after]]
            X, d = mesh.shells.points[ends], shells.d[kind][row, [corner, after]]
            side = _Side(X, d, heights[kind][row], mesh.shells.name)
            for end, samples in zip(number[ends].tolist(), side.samples(boundary), strict=True):
                if end >= 0:
                    found[end].append(samples)
    n = 3 * len(mesh.of_solids)
    return sp.vstack([sp.csr_array((0, n)), *(_rows(sides, n) for sides in found)], format="csr")


@dataclass(frozen=True, eq=False)
class _Boundary:
    """The boundary of solids over points (n, 3): facets by type with their boxes (m, 2, 3)."""

    points: Array
    facets: Mapping[str, IntArray]
    boxes: Mapping[str, Array]

    @classmethod
    def of(cls, points: Array, facets: Facets) -> "_Boundary":
        outer = facets.patch(np.flatnonzero(facets.boundary))
        boxes = {}
        for kind, nodes in outer.items():
            corners = points[nodes]
            boxes[kind] = np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)
        return cls(points, outer, boxes)

    def within(self, low: Array, high: Array) -> dict[str, IntArray]:
        """The facets whose boxes meet a box, by type."""
        found = {}
        for kind, nodes in self.facets.items():
            box = self.boxes[kind]
            near = ((box[:, 0] <= high) & (box[:, 1] >= low)).all(axis=1)
            if near.any():
                found[kind] = nodes[near]
        return found


class _Side:
    """A side of a shell on a solid: its ends X (2, 3), directors d (2, 3), and heights (2,)."""

    def __init__(self, X: Array, d: Array, heights: Array, name: str) -> None:
        self.X, self.d, self.heights, self.name = X, d, heights, name
        self.length = float(np.linalg.norm(X[1] - X[0]))
        self.along = (X[1] - X[0]) / self.length
        across = np.cross(d.mean(axis=0), self.along)
        self.inward = across / np.linalg.norm(across)
        self.thickness = float(heights[1] - heights[0])
        self.reach = MAX_SLOPE * float(np.abs(heights).max())

    def samples(self, boundary: _Boundary) -> tuple[_Samples, _Samples]:
        """The points of the solid under the side, from its first and from its second end."""
        box = np.concatenate([self.X + z * self.d for z in self.heights])
        near = boundary.within(box.min(axis=0) - self.reach, box.max(axis=0) + self.reach)
        s, along = _gauss(np.array([0.0, 1.0]), POINTS_ALONG)
        z, across = _gauss(self._layers(boundary.points, near), POINTS_ACROSS)
        fibers = np.outer(1.0 - s, self.d[0]) + np.outer(s, self.d[1])
        arms = np.outer(s, self.X[1] - self.X[0])[:, None] + z[:, None] * fibers[:, None]
        # From an end of the side, for rounding a kilometer away.
        corners = {kind: boundary.points[nodes] - self.X[0] for kind, nodes in near.items()}
        hits = _Hits.none(arms.size // 3)
        for kind, nodes in near.items():
            hits.add(kind, nodes, corners[kind], arms.reshape(-1, 3), self.inward, self.reach)
        # A fiber that misses the solid goes at all places along the side, so dual shapes stay dual.
        held = hits.found.reshape(len(s), len(z)).all(axis=0)
        if across[held].sum() < MIN_HELD * self.thickness:
            raise MeshError(
                f"{self.name}: expected the edge of a shell on the face of a solid, found "
                f"{across[held].sum() / self.thickness:.2g} of its thickness there, at "
                f"{self.X.mean(axis=0).tolist()}"
            )
        some = np.tile(held, len(s))
        dA = (self.length * np.outer(along, across)).ravel()[some]
        s, z = np.repeat(s, len(z))[some], np.tile(z, len(s))[some]
        y, nodes, N = hits.y[some], hits.nodes[some], hits.N[some]
        return (
            _Samples(y, z, (2.0 - 3.0 * s) * dA, (1.0 - s) * dA, nodes, N),
            _Samples(y - (self.X[1] - self.X[0]), z, (3.0 * s - 1.0) * dA, s * dA, nodes, N),
        )

    def _layers(self, points: Array, facets: Mapping[str, IntArray]) -> Array:
        """Heights between which the displacement of the solid is smooth: those of its nodes."""
        low, high = self.heights
        nodes = [np.unique(of) for of in facets.values()]
        arms = points[np.concatenate([NO_NODES, *nodes])] - self.X[0]
        z, s = arms @ self.d.mean(axis=0), arms @ self.along
        # Not those far along the shell, which are nodes of other faces.
        near = (np.abs(arms @ self.inward) < self.reach) & (z > low) & (z < high)
        inner = z[near & (s > -0.01 * self.length) & (s < 1.01 * self.length)]
        steps = np.unique(np.round((inner - low) / self.thickness, 6))
        if len(steps) >= MAX_LAYERS:
            steps = np.linspace(0.0, 1.0, MAX_LAYERS + 1)
        return np.asarray(low + self.thickness * np.unique([0.0, *steps, 1.0]))


def _gauss(bounds: Array, n: int) -> tuple[Array, Array]:
    """Points and weights of Gauss in each interval between bounds."""
    x, w = leggauss(n)
    half, middle = 0.5 * np.diff(bounds), 0.5 * (bounds[1:] + bounds[:-1])
    return (middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * w).ravel()


@dataclass(frozen=True, eq=False)
class _Hits:
    """Where lines along a direction meet facets, the nearest ones, inside rather than beyond them.

    far (q,) [m]: how far, inf for none.
    y (q, 3) [m] from the end of the side; nodes (q, k) and N (q, k), filled up with zeros.
    """

    far: Array
    y: Array
    nodes: IntArray
    N: Array

    @classmethod
    def none(cls, n: int) -> "_Hits":
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


def _rows(sides: Sequence[_Samples], n: int) -> Any:
    """Rows (6, n) of one point, whose sides are sampled from it."""
    of_sides = [np.broadcast_to(side.nodes, side.N.shape).ravel() for side in sides]
    nodes = np.unique(np.concatenate(of_sides))
    slots = [
        np.searchsorted(nodes, of).reshape(side.N.shape)
        for of, side in zip(of_sides, sides, strict=True)
    ]

    def summed(weights: Array, side: _Samples, slot: IntArray) -> Array:
        """sum_q weights (q, ...) N_k, by node (m, ...)."""
        total = np.zeros((len(nodes), *weights.shape[1:]))
        factors = side.N.reshape(*side.N.shape, *(1,) * (weights.ndim - 1))
        np.add.at(total, slot, factors * weights[:, None])
        return total

    area = sum(float(side.dual.sum()) for side in sides)
    mean, place = np.zeros(len(nodes)), np.zeros(3)
    H, turned = np.zeros((3, 3)), np.zeros((len(nodes), 3, 3))
    for side, slot in zip(sides, slots, strict=True):
        mean += summed(side.dual, side, slot) / area
        place += side.dual @ side.y / area
        height = side.dual * (side.z - side.dual @ side.z / side.dual.sum())
        inertia = float(height @ side.z)
        # w x d is the slope of the displacement across the thickness, d that of the places.
        slope, d = summed(height, side, slot) / inertia, height @ side.y / inertia
        H += inertia * (d @ d * np.eye(3) - np.outer(d, d))
        turned += inertia * slope[:, None, None] * _crossed(d)
    w = _whole_turn(H, turned, _nearest_turn(sides, summed, slots))
    rows = np.zeros((6, len(nodes), 3))
    rows[:3] = (mean[:, None, None] * np.eye(3) + _crossed(place) @ w).transpose(1, 0, 2)
    rows[3:] = w.transpose(1, 0, 2)
    columns = (3 * nodes[:, None] + np.arange(3)).ravel()
    return in_columns(rows.reshape(6, -1), columns, n)


def _nearest_turn(
    sides: Sequence[_Samples], summed: Callable[..., Array], slots: Sequence[IntArray]
) -> Array:
    """The rotation (m, 3, 3) of the rigid motion nearest to that of the samples."""
    weight = np.concatenate([side.weight for side in sides])
    middle = weight @ np.concatenate([side.y for side in sides]) / weight.sum()
    J = np.zeros((3, 3))
    moments: Any = 0.0
    for side, slot in zip(sides, slots, strict=True):
        arms = side.y - middle
        squares = np.einsum("q,qi,qj->ij", side.weight, arms, arms)
        J += np.trace(squares) * np.eye(3) - squares
        moments = moments + summed(side.weight[:, None, None] * _crossed(arms), side, slot)
    return np.asarray(np.linalg.solve(J, moments))


def _whole_turn(H: Array, turned: Array, nearest: Array) -> Array:
    """w (m, 3, 3) with H w = turned; about an axis of no stiffness that of the nearest turn."""
    stiffness, axes = np.linalg.eigh(H)
    known = stiffness > MIN_RELATIVE_STIFFNESS * stiffness[-1]
    inverse = (axes[:, known] / stiffness[known]) @ axes[:, known].T
    rest = axes[:, ~known] @ axes[:, ~known].T
    return np.asarray(inverse @ turned + rest @ nearest)


def _crossed(arms: Array) -> Array:
    """r~ (..., 3, 3): r x v from v."""
    flat = -spider(arms.reshape(-1, 3))[:, :, 3:]
    return flat.reshape(*arms.shape, 3)
