"""What constraints see of bodies: their inverse inertia and the accelerance of their interfaces, as
sparse matrices.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, bsr_array, csr_array

from ..arrays import Array
from ..lower.lower import CompiledModel
from ..step.system import System


def inverse_inertia(system: System) -> csr_array:
    """M^-1 of (x, Theta) of all bodies (6 n_b, 6 n_b)."""
    return _of_bodies(1.0 / system.bodies.mass, np.linalg.inv(system.bodies.J_rot))


def inverse_root(system: System) -> csr_array:
    """L with L L^T = M^-1 (6 n_b, 6 n_b)."""
    return _of_bodies(
        1.0 / np.sqrt(system.bodies.mass), np.linalg.cholesky(np.linalg.inv(system.bodies.J_rot))
    )


def interface_accelerance(compiled: CompiledModel) -> csr_array:
    """A_el: accelerations of all active dofs under unit loads on them, at rest (n_a, n_a)."""
    return _diagonal(_accelerances(compiled))


def accelerance_root(compiled: CompiledModel) -> csr_array:
    """A with A A^T = A_el (n_a, n_a)."""
    roots = []
    for accelerance in _accelerances(compiled):
        values, vectors = np.linalg.eigh(accelerance)
        roots.append(vectors * np.sqrt(np.maximum(values, 0.0)))
    return _diagonal(roots)


def _accelerances(compiled: CompiledModel) -> list[Array]:
    elastic = compiled.system.elastic
    accelerances = []
    for e, element in enumerate(compiled.superelements):
        own = elastic.active[elastic.active_range[e] : elastic.active_range[e + 1]] - elastic.dof[e]
        accelerances.append(element.accelerance[np.ix_(own, own)])
    return accelerances


def _of_bodies(linear: Array, angular: NDArray[np.floating[Any]]) -> csr_array:
    n = len(linear)
    blocks = np.zeros((n, 6, 6))
    blocks[:, :3, :3] = linear[:, None, None] * np.eye(3)
    blocks[:, 3:, 3:] = angular
    return csr_array(bsr_array((blocks, np.arange(n), np.arange(n + 1))))


def _diagonal(blocks: list[Array]) -> csr_array:
    return csr_array(block_diag([np.zeros((0, 0)), *blocks]))
