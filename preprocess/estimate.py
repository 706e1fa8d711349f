"""The first frequencies of a free body, without its impulse responses."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.sparse.linalg import LinearOperator, eigsh

from ..superelement.validation import Array
from .assembly.structure import Structure
from .mesh.mesh import IntArray
from .mesh.nodes import Nodes
from .responses.lowest import independent_squares
from .solving.factor import factorize
from .threads import in_order

MAX_SOLVED_UNKNOWNS = 50_000
"""Unknowns of solids up to which frequencies are computed, and above which they are estimated."""
SPLINES_PER_COMPONENT = 350
"""Splines for a component of displacement: fields enough for some ten modes, few enough for a dense
eigenproblem.
"""
REDUCED_ROWS_AT_ONCE = 2**14
MIN_GRID_EXTENT = 1e-3  # across a body without any, over the largest


@dataclass(frozen=True, eq=False)
class Frequencies:
    """The first elastic frequencies (m,) [Hz], ascending: exact, or else upper bounds."""

    values: Array
    exact: bool


def first_frequencies(structure: Structure, count: int) -> Frequencies:
    """Up to `count` frequencies: exact for beams and small solids, upper bounds for larger ones."""
    count = min(count, structure.n_u - 7)
    if structure.nodes.rotations.all() or structure.n_u <= MAX_SOLVED_UNKNOWNS:
        return Frequencies(_solved(structure, count), exact=True)
    return Frequencies(ritz_frequencies(structure, SPLINES_PER_COMPONENT)[:count], exact=False)


def ritz_frequencies(structure: Structure, splines: int) -> Array:
    """Upper bounds (m,) [Hz] of the elastic frequencies, from quadratic splines in space.

        V^T K V y = omega^2 V^T M V y
        V (n_u, 3 n): n products of splines in x, y and z, in each direction

    on a grid of cubes, the finest that leaves at most `splines` products that do not vanish on the
    body. The fields hold the rigid motions, so by Courant's principle the values after the first
    six bound those of the mesh. Nodes with rotations turn as the field does, by half its curl.
    Source: W. Ritz, J. reine angew. Math. 135 (1909).
    """
    V = _fields(structure.nodes, splines)
    K, M = _reduced(structure.K, V), _reduced(structure.M, V)
    return np.sqrt(independent_squares(K, M)[6:]) / (2.0 * np.pi)


def _reduced(A: Any, V: Any) -> Array:
    """V^T A V (r, r), summed over pieces of rows."""
    rows = A.tocsc().T

    def of_rows(start: int) -> Any:
        piece = slice(start, start + REDUCED_ROWS_AT_ONCE)
        return V[piece].T @ (rows[piece] @ V)

    total = np.zeros((V.shape[1], V.shape[1]))
    for part in in_order(of_rows, range(0, A.shape[0], REDUCED_ROWS_AT_ONCE)):
        total += part.toarray()
    return total


def _solved(structure: Structure, count: int) -> Array:
    """The frequencies (m,) [Hz] of the mesh, by Lanczos' method on (K + s M)^-1.

    s is of the size of the first elastic eigenvalue.
    """
    first = ritz_frequencies(structure, 27)[:1]
    if not (len(first) and 0.0 < first[0] < np.inf):
        raise np.linalg.LinAlgError("no first frequency can be told from rounding")
    # Positive definite although the body is free, and close to the modes looked for.
    s = 0.1 * (2.0 * np.pi * first[0]) ** 2
    solve = factorize(structure.K + s * structure.M, "the shifted stiffness")
    inverse = LinearOperator(structure.K.shape, matvec=solve, dtype=np.float64)
    squares = eigsh(
        structure.K, count + 6, structure.M, sigma=-s, OPinv=inverse, return_eigenvectors=False
    )
    elastic: Array = np.sort(squares)[6:]
    return np.sqrt(elastic) / (2.0 * np.pi)


def _fields(nodes: Nodes, splines: int) -> Any:
    """V (n_u, 3 n), sparse: the dofs under each of the n products of splines, along x, then y, then
    z.
    """
    lower, upper = nodes.points.min(axis=0), nodes.points.max(axis=0)
    # A flat mesh of lines would make a grid without volume.
    margin = 0.5 * np.maximum(MIN_GRID_EXTENT * (upper - lower).max() - (upper - lower), 0.0)
    lower, upper = lower - margin, upper + margin
    scaled = (nodes.points - lower) / (upper - lower)
    cells = _grid(scaled, upper - lower, splines)
    splines_along, slopes_along = [], []
    for axis, length in enumerate(upper - lower):
        N, dN = _along(scaled[:, axis], cells[axis])
        splines_along.append(N)
        slopes_along.append(dN / length)
    X, Y, Z = splines_along
    dX, dY, dZ = slopes_along

    values = _product(X, Y, Z)
    used = np.flatnonzero(np.diff(values.tocsc().indptr))
    turning = nodes.rotations
    x, y, z = (
        _product(*(factor[turning] for factor in factors))[:, used]
        for factors in ((dX, Y, Z), (X, dY, Z), (X, Y, dZ))
    )
    curl = sp.block_array([[None, -z, y], [z, None, -x], [-y, x, None]])
    translations = nodes.displacements.T.ravel()
    rotations = (nodes.first[turning] + np.arange(3, 6)[:, None]).ravel()
    V = sp.vstack([sp.block_diag([values[:, used]] * 3), 0.5 * curl], format="csr")
    order = np.argsort(np.concatenate([translations, rotations]))
    return V[order]


def _grid(scaled: Array, extent: Array, splines: int) -> IntArray:
    """The cells (3,) of the finest grid of near cubes with at most `splines` products.

    scaled (n, 3): the points in the unit cube of the grid.
    """
    finest = np.ones(3, dtype=np.int64)
    for n in range(2, splines):
        cells = np.maximum(1, np.round(n * extent / extent.max())).astype(np.int64)
        if _reaching(scaled, cells) > splines:
            break
        finest = cells
    return finest


def _reaching(scaled: Array, cells: IntArray) -> int:
    """The number of products of quadratic splines that do not vanish at every point.

    A cell has three by three by three.
    """
    reached = np.zeros(cells + 2, dtype=np.bool_)
    occupied = np.unique(np.minimum((scaled * cells).astype(np.int64), cells - 1), axis=0)
    for offset in np.ndindex(3, 3, 3):
        reached[tuple((occupied + offset).T)] = True
    return int(reached.sum())


def _along(x: Array, cells: int) -> tuple[Any, Any]:
    """Values and slopes (n, cells + 2) of the quadratic splines over [0, 1] in equal cells."""
    knots = np.concatenate([np.zeros(2), np.linspace(0.0, 1.0, cells + 1), np.ones(2)])
    basis = BSpline(knots, np.eye(cells + 2), 2)
    return basis(x), basis.derivative()(x)


def _product(X: Array, Y: Array, Z: Array) -> Any:
    """X_ni Y_nj Z_nk (n, i j k), sparse: of quadratic splines three are not zero at any point."""
    numbers, factors = [], []
    for N in (X, Y, Z):
        nonzero: NDArray[np.int64] = np.argsort(N == 0.0, axis=1, kind="stable")[:, :3]
        numbers.append(nonzero)
        factors.append(np.take_along_axis(N, nonzero, axis=1))
    values = np.einsum("ni,nj,nk->nijk", *factors)
    i, j, k = numbers
    ij = i[:, :, None, None] * Y.shape[1] + j[:, None, :, None]
    columns = ij * Z.shape[1] + k[:, None, None, :]
    rows = np.repeat(np.arange(len(X)), 27)
    shape = (len(X), X.shape[1] * Y.shape[1] * Z.shape[1])
    product = sp.csr_array((values.ravel(), (rows, columns.ravel())), shape=shape)
    product.eliminate_zeros()
    return product
