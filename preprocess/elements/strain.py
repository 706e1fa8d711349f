"""Strains at points of a solid mesh: sampled within elements, extrapolated to nodes, averaged."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..body.material import STRESSES
from ..mesh.mesh import IntArray, Mesh
from .element import solid_element

# strain_i = sum_(c,a) STRAINS_(c,i,a) du_a/dx_c, shear strains being engineering's
STRAINS = np.zeros((3, 6, 3))
for _i, (_a, _c) in enumerate(STRESSES):
    STRAINS[_c, _i, _a] = STRAINS[_a, _i, _c] = 1.0


def strain_rows(mesh: Mesh, points: Mapping[str, IntArray]) -> Any:
    """Rows (6 p, 3 n), sparse: strains at p points from displacements of n nodes.

    points: by type of element (n_elements, k), the point to which each node belongs, -1 for none.
    The strain at a point is the mean over the elements that touch it. In an element the polynomial
    through the strains at its samples is evaluated at its nodes: at the Gauss points of one order
    less strains are more accurate than at the nodes themselves. Order: xx, yy, zz, 2 yz, 2 xz,
    2 xy. Errors fall with h^2 for quadratic elements, with h for linear ones.
    """
    n_p = 1 + max(int(numbers.max()) for numbers in points.values())
    slopes = [sp.csr_array((n_p, len(mesh.points))) for _ in range(3)]
    touching = np.zeros(n_p, dtype=np.int64)
    for kind, numbers in points.items():
        rows = np.flatnonzero((numbers >= 0).any(axis=1))
        solid, cells = solid_element(kind), mesh.cells[kind][rows]
        element, node = np.nonzero(numbers[rows] >= 0)
        point = numbers[rows[element], node]
        touching += np.bincount(point, minlength=n_p)

        n_samples = len(cells) * solid.samples.shape[1]
        samples = np.arange(n_samples).reshape(len(cells), -1)  # (elements, q)
        carry = _sparse(
            _extrapolation(kind)[node], point[:, None], samples[element], (n_p, samples.size)
        )
        gradients = solid.gradients(solid.samples, mesh.points[cells])  # (elements, k, 3, q)
        for c in range(3):
            columns, shape = cells[:, :, None], (samples.size, len(mesh.points))
            slopes[c] += carry @ _sparse(gradients[:, :, c], samples[:, None], columns, shape)
    mean = sp.dia_array((1.0 / touching[None], [0]), shape=(n_p, n_p))
    terms = zip(slopes, STRAINS, strict=True)
    return sum(sp.kron(mean @ slope, strain, format="csr") for slope, strain in terms)


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
    return sp.coo_array((values.ravel(), (rows, columns)), shape=shape).tocsr()
