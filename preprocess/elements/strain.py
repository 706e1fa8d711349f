"""Strains at points of a solid mesh: sampled within elements, extrapolated to nodes, averaged."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..body.material import Material
from ..mesh.mesh import IntArray, Mesh
from .assumed import assumed
from .batches import batched
from .element import solid_element

NO_OWNER = -1  # of elements at none of the points
STRAIN_BATCH = 2**20  # numbers in the strains of a batch of elements


def strain_rows(
    mesh: Mesh, points: Mapping[str, IntArray], materials: Sequence[Material], owners: IntArray
) -> Any:
    """Rows (6 p, 3 n), sparse: strains at p points from displacements of n nodes.

    points: by type of element (n_elements, k), the point to which each node belongs, -1 for none;
    owners (n_elements,): the number of each element's material in `materials`. The strain at a
    point is the mean over the elements that touch it. In an element the polynomial through the
    strains at its samples is evaluated at its nodes: at the Gauss points of one order less strains
    are more accurate than at the nodes themselves. They are the strains whose energy is the
    stiffness, incompatible modes and projected dilatation included. Order: xx, yy, zz, 2 yz, 2 xz,
    2 xy. Errors fall with h^2, of four-node tetrahedra with h.
    """
    n_p = 1 + max(int(numbers.max()) for numbers in points.values())
    touching = np.zeros(n_p, dtype=np.int64)
    for of in points.values():
        touching += np.bincount(of[of >= 0], minlength=n_p)
    shape = (6 * n_p, 3 * len(mesh.points))
    total = sp.csr_array(shape)
    for kind, numbers in points.items():
        carry, samples = _extrapolation(kind), solid_element(kind).samples
        k = numbers.shape[1]
        # Inner elements touch no point of the surface: their strains would fill the memory.
        used = (numbers >= 0).any(axis=1)
        of_kind = np.where(used, mesh.of_kind(owners, kind), NO_OWNER)
        for owner, rows in batched(of_kind, max(1, STRAIN_BATCH // (18 * k * samples.shape[1]))):
            if owner == NO_OWNER:
                continue
            cells, of, material = mesh.cells[kind][rows], numbers[rows], materials[owner]
            strained = assumed(kind, material).on(mesh.points[cells], material.elasticity)
            element, node = np.nonzero(of >= 0)
            point = of[element, node]
            at_nodes = strained.strains(samples) @ carry.T  # (n, 6, 3 k, k)
            values = at_nodes[element, :, :, node] / touching[point][:, None, None]
            columns = (3 * cells[:, :, None] + np.arange(3)).reshape(-1, 1, 3 * k)[element]
            rows_of = 6 * point[:, None, None] + np.arange(6)[:, None]
            total = total + _sparse(values, rows_of, columns, shape)
    return total


def _extrapolation(kind: str) -> Array:
    """(k, q): values at the nodes of the polynomial through the values at the samples."""
    return at_samples(kind, solid_element(kind).nodes)


def at_samples(kind: str, xi: Array) -> Array:
    """(q, s): values at points xi (3, q) of the polynomial through the values at the samples."""
    element = solid_element(kind)
    n = element.samples.shape[1]
    of_samples, of_points = _terms(element.samples, n), _terms(xi, n)
    return np.asarray(np.linalg.solve(of_samples, of_points).T, dtype=float)


def _terms(xi: Array, n: int) -> Array:
    """The first n terms (n, q) at points xi (3, q): tetrahedra have 1 or 4, prisms 6, cubes 8."""
    x, y, z = xi
    return np.array([np.ones_like(x), x, y, z, x * z, y * z, x * y, x * y * z])[:n]


def _sparse(values: Array, rows: IntArray, columns: IntArray, shape: tuple[int, int]) -> Any:
    rows, columns = (np.broadcast_to(numbers, values.shape).ravel() for numbers in (rows, columns))
    matrix = sp.coo_array((values.ravel(), (rows, columns)), shape=shape).tocsr()
    matrix.eliminate_zeros()
    return matrix
