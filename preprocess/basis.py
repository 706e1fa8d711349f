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

    def extend(self, W: Array, near: int = 0) -> int:
        """Add what is new in W (n_u, k); the number of columns that this makes, k or fewer, 0 if nothing is new.

        W, made orthogonal to the columns from `near` on (all, unless it is known to be nearly orthogonal to those
        before), is normalised and then made orthogonal to all: the second time leaves rounding of the size of V.
        """
        squares = np.einsum("ik,ik->k", W, self._M @ W)
        W = W / np.sqrt(np.maximum(squares, np.finfo(float).tiny))
        W = self._normalised(self._remainder(W, near), NEW)
        W = self._normalised(self._remainder(W), OUTSIDE)
        self._append(W)
        return int(W.shape[1])

    def since(self, start: int) -> Array:
        """The columns from `start` on."""
        return np.hstack(self._filled(start))

    def combined(self, Q: Array) -> Array:
        """V Q (n_u, k) for Q (r, k), or with the first columns of V alone for fewer rows."""
        total = np.zeros((self._M.shape[0], Q.shape[1]))
        for i, chunk in enumerate(self._filled()):
            part = Q[CHUNK * i : CHUNK * (i + 1)]
            total += chunk[:, : len(part)] @ part
        return total

    def products(self, f: Array) -> Array:
        """V^T f (r, k) for f (n_u, k)."""
        return np.concatenate([chunk.T @ f for chunk in self._filled()])

    def at(self, rows: Any) -> Array:
        """rows @ V (k, r) for sparse rows (k, n_u)."""
        rows = rows.tocsc()
        touched = np.flatnonzero(np.diff(rows.indptr))
        rows = rows[:, touched]
        return np.hstack([rows @ chunk[touched] for chunk in self._filled()])

    def _remainder(self, W: Array, start: int = 0) -> Array:
        """W - V V^T M W, with the columns of V from `start` on."""
        MW = self._M @ W
        for chunk in self._filled(start):
            W = W - chunk @ (chunk.T @ MW)
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

    def _filled(self, start: int = 0) -> list[Array]:
        """The chunks from column `start` on, the last one up to where it is filled."""
        return [
            chunk[:, max(0, start - CHUNK * i) : self.columns - CHUNK * i]
            for i, chunk in enumerate(self._chunks)
            if start < CHUNK * (i + 1)
        ]
