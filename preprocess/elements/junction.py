"""Junctions of shells and solids: how the edge of a shell follows the solid that it ends on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.polynomial.legendre import leggauss

from ...superelement.validation import Array
from ..errors import MeshError
from ..mesh.facets import Facets
from ..mesh.mesh import NO_NODES, IntArray
from ..mesh.mixed import MixedMesh
from ..mesh.nodes import spider
from ..sparse import in_columns
from .directors import Directors
from .facet_hits import FacetHits

POINTS_ALONG, POINTS_ACROSS = 3, 2
"""points of integration along a side, and between two nodes of the solid across the thickness"""
MAX_LAYERS = 24  # across the thickness; beyond, an even division does as well
MAX_SLOPE = 2.0
"""of a shell over the solid: how far along itself a fiber is followed to the face, in heights"""
MIN_HELD = 0.1  # of the thickness on the solid, below which it holds no moment
MIN_RELATIVE_STIFFNESS = 0.02
"""of a turn that the slopes of fibers do not tell: below it the one about them is left"""


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
        hits = FacetHits.none(arms.size // 3)
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


def _rows(sides: Sequence[_Samples], n: int) -> Any:
    """Rows (6, n) of one point, whose sides are sampled from it."""
    of_sides = [side.nodes.ravel() for side in sides]
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
