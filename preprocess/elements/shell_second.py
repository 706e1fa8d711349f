"""Second order of shells: strain energy to third order, inertia to second, in the dofs of nodes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NoReturn

import numpy as np

from ...superelement.validation import Array
from ..errors import BodyError
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import node_dofs
from .inertia import LEVI_CIVITA, of_moments, second_of_products
from .laminate import Laminate
from .shell import Shells, SurfaceFrames
from .shell_matrices import DRILLING_FACTOR, nodal_strains, shell_batches

GEOMETRIC_BATCH = 2**22  # numbers in the geometric stiffnesses of a batch of elements


@dataclass(frozen=True, eq=False)
class ShellTensors:
    """Shells with laminates; motions (6 n, r) are columns on the six dofs of each node.

    Directors turn by the rotation vector w of their node, d -> exp(w~) d, so that a point is at
    x + u + z (exp(w~) d), interpolated. Strains are Green's along the surface, assumed as the first
    order ones are; what is internal of an element adds to them linearly. center (3,): of mass [m].
    """

    strain_energy: ClassVar[bool] = True

    mesh: Mesh
    shells: Mapping[str, Shells]
    laminates: Sequence[Laminate]
    owners: IntArray
    center: Array

    @property
    def n_dofs(self) -> int:
        return 6 * len(self.mesh.points)

    def inertia_loads(self) -> Array:
        """F (6 n, 6): the first order change of the inertia is F^T u."""
        F = np.zeros((self.n_dofs, 6))
        for piece in self._pieces():
            by_points = of_moments(piece.moments.reshape(-1, 3)).reshape(6, *piece.moments.shape)
            loads = np.einsum("jnpi,npic->ncj", by_points, piece.rows, optimize=True)
            np.add.at(F, piece.dofs, loads)
        return F

    def inertia(self, motions: Array) -> Array:
        """Q (6, r, r): the second derivative of the inertia by motions."""
        r = motions.shape[1]
        products, second = np.zeros((3, 3, r, r)), np.zeros((6, r, r))
        for piece in self._pieces():
            y = piece.rows @ motions[piece.dofs][:, None]
            products += np.einsum("np,npik,npjl->ijkl", piece.mass, y, y, optimize=True)
            # 2 X.y I - X y^T - y X^T of the second order of directors, node by node.
            for j, v in enumerate(piece.pulled()):
                second[j] += _worked(v, piece.d, motions, piece.turning)
        return second_of_products(products) + second

    def gyroscopic(self, motions: Array) -> Array:
        """h (3, r, r): the angular momentum h(q, q') of motions."""
        r = motions.shape[1]
        h = np.zeros((3, r, r))
        for piece in self._pieces():
            y = piece.rows @ motions[piece.dofs][:, None]
            products = np.einsum("np,npak,npbl->abkl", piece.mass, y, y, optimize=True)
            h += np.einsum("iab,abkl->ikl", LEVI_CIVITA, products)
            # X x y of the second order of directors: along i it is (e_i x X) . y
            for i in range(3):
                across = np.cross(np.eye(3)[i], piece.moments)
                v = np.einsum("npi,pk->nki", piece.heights[..., None] * across, piece.N)
                h[i] += _worked(v, piece.d, motions, piece.turning)
        return h

    def third(self, u: Array, motions: Array) -> Array:
        """D3(u; psi_k, psi_l) (k, r, r): the third derivative of the strain energy.

            D3(a; b, c) = int S(a).E2(b, c) + S(b).E2(a, c) + S(c).E2(a, b) dA

        with the forces S of the first order strains and the second derivative E2 of Green's, which
        no rotation of the whole element changes: the energy of a turned body is exactly what it
        was.
        """
        r = motions.shape[1]
        total = np.zeros((u.shape[1], r, r))
        for batch in self._batches(r + u.shape[1]):
            a, b = u[batch.dofs], motions[batch.dofs]
            G = batch.geometric(np.concatenate([b, a], axis=2))
            total += _works(G[:, r:], b, b)
            mixed = _works(G[:, :r], a, b).transpose(1, 0, 2)
            total += mixed + mixed.transpose(0, 2, 1)
        return total

    def quartic(self, motions: Array, moved: Any) -> NoReturn:
        """`BodyError`: the squares of the slopes of shells would lock against their stretch."""
        raise BodyError("shells: expected solids for the strain energy of fourth order")

    def _batches(self, columns: int) -> Iterator["_Batch"]:
        for found in shell_batches(self.mesh, self.owners):
            cells = self.mesh.cells[found.kind][found.rows]
            size = max(1, GEOMETRIC_BATCH // (columns * (6 * cells.shape[1]) ** 2))
            for start in range(0, len(cells), size):
                some = slice(start, start + size)
                yield _Batch(
                    node_dofs(cells[some], 6),
                    self.shells[found.kind].some(found.rows[some]),
                    self.laminates[found.owner],
                )

    def _pieces(self) -> Iterator["_Piece"]:
        for batch in self._batches(1):
            yield _Piece.of(batch, self.center)


@dataclass(frozen=True, eq=False)
class _Piece:
    """The mass of some shells as points (n, p): two across the thickness, with its moments.

    mass (n, p) [kg], moments (n, p, 3): mass times position from the center; rows (n, p, 3, 6 k):
    their displacements; heights (n, p) over the nodes, N (p, k) and d (n, k, 3): what moves them to
    second order. turning (n, k, 3): the dofs of rotations.
    """

    dofs: IntArray
    mass: Array
    moments: Array
    rows: Array
    heights: Array
    N: Array
    d: Array

    @classmethod
    def of(cls, batch: "_Batch", center: Array) -> "_Piece":
        shells, xi = batch.shells, batch.shells.shape.xi
        dA = shells.frames(xi).areas * shells.shape.weights
        mass, moment, inertia = batch.laminate.inertia
        # Two points with half of the mass each have all three moments of the thickness.
        middle, radius = moment / mass, np.sqrt(inertia / mass - (moment / mass) ** 2)
        N, spun = shells.motion(xi)
        n, k = shells.X.shape[:2]
        x, d = np.einsum("qk,nki->nqi", N, shells.X), np.einsum("qk,nki->nqi", N, shells.d)
        rows, places, heights = [], [], []
        for z in (middle - radius, middle + radius):
            row = np.zeros((n, len(N), 3, k, 6))
            row[..., :3] = np.einsum("qk,ij->qikj", N, np.eye(3))
            row[..., 3:] = z * spun
            rows.append(row.reshape(n, len(N), 3, 6 * k))
            places.append(x + z * d - center)
            heights.append(np.full((n, len(N)), z))
        weight = np.tile(0.5 * mass * dA, (1, 2))
        return cls(
            batch.dofs,
            weight,
            weight[..., None] * np.concatenate(places, axis=1),
            np.concatenate(rows, axis=1),
            np.concatenate(heights, axis=1),
            np.tile(N, (2, 1)),
            shells.d,
        )

    @property
    def turning(self) -> IntArray:
        """The dofs (n, k, 3) of rotations."""
        return self.dofs.reshape(len(self.dofs), -1, 6)[:, :, 3:]

    def pulled(self) -> Array:
        """Vectors v (6, n, k, 3): the change of the inertia is v.y2 of directors at the nodes."""
        by_points = of_moments(self.moments.reshape(-1, 3)).reshape(6, *self.moments.shape)
        v = np.einsum("jnpi,np,pk->jnki", by_points, self.heights, self.N, optimize=True)
        return np.asarray(v)


def _worked(v: Array, d: Array, motions: Array, turning: IntArray) -> Array:
    """sum v.y2 (r, r), y2 = 1/2 (w_k x (w_l x d) + w_l x (w_k x d)), v and d (n, k, 3)."""
    w = motions[turning]
    return np.asarray(np.einsum("nkia,nkij,nkjb->ab", w, _turned_twice(v, d), w, optimize=True))


def _turned_twice(v: Array, d: Array) -> Array:
    """P (..., 3, 3): w^T P w' = 1/2 v.(w x (w' x d) + w' x (w x d)) = sym (w.d)(w'.v) - w.w' v.d"""
    product = v[..., :, None] * d[..., None, :]
    along = np.sum(v * d, axis=-1)[..., None, None]
    return np.asarray(0.5 * (product + np.swapaxes(product, -1, -2)) - along * np.eye(3))


@dataclass(frozen=True, eq=False)
class _Batch:
    """Shells of one type and laminate, and their dofs (n, 6 k)."""

    dofs: IntArray
    shells: Shells
    laminate: Laminate

    def geometric(self, motions: Array) -> Array:
        """G (n, r, 6 k, 6 k): b^T G c = S.E2(b, c) with the forces S of motions (n, 6 k, r)."""
        shells, shape = self.shells, self.shells.shape
        # With what is internal, whose forces belong to the stress of a motion.
        strains, at = nodal_strains(shells, self.laminate, shape.xi)
        dA = at.areas * shape.weights
        forces = self.laminate.stiffness @ (strains @ motions[:, None]) * dA[:, :, None, None]
        n, k = shells.X.shape[:2]
        G = np.zeros((n, motions.shape[2], k, 6, k, 6))
        # Forces that work on covariant strains.
        turned = np.swapaxes(at.in_plane, 2, 3)
        self._add_in_plane(G, turned @ forces[:, :, :3], turned @ forces[:, :, 3:6], at)
        self._add_shear(G, forces[:, :, 6:], at)
        drilling = shells.drilling(shape.xi, at).reshape(n, len(dA[0]), 6 * k)
        held = DRILLING_FACTOR * self.laminate.in_plane_shear * dA[..., None]
        self._add_drilling(G, held * (drilling @ motions), at)
        # The blocks below the diagonal are those above it.
        G[:, :, :, 3:, :, :3] = G[:, :, :, :3, :, 3:].transpose(0, 1, 4, 5, 2, 3)
        return G.reshape(n, motions.shape[2], 6 * k, 6 * k)

    def _spun(self) -> Array:
        """-d~ (n, k, 3, 3): w x d from w."""
        return np.asarray(np.einsum("imj,nkj->nkim", LEVI_CIVITA, self.shells.d))

    def _add_in_plane(self, G: Array, N: Array, M: Array, at: SurfaceFrames) -> None:
        """Of covariant forces N and moments M (n, q, 3, r).

        e_ab'' = sym u,a.u,b;   k_ab'' = sym (u,a.f,b + u,b.f,a) + A_a.d'',b
        """
        dN = self.shells.shape.dN(self.shells.shape.xi)
        pairs = np.stack(
            [
                np.einsum("iq,jq->qij", dN[:, 0], dN[:, 0]),
                np.einsum("iq,jq->qij", dN[:, 1], dN[:, 1]),
                np.einsum("iq,jq->qij", dN[:, 0], dN[:, 1])
                + np.einsum("iq,jq->qij", dN[:, 1], dN[:, 0]),
            ],
            axis=1,
        )
        stretched = np.einsum("nqmr,qmij->nrij", N, pairs, optimize=True)
        G[:, :, :, :3, :, :3] += stretched[:, :, :, None, :, None] * np.eye(3)[:, None, :]
        bent = np.einsum("nqmr,qmij->nrij", M, pairs, optimize=True)
        G[:, :, :, :3, :, 3:] += np.einsum("nrij,njab->nriajb", bent, self._spun(), optimize=True)
        first, second = dN[:, 0], dN[:, 1]
        v = np.einsum("nqr,jq,nqi->nrji", M[:, :, 0], first, at.a[:, :, 0], optimize=True)
        v += np.einsum("nqr,jq,nqi->nrji", M[:, :, 1], second, at.a[:, :, 1], optimize=True)
        v += np.einsum("nqr,jq,nqi->nrji", M[:, :, 2], second, at.a[:, :, 0], optimize=True)
        v += np.einsum("nqr,jq,nqi->nrji", M[:, :, 2], first, at.a[:, :, 1], optimize=True)
        self._add_directors(G, v)

    def _add_shear(self, G: Array, Q: Array, at: SurfaceFrames) -> None:
        """Of shear forces (n, q, 2, r): (2 e_at)'' = sym u,a.f + A_a.d'' at the ties."""
        shape = self.shells.shape
        weights = np.einsum("nqia,qapb->nqipb", at.turn, shape.weights_of_ties(shape.xi))
        s = np.einsum("nqipb,nqir->npbr", weights, Q, optimize=True)
        N, dN = shape.N(shape.ties), shape.dN(shape.ties)
        a = np.einsum("kap,nki->npai", dN, self.shells.X)
        mixed = np.einsum("npbr,ibp,jp->nrij", s, dN, N, optimize=True)
        G[:, :, :, :3, :, 3:] += np.einsum("nrij,njab->nriajb", mixed, self._spun(), optimize=True)
        self._add_directors(G, np.einsum("npbr,jp,npbi->nrji", s, N, a, optimize=True))

    def _add_directors(self, G: Array, v: Array) -> None:
        """Of vectors v (n, r, k, 3) that work on the second order of directors."""
        blocks = _turned_twice(v, self.shells.d[:, None])
        # Directors turn with their own node alone: nothing is off the diagonal.
        for node in range(blocks.shape[2]):
            G[:, :, node, 3:, node, 3:] += blocks[:, :, node]

    def _add_drilling(self, G: Array, s: Array, at: SurfaceFrames) -> None:
        """Of moments (n, q, r) on w.n - 1/2 (e_2.u,1 - e_1.u,2), whose axes turn with the nodes.

        -1/2 (u,1.(w x e_2) - u,2.(w x e_1)),   symmetric
        """
        shape = self.shells.shape
        along = np.einsum("nqia,kaq->nqik", at.turn, shape.dN(shape.xi))
        N = shape.N(shape.xi)
        spun = np.einsum("imj,nqaj->nqaim", LEVI_CIVITA, at.axes[:, :, :2])
        for axis, other, sign in ((0, 1, -0.5), (1, 0, 0.5)):
            G[:, :, :, :3, :, 3:] += sign * np.einsum(
                "nqr,nqi,jq,nqab->nriajb", s, along[:, :, axis], N, spun[:, :, other], optimize=True
            )


def _works(G: Array, left: Array, right: Array) -> Array:
    """left^T G right (r_G, r_left, r_right), summed over elements; G (n, r_G, c, c) symmetric."""
    if left.shape[2] > right.shape[2]:
        return _works(G, right, left).transpose(0, 2, 1)
    n, r, c, _ = G.shape
    # The side with fewer columns first: what it makes is all that is held at once.
    pulled = left.transpose(0, 2, 1)[:, None] @ G
    rows = np.ascontiguousarray(pulled.transpose(1, 2, 0, 3)).reshape(-1, n * c)
    return np.asarray(rows @ right.reshape(n * c, -1)).reshape(r, left.shape[2], -1)
