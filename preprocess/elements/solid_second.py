"""Second order of solids: strain energy to fourth order, inertia to second, of St. Venant and
Kirchhoff's material.

Pairs of motions count in the order of numpy's triu_indices, for all is symmetric in them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...superelement.validation import Array
from ..body.material import STRESS_ORDER, Material
from ..mesh.mesh import IntArray, Mesh
from .assumed import STRESS_NUMBER, Strained, assumed
from .inertia import Moved, NodalTensors

PRODUCT_BATCH = 2**18
"""Numbers in the products of gradients of a batch of elements, so that they stay in the cache."""


@dataclass(frozen=True, eq=False)
class SolidTensors(NodalTensors):
    """The inertia and the strain energy of solids of St. Venant and Kirchhoff's material.

    `owners` (n_elements,) is the number of each element's material in `materials`.
    """

    strain_energy: ClassVar[bool] = True

    mesh: Mesh
    materials: Sequence[Material]
    owners: IntArray

    def third(self, u: Array, motions: Array) -> Array:
        """D3(u; psi_k, psi_l) (k, r, r): the third derivative of the strain energy.

            D3(a; b, c) = int sigma(a):grad b^T grad c + sigma(b):grad a^T grad c
                            + sigma(c):grad a^T grad b dV,    sigma(a) = C:sym grad a

        r^2 numbers of each pair of nodes and direction of `u`, whatever the points of integration.
        """
        r, columns = motions.shape[1], u.shape[1] + motions.shape[1]
        total = np.zeros((u.shape[1], r, r))
        for part in self._batches(columns):
            a, b = part.moved(u), part.moved(motions)
            G = part.geometric(np.concatenate([b, a], axis=3))
            total += _works(G[:, r:], b, b)
            mixed = _works(G[:, :r], a, b).transpose(1, 0, 2)
            total += mixed + mixed.transpose(0, 2, 1)
        return total

    def quartic(self, motions: Array, moved: Moved | None) -> tuple[Array, Array]:
        """The energy of second order strains, and the loads of their stresses, by pairs.

            int e_kl.C e_mn dV (pairs, pairs),   Q (3 n, pairs): Q_kl^T u = int sigma(u).e_kl dV

        e_kl = sym(grad psi_k^T grad psi_l + grad u_kl), u_kl what `moved` says of some nodes.
        """
        first, second = np.triu_indices(motions.shape[1])
        energy, loads = np.zeros((len(first),) * 2), np.zeros((len(motions), len(first)))
        row, table = (None, None) if moved is None else _table(moved, len(motions))
        for part in self._batches(len(first)):
            H = part.gradients(part.moved(motions))
            strain = _second_strains(H[..., first], H[..., second])
            if row is not None and table is not None:
                strain += _strains(part.gradients(part.held(table[row[part.dofs]])))
            strain = part.strained.with_projected_trace(strain)
            f, relaxed = part.loads(part.stresses(strain))
            energy += part.energy(strain) - relaxed
            np.add.at(loads, part.dofs.ravel(), f)
        return energy, loads

    def _batches(self, columns: int) -> Iterator["_Batch"]:
        """Some elements of one type and material at a time, for so many columns of strains."""
        for kind, cells in self.mesh.elements.items():
            for number, material in enumerate(self.materials):
                strains, C = assumed(kind, material), material.elasticity
                rows_of = np.flatnonzero(self.mesh.of_kind(self.owners, kind) == number)
                per_point = 9 * columns + 6 * strains.columns**2
                size = max(1, PRODUCT_BATCH // (per_point * len(strains.weights)))
                for start in range(0, len(rows_of), size):
                    nodes = cells[rows_of[start : start + size]]
                    strained = strains.on(self.mesh.points[nodes], C)
                    yield _Batch(3 * nodes[:, :, None] + np.arange(3), strained)


@dataclass(frozen=True, eq=False)
class _Batch:
    """Elements of one type and material.

    dofs (n, k, 3) of their nodes. Displacements (n, k + m, 3, r) of nodes and incompatible modes;
    gradients (n, 3, q, 3, r): du_i/dx_m at [:, m, :, i]; strains (6, n, q, r) in the order of
    `STRESS_ORDER`, and stresses (n, 3, q, 3, r) placed as gradients.
    """

    dofs: IntArray
    strained: Strained

    @property
    def dN(self) -> Array:
        return self.strained.dN

    @property
    def dV(self) -> Array:
        return self.strained.dV

    @property
    def C(self) -> Array:
        return self.strained.C

    def moved(self, u: Array) -> Array:
        """Displacements of nodes, and of the modes that they bring about, of u (3 n, r)."""
        of_nodes = u[self.dofs]
        if self.strained.assumed.modes is None:
            return of_nodes
        n, k, _, r = of_nodes.shape
        of_modes = self.strained.condensation @ of_nodes.reshape(n, 3 * k, r)
        return np.concatenate([of_nodes, of_modes.reshape(n, -1, 3, r)], axis=1)

    def held(self, of_nodes: Array) -> Array:
        """Displacements of nodes (n, k, 3, r) alone."""
        n, k, _, r = of_nodes.shape
        return np.concatenate([of_nodes, np.zeros((n, self.dN.shape[1] - k, 3, r))], axis=1)

    def gradients(self, u: Array) -> Array:
        """Gradients of displacements (n, k, 3, r) of the nodes."""
        n, k, _, r = u.shape
        q = self.dV.shape[1]
        slopes = self.dN.reshape(n, k, 3 * q).transpose(0, 2, 1) @ u.reshape(n, k, 3 * r)
        return slopes.reshape(n, 3, q, 3, r)

    def geometric(self, u: Array) -> Array:
        """int grad N.sigma(u) grad N^T dV (n, r, k, k): what the stress of u (n, k, 3, r) makes."""
        n, k, _, r = u.shape
        strains = self.strained.with_projected_trace(_strains(self.gradients(u)))
        sigma = self._stress(strains).swapaxes(0, 1)
        slopes = self.dN[:, :, None], (self.dN * self.dV[:, None, None])[:, None]
        products = [_symmetric(*slopes, i, j) for i, j in STRESS_ORDER]
        G = np.stack(products, axis=3).reshape(n, k * k, -1) @ sigma.reshape(n, -1, r)
        return np.ascontiguousarray(G.swapaxes(1, 2)).reshape(n, r, k, k)

    def stresses(self, strains: Array) -> Array:
        return np.asarray(self._stress(strains)[STRESS_NUMBER].transpose(2, 0, 3, 1, 4))

    def _stress(self, strains: Array) -> Array:
        """The stresses (6, n, q, r) that do work on strains, of strains with projected trace."""
        sigma = (self.C @ strains.reshape(6, -1)).reshape(strains.shape)
        return self.strained.with_projected_trace(sigma)

    def loads(self, stresses: Array) -> tuple[Array, Array]:
        """int stress.grad N dV (3 n k, r) on the dofs of every element.

        And f^T K^-1 f (r, r) of the loads f on incompatible modes, which give way to them.
        """
        n, _, q, _, r = stresses.shape
        weighted = (self.dN * self.dV[:, None, None]).reshape(n, -1, 3 * q)
        f = (weighted @ stresses.reshape(n, 3 * q, 3 * r)).reshape(n, -1, r)
        k = self.strained.n_nodal
        if f.shape[1] == k:
            return f.reshape(-1, r), np.zeros((r, r))
        of_modes = f[:, k:]
        gave_way = np.linalg.solve(self.strained.full_stiffness[:, k:, k:], of_modes)
        relaxed = of_modes.reshape(-1, r).T @ gave_way.reshape(-1, r)
        condensed = f[:, :k] + self.strained.condensation.transpose(0, 2, 1) @ of_modes
        return condensed.reshape(-1, r), relaxed

    def energy(self, strains: Array) -> Array:
        """int e_k.C e_l dV (r, r)."""
        weighted = (strains * self.dV[..., None]).reshape(6, -1)
        stress = (self.C @ weighted).reshape(-1, strains.shape[-1])
        return np.asarray(strains.reshape(stress.shape).T @ stress)


def _strains(H: Array) -> Array:
    """Strains of gradients, shear strains twice the tensor's."""
    rows = [H[:, m, :, i] if m == i else H[:, m, :, i] + H[:, i, :, m] for m, i in STRESS_ORDER]
    return np.stack(rows)


def _second_strains(a: Array, b: Array) -> Array:
    """sym(grad a^T grad b) as strains, column by column."""
    rows = []
    for m, n in STRESS_ORDER:
        product = _product(a, b, m, n)
        rows.append(product if m == n else product + _product(b, a, m, n))
    return np.stack(rows)


def _product(a: Array, b: Array, m: int, n: int) -> Array:
    return np.asarray(np.einsum("eqip,eqip->eqp", a[:, m], b[:, n]))


def _symmetric(a: Array, b: Array, i: int, j: int) -> Array:
    """a_i b_j, for i /= j with a_j b_i."""
    product = a[..., i, :] * b[..., j, :]
    return product if i == j else product + a[..., j, :] * b[..., i, :]


def _works(geometric: Array, left: Array, right: Array) -> Array:
    """left^T G right (r_G, r_left, r_right) of G (n, r_G, k, k) and displacements (n, k, 3, r)."""
    n, k, _, r = right.shape
    pulled = geometric @ right.reshape(n, 1, k, 3 * r)
    rows = pulled.reshape(n, -1, 3 * k, r).transpose(1, 0, 2, 3).reshape(-1, 3 * n * k, r)
    return left.reshape(3 * n * k, -1).T @ rows


def _table(moved: Moved, n_dofs: int) -> tuple[IntArray, Array]:
    """What `moved` says by pairs (n_rows, pairs), then zeros, and the row of each dof (n_dofs,)."""
    dofs, values = moved
    first, second = np.triu_indices(values.shape[-1])
    row = np.full(n_dofs, dofs.size)
    row[dofs.ravel()] = np.arange(dofs.size)
    rows = values[..., first, second].reshape(-1, len(first))
    return row, np.vstack([rows, np.zeros((1, len(first)))])
