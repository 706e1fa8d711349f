"""Motion of frames and of the nodes that follow them, to second order.

Second derivatives (..., r, r) are by the coordinates q of motions u = Psi q, Psi (n_u, r).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..elements.inertia import cross
from ..mesh.mesh import IntArray
from ..mesh.nodes import Nodes
from .interfaces import Attachment
from .surface import Fit


@dataclass(frozen=True, eq=False)
class Follower:
    """Nodes on arms (n, 3) of a rigid frame, which has the rotation vector w = rotation @ u.

        u_i = u_C + (exp(w~) - 1) X_i,    second order 1/2 w~w~ X_i

    dofs (n, 3): those of their displacements in the source.
    """

    dofs: IntArray
    arms: Array
    rotation: Any

    def work(self, loads: Array, a: Array, b: Array) -> Array:
        """Of loads (n_dofs, k) on the second derivative by motions a and b: (k, r_a, r_b)."""
        N = np.einsum("nik,nj->kij", loads[self.dofs], self.arms, optimize=True)
        symmetric = 0.5 * (N + N.transpose(0, 2, 1))
        # w~w~ X = (w.X) w - |w|^2 X: of its work on loads only the symmetric part counts.
        B = symmetric - np.einsum("kii->k", N)[:, None, None] * np.eye(3)
        return np.asarray((self.rotation @ a).T @ B @ (self.rotation @ b))

    def displacements(self, motions: Array) -> Array:
        """The second derivative (n, 3, r, r) of their displacements."""
        w = self.rotation @ motions
        return twice_turned(self.arms, w).transpose(1, 0, 2, 3)


def twice_turned(arms: Array, w: Array) -> Array:
    """1/2 (w_k~ w_l~ + w_l~ w_k~) X (3, n, r, r) of arms X (n, 3) and rotations w (3, r)."""
    first, second = w[:, None, :, None], w[:, None, None, :]
    X = arms.T[:, :, None, None]
    return 0.5 * (cross(first, cross(second, X)) + cross(second, cross(first, X)))


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame (3 or 6 rows) on the dofs of a structure.

    carried: its rows on the dofs of the source, nodes (n, 3) and fit: those whose mean motion it
    follows, and how they turn it; none where it has dofs of its own.
    """

    rows: Any
    carried: Any | None = None
    nodes: IntArray | None = None
    fit: Fit | None = None
    arm: Array | None = None

    def second(self, T: Any, followers: Sequence[Follower], motions: Array) -> Array:
        """The second derivative (n_rows, r, r) of displacement and rotation vector.

        T (n, n_u): the dofs of the source.
        """
        r = motions.shape[1]
        total = np.zeros((self.rows.shape[0], r, r))
        if self.carried is not None:
            loads = self.carried.T.toarray()
            for follower in followers:
                total += follower.work(loads, motions, motions)
        if self.fit is not None and self.nodes is not None and self.arm is not None:
            u = (T @ motions)[self.nodes]
            total += _fitted(self.fit, self.arm, u, self.rows[3:] @ motions)
        return total


def _fitted(fit: Fit, arm: Array, u: Array, w: Array) -> Array:
    """The second derivative (6, r, r) of the rotation that fits best, and of an arm's end.

    int |x + u - mean u - exp(w~) x|^2 least: int x x u = J w in first order, and in second

        J w2 = int (w x x) x u + 1/2 (w x (w x x)) x x,    u_2 = w2 x arm + 1/2 w~w~ arm

    with nodes (n, 3, r) of u; w (3, r).
    """
    J = fit.inertia
    H = np.einsum("nik,nj->ijk", u, fit.y)
    # The moment w2 must balance, for one order of the motions; the other is its transpose.
    pulled = np.einsum("jik,jl->ikl", H, w) - np.einsum("jjk,il->ikl", H, w)
    held = 0.5 * cross(w[:, :, None], (J @ w)[:, None, :])
    moment = pulled - held
    moment = moment + moment.transpose(0, 2, 1)
    turned = np.einsum("ij,jkl->ikl", np.linalg.inv(J), moment)
    moved = cross(turned, arm[:, None, None]) + twice_turned(arm[None], w)[:, 0]
    return np.concatenate([moved, turned])


def frame_of(attachment: Attachment, T: Any, nodes: Nodes) -> Frame:
    """A frame that follows nodes of the source, whose dofs are T u."""
    rows, fit = attachment.rows @ T, attachment.fit
    if fit is None:
        return Frame(rows, attachment.rows)
    dofs = nodes.displacements[attachment.nodes]
    return Frame(rows, attachment.rows, dofs, fit, attachment.X - fit.middle)
