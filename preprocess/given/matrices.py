"""Stiffness and mass of other programs, read from files into the order of the dofs of nodes."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..body.body import Matrices
from ..errors import MatrixError
from ..mesh.mesh import IntArray
from ..mesh.nodes import Nodes
from .matrix_files import MatrixFile, read_matrix
from .node_table import NodeTable, read_dofs, read_nodes

MAX_ASYMMETRY = 1e-10  # of K, relative to its largest entry: rounding
DOFS_PER_NODE = 6


@dataclass(frozen=True, eq=False)
class GivenModel:
    """K [N/m ...] and M [kg ...] (n_u, n_u), sparse and symmetric, on the dofs of `nodes`.

    `table` has the labels of the nodes.
    """

    name: str
    table: NodeTable
    nodes: Nodes
    K: Any
    M: Any

    def dof(self, number: int) -> str:
        """A dof by its node and direction, for messages."""
        node = self.nodes.owner[number]
        return f"dof {number - self.nodes.first[node] + 1} of node {self.table.labels[node]}"


def read_matrices(files: Matrices) -> GivenModel:
    """Read K, M and nodes into one order: that of the nodes, each with three or six dofs.

    Nodes without dofs, and dofs that have neither stiffness nor mass, are left out, as the
    rotations are that Nastran gives to solids. A file that has each pair of dofs once holds half of
    a symmetric matrix. `MatrixError` if the matrices do not fit each other or their nodes, or are
    not symmetric.
    """
    table = read_nodes(files.nodes)
    stiffness = read_matrix(files.stiffness, "KGG")
    if files.mass is None and not stiffness.named:
        raise MatrixError(f"matrices.mass: expected a file, for {stiffness.name} holds one matrix")
    mass = read_matrix(files.mass or files.stiffness, "MGG")
    rows = [_slots(file, files, table) for file in (stiffness, mass)]
    # Both matrices decide: a dof with mass alone is still one, and is refused later by name.
    used = np.zeros(DOFS_PER_NODE * len(table.labels), dtype=bool)
    for file, slots in zip((stiffness, mass), rows, strict=True):
        used[slots[_touched(file.entries)]] = True
    with_dofs, rotations = _used_nodes(table, used.reshape(-1, DOFS_PER_NODE))
    nodes = Nodes(with_dofs.points, rotations)
    new_row = np.cumsum(used) - 1
    K, M = (
        _ordered(file.entries, new_row[slots], used[slots], nodes.n_dofs)
        for file, slots in zip((stiffness, mass), rows, strict=True)
    )
    model = GivenModel(f"{stiffness.name}, {mass.name}", with_dofs, nodes, K, M)
    return replace(model, K=_symmetric(model, stiffness.name, K), M=_symmetric(model, mass.name, M))


def _slots(file: MatrixFile, files: Matrices, table: NodeTable) -> IntArray:
    """The slot 6 node + direction - 1 (n,) of every row of a matrix.

    From its own labels, else from `files.dofs`, else in the order of the nodes.
    """
    n, n_nodes = file.entries.shape[0], len(table.labels)
    dofs = file.dofs
    if dofs is None and files.dofs is not None:
        dofs = read_dofs(files.dofs)
        if len(dofs) != n:
            raise MatrixError(
                f"{files.dofs}: expected a row for each of the {n} of {file.name}, "
                f"found {len(dofs)}"
            )
    if dofs is None:
        if file.dofs_file:
            raise MatrixError(
                f"{file.name}: expected the node and direction of its rows, found none: name the "
                f"file {file.dofs_file} that was written with it in matrices.dofs"
            )
        if n not in (3 * n_nodes, DOFS_PER_NODE * n_nodes):
            raise MatrixError(
                f"{file.name}: expected {3 * n_nodes} or {6 * n_nodes} rows, three or six for "
                f"each of the {n_nodes} nodes of {table.name}, found {n}: "
                "tell node and direction of every row in matrices.dofs"
            )
        per_node = n // n_nodes
        return (DOFS_PER_NODE * np.arange(n_nodes)[:, None] + np.arange(per_node)).ravel()
    source = file.name if files.dofs is None or file.dofs is not None else files.dofs.name
    labels, directions = dofs.T
    if len(unknown := table.unknown(labels)):
        raise MatrixError(
            f"{source}: no node {unknown[0]} in {table.name}, "
            f"nor {len(np.unique(unknown)) - 1} others"
        )
    if (wrong := (directions < 1) | (directions > DOFS_PER_NODE)).any():
        raise MatrixError(
            f"{source}: expected dofs 1 to 6, displacements and rotations, found dof "
            f"{directions[wrong][0]} of node {labels[wrong][0]}"
        )
    slots: IntArray = DOFS_PER_NODE * table.rows(labels) + directions - 1
    if len(twice := np.flatnonzero(np.bincount(slots) > 1)):
        raise MatrixError(
            f"{source}: expected every dof once, found dof {twice[0] % DOFS_PER_NODE + 1} of node "
            f"{table.labels[twice[0] // DOFS_PER_NODE]} in several rows"
        )
    return slots


def _touched(entries: Any) -> Any:
    """True (n,) for dofs with a nonzero entry in their row, or in their column of half a matrix."""
    nonzero = entries.data != 0.0
    touched = np.zeros(entries.shape[0], dtype=bool)
    touched[entries.row[nonzero]] = True
    touched[entries.col[nonzero]] = True
    return touched


def _used_nodes(table: NodeTable, used: Any) -> tuple[NodeTable, Any]:
    """The nodes that have dofs, and which of them rotate, from which directions are used (n, 6)."""
    there = used.any(axis=1)
    wrong = there & ~(
        used[:, :3].all(axis=1) & (used[:, 3:].all(axis=1) | ~used[:, 3:].any(axis=1))
    )
    if wrong.any():
        node = int(np.argmax(wrong))
        directions = ", ".join(str(i + 1) for i in np.flatnonzero(used[node]))
        raise MatrixError(
            "expected stiffness or mass on dofs 1 to 3 of a node, or on 1 to 6, found "
            f"{directions} at node {table.labels[node]}, and such at {wrong.sum() - 1} others: "
            "export the model without constraints"
        )
    return table.part(np.flatnonzero(there)), used[there, 3]


def _ordered(entries: Any, new_row: IntArray, kept: Any, n_dofs: int) -> Any:
    """The entries of the rows that are kept, in their new rows and columns."""
    inside = kept[entries.row] & kept[entries.col]
    rows, columns = new_row[entries.row[inside]], new_row[entries.col[inside]]
    matrix = sp.coo_array(
        (entries.data[inside].astype(float), (rows, columns)), shape=(n_dofs, n_dofs)
    ).tocsc()
    matrix.eliminate_zeros()
    return matrix


def _symmetric(model: GivenModel, name: str, matrix: Any) -> Any:
    """(K + K^T) / 2; of half a matrix, with one entry for each pair of dofs, K + K^T - diag K."""
    transposed = matrix.T.tocsc()
    difference = matrix - transposed
    largest = abs(matrix).max()
    if abs(difference).max() <= MAX_ASYMMETRY * largest:
        return (0.5 * (matrix + transposed)).tocsc()
    diagonal = sp.diags_array(matrix.diagonal(), format="csc")
    one_side = (matrix - diagonal).astype(bool)
    # No pair of dofs is there twice: the file holds one triangle, in whichever order.
    if not one_side.multiply(one_side.T.tocsc()).nnz:
        return (matrix + transposed - diagonal).tocsc()
    entries = abs(difference).tocoo()
    worst = int(np.argmax(entries.data))
    row, column = (model.dof(int(numbers[worst])) for numbers in (entries.row, entries.col))
    raise MatrixError(
        f"{name}: expected a symmetric matrix, found entries that differ from their mirror images "
        f"by up to {entries.data[worst] / largest:.1e} of the largest, "
        f"most between {row} and {column}"
    )
