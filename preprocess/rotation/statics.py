"""Fields at rest under loads on interfaces and loads of rotation, and what their stress does."""

from dataclasses import dataclass

import numpy as np

from ...superelement.validation import Array
from ..assembly.second_order import SecondOrder
from ..assembly.structure import Structure
from ..responses.shapes import Shapes
from ..responses.static import static_shapes

MIN_LOAD_EIGENVALUE = 1e-12
"""Eigenvalue of the scaled energies of loads below which one is a sum of others."""
SPIN_WEIGHTS = np.diag([1.0, 1.0, 1.0, np.sqrt(2.0), np.sqrt(2.0), np.sqrt(2.0)])
"""s(omega) = 1/2 SPIN_WEIGHTS (omega omega^T): each entry off the diagonal stands for two."""
MIN_KIND_STIFFENING = 1e-2  # relative to the other kind of loads, from which on it counts


@dataclass(frozen=True, eq=False)
class Statics:
    """u = P K^+ P^T f (n_u, n_c + 6) under unit loads f = [P_C^T, F] (n_u, n_c + 6).

    interfaces (n_c, k): their loads that store an energy of 1/2 each, and none of two together;
    rotation (6, 6): omega omega^T, so that the softest of it stores 1/2. Sums over squares of
    either are the same in any axes.
    """

    f: Array
    u: Array
    interfaces: Array
    rotation: Array

    def by_kind(self, numbers: Array) -> tuple[Array, Array]:
        """Numbers (n_c + 6, n) of the loads f, of loads of unit energy instead (k, n), (6, n)."""
        n_c = len(self.interfaces)
        return self.interfaces.T @ numbers[:n_c], self.rotation.T @ numbers[n_c:]


@dataclass(frozen=True, eq=False)
class Stiffening:
    """How stress stiffens shapes Psi = Phi Y, Y (m, n), of squared frequencies (n,)."""

    fields: Statics
    second: SecondOrder
    shapes: Shapes

    def most(self, Y: Array, squares: Array) -> Array:
        """kappa (n,) [1/sqrt(J)], the most by which loads change the stiffness of a shape:

            kappa_k = max |D3(u; psi_k, psi_k)| / (omega_k^2 sqrt(u^T K u))

        over all loads on interfaces, u = sum_c a_c u_c, and those of rotation, which come together.
        Relative to the energy that they store, so that forces, moments and rotation compare.
        """
        if len(squares) == 0:
            return np.zeros(0)
        D3 = self.second.third(self.fields.u, self.shapes.combined(Y))
        diagonal = np.diagonal(D3, axis1=1, axis2=2) / squares
        kinds = self.fields.by_kind(diagonal)
        return np.asarray(np.max([np.linalg.norm(kind, axis=0) for kind in kinds], axis=0))

    def taken(self, Y: Array, squares: Array, Y_low: Array, low_squares: Array) -> Array:
        """The part (n,) of what loads stiffen the lowest modes that each shape would take.

            max_c |psi^T f_c D3(psi; low, low)| / omega^2  over  max_c |D3(u_c; low, low)|

        of loads as in `most`, with u_c without the modes: the stress of a load that a coordinate
        carries is not among those that stiffen.
        """
        if len(squares) == 0:
            return np.zeros(0)
        Psi, low = self.shapes.combined(Y), self.shapes.combined(Y_low)
        f, weights = self.fields.f, np.sqrt(np.outer(low_squares, low_squares))
        u = self.fields.u - low @ ((low.T @ f) / low_squares[:, None])
        stiffened = (self.second.third(u, low) / weights).reshape(f.shape[1], -1)
        by_shapes = np.linalg.norm(self.second.third(Psi, low) / weights, axis=(1, 2))
        whole = [np.linalg.norm(kind, 2) for kind in self.fields.by_kind(stiffened)]
        carried = [
            np.linalg.norm(kind, axis=0) * by_shapes
            for kind in self.fields.by_kind(f.T @ Psi / squares)
        ]
        kinds = zip(carried, np.maximum(whole, MIN_KIND_STIFFENING * max(whole)), strict=True)
        return np.asarray(np.max([part / total for part, total in kinds], axis=0))


def statics(structure: Structure) -> Statics:
    """The fields of a structure with loads of rotation."""
    f = np.hstack([structure.loads, structure.inertia_loads])
    u = static_shapes(structure)
    n_c = structure.P_C.shape[0]
    energy = f.T @ u
    rotation = SPIN_WEIGHTS @ energy[n_c:, n_c:] @ SPIN_WEIGHTS
    softest = np.linalg.eigvalsh(0.5 * (rotation + rotation.T))[-1]
    return Statics(f, u, _orthonormal(energy[:n_c, :n_c]), SPIN_WEIGHTS / np.sqrt(softest))


def _orthonormal(energy: Array) -> Array:
    """Sums (n, k) of loads whose energies (n, n) are then the unit matrix."""
    tiny = np.finfo(float).tiny
    scale = 1.0 / np.sqrt(np.maximum(np.diag(energy), tiny))
    scaled = scale[:, None] * energy * scale
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    kept = values > MIN_LOAD_EIGENVALUE * values[-1]
    return np.asarray(scale[:, None] * vectors[:, kept] / np.sqrt(values[kept]))
