"""Stiffness and mass of other programs, read from files into the order of the dofs of nodes."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..body.body import Matrices
from ..errors import MatrixError
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import Nodes
from .matrix_files import MatrixFile, read_matrix
from .matrix_names import MASS_NAMES, STIFFNESS_NAMES
from .node_table import NodeTable, read_dofs, read_nodes

MAX_ASYMMETRY = 1e-10  # of K, relative to its largest entry: rounding
DOFS_PER_NODE = 6


@dataclass(frozen=True, eq=False)
class GivenModel:
    """K [N/m ...] and M [kg ...] (n_u, n_u), sparse and symmetric, on the dofs of `nodes`.

    `table` has the labels of the nodes; `mesh` the solid elements of their file, with nodes that
    need not have dofs, None where there are none.
    """

    name: str
    table: NodeTable
    nodes: Nodes
    K: Any
    M: Any
    mesh: Mesh | None = None

    def dof(self, number: int) -> str:
        """A dof by its node and direction, for messages."""
        node = self.nodes.owner[number]
        if node < 0:
            first = self.nodes.n_dofs - self.nodes.generalized
            return f"the generalized coordinate {self.table.scalars[number - first]}"
        return f"dof {number - self.nodes.first[node] + 1} of node {self.table.labels[node]}"


def read_matrices(files: Matrices) -> GivenModel:
    """Read K, M and nodes into one order: that of the nodes, each with three or six dofs.

    Generalized coordinates follow, by their labels. Nodes without dofs, and dofs that have neither
    stiffness nor mass, are left out, as the rotations are that Nastran gives to solids. A file that
    has each pair of dofs once holds half of a symmetric matrix. Dofs in axes of their nodes are
    turned into those of the points. `MatrixError` if the matrices do not fit each other or their
    nodes, or are not symmetric.
    """
    table = read_nodes(files.nodes)
    stiffness = read_matrix(files.stiffness, STIFFNESS_NAMES)
    if files.mass is None and not stiffness.named:
        raise MatrixError(f"matrices.mass: expected a file, for {stiffness.name} holds one matrix")
    mass = read_matrix(files.mass or files.stiffness, MASS_NAMES)
    names = ", ".join(dict.fromkeys((stiffness.name, mass.name)))
    _check_pair(stiffness, mass, files, names)
    rows = [_dofs(file, files, table) for file in (stiffness, mass)]
    scalars = np.unique(np.concatenate([dofs[dofs[:, 1] == 0, 0] for dofs in rows]))
    slots = [
        _slots(file, files, dofs, table, scalars)
        for file, dofs in zip((stiffness, mass), rows, strict=True)
    ]
    # Both matrices decide: a dof with mass alone is still one, and is refused later by name.
    used = np.zeros(DOFS_PER_NODE * len(table.labels) + len(scalars), dtype=bool)
    for file, places in zip((stiffness, mass), slots, strict=True):
        used[places[_touched(file.entries)]] = True
    of_nodes, of_scalars = np.split(used, [DOFS_PER_NODE * len(table.labels)])
    with_dofs, rotations = _used_nodes(table, of_nodes.reshape(-1, DOFS_PER_NODE), names)
    nodes = Nodes(with_dofs.points, rotations, int(of_scalars.sum()))
    new_row = np.cumsum(used) - 1
    K, M = (
        _ordered(file.entries, new_row[places], used[places], nodes.n_dofs)
        for file, places in zip((stiffness, mass), slots, strict=True)
    )
    mesh = table.mesh()
    table = replace(with_dofs, scalars=scalars[of_scalars])
    model = GivenModel(names, table, nodes, K, M, mesh)
    return replace(model, K=_symmetric(model, stiffness.name, K), M=_symmetric(model, mass.name, M))


def _check_pair(stiffness: MatrixFile, mass: MatrixFile, files: Matrices, names: str) -> None:
    """`MatrixError` for one matrix as both, and for a table of dofs that neither takes."""
    K, M = stiffness.entries, mass.entries
    if K.shape == M.shape and all(
        np.array_equal(getattr(K, part), getattr(M, part)) for part in ("data", "row", "col")
    ):
        raise MatrixError(
            f"{names}: expected a stiffness and a mass, found the same matrix for both"
        )
    if files.dofs is not None and stiffness.dofs is not None and mass.dofs is not None:
        raise MatrixError(
            f"{files.dofs}: expected no matrices.dofs, for {names} tell node and direction of "
            "their rows"
        )


def _dofs(file: MatrixFile, files: Matrices, table: NodeTable) -> IntArray:
    """The label and direction (n, 2) of every row of a matrix.

    From its own labels, else from `files.dofs`, else as the program that wrote the nodes orders
    them.
    """
    if file.dofs is not None:
        return file.dofs
    n, n_nodes, n_scalars = file.entries.shape[0], len(table.labels), len(table.scalars)
    if files.dofs is not None:
        dofs = read_dofs(files.dofs)
        if len(dofs) != n:
            raise MatrixError(
                f"{files.dofs}: expected a row for each of the {n} of {file.name}, "
                f"found {len(dofs)}"
            )
        return dofs
    if file.dofs_file:
        raise MatrixError(
            f"{file.name}: expected the node and direction of its rows, found none: name the "
            f"file {file.dofs_file} that was written with it in matrices.dofs"
        )
    per_node = (n - n_scalars) // n_nodes
    if per_node not in (3, DOFS_PER_NODE) or n != per_node * n_nodes + n_scalars:
        behind = f", and {n_scalars} of scalar points" if n_scalars else ""
        raise MatrixError(
            f"{file.name}: expected {3 * n_nodes} or {6 * n_nodes} rows, three or six for "
            f"each of the {n_nodes} nodes of {table.name}{behind}, found {n}: "
            "tell node and direction of every row in matrices.dofs"
        )
    return table.dofs(per_node, by_label=file.by_label and table.by_label)


def _slots(
    file: MatrixFile, files: Matrices, dofs: IntArray, table: NodeTable, scalars: IntArray
) -> IntArray:
    """The slot 6 node + direction - 1 (n,) of every row; behind those of nodes, of scalars."""
    source = file.name if files.dofs is None or file.dofs is not None else files.dofs.name
    labels, directions = dofs.T
    # As Nastran has it: scalar points have the component 0.
    scalar = directions == 0
    if len(unknown := table.unknown(labels[~scalar])):
        raise MatrixError(
            f"{source}: no node {unknown[0]} in {table.name}, "
            f"nor {len(np.unique(unknown)) - 1} others"
        )
    if (wrong := (directions < 0) | (directions > DOFS_PER_NODE)).any():
        raise MatrixError(
            f"{source}: expected dofs 1 to 6, displacements and rotations, or 0 of a generalized "
            f"coordinate, found dof {directions[wrong][0]} of node {labels[wrong][0]}"
        )
    both = np.isin(table.labels, labels[scalar])
    if both.any():
        raise MatrixError(
            f"{source}: expected dofs 1 to 6 of node {table.labels[both][0]}, found 0, which is "
            "for generalized coordinates"
        )
    slots = np.empty(len(dofs), dtype=np.int64)
    slots[~scalar] = DOFS_PER_NODE * table.rows(labels[~scalar]) + directions[~scalar] - 1
    first = DOFS_PER_NODE * len(table.labels)
    slots[scalar] = first + np.searchsorted(scalars, labels[scalar])
    if len(twice := np.flatnonzero(np.bincount(slots) > 1)):
        label, direction = dofs[slots == twice[0]][0]
        raise MatrixError(
            f"{source}: expected every dof once, found dof {direction} of node "
            f"{label} in several rows"
        )
    return slots


def _touched(entries: Any) -> Any:
    """True (n,) for dofs with a nonzero entry in their row, or in their column of half a matrix."""
    nonzero = entries.data != 0.0
    touched = np.zeros(entries.shape[0], dtype=bool)
    touched[entries.row[nonzero]] = True
    touched[entries.col[nonzero]] = True
    return touched


def _used_nodes(table: NodeTable, used: Any, names: str) -> tuple[NodeTable, Any]:
    """The nodes that have dofs, and which of them rotate, from which directions are used (n, 6).

    names: of the files of the matrices, for the message.
    """
    there = used.any(axis=1)
    wrong = there & ~(
        used[:, :3].all(axis=1) & (used[:, 3:].all(axis=1) | ~used[:, 3:].any(axis=1))
    )
    if wrong.any():
        node = int(np.argmax(wrong))
        directions = ", ".join(str(i + 1) for i in np.flatnonzero(used[node]))
        raise MatrixError(
            f"{names}: expected stiffness or mass on dofs 1 to 3 of a node, or on 1 to 6, found "
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
    diagonal = sp.diags_array(matrix.diagonal(), format="csc")
    one_side = (matrix - diagonal).astype(bool)
    # No pair of dofs is there twice: the file holds one triangle, in whichever order. Before the
    # difference, which is small where the triangle is small beside the diagonal.
    if one_side.nnz and not one_side.multiply(one_side.T.tocsc()).nnz:
        return _turned(model, matrix + transposed - diagonal)
    difference = matrix - transposed
    largest = abs(matrix).max()
    if abs(difference).max() <= MAX_ASYMMETRY * largest:
        return _turned(model, 0.5 * (matrix + transposed))
    entries = abs(difference).tocoo()
    worst = int(np.argmax(entries.data))
    row, column = (model.dof(int(numbers[worst])) for numbers in (entries.row, entries.col))
    raise MatrixError(
        f"{name}: expected a symmetric matrix, found entries that differ from their mirror images "
        f"by up to {entries.data[worst] / largest:.1e} of the largest, "
        f"most between {row} and {column}"
    )


def _turned(model: GivenModel, matrix: Any) -> Any:
    """R^T A R, csc, of A in the axes of the nodes: their dofs are R times those in the file's."""
    if model.table.axes is None:
        return matrix.tocsc()
    # Rotations of a node turn as its displacements do.
    blocks = [
        axes
        for axes, rotates in zip(model.table.axes, model.nodes.rotations, strict=True)
        for _ in range(1 + rotates)
    ]
    R = sp.block_diag([*blocks, sp.eye_array(model.nodes.generalized)], format="csr")
    turned = R.T @ matrix @ R
    return (0.5 * (turned + turned.T)).tocsc()
