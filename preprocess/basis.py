"""A basis of displacements that grows, orthonormal in the mass matrix."""

from typing import Any

import numpy as np
from scipy.linalg import eigh

from ..superelement.validation import Array

NEW = 1e-13
"""Share of a vector that must be new; below, rounding has made it."""
OUTSIDE = 0.5
"""Length that a unit vector, once orthogonal to the basis, must keep: "twice is enough" (Kahan and Parlett)."""
RESOLVED = 1e-5
"""Size of directions, relative to the largest, that one Gram matrix (which squares it) resolves with room to spare."""
CHUNK = 256
"""Columns for which memory is taken at a time."""


class Basis:
    """V (n_u, r) with V^T M V = I, in chunks of columns: it grows without being copied."""

    def __init__(self, M: Any) -> None:
        self.columns = 0
        self._M = M
        self._chunks: list[Array] = []

    def extend(self, W: Array) -> Array:
        """Add what is new in W (n_u, k); the columns that were added (n_u, k or fewer), none if nothing is new.

        Twice orthogonal to all the others, by matrix products: once leaves rounding relative to what was removed.
        """
        squares = np.einsum("ik,ik->k", W, self._M @ W)
        W = W / np.sqrt(np.maximum(squares, np.finfo(float).tiny))
        for shortest in (NEW, OUTSIDE):
            W = self._normalised(self._remainder(W), shortest)
        self._append(W)
        return W

    def products(self, f: Array) -> Array:
        """V^T f (r, k) for f (n_u, k)."""
        return np.concatenate([np.zeros((0, f.shape[1])), *(chunk.T @ f for chunk in self._filled())])

    def at(self, rows: Any) -> Array:
        """rows @ V (k, r) for sparse rows (k, n_u)."""
        rows = rows.tocsc()
        touched = np.flatnonzero(np.diff(rows.indptr))
        rows = rows[:, touched]
        return np.hstack([rows @ chunk[touched] for chunk in self._filled()])

    def _remainder(self, W: Array) -> Array:
        """W - V V^T M W"""
        coefficients = self.products(self._M @ W)
        start = 0
        for chunk in self._filled():
            W = W - chunk @ coefficients[start : start + chunk.shape[1]]
            start += chunk.shape[1]
        return W

    def _normalised(self, W: Array, shortest: float) -> Array:
        """An orthonormal basis of the columns of W, without directions of this length or shorter."""
        found = []
        while W.shape[1]:
            squares, Q = eigh(W.T @ (self._M @ W))
            sizes = np.sqrt(np.maximum(squares, 0.0))
            if sizes[-1] <= shortest:
                break
            long = sizes > max(RESOLVED * sizes[-1], shortest)
            found.append(W @ (Q[:, long] / sizes[long]))
            W = W @ Q[:, ~long]
            W = W - found[-1] @ (found[-1].T @ (self._M @ W))
        return np.hstack([W[:, :0], *found])

    def _append(self, W: Array) -> None:
        while W.shape[1]:
            if self.columns == CHUNK * len(self._chunks):
                self._chunks.append(np.empty((len(W), CHUNK), order="F"))
            start = self.columns % CHUNK
            width = min(W.shape[1], CHUNK - start)
            self._chunks[-1][:, start : start + width] = W[:, :width]
            self.columns += width
            W = W[:, width:]

    def _filled(self) -> list[Array]:
        """The chunks, the last one up to where it is filled."""
        last = self.columns - CHUNK * (len(self._chunks) - 1)
        return [*self._chunks[:-1], *(chunk[:, :last] for chunk in self._chunks[-1:])]
