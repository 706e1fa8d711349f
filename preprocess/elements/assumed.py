"""Strains of solids that are richer than those of their nodes, so that the elements do not lock.

Two means, both within each element:

Incompatible modes. m further "nodes" move in each direction, with the gradients

    g_j = (det J_0 / det J) J_0^-T dM_j/dxi,    int dM_j/dxi dxi = 0,    J_0: J in the middle

so that constant stresses do no work on them, whatever the shape of the element. Nothing else
touches them, and so they are condensed: alpha = A u, A = -K_aa^-1 K_au.

Projected dilatation. The trace of the strain is replaced by its projection (weighted by the volume)
on the polynomials p of low order, so that few conditions are left where the volume cannot change:

    strain = e + 1 (p - tr e) / 3,    int (p - tr e) q dV = 0 for all such q

Sources: R. L. Taylor, P. J. Beresford, E. L. Wilson, International Journal for Numerical Methods in
Engineering 10 (1976) 1211-1219; J. C. Simo and M. S. Rifai, ibid. 29 (1990) 1595-1638; T. J. R.
Hughes, ibid. 15 (1980) 1413-1418; docs/theory.md, Solid elements.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from ...superelement.validation import Array
from ..body.material import STRESS_ORDER, Material
from ..mesh.cells import SOLID_TYPES, SolidType
from .element import SolidElement, cofactors, physical, points_of, reference


def _of_hexahedron(xi: Array) -> Array:
    return np.asarray(np.einsum("ij,iq->jiq", np.eye(3), 1.0 - 2.0 * xi))


def _of_wedge(xi: Array) -> Array:
    x, y, z, zero = xi[0] - 1.0 / 3.0, xi[1] - 1.0 / 3.0, 1.0 - 2.0 * xi[2], np.zeros_like(xi[0])
    return np.array([[x, zero, zero], [zero, y, zero], [y, x, zero], [zero, zero, z]])


def _of_tetrahedron(xi: Array) -> Array:
    x, y, z = xi
    last = 1.0 - x - y - z
    return np.array([[y * z * (last - x), x * z * (last - y), x * y * (last - z)]])


INCOMPATIBLE_MODES: dict[str, Callable[[Array], Array]] = {
    "hexahedron": _of_hexahedron,
    "wedge": _of_wedge,
    "tetrahedron": _of_tetrahedron,
}
"""Gradients dM/dxi (m, 3, q) of incompatible modes at points xi (3, q): of xi (1 - xi) along each
axis of a hexahedron and along that of a wedge, of xi^2 / 2, eta^2 / 2 and xi eta in its triangle,
less their means; and of the product of the four volume coordinates of a tetrahedron, a bubble that
vanishes on its faces.
"""


@dataclass(frozen=True, eq=False)
class Assumed:
    """What the strains of a type of solid are made of.

    element: its shapes; xi (3, q) and weights (q,): points of integration of the strain energy;
    modes: the gradients of its incompatible modes, None for none; terms: how many of 1,
    xi, eta, zeta its dilatation has, 0 for whatever nodes and modes make.
    """

    element: SolidElement
    xi: Array
    weights: Array
    modes: Callable[[Array], Array] | None
    terms: int

    @property
    def plain(self) -> bool:
        """Strains are those of the nodes."""
        return self.modes is None and not self.terms

    @property
    def columns(self) -> int:
        """Nodes and modes."""
        n_modes = 0 if self.modes is None else int(self.modes(self.xi).shape[0])
        return n_modes + int(self.element.nodes.shape[1])

    def gradients(self, xi: Array, X: Array) -> tuple[Array, Array]:
        """Gradients (n, k + m, 3, q) [1/m] of nodes and modes, and det J (n, q), at xi (3, q)."""
        dN = self.element.dN(xi)
        cof, det = cofactors(dN, X)
        of_nodes = physical(dN, cof, det)
        if self.modes is None:
            return of_nodes, det
        dM = self.modes(xi)
        middle = self.element.nodes.mean(axis=1)[:, None]
        cof_0, _ = cofactors(self.element.dN(middle), X)  # J_0^-T det J_0
        pulled = (cof_0[..., 0] @ dM.transpose(1, 0, 2).reshape(3, -1)).reshape(
            len(X), 3, *dM.shape[::2]
        )
        of_modes = pulled.transpose(0, 2, 1, 3) / det[:, None, None]
        return np.concatenate([of_nodes, of_modes], axis=1), det

    def on(self, X: Array, C: Array) -> "Strained":
        """The strains of elements with nodes X (n, k, 3) of a material of elasticity C (6, 6)."""
        return Strained(self, X, C)

    def polynomials(self, xi: Array) -> Array:
        """The terms (terms, q) of the dilatation."""
        return np.vstack([np.ones_like(xi[:1]), xi])[: self.terms]


@dataclass(frozen=True, eq=False)
class Strained:
    """Elements of one type and material: nodes X (n, k, 3), elasticity C (6, 6) [Pa]."""

    assumed: Assumed
    X: Array
    C: Array

    @property
    def n_nodal(self) -> int:
        """The dofs 3 k of the nodes."""
        return 3 * int(self.X.shape[1])

    @cached_property
    def _at_integration(self) -> tuple[Array, Array]:
        dN, det = self.assumed.gradients(self.assumed.xi, self.X)
        return dN, det * self.assumed.weights

    @property
    def dN(self) -> Array:
        """(n, k + m, 3, q) [1/m] of nodes and modes at points of integration."""
        return self._at_integration[0]

    @property
    def dV(self) -> Array:
        """(n, q) [m^3] at points of integration."""
        return self._at_integration[1]

    def projection(self, xi: Array) -> Array:
        """(n, s, q): the projection, at points xi (3, s), of values at points of integration."""
        terms = self.assumed.polynomials(self.assumed.xi)
        weighted = terms * self.dV[:, None]
        coefficients = np.linalg.solve(weighted @ terms.T, weighted)
        return np.asarray(self.assumed.polynomials(xi).T @ coefficients)

    @cached_property
    def projected(self) -> Array | None:
        """The projection (n, q, q) at the points of integration; None for dilatations as they are.

        It is self-adjoint under the weights dV.
        """
        return self.projection(self.assumed.xi) if self.assumed.terms else None

    def with_projected_trace(self, tensors: Array) -> Array:
        """Strains or stresses (6, n, q, r) with their trace t replaced: + 1 (P t - t) / 3.

        The stress that does work on strains e is this one of C times this one of e.
        """
        if self.projected is None:
            return tensors
        trace = tensors[:3].sum(axis=0)
        changed = tensors.copy()
        changed[:3] += (self.projected @ trace - trace) / 3.0
        return changed

    @cached_property
    def full_stiffness(self) -> Array:
        """(n, 3 (k + m), 3 (k + m)) of nodes and modes."""
        n, c, _, q = self.dN.shape
        B = self.dN.reshape(n, 3 * c, q)
        places = STRESS_NUMBER.ravel()
        tensor = self.C[places[:, None], places].reshape(3, 3, 3, 3)
        # The integrals of gradients know no material: each pair has nine, which C contracts.
        G = ((B * self.dV[:, None]) @ B.transpose(0, 2, 1)).reshape(n, c, 3, c, 3)
        pairs = G.transpose(0, 1, 3, 2, 4).reshape(-1, 9)
        K = (pairs @ tensor.transpose(1, 3, 0, 2).reshape(9, 9)).reshape(n, c, c, 3, 3)
        K = K.transpose(0, 1, 3, 2, 4).reshape(n, 3 * c, 3 * c)
        if self.projected is not None:
            # With r = tr e - p and s = 1.C 1: (e - 1 r / 3).C (e - 1 r / 3) is e.C e with
            # r y + y r, y = s r / 18 - 1.C e / 3.
            r = B - B @ self.projected.transpose(0, 2, 1)
            pressed = self.C[:, :3].sum(axis=1)
            work = (pressed[STRESS_NUMBER] @ self.dN).reshape(n, 3 * c, q)
            y = (pressed[:3].sum() / 18.0 * r - work / 3.0) * self.dV[:, None]
            product = r @ y.transpose(0, 2, 1)
            K = K + product + product.transpose(0, 2, 1)
        return np.asarray(K)

    @cached_property
    def condensation(self) -> Array:
        """A (n, 3 m, 3 k): the modes alpha = A u that nothing loads."""
        K, k = self.full_stiffness, self.n_nodal
        return np.asarray(-np.linalg.solve(K[:, k:, k:], K[:, k:, :k]))

    def stiffness(self) -> Array:
        """(n, 3 k, 3 k) of the nodes."""
        K, k = self.full_stiffness, self.n_nodal
        return np.asarray(K[:, :k, :k] + K[:, :k, k:] @ self.condensation)

    def strains(self, xi: Array) -> Array:
        """(n, 6, 3 k, s): strains at points xi (3, s) from displacements of the nodes."""
        dN, _ = self.assumed.gradients(xi, self.X)
        n, c, _, s = dN.shape
        by_axis = np.zeros((n, 6, c, 3, s))
        for row, (a, b) in enumerate(STRESS_ORDER):
            by_axis[:, row, :, a] += dN[:, :, b]
            if a != b:
                by_axis[:, row, :, b] += dN[:, :, a]
        rows = by_axis.reshape(n, 6, 3 * c, s)
        if self.assumed.terms:
            traces = self.dN.reshape(n, 3 * c, -1) @ self.projection(xi).transpose(0, 2, 1)
            rows[:, :3] += ((traces - dN.reshape(n, 3 * c, s)) / 3.0)[:, None]
        if 3 * c == self.n_nodal:
            return rows
        of_nodes, of_modes = rows[:, :, : self.n_nodal], rows[:, :, self.n_nodal :]
        return np.asarray(
            of_nodes + np.einsum("eixs,exk->eiks", of_modes, self.condensation, optimize=True)
        )


STRESS_NUMBER = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # of the stress ij in `STRESS_ORDER`


def assumed(kind: str, material: Material) -> Assumed:
    """The strains of a type of solid, by meshio's name, of a material."""
    return _assumed(SOLID_TYPES[kind], material.nearly_incompressible)


@cache
def _assumed(solid: SolidType, nearly_incompressible: bool) -> Assumed:
    element = reference(solid)
    if not (solid.locks or nearly_incompressible):
        return Assumed(element, element.xi, element.weights, None, 0)
    # Modes and nodes of corners hold strains that are linear, which these points integrate.
    xi, weights = points_of(solid, solid.sampling) if solid.locks else (element.xi, element.weights)
    modes = None if solid.modes is None else INCOMPATIBLE_MODES[solid.modes]
    return Assumed(element, xi, weights, modes, solid.terms)
