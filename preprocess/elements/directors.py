"""Directors of shells: the normals at their corners, of neighbors one where they are smooth."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from ...superelement.validation import Array
from ..mesh.mesh import IntArray

MAX_SMOOTH_ANGLE = np.radians(30.0)
"""Angle between the normals of neighbors up to which the surface is smooth: beyond is a fold."""


@dataclass(frozen=True, eq=False)
class Directors:
    """Unit vectors d (n, k, 3) at the corners of shells, by type, and the fan (n, k) of each.

    A fan is a node and the elements around it that go on smoothly from each other, which share
    their director there. open (n, k): whether the surface ends at a side, from a corner to the
    next one, or does not go on smoothly. turned: pairs of neighbors whose normals are on opposite
    sides.
    """

    d: Mapping[str, Array]
    fans: Mapping[str, IntArray]
    open: Mapping[str, NDArray[np.bool_]]
    turned: IntArray

    @property
    def n_fans(self) -> int:
        return 1 + max(int(fan.max()) for fan in self.fans.values())


def directors(points: Array, cells: Mapping[str, IntArray], owners: IntArray) -> Directors:
    """The directors of shells; `owners` (n_elements,) of their laminates, which end a fan."""
    normals = {kind: _corner_normals(points[nodes]) for kind, nodes in cells.items()}
    mean = np.concatenate([_unit(normal.sum(axis=1)) for normal in normals.values()])
    corner, first = {}, 0
    for kind, nodes in cells.items():
        corner[kind] = first + np.arange(nodes.size).reshape(nodes.shape)
        first += nodes.size
    sides = _sides(cells, corner)
    joined, turned = _joined(sides, mean, owners)
    # Corners of one node are joined along sides: around it goes what is smooth on the way.
    one, other = sides.corners[joined[0]], sides.corners[joined[1], ::-1]
    graph = sp.coo_array((np.ones(one.size), (one.ravel(), other.ravel())), shape=(first, first))
    count, fan = connected_components(graph, directed=False)
    total = np.zeros((count, 3))
    # The normals of corners are as long as their angles, which weigh them.
    np.add.at(total, fan, np.concatenate([normal.reshape(-1, 3) for normal in normals.values()]))
    shared = _unit(total)
    fans = {kind: fan[numbers] for kind, numbers in corner.items()}
    ends = np.ones(first, dtype=np.bool_)
    ends[sides.corners[np.concatenate(joined), 0]] = False
    free = {kind: ends[numbers] for kind, numbers in corner.items()}
    return Directors({kind: shared[of] for kind, of in fans.items()}, fans, free, turned)


def _corner_normals(X: Array) -> Array:
    """Normals (n, k, 3) at the corners of elements X (n, k, 3), as long as the angles there."""
    after, before = np.roll(X, -1, axis=1) - X, np.roll(X, 1, axis=1) - X
    across = np.cross(after, before)
    sine = np.linalg.norm(across, axis=2)
    # By arctan2, which keeps the digits of angles near 0 and pi.
    angle = np.arctan2(sine, np.einsum("nki,nki->nk", after, before))
    return np.asarray(across * (angle / np.maximum(sine, np.finfo(float).tiny))[..., None])


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.finfo(float).tiny))


class _Sides(NamedTuple):
    """All sides of elements: their nodes and corners (m, 2), and the element (m,) of each."""

    nodes: IntArray
    corners: IntArray
    element: IntArray


def _sides(cells: Mapping[str, IntArray], corner: Mapping[str, IntArray]) -> _Sides:
    nodes: list[IntArray] = []
    corners: list[IntArray] = []
    element, first = [], 0
    for kind, of in cells.items():
        for found, rows in ((nodes, of), (corners, corner[kind])):
            found.append(np.stack([rows, np.roll(rows, -1, axis=1)], axis=2).reshape(-1, 2))
        element.append(np.repeat(first + np.arange(len(of)), of.shape[1]))
        first += len(of)
    return _Sides(np.concatenate(nodes), np.concatenate(corners), np.concatenate(element))


def _joined(
    sides: _Sides, mean: Array, owners: IntArray
) -> tuple[tuple[IntArray, IntArray], IntArray]:
    """Pairs of sides in which neighbors go on smoothly, and pairs (m, 2) of turned neighbors.

    Where more than two elements meet in a side none goes on in another.
    """
    keys = np.sort(sides.nodes, axis=1)
    _, edge, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    edge = edge.ravel()
    # A web on a plate has no neighbor that it goes on in, so all three keep their normals.
    inner = np.flatnonzero(count[edge] == 2)
    first, second = inner[np.argsort(edge[inner], kind="stable")].reshape(-1, 2).T
    # Neighbors of one side of the surface run along their edge in opposite directions.
    opposite = sides.nodes[first, 0] == sides.nodes[second, 1]
    a, b = sides.element[first], sides.element[second]
    cosine = np.einsum("ei,ei->e", mean[a], mean[b])
    smooth = opposite & (cosine > np.cos(MAX_SMOOTH_ANGLE)) & (owners[a] == owners[b])
    return (first[smooth], second[smooth]), np.stack([a[~opposite], b[~opposite]], axis=1)
