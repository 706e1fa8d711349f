"""The coordinates of which interfaces, inertia and stiffness depend beyond the first order."""

from dataclasses import dataclass

import numpy as np

from ...superelement import Modes
from ...superelement.attachments import attachments
from ...superelement.validation import Array
from ..body.body import NonlinearCoordinates
from ..mesh.mesh import IntArray
from .statics import Stiffening

LOOKED_AT = 4  # lowest modes that are looked at for each that is asked for
MIN_KAPPA = 1e-2  # kappa, relative to the largest, from which on loads stiffen a shape
MAX_STIFFENING_TAKEN = 0.03  # of that by a load, which a soft shape takes with its stress


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Shapes Psi = Phi Y that are orthonormal in mass and orthogonal in stiffness.

    Y (m, n), the first `n_low` of which are modes; squares (n,): Y^T diag(omega^2) Y; kappa
    (candidates,): of all that were looked at, relative to the largest, most first; none where
    stress is unknown.
    """

    Y: Array
    squares: Array
    n_low: int
    kappa: Array

    @property
    def r(self) -> int:
        """The number of coordinates q: of modes, and two of each soft shape."""
        return 2 * len(self.squares) - self.n_low

    @property
    def by_stiffness(self) -> IntArray:
        """Where the projections by stiffness of all shapes stand in q."""
        return np.arange(len(self.squares))

    @property
    def by_mass(self) -> IntArray:
        """Where those by mass do, which are the same for modes."""
        return np.concatenate([np.arange(self.n_low), np.arange(len(self.squares), self.r)])

    def placed(self, A: Array, rows: IntArray) -> Array:
        """A (k, r, r) from A (k, n, n) of the shapes, in the rows and columns of a projection."""
        found = np.zeros((len(A), self.r, self.r))
        found[:, rows[:, None], rows] = A
        return found

    def projections(self, omega: Array) -> Array:
        """T (n_low + 2 n_soft, m), q = T eta: of the soft shapes by stiffness, then by mass.

        q_K = diag(squares)^-1 Y^T omega^2 eta,     q_M = Y^T eta
        """
        soft = self.Y[:, self.n_low :].T
        by_stiffness = soft * omega**2 / self.squares[self.n_low :, None]
        return np.vstack([self.Y[:, : self.n_low].T, by_stiffness, soft])


def choose(
    modes: Modes, asked: NonlinearCoordinates, loaded: IntArray, stiffening: Stiffening
) -> Coordinates:
    """The lowest modes, and soft combinations of the residual attachments of loaded dofs.

        Psi_a = (K^+ - Phi_low omega_low^-2 Phi_low^T) P_C^T
        G z = omega^2 M z,    G = P_C Psi_a,    M = Psi_a^T M Psi_a,    z^T M z = 1

    of those that loads stiffen: kappa from `MIN_KAPPA` of the largest on. A stiff one, as the
    stretch of a bar, would take its stress out of what stiffens the others; so would some of a body
    that is short or bent, of which `MAX_STIFFENING_TAKEN` is allowed, unless level 2 has the energy
    that gives it back. Source: docs/theory.md, Fast rotation.
    """
    unit = np.eye(len(modes.omega))
    order = np.argsort(modes.omega)[: LOOKED_AT * asked.modes]
    mode_kappa = stiffening.most(unit[:, order], modes.omega[order] ** 2)
    low = order[mode_kappa >= MIN_KAPPA * mode_kappa.max()][: asked.modes]
    Y, squares = unit[:, low], modes.omega[low] ** 2
    soft, soft_squares = attachments(modes, low, loaded)
    soft_kappa = stiffening.most(soft, soft_squares)
    kappa = np.sort(np.concatenate([mode_kappa, soft_kappa]))[::-1]
    kept = _most(soft_kappa, asked.soft, MIN_KAPPA * kappa[0])
    if asked.level == 1:
        kept = kept[
            stiffening.taken(soft[:, kept], soft_squares[kept], Y, squares) <= MAX_STIFFENING_TAKEN
        ]
    # By frequency again: those that were asked for came by how much they stiffen.
    kept = np.sort(kept)
    return _coordinates(modes, low, soft[:, kept], soft_squares[kept], kappa / kappa[0])


def lowest(modes: Modes, asked: NonlinearCoordinates, loaded: IntArray) -> Coordinates:
    """The lowest modes, and as many of the softest attachments as are asked for; "auto" means none.

    For bodies whose stress is unknown.
    """
    low = np.argsort(modes.omega)[: asked.modes]
    soft, squares = attachments(modes, low, loaded)
    n = 0 if asked.soft == "auto" else asked.soft
    return _coordinates(modes, low, soft[:, :n], squares[:n], np.zeros(0))


def _coordinates(
    modes: Modes, low: IntArray, soft: Array, squares: Array, kappa: Array
) -> Coordinates:
    """Of modes `low` and soft shapes (m, n_soft) with their squares (n_soft,)."""
    return Coordinates(
        np.hstack([np.eye(len(modes.omega))[:, low], soft]),
        np.concatenate([modes.omega[low] ** 2, squares]),
        len(low),
        kappa,
    )


def _most(kappa: Array, asked: int | str, least: float) -> IntArray:
    """Those with the largest kappa: as many as are asked for, or from `least` on."""
    if asked == "auto":
        return np.flatnonzero(kappa >= least)
    return np.argsort(-kappa, kind="stable")[: int(asked)]
