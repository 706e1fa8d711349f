"""A basis of displacements that grows, orthonormal in the mass matrix."""

from tempfile import TemporaryFile
from typing import Any

import numpy as np
from scipy.linalg import eigh

from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..processes import Processes
from .shapes import at

MIN_NEW_SHARE = 1e-13  # of a vector; below, rounding has made it
MIN_LENGTH_KEPT = 0.5
"""Length that a unit vector, once orthogonal to the basis, must keep: "twice is enough" (Kahan and
Parlett).
"""
MIN_GRAM_DIRECTION = 1e-5
"""Size of directions, relative to the largest, that one Gram matrix (which squares it) resolves
with room to spare.
"""


class Basis:
    """V (n_u, r) with V^T M V = I, in one array that is set aside for `capacity` columns.

    So it grows without being copied; the system gives an array its memory where it is first written
    to, hence columns that never come cost nothing. file: the array is in a temporary file, of which
    memory keeps what it has room for, and which is gone when the basis is.
    """

    def __init__(self, structure: Structure, capacity: int, file: bool = False) -> None:
        self.columns = 0
        self.processes = structure.processes
        self._M = structure.M
        shape = (len(structure.U), capacity)
        self._array: Array
        if file:
            with TemporaryFile(prefix="duhamel-") as scratch:
                self._array = np.memmap(scratch, np.float64, "w+", shape=shape, order="F")
        else:
            self._array = np.empty(shape, order="F")

    @property
    def in_file(self) -> bool:
        return isinstance(self._array, np.memmap)

    @property
    def V(self) -> Array:
        """The columns so far (n_u, r), not a copy."""
        return self._array[:, : self.columns]

    def extend(self, W: Array, near: int = 0) -> int:
        """Add the new directions of W (n_u, k); the number of columns added, 0 to k.

        W, made orthogonal to the columns from `near` on (all, unless it is known to be nearly
        orthogonal to those before), is normalized and then made orthogonal to all: the second time
        leaves rounding of the size of V.
        """
        MW = self._M @ W
        squares = self.processes.total(np.einsum("ik,ik->k", W, MW))
        unit = 1.0 / np.sqrt(np.maximum(squares, np.finfo(float).tiny))
        W, MW = self._normalized(*self._remainder(W * unit, MW * unit, near), MIN_NEW_SHARE)
        W, _ = self._normalized(*self._remainder(W, MW), MIN_LENGTH_KEPT)
        self._array[:, self.columns : self.columns + W.shape[1]] = W
        self.columns += W.shape[1]
        return int(W.shape[1])

    def at(self, rows: Any) -> Array:
        """rows @ V (k, r) for sparse rows (k, n_u), of which V is read only where they touch it."""
        return self.processes.total(at(rows, self.V))

    def _remainder(self, W: Array, MW: Array, start: int = 0) -> tuple[Array, Array]:
        """W - V V^T M W, with the columns of V from `start` on, and M times it."""
        V = self.V[:, start:]
        rest: Array = W - V @ self.processes.total(V.T @ MW)
        return rest, self._M @ rest

    def _normalized(self, W: Array, MW: Array, shortest: float) -> tuple[Array, Array]:
        """An orthonormal basis of the columns of W, without directions as short as `shortest`.

        MW: M times W; with the basis comes M times it.
        """
        bases, masses = [W[:, :0]], [MW[:, :0]]
        while W.shape[1]:
            squares, Q = _eigh(self.processes.total(W.T @ MW), self.processes)
            sizes = np.sqrt(np.maximum(squares, 0.0))
            if sizes[-1] <= shortest:
                break
            long = sizes > max(MIN_GRAM_DIRECTION * sizes[-1], shortest)
            scaled = Q[:, long] / sizes[long]
            bases.append(W @ scaled)
            masses.append(MW @ scaled)
            if long.all():
                break
            W = W @ Q[:, ~long]
            W = W - bases[-1] @ self.processes.total(masses[-1].T @ W)
            MW = self._M @ W
        return np.hstack(bases), np.hstack(masses)


def _eigh(gram: Array, processes: Processes) -> tuple[Array, Array]:
    found: tuple[Array, Array] = processes.agreed(lambda: eigh(gram))
    return found
