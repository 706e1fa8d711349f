"""Directors of shells: the normals at their corners, of neighbors one where they are smooth."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from ...superelement.validation import Array
from ..mesh.mesh import IntArray

MAX_SMOOTH_ANGLE = np.radians(30.0)
"""Angle between the normals of neighbors up to which the surface is smooth: beyond is a fold."""


@dataclass(frozen=True, eq=False)
class Directors:
    """Unit vectors d (n, k, 3) at the corners of shells, by type, and the fan (n, k) of each.

    A fan is a node and the elements around it that go on smoothly from each other, which share
    their director there. turned: pairs of neighbors whose normals are on opposite sides.
    """

    d: Mapping[str, Array]
    fans: Mapping[str, IntArray]
    turned: IntArray


def directors(points: Array, cells: Mapping[str, IntArray], owners: IntArray) -> Directors:
    """The directors of shells; `owners` (n_elements,) of their laminates, which end a fan."""
    normals = {kind: _corner_normals(points[nodes]) for kind, nodes in cells.items()}
    mean = np.concatenate([_unit(normal.sum(axis=1)) for normal in normals.values()])
    corner, first = {}, 0
    for kind, nodes in cells.items():
        corner[kind] = first + np.arange(nodes.size).reshape(nodes.shape)
        first += nodes.size
    one, other, turned = _joined(cells, corner, mean, owners)
    graph = sp.coo_array((np.ones(one.size), (one, other)), shape=(first, first))
    count, fan = connected_components(graph, directed=False)
    total = np.zeros((count, 3))
    # The normals of corners are as long as their angles, which weigh them.
    np.add.at(total, fan, np.concatenate([normal.reshape(-1, 3) for normal in normals.values()]))
    shared = _unit(total)
    fans = {kind: fan[numbers] for kind, numbers in corner.items()}
    return Directors({kind: shared[of] for kind, of in fans.items()}, fans, turned)


def _corner_normals(X: Array) -> Array:
    """Normals (n, k, 3) at the corners of elements X (n, k, 3), as long as the angles there."""
    after, before = np.roll(X, -1, axis=1) - X, np.roll(X, 1, axis=1) - X
    across = np.cross(after, before)
    sine = np.linalg.norm(across, axis=2)
    angle = np.arctan2(sine, np.einsum("nki,nki->nk", after, before))
    return across * (angle / np.maximum(sine, np.finfo(float).tiny))[..., None]


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.finfo(float).tiny))


def _joined(
    cells: Mapping[str, IntArray], corner: Mapping[str, IntArray], mean: Array, owners: IntArray
) -> tuple[IntArray, IntArray, IntArray]:
    """Pairs of corners of neighbors at one node that go on smoothly, and turned neighbors (m, 2).

    Where more than two elements meet in an edge none goes on in another.
    """
    nodes, corners, element, start = [], [], [], 0
    for kind, of in cells.items():
        nodes.append(np.stack([of, np.roll(of, -1, axis=1)], axis=2).reshape(-1, 2))
        numbers = corner[kind]
        corners.append(np.stack([numbers, np.roll(numbers, -1, axis=1)], axis=2).reshape(-1, 2))
        element.append(np.repeat(start + np.arange(len(of)), of.shape[1]))
        start += len(of)
    ends, at, of_edge = np.concatenate(nodes), np.concatenate(corners), np.concatenate(element)
    _, edge, count = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    edge = edge.ravel()
    inner = np.flatnonzero(count[edge] == 2)
    first, second = inner[np.argsort(edge[inner], kind="stable")].reshape(-1, 2).T
    # Neighbors of one side run along their edge in opposite directions.
    opposite = ends[first, 0] == ends[second, 1]
    a, b = of_edge[first], of_edge[second]
    cosine = np.einsum("ei,ei->e", mean[a], mean[b])
    smooth = opposite & (cosine > np.cos(MAX_SMOOTH_ANGLE)) & (owners[a] == owners[b])
    f, s = first[smooth], second[smooth]
    one = np.concatenate([at[f, 0], at[f, 1]])
    other = np.concatenate([at[s, 1], at[s, 0]])
    turned = np.stack([a[~opposite], b[~opposite]], axis=1)
    return one, other, turned
