"""Strains of shells at points of their surface, from displacements and rotations of their nodes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from .shell_shape import ShellShape


@dataclass(frozen=True, eq=False)
class SurfaceFrames:
    """The surface of n shells at q points: tangents a (n, q, 2, 3), areas (n, q), axes.

    axes (n, q, 3, 3): local axes as rows, the third one the normal; turn (n, q, 2, 2): t_ia, the
    component along axis i of the contravariant base vector a.
    """

    a: Array
    areas: Array
    axes: Array
    turn: Array

    @cached_property
    def in_plane(self) -> Array:
        """(n, q, 3, 3): strains 11, 22, 2 12 along the axes from covariant ones."""
        t = self.turn
        first, second = t[..., 0, :], t[..., 1, :]
        rows = [
            [first[..., 0] ** 2, first[..., 1] ** 2, first[..., 0] * first[..., 1]],
            [second[..., 0] ** 2, second[..., 1] ** 2, second[..., 0] * second[..., 1]],
            [
                2.0 * first[..., 0] * second[..., 0],
                2.0 * first[..., 1] * second[..., 1],
                first[..., 0] * second[..., 1] + first[..., 1] * second[..., 0],
            ],
        ]
        return np.moveaxis(np.array(rows), (0, 1), (2, 3))


@dataclass(frozen=True, eq=False)
class Shells:
    """n shells of one type: nodes X (n, k, 3) [m], unit directors d (n, k, 3) at them.

    A point at the height z over the surface is at x + z d, and moves by u + z w x d, with x, d, u
    and w x d interpolated from the nodes: a rigid motion is among these exactly, of warped shells
    too. axis (n, 3): whose projection on the surface is local axis 1. Rows over the dofs of the
    nodes are (n, q, ..., k, 6): three displacements, three rotations.
    """

    shape: ShellShape
    X: Array
    d: Array
    axis: Array

    def some(self, rows: IntArray) -> "Shells":
        """Some of the shells."""
        return Shells(self.shape, self.X[rows], self.d[rows], self.axis[rows])

    def frames(self, xi: Array) -> SurfaceFrames:
        """The surface at points xi (2, q)."""
        a = np.einsum("kaq,nki->nqai", self.shape.dN(xi), self.X)
        normal = np.cross(a[:, :, 0], a[:, :, 1])
        areas = np.linalg.norm(normal, axis=2)
        e3 = normal / areas[..., None]
        across = self.axis[:, None] - np.einsum("ni,nqi->nq", self.axis, e3)[..., None] * e3
        # An axis along the normal, which has no projection, is refused where the body is read.
        e1 = across / np.linalg.norm(across, axis=2, keepdims=True)
        axes = np.stack([e1, np.cross(e3, e1), e3], axis=2)
        # a_alpha = s_(alpha i) e_i, of which the inverse has the contravariant base.
        turn = np.linalg.inv(np.einsum("nqai,nqbi->nqab", a, axes[:, :, :2]))
        return SurfaceFrames(a, areas, axes, turn)

    def membrane(self, xi: Array, at: SurfaceFrames) -> Array:
        """Strains (n, q, 3, k, 6) of the surface along its axes, 11, 22, 2 12.

        e_ab = 1/2 (a_a . u,b + a_b . u,a)
        """
        rows = np.zeros((*at.areas.shape, 3, self.X.shape[1], 6))
        rows[..., :3] = _paired(self.shape.dN(xi), at.a)
        return np.asarray(np.einsum("nqij,nqjkd->nqikd", at.in_plane, rows))

    def bending(self, xi: Array, at: SurfaceFrames) -> Array:
        """Curvatures (n, q, 3, k, 6), the slopes of strains by the height z.

            k_ab = 1/2 (a_a . f,b + d,a . u,b + a_b . f,a + d,b . u,a),   f = w x d

        The change d,a of the director is what makes rigid rotations of curved shells free of it.
        """
        dN = self.shape.dN(xi)
        rows = np.zeros((*at.areas.shape, 3, self.X.shape[1], 6))
        # Of flat shells the director is the same everywhere: displacements then do not bend.
        rows[..., :3] = _paired(dN, np.einsum("kaq,nki->nqai", dN, self.d))
        rows[..., 3:] = np.cross(self.d[:, None, None], _paired(dN, at.a))
        return np.asarray(np.einsum("nqij,nqjkd->nqikd", at.in_plane, rows))

    def bubble_bending(self, xi: Array, at: SurfaceFrames) -> Array:
        """Curvatures (n, q, 3, 2) of the bubble of directors along the tangents `bubble_axes`."""
        assert self.shape.bubble is not None
        _, slopes = self.shape.bubble(xi)
        along = np.einsum("nqai,nmi->nqam", at.a, self.bubble_axes)
        rows = np.stack(
            [
                slopes[0][:, None] * along[:, :, 0],
                slopes[1][:, None] * along[:, :, 1],
                slopes[0][:, None] * along[:, :, 1] + slopes[1][:, None] * along[:, :, 0],
            ],
            axis=2,
        )
        return np.asarray(np.einsum("nqij,nqjm->nqim", at.in_plane, rows))

    @cached_property
    def bubble_axes(self) -> Array:
        """Two tangents (n, 2, 3) in the middle."""
        return self.frames(self.shape.middle).axes[:, 0, :2]

    @cached_property
    def _tied(self) -> tuple[Array, Array]:
        """2 e_rt, 2 e_st at the ties (n, p, 2, k, 6), and those of the bubble (n, p, 2, 2).

        2 e_at = a_a . f + d . u,a
        """
        xi = self.shape.ties
        N, dN = self.shape.N(xi), self.shape.dN(xi)
        a = np.einsum("kap,nki->npai", dN, self.X)
        d = np.einsum("kp,nki->npi", N, self.d)
        rows = np.empty((*a.shape[:3], self.X.shape[1], 6))
        rows[..., :3] = np.einsum("kap,npi->npaki", dN, d)
        crossed = np.cross(self.d[:, None, None], a[:, :, :, None])
        rows[..., 3:] = np.einsum("kp,npaki->npaki", N, crossed)
        if self.shape.bubble is None:
            return rows, np.zeros((*a.shape[:3], 0))
        values, _ = self.shape.bubble(xi)
        return rows, values[:, None, None] * np.einsum("npai,nmi->npam", a, self.bubble_axes)

    def shear(self, xi: Array, at: SurfaceFrames) -> tuple[Array, Array]:
        """Assumed shear strains 2 13, 2 23 (n, q, 2, k, 6), and those of the bubble."""
        weights = np.einsum("nqia,qapb->nqipb", at.turn, self.shape.weights_of_ties(xi))
        rows, of_bubble = self._tied
        # One product for all ties, whatever the element: their strains do not depend on the point.
        flat = weights.reshape(*weights.shape[:3], -1)
        n, p = rows.shape[:2]
        nodal = np.einsum("nqij,njc->nqic", flat, rows.reshape(n, 2 * p, -1))
        bubble = np.einsum("nqij,njm->nqim", flat, of_bubble.reshape(n, 2 * p, -1))
        return nodal.reshape(*flat.shape[:3], -1, 6), bubble

    def incompatible(self, xi: Array, at: SurfaceFrames) -> Array:
        """Strains (n, q, 3, 4) of the modes 1 - r^2 and 1 - s^2 of displacements in the plane.

        By the Jacobian of the middle, so that uniform strains bring none of them about. Source:
        R. L. Taylor, P. J. Beresford, E. L. Wilson, Int. J. Num. Meth. Eng. 10 (1976) 1211-1219.
        """
        middle = self.frames(self.shape.middle)
        along = np.einsum("nai,nmi->nam", middle.a[:, 0], middle.axes[:, 0, :2])
        r, s = -2.0 * xi
        rows = np.zeros((len(self.X), xi.shape[1], 3, 2, 2))
        rows[:, :, 0, 0] = r[:, None] * along[:, None, 0]
        rows[:, :, 1, 1] = s[:, None] * along[:, None, 1]
        rows[:, :, 2, 0] = r[:, None] * along[:, None, 1]
        rows[:, :, 2, 1] = s[:, None] * along[:, None, 0]
        covariant = rows.reshape(*rows.shape[:3], 4)
        strains = np.einsum("nij,nqjm->nqim", middle.in_plane[:, 0], covariant)
        return np.asarray(strains * (middle.areas / at.areas)[:, :, None, None])

    def drilling(self, xi: Array, at: SurfaceFrames) -> Array:
        """The rotation (n, q, k, 6) about the normal beyond that of the surface.

        w . n - 1/2 (e_2 . u,1 - e_1 . u,2)
        """
        # Slopes along the local axes, in which the mean rotation of the surface is one number.
        along = np.einsum("nqia,kaq->nqik", at.turn, self.shape.dN(xi))
        e1, e2, e3 = np.moveaxis(at.axes, 2, 0)
        rows = np.empty((*at.areas.shape, self.X.shape[1], 6))
        rows[..., :3] = -0.5 * np.einsum("nqk,nqi->nqki", along[:, :, 0], e2)
        rows[..., :3] += 0.5 * np.einsum("nqk,nqi->nqki", along[:, :, 1], e1)
        rows[..., 3:] = np.einsum("kq,nqi->nqki", self.shape.N(xi), e3)
        return rows

    def motion(self, xi: Array) -> tuple[Array, Array]:
        """u (q, k) from displacements of nodes, and f = w x d (n, q, 3, k, 3) from rotations."""
        N = self.shape.N(xi).T
        # Rows of w x d by w: -d~.
        x, y, z = np.moveaxis(self.d, 2, 0)
        o = np.zeros_like(x)
        spun = np.array([[o, z, -y], [-z, o, x], [y, -x, o]])
        return N, np.einsum("qk,ijnk->nqikj", N, spun)


def _paired(dN: Array, vectors: Array) -> Array:
    """Rows (n, q, 3, k, 3): v_1 N,1; v_2 N,2; v_2 N,1 + v_1 N,2 of vectors (n, q, 2, 3)."""
    first, second = vectors[:, :, 0, None], vectors[:, :, 1, None]
    by_r, by_s = (np.moveaxis(dN[:, axis], 0, 1)[None, :, :, None] for axis in range(2))
    return np.stack([by_r * first, by_s * second, by_r * second + by_s * first], axis=2)
