"""The second order of a body: inertia, momentum, strain energy and frames in motions of its dofs.

Second derivatives (..., r, r) are by the coordinates q of motions u = Psi q, Psi (n_u, r), of the
dofs of the structure, in mesh axes. Motions are free of rigid ones, U^T M u = 0, and so is what
second order adds to them: where nodes or masses follow a frame that turns, the body is moved back,
so that its center of mass and its mean rotation stay.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..body.body import Body
from ..elements.inertia import Moved, Pieces, pairs
from ..mesh.nodes import Nodes, spider
from .frame_motion import Follower, Frame, frame_of
from .interfaces import Attachment
from .source import Source, Tensors
from .structure import Structure

Solve = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Lumped:
    """A mass or inertia on a frame, as one rigid piece."""

    piece: Pieces
    frame: Frame

    @property
    def changes(self) -> Array:
        """The first order change of the inertia (6, 3 or 6) by the motion of the frame."""
        return np.asarray(self.piece.changes()[0][:, : self.frame.rows.shape[0]])

    @property
    def momenta(self) -> Array:
        """Momentum and angular momentum (6, 3 or 6) of the motion of the frame."""
        arm, mass = spider(self.piece.X)[0], self.piece.mass[0] * np.eye(3)
        turning = np.vstack([np.zeros((3, 3)), self.piece.inertia[0]])
        return np.hstack([arm.T @ mass, turning])[:, : self.frame.rows.shape[0]]

    def motions(self, motions: Array) -> tuple[Array, Array]:
        """Displacements and rotations (3, 1, r)."""
        moved = np.zeros((6, 1, motions.shape[1]))
        moved[: self.frame.rows.shape[0], 0] = self.frame.rows @ motions
        return moved[:3], moved[3:]


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """Tensors of a structure whose source has the dofs T u.

    elements: those of its elements; frames: its interfaces; followers: nodes on rigid ones. K and M
    are those of the source.
    """

    structure: Structure
    elements: Tensors
    T: Any
    K: Any
    momenta: Array
    """M A (n, 6) of the source: its momenta under rigid motions"""
    frames: tuple[Frame, ...]
    followers: tuple[Follower, ...]
    lumped: tuple[Lumped, ...]

    @cached_property
    def inertia_loads(self) -> Array:
        """F (n_u, 6): F^T u is the first order change of the inertia J_11, J_22, J_33, J_23, J_13,
        J_12 [kg m^2].
        """
        F = self.T.T @ self._element_loads
        for lumped in self.lumped:
            F = F + lumped.frame.rows.T @ lumped.changes.T
        return np.asarray(F)

    def inertia(self, motions: Array) -> Array:
        """Q (6, r, r): the second derivative of the inertia, in the order of `inertia_loads`."""
        Q = self.elements.inertia(self.T @ motions) + self._follow(self._element_loads, motions)
        for lumped in self.lumped:
            Q += lumped.piece.second(*lumped.motions(motions))
            Q += _times(lumped.changes, self._second(lumped.frame, motions))
        return Q + _times(self.inertia_loads.T @ self.structure.rigid.A, self._moved_back(motions))

    def gyroscopic(self, motions: Array) -> Array:
        """h (3, r, r): the angular momentum of the elastic motion is h(q, q')."""
        h = self.elements.gyroscopic(self.T @ motions)
        for lumped in self.lumped:
            h += lumped.piece.momentum(*lumped.motions(motions))
        return h

    def third(self, u: Array, motions: Array) -> Array:
        """D3(u; psi_k, psi_l) (k, r, r) of u (n_u, k): the third derivative of the strain energy.

        Symmetric in all three. Loads K u on the nodes of a rigid frame work on what second order
        adds to their displacements. `BodyError` for a body without elements.
        """
        a, b = self.T @ u, self.T @ motions
        D3 = self.elements.third(a, b)
        # Elements see only what is linear in the dofs: tied nodes swing on arcs besides.
        if self.followers:
            D3 += self._follow(self.K @ a, motions)
            mixed = self._follow(self.K @ b, u, motions).transpose(1, 0, 2)
            D3 += mixed + mixed.transpose(0, 2, 1)
        return D3

    def cubic(self, motions: Array) -> Array:
        """D3(psi_k; psi_l, psi_m) (r, r, r), symmetric to the last bit."""
        D3 = self.third(motions, motions)
        return _symmetric(D3)

    def quartic(self, motions: Array, solve: Solve) -> Array:
        """D4 (r, r, r, r), so that with W = D3(q, q, q) / 6 + D4(q, q, q, q) / 8 no energy is
        negative.

            D4 = sym int e_kl.C e_mn dV - Q_kl^T K_w^+ Q_mn,    Q_kl^T u = int sigma(u).e_kl dV

        e_kl = sym(grad psi_k^T grad psi_l), second order strains of St. Venant and Kirchhoff;
        `solve` gives K_w^+ Q, the displacements (n_u, n) under loads (n_u, n) of the motions that
        are not among psi. `BodyError` for a body without solids.
        """
        r = motions.shape[1]
        energy, loads = self.elements.quartic(self.T @ motions, self._moved(motions))
        loads = self.T.T @ loads
        energy -= loads.T @ solve(loads)
        pair = pairs(r)
        return _symmetric(energy[pair[:, :, None, None], pair])

    def interfaces(self, motions: Array) -> Array:
        """(n_c, r, r): the second derivative of displacements and rotation vectors of interfaces.

        Where they are measured: frames of their own move as their dofs do, those on the mean motion
        of nodes turn as fits them best; and all move back with the body.
        """
        return self.measured(motions) + _times(
            self.structure.P_C @ self.structure.rigid.A, self._moved_back(motions)
        )

    def nodes(self, rows: Any, motions: Array) -> Array:
        """The same (k, r, r) of displacements `rows` (k, n_u) of nodes: that the body is moved
        back.
        """
        return _times(rows @ self.structure.rigid.A, self._moved_back(motions))

    def measured(self, motions: Array) -> Array:
        """As `interfaces`, of a body that is not moved back."""
        return np.concatenate([self._second(frame, motions) for frame in self.frames])

    @cached_property
    def _element_loads(self) -> Array:
        return self.elements.inertia_loads()

    def _second(self, frame: Frame, motions: Array) -> Array:
        return frame.second(self.T, self.followers, motions)

    def _follow(self, loads: Array, a: Array, b: Array | None = None) -> Array:
        """Work of loads (n, k) of the source on what second order adds to followers (k, r, r)."""
        b = a if b is None else b
        total = np.zeros((loads.shape[1], a.shape[1], b.shape[1]))
        for follower in self.followers:
            total += follower.work(loads, a, b)
        return total

    def _moved(self, motions: Array) -> Moved | None:
        """The dofs (n, 3) of followers, and second derivatives (n, 3, r, r) of what they do."""
        if not self.followers:
            return None
        dofs = np.concatenate([follower.dofs for follower in self.followers])
        return dofs, np.concatenate([part.displacements(motions) for part in self.followers])

    def _moved_back(self, motions: Array) -> Array:
        """Translation and rotation (6, r, r) that take away the momenta of second order."""
        rigid = self.structure.rigid
        momenta = self._follow(self.momenta, motions)
        for lumped in self.lumped:
            momenta += _times(lumped.momenta, self._second(lumped.frame, motions))
        back = np.asarray(-np.linalg.inv(rigid.J_rot))
        return np.concatenate([momenta[:3] / -rigid.mass, _times(back, momenta[3:])])


def second_order(structure: Structure, source: Source, body: Body) -> SecondOrder:
    """The second order of a structure that was assembled from `source` and `body`.

    The matrices of the source are made once more. `BodyError` if those of another program tell
    nothing of it.
    """
    K, M = source.matrices()
    nodes, center = source.nodes, structure.rigid.center
    elements = source.tensors(M, center)
    T = _source_dofs(structure, nodes)
    frames = {
        name: Frame(structure.rows[name]) if frame.rigid else frame_of(frame, T, nodes)
        for name, frame in structure.frames.items()
    }
    return SecondOrder(
        structure,
        elements,
        T,
        K,
        np.asarray(M @ nodes.rigid_motion(center)),
        tuple(frames.values()),
        tuple(_followers(structure, nodes)),
        tuple(_lumped(structure, body, frames, lambda frame: frame_of(frame, T, nodes))),
    )


def _source_dofs(structure: Structure, nodes: Nodes) -> Any:
    """T (n_source, n_u) sparse: all dofs of the source, whose nodes may follow rigid frames."""
    if structure.turns is None or not nodes.rotations.all():
        # Nodes of solids have displacements alone; where beams and they meet, none follows.
        return sp.eye_array(nodes.n_dofs) if nodes.rotations.any() else structure.T
    by_kind = sp.vstack([structure.T, structure.turns], format="csr")
    first = 3 * np.arange(len(nodes.points))[:, None] + np.arange(3)
    return by_kind[np.hstack([first, first + 3 * len(nodes.points)]).ravel()]


def _followers(structure: Structure, nodes: Nodes) -> Iterator[Follower]:
    for name, frame in structure.frames.items():
        if frame.rigid:
            arms = nodes.points[frame.nodes] - frame.X
            yield Follower(nodes.displacements[frame.nodes], arms, structure.rows[name][3:])


def _lumped(
    structure: Structure,
    body: Body,
    frames: Mapping[str, Frame],
    selected: Callable[[Attachment], Frame],
) -> Iterator[Lumped]:
    for name, mass in body.masses.items():
        attachment = structure.masses[name]
        frame = selected(attachment) if mass.interface is None else frames[mass.interface]
        X = attachment.X - structure.rigid.center
        piece = Pieces(np.array([mass.mass]), np.array([mass.inertia]), X[None])
        yield Lumped(piece, frame)


def _times(matrix: Array, tensor: Array) -> Array:
    """matrix (n, k) times the first axis of a tensor (k, r, r)."""
    return np.asarray(np.tensordot(matrix, tensor, axes=1))


def _symmetric(tensor: Array) -> Array:
    """The mean over all orders of the axes, symmetric to the last bit."""
    orders = list(permutations(range(tensor.ndim)))
    # Sums of the same terms in another order round differently, so one order is written to all.
    mean = np.sum([tensor.transpose(order) for order in orders], axis=0) / len(orders)
    return np.asarray(mean[tuple(np.sort(np.indices(tensor.shape), axis=0))])
