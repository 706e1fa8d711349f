"""Integrals over facets in space: area, centroid, and the mean rigid motion of a surface."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..elements.facet import facet_shapes
from ..mesh.facets import Patch
from ..mesh.mesh import IntArray
from ..mesh.nodes import Nodes, spider
from ..sparse import in_columns


@dataclass(frozen=True, eq=False)
class Surface:
    """Facets ready to integrate, as points x (m, 3) with areas dA (m,) [m^2] each.

    nodes (n,): those of the facets, each once; N (m, n), sparse: values at the points x from values
    at these nodes.
    """

    nodes: IntArray
    x: Array
    dA: Array
    N: Any

    @property
    def area(self) -> float:
        return float(self.dA.sum())

    @property
    def centroid(self) -> Array:
        """The centroid of the area (3,)."""
        moment: Array = self.dA @ self.x
        return moment / self.area


def surface(points: Array, patch: Patch) -> Surface:
    """The isoparametric surface of facets over the points (n_points, 3) of a mesh."""
    # Numbers among the nodes of the surface keep N small, whatever the size of the mesh.
    nodes = np.unique(np.concatenate([facets.ravel() for facets in patch.values()]))
    pieces = [
        _piece(points[nodes], kind, np.searchsorted(nodes, facets))
        for kind, facets in patch.items()
    ]
    x, dA, N = zip(*pieces, strict=True)
    return Surface(nodes, np.concatenate(x), np.concatenate(dA), sp.vstack(N, format="csr"))


def _piece(points: Array, kind: str, facets: IntArray) -> tuple[Array, Array, Any]:
    """x, dA and N of facets (n, k) of one type."""
    N, weights, normals = facet_shapes(points, kind, facets)
    n, k = facets.shape
    dA = np.linalg.norm(normals, axis=-1) * weights
    columns = np.broadcast_to(facets[:, None, :], (n, len(weights), k)).ravel()
    table = sp.csr_array(
        (np.tile(N.T.ravel(), n), columns, np.arange(0, len(columns) + 1, k)),
        (dA.size, len(points)),
    )
    return np.einsum("kq,fki->fqi", N, points[facets]).reshape(-1, 3), dA.ravel(), table


@dataclass(frozen=True, eq=False)
class Fit:
    """What turns a fitted frame: nodes at x (n, 3) [m] from the middle, and their moments y (n, 3).

    y: int N_i x dA [m^3] of a surface, x [m] of points.
    """

    middle: Array
    x: Array
    y: Array

    @property
    def inertia(self) -> Array:
        """int |x|^2 I - x x^T dA (3, 3)."""
        S = self.x.T @ self.y
        return np.asarray(np.trace(S) * np.eye(3) - 0.5 * (S + S.T))


def fit_of_surface(patch: Surface, nodes: Nodes) -> Fit:
    """The fit of `mean_motion`."""
    arms = patch.x - patch.centroid
    moments = np.asarray(patch.N.T @ (patch.dA[:, None] * arms))
    return Fit(patch.centroid, nodes.points[patch.nodes] - patch.centroid, moments)


def fit_of_points(members: IntArray, nodes: Nodes) -> Fit:
    """The fit of `mean_motion_of_points`."""
    middle = nodes.points[members].mean(axis=0)
    x = nodes.points[members] - middle
    return Fit(middle, x, x)


def mean_motion(patch: Surface, X: Array, nodes: Nodes) -> Any:
    """D (6, n_dofs) sparse: the rigid motion about X nearest to that of the surface, q = D u.

        int |u - A q|^2 dA least:   D = (int A^T A dA)^-1 int A^T N dA,   A = [I, -(x - X)~]

    so D A = I, and a load p on the frame becomes the traction A (int A^T A dA)^-1 p, linear over
    the surface as the stress in a beam. With nodal areas int N_i dA as weights the corners of
    quadratic facets would weigh nothing, or less; the integral needs no such weights, and differs
    only in how a facet shares load among its nodes.
    """
    A = spider(patch.x - patch.centroid)
    blocks = patch.N.T @ (patch.dA[:, None] * A.reshape(-1, 18))
    return _fitted(blocks.reshape(-1, 3, 6), patch.nodes, patch.centroid, X, nodes)


def mean_motion_of_points(members: IntArray, X: Array, nodes: Nodes) -> Any:
    """D (6, n_dofs) sparse as `mean_motion`, of single nodes that all weigh the same."""
    middle = nodes.points[members].mean(axis=0)
    return _fitted(spider(nodes.points[members] - middle), members, middle, X, nodes)


def mean_motion_of_sections(members: IntArray, X: Array, nodes: Nodes, radius: float) -> Any:
    """D (6, n_dofs) sparse: the rigid motion about X nearest to that of nodes with six dofs.

        sum |u_i - q - w x (X_i - X)|^2 + radius^2 |w_i - w|^2 least

    With the radius of gyration of sections across the edge of a shell, whose nodes may be on a
    line, as `mean_motion` of the faces that a solid has there.
    """
    arms = spider(nodes.points[members] - X)
    turns = np.broadcast_to(np.eye(6)[3:], arms.shape)
    A = np.concatenate([arms, turns], axis=1)
    weighted = A * np.array([1.0] * 3 + [radius**2] * 3)[:, None]
    G = np.einsum("nij,nik->jk", weighted, A)
    D = np.linalg.solve(G, weighted.transpose(2, 0, 1).reshape(6, -1))
    columns = nodes.first[members][:, None] + np.arange(6)
    return in_columns(D, columns.ravel(), nodes.n_dofs)


def _fitted(blocks: Array, members: IntArray, middle: Array, X: Array, nodes: Nodes) -> Any:
    """D = (sum B_i^T A_i)^-1 [B_i^T] for weighted arms B_i (n, 3, 6) of nodes `members`; D A = I.

    Both arms reach from `middle`, where the fit is best conditioned; the frame at X moves with the
    fitted motion.
    """
    G = np.einsum("nij,nik->jk", blocks, spider(nodes.points[members] - middle))
    D = np.linalg.solve(G, blocks.transpose(2, 0, 1).reshape(6, -1))
    D[:3] = spider((X - middle)[None])[0] @ D
    return in_columns(D, nodes.displacements[members].ravel(), nodes.n_dofs)
