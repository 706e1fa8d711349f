"""Nodes by label: positions and groups."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ...files import in_one_line
from ...superelement.validation import Array
from ..errors import MatrixError, MeshError
from ..mesh.cells import SOLID_TYPES
from ..mesh.mesh import NO_NODES, IntArray, Mesh
from ..mesh.numbering import Numbering
from .damage import about_matrices, arrays, load_rows, require_text, whole_numbers

MAX_DIGITS = 18  # of labels, which are integers of 64 bits


@dataclass(frozen=True, eq=False)
class NodeTable:
    """labels (n,) and points (n, 3) [m] of nodes, and groups of them as rows (k,) of the table.

    axes (n, 3, 3): those of the dofs of nodes as rows, None where all have the ones of the points.
    scalars (k,): labels of generalized coordinates. by_label: whether the program that wrote the
    nodes has its own matrices in the order of labels, not of the table. solids: the solid elements
    (n_cells, k) by type, as labels; empty where the file has none.
    """

    name: str
    labels: IntArray
    points: Array
    groups: Mapping[str, IntArray] = field(default_factory=dict)
    axes: Array | None = None
    scalars: IntArray = field(default_factory=lambda: NO_NODES)
    by_label: bool = False
    solids: Mapping[str, IntArray] = field(default_factory=dict)

    @cached_property
    def _numbering(self) -> Numbering:
        return Numbering(self.labels, "node")

    @property
    def size(self) -> float:
        """The diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    def unknown(self, labels: IntArray) -> IntArray:
        """Those of the labels that no node has."""
        return labels[~self._numbering.known(labels)]

    def rows(self, labels: IntArray) -> IntArray:
        """The rows of labels, all of which must be known."""
        return self._numbering.rows(labels, self.name)

    def part(self, rows: IntArray) -> "NodeTable":
        """Some of the nodes."""
        new_row = np.full(len(self.labels), -1, dtype=np.int64)
        new_row[rows] = np.arange(len(rows))
        groups = {
            name: new_row[members][new_row[members] >= 0] for name, members in self.groups.items()
        }
        axes = None if self.axes is None else self.axes[rows]
        return replace(
            self, labels=self.labels[rows], points=self.points[rows], groups=groups, axes=axes
        )

    def mesh(self) -> Mesh | None:
        """The solid elements of the file on their nodes, None where it has none."""
        if not self.solids:
            return None
        cells = {
            kind: self.rows(nodes.ravel()).reshape(nodes.shape)
            for kind, nodes in self.solids.items()
        }
        whole = Mesh(self.name, self.points, cells, {}, tuple(cells), self.labels)
        return whole.without_loose_nodes()

    def dofs(self, per_node: int, by_label: bool) -> IntArray:
        """The label and direction (n, 2) of all dofs, in the order of labels or of the table.

        Generalized coordinates, of direction 0, have their place among the labels, or come last.
        """
        labels = np.repeat(self.labels, per_node)
        directions = np.tile(np.arange(1, per_node + 1), len(self.labels))
        dofs = np.stack([labels, directions], axis=1)
        scalars = np.stack([self.scalars, np.zeros_like(self.scalars)], axis=1)
        dofs = np.concatenate([dofs, scalars])
        # A stable order keeps the directions of a node.
        return dofs[np.argsort(dofs[:, 0], kind="stable")] if by_label else dofs


def read_nodes(path: Path) -> NodeTable:
    """The nodes of a table (.csv, .txt), of arrays (.npz), or of a mesh file.

    Columns "label, x, y, z"; arrays `points` and perhaps `labels`.

    `MatrixError` if the file cannot be read, `MeshError` if it is a mesh that cannot.
    """
    with about_matrices(path, "nodes"):
        table = _READERS.get(path.suffix.lower(), _of_mesh)(path)
    if table.points.shape != (len(table.labels), 3) or not np.isfinite(table.points).all():
        raise MatrixError(
            f"{path}: expected three finite coordinates for each of {len(table.labels)} nodes, "
            "found an array "
            f"{table.points.shape}{'' if np.isfinite(table.points).all() else ' with others'}"
        )
    labels, count = np.unique(table.labels, return_counts=True)
    if (count > 1).any():
        raise MatrixError(
            f"{path}: expected every label once, "
            f"found node {labels[count > 1][0]} {count.max()} times"
        )
    return table


def read_dofs(path: Path) -> IntArray:
    """The label of the node and the direction (n, 2) of every row of the matrices.

    A table "label, dof", or of CalculiX (.dof) "label.dof". `MatrixError`.
    """
    with about_matrices(path, "labels and dofs"):
        if path.suffix.lower() == ".dof":
            require_text(path)
            # As text: a point between two integers is no decimal one.
            words = path.read_text(encoding="utf-8").split()
            pairs = [word.partition(".")[::2] for word in words]
            wrong = [word for word, pair in zip(words, pairs, strict=True) if not _whole(pair)]
            if wrong or not words:
                raise MatrixError(f"expected 'label.dof', found {(wrong or ['nothing'])[0]!r}")
            return np.array(pairs, dtype=np.int64)
    return as_integers(path, read_columns(path, "label, dof"), "labels and dofs")


def _whole(words: tuple[str, ...]) -> bool:
    """Whether all words are digits alone, and few enough for integers of 64 bits."""
    return all(word.isascii() and word.isdigit() and len(word) < MAX_DIGITS for word in words)


def read_columns(path: Path, columns: str) -> Array:
    """A table of numbers (n, k) with commas or blanks between them, perhaps below a line of words.

    columns: the names of the k columns, for messages.
    """
    try:
        text = path.read_text(encoding="utf-8")
        first, _, rest = text.partition("\n")
        # A heading is told by words where numbers should be; files with and without one are common.
        try:
            np.array(first.replace(",", " ").split(), dtype=float)
        except ValueError:
            text = rest
        table = load_rows(text.replace(",", " ").splitlines(), comments=("#", "*"))
    except (OSError, UnicodeDecodeError, ValueError) as error:
        why = in_one_line(error)
        raise MatrixError(f"{path}: expected a table of {columns}: {why}") from error
    if not len(table) or table.shape[1] != len(columns.split(",")):
        raise MatrixError(
            f"{path}: expected a table of {columns}, found {table.shape[1]} columns, "
            f"{len(table)} rows"
        )
    return table


def as_integers(path: Path, values: Array, what: str) -> IntArray:
    """Numbers of a table that must be whole."""
    try:
        return whole_numbers(values, what)
    except MatrixError as error:
        raise MatrixError(f"{path}: {error}") from error


def _of_table(path: Path) -> NodeTable:
    table = read_columns(path, "label, x, y, z")
    return NodeTable(path.name, as_integers(path, table[:, 0], "labels"), table[:, 1:])


def _of_npz(path: Path) -> NodeTable:
    with arrays(path, "arrays points (n, 3) and perhaps labels (n,)"), np.load(path) as file:
        points = np.asarray(file["points"], dtype=float)
        labels = file["labels"] if "labels" in file else np.arange(1, len(points) + 1)
    return NodeTable(
        path.name, as_integers(path, np.asarray(labels, dtype=float).ravel(), "labels"), points
    )


def _of_mesh(path: Path) -> NodeTable:
    """All nodes of a mesh file; a group holds its points and the nodes of its cells."""
    from ..mesh.reading import read_draft

    draft = read_draft(path)
    cells, groups = draft.cells, {}
    for name, group in draft.groups.items():
        nodes = [cells[kind][rows].ravel() for kind, rows in group.cells.items()]
        groups[name] = np.unique(np.concatenate([NO_NODES, group.points, *nodes]))
    labels = np.arange(1, len(draft.points) + 1) if draft.labels is None else draft.labels
    solids = {kind: labels[rows] for kind, rows in cells.items() if kind in SOLID_TYPES}
    try:
        axes = draft.axes()
    except MeshError as error:  # of a mesh that is fine, but for matrices
        raise MatrixError(str(error)) from error
    return NodeTable(
        path.name, labels, draft.points, groups, axes, draft.scalars, draft.by_label, solids
    )


_READERS = {".csv": _of_table, ".txt": _of_table, ".npz": _of_npz}
"""By suffix; what is not here is a mesh."""
