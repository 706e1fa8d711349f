"""Stiffness and mass of shells, summed over batches of elements."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ...superelement.validation import Array
from ..mesh.mesh import IntArray, Mesh
from ..threads import in_order
from .assembly_map import pattern
from .batches import batched
from .laminate import Laminate
from .shell import Shells, SurfaceFrames

DRILLING_FACTOR = 1e-4
"""The stiffness and inertia of a rotation about the normal, relative to the membrane's shear
stiffness and to the rotary inertia: so small that thin warped shells stay soft, and the same for
both, so that its vibration is far above the band of a shell (12 G / (rho t^2) = omega^2).
"""
SHELL_BATCH = 512  # elements at once, whose rows stay in the cache


class ShellBatch(NamedTuple):
    """Shells of one type, by their rows (n,), and the number of their laminate."""

    kind: str
    owner: int
    rows: IntArray


def shell_batches(mesh: Mesh, owners: IntArray) -> Iterator[ShellBatch]:
    """All elements, of one type and laminate at a time."""
    for kind in mesh.elements:
        for owner, rows in batched(mesh.of_kind(owners, kind), SHELL_BATCH):
            yield ShellBatch(kind, owner, rows)


def shell_matrices(
    mesh: Mesh, shells: Mapping[str, Shells], laminates: Sequence[Laminate], owners: IntArray
) -> tuple[Any, Any]:
    """Stiffness and consistent mass (6 n, 6 n), sparse, symmetric to the last bit.

    Quadrangles are MITC4 with incompatible modes of the membrane, triangles MITC3+. `owners`
    (n_elements,) is the number of each element's laminate. Source: K. J. Bathe, E. N. Dvorkin,
    Int. J. Num. Meth. Eng. 22 (1986) 697-722; Y. Lee, P. S. Lee, K. J. Bathe, Computers and
    Structures 138 (2014) 12-23.
    """
    blocks = pattern(mesh.elements, len(mesh.points))
    K, M = np.zeros((blocks.n_blocks, 6, 6)), np.zeros((blocks.n_blocks, 6, 6))

    def of_batch(batch: ShellBatch) -> tuple[IntArray, Array, Array]:
        cells, some = mesh.cells[batch.kind][batch.rows], shells[batch.kind].some(batch.rows)
        at = some.frames(some.shape.xi)
        laminate = laminates[batch.owner]
        i, j = np.triu_indices(cells.shape[1])
        pairs = [
            matrix[:, i, :, j].ravel()
            for matrix in (_stiffness(some, at, laminate), _mass(some, at, laminate))
        ]
        return blocks.entries(cells, 6), pairs[0], pairs[1]

    for places, stiffness, mass in in_order(of_batch, shell_batches(mesh, owners)):
        np.add.at(K.reshape(-1), places, stiffness)
        np.add.at(M.reshape(-1), places, mass)
    return blocks.matrix(K), blocks.matrix(M)


def generalized(shells: Shells, xi: Array, at: SurfaceFrames) -> Array:
    """Strains (n, q, 8, c): of the surface (3), curvatures (3) and shear (2), along its axes.

    c: the dofs 6 k of the nodes, and then what is internal: two of the bubble of triangles, or four
    incompatible modes of quadrangles.
    """
    shear, of_bubble = shells.shear(xi, at)
    nodal = [shells.membrane(xi, at), shells.bending(xi, at), shear]
    n, q = at.areas.shape
    strains = np.concatenate([rows.reshape(n, q, rows.shape[2], -1) for rows in nodal], axis=2)
    # What no neighbor shares: it is condensed before elements are summed.
    inner = np.zeros((n, q, 8, 4 if shells.shape.incompatible else 2))
    if shells.shape.incompatible:
        inner[:, :, :3] = shells.incompatible(xi, at)
    else:
        inner[:, :, 3:6] = shells.bubble_bending(xi, at)
        inner[:, :, 6:] = of_bubble
    return np.concatenate([strains, inner], axis=3)


def full_stiffness(strains: Array, laminate: Laminate, dA: Array) -> Array:
    """int B^T C B dA (n, c, c) of strains (n, q, 8, c) and areas (n, q)."""
    n, q, rows, c = strains.shape
    stress = (laminate.stiffness @ strains) * dA[:, :, None, None]
    return strains.reshape(n, q * rows, c).transpose(0, 2, 1) @ stress.reshape(n, q * rows, c)


def condensation(K: Array, n_nodal: int) -> Array:
    """-K_ii^-1 K_in (n, inner, nodal): what the dofs of nodes make of what is internal."""
    inner = np.linalg.solve(K[:, n_nodal:, n_nodal:], K[:, n_nodal:, :n_nodal])
    return np.asarray(-inner, dtype=np.float64)


def nodal_strains(shells: Shells, laminate: Laminate, xi: Array) -> tuple[Array, SurfaceFrames]:
    """Strains (n, q, 8, 6 k) at points xi from the dofs of nodes alone, and the axes there."""
    c, inner = 6 * shells.X.shape[1], shells.frames(shells.shape.xi)
    dA = inner.areas * shells.shape.weights
    full = full_stiffness(generalized(shells, shells.shape.xi, inner), laminate, dA)
    at = shells.frames(xi)
    strains = generalized(shells, xi, at)
    return strains[..., :c] + strains[..., c:] @ condensation(full, c)[:, None], at


def _stiffness(shells: Shells, at: SurfaceFrames, laminate: Laminate) -> Array:
    """(n, k, 6, k, 6), with what is internal condensed."""
    xi, (n, k) = shells.shape.xi, shells.X.shape[:2]
    dA = at.areas * shells.shape.weights
    full = full_stiffness(generalized(shells, xi, at), laminate, dA)
    c = 6 * k
    K = full[:, :c, :c] + full[:, :c, c:] @ condensation(full, c)
    # At all points, not one: a single point would leave alternating rotations free.
    drilling = shells.drilling(xi, at).reshape(n, -1, c)
    held = DRILLING_FACTOR * laminate.in_plane_shear * dA[..., None] * drilling
    return np.asarray(K + drilling.transpose(0, 2, 1) @ held).reshape(n, k, 6, k, 6)


def _mass(shells: Shells, at: SurfaceFrames, laminate: Laminate) -> Array:
    """(n, k, 6, k, 6): int m u.u + 2 s u.f + j f.f dA, with f = w x d.

    And a part of j on the rotation about the normal beyond that of the surface, which no rigid
    motion has.
    """
    xi, (n, k) = shells.shape.xi, shells.X.shape[:2]
    dA = at.areas * shells.shape.weights
    N, f = shells.motion(xi)
    M = np.zeros((n, k, 6, k, 6))
    mass, moment, inertia = laminate.inertia
    M[:, :, :3, :, :3] = np.einsum("nq,qk,ql,ij->nkilj", mass * dA, N, N, np.eye(3), optimize=True)
    # Zero where the mass is centered at the nodes; an offset couples stretch and rotation.
    mixed = np.einsum("nq,qk,nqilj->nkilj", moment * dA, N, f, optimize=True)
    M[:, :, :3, :, 3:], M[:, :, 3:, :, :3] = mixed, mixed.transpose(0, 3, 4, 1, 2)
    M[:, :, 3:, :, 3:] = np.einsum("nq,nqmki,nqmlj->nkilj", inertia * dA, f, f, optimize=True)
    drilling = shells.drilling(xi, at).reshape(n, -1, 6 * k)
    held = DRILLING_FACTOR * laminate.rotary * dA[..., None] * drilling
    return M + (drilling.transpose(0, 2, 1) @ held).reshape(M.shape)
