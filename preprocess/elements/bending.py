"""How much too stiff the elements of a mesh are in bending."""

from collections.abc import Sequence

import numpy as np

from ...superelement.validation import Array
from ..body.material import STRESS_ORDER, Material
from ..mesh.mesh import IntArray, Mesh
from .assumed import assumed
from .batches import batched
from .element import cofactors, solid_element

CORNER_NODE_SOLIDS = ("tetra", "hexahedron", "wedge")
"""Solids with nodes at their corners alone; others hold pure bending exactly."""
LOOKED_AT = 4096  # elements of a type that are looked at, evenly over the mesh
BENDING_BATCH_ELEMENTS = 512


def bending_excess(mesh: Mesh, materials: Sequence[Material], owners: IntArray) -> float:
    """The energy of pure bending that is forced on the nodes, over the exact one; 1 or more.

    The body is bent about each of the two principal axes of its nodes that are across the longest,
    and the larger ratio counts. With a stretch zeta s, s the strains under a stress along the body
    and zeta the place along d, across it,

        u = zeta s X - d X.s X / 2,    W = int zeta^2 s.C s dV / 2

    Slender bodies that bend under a force sag by some 1 / ratio of what they should, within a few
    hundredths in bars of tetrahedra and wedges. `owners` (n_elements,) is the number of each
    element's material in `materials`.
    """
    X = mesh.points - mesh.points.mean(axis=0)
    axes = np.linalg.eigh(X.T @ X)[1].T
    s = _stretched(materials[int(np.bincount(owners).argmax())], axes[2])
    energies = np.zeros((2, 2))
    for kind in mesh.elements:
        # One type that holds bending is enough: neighbors of it could not mix with the others.
        if kind not in CORNER_NODE_SOLIDS:
            return 1.0
        of_kind = mesh.of_kind(owners, kind)
        looked_at = np.unique(np.linspace(0, len(of_kind) - 1, LOOKED_AT).astype(np.int64))
        for owner, some in batched(of_kind[looked_at], BENDING_BATCH_ELEMENTS):
            cells = mesh.cells[kind][looked_at[some]]
            for row, d in enumerate(axes[:2]):
                energies[row] += _energies(kind, X[cells], materials[owner], s, d)
    found, exact = energies.T
    return float(np.max(found / exact))


def _stretched(material: Material, along: Array) -> Array:
    """Strains (3, 3) of a material under a stress along a direction, 1 along it."""
    i, j = np.array(STRESS_ORDER).T
    six = np.linalg.solve(material.elasticity, along[i] * along[j])
    strains = np.zeros((3, 3))
    strains[i, j] = strains[j, i] = np.where(i == j, six, 0.5 * six)
    return np.asarray(strains / (along @ strains @ along))


def _energies(kind: str, X: Array, material: Material, s: Array, d: Array) -> Array:
    """Of elements with nodes X (n, k, 3): the energy of bent nodes, and that of bending."""
    u = (X @ d)[..., None] * (X @ s) - 0.5 * d * np.einsum("eki,ij,ekj->ek", X, s, X)[..., None]
    K = assumed(kind, material).on(X, material.elasticity).stiffness()
    bent = u.reshape(len(X), -1, 1)
    element = solid_element(kind)
    zeta = np.einsum("eki,i,kq->eq", X, d, element.N(element.xi))
    volumes = cofactors(element.dN(element.xi), X)[1] * element.weights
    density = np.einsum("ij,ijkl,kl", s, material.elasticity_tensor, s)
    return np.array([np.sum(bent * (K @ bent)), density * np.sum(zeta**2 * volumes)])
