"""Matrices whose rows are spread over processes, by PETSc."""

from typing import Any

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from ...superelement.validation import Array
from .partition import petsc_rows


def product(mat: Any, X: Array) -> Array:
    """The own rows of A X for a matrix A of PETSc and the own rows of X (n,) or (n, k)."""
    if _leaves_processes_out(mat):
        return _by_columns(mat, X)
    dense = dense_columns(X, mat)
    found = mat.matMult(dense)
    own = np.array(found.getDenseArray(), order="F")
    # Not left to the collector of garbage, which runs at other times in other processes.
    found.destroy()
    dense.destroy()
    return own.reshape((-1, *X.shape[1:]), order="F")


def _leaves_processes_out(mat: Any) -> bool:
    """Whether a process has none of the rows or columns, which products with many vectors do not
    bear.
    """
    ranges = mat.getOwnershipRanges(), mat.getOwnershipRangesColumn()
    return any((np.diff(owned) == 0).any() for owned in ranges)


def _by_columns(mat: Any, X: Array) -> Array:
    x, y = mat.createVecs()
    found = np.empty((mat.getLocalSize()[0], *X.shape[1:]), order="F")
    for column in np.ndindex(X.shape[1:]):
        x.setArray(X[:, *column])
        mat.mult(x, y)
        found[:, *column] = y.getArray()
    x.destroy()
    y.destroy()
    return found


def dense_columns(X: Array, mat: Any) -> Any:
    """X (n, k) or (n,) that a matrix is to be multiplied with, which the caller destroys."""
    columns = np.asfortranarray(X if X.ndim == 2 else X[:, None], dtype=np.float64)
    sizes = ((len(X), mat.size[1]), (None, columns.shape[1]))
    dense = PETSc.Mat().createDense(sizes, array=columns, comm=mat.comm)
    dense.assemble()
    return dense


class SpreadMatrix:
    """A (n, n), symmetric and sparse, from the own rows (n_own, n) of every process.

    A @ X takes the own rows of X (n,) or (n, k), and has those of the product.
    """

    def __init__(self, rows: Any, comm: Any) -> None:
        self.shape = (rows.shape[1], rows.shape[1])
        sizes = (rows.shape[0], rows.shape[1])
        self.mat = PETSc.Mat().createAIJ((sizes, sizes), csr=petsc_rows(rows), comm=comm)
        self.mat.assemble()

    def __matmul__(self, X: Array) -> Array:
        return product(self.mat, X)

    def diagonal(self) -> Array:
        """The own entries (n_own,) of the diagonal."""
        vector = self.mat.getDiagonal()
        found = np.array(vector.getArray())
        vector.destroy()
        return found

    def own_rows(self) -> Any:
        """The own rows (n_own, n), sparse."""
        first, columns, values = self.mat.getValuesCSR()
        return sp.csr_array((values, columns, first), shape=(len(first) - 1, self.shape[1]))


class SpreadMass:
    """M (n, n) as one factor for each pair of nodes, m I, and the rest, which ties and masses make.

    So it is a third of it. Nodes have three unknowns, or twice three.
    """

    def __init__(self, rows: Any, comm: Any) -> None:
        self.shape = (rows.shape[1], rows.shape[1])
        self._comm = comm
        factors = rows[::3][:, ::3].tocsr()
        rest = (rows - sp.kron(factors, sp.eye_array(3))).tocsr()
        rest.eliminate_zeros()
        self._of_nodes = SpreadMatrix(factors, comm)
        self._rest = SpreadMatrix(rest, comm) if comm.allreduce(rest.nnz) else None

    def __matmul__(self, X: Array) -> Array:
        n = len(X) // 3
        # A row for each node: (3 n, k) as (n, 3 k).
        by_node = X.reshape((3, n, -1), order="F").transpose(1, 0, 2)
        moved = self._of_nodes @ np.asfortranarray(by_node).reshape((n, -1), order="F")
        by_axis = moved.reshape((n, 3, -1), order="F").transpose(1, 0, 2)
        found: Array = np.asfortranarray(by_axis).reshape(X.shape, order="F")
        if self._rest is not None:
            found += self._rest @ X
        return found

    def diagonal(self) -> Array:
        """The own entries (n_own,) of the diagonal."""
        found = np.repeat(self._of_nodes.diagonal(), 3)
        return found if self._rest is None else found + self._rest.diagonal()

    def assembled(self) -> Any:
        """All of it as a matrix of PETSc, which the caller destroys."""
        rows = sp.kron(self._of_nodes.own_rows(), sp.eye_array(3), format="csr")
        if self._rest is not None:
            rows = (rows + self._rest.own_rows()).tocsr()
        return SpreadMatrix(rows, self._comm).mat


def shifted(K: SpreadMatrix, M: SpreadMass, shift: float) -> Any:
    """K + s M, symmetric and positive definite, as a matrix of PETSc."""
    mass = M.assembled()
    S = K.mat.copy()
    S.axpy(shift, mass)
    mass.destroy()
    S.setOption(PETSc.Mat.Option.SPD, True)
    return S
