"""Central differences with lumped masses, on the stiffness of the meshes of a case."""

import math
import time
from dataclasses import dataclass

import duhamel as du
import numba
import numpy as np
from duhamel.preprocess import assemble
from numpy.typing import NDArray
from scipy.sparse import bsr_array, diags_array
from scipy.sparse.linalg import eigsh

from .cases import GAP, SPEED, Array, Case

Index = NDArray[np.int64]

COURANT = 0.9
"""step over the largest stable one"""


@dataclass(frozen=True, eq=False)
class Run:
    """Force (n,) [N] at times (n,) [s], CPU time [s] and number of steps."""

    time: Array
    force: Array
    cpu: float

    @property
    def impulse(self) -> float:
        return float(np.trapezoid(self.force, self.time))


@dataclass(frozen=True, eq=False)
class Mesh:
    """The lower triangle of K in blocks (n, 3, 3), their columns and row starts, masses (3N,) of
    the dofs, and the largest stable step [s]; of several parts one after the other.
    """

    blocks: Array
    columns: Index
    starts: Index
    mass: Array
    stable: float


@dataclass(frozen=True, eq=False)
class Gaps:
    """The gaps (m,) between nodes and what is opposite: g = gap + n . (u_node - sum_j w_j u_j).

    nodes (m,); opposite (m, k) nodes with weights (m, k), none of a plane; normal (m, 3); areas
    (m,) of the nodes.
    """

    nodes: Index
    gap: Array
    normal: Array
    opposite: Index
    weights: Array
    area: Array


def mesh_of(part: du.Part) -> Mesh:
    structure = assemble(part.body(step=1e-6, band=1e5))
    order = structure.nodes.displacements.ravel()
    K = bsr_array(structure.K.tocsr()[order][:, order], blocksize=(3, 3))
    K.sort_indices()
    mass = np.asarray(structure.M.sum(axis=1)).ravel()[order]
    root = diags_array(1.0 / np.sqrt(mass))
    largest = eigsh(root @ K @ root, 1, which="LM", return_eigenvectors=False, tol=1e-4)[0]
    rows = np.repeat(np.arange(len(K.indptr) - 1), np.diff(K.indptr))
    lower = K.indices <= rows
    return Mesh(
        np.ascontiguousarray(K.data[lower]),
        K.indices[lower].astype(np.int64),
        np.concatenate([[0], np.cumsum(np.bincount(rows[lower]))]),
        mass,
        float(2.0 / np.sqrt(largest)),
    )


def both(first: Mesh, second: Mesh) -> Mesh:
    """Two bodies as one mesh."""
    n, blocks = len(first.mass) // 3, len(first.blocks)
    return Mesh(
        np.concatenate([first.blocks, second.blocks]),
        np.concatenate([first.columns, second.columns + n]),
        np.concatenate([first.starts, second.starts[1:] + blocks]),
        np.concatenate([first.mass, second.mass]),
        min(first.stable, second.stable),
    )


def gaps_of(case: Case, elements: list[du.Superelement], n_first: int) -> Gaps:
    """n_first: nodes of the first mesh."""
    first = elements[0].surface(case.surface)
    m, area = first.n, node_areas(first.X, first.facets)
    nodes = np.asarray(first.nodes, dtype=np.int64)
    if len(elements) == 1:
        height = first.X[:, 2] - first.X[:, 2].min() + GAP
        normal = np.tile([0.0, 0.0, 1.0], (m, 1))
        return Gaps(nodes, height, normal, np.empty((m, 0), dtype=np.int64), np.empty((m, 0)), area)
    second = elements[1].surface(case.surface)
    X, Y = first.X + elements[0].center, second.X + elements[1].center
    # Bilinear facets of cylinders, of which the nearest is opposite.
    found = [nearest(x, Y[facet]) for x in X for facet in second.facets]
    gap, normal, weights = (np.array(values) for values in zip(*found, strict=True))
    chosen = np.arange(m), np.abs(gap).reshape(m, -1).argmin(axis=1)
    return Gaps(
        nodes,
        gap.reshape(m, -1)[chosen],
        normal.reshape(m, -1, 3)[chosen],
        second.nodes[second.facets[chosen[1]]] + n_first,
        weights.reshape(m, -1, 4)[chosen],
        area,
    )


def nearest(x: Array, corners: Array) -> tuple[float, Array, Array]:
    """Gap of a point over a rectangle, its normal and the weights of its corners (4,).

    The gap is infinite where the foot is outside.
    """
    along, across = corners[1] - corners[0], corners[3] - corners[0]
    normal = np.cross(along, across)
    normal /= np.linalg.norm(normal)
    s, t = ((x - corners[0]) @ edge / (edge @ edge) for edge in (along, across))
    weights = np.array([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    inside = min(s, t, 1.0 - s, 1.0 - t) > -1e-9
    return float(normal @ (x - corners[0])) if inside else np.inf, normal, weights


def node_areas(X: Array, facets: Index) -> Array:
    """The part of each node of the area of its bilinear facets: int N dA, by 2 x 2 points."""
    areas = np.zeros(len(X))
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for point in signs / np.sqrt(3.0):
        N = np.prod(1.0 + signs * point, axis=1) / 4.0
        dN = signs * (1.0 + signs * point)[:, ::-1] / 4.0
        tangents = np.einsum("kd,fkx->fdx", dN, X[facets])
        weights = np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
        np.add.at(areas, facets, weights[:, None] * N)
    return areas


@numba.njit(fastmath=True)
def central_differences(
    blocks: Array,
    columns: Index,
    starts: Index,
    step: float,
    factor: Array,
    nodes: Index,
    gap: Array,
    normal: Array,
    opposite: Index,
    weights: Array,
    stiffness: Array,
    u: Array,
    v: Array,
    force: Array,
) -> None:
    """Fill force (n,) with that on the first body before each step; factor: step / mass."""
    f = np.zeros_like(u)
    for n in range(len(force)):
        f[:] = 0.0
        for i in range(len(starts) - 1):
            a, b, c = u[i, 0], u[i, 1], u[i, 2]
            x = y = z = 0.0
            last = starts[i + 1] - 1
            for k in range(starts[i], last):
                j, K = columns[k], blocks[k]
                d, e, g = u[j, 0], u[j, 1], u[j, 2]
                x += K[0, 0] * d + K[0, 1] * e + K[0, 2] * g
                y += K[1, 0] * d + K[1, 1] * e + K[1, 2] * g
                z += K[2, 0] * d + K[2, 1] * e + K[2, 2] * g
                f[j, 0] += K[0, 0] * a + K[1, 0] * b + K[2, 0] * c
                f[j, 1] += K[0, 1] * a + K[1, 1] * b + K[2, 1] * c
                f[j, 2] += K[0, 2] * a + K[1, 2] * b + K[2, 2] * c
            K = blocks[last]  # of the node itself
            f[i, 0] += x + K[0, 0] * a + K[0, 1] * b + K[0, 2] * c
            f[i, 1] += y + K[1, 0] * a + K[1, 1] * b + K[1, 2] * c
            f[i, 2] += z + K[2, 0] * a + K[2, 1] * b + K[2, 2] * c
        x = y = z = 0.0
        for k in range(len(nodes)):
            i, depth = nodes[k], -gap[k]
            for c in range(3):
                moved = u[i, c]
                for j in range(opposite.shape[1]):
                    moved -= weights[k, j] * u[opposite[k, j], c]
                depth -= normal[k, c] * moved
            if depth > 0.0:
                push = stiffness[k] * depth
                for c in range(3):
                    f[i, c] -= push * normal[k, c]
                    for j in range(opposite.shape[1]):
                        f[opposite[k, j], c] += weights[k, j] * push * normal[k, c]
                x += push * normal[k, 0]
                y += push * normal[k, 1]
                z += push * normal[k, 2]
        force[n] = math.sqrt(x * x + y * y + z * z)
        for i in range(len(u)):
            for x in range(3):
                v[i, x] -= factor[i, x] * f[i, x]
                u[i, x] += step * v[i, x]


def run_explicit(case: Case, mesh: Mesh, gaps: Gaps, n_first: int) -> Run:
    step = COURANT * mesh.stable
    n = round(case.t_end / step)
    cpu = 0.0
    for count in (0, n):  # none first, which compiles
        u, v = np.zeros((2, len(mesh.mass) // 3, 3))
        v[:n_first] = SPEED * np.array(case.way)
        force = np.zeros(count)
        begin = time.process_time()
        central_differences(
            mesh.blocks,
            mesh.columns,
            mesh.starts,
            step,
            step / mesh.mass.reshape(-1, 3),
            gaps.nodes,
            gaps.gap,
            gaps.normal,
            gaps.opposite,
            gaps.weights,
            case.layer * gaps.area,
            u,
            v,
            force,
        )
        cpu = time.process_time() - begin
    return Run(step * np.arange(n), force, cpu)
