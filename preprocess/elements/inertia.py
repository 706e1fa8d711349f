"""Inertia and angular momentum of what moves with a body, to second order in its motion.

Symmetric matrices are vectors in the order 11, 22, 33, 23, 13, 12. Positions are from the center of
mass. Columns k, l of displacements u and rotations w are motions psi_k, psi_l; rotations are
rotation vectors.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...superelement.validation import Array
from ..body.material import STRESS_ORDER
from ..errors import BodyError
from ..mesh.mesh import IntArray

LEVI_CIVITA = np.zeros((3, 3, 3))  # (a x b)_i = LEVI_CIVITA_ijk a_j b_k
for _i in range(3):
    LEVI_CIVITA[_i, _i - 2, _i - 1], LEVI_CIVITA[_i, _i - 1, _i - 2] = 1.0, -1.0


Moved = tuple[IntArray, Array]
"""dofs (s, 3) of nodes, and second derivatives (s, 3, r, r) of their displacements."""


def vector_of(tensors: Array) -> Array:
    """The six numbers (6, ...) of symmetric matrices (3, 3, ...)."""
    rows, columns = np.array(STRESS_ORDER).T
    return np.asarray(tensors[rows, columns])


def cross(a: Array, b: Array) -> Array:
    """Cross products along the first axis, all others broadcast."""
    (a0, a1, a2), (b0, b1, b2) = a, b
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


@dataclass(frozen=True, eq=False)
class Pieces:
    """Rigid pieces, sections of beams or lumped masses, that move by u and turn by exp(w).

    mass (p,) [kg]; inertia (p, 3, 3) [kg m^2], about their own centers; X (p, 3) [m].
    """

    mass: Array
    inertia: Array
    X: Array

    def changes(self) -> Array:
        """G (p, 6, 6): the first order change of the inertia is the sum of G [u; w].

        d1 = m (2 X.u I - X u^T - u X^T) + w~ j - j w~
        """
        moments = self.mass[:, None] * self.X
        moved = of_moments(moments)
        spun = np.einsum("ika,paj->ijpk", LEVI_CIVITA, self.inertia)
        turned = vector_of(spun + spun.swapaxes(0, 1))
        return np.concatenate([moved, turned], axis=2).transpose(1, 0, 2)

    def second(self, u: Array, w: Array) -> Array:
        """(6, r, r): the second derivative of the inertia by the motions u, w (3, p, r).

        d2 = m (u.u I - u u^T) + 1/2 w~w~ j + 1/2 j w~w~ - w~ j w~
        """
        moved = second_of_products(np.einsum("p,ipk,jpl->ijkl", self.mass, u, u, optimize=True))
        return moved + vector_of(self._turned(w))

    def _turned(self, w: Array) -> Array:
        """The part (3, 3, r, r) of the second derivative that comes from rotations."""
        W = np.einsum("iba,bpk->piak", LEVI_CIVITA, w)
        Wj = np.einsum("pabl,pbj->pajl", W, self.inertia)
        jW = np.einsum("pab,pbjl->pajl", self.inertia, W)
        twice = np.einsum("piak,pajl->ijkl", W, Wj, optimize=True)
        around = np.einsum("piak,pajl->ijkl", W, jW, optimize=True)
        half = 0.5 * (twice + twice.swapaxes(0, 1)) - around
        return np.asarray(half + half.swapaxes(2, 3))

    def momentum(self, u: Array, w: Array) -> Array:
        """h (3, r, r): the angular momentum h(q, q') of motions u, w (3, p, r).

        m u x u' + w x j w' - 1/2 j (w x w')
        """
        jw = np.einsum("pij,jpk->ipk", self.inertia, w)
        path = np.einsum("iab,p,apk,bpl->ikl", LEVI_CIVITA, self.mass, u, u, optimize=True)
        spin = np.einsum("iab,apk,bpl->ikl", LEVI_CIVITA, w, jw, optimize=True)
        drift = np.einsum("pij,jab,apk,bpl->ikl", self.inertia, LEVI_CIVITA, w, w, optimize=True)
        return np.asarray(path + spin - 0.5 * drift)


def of_moments(moments: Array) -> Array:
    """(6, p, 3): change of the inertia by displacements of points with the moments m X (p, 3).

    d1 = 2 X.u I - X u^T - u X^T, times m
    """
    one_sided = np.einsum("pi,jk->ijpk", moments, np.eye(3))
    traces = np.einsum("pk,ij->ijpk", 2.0 * moments, np.eye(3))
    return vector_of(traces - one_sided - one_sided.swapaxes(0, 1))


def second_of_products(products: Array) -> Array:
    """(6, r, r): second derivative of the inertia from the sums (3, 3, r, r) of m u_ik u_jl.

    d2 = m (u.u I - u u^T)
    """
    traces = np.einsum("iikl,ab->abkl", products, np.eye(3))
    tensors = traces - products
    return vector_of(tensors + tensors.transpose(1, 0, 2, 3))


@dataclass(frozen=True, eq=False)
class NodalTensors:
    """The inertia of nodes with mass M_s (x) I_3 at X (n, 3) [m] from the center of mass, exactly.

    Motions (3 n, r). `name`: that of the file, for messages.
    """

    strain_energy: ClassVar[bool] = False

    name: str
    M: Any
    X: Array

    def inertia_loads(self) -> Array:
        """F (3 n, 6): the first order change of the inertia is F^T u."""
        return of_moments(np.asarray(self.M @ self.X)).transpose(1, 2, 0).reshape(-1, 6)

    def inertia(self, motions: Array) -> Array:
        """Q (6, r, r): the second derivative of the inertia by motions."""
        return second_of_products(self._products(motions))

    def gyroscopic(self, motions: Array) -> Array:
        """h (3, r, r): the angular momentum h(q, q') of motions."""
        return np.asarray(np.einsum("iab,abkl->ikl", LEVI_CIVITA, self._products(motions)))

    def third(self, u: Array, motions: Array) -> Array:
        """`BodyError`: masses have no strain energy."""
        raise self._no_elements()

    def quartic(self, motions: Array, moved: Moved | None) -> tuple[Array, Array]:
        """`BodyError`: masses have no strain energy."""
        raise self._no_elements()

    def _no_elements(self) -> BodyError:
        return BodyError(
            f"{self.name}: matrices do not tell how loads stiffen a body: expected a mesh"
        )

    def _products(self, motions: Array) -> Array:
        """u_ik^T M_s u_jl (3, 3, r, r)."""
        n, r = self.X.shape[0], motions.shape[1]
        u = motions.reshape(n, 3 * r)
        products = (u.T @ (self.M @ u)).reshape(3, r, 3, r)
        return np.asarray(products.transpose(0, 2, 1, 3))


def scalar_mass(M: Any) -> Any | None:
    """M_s (n, n) of a mass matrix M = M_s (x) I_3, sparse; None of another one."""
    M = M.tocsr()
    M_s = M[0::3, 0::3]
    parts = [[M[i::3, j::3] for j in range(3)] for i in range(3)]
    # Lumped masses with arms, or dofs in local axes, couple directions.
    off = max(abs(parts[i][j]).max() for i in range(3) for j in range(3) if i != j)
    apart = max(abs(parts[i][i] - M_s).max() for i in range(3))
    return M_s if max(off, apart) <= 1e-10 * abs(M_s).max() else None


def pairs(r: int) -> IntArray:
    """The number (r, r) of the pair of two motions."""
    numbers = np.zeros((r, r), dtype=np.int64)
    rows, columns = np.triu_indices(r)
    numbers[rows, columns] = numbers[columns, rows] = np.arange(len(rows))
    return numbers
