"""Stiffness and mass of solids, summed over batches of elements."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from ...superelement.validation import Array
from ..body.material import Material
from ..errors import MeshError
from ..mesh.mesh import IntArray, Mesh
from ..threads import in_order
from .assembly_map import pattern
from .assumed import assumed
from .batches import batched
from .element import cofactors, physical, solid_element

MIN_RELATIVE_JACOBIAN = 1e-10
"""The Jacobian of an element, relative to the cube of its diameter, below which it counts as
degenerate.
"""
GRADIENT_BATCH = 2**17  # numbers of a batch of elements, so that they stay in the cache


def solid_matrices(mesh: Mesh, materials: Sequence[Material], owners: IntArray) -> tuple[Any, Any]:
    """Stiffness and consistent mass (3 n, 3 n), sparse, symmetric to the last bit.

    Every point has three displacements [m].

        K_(ia)(jb) = C_acbd int N_i,c N_j,d dV        M_(ia)(jb) = rho delta_ab int N_i N_j dV

    `owners` (n_elements,) is the number of each element's material in `materials`. Elements are
    isoparametric, so that curved ones keep their geometry. They must be such as `check_jacobians`
    lets pass.
    """
    blocks = pattern(mesh.elements, len(mesh.points))
    K, M = np.zeros((blocks.n_blocks, 3, 3)), np.zeros((blocks.n_blocks, 1, 1))

    def of_batch(batch: _Batch) -> tuple[IntArray, Array, IntArray, Array]:
        cells = mesh.cells[batch.kind][batch.rows]
        stiffness, mass = _element_matrices(batch.kind, mesh.points[cells], materials[batch.owner])
        return blocks.entries(cells, 3), stiffness, blocks.entries(cells, 1), mass

    for at, stiffness, at_scalar, mass in in_order(of_batch, _batches(mesh, owners)):
        np.add.at(K.reshape(-1), at, stiffness)
        np.add.at(M.reshape(-1), at_scalar, mass)
    K = blocks.matrix(K)  # and no longer its sums
    return K, blocks.matrix(M, copies=3)


class _Batch(NamedTuple):
    """Elements of one type, by their rows (n,), and the number of their material."""

    kind: str
    owner: int
    rows: IntArray


def _batches(mesh: Mesh, owners: IntArray) -> Iterator[_Batch]:
    for kind in mesh.elements:
        element = solid_element(kind)
        size = max(1, GRADIENT_BATCH // (3 * len(element.order) * len(element.weights)))
        for owner, rows in batched(mesh.of_kind(owners, kind), size):
            yield _Batch(kind, owner, rows)


def _element_matrices(kind: str, X: Array, material: Material) -> tuple[Array, Array]:
    """Blocks of the stiffness (pairs, n, 3, 3) and factors of I in those of the mass (pairs, n).

    Of elements with nodes X (n, k, 3); both are flat.
    """
    element, strains = solid_element(kind), assumed(kind, material)
    k, q = len(element.order), len(element.weights)
    N, dN = element.N(element.xi), element.dN(element.xi)
    i, j = np.triu_indices(k)
    NN = N[i] * N[j] * element.weights  # (pairs, q)
    cof, det = cofactors(dN, X)
    mass = (material.rho * (NN @ det.T)).ravel()
    if not strains.plain:
        K = strains.on(X, material.elasticity).stiffness().reshape(-1, k, 3, k, 3)
        return K[:, i, :, j].ravel(), mass
    C = material.elasticity_tensor.transpose(1, 3, 0, 2).reshape(9, 9)
    B = physical(dN, cof, det).reshape(len(X), 3 * k, q)
    # The integrals of gradients know no material: each pair of nodes has nine, which C contracts.
    G = ((B * (det * element.weights)[:, None]) @ B.transpose(0, 2, 1)).reshape(-1, k, 3, k, 3)
    stiffness = G[:, i, :, j].reshape(-1, 9) @ C
    return stiffness.ravel(), mass


def volumes(mesh: Mesh) -> Array:
    """The volume (n_elements,) [m^3] of every element."""
    return np.concatenate([det @ weights for _, det, weights in _determinants(mesh)])


def _determinants(mesh: Mesh) -> Iterator[tuple[Array, Array, Array]]:
    """Nodes X (n, k, 3), det J (n, q) and weights (q,) of batches of elements, in their order."""
    for kind, cells in mesh.elements.items():
        element = solid_element(kind)
        dN = element.dN(element.xi)
        for _, rows in batched(np.zeros(len(cells), dtype=np.int64), GRADIENT_BATCH // dN.size):
            X = mesh.points[cells[rows]]
            yield X, cofactors(dN, X)[1], element.weights


def check_jacobians(mesh: Mesh) -> None:
    """Every element must keep its orientation and volume at all points of integration.

    `MeshError` names one that does not.
    """
    lowest, relative = [], []
    # Relative to the diameter, so that the bound holds in any unit of length.
    for X, det, _ in _determinants(mesh):
        lowest.append(det.min(axis=1))
        relative.append(lowest[-1] / np.linalg.norm(np.ptp(X, axis=1), axis=1) ** 3)
    worst = np.concatenate(relative)
    bad = np.flatnonzero(worst <= MIN_RELATIVE_JACOBIAN)
    if bad.size:
        number = int(bad[0])
        kind, row = mesh.element(number)
        state = "inverted" if worst[number] < -MIN_RELATIVE_JACOBIAN else "degenerate"
        groups = [name for name, group in mesh.groups.items() if row in group.cells.get(kind, ())]
        middle = mesh.points[mesh.cells[kind][row]].mean(axis=0).tolist()
        raise MeshError(
            f"{mesh.name}: {kind} element {row} of group {', '.join(groups) or '(none)'} is "
            f"{state}: its Jacobian falls to {np.concatenate(lowest)[number]:.3e} m^3 near "
            f"{middle}; {bad.size} of {len(worst)} elements are inverted or degenerate"
        )
