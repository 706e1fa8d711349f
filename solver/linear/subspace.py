"""The subspace of the slowest motions of a large linear model, by a block Krylov method.

    T = (A - sigma)^-1,    H = Q^T T Q,    eigenvalues sigma + 1 / mu of A by mu of H

Q (n, p) spans a block of random vectors, T of it, T^2 of it and so on. A block finds eigenvalues
that coincide, as those of a shaft at rest in two planes, or of free motions. The residual T q - mu
q of each vector that is asked for is its certificate. Source: Y. Saad, Numerical Methods for Large
Eigenvalue Problems (2011), ch. 6.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Index

# of sigma: eigenvalues below are motions that nothing resists
RIGID_EIGENVALUE = 3e-5
# vectors: double eigenvalues need two, and products of blocks cost little more
MIN_BLOCK = 8
# of an eigenvalue mu, from which it counts as found
EIGEN_RESIDUAL = 1e-10
# found beyond those that are asked for, so that none of these is missed
EXTRA_EIGENVALUES = 2
# of the subspace before its eigenvalues are computed again
SUBSPACE_GROWTH = 1.3
# of the iteration that looks for modes beside those that are found
MAX_ROUNDS = 12
# above it an eigenvalue of the subspace is none of the model
STRAY_RESIDUAL = 1e-3
# relative difference of one that was found twice
DUPLICATE_EIGENVALUE = 1e-7


@dataclass(frozen=True, eq=False)
class Subspace:
    """(A - sigma)^-1 in an invariant subspace.

    basis (n, p), orthonormal; None: all states. matrix (p, p): H. left (n, p): T Q - Q H.
    """

    sigma: float
    basis: Array | None
    matrix: Array
    left: Array | None = None

    @cached_property
    def _eigen(self) -> tuple[Any, Any]:
        mu, vectors = np.linalg.eig(self.matrix)
        return mu.astype(np.complex128), vectors.astype(np.complex128)

    @property
    def mu(self) -> Any:
        """Eigenvalues of the matrix (p,)."""
        return self._eigen[0]

    @property
    def values(self) -> Any:
        """Eigenvalues of A (p,) [rad/s]."""
        return self.sigma + 1.0 / self.mu

    @property
    def vectors(self) -> Any:
        """Eigenvectors of the matrix (p, p)."""
        return self._eigen[1]

    @cached_property
    def errors(self) -> Array:
        """Residuals of the eigenvectors (p,), relative to mu."""
        if self.left is None:
            return np.zeros(len(self.mu))
        errors: Array = np.linalg.norm(self.left @ self.vectors, axis=0) / np.abs(self.mu)
        return errors

    @property
    def found(self) -> NDArray[np.bool_]:
        """Of each eigenvalue of the matrix, whether it is one of the model (p,)."""
        found: NDArray[np.bool_] = self.errors <= EIGEN_RESIDUAL
        return found

    @property
    def free(self) -> NDArray[np.bool_]:
        """Whether it is that of a motion that nothing resists (p,)."""
        free: NDArray[np.bool_] = np.abs(self.values) < RIGID_EIGENVALUE * self.sigma
        return free

    def lifted(self, vectors: Any) -> Any:
        """States (n, k) of vectors of the subspace (p, k)."""
        return vectors if self.basis is None else self.basis @ vectors

    def states(self, chosen: Index) -> Any:
        """States (n, k) of the eigenvalues of these numbers."""
        return self.lifted(self.vectors[:, chosen])


def slowest(
    apply: Callable[[Array], Array],
    states: int,
    sigma: float,
    n: int,
    most: int,
    block_size: int = MIN_BLOCK,
) -> Subspace | None:
    """The subspace of the n slowest modes; None where it would have more than `most` vectors.

    apply: (A - sigma)^-1 of vectors (states, k). block_size: the number of eigenvalues that may
    coincide without taking longer. Once the modes are found, vectors without a part in them are
    added: only if these bring no further mode below the last one are they all.
    """
    random = np.random.default_rng(0)
    basis, images = np.empty((states, 0)), np.empty((states, 0))
    block, before = random.normal(size=(states, block_size)), None
    size = 4 * (n + EXTRA_EIGENVALUES + block_size)
    while size <= min(most, states - block_size):
        while basis.shape[1] < size:
            block = _orthonormal(block, basis)
            image = apply(block)
            basis, images = np.hstack([basis, block]), np.hstack([images, image])
            block = image
        found = _projected(sigma, basis, images)
        first = _first(found, n)
        if first is not None:
            if before is not None and np.allclose(
                first, before, rtol=DUPLICATE_EIGENVALUE, atol=0.0
            ):
                return found
            before, block = first, _others(apply, found, random.normal(size=(states, block_size)))
        size = int(SUBSPACE_GROWTH * size)
    return None


def _projected(sigma: float, basis: Array, images: Array) -> Subspace:
    matrix = basis.T @ images
    return Subspace(sigma, basis, matrix, images - basis @ matrix)


def _others(apply: Callable[[Array], Array], space: Subspace, block: Array) -> Array:
    """The slowest motions in a block (states, k) beside those that are found, by iteration."""
    found = space.states(np.flatnonzero(space.found & (space.values.imag >= 0.0)))
    known, _ = np.linalg.qr(np.hstack([found.real, found.imag]))
    for _ in range(MAX_ROUNDS):
        block = apply(_orthonormal(block, known))
    return block


def _orthonormal(block: Array, basis: Array) -> Array:
    """The part of a block across a basis, (states, k)."""
    for _ in range(2):
        block = block - basis @ (basis.T @ block)
        block, _ = np.linalg.qr(block)
    return block


def _first(space: Subspace, n: int) -> Array | None:
    """The sizes of the first n eigenvalues of A, of a pair one; None if they are not found yet.

    Those of free motions, 0, do not count. Nor do eigenvalues of H that are far from any of T,
    which a subspace has between others; those on their way to one do.
    """
    upper = np.flatnonzero((space.values.imag >= 0.0) & ~space.free)
    upper = upper[np.argsort(np.abs(space.values[upper]))]
    found = np.flatnonzero(space.errors[upper] <= EIGEN_RESIDUAL)[: n + EXTRA_EIGENVALUES]
    if len(found) < n + EXTRA_EIGENVALUES:
        return None
    before = space.errors[upper[: found[-1]]]
    if ((before > EIGEN_RESIDUAL) & (before < STRAY_RESIDUAL)).any():
        return None
    first: Array = np.abs(space.values[upper[found[:n]]])
    return first
